"""Bending of the shafts of a Cardan line: critical speeds, whirl, and the answer to the joints' secondary couples."""

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from functools import partial
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from torsion import fields
from torsion.analyses.joints.joint_lines import Placed, placed
from torsion.analyses.lateral.beam_matrices import DEGREE, assemble_lateral, places
from torsion.analyses.lateral.bending_shafts import BendingShaft, Planes, bending_shafts, planes
from torsion.analyses.lateral.couple_response import (
    Answer,
    Largest,
    PointForce,
    answer,
    couples_at,
    extent,
    orders,
    speeds_for,
)
from torsion.analyses.lateral.tilt_stability import Tilting, Torques, tilting
from torsion.analyses.lateral.whirl import Critical, Whirl, criticals, whirl
from torsion.analyses.steady import steady as mean_torques
from torsion.arrays import FloatArray
from torsion.assembly import assemble
from torsion.assembly.system import System
from torsion.errors import Fault, InputError, Path, SolveError
from torsion.fields import Declared, given
from torsion.findings import Progress, Work, silent
from torsion.kernels.trees.tree_response import Status
from torsion.results import derived, reported, result
from torsion.study import Operation, SpeedRange, states_mean_torque
from torsion.train import Train

PLACE: Path = ("analyses", "lateral")
_ROUNDS = 6  # of dividing more finely; two suffice but for a shaft with many masses
_SPARE = 4  # inner unknowns for every mode that is reported
_WHIRL_SPEEDS = 41  # speeds of the whirl map at most


class LateralSettings(Declared):
    """Settings of `lateral`."""

    modes: Annotated[int, Field(ge=1, le=20)] = given("bending modes of a plane", 4)
    speeds: SpeedRange | None = given("speed range (default: operation.speeds)")
    shear: bool = given("shear deflection and its effect on the frequencies (Timoshenko)", False)
    torque: fields.Torque | None = given(
        "torque in every joint (default: the mean torque, if known)"
    )
    carrier: Literal["driving", "driven"] = given(
        "which end of a line of joints has the constant torque", "driving"
    )


@reported
class Holding:
    """What holds a shaft."""

    name: str = result("joint or support")
    at: float = result("m", "its place along the shaft")


@reported
class InPlanes:
    """Frequencies in both planes of bending."""

    y: FloatArray = result("Hz", "mode", "along the normal of the joint's plane", key="y")
    z: FloatArray = result("Hz", "mode", "in the plane, square to the shaft", key="z")


@reported
class ShaftFound:
    """One bending shaft; y lies along the normal of the plane of the joint before it (else behind it)."""

    name: str = result("shafts that bend as one")
    parts: tuple[int, ...]  # of its shafts
    ratio: Fraction = result(
        "its speed / reference speed, exact; orders are per revolution of the shaft"
    )
    length: float = result("m", "its length")
    position: FloatArray = result(
        "m", "place", "along the shaft; the end between two elements is listed twice"
    )
    point: tuple[Holding, ...] = result("joints and supports that hold it", key="points")
    at_rest: InPlanes = result("natural frequencies without rotation", key="at_rest_Hz")
    critical: tuple[Critical, ...] = result(
        "of order 1, then of the orders of the joints' couples, by speed",
        key="critical_speeds",
    )
    whirl: Whirl | None = result("over speed; null without speeds")
    answers: tuple[Answer, ...] = result(
        "to the secondary couples, one an order; empty without a torque"
    )
    elements: int = result("finite elements")
    tilting: Tilting | None = result(
        "of a driven, nearly rigid shaft on supports with a known torque", default=None
    )
    remark: str = ""  # why its tilting was left out

    @derived("largest amplitudes, one an order of the secondary couples")
    def largest(self) -> tuple[Largest, ...]:
        """Largest displacement and bending moment of every order."""
        rows = []
        for response in self.answers:
            (size, at, speed), (moment, moment_at, moment_speed) = (
                response.peak(values) for values in (response.orbit, response.largest_moment)
            )
            place, moment_place = (
                None if k is None else float(self.position[k]) for k in (at, moment_at)
            )
            count = int((response.status != Status.OK).sum())
            bending = moment, moment_place, moment_speed
            rows.append(Largest(response.order, size, place, speed, *bending, count))
        return tuple(rows)

    @derived("largest forces on joints and supports, by order of the secondary couples")
    def forces(self) -> tuple[PointForce, ...]:
        """Largest force of every order on every joint and support."""
        rows = []
        for number, holding in enumerate(self.point):
            for response in self.answers:
                force, _, speed = response.peak(extent(response.force)[:, number : number + 1])
                rows.append(PointForce(holding.name, holding.at, response.order, force, speed))
        return tuple(rows)


