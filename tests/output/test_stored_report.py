"""A report kept as data: every value of every type comes back, and what is damaged or foreign is refused in words."""

import json
import math
from collections.abc import Iterator
from dataclasses import dataclass, is_dataclass
from pathlib import Path
from typing import Annotated, Any, Literal, get_args, get_type_hints

import numpy as np
import pytest
from tests.contracts.frozen import solved
from tests.for_all import for_all

import torsion
from torsion.findings import Findings
from torsion.output.document import Cover, Document, document
from torsion.output.pages.html import html
from torsion.output.reports import REPORTS
from torsion.output.stored.stored_data import BY_NAME, Arrays, StoredFloats, plain, restored
from torsion.output.stored.stored_report import NAMED_CLASSES, _checksum, opened, stored
from torsion.output.write import redraw


@dataclass(frozen=True)
class Inner:
    size: float
    name: str = ""


@dataclass(frozen=True)
class Other:
    size: float


@dataclass(frozen=True)
class Outer:
    either: Annotated[Inner | Other, BY_NAME]
    pen: int | Literal["limit", "rated"] = 0
    pairs: tuple[tuple[float, str], ...] = ()
    values: StoredFloats | None = None
    flag: bool = False


def there_and_back(value: Any) -> Any:
    arrays = Arrays()
    data = json.loads(
        json.dumps([plain(value, arrays, {Inner, Other}), arrays.kept], allow_nan=False)
    )
    return restored(type(value), data[0], Arrays(data[1]))


@for_all(
    "value",
    [
        Outer(Inner(1.5)),
        Outer(Other(1.5)),
        Outer(Inner(-0.0, "ψ\u2028\"'"), "limit"),
        Outer(Other(3.0), 7, flag=True),
        Outer(Other(0.1), pairs=((1e-320, "a"), (2.0, ""))),
        Outer(Other(math.inf)),
        Outer(Other(-math.inf)),
    ],
)
def test_a_value_of_every_type_comes_back(value: Outer) -> None:
    back = there_and_back(value)
    assert back == value
    assert repr(back) == repr(value)


def test_what_is_no_number_comes_back_as_such() -> None:
    assert math.isnan(there_and_back(Outer(Other(math.nan))).either.size)


@for_all(
    "array",
    [
        np.array([0.1, -0.0, np.nan, np.inf, 5e-324]),
        np.zeros(0),
        np.zeros((0, 3)),
        np.arange(12.0).reshape(3, 4).T,
        np.arange(5),
        np.array([True, False]),
        np.arange(6.0)[::-2],
        np.array(2.5),
        np.arange(3, dtype=np.int32),
    ],
)
def test_every_bit_of_an_array_comes_back(array: np.ndarray) -> None:
    found = there_and_back(Outer(Other(1.0), values=array)).values
    assert found.shape == array.shape
    assert found.dtype.kind == array.dtype.kind
    assert found.tobytes() == np.ascontiguousarray(array, dtype=found.dtype).tobytes()


def test_an_array_is_kept_once_and_comes_back_as_one() -> None:
    arrays, x = Arrays(), np.linspace(0.0, 1.0, 50)
    data = [
        plain(Outer(Other(size), values=x.copy()), arrays, {Inner, Other}) for size in (1.0, 2.0)
    ]
    assert len(arrays.kept) == 1
    kept = Arrays(arrays.kept)
    first, second = (restored(Outer, values, kept) for values in data)
    assert first.values is second.values


