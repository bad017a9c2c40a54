"""Chapter: where small deviations of a train with joints grow: ranges of speed, the map, the tilt of driven shafts."""

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from torsion.analyses.stability.stability_over_speed import Stability, StabilityMap
from torsion.arrays import FloatArray
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, Table, table
from torsion.output.figures import curves
from torsion.output.figures.figure import Axis
from torsion.output.numbers import RPM, counted, given_rpm, number, rpm
from torsion.output.reported_values import of_torsion, rated_rpm, tilted, widened
from torsion.rules.stable_motion import mean_speed_words
from torsion.rules.verdict_line import Checks

if TYPE_CHECKING:
    from torsion.analyses.lateral.shaft_bending import ShaftFound
    from torsion.analyses.lateral.tilt_stability import TiltRange
    from torsion.analyses.stability.unstable_ranges import UnstableRange

    Unstable = UnstableRange | TiltRange

MODEL = (
    "A joint makes the stiffness of the train vary with the angle (parametric excitation). Small deviations "
    "from the periodic motion grow or decay as exp(growth · t). The train is unstable if a deviation grows. "
    "Vibratory torques are not included. A drift of the mean speed of the whole train is reported separately "
    "and is not an instability."
)
OVER = {
    "angle": ("joint angle", "deg"),
    "damping": ("factor on the damping", ""),
    "torque": ("factor on the mean torque", ""),
}
MOST_ROWS = 30
MOST_NAMED = 6  # modes whose frequency is stated
SMALL = 1e-5  # 1/s: less is the error of few modes and of rounding
BELOW, ABOVE = 0, 1  # the ends of a range
TILT = (
    "The secondary couple of a joint depends on the tilt of the driven shaft and varies its stiffness at "
    "twice the speed of the driving shaft. Small tilting motions can therefore grow. The model is a rigid "
    "shaft that tilts about the centre of its joint (Zhu and Wang); the driving shaft rotates uniformly with "
    "the mean torque."
)


def chapter(findings: Findings) -> Iterator[Block]:
    """Nothing where stability was not requested."""
    growth_map, mapped = findings.get(Stability), findings.get(StabilityMap)
    if growth_map is None and mapped is None:
        return
    yield Heading("Stability")
    if growth_map is not None:
        yield _introduction(findings, growth_map)
        check = next(line for line in findings.need(Checks).lines if line.clause == "stability")
        has_range = findings.study.operation.speeds is not None
        speeds = "the operation" if has_range else "the speeds requested"
        if check.verdict == "pass":
            text = f"No deviation grows at any speed in {speeds}."
        elif not np.isfinite(check.value):
            text = f"Stability is not known at every speed in {speeds}: {check.note}."
        elif check.value <= 0:
            text = f"No unstable range was found, but {speeds} is not covered completely: {check.note}."
        else:
            fastest = f"{number(check.value, 4)} 1/s at {rpm(check.speed)} rpm"
            text = f"The train is unstable in {speeds}: maximum growth {fastest}."
        yield Paragraph(text, "pass" if check.verdict == "pass" else "fail")
        if drift := mean_speed_words(growth_map, findings.study):
            yield Paragraph(f"{drift.removesuffix('.')}.", "note")
        if growth_map.ranges:
            rows = [("", band) for band in growth_map.ranges]
            yield _range_table(findings, rows, caption := "Unstable ranges of speed", caption)
        if unsolved := growth_map.unsolved.size:
            text = f"No periodic motion was found at {counted(unsolved, 'speed')}; stability is not known there."
            yield Paragraph(text, "fail")
        name, caption = "stability-growth", "Growth rate over the speed"
        curve = growth_map.speed, growth_map.growth
        figure = curves.stability(name, caption, *curve, growth_map.ranges, rated_rpm(findings))
        yield of_torsion(findings, figure)
    if mapped is not None:
        yield from _map(findings, mapped)


