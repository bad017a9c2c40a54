"""The scenes with engines show what they are there for."""

import math
from pathlib import Path

import numpy as np
import pytest
from tests.kernels.engine.test_engine_kernels import ORACLES

import torsion
from torsion.analyses.engine.engine_results import Engines
from torsion.analyses.response.amplitudes import Response, Synthesis
from torsion.findings import Findings
from torsion.rules.verdict_line import Checks

SCENES = Path(__file__).parents[2] / "shafting_specs"
RPM = math.pi / 30.0


@pytest.fixture(scope="module")
def measured() -> Findings:
    return torsion.run(torsion.read(SCENES / "six_cylinder_pressure.yaml"))


@pytest.mark.parametrize("speed", ["1200", "1440", "2000", "2200"])
def test_the_public_engine_answers_as_a_dense_solution_and_another_program(speed: str, measured: Findings) -> None:
    """First and last span order by order, and the sums of magnitudes, which that program prints."""
    known, response = ORACLES["six_cylinder_mendes_pressure"]["by rpm"][speed], measured.need(Response)
    at = int(np.argmin(np.abs(response.speed - float(speed) * RPM)))
    for span, key in ((0, "S1 amplitudes"), (-1, "S8 amplitudes")):
        np.testing.assert_allclose(np.abs(response.torque[at, :, span]), known[key], rtol=2e-8)
    total = measured.need(Synthesis)
    np.testing.assert_allclose(total.bound[at], known["sum of magnitudes"], rtol=5e-9)
    np.testing.assert_allclose(total.half_range[at], known["half range s1..s8"], rtol=2e-5)  # of 7200 samples


def test_the_ship_fails_with_a_misfire_and_passes_without() -> None:
    text = (SCENES / "diesel_misfire.yaml").read_text(encoding="utf-8")
    out, whole = (torsion.run(torsion.parse(one)) for one in (text, text.replace("      misfire: 6\n", "")))
    verdicts = [{check.verdict for check in found.need(Checks).lines} for found in (out, whole)]
    assert "fail" in verdicts[0]
    assert verdicts[1] == {"pass"}
    span = [one.name for one in out.system.spans].index("rubber coupling")
    cases = out.need(Engines).each[0].misfires
    assert max(cases[6].half_range[:, span]) == pytest.approx(out.need(Synthesis).half_range[:, span].max(), rel=1e-9)
    assert max(cases[0].half_range[:, span]) == pytest.approx(whole.need(Synthesis).half_range[:, span].max(), rel=5e-3)