@reported
class Lateral:
    """The bending side of the train."""

    shafts: tuple[ShaftFound, ...] = result(
        "shafts that bend; all speeds are speeds of the reference"
    )
    remarks: tuple[str, ...] = result("what was omitted, and why")
    shear: bool = result("shear deflection is in the beams", key="has_shear", default=False)


def lateral(
    train: Train,
    operation: Operation,
    requested: LateralSettings | None = None,
    *,
    progress: Progress = silent,
) -> Lateral:
    """Return every shaft that joints and supports hold. Joints stand still in space and pass on no bending moment.

    Raises InputError where no shaft is supported, or a support or a material is at fault; SolveError where the
    requested modes are out of reach.
    """
    wanted = requested or LateralSettings()
    if faults := lateral_faults(train, requested):
        raise InputError(faults)
    placed_joints, (shafts, _) = placed(train), bending_shafts(train)
    supported = [shaft for shaft in shafts if not shaft.lacks]
    speeds = wanted.speeds or operation.speeds
    found_shafts = []
    reference = None if speeds is None else speeds.values()
    torque = None if speeds is None else _torques(train, operation, wanted, placed_joints)
    for number, shaft in enumerate(supported):
        progress("bending of the shafts", number / len(supported))
        found_shafts.append(_bend_shaft(placed_joints, shaft, wanted, reference, torque))
    remarks = []
    for shaft in shafts:
        if shaft.lacks or shaft.loads:
            masses = f"the masses of {', '.join(shaft.loads)}, which the file does not say"
            remarks.append(f"{shaft.name}: {shaft.lacks or f'it bends without {masses}'}")
    if reference is None:
        remarks.append(
            "no speeds are given: whirl over speed and the response to the secondary couples are not computed"
        )
    elif placed_joints and torque is None:
        remarks.append("no torque is known: the response to the secondary couples is not computed")
    remarks += [f"{shaft.name}: {shaft.remark}" for shaft in found_shafts if shaft.remark]
    return Lateral(tuple(found_shafts), tuple(remarks), wanted.shear)


def lateral_faults(train: Train, requested: LateralSettings | None) -> list[Fault]:
    """Return the supports and materials at fault; where bending is requested and no shaft is supported, that too."""
    shafts, faults = bending_shafts(train)
    supported = [shaft for shaft in shafts if not shaft.lacks]
    if not faults and not supported:
        # At the keys where every shaft lacks something; else where bending is requested, or at the first support.
        faults += [
            Fault(shaft.place, f"{shaft.name} cannot bend: {shaft.lacks}")
            for shaft in shafts
            if shaft.place
        ]
        if not faults:
            held = [train.parts[bar.part].path for bar in train.bars if train.shaft(bar).support]
            path: Path = PLACE if requested is not None or not held else (*held[0], "support")
            reasons = "; ".join(f"{shaft.name}: {shaft.lacks}" for shaft in shafts)
            message = f"no shaft of the train can bend: {reasons}"
            if not shafts:
                message = "the train has no shaft, and only shafts bend"
            faults.append(Fault(path, message, at_key=True))
    if requested is None or not requested.shear:
        return faults
    # Young's and shear modulus of a shaft must belong together: their ratio says Poisson's.
    for shaft in supported:
        for number, segment in zip(shaft.parts, shaft.beam.segments, strict=True):
            poisson = segment.youngs_modulus / (2.0 * segment.shear_modulus) - 1.0
            if not 0.0 <= poisson <= 0.5:
                path = (*train.parts[number].path, "material")
                message = f"its `youngs_modulus` and `shear_modulus` make a Poisson's ratio of {poisson:.3g}"
                faults.append(Fault(path, message, "from 0 to 0.5 for `shear: true`"))
    return faults


def _torques(
    train: Train, operation: Operation, requested: LateralSettings, placed_joints: Sequence[Placed]
) -> Torques | None:
    """(joints, speeds) N m, mean, in the driving shafts of all joints, of reference speeds, rad/s; None if unknown."""
    if not placed_joints or (requested.torque is None and not states_mean_torque(train, operation)):
        return None
    spans = [joint.span for joint in placed_joints]
    if (stated := requested.torque) is not None:
        return partial(_stated_torques, stated, spans)
    return partial(_mean_torques, train, assemble(train), operation, spans)


def _stated_torques(stated: float, spans: Sequence[int], speeds: FloatArray) -> FloatArray:
    return np.full((len(spans), len(speeds)), stated)


