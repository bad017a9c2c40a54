"""Universal joints by themselves: kinematics, secondary couples, the line of joints as one, and its best phase."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from torsion import fields
from torsion.analyses.joints import joint_lines
from torsion.analyses.joints.joint_lines import Behind, CoupleFound, JointFound, Joints, Placed
from torsion.analyses.steady import Steady
from torsion.analyses.steady import steady as mean_torques
from torsion.arrays import FloatArray
from torsion.assembly import assemble
from torsion.errors import Fault, InputError, Path
from torsion.fields import Declared, Quantity, given
from torsion.findings import Work
from torsion.kernels.joints.cross import Carrier, couple_harmonics, couples, fluctuation, transfer
from torsion.kernels.joints.line import Variable
from torsion.kernels.joints.tripod import constant_velocity_couple, exact_motion, exact_statics
from torsion.study import Operation, states_mean_torque
from torsion.train import Train

Pair = tuple[CoupleFound, ...]  # on the driving and on the driven shaft
SHAFTS: tuple[Carrier, Carrier] = ("driving", "driven")
_COUPLE_SAMPLES = 720  # over a revolution of a tripod; symmetry puts the extremes of its couples at multiples of 30 degrees


def joint_couples(
    joint: Placed, yoke: FloatArray, torque: float, carrier: Carrier, distance: float | None
) -> tuple[Pair, float]:
    """Return the couples on the driving and the driven shaft, and the greatest force across the driving shaft, N.

    yoke (angles,) rad from the joint's plane; `torque` is constant on the shaft called `carrier`; distance of two
    bearings, m.
    """
    force = 0.0
    if joint.record.kind == "cross":
        pair = _of_cross(joint, yoke, torque, carrier)
    elif joint.record.order == 0 or joint.record.angle == 0:
        # A standing couple torque tan(angle/2) in the plane, the same on either shaft.
        size = float(constant_velocity_couple(joint.record.angle, torque))
        none = np.zeros_like(yoke)
        mean = (0.0, size)
        driving = CoupleFound("driving", none, none + size, None, mean, (0j, 0j), 0, abs(size))
        pair = driving, replace(driving, shaft="driven")
    else:
        pair, force = _of_tripod(joint, yoke, torque, carrier)
    if distance is not None:
        pair = tuple(replace(couple, bearing=couple.largest / distance) for couple in pair)
    return pair, force


def _of_cross(joint: Placed, yoke: FloatArray, torque: float, carrier: Carrier) -> Pair:
    """Mean and second harmonic in closed form, counted over the carrier's own angle."""
    angle = joint.record.angle
    start = joint.record.yoke
    curves = couples(yoke, angle, torque, carrier)
    if carrier == "driven":
        start += float(transfer(start, angle).error)
    turn = np.exp(2j * start)
    sine = math.sin(angle)
    # on the shaft without the constant torque: the peak of tan u sqrt(1 - sin^2 u^2)
    lesser = sine if 2.0 * sine * sine <= 1.0 else 0.5 / math.cos(angle)
    parts = couple_harmonics(angle, torque, carrier)
    shafts = zip(SHAFTS, (curves.driving, curves.driven), parts, strict=True)
    return tuple(
        CoupleFound(
            shaft,
            couple.normal,
            couple.inplane,
            couple.yoke,
            mean=(0.0, float(part.mean)),
            amplitude=(complex(part.normal * turn), complex(part.inplane * turn)),
            order=2,
            largest=abs(torque) * (math.tan(angle) if shaft == carrier else lesser),
        )
        for shaft, couple, part in shafts
    )


