"""The results as JSON: documented, finite, exact, and without the libraries of the page."""

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from docs.site.results_manual import documented

from torsion.analyses.response.amplitudes import Response
from torsion.analyses.undamped_modes import Modes
from torsion.findings import Findings
from torsion.output.stored.results_json import results, text

KEYS = {key.path: key.meaning for key in documented()}
NOT_IN_THIS_TRAIN = (
    "frequency_response",
    "check.",
    "checks[].barred",
    "checks[].times",
    "checks[].reach",
    "compressors",
    "lateral",
    "joints.lines[].optimum",
    "first_order_compared",
    "periodic",
    "stability",
    "plan.unanswered",
    "transient",
    "nonlinear_peaks",
    "tooth_forces",
    "dampers",
    "engines",
    "pendulums",
    "coupling_tables",
    "design",
    "sweep",
    "fit",
    "tolerances",
    "coupling_temperatures",
    "frequencies_over_speed",
    "sharp_steps",
    "hubs",
    "fillets",
    "vibratory_torques",
    "files",
    "report",  # in files alone
)
LIGHT = """
import sys, torsion
from torsion.output.stored.results_json import text
text(torsion.run(torsion.parse({scene!r})))
heavy = ("matplotlib", "jinja2", "typst", "rich", "torsion.kernels.joints")
print([name for name in sys.modules if name.split(".")[0] in heavy or name in heavy])
"""


def paths(value: Any, at: str = "") -> set[str]:
    """Every path down to the documented leaves."""
    if at in KEYS:
        return {at}
    if isinstance(value, dict):
        return set().union(*(paths(v, f"{at}.{k}" if at else k) for k, v in value.items()))
    if isinstance(value, list):
        return set().union(*(paths(v, f"{at}[]") for v in value))
    return {at} if value is not None else set()


def test_every_key_is_documented_and_every_documented_key_is_there(train: Findings) -> None:
    found = paths(results(train))
    assert found <= set(KEYS)
    left = {key for key in KEYS if not key.startswith(NOT_IN_THIS_TRAIN)} - found
    assert left == set()


def test_the_text_is_strict_json_without_infinities(train: Findings, undamped: Findings) -> None:
    for findings in (train, undamped):
        back = json.loads(text(findings), parse_constant=pytest.fail)
        assert back == json.loads(json.dumps(results(findings)))
        assert back["format"] == 1


@pytest.mark.parametrize("only", [("modes",), ("checks", "damped_modes")])
def test_of_some_results_their_keys_and_the_head_are_printed(
    train: Findings, only: tuple[str, ...]
) -> None:
    every, some = json.loads(text(train)), json.loads(text(train, only))
    assert set(some) == {"format", "program", "legend", "scene", "plan", *only}
    assert some == {key: every[key] for key in some}
    assert len(every) > len(some)


def test_numbers_come_back_to_the_last_digit(train: Findings) -> None:
    back = json.loads(text(train))
    np.testing.assert_array_equal(back["modes"]["frequency_Hz"], train.need(Modes).frequency)
    pairs = np.array(back["response"]["lines"][0]["torque_Nm"])
    spans = back["response"]["span"]
    np.testing.assert_array_equal(
        pairs[..., 0] + 1j * pairs[..., 1], train.need(Response).torque[:, 0, spans]
    )


def test_orders_are_exact_texts(train: Findings) -> None:
    stated = [line["order"] for line in results(train)["response"]["lines"]]
    assert stated == [str(line.order) for line in train.need(Response).lines]
    assert "80/41" in stated


def test_a_line_that_is_not_ok_has_its_word_and_no_number(undamped: Findings) -> None:
    line = results(undamped)["response"]["lines"][0]
    words = line["status"]
    assert set(words) >= {"ok"}
    assert "singular" in words or "near-singular" in words
    together = results(undamped)["synthesis"]["half_range_Nm"][0]
    for word, torque, half_range in zip(words, line["torque_Nm"], together, strict=True):
        unknown = [part is None for pair in torque for part in pair] + [half_range is None]
        assert all(unknown) if word != "ok" else not any(unknown)


def test_json_alone_loads_neither_plots_nor_templates() -> None:
    scene = "name: a\ntrain: [disc: {inertia: 2}, coupling: {stiffness: 120}, disc: {inertia: 3}]\n"
    script = LIGHT.format(scene=scene)
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == "[]"


def test_results_alone_load_nothing_that_prints(tmp_path: Path) -> None:
    scene = tmp_path / "scene.yaml"
    scene.write_text(
        "name: two discs\ntrain: [disc: {inertia: 2}, coupling: {stiffness: 120}, disc: {inertia: 1}]\n"
    )
    heavy = ("matplotlib", "jinja2", "typst", "rich")
    code = f"""
import sys
from torsion.cli import app
app(["solve", {str(scene)!r}, "--json"], standalone_mode=False)
print([name for name in sys.modules if name in {heavy}], file=sys.stderr)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stderr.strip() == "[]"
    assert json.loads(done.stdout)["modes"]
