"""Forces on the teeth of every mesh whose pitch diameter is given, from the mean torque at the rated point."""

import math
from contextlib import suppress

import numpy as np

from torsion.analyses.steady import steady_if_known
from torsion.errors import InputError
from torsion.findings import Work
from torsion.results import reported, result
from torsion.sources import source


@reported
class ToothForce:
    """The nominal forces at the reference cylinder of one mesh (ISO 6336-1: F_t = 2 T/d), without K_A."""

    mesh: str = result("name of the mesh")
    diameter: float = result("m", "pitch diameter d of the driving wheel", key="pitch_diameter_m")
    driven_diameter: float = result(
        "m", "pitch diameter of the driven wheel", key="driven_pitch_diameter_m"
    )
    module: float | None = result("m", "normal module m_n, or null")
    helix: float = result("rad", "helix angle beta", key="helix_angle_rad")
    pressure_angle: float = result("rad", "normal pressure angle alpha_n")
    torque: float = result("N*m", "mean torque T at the driving wheel, rated point")
    tangential: float = result("N", "F_t = 2 T/d")
    radial: float = result("N", "F_r = F_t tan(alpha_n)/cos(beta)")
    axial: float = result("N", "F_a = F_t tan(beta)")


@reported
class ToothForces:
    """Of every mesh that has a pitch diameter, in the order of the train."""

    meshes: tuple[ToothForce, ...] = result(
        "nominal forces of every mesh with a pitch diameter", key=""
    )


@source("ISO6336-1")
def forces(
    torque: float, diameter: float, helix: float, pressure_angle: float
) -> tuple[float, float, float]:
    """Return tangential, radial and axial force (N) of a torque (N m) at a pitch diameter (m); angles in rad.

    >>> [round(force, 6) for force in forces(100.0, 0.2, 0.0, math.atan(0.25))]
    [1000.0, 250.0, 0.0]
    """
    tangential = 2.0 * torque / diameter
    return (
        tangential,
        tangential * math.tan(pressure_angle) / math.cos(helix),
        tangential * math.tan(helix),
    )


def run(work: Work) -> None:
    """Put the forces where the mean torque at the rated point is known."""
    rated = work.study.operation.rated
    system = work.system
    steady = None
    if rated is not None:
        with suppress(InputError):  # the table of the load may not reach to it
            steady = steady_if_known(work.study, system, np.array([rated.speed]))
    if steady is None:
        work.log.without("tooth forces", "the mean torque at the rated point is not known")
        return
    torques = {
        (span.part, span.name): abs(float(steady.torque[k, 0]))
        for k, span in enumerate(system.own_spans)
    }
    with work.log.step("tooth forces", "the file gives pitch diameters") as step:
        forces_of = []
        for mesh in system.train.constraints:
            if (teeth := mesh.toothing) is not None:
                torque = torques[mesh.part, mesh.name]
                size = teeth.diameter, teeth.diameter / float(mesh.ratio), teeth.module
                angles = teeth.helix, teeth.pressure_angle
                acting = forces(torque, teeth.diameter, *angles)
                forces_of.append(ToothForce(mesh.name, *size, *angles, torque, *acting))
        work.put(tooth_forces=ToothForces(tuple(forces_of)))
        step.method = "F_t = 2 T/d"
        step.size = f"{len(forces_of)} mesh{'es' * (len(forces_of) != 1)}"