def _introduction(findings: Findings, stability: Stability) -> Paragraph:
    modes = ", ".join(
        f"w{k} = {number(w)}" for k, w in enumerate(stability.modes[:MOST_NAMED].tolist(), start=1)
    )
    checked = (
        f" Monodromy matrix and Hill matrix differ by at most {number(stability.check, 2)} 1/s."
        if np.isfinite(stability.check)
        else " The second method is too large for this train. The growth rates are from one method."
        if np.isfinite(stability.growth).any()
        else " No periodic motion was found at any speed, so that no growth rate is known."
    )
    if stability.kept is not None:
        checked += (
            f" The model has {stability.kept} of {stability.modes.size} elastic modes. With twice as many modes the growth "
            f"rates change by at most {number(stability.left_out, 2)} 1/s."
        )
    damps = "" if stability.loses else " The train has no damping: the minimum growth is 0."
    return Paragraph(
        f"{MODEL} {counted(int(stability.requested.sum()), 'speed')} of {findings.study.reference} as requested, "
        f"{int((~stability.requested).sum())} more near unstable ranges.{checked}{damps} Elastic modes with straight "
        f"joints: {modes} rad/s{' and higher' if stability.modes.size > MOST_NAMED else ''}."
    )


def _range_table(
    findings: Findings, ranges: "Sequence[tuple[str, Unstable]]", caption: str, short: str = ""
) -> Table:
    """Return unstable ranges of the train, or of the tilt of shafts, by whose name they stand."""
    speeds, words_of_place = findings.study.operation.speeds, {True: "UNSTABLE", False: "outside"}
    inside = [speeds is None or band.meets(speeds.first, speeds.last) for _, band in ranges]
    return table(
        "< Shaft:? | first: From [rpm]:9 -> from rpm | last: To [rpm]:9 -> to rpm | < Type -> | "
        "growth: Maximum growth [1/s] -> growth, 1/s | at: Speed [rpm]:7 -> at rpm | "
        "< In the operating range -> operation | < Beyond the range:? ->",
        [
            (band, name, band.name, words_of_place[is_inside], "; ".join(_beyond(band)) or None)
            for (name, band), is_inside in zip(ranges, inside, strict=True)
        ],
        caption,
        marks=["fail" if is_inside else "note" for is_inside in inside],
        most=MOST_ROWS,
        short=short,
    )


def _beyond(band: "Unstable") -> list[str]:
    """What is said of the ends that are no boundaries, in sentences without their stop."""
    sentences = []
    for side, (end, way) in enumerate(((band.first, "below"), (band.last, "above"))):
        if (limit := band.unknown[side]) is not None:
            low, high = sorted((end, limit))
            sentences.append(f"{given_rpm(low)} to {given_rpm(high)} rpm not known")
        elif band.is_open[side]:
            sentences.append(f"continues {way} {given_rpm(end)} rpm (not requested)")
    return sentences


def restrictions(findings: Findings, stability: Stability) -> list[str]:
    """Return restrictions of the speed: the unstable ranges, and where it could not be said whether there is one."""
    stated = [_restriction(band, stability.speed) for band in stability.ranges]
    if drift := mean_speed_words(stability, findings.study):
        stated.append(f"{drift.removesuffix('.')}.")
    nothing = [
        f"Stability of the {check.where} not computed: {check.note}."
        for check in findings.need(Checks).lines
        if check.clause == "stability" and np.isinf(check.value)
    ]
    ends = [band.first for band in stability.ranges if band.unknown[BELOW] is not None]
    ends += [band.last for band in stability.ranges if band.unknown[ABOVE] is not None]
    return stated + (
        nothing
        or [
            f"No periodic motion was found from {given_rpm(low)} to {given_rpm(high)} rpm; stability is not known "
            "there."
            for low, high in stability.unknown
            if not any(low <= end <= high for end in ends)
        ]
    )


def tilt_restrictions(findings: Findings) -> list[str]:
    """Return restrictions of the speed: the unstable ranges of the tilt of every shaft, the first of them."""
    stated = [
        _restriction(band, tilting.speed, f"tilt of {name}, ")
        for name, tilting in tilted(findings)
        for band in tilting.zones
    ]
    number = len(stated) - MOST_ROWS
    remainder = [f"{number} more unstable ranges of the tilt in the table."] if number > 0 else []
    return stated[:MOST_ROWS] + remainder


def _restriction(band: "Unstable", speeds: FloatArray, subject: str = "") -> str:
    requested = float(speeds[0]), float(speeds[-1])
    return f"Unstable range: {words(band, requested, subject)}. Not for operation."


