"""Rule `universal-joints`: makers' limits of non-uniformity, accelerations, speed times angle, and tube speed."""

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Annotated

from torsion.analyses.joints.joint_lines import Joints
from torsion.analyses.lateral.bending_shafts import bending_shafts
from torsion.analyses.lateral.shaft_bending import Lateral
from torsion.errors import Fault
from torsion.fields import Number, Quantity, given
from torsion.findings import Results
from torsion.primitives import Bar, Spring
from torsion.rules.demands import unjudged
from torsion.rules.verdict_line import (
    TO_BE_VERIFIED,
    Check,
    Rule,
    RuleSettings,
    Standing,
    verdict_of,
)
from torsion.study import Study
from torsion.train import Train

RULE = "universal-joints"
ELBE = 0.0027  # tan b sin b of 3 degrees, the usual limit of the resulting angle (Elbe)
SPICER_TORSIONAL, SPICER_INERTIAL = 300.0, 1000.0  # rad/s2 (Spicer)
BENDING = "Speed against the critical bending speed"
EVENLY = "driven from its first end"
SHARE_OF_CRITICAL = 0.65  # usual 0.65 to 0.8
PUBLISHED = {  # setting: its limit by makers, in words
    "unevenness": (ELBE, "limit after Elbe, 3 deg in round figures"),
    "torsional": (SPICER_TORSIONAL, "limit after Spicer"),
    "inertial": (SPICER_INERTIAL, "limit after Spicer"),
}
RPM = 30.0 / math.pi
Limit = tuple[float, Standing, str]  # with its origin in words
Acceleration = Annotated[float, Quantity("rad/s**2", above=0)]


@dataclass(frozen=True)
class Tube:
    """The shaft from one joint to the next."""

    name: str
    parts: tuple[int, ...]  # of its shafts
    ratio: Fraction  # its speed / reference speed
    critical: float  # rad/s, lowest bending frequency without supports; NaN where it has some or something lacks
    lacks: str  # why it is not judged; empty where it is
    has_support: (
        bool  # between the joints, so that the analysis of bending knows its critical speeds
    )


def tubes(train: Train) -> tuple[Tube, ...]:
    """Return every shaft between a joint and the one before it; none where rigid or elastic links alone join the two."""
    joints = {mesh.part: mesh for mesh in train.constraints}
    shafts = list[Tube]()
    for joint in train.constraints:
        pieces = (
            () if joint.after is None else _path(train, joints[joint.after].driven, joint.driving)
        )
        bars = [piece for piece in pieces if isinstance(piece, Bar)]
        if not bars:
            continue
        bar, parts = bars[0], tuple(bar.part for bar in bars)
        names, ratio = ", ".join(bar.name for bar in bars), train.parts[joint.part].ratio
        critical, lacks, has_support = math.nan, "", any(train.shaft(bar).support for bar in bars)
        material = train.materials[train.shaft(bar).material]
        is_soft = any(isinstance(piece, Spring) and piece.flexibility > 0 for piece in pieces)
        if has_support:
            bent = (shaft for shaft in bending_shafts(train)[0] if shaft.lacks)
            lacks = "; ".join(shaft.lacks for shaft in bent if set(shaft.parts) & set(parts))
        elif len(bars) > 1 or is_soft:
            lacks = "it is not one tube from joint to joint"
        elif bar.section is not None:
            lacks = "its section is a mesh, which is not solved for bending"
        elif bar.outer[0] != bar.outer[1] or bar.bore[0] != bar.bore[1]:
            lacks = "it is conical"
        elif material.youngs_modulus is None or material.density == 0:
            lacks = "its material has no `youngs_modulus` or no density"
        else:
            size = bar.length, bar.outer[0], bar.bore[0]
            critical = critical_speed(*size, material.youngs_modulus, material.density)
        shafts.append(Tube(names, parts, ratio, critical, lacks, has_support))
    return tuple(shafts)


def critical_speed(
    length: float, outer: float, bore: float, modulus: float, density: float
) -> float:
    """Return pi^2/4 sqrt(E/rho) sqrt(D^2 + d^2)/L^2, rad/s: first bending frequency of a simply supported tube (Euler).

    In the joint makers' form 15 pi/2 sqrt(E/rho) sqrt(D^2 + d^2)/L^2 per minute.
    """
    return math.pi**2 / 4.0 * math.sqrt(modulus / density) * math.hypot(outer, bore) / length**2