@for_all(
    "data",
    [
        {},
        [],
        None,
        {"either": {"Other": {"size": 1}}, "more": 1},
        {"either": {"size": 1}},
        {"either": {"Third": {}}},
        {"either": {"Other": {"size": "x"}}},
        {"either": {"Other": {"size": []}}},
        {"either": {"Other": {"size": 1}}, "pen": 1.5},
        {"either": {"Other": {"size": 1}}, "pen": "other"},
        {"either": {"Other": {"size": 1}, "Inner": {"size": 1}}},
        {"either": {"Other": {"size": 1}}, "pairs": [[1]]},
        {"either": {"Other": {"size": 1}}, "values": 0},
        {"either": {"Other": {"size": 1}}, "values": -1},
        {"either": {"Other": {"size": 1}}, "flag": 2},
    ],
)
def test_what_the_types_do_not_allow_is_refused(data: Any) -> None:
    with pytest.raises(ValueError, match=r"\w"):
        restored(Outer, data, Arrays())


@for_all(
    ("key", "value"),
    [
        ("type", "O"),
        ("type", "<f4"),
        ("shape", [4]),
        ("shape", [-5]),
        ("shape", [10**12]),
        ("shape", [5.0]),
        ("bytes", "????"),
        ("bytes", "AAAA"),
        ("shape", [6]),
        ("bytes", 5),
    ],
)
def test_a_damaged_array_is_refused(key: str, value: Any) -> None:
    arrays = Arrays()
    arrays.place(np.arange(5.0))
    with pytest.raises(ValueError, match="array"):
        Arrays([arrays.kept[0] | {key: value}]).at(0)


BEFORE = '{\n"format": 1'


def kept_in(folder: Path, made: Document) -> str:
    """Write results that are a report alone; return their text."""
    text = BEFORE + stored(made, _checksum(BEFORE), ["results.json"])
    (folder / "results.json").write_text(text, encoding="utf-8")
    return text


@pytest.mark.parametrize("report", ["solve", "joint"])
def test_a_report_with_every_sort_of_figure_is_drawn_the_same(
    report: str, train: Findings, tmp_path: Path
) -> None:
    made = document(train, report=REPORTS[report])
    kept_in(tmp_path, made)
    assert html(opened(tmp_path)) == html(made)
    assert opened(tmp_path / "results.json").name == report


def test_the_figures_of_an_engine_and_what_misfires_are_drawn_the_same(tmp_path: Path) -> None:
    made = document(solved("diesel_misfire"))
    kept_in(tmp_path, made)
    assert "main engine with cylinder 6 motored (misfire)" in html(made)
    assert html(opened(tmp_path)) == html(made)


HEAD = '{"format":%d,"program":"9.0","sha256":"%s","content":'
NAMES = ',\n"files": []\n}\n'


def forged(content: str) -> str:
    """A file of results with that content of its report, and its checksum."""
    sha = _checksum(_checksum("{") + content)
    return f'{{,\n"report": {HEAD % (1, sha)}{content}}}{NAMES}'


@for_all(
    ("text", "words"),
    [
        ("name: a scene\n", "holds no report"),
        ("{}", "holds no report"),
        ('{"report": 5}', "holds no report"),
        (
            f'{{,\n"report": {HEAD % (2, "0" * 64)}{{}}}}{NAMES}',
            r"format 2 of torsion 9.0; this is torsion .* reads format 1",
        ),
        (f'{{,\n"report": {HEAD % (1, "0" * 64)}{{}}}}{NAMES}', "damaged or was changed"),
        (forged("["), "with other parts than torsion"),
        (forged("[" * 10**6), "with other parts than torsion"),
        (forged("{}"), "with other parts than torsion"),
        (forged('{"document":5,"arrays":[]}'), "with other parts than torsion"),
        (forged('{"document":{"cover":1e999},"arrays":[]}'), "with other parts than torsion"),
        (forged('{"document":{},"arrays":{}}'), "with other parts than torsion"),
        (forged('"\\u001b"'), "control characters"),
    ],
)
def test_a_foreign_or_damaged_file_is_refused_in_words(
    text: str, words: str, tmp_path: Path
) -> None:
    (tmp_path / "results.json").write_text(text, encoding="utf-8")
    with pytest.raises(torsion.InputError, match=words):
        opened(tmp_path)


