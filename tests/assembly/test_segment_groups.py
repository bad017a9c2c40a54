"""A system with segment groups in place of the segments of long shafts gives the answers of the whole one."""

import numpy as np
import pytest
from scipy.linalg import solve_banded

import torsion
from torsion.analyses.response.over_speed import response, response_at
from torsion.assembly import assemble
from torsion.assembly.system import System, condensed
from torsion.study import Study

SEGMENTS, GROUPS = 600, 50
ETA, STIFFNESS, PSI = 0.02, 2.0e5, 0.6
SCENE = """
name: long
materials:
  s: {{shear_modulus: 79.3 GPa, youngs_modulus: 206 GPa, density: 7850 kg/m**3, loss_factor: 0.02}}
operation: {{speeds: {{from: 30 rad/s, to: 900 rad/s, steps: 9}}}}
train:
  - disc: {{name: a, inertia: 3.0}}
  - {first}
  - disc: {{name: b, inertia: 1.0, damping: 5}}
  - {second}
  - disc: {{name: c, inertia: 2.0}}
excitations: [{{at: a, torque: 100, order: 1}}, {{at: c, torque: 30, order: 3, phase: 20 deg}}]
"""
SHAFT = "shaft: {name: shaft, length: 40 m, diameter: D, segments: 600, material: s}"
COUPLING = "coupling: {name: soft, stiffness: 2.0e5, psi: 0.6}"
UNIFORM, CONICAL = SHAFT.replace("D", "0.1 m"), SHAFT.replace("D", "[0.1 m, 0.16 m]")


def _study(first: str, second: str) -> Study:
    return torsion.parse(SCENE.format(first=first, second=second))


def _dense(system: System, line: int, w: float) -> tuple[np.ndarray, np.ndarray]:
    """Angles (stations,) and torques (segments,) of a chain at w, by a banded solution of all its stations."""
    row, (link,) = system.rows[0], [k for k, span in enumerate(system.own_spans)]
    shaft, other = row.stations, [system.driving[link], system.driven[link]]
    order = [*shaft, other[1]] if other[0] == shaft[-1] else [other[0], *shaft]
    h = system.flexibility[-SEGMENTS:] / (1 + 1j * ETA)
    soft = 1 / (STIFFNESS * (1 + 1j * PSI / (2 * np.pi)))
    k = 1 / (np.append(h, soft) if other[0] == shaft[-1] else np.append(soft, h))
    own = (-(w**2) * system.inertia).astype(complex)
    own[1] += 5j * w
    diagonal = own[order] + np.append(k, 0) + np.append(0, k)
    load = np.zeros(len(order), dtype=complex)
    load[order.index((0, 2)[line])] = (100.0, 30.0 * np.exp(1j * np.radians(20)))[line]
    bands = np.array([np.append(0, -k), diagonal, np.append(-k, 0)])
    angle = solve_banded((1, 1), bands, load)
    torque = (angle[:-1] - angle[1:]) * k
    at_station = np.empty(len(order), dtype=complex)
    at_station[order] = angle
    return at_station, torque[:SEGMENTS] if other[0] == shaft[-1] else torque[1:]


@pytest.mark.parametrize("shaft", [UNIFORM, CONICAL], ids=["uniform", "conical"])
@pytest.mark.parametrize("is_first", [True, False])
def test_the_response_of_a_condensed_train_is_that_of_all_its_segments(shaft, is_first):
    study = _study(*((shaft, COUPLING) if is_first else (COUPLING, shaft)))
    whole = assemble(study.train)
    small = condensed(whole, GROUPS)
    assert small.whole is whole
    assert (len(whole.rows), small.rows[0].number) == (1, GROUPS + 1)
    found = response(study, small)
    groups = small.groups
    assert groups is not None
    for point in range(0, len(found.speed), 7):
        for line, order in enumerate((1, 3)):
            angle, torque = _dense(whole, line, order * float(found.speed[point]))
            there = torque[groups.spans[-GROUPS - 1 :] - 1]
            here = found.torque[point, line, -GROUPS - 1 :]
            np.testing.assert_allclose(here, there, atol=3e-9 * np.abs(torque).max())
            there = angle[groups.stations]
            np.testing.assert_allclose(
                found.angle[point, line], there, atol=3e-9 * np.abs(angle).max()
            )


def test_groups_keep_the_names_and_sums_of_their_segments():
    whole = assemble(_study(UNIFORM, COUPLING).train)
    small = condensed(whole, GROUPS)
    row = [span.name for span in small.spans if span.name.startswith("shaft")]
    assert (row[0], row[-2], row[-1]) == ("shaft [1..12]", "shaft [589..599]", "shaft [600]")
    assert small.stations[3].name == "shaft 12/600"
    assert small.inertia.sum() == pytest.approx(whole.inertia.sum(), rel=1e-14)
    assert small.flexibility.sum() == pytest.approx(whole.flexibility.sum(), rel=1e-14)


def test_a_train_without_long_shafts_stays_as_it_is():
    whole = assemble(_study(UNIFORM, COUPLING).train)
    assert condensed(whole, SEGMENTS) is whole
    assert whole.whole is whole


def test_a_cone_that_is_swept_against_its_drive_is_condensed_from_its_other_end():
    scene = SCENE.format(first=CONICAL, second=COUPLING).replace(
        "name: c, inertia: 2.0", "name: c, held: true"
    )
    study = torsion.parse(scene.replace(", {at: c, torque: 30, order: 3, phase: 20 deg}", ""))
    whole = assemble(study.train)
    small = condensed(whole, GROUPS)
    groups = small.groups
    assert groups is not None
    assert (small.condensed.sign[groups.last_span > groups.spans] < 0).all()
    found = response(study, small)
    there = response_at(study, whole, found, found.speed).angle[..., groups.stations]
    size = np.abs(there).max(axis=(1, 2), keepdims=True)
    np.testing.assert_allclose(found.angle / size, there / size, atol=1e-9)