def words(band: "Unstable", requested: tuple[float, float], subject: str = "") -> str:
    """Return a range for a restriction of speed: '772.3 to at least 780 rpm, principal of mode 1; from there ...'.

    Boundaries are rounded so that the range grows, but not beyond the speeds requested (rad/s).
    """
    first, last = requested
    stated = list(widened((band.first * RPM, band.last * RPM), (first * RPM, last * RPM)))
    for side, (speed, limit) in enumerate(((band.first, "at most"), (band.last, "at least"))):
        if band.unknown[side] is not None:
            stated[side] = f"{limit} {given_rpm(speed)}"
        elif band.is_open[side]:
            stated[side] = given_rpm(speed)
    ends = f"{stated[BELOW]} to {stated[ABOVE]} rpm"
    if band.last <= band.first:
        ends = f"at {given_rpm(band.first)} rpm"
    return "; ".join([f"{ends}, {subject}{band.name}", *_beyond(band)])


def _map(findings: Findings, growth_map: StabilityMap) -> Iterator[Block]:
    what, unit = OVER[growth_map.over]
    missing = int(np.isnan(growth_map.growth).sum())
    text = (
        f"Growth over speed and {what}, on {growth_map.modes} of {growth_map.of_modes} elastic modes. At "
        f"{counted(growth_map.checked, 'point')} the full model was also computed: maximum difference "
        f"{number(growth_map.error, 2)} 1/s."
    )
    grows = np.any(growth_map.growth > SMALL, axis=0)
    text += f" Small deviations grow at {int(grows.sum())} of {grows.size} values of the {what}."
    ranges = () if findings.get(Stability) is None else findings.need(Stability).ranges
    missed = sum(
        not np.any((growth_map.speed >= band.first) & (growth_map.speed <= band.last))
        for band in ranges
    )
    if missed:
        text += (
            f" The map has {counted(growth_map.speed.size, 'speed')} only. It does not show {missed} of the "
            f"{counted(len(ranges), 'unstable range')} above, between its speeds."
        )
    if growth_map.elsewhere:
        text += (
            f" At {counted(growth_map.elsewhere, 'point')} it settled in another periodic motion."
        )
    if missing:
        text += f" At {missing} of {growth_map.growth.size} points no periodic motion was found; they are hatched."
    value = np.degrees(growth_map.value) if growth_map.over == "angle" else growth_map.value
    yield Heading(f"Map over speed and {what}", 2)
    yield Paragraph(text, "note" if missing else "plain")
    caption = f"Growth rate over speed and {what}; the line is growth 0"
    axis, rated = Axis(what, unit), rated_rpm(findings)
    yield curves.stability_map(caption, growth_map.speed, axis, value, growth_map.growth, rated)


def tilt_section(findings: Findings, shafts: "tuple[ShaftFound, ...]") -> Iterator[Block]:
    """Parametric stability of the tilt of driven shafts on bearings; nothing where none tilts on supports."""
    stated = [(shaft.name, shaft.tilting) for shaft in shafts if shaft.tilting is not None]
    if not stated:
        return
    yield Heading("Parametric stability of the tilt", 2)
    yield Paragraph(TILT)
    yield table(
        "< Shaft | joint: < Driven by | transverse_inertia: Transverse inertia | polar_inertia: Polar inertia | "
        "frequency@y: Frequency of the tilt, y [Hz] | frequency@z: z [Hz] | decay_rate@1: Decay rate, y [1/s] | "
        "decay_rate@2: z [1/s]",
        [(tilting, name) for name, tilting in stated],
        "Rigid shafts that tilt about the centre of their joint; at rest, without torque",
    )
    for check in findings.need(Checks).lines:
        if check.clause == "tilting":
            note = f" ({check.note})" if check.note else ""
            text = f"No tilting motion of {check.where} grows at the computed speeds{note}."
            if check.value > 0:
                fastest = f"{number(check.value, 4)} 1/s at {rpm(check.speed)} rpm"
                text = f"{check.where} is unstable: its tilt grows by up to {fastest}{note}."
            yield Paragraph(text, "fail" if check.value > 0 or check.fails else "pass")
    if bands := [(name, band) for name, tilting in stated for band in tilting.zones]:
        yield _range_table(findings, bands, "Unstable ranges of the tilt")
    for count, (name, tilting) in enumerate(stated, start=1):
        caption = f"{name}: growth rate of the tilt by the couple of {tilting.joint}"
        curve, rated = (tilting.speed, tilting.growth), rated_rpm(findings)
        yield curves.stability(f"tilting-{count}", caption, *curve, tilting.zones, rated)