def _path(train: Train, start: int, end: int) -> tuple[Spring | Bar, ...]:
    """Return what lies between two stations, the last first, along springs and shafts in the direction of power flow."""
    pieces: tuple[Spring | Bar, ...] = (*train.springs, *train.bars)
    paths: dict[int, tuple[Spring | Bar, ...]] = {start: ()}
    queue = [start]
    for station in queue:  # which grows meanwhile: breadth first
        for piece in pieces:
            if piece.driving == station and piece.driven not in paths:
                paths[piece.driven] = piece, *paths[station]
                queue.append(piece.driven)
    return paths.get(end, ())


class JointRuleSettings(RuleSettings):
    """Settings of `universal-joints`."""

    unevenness: Annotated[float, Quantity("1", above=0, usual="fluctuation")] = given(
        "maximum tan b sin b of the resulting angle b of a line (Elbe: 3 degrees)", ELBE
    )
    torsional: Acceleration = given(
        "maximum acceleration downstream of a line of joints (Spicer)", SPICER_TORSIONAL
    )
    inertial: Acceleration = given(
        "maximum acceleration of a shaft between joints (Spicer)", SPICER_INERTIAL
    )
    speed_angle: Number | None = given(
        "maximum speed times angle of a joint, rpm times degrees (makers: 17000 to 27000 by size; default: not judged)"
    )
    critical_share: Annotated[float, Quantity("1", above=0, at_most=1)] = given(
        "maximum speed of a tube between two joints / its critical bending speed, on a `support` that of the bending "
        "analysis (usual: 0.65 to 0.8)",
        SHARE_OF_CRITICAL,
    )


class UniversalJoints(Rule[JointRuleSettings]):
    """The rule, as the study reads it."""

    name = RULE
    edition = "published practice of joint makers (Elbe, Spicer, Dana)"
    settings_class = JointRuleSettings
    needs = ("joints",)

    def faults(self, study: Study) -> Iterable[Fault]:
        """Return what the file lacks for this rule."""
        if not study.has_joints:
            message = f"{RULE} finds no joint in the train"
            return [Fault(self.path(study), message, "leave the rule out")]
        if _speed(study) is None:
            hint = "`speeds: {from: 300 rpm, to: 1800 rpm}`, or `rated: {speed: 1500 rpm}`"
            message = f"no speed is given; {RULE} judges the highest"
            return [Fault(("operation", "speeds"), message, hint)]
        return []

    def left_out(self, study: Study) -> Iterable[tuple[str, str]]:
        """Yield what it does not judge, and why."""
        for tube in tubes(study.train):
            if tube.lacks:
                yield f"{RULE}: bending of {tube.name}", tube.lacks
        if self.settings.speed_angle is None:
            why = "`speed_angle` gives no limit; it depends on the joint's size"
            yield f"{RULE}: speed times angle", why

    def judge(self, evidence: Results) -> Iterable[Check]:
        """Yield every line of joints, every shaft between joints and, where requested, every joint, at the highest speed."""
        joints, speed = evidence.get(Joints), _speed(evidence.study)
        if joints is None or speed is None:
            raise ValueError("a rule about joints needs them and a speed")
        limits = dict[str, Limit]()
        for key, (by_maker, words) in PUBLISHED.items():
            maximum = float(getattr(self.settings, key))
            limits[key] = maximum, "setting", f"setting `{key}`"
            if maximum == by_maker:
                limits[key] = maximum, "maker", words
        # rad/s2: greatest acceleration behind every joint; no gear stands in a line of joints.
        steepest = [joint.steepest * (speed * float(joint.ratio)) ** 2 for joint in joints.joints]

        # Non-uniformity of every line, and what it does to the driven inertia.
        for line in joints.lines:
            members = [joints.joints[position] for position in line.joints]
            where = ", ".join(joint.name for joint in members)
            bend = f"resulting angle of the cross joints {math.degrees(line.resultant):.4g} deg"
            worst_first = sorted(members, key=lambda joint: -joint.unevenness)
            parts = tuple(joint.part for joint in worst_first)
            about = "U", where, "Non-uniformity of the line"
            limit = limits["unevenness"]
            yield _verdict(about, line.index, "1", limit, None, parts, before=bend)
            about = "torsional", where, "Angular acceleration of the driven side"
            value, limit = steepest[line.joints[-1]], limits["torsional"]
            yield _verdict(about, value, "rad/s2", limit, speed, parts)

        # Of every shaft between two joints, each once, the driving shaft of the line turning evenly.
        what = "Angular acceleration of the shaft downstream of the joint"
        for position in dict.fromkeys(
            position for line in joints.lines for position in line.joints[:-1]
        ):
            joint, limit = joints.joints[position], limits["inertial"]
            about, part = ("inertial", joint.name, what), (joint.part,)
            yield _verdict(about, steepest[position], "rad/s2", limit, speed, part, after=EVENLY)

        for joint in joints.joints if self.settings.speed_angle is not None else ():
            limit = (self.settings.speed_angle or 0.0, "setting", "setting `speed_angle`")
            # As its maker counts it.
            value = speed * float(joint.ratio) * RPM * math.degrees(joint.angle)
            about = "n b", joint.name, "Speed times angle"
            yield _verdict(about, value, "deg/min", limit, speed, (joint.part,))
        share, bent = self.settings.critical_share, evidence.get(Lateral)
        for tube in tubes(evidence.study.train):
            yield _bending(tube, bent, share, speed)


