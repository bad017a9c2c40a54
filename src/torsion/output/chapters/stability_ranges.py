"""Chapter: stability of a train with joints: growth of small deviations, unstable ranges, and the map."""

import numpy as np

from torsion.analyses.motion.stability_map import StabilityMap
from torsion.analyses.motion.stability_over_speed import Stability
from torsion.findings import Findings
from torsion.output.blocks import Block, Column, Figure, Heading, Paragraph, Table, head, texts
from torsion.output.chapters.unstable_ranges import ABOVE, BELOW, beyond, end, fastest, legend
from torsion.output.numbers import NONE, RPM, counted, distinct_texts, number, rpm
from torsion.output.reported_values import rated_rpm, reference
from torsion.rules.verdict_line import Checks

MODEL = (
    "A joint makes the stiffness of the train vary with the angle. About the periodic motion that the joints and the "
    "mean torque leave, small deviations grow or die out as exp(growth · t); the train is unstable where they grow, "
    "whatever excites it. Vibratory torques are left out."
)
OVER = {
    "angle": ("joint angle", "deg"), "damping": ("factor on the damping", ""),
    "torque": ("factor on the mean torque", ""),
}  # fmt: skip
MOST_ROWS = 30
MOST_VALUES = 13  # of a map, in the table
SMALL = 1e-5  # 1/s: less is the error of few modes and of rounding


def chapter(findings: Findings) -> list[Block]:
    """Nothing where stability was not requested."""
    found, mapped = findings.get(Stability), findings.get(StabilityMap)
    if found is None:
        return [] if mapped is None else [Heading("Stability"), *_map(findings, mapped)]
    blocks: list[Block] = [Heading("Stability"), _introduction(findings, found), _verdict(findings, found)]
    if found.ranges:
        blocks.append(_ranges(findings, found))
    if found.unsolved.size:
        blocks.append(_unsolved(found))
    blocks.append(_figure(findings, found))
    if mapped is not None:
        blocks += _map(findings, mapped)
    return blocks


def _introduction(findings: Findings, found: "Stability") -> Paragraph:
    modes = ", ".join(f"w{k} = {number(w)}" for k, w in enumerate(found.modes[:6].tolist(), start=1))
    checked = (
        f" Where both were used, monodromy and Hill's matrix differ by at most {number(found.check, 2)} 1/s."
        if np.isfinite(found.check)
        else " The second method was too large for this train: the growth rates stand unchecked."
        if np.isfinite(found.growth).any()
        else " No periodic motion was found at any of them, so that no growth rate is known."
    )
    if found.kept is not None:
        checked += (
            f" The train is reduced to {found.kept} of {found.modes.size} elastic modes; with twice as many the growth "
            f"rates change by at most {number(found.left_out, 2)} 1/s where that was tried."
        )
    damps = "" if found.loses else " Nothing in the train damps: a growth of 0 is the best there is."
    text = (
        f"{MODEL} {counted(int(found.requested.sum()), 'speed')} of {reference(findings)} as requested, "
        f"{int((~found.requested).sum())} more in and around zones.{checked}{damps} "
        f"Elastic modes with straight joints: {modes} rad/s{' and higher' if found.modes.size > 6 else ''}."
    )
    return Paragraph(text)


def _verdict(findings: Findings, found: "Stability") -> Paragraph:
    check = next(check for check in findings.need(Checks).lines if check.clause == "stability")
    where = "the operation" if findings.study.operation.speeds is not None else "the speeds requested"
    if check.verdict == "pass":
        return Paragraph(f"No deviation grows at any speed of {where}.", "pass")
    if not np.isfinite(check.value):
        return Paragraph(f"Stability cannot be stated at every speed of {where}: {check.note}.", "fail")
    if check.value <= 0:
        return Paragraph(f"No unstable range was found, but the answer for {where} is not whole: {check.note}.", "fail")
    return Paragraph(
        f"The train is unstable within {where}: the fastest growth "
        f"{number(check.value, 4)} 1/s at {rpm(check.speed)} rpm.", "fail"
    )  # fmt: skip


def _ranges(findings: Findings, found: "Stability") -> Table:
    speeds = findings.study.operation.speeds
    columns: tuple[Column, ...] = head(
        "From [rpm] -> from rpm | To [rpm] -> to rpm | < Type -> | Largest growth [1/s] -> growth, 1/s | "
        "At speed [rpm] -> at rpm | Factor per revolution | < Within the operation -> operation"
    )
    shown = found.ranges[:MOST_ROWS]
    further = any(beyond(one) for one in shown)
    if further:
        columns += (texts("Beyond its ends"),)
    rows, marks = [], []
    for one in shown:
        inside = speeds is None or one.meets(speeds.first, speeds.last)
        factor = float(np.exp(min(one.growth * 2.0 * np.pi / one.at, 700.0)))
        rows.append((
            end(one, BELOW, 9), end(one, ABOVE, 9), one.name, number(one.growth), fastest(one),
            number(factor, 4), "UNSTABLE" if inside else "outside", *(["; ".join(beyond(one))] if further else []),
        ))  # fmt: skip
        marks.append("fail" if inside else "note")
    rest = f"; {MOST_ROWS} of {len(found.ranges)}" if len(found.ranges) > MOST_ROWS else ""
    title = f"Unstable ranges of speed{legend(shown)}"
    return Table(columns, tuple(rows), title + rest, tuple(marks), title)