def test_a_file_that_is_none_is_refused(tmp_path: Path) -> None:
    with pytest.raises(torsion.InputError, match="No such file"):
        opened(tmp_path)
    (tmp_path / "results.json").write_bytes(b"\xff\xfe{")
    with pytest.raises(torsion.InputError, match="UTF-8"):
        opened(tmp_path / "results.json")


def test_a_figure_that_was_changed_by_hand_is_noticed(bare: Findings, tmp_path: Path) -> None:
    kept_in(tmp_path, document(bare))
    file = tmp_path / "results.json"
    text = file.read_text(encoding="utf-8")
    assert ",120.0," in text
    file.write_text(text.replace(",120.0,", ",130.0,"), encoding="utf-8")
    with pytest.raises(torsion.InputError, match="was changed after"):
        opened(file)


def places(data: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """Every place in nested lists and mappings."""
    yield path
    for step in (
        data if isinstance(data, dict) else range(len(data)) if isinstance(data, list) else ()
    ):
        yield from places(data[step], (*path, step))


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
@for_all(
    ("begin", "instead"),
    list(enumerate([None, 7, -1, "x", [], {}, [[]], True, "inf", "nan", "\ud800", "\x1b[31m"])),
)
def test_whatever_stands_in_its_place_there_is_a_report_or_a_refusal(
    begin: int, instead: Any, bare: Findings, tmp_path: Path
) -> None:
    """Places of a report in turn hold something else, with the checksum of that: it is drawn, or refused.

    The places of one value lie between those of the others.
    """
    text, drawn, refused = kept_in(tmp_path, document(bare)), 0, 0
    content = json.loads(text[text.index('"content":') + 10 : text.index(',\n"files"') - 1])
    every = list(places(content))
    step_on = len(every) // 60
    for path in every[begin * step_on // 12 :: step_on]:
        changed = json.loads(json.dumps(content))
        inside = changed
        for step in path[:-1]:
            inside = inside[step]
        if path:
            inside[path[-1]] = instead
        else:
            changed = {"document": instead}
        (tmp_path / "results.json").write_text(forged(json.dumps(changed)), encoding="utf-8")
        try:
            redraw(opened(tmp_path), tmp_path / "out")
            drawn += 1
        except torsion.InputError:
            refused += 1
    assert drawn + refused >= 60
    assert refused > 4


def test_nothing_of_a_foreign_report_is_anything_but_text(nasty: str, tmp_path: Path) -> None:
    made = Document(
        Cover(nasty, nasty, ((nasty, nasty),), nasty, nasty, nasty, ((nasty, nasty),)), ()
    )
    kept_in(tmp_path, made)
    page = html(opened(tmp_path))
    assert "<b>#1" not in page
    assert page.count("&lt;b&gt;#1") >= 7
    with pytest.raises(ValueError, match="picture"):
        Cover("a", "b", (), logo="https://example.com/a.png")
    with pytest.raises(ValueError, match="picture"):
        Cover("a", "b", (), logo='data:image/png;base64,AAAA" onerror="x')


def dataclasses_within(annotation: Any) -> set[type]:
    """Dataclasses that an annotation names itself."""
    if is_dataclass(annotation) and isinstance(annotation, type):
        return {annotation}
    return set().union(*map(dataclasses_within, get_args(annotation)))


def test_a_class_stands_by_its_name_exactly_where_a_field_may_hold_another() -> None:
    """The writer sees values, the reader annotations: both must agree on what has a name."""
    from torsion.output import blocks, document
    from torsion.output.figures import figure

    for module in (blocks, figure, document):
        for kind in vars(module).values():
            if isinstance(kind, type) and is_dataclass(kind) and kind.__module__ == module.__name__:
                for name, hint in get_type_hints(kind).items():
                    within = dataclasses_within(hint)
                    assert len(within) <= 1 or within <= NAMED_CLASSES, (kind, name)
                    assert len(within) != 1 or not within & NAMED_CLASSES, (kind, name)