def _of_tripod(
    joint: Placed, yoke: FloatArray, torque: float, carrier: Carrier
) -> tuple[Pair, float]:
    """Exact couples of a single bearing; mean and third harmonic over the carrier's own angle from one revolution."""
    record = joint.record
    start = joint.record.yoke + math.pi / 2
    arms = 2.0 * np.pi * np.arange(_COUPLE_SAMPLES) / _SAMPLES
    data = record.angle, record.radius or 0.0, record.arm or 1.0
    # The carrier's angle from where it starts, and its speed / driving speed.
    x, share = arms - start, np.ones_like(arms)
    if carrier == "driven":
        both = exact_motion(np.append(arms, start), *data)
        x = x + both.error[:-1] - both.error[-1]
        share = both.ratio[:-1]

    # (Normal, in the plane) on both shafts, at the requested angles and over a revolution.
    shown, turned = (
        exact_statics(
            angles,
            *data,
            torque * (exact_motion(angles, *data).ratio if carrier == "driven" else 1.0),
        )
        for angles in (yoke + math.pi / 2, arms)
    )
    curves, turns = (
        [
            (contact.driving_normal, contact.driving_inplane),
            (-contact.driving_normal, contact.driven_inplane),
        ]
        for contact in (shown, turned)
    )
    pair = []
    for shaft, curve, revolution in zip(SHAFTS, curves, turns, strict=True):
        mean = [float(np.mean(part * share)) for part in revolution]
        third = [complex(2.0 * np.mean(part * share * np.exp(-3j * x))) for part in revolution]
        largest = float(np.hypot(*revolution).max())
        pair.append(
            CoupleFound(shaft, *curve, None, (mean[0], mean[1]), (third[0], third[1]), 3, largest)
        )
    return tuple(pair), float(np.hypot(*turned.force).max())


PLACE: Path = ("analyses", "joints")
_SAMPLES = (
    720  # of a tripod's turn; symmetry puts the extremes of its speed at multiples of 30 degrees
)


class JointsSettings(Declared):
    """Settings of `joints`."""

    optimise: Variable | None = given("which quantity of the joints is to be chosen best")
    joint: str | None = given(
        "the one joint that may be changed (default: every joint of its line but the first)"
    )
    turns: Annotated[int, Field(ge=1, le=100)] = given(
        "turns of the driving shaft that are shown", 1
    )
    steps: Annotated[int, Field(ge=8, le=10_000)] = given("angles per revolution", 360)
    torque: fields.Torque | None = given(
        "torque in the driving shaft of every joint (default: the mean torque, if known)"
    )
    carrier: Literal["driving", "driven"] = given(
        "the shaft of a joint whose torque is constant", "driving"
    )
    bearings: Mapping[
        str, Annotated[float, Quantity("m", above=0, usual="distance of bearings")]
    ] = given("distance of the bearings that carry a joint's couple, by joint", {})


def joints(
    train: Train,
    operation: Operation,
    requested: JointsSettings | None = None,
    steady: Steady | None = None,
) -> Joints:
    """Return all joints of a train over the turns of each line's first shaft; the rest of the train is taken as rigid.

    Each joint carries its own mean torque at the rated speed (else the highest), constant on the shaft `carrier`;
    a `torque` that is given stands in its place everywhere. `steady` saves computing the mean torques again.
    Raises InputError where the train has no joint, or a setting names none.
    """
    wanted = requested or JointsSettings()
    placed = joint_lines.placed(train)
    if faults := settings_faults(train, wanted):
        raise InputError(faults)
    turned = np.linspace(0.0, 2.0 * math.pi * wanted.turns, wanted.steps * wanted.turns + 1)
    speed = operation.speed
    # Mean torque in the driving shaft of every joint, N m, where it is known.
    torques: list[float | None] = [wanted.torque] * len(placed)
    lacking = []
    if wanted.torque is None and speed and states_mean_torque(train, operation):
        if steady is None:
            steady = mean_torques(train, assemble(train), operation, np.array([speed]))
        column = int(np.argmin(np.abs(steady.speed - speed)))
        torques = [float(steady.torque[joint.span, column]) for joint in placed]
    elif wanted.torque is None:
        lacking.append("no torque is known: secondary couples are omitted")
    moved = joint_lines.motions(placed, turned)
    moved_joints = [
        _joint(placed, k, moved[k], wanted, speed, torque) for k, torque in enumerate(torques)
    ]
    # Every shaft line, from its first joint to one that no other stands behind.
    followed = {joint.before for joint in placed}
    paths = [joint_lines.path_to(placed, k) for k in range(len(placed)) if k not in followed]
    lines = tuple(
        joint_lines.line_found(placed, path, wanted.optimise, wanted.joint) for path in paths
    )
    remarks = [] if speed else ["no speed is given: accelerations are given for speed 1 rad/s"]
    remarks += lacking
    for line in lines:
        names = ", ".join(placed[k].name for k in line.joints)
        if joint_lines.has_third_order(placed, line.joints):
            what = "the resulting angle and the optimum include only the cross joints"
            remarks.append(f"{names}: {what}; speeds include the tripods")
        if wanted.optimise and line.optimum is None:
            what = f"no {wanted.optimise} of a cross joint is free to be chosen on this line"
            remarks.append(f"{names}: {what}")
    return Joints(turned, tuple(moved_joints), lines, tuple(remarks))