def _unsolved(found: "Stability") -> Table:
    speeds = found.unsolved[:MOST_ROWS].tolist()
    rest = f"; {MOST_ROWS} of {found.unsolved.size}" if found.unsolved.size > MOST_ROWS else ""
    stated = distinct_texts([speed * RPM for speed in speeds])
    rows = tuple((speed, "no periodic motion was found: nothing can be said of its stability") for speed in stated)
    columns = head("Speed [rpm] | < Remark")
    return Table(columns, rows, f"Speeds without an answer{rest}", ("fail",) * len(rows))


def _figure(findings: Findings, found: "Stability") -> Figure:
    values = {
        "speed": found.speed * RPM, "growth": found.growth, "rated": rated_rpm(findings),
        "unstable": [(one.first * RPM, one.last * RPM, one.name) for one in found.ranges],
    }  # fmt: skip
    return Figure("stability-growth", "Growth rate of small deviations over the speed", "stability", values)


def _map(findings: Findings, found: "StabilityMap") -> list[Block]:
    what, unit = OVER[found.over]
    missing = int(np.isnan(found.growth).sum())
    text = (
        f"Growth over speed and {what}, on {found.modes} of {found.of_modes} elastic modes. At "
        f"{counted(found.checked, 'point')} the whole train was computed too: largest difference "
        f"{number(found.error, 2)} 1/s.{_missed(findings, found)}"
    )
    if found.elsewhere:
        text += f" At {counted(found.elsewhere, 'point')} it settled in another periodic motion."
    if missing:
        text += f" At {missing} of {found.growth.size} points no periodic motion was found; they are hatched."
    value = np.degrees(found.value) if found.over == "angle" else found.value
    drawn = {
        "speed": found.speed * RPM, "value": value, "growth": found.growth,
        "quantity": f"{what}, {unit}" if unit else what, "rated": rated_rpm(findings),
    }  # fmt: skip
    return [
        Heading(f"Map over speed and {what}", 2), Paragraph(text, "note" if missing else "plain"),
        _values(found, what, unit, value),
        Figure("stability-map", f"Growth rate over speed and {what}; the line: growth 0", "stability map", drawn),
    ]  # fmt: skip


def _missed(findings: Findings, found: "StabilityMap") -> str:
    """That unstable ranges lie between the speeds of the map."""
    ranges = () if findings.get(Stability) is None else findings.need(Stability).ranges
    missed = sum(not np.any((found.speed >= one.first) & (found.speed <= one.last)) for one in ranges)
    if not missed:
        return ""
    which = "the" if len(ranges) == 1 else f"{missed} of the {len(ranges)}"
    return (
        f" The map knows its {counted(found.speed.size, 'speed')} alone: {which} unstable "
        f"{'range' if len(ranges) == 1 else 'ranges'} above {'lies' if missed == 1 else 'lie'} between them and "
        "cannot be seen in it."
    )


def _values(found: "StabilityMap", what: str, unit: str, value: np.ndarray) -> Table:
    """The fastest growth at values spread over the map."""
    columns = head(
        f"{what.capitalize()} [{unit}] | Largest growth [1/s] | At speed [rpm] | Speeds unstable [%] | "
        "Without an answer [%] | < "
    )
    rows, marks = [], []
    for k in np.unique(np.linspace(0, len(value) - 1, MOST_VALUES).round().astype(int)).tolist():
        growth = found.growth[:, k]
        known = np.isfinite(growth)
        unknown = 100.0 * float((~known).mean())
        if not known.any():
            rows.append((number(float(value[k])), NONE, NONE, NONE, number(unknown, 3), "no periodic motion"))
            marks.append("fail")
            continue
        at = int(np.argmax(np.where(known, growth, -np.inf)))
        grows = growth[known] > SMALL
        where = f"{known.sum()} of {known.size} speeds" if unknown else f"the {counted(known.size, 'speed')} of the map"
        words = ("UNSTABLE" if grows.any() else f"stable at {where}") + (", in part unknown" if unknown else "")
        rows.append((number(float(value[k]), 4), number(float(growth[at]), 4), rpm(float(found.speed[at])),
                     number(100.0 * float(grows.mean()), 3), number(unknown, 3), words))  # fmt: skip
        marks.append("fail" if grows.any() or unknown else "")
    return Table(columns, tuple(rows), "Fastest growth of the map, by value", tuple(marks))
