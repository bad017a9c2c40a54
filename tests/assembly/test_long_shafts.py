"""Long shafts in many segments: their response."""

import numpy as np
import pytest
from scipy.linalg import solve_banded

import torsion
from torsion.analyses.response.over_speed import response
from torsion.assembly import assemble
from torsion.assembly.system import System
from torsion.study import Study

SEGMENTS = 600
ETA, STIFFNESS, PSI = 0.02, 2.0e5, 0.6
SCENE = """
name: long
materials:
  s: {{shear_modulus: 79.3 GPa, youngs_modulus: 206 GPa, density: 7850 kg/m**3, loss_factor: 0.02}}
operation: {{speeds: {{from: 30 rad/s, to: 400 rad/s, steps: 5}}}}
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
def test_the_response_of_a_long_shaft_is_that_of_its_banded_equations(shaft, is_first):
    study = _study(*((shaft, COUPLING) if is_first else (COUPLING, shaft)))
    whole = assemble(study.train)
    found = response(study, whole)
    for point in range(0, len(found.speed), 7):
        for line, order in enumerate((1, 3)):
            angle, torque = _dense(whole, line, order * float(found.speed[point]))
            here = found.torque[point, line, -SEGMENTS:]
            np.testing.assert_allclose(here, torque, atol=3e-9 * np.abs(torque).max())
            here = found.angle[point, line]
            np.testing.assert_allclose(here, angle, atol=3e-9 * np.abs(angle).max())
