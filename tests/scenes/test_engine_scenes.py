"""The scenes with engines show what they are there for."""

import math
from pathlib import Path

import numpy as np
import pytest
from tests.contracts.frozen import solved
from tests.kernels.engine.test_engine_kernels import ORACLES

import torsion
from torsion.analyses.engine.engine_results import Engines
from torsion.analyses.response.amplitudes import Response, Synthesis
from torsion.findings import Findings
from torsion.output.chapters.response.crank_machines import states
from torsion.output.headline import worst_line
from torsion.rules.verdict_line import Checks

SCENES = Path(__file__).parents[2] / "shafting_specs"
RPM = math.pi / 30.0


@pytest.fixture(scope="module")
def measured() -> Findings:
    return solved("six_cylinder_pressure")


@pytest.mark.parametrize("speed", ["1200", "1440", "2000", "2200"])
def test_the_public_engine_answers_as_a_dense_solution_and_another_program(
    speed: str, measured: Findings
) -> None:
    """First and last span order by order, and the sums of magnitudes, which that program prints."""
    known, response = (
        ORACLES["six_cylinder_mendes_pressure"]["by rpm"][speed],
        measured.need(Response),
    )
    at = int(np.argmin(np.abs(response.speed - float(speed) * RPM)))
    for span, key in ((0, "S1 amplitudes"), (-1, "S8 amplitudes")):
        np.testing.assert_allclose(np.abs(response.torque[at, :, span]), known[key], rtol=2e-8)
    total = measured.need(Synthesis)
    np.testing.assert_allclose(total.bound[at], known["sum of magnitudes"], rtol=5e-9)
    np.testing.assert_allclose(
        total.half_range[at], known["half range s1..s8"], rtol=2e-5
    )  # of 7200 samples


def test_the_ship_fails_with_a_misfire_and_passes_without() -> None:
    text = (SCENES / "diesel_misfire.yaml").read_text(encoding="utf-8")
    out, whole = (
        torsion.run(torsion.parse(one)) for one in (text, text.replace("      misfire: 6\n", ""))
    )
    verdicts = [{check.verdict for check in found.need(Checks).lines} for found in (out, whole)]
    assert "fail" in verdicts[0]
    assert verdicts[1] == {"pass"}
    span = [one.name for one in out.system.spans].index("rubber coupling")
    cases = out.need(Engines).each[0].misfires
    assert max(cases[6].half_range[:, span]) == pytest.approx(
        out.need(Synthesis).half_range[:, span].max(), rel=1e-9
    )
    assert max(cases[0].half_range[:, span]) == pytest.approx(
        whole.need(Synthesis).half_range[:, span].max(), rel=5e-3
    )
    crank = slice(
        0, 10
    )  # which the damping at the load, as it stands with a cylinder out, hardly reaches
    largest = whole.need(Synthesis).half_range[:, crank].max(axis=0)
    assert cases[0].half_range[:, crank].max(axis=0) == pytest.approx(
        largest, rel=5e-5
    )  # of all speeds, not of some


def test_the_slow_engine_bars_order_6_of_its_first_mode_and_names_the_cylinder_of_its_worst_misfire() -> (
    None
):
    found = solved("two_stroke_ship")
    out = found.cases["misfire"]
    for one in (found, out):
        bars = [band for check in one.need(Checks).lines for band in check.barred]
        assert {(band.shaft, band.order) for band in bars} == {
            ("intermediate shaft", 6),
            ("propeller shaft", 6),
        }
        assert len(bars) == 2
        assert all(band.lower < 2 * math.pi * 4.938974 / 6 < band.upper for band in bars)
    least = [
        [check.limit for check in one.need(Checks).lines if check.clause == "minimum diameter"]
        for one in (found, out)
    ]
    assert least[0] == pytest.approx(
        least[1], rel=1e-12
    )  # of the rated power, with a cylinder out too
    ((_, line),) = worst_line({"": out})
    assert "with cylinder 1 of main engine motored" in line
    (words,) = states(out)
    assert words.startswith(
        "main engine with cylinder 1 motored (misfire), all others with 120 % of the heat, each"
    )
