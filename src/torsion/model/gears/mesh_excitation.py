"""What excites at a gear mesh: a transmission error of its teeth, or the torque that it makes in a blocked mesh."""

import math

from torsion.errors import Fault, Path
from torsion.fields import Amount
from torsion.model.machine_torques import Excitation
from torsion.primitives import Constraint, Torque


def mesh_torque(given: Excitation, mesh: Constraint, path: Path) -> Torque | Fault:
    """The excitation of a mesh, its amplitude as the angle e of the driving gear; a fault where it says none.

    e is the twist driving - driven/ratio of teeth that carry no vibratory torque: an elastic mesh carries
    k (twist - e), a rigid one has the twist e. A torque of the mesh is k e.
    """
    if given.frequency is not None:
        return Fault(
            (*path, "frequency"), "a mesh excites by its teeth", "give `order`, or leave both out"
        )
    if given.order is not None and given.harmonic != 1:
        return Fault(
            (*path, "harmonic"), "`order` and `harmonic` exclude each other", "keep one of them"
        )
    if given.order is None and not mesh.meshings:
        hint = "give `order`: the number of teeth of the driving gear, or 1 for its run-out"
        return Fault((*path, "at"), f"'{mesh.name}' has no `teeth` that say the order", hint)
    angle = _angle(given, mesh, path)
    if isinstance(angle, Fault):
        return angle
    order, name = given.order or given.harmonic * mesh.meshings, f"mesh of {mesh.name}"
    return Torque(
        name,
        mesh.driving,
        order,
        phase=given.phase,
        path=path,
        source=given.source,
        mesh=(mesh.name, angle),
    )


def _angle(given: Excitation, mesh: Constraint, path: Path) -> float | Fault:
    """The amplitude as an angle (rad) of the driving gear."""
    torque, torque_path = given.torque, (*path, "torque")
    if torque is not None:
        if not isinstance(torque, Amount) or torque.of_mean:
            hint = "for example `torque: 120 N*m`"
            return Fault(torque_path, "the torque of a mesh is one amplitude", hint)
        if mesh.meshings and not mesh.teeth:
            message = f"'{mesh.name}' is a planetary stage, of several meshes"
            return Fault(torque_path, message, "give `transmission_error`")
        if mesh.flexibility == 0:
            message = f"a torque between the teeth of '{mesh.name}', which are rigid, moves nothing"
            hint = "give `transmission_error`, or the gear its `mesh_stiffness`"
            return Fault(torque_path, message, hint)
        return torque.torque * mesh.flexibility
    unit, size = given.transmission_error or ("rad", 0.0)
    if unit == "rad":
        if given.base_radius is not None:
            return Fault((*path, "base_radius"), "an angle needs no `base_radius`", "leave it out")
        return float(size)
    if given.base_radius is not None:
        return float(size / given.base_radius / mesh.wheel)
    if (teeth := mesh.toothing) is None:
        hint = "give `base_radius` of the driving gear here, or the gear its `module` or `pitch_diameter`"
        return Fault((*path, "transmission_error"), f"the size of '{mesh.name}' is not known", hint)
    transverse = math.atan(math.tan(teeth.pressure_angle) / math.cos(teeth.helix))
    return float(size / (teeth.diameter / 2.0 * math.cos(transverse)))