def _mean_torques(
    train: Train, system: System, operation: Operation, spans: list[int], speeds: FloatArray
) -> FloatArray:
    return np.asarray(mean_torques(train, system, operation, speeds).torque[spans])


def _bend_shaft(
    placed_joints: Sequence[Placed],
    shaft: BendingShaft,
    requested: LateralSettings,
    reference: FloatArray | None,
    torque: Torques | None,
) -> ShaftFound:
    ratio = float(shaft.ratio)
    shaft_speeds = None if reference is None else reference * ratio
    excited = tuple(order for order in orders(placed_joints, shaft) if order)
    both, critical, at_rest = _refined(shaft, requested, shaft_speeds, excited)
    # Answers and critical speeds are reported at the speed of the reference in place of the shaft's own.
    map_of = None
    if shaft_speeds is not None:
        count = min(len(shaft_speeds), _WHIRL_SPEEDS)
        rows = np.linspace(0, len(shaft_speeds) - 1, count).round().astype(int)
        map_of = whirl(both, shaft_speeds[rows], requested.modes)
        map_of = replace(map_of, speed=map_of.speed / ratio)
    answers: tuple[Answer, ...] = ()
    tilt = None
    remark = ""
    if reference is not None and shaft.joints and torque is not None:
        tilt, remark = tilting(shaft, placed_joints, torque, reference, (at_rest.y, at_rest.z))
        resonances = tuple(crossing for crossing in critical if crossing.order in excited)
        grid = speeds_for(reference * ratio, resonances)
        couple = couples_at(placed_joints, shaft, torque(grid / ratio), requested.carrier)
        at_shaft_speed = [answer(both, order, grid, couple[order]) for order in couple]
        answers = tuple(
            replace(response, speed=response.speed / ratio) for response in at_shaft_speed
        )
    system = both.system
    return ShaftFound(
        shaft.name,
        shaft.parts,
        shaft.ratio,
        shaft.beam.length,
        places(system).position,
        tuple(Holding(point.name, point.at) for point in shaft.beam.points),
        at_rest,
        tuple(replace(crossing, speed=crossing.speed / ratio) for crossing in critical),
        map_of,
        answers,
        len(system.cells),
        tilt,
        remark,
    )


def _refined(
    shaft: BendingShaft,
    requested: LateralSettings,
    speed: FloatArray | None,
    excited: tuple[int, ...],
) -> tuple[Planes, tuple[Critical, ...], InPlanes]:
    """The shaft in as many elements as the highest frequency that is reported of it needs, with those it has at rest."""
    highest = 0.0 if speed is None else float(speed[-1]) * max((1, *excited))
    elements = 1
    for _ in range(_ROUNDS):
        system = assemble_lateral(
            shaft.beam, frequency=highest, shear=requested.shear, elements=elements
        )
        both = planes(system)
        critical = tuple(
            crossing
            for order in (1, *excited)
            for crossing in criticals(both, order, np.inf)[: 2 * requested.modes]
        )
        y, z = (
            1.0 / np.sqrt(square[square > 0][: requested.modes]) / (2.0 * np.pi)
            for square in (both.y.square, both.z.square)
        )
        reported_of = [np.array([crossing.frequency for crossing in critical]), y, z]
        reported_of += [] if speed is None else [whirl(both, speed[-1:], requested.modes).frequency]
        top = max(part[np.isfinite(part)].max(initial=0.0) for part in reported_of)
        reached = 2.0 * np.pi * float(top)
        spare = len(system.free) >= _SPARE * requested.modes
        if spare and reached <= highest:
            return both, critical, InPlanes(y, z)
        highest = max(highest, 1.01 * reached)
        elements = elements if spare else 2 * elements
    raise SolveError(f"{shaft.name}: its bending modes need too many elements; give fewer `modes`")


def run(work: Work) -> None:
    """The bending of every shaft that is supported."""
    why = "requested" if "lateral" in work.study.analyses else "a shaft has a `support`"
    with work.log.step("bending of the shafts", why) as step:
        settings = work.settings("lateral", LateralSettings)
        bending = lateral(work.study.train, work.study.operation, settings, progress=work.progress)
        beams = "with shear (Timoshenko)" if bending.shear else "without shear"
        step.method = f"beams {beams} by finite elements of degree {DEGREE}, in all their modes"
        step.size = f"{len(bending.shafts)} shafts, {sum(shaft.elements for shaft in bending.shafts)} elements"
    work.log.left_out += [("bending, in part", remark) for remark in bending.remarks]
    work.log.libraries["scikit-fem"] = None
    work.put(lateral=bending)
