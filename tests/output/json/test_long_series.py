"""Long arrays among the results: as text piece by piece, and in a file of their own."""

import json
import struct
from itertools import repeat
from pathlib import Path

import numpy as np
import pytest

import torsion
from torsion.errors import InputError
from torsion.kernels.trees.tree_response import Status
from torsion.output.stored import results_json
from torsion.output.stored.results_json import (
    END,
    SERIES,
    lines,
    listed,
    numbers,
    text,
    write_json,
)
from torsion.results import words

SPECS = Path(__file__).parents[3] / "shafting_specs"


def _data() -> dict:
    rng = np.random.default_rng(1)
    values = rng.normal(size=(3, 7001))
    values[1, 5] = np.nan
    return {
        "few": {
            "number": 1.5,
            "word": 'x"y',
            "none": None,
            "list": [1, [2.0, "z"]],
            "empty": np.empty((0, 3)),
        },
        "long": [
            {
                "torque": values,
                "complex": numbers(values[0] + 1j),
                "at": np.arange(23_456),
                "flag": values[0] > 0,
            }
        ],
        "status": words(np.array([0, 2, 1]), Status),
    }


def test_the_text_of_a_key_is_that_of_the_lists():
    data = _data()
    assert json.loads(b"".join(lines([("a", data)])) + END.encode()) == {"a": listed(data)}
    back = listed(data)
    assert back["long"][0]["torque"][1][5] is None
    assert back["status"] == ["ok", "singular", "near-singular"]
    assert np.shape(back["long"][0]["complex"]) == (7001, 2)


def test_long_arrays_stand_in_a_file_of_their_own_under_their_keys(tmp_path):
    data = _data()
    parts = {key: repeat(value).__next__ for key, value in data.items()}
    written = write_json(parts, tmp_path / "results.json", most=10_000)
    assert [path.name for path in written] == ["results.json", SERIES]
    back = json.loads(written[0].read_text())
    assert back["few"] == listed(data["few"])
    with np.load(written[1]) as series:
        assert sorted(series) == ["long[0].at", "long[0].complex", "long[0].torque"]
        for name, place in back["long"][0].items():
            if name != "flag":
                assert place == {
                    "file": SERIES,
                    "array": f"long[0].{name}",
                    "shape": list(data["long"][0][name].shape),
                }
                np.testing.assert_array_equal(series[place["array"]], data["long"][0][name])
    assert back["long"][0]["flag"] == data["long"][0]["flag"].tolist()


def test_an_array_of_as_many_numbers_as_are_written_stays_in_the_file(tmp_path):
    parts = {"a": lambda: np.arange(6).reshape(2, 3), "b": lambda: np.arange(7)}
    write_json(parts, tmp_path / "results.json", most=6)
    back = json.loads((tmp_path / "results.json").read_text())
    assert back["a"] == [[0, 1, 2], [3, 4, 5]]
    assert back["b"] == {"file": SERIES, "array": "b", "shape": [7]}


def test_numbers_of_all_arrays_together_are_bounded(tmp_path, monkeypatch):
    """Many arrays of fewer numbers than one may have do not make a file of any size."""
    monkeypatch.setattr(results_json, "MOST_LISTED", 10_000)
    parts = {name: lambda: np.arange(3_000) for name in "abcde"} | {
        "short": lambda: np.arange(1_000)
    }
    write_json(parts, tmp_path / "results.json")
    back = json.loads((tmp_path / "results.json").read_text())
    assert [name for name in parts if isinstance(back[name], list)] == ["a", "b", "c", "short"]
    assert back["d"] == {"file": SERIES, "array": "d", "shape": [3_000]}


def test_results_that_are_too_long_for_a_stream_are_refused_with_what_to_do():
    findings = torsion.run(torsion.parse((SPECS / "two_discs.yaml").read_text(encoding="utf-8")))
    whole = text(findings)
    assert text(findings, largest=len(whole)) == whole
    with pytest.raises(
        InputError, match=r"MB of JSON, too many for --json \(use -o DIR, .* series.npz"
    ):
        text(findings, largest=len(whole) - 1)


def test_the_series_may_be_longer_than_four_gigabytes_and_hold_no_objects(tmp_path):
    write_json({"a": lambda: np.arange(7)}, tmp_path / "results.json", most=6)
    header = (tmp_path / SERIES).read_bytes()
    name, extra = struct.unpack("<HH", header[26:30])
    assert extra
    assert struct.unpack("<H", header[30 + name : 32 + name]) == (1,)  # sizes of 64 bits
    with pytest.raises(ValueError, match="Object arrays cannot be saved"):
        write_json({"b": lambda: np.array([None, "x"])}, tmp_path / "other.json", most=1)


def test_without_long_arrays_there_is_one_file_of_a_line_for_each_key(tmp_path):
    parts = {"a": lambda: [1, 2], "b": lambda: {"c": np.ones(2)}}
    (file,) = write_json(parts, tmp_path / "results.json")
    assert (
        file.read_text()
        == '{\n"a": [1,2],\n"b": {"c":[1.0,1.0]}\n}\n'
        == b"".join(lines((key, make()) for key, make in parts.items())).decode() + END
    )


def test_an_infinite_number_outside_of_arrays_is_null_too():
    assert list(lines([("a", float("inf")), ("b", [float("nan"), 1])])) == [
        b'{\n"a": null',
        b',\n"b": [null,1]',
    ]
