"""Chapter: bending of the shafts: critical speeds, whirl over speed, the answer to the joints' secondary couples."""

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from torsion.analyses.lateral.shaft_bending import Lateral
from torsion.arrays import FloatArray
from torsion.findings import Findings
from torsion.kernels.tree_response import Status
from torsion.output.blocks import Block, Figure, Heading, Paragraph, Points
from torsion.output.chapters import lateral_tables
from torsion.output.chapters import tilt_stability as tilting
from torsion.output.chapters.lateral_tables import MICRO, Range, inside, near, sound, unstable
from torsion.output.numbers import RPM, scale
from torsion.output.reported_values import rated_rpm, reference

if TYPE_CHECKING:
    from torsion.analyses.lateral.couple_response import Answer
    from torsion.analyses.lateral.shaft_bending import ShaftFound

AXES = (
    "y lies along the normal of the plane of the joint before the shaft (else of the one behind it), z square to y and "
    "to the shaft. Joints hold their shafts in place and let them tilt; supports are springs."
)


def chapter(findings: Findings) -> list[Block]:
    """Nothing where bending is not requested and no shaft has a support."""
    found = findings.get(Lateral)
    if found is None:
        return []
    speeds = speed_range(findings)
    blocks: list[Block] = [
        Heading("Bending of the shafts"), Paragraph(f"Speeds are those of {reference(findings)}. {AXES}"),
        lateral_tables.shafts(found.shafts), lateral_tables.criticals(found.shafts, speeds),
    ]  # fmt: skip
    table = lateral_tables.whirl(found.shafts)
    if table is not None:
        blocks += [Heading("Whirl over the speed", 2), *_verdict(table.marks), table]
        blocks += [made for k, shaft in enumerate(found.shafts) if (made := _whirl(findings, shaft, k))]
    blocks += _answers(findings, found.shafts)
    blocks += tilting.section(findings, found.shafts)
    if found.remarks:
        blocks += [Heading("What could not be said of the bending", 2), Points(found.remarks)]
    return blocks


def speed_range(findings: Findings) -> Range:
    """Lowest and highest reference speed of the analysis; None where no speeds are given."""
    requested = getattr(findings.study.analyses.get("lateral"), "speeds", None)
    speeds = requested or findings.study.operation.speeds
    return None if speeds is None else (speeds.first, speeds.last)


def _verdict(marks: tuple[str, ...]) -> list[Block]:
    """A sentence where a motion grows by itself."""
    grown = marks.count("fail")
    if not grown:
        return []
    text = f"{grown} of the modes below grow by themselves in the speed range: the shaft is unstable there."
    return [Paragraph(text, "fail")]


def _whirl(findings: Findings, shaft: "ShaftFound", number: int) -> Figure | None:
    """Frequencies over speed with the order lines."""
    over, speeds = shaft.whirl, speed_range(findings)
    if over is None or speeds is None:
        return None
    orders = sorted({1, *(one.order for one in shaft.critical)})
    last = float(over.speed[-1]) * float(shaft.ratio) / (2.0 * np.pi)
    values = {
        "speed": over.speed * RPM, "frequency": over.frequency, "direction": over.direction,
        "unstable": unstable(over.log_decrement), "rated": rated_rpm(findings),
        "orders": [(order * last, f"order {order}") for order in orders],
        "crossings": [
            (one.speed * RPM, one.frequency, inside(one, speeds))
            for one in near(shaft, speeds)
        ],
    }  # fmt: skip
    return Figure(f"whirl-{number + 1}", f"Whirl of {shaft.name}: frequency over speed", "whirl", values)


def _answers(findings: Findings, shafts: "tuple[ShaftFound, ...]") -> list[Block]:
    """Nothing where no torque is known."""
    tables = [table for table in (lateral_tables.answers(shafts), lateral_tables.forces(shafts)) if table]
    if not tables:
        return []
    figures = [_bending(findings, shaft, k) for k, shaft in enumerate(shafts) if shaft.answers]
    return [Heading("Answer to the secondary couples", 2), *tables, *figures]


def _bending(findings: Findings, shaft: "ShaftFound", number: int) -> Figure:
    """Largest displacement, moment and force of the shaft over speed, every order apart."""
    from torsion.analyses.lateral.couple_response import extent

    def over(of: "Callable[[Answer], FloatArray]") -> list[FloatArray]:
        return [of(one).max(axis=1) for one in shaft.answers]

    curves = [over(lambda one: extent(one.moment)), over(lambda one: extent(one.force))]
    moment, force = (
        scale(unit, [float(v) for one, curve in zip(shaft.answers, every, strict=True) for v in sound(one, curve)])
        for unit, every in zip(("N m", "N"), curves, strict=True)
    )
    values = {
        "speed": [one.speed * RPM for one in shaft.answers],
        "orders": [f"order {one.order}" + ("" if one.order else ", at rest") for one in shaft.answers],
        "panels": [
            ("displacement,\nµm", over(lambda one: MICRO * one.orbit)),
            (f"bending moment,\n{moment.unit}", [moment.factor * one for one in curves[0]]),
            (f"force on a joint\nor support, {force.unit}", [force.factor * one for one in curves[1]]),
        ],
        "near": [one.status == Status.NEAR_SINGULAR for one in shaft.answers],
        "singular": [one.status == Status.SINGULAR for one in shaft.answers],
        "crossings": [
            one.speed * RPM
            for one in shaft.critical
            if one.order in {answer.order for answer in shaft.answers} and inside(one, speed_range(findings))
        ],
        "rated": rated_rpm(findings),
    }
    caption = f"{shaft.name}: largest displacement, bending moment and force by the secondary couples, half ranges"
    return Figure(f"bending-{number + 1}", caption, "bending", values)