def _bending(tube: Tube, bent: Lateral | None, share: float, speed: float) -> Check:
    """Speed of a tube against a share of its critical bending speed, that of a tube on supports as it was computed."""
    about, lacks = ("n_crit", tube.name, BENDING), tube.lacks
    if tube.has_support and bent is None and not lacks:
        lacks = "its bending was not computed"
    if lacks:
        return replace(unjudged(RULE, *about, lacks, TO_BE_VERIFIED), parts=tube.parts)
    first, second, origin = tube.critical, tube.critical / 2.0, "simply supported at the joints"
    if tube.has_support and bent is not None:
        criticals = [
            critical
            for shaft in bent.shafts
            if set(shaft.parts) & set(tube.parts)
            for critical in shaft.critical
        ]
        first, second = (
            min(
                (critical.speed for critical in criticals if critical.order == order),
                default=math.inf,
            )
            for order in (1, 2)
        )
        origin = "bending of the shaft on its supports, order 1"
    speed_rpm, critical_rpm = speed * float(tube.ratio) * RPM, first * RPM
    twice = "passes it within the speeds" if speed_rpm >= second * RPM else "stays below it"
    standing: Standing = TO_BE_VERIFIED if share == SHARE_OF_CRITICAL else "setting"
    words = f"{share:.3g} x critical bending speed {critical_rpm:.5g} rpm ({origin})"
    couple = (
        f"the secondary couple turns at twice the speed, {2.0 * speed_rpm:.5g} rpm, and {twice}"
    )
    limit = share * critical_rpm, standing, words
    return _verdict(about, speed_rpm, "rpm", limit, speed, tube.parts, after=couple)


def _verdict(
    about: tuple[str, str, str],
    value: float,
    unit: str,
    limit: Limit,
    speed: float | None,
    parts: tuple[int, ...],
    *,
    before: str = "",
    after: str = "",
) -> Check:
    """A verdict on some parts whose note is that of the limit, with what stands `before` and `after` it.

    about: clause, place and what is compared.
    """
    maximum, standing, words = limit
    return Check(
        RULE,
        *about,
        value=value,
        limit=maximum,
        unit=unit,
        verdict=verdict_of(value <= maximum, standing),
        standing=standing,
        speed=speed,
        note="; ".join(filter(None, (before, words, after))),
        parts=parts,
    )


def _speed(study: Study) -> float | None:
    """The highest speed of the range or the rated one, which is higher, rad/s of the reference; of a case its own."""
    speeds, rated = study.operation.speeds, study.operation.rated
    if speeds is not None and study.case is not None and study.case.has_own_speeds:
        return speeds.last
    highest = max(0.0 if speeds is None else speeds.last, 0.0 if rated is None else rated.speed)
    return highest or None
