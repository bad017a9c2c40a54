"""Exact motions beside a response: a band of modes, and work that is bounded."""

import pytest

import torsion
from torsion.analyses.motion.derived import nonlinear_peaks
from torsion.analyses.motion.derived.nonlinear_peaks import NonlinearPeak
from torsion.analyses.motion.train.loaded_train import Built
from torsion.analyses.response.synthesis import Synthesis
from torsion.findings import Findings
from torsion.output.chapters.response.couplings import nonlinear_at_peaks

TEXT = """name: x
operation: {{speeds: {{from: 240 rpm, to: 290 rpm, steps: 6}}, rated: {{speed: 1500 rpm, power: 200 kW}}}}
train:
- motor: {{inertia: 20}}
- coupling: {{name: teeth, stiffness: 300 kN*m/rad, {}}}
"""
PIECES = """- disc: {{inertia: 0.0126}}
- coupling: {{stiffness: 2.2e6}}
"""
TEXT += 16 * PIECES
TEXT += """\
- propeller: {{inertia: 12, blades: 4, excitation: [{{blade_order: 1, torque: 500 N*m}}]}}
analyses: {{response: }}
"""
PLAY = "viscous: 300, clearance: 0.3 deg"
FRICTION = "viscous: 300, hysteresis_torque: {torque: 400 N*m, stiffness: 900 kN*m/rad}"


def solved(kind: str) -> tuple[Findings, tuple[NonlinearPeak, ...]]:
    """Findings, and what stands beside the response."""
    found = torsion.run(torsion.parse(TEXT.format(kind)))
    return found, found.results["nonlinear_peaks"].each


@pytest.mark.parametrize("kind", [PLAY, FRICTION])
def test_a_band_of_modes_is_as_good_as_all(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """A damper of the contact takes part in what the modes left out give; without that the first is 3 % too low."""
    monkeypatch.setattr(nonlinear_peaks, "PARTS", 1)  # the largest settles
    bands = list[bool]()
    known = nonlinear_peaks.Band.begin_motion

    def seen(self: nonlinear_peaks.Band, built: Built) -> None:
        bands.append(built.is_band)
        known(self, built)

    monkeypatch.setattr(nonlinear_peaks.Band, "begin_motion", seen)
    _, whole = solved(kind)
    assert not any(bands)
    bands.clear()
    monkeypatch.setattr(nonlinear_peaks, "CHEAP", 0.0)
    _, band = solved(kind)
    assert all(bands)
    for one, other in zip(band, whole, strict=True):
        assert one.exact == pytest.approx(other.exact, rel=4e-3)
        assert one.half_range == pytest.approx(other.half_range, rel=5e-3)
        assert (one.half_ranges >= (1.0 - 1e-3) * other.half_ranges).all()  # for verdicts, raised


def test_work_has_its_end_and_what_is_not_followed_never_passes(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(nonlinear_peaks, "MOST_WORK", 300.0)
    found, each = solved(PLAY)
    assert not any(one.ended for one in each)
    assert [one.exact for one in each] == [None] * len(each)
    safe, speed = found.need(Synthesis), each[0].speed
    assert (safe.half_range[found.results["response"].speed == speed] == float("inf")).all()
    (note,) = (
        block for block in nonlinear_at_peaks(found) if "too much computing time" in str(block)
    )
    assert "Compute the transient response at this speed" in str(note)
