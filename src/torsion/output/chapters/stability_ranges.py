"""Chapter: where small deviations of a train with joints grow: ranges of speed, the map, the tilt of driven shafts."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from torsion.analyses.stability.stability_map import StabilityMap
from torsion.analyses.stability.stability_over_speed import Stability
from torsion.analyses.stability.unstable_ranges import UnstableRange
from torsion.arrays import FloatArray
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, Table, table
from torsion.output.figures import curves_over_speed
from torsion.output.nearest_criticals import of_torsion
from torsion.output.numbers import NONE, RPM, counted, distinct_texts, given_rpm, number, rpm
from torsion.output.reported_values import rated_rpm, reference, tilted, widened
from torsion.rules.stable_motion import mean_speed_words
from torsion.rules.verdict_line import Checks

if TYPE_CHECKING:
    from torsion.analyses.lateral.shaft_bending import ShaftFound
    from torsion.analyses.lateral.tilt_stability import Tilting

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
MOST_VALUES = 13  # of a map, in the table
MOST_NAMED = 6  # modes whose frequency is stated
SMALL = 1e-5  # 1/s: less is the error of few modes and of rounding
BELOW, ABOVE = 0, 1  # the ends of a range
GOES_ON, UNKNOWN = "+", "?"  # beside an end that is no boundary
LEGEND = {GOES_ON: "continues beyond the requested speeds", UNKNOWN: "not computed beyond"}
TILT = (
    "The secondary couple of a joint depends on the tilt of the driven shaft and varies its stiffness at "
    "twice the speed of the driving shaft. Small tilting motions can therefore grow. The model is a rigid "
    "shaft that tilts about the centre of its joint (Zhu and Wang); the driving shaft rotates uniformly with "
    "the mean torque."
)
TILT_ZONES = {"mean couple": "excited by the mean couple", "several": "several resonances together"}


def chapter(findings: Findings) -> Iterator[Block]:
    """Nothing where stability was not requested."""
    found, mapped = findings.get(Stability), findings.get(StabilityMap)
    if found is None and mapped is None:
        return
    yield Heading("Stability")
    if found is not None:
        yield _introduction(findings, found)
        yield _verdict(findings)
        if drift := mean_speed_words(found, findings.study):
            yield Paragraph(_sentence(drift), "note")
        if found.ranges:
            yield _ranges(findings, found)
        if found.unsolved.size:
            yield _unsolved(found)
        yield of_torsion(
            findings,
            curves_over_speed.stability(
                "stability-growth",
                "Growth rate over the speed",
                speed=found.speed * RPM,
                growth=found.growth,
                rated=rated_rpm(findings),
                unstable=[(one.first * RPM, one.last * RPM, one.name) for one in found.ranges],
            ),
        )
    if mapped is not None:
        yield from _map(findings, mapped)


def _sentence(words: str) -> str:
    return words if words.endswith(".") else f"{words}."


def _introduction(findings: Findings, found: Stability) -> Paragraph:
    modes = ", ".join(
        f"w{k} = {number(w)}" for k, w in enumerate(found.modes[:MOST_NAMED].tolist(), start=1)
    )
    checked = (
        f" Monodromy matrix and Hill matrix differ by at most {number(found.check, 2)} 1/s."
        if np.isfinite(found.check)
        else " The second method is too large for this train. The growth rates are from one method."
        if np.isfinite(found.growth).any()
        else " No periodic motion was found at any speed, so that no growth rate is known."
    )
    if found.kept is not None:
        checked += (
            f" The model has {found.kept} of {found.modes.size} elastic modes. With twice as many modes the growth "
            f"rates change by at most {number(found.left_out, 2)} 1/s."
        )
    damps = "" if found.loses else " The train has no damping: the minimum growth is 0."
    return Paragraph(
        f"{MODEL} {counted(int(found.requested.sum()), 'speed')} of {reference(findings)} as requested, "
        f"{int((~found.requested).sum())} more near unstable ranges.{checked}{damps} Elastic modes with straight "
        f"joints: {modes} rad/s{' and higher' if found.modes.size > MOST_NAMED else ''}."
    )


def _verdict(findings: Findings) -> Paragraph:
    check = next(check for check in findings.need(Checks).lines if check.clause == "stability")
    where = (
        "the operation" if findings.study.operation.speeds is not None else "the speeds requested"
    )
    if check.verdict == "pass":
        return Paragraph(f"No deviation grows at any speed in {where}.", "pass")
    if not np.isfinite(check.value):
        return Paragraph(f"Stability is not known at every speed in {where}: {check.note}.", "fail")
    if check.value <= 0:
        return Paragraph(
            f"No unstable range was found, but {where} is not covered completely: {check.note}.",
            "fail",
        )
    fastest = f"{number(check.value, 4)} 1/s at {rpm(check.speed)} rpm"
    return Paragraph(f"The train is unstable in {where}: maximum growth {fastest}.", "fail")


def _ranges(findings: Findings, found: Stability) -> Table:
    speeds, shown = findings.study.operation.speeds, found.ranges[:MOST_ROWS]
    titles = (
        "From [rpm] -> from rpm | To [rpm] -> to rpm | < Type -> | Maximum growth [1/s] -> growth, 1/s | "
        "Speed [rpm] -> at rpm | Factor per revolution | < In the operating range -> operation"
    )
    further = any(_beyond(one) for one in shown)
    rows, present = [], set[str]()
    for one in shown:
        marks = [_mark(one, side) for side in (BELOW, ABOVE)]
        present.update(marks)
        inside = speeds is None or one.meets(speeds.first, speeds.last)
        factor = float(np.exp(min(one.growth * 2.0 * np.pi / one.at, 700.0)))
        rows.append(
            (
                rpm(one.first, 9) + marks[BELOW],
                rpm(one.last, 9) + marks[ABOVE],
                one.name,
                number(one.growth),
                distinct_texts([one.first * RPM, one.at * RPM, one.last * RPM])[1],
                number(factor, 4),
                "UNSTABLE" if inside else "outside",
                *(["; ".join(_beyond(one))] if further else []),
            )
        )
    legend = "; ".join(f"{sign} {text}" for sign, text in LEGEND.items() if sign in present)
    title = f"Unstable ranges of speed{f' ({legend})' if legend else ''}"
    rest = f"; {MOST_ROWS} of {len(found.ranges)}" if len(found.ranges) > MOST_ROWS else ""
    titles += " | < Beyond the range" if further else ""
    verdicts = ["fail" if "UNSTABLE" in row else "note" for row in rows]
    return table(titles, rows, title + rest, marks=verdicts, short=title)


def _mark(one: UnstableRange, side: int) -> str:
    """'+' where the range goes on beyond the speeds requested, '?' where nothing is known beyond; '' of a boundary."""
    if one.unknown[side] is not None:
        return UNKNOWN
    return GOES_ON if one.is_open[side] else ""


def _beyond(one: UnstableRange) -> list[str]:
    """What is said of the ends that are no boundaries, in sentences without their stop."""
    said = []
    for side, (end, way) in enumerate(((one.first, "below"), (one.last, "above"))):
        if (unknown := one.unknown[side]) is not None:
            low, high = sorted((end, unknown))
            said.append(f"{given_rpm(low)} to {given_rpm(high)} rpm not known")
        elif one.is_open[side]:
            said.append(f"continues {way} {given_rpm(end)} rpm (not requested)")
    return said


def restrictions(findings: Findings, found: Stability) -> list[str]:
    """Of the speed: the unstable ranges in words, and where it could not be said whether there is one."""
    requested = float(found.speed[0]), float(found.speed[-1])
    stated = [
        f"Unstable range: {words(one, requested)}. Not for operation." for one in found.ranges
    ]
    if drift := mean_speed_words(found, findings.study):
        stated.append(_sentence(drift))
    nothing = [
        check
        for check in findings.need(Checks).lines
        if check.clause == "stability" and np.isinf(check.value)
    ]
    if nothing:
        return stated + [
            f"Stability of the {check.where} not computed: {check.note}." for check in nothing
        ]
    beside = [one.first for one in found.ranges if one.unknown[BELOW] is not None]
    beside += [one.last for one in found.ranges if one.unknown[ABOVE] is not None]
    return stated + [
        f"No periodic motion was found from {given_rpm(low)} to {given_rpm(high)} rpm; stability is not known there."
        for low, high in found.unknown
        if not any(low <= end <= high for end in beside)
    ]


def tilt_restrictions(findings: Findings) -> list[str]:
    """Of the speed: the unstable ranges of the tilt of every shaft in words, the first of them."""
    stated = []
    for name, tilting in tilted(findings):
        looked_at = float(tilting.speed[0]) * RPM, float(tilting.speed[-1]) * RPM
        for zone in tilting.zones:
            low, high = widened((zone.lower * RPM, zone.upper * RPM), looked_at)
            kind = TILT_ZONES.get(zone.kind, zone.kind)
            further = "; it continues beyond the computed speeds" if any(zone.is_open) else ""
            stated.append(
                f"Unstable range: {low} to {high} rpm, tilt of {name}, {kind}{further}. Not for operation."
            )
    more = len(stated) - MOST_ROWS
    return (
        stated
        if more <= 0
        else [*stated[:MOST_ROWS], f"{more} more unstable ranges of the tilt in the table."]
    )


def words(one: UnstableRange, requested: tuple[float, float]) -> str:
    """The range for a restriction of speed: '772.3 to at least 780 rpm, principal of mode 1; from there ...'.

    Boundaries are rounded so that the range grows, but not beyond the speeds requested (rad/s).
    """
    stated = list(
        widened((one.first * RPM, one.last * RPM), (requested[0] * RPM, requested[1] * RPM))
    )
    for side, (speed, limit) in enumerate(((one.first, "at most"), (one.last, "at least"))):
        if one.grows_at_end[side]:
            stated[side] = given_rpm(speed)
        if one.unknown[side] is not None:
            stated[side] = f"{limit} {stated[side]}"
    band = (
        f"at {given_rpm(one.first)} rpm"
        if one.last <= one.first
        else f"{stated[BELOW]} to {stated[ABOVE]} rpm"
    )
    return "; ".join([f"{band}, {one.name}", *_beyond(one)])


def _unsolved(found: Stability) -> Table:
    stated = distinct_texts((found.unsolved[:MOST_ROWS] * RPM).tolist())
    rest = f"; {MOST_ROWS} of {found.unsolved.size}" if found.unsolved.size > MOST_ROWS else ""
    rows = [(speed, "no periodic motion was found; stability is not known") for speed in stated]
    caption = f"Speeds without a solution{rest}"
    return table("Speed [rpm] | < Remark", rows, caption, marks=["fail"] * len(rows))


def _map(findings: Findings, found: StabilityMap) -> Iterator[Block]:
    what, unit = OVER[found.over]
    missing = int(np.isnan(found.growth).sum())
    text = (
        f"Growth over speed and {what}, on {found.modes} of {found.of_modes} elastic modes. At "
        f"{counted(found.checked, 'point')} the full model was also computed: maximum difference "
        f"{number(found.error, 2)} 1/s.{_missed(findings, found)}"
    )
    if found.elsewhere:
        text += f" At {counted(found.elsewhere, 'point')} it settled in another periodic motion."
    if missing:
        text += f" At {missing} of {found.growth.size} points no periodic motion was found; they are hatched."
    value = np.degrees(found.value) if found.over == "angle" else found.value
    yield Heading(f"Map over speed and {what}", 2)
    yield Paragraph(text, "note" if missing else "plain")
    yield _values(found, f"{what.capitalize()} [{unit}]", value)
    yield curves_over_speed.stability_map(
        "stability-map",
        f"Growth rate over speed and {what}; the line is growth 0",
        speed=found.speed * RPM,
        value=value,
        growth=found.growth,
        quantity=what,
        unit=unit,
        rated=rated_rpm(findings),
    )


def _missed(findings: Findings, found: StabilityMap) -> str:
    """That unstable ranges lie between the speeds of the map."""
    ranges = () if findings.get(Stability) is None else findings.need(Stability).ranges
    missed = sum(
        not np.any((found.speed >= one.first) & (found.speed <= one.last)) for one in ranges
    )
    if not missed:
        return ""
    which = "the" if len(ranges) == 1 else f"{missed} of the {len(ranges)}"
    return (
        f" The map has {counted(found.speed.size, 'speed')} only. It does not show {which} unstable "
        f"{'range' if len(ranges) == 1 else 'ranges'} above that {'lies' if missed == 1 else 'lie'} between them."
    )


def _values(found: StabilityMap, title: str, value: FloatArray) -> Table:
    """The fastest growth at values spread over the map."""
    rows, marks = [], []
    for k in np.unique(np.linspace(0, len(value) - 1, MOST_VALUES).round().astype(int)).tolist():
        growth = found.growth[:, k]
        known = np.isfinite(growth)
        unknown = 100.0 * float((~known).mean())
        if not known.any():
            rows.append(
                (
                    number(float(value[k])),
                    NONE,
                    NONE,
                    NONE,
                    number(unknown, 3),
                    "no periodic motion",
                )
            )
            marks.append("fail")
            continue
        at = int(np.nanargmax(growth))
        grows = growth[known] > SMALL
        where = (
            f"{known.sum()} of {known.size} speeds"
            if unknown
            else f"the {counted(known.size, 'speed')} of the map"
        )
        verdict = ("UNSTABLE" if grows.any() else f"stable at {where}") + (
            ", partly unknown" if unknown else ""
        )
        rows.append(
            (
                number(float(value[k]), 4),
                number(float(growth[at]), 4),
                rpm(float(found.speed[at])),
                number(100.0 * float(grows.mean()), 3),
                number(unknown, 3),
                verdict,
            )
        )
        marks.append("fail" if grows.any() or unknown else "")
    columns = "| Maximum growth [1/s] | Speed [rpm] | Unstable speeds [%] | Unknown speeds [%] | < "
    return table(f"{title} {columns}", rows, "Maximum growth in the map, by value", marks=marks)


def tilt_section(findings: Findings, shafts: "tuple[ShaftFound, ...]") -> Iterator[Block]:
    """Parametric stability of the tilt of driven shafts on bearings; nothing where none tilts on supports."""
    stated = [(shaft.name, shaft.tilting) for shaft in shafts if shaft.tilting is not None]
    if not stated:
        return
    yield Heading("Parametric stability of the tilt", 2)
    yield Paragraph(TILT)
    yield table(
        "< Shaft | < Driven by | Transverse inertia [kg m²] | Polar inertia [kg m²] | Frequency of the tilt, y [Hz] | "
        "z [Hz] | Decay rate, y [1/s] | z [1/s]",
        [
            (
                name,
                tilting.joint,
                tilting.shaft.inertia,
                tilting.shaft.polar * tilting.shaft.inertia,
                *tilting.frequency.values(),
                *(rate / 2.0 for rate in tilting.shaft.decay[::-1]),
            )
            for name, tilting in stated
        ],
        "Rigid shafts that tilt about the centre of their joint; at rest, without torque",
    )
    for check in findings.need(Checks).lines:
        if check.clause == "tilting":
            note = f" ({check.note})" if check.note else ""
            at = f"{number(check.value, 4)} 1/s at {rpm(check.speed)} rpm"
            if check.value > 0:
                yield Paragraph(
                    f"{check.where} is unstable: its tilt grows by up to {at}{note}.", "fail"
                )
            else:
                text = f"No tilting motion of {check.where} grows at the computed speeds{note}."
                yield Paragraph(text, "fail" if check.fails else "pass")
    if any(tilting.zones for _, tilting in stated):
        yield _tilt_zones(findings, stated)
    for count, (name, tilting) in enumerate(stated, start=1):
        caption = f"{name}: growth rate of the tilt by the couple of {tilting.joint}"
        yield curves_over_speed.stability(
            f"tilting-{count}",
            caption,
            speed=tilting.speed * RPM,
            growth=np.asarray(tilting.growth),
            rated=rated_rpm(findings),
            unstable=[(zone.lower * RPM, zone.upper * RPM, zone.kind) for zone in tilting.zones],
        )


def _tilt_zones(findings: Findings, stated: "list[tuple[str, Tilting]]") -> Table:
    speeds, rows = findings.study.operation.speeds, []
    for name, tilting in stated:
        for zone in tilting.zones:
            low, worst, up = zone.lower, zone.worst, zone.upper
            inside = speeds is None or (low < speeds.last and up > speeds.first)
            ends = [
                rpm(w, 9) + (" (open)" if zone.is_open[side] else "")
                for side, w in enumerate((low, up))
            ]
            kind = TILT_ZONES.get(zone.kind, zone.kind)
            rows.append(
                (
                    name,
                    *ends,
                    kind,
                    number(zone.rate),
                    rpm(worst),
                    "UNSTABLE" if inside else "outside",
                )
            )
    return table(
        "< Shaft | From [rpm] | To [rpm] | < Type | Maximum growth [1/s] | Speed [rpm] | < In the operating range",
        rows,
        "Unstable ranges of the tilt (open: the range continues beyond the computed speeds)",
        marks=["fail" if "UNSTABLE" in row else "note" for row in rows],
    )