def _joint(
    placed: Sequence[Placed],
    position: int,
    behind: Behind,
    requested: JointsSettings,
    speed: float | None,
    torque: float | None,
) -> JointFound:
    joint = placed[position]
    moved = behind.transfer
    pair = tuple[CoupleFound, ...]()
    force = 0.0
    if torque is not None:
        distance = requested.bearings.get(joint.name)
        pair, force = joint_couples(joint, behind.yoke, torque, requested.carrier, distance)
    # (Greatest - least)/mean driven speed at constant driving speed.
    if joint.record.order == 2:
        unevenness = float(fluctuation(joint.record.angle))
    else:
        turned = 2.0 * np.pi * np.arange(_SAMPLES) / _SAMPLES
        unevenness = float(np.ptp(joint_lines.turning(joint.record, turned).ratio))
    return JointFound(
        name=joint.name,
        part=joint.part,
        kind=joint.record.kind,
        angle=joint.record.angle,
        plane=joint.record.plane,
        phase=joint.record.phase,
        yoke=joint.record.yoke,
        ratio=joint.ratio,
        order=joint.record.order,
        amplitude=joint.error[0][1] if joint.error else 0j,
        unevenness=unevenness,
        speed=None if speed is None else speed * float(joint.ratio),
        torque=torque,
        error=moved.error,
        speed_ratio=moved.ratio,
        acceleration=moved.curvature,
        torque_ratio=1.0 / behind.ratio,
        couples=pair,
        force=force,
        steepest=joint_lines.steepest(placed, joint_lines.path_to(placed, position)),
    )


def settings_faults(train: Train, requested: JointsSettings) -> list[Fault]:
    """Return the faults of the settings against the train."""
    placed = joint_lines.placed(train)
    if not placed:
        return [Fault(PLACE, "the train has no joint", "add one: `- joint: {angle: 5 deg}`")]
    names = [joint.name for joint in placed]
    hint = f"joints: {', '.join(names)}"
    faults = [
        Fault((*PLACE, "bearings", name), f"no joint is called '{name}'", hint, at_key=True)
        for name in requested.bearings
        if name not in names
    ]
    if requested.joint is None:
        return faults

    # The joint that may be changed must change something.
    where = (*PLACE, "joint")
    if requested.joint not in names:
        return [*faults, Fault(where, f"no joint is called '{requested.joint}'", hint)]
    joint = placed[names.index(requested.joint)]
    if requested.optimise is None:
        message = "`joint` lists joints that may change, and nothing is optimised"
        faults.append(Fault(where, message, "add `optimise: phase`"))
    elif joint.record.kind != "cross":
        message = f"'{joint.name}' is not a cross joint; it has nothing to choose"
        faults.append(Fault(where, message, "name a cross joint"))
    elif joint.before is None and requested.optimise != "angle":
        changes = f"its {requested.optimise} changes nothing"
        message = f"'{joint.name}' is the first of its line; {changes}"
        faults.append(Fault(where, message, "name a later joint"))
    return faults


def run(work: Work) -> None:
    """The joints of the train by themselves."""
    with work.log.step(
        "universal joints",
        "requested" if "joints" in work.study.analyses else "the train has joints",
    ) as step:
        settings = work.settings("joints", JointsSettings)
        result = joints(work.study.train, work.study.operation, settings, work.get(Steady))
        step.method = "exact kinematics of rigid shafts, each line as one joint"
        lines = "1 line" if len(result.lines) == 1 else f"{len(result.lines)} lines"
        step.size = f"{len(result.joints)} joints on {lines}, {result.angle.size} angles"
    for remark in result.remarks:
        work.log.without("universal joints, in part", remark)
    work.put(joints=result)
