"""Chapter: bands of the natural frequencies over the tolerances, which figure matters, and what each coupling does."""

from collections.abc import Iterator

from torsion.analyses.critical import CriticalSpeeds
from torsion.analyses.modes.tolerances import CouplingReach, Tolerances
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, table
from torsion.output.numbers import given_rpm, number, order, rpm
from torsion.output.reported_values import reference

MOST_ROWS = 60
MOST_FIGURES = 6  # of a mode
WHAT = (
    "Every natural frequency rises with every stiffness and falls with every inertia. The bounds therefore "
    "follow from all stiffnesses low with all inertias high, and the reverse. Sturm counts prove them for "
    "every combination within the tolerances. Torque, stress and heat are not monotonic: they are for the "
    "nominal values, and the cases of the tolerances (cases: {from: tolerances}) give both ends of the "
    "couplings."
)
MATTERS = (
    "The dominant parameter of each mode is first. The sensitivity is the relative change of the frequency "
    "over the relative change of the parameter: half the elastic energy share of a stiffness, minus half the "
    "kinetic energy share of an inertia. Sensitivity times tolerance is the change of the mode to first "
    "order."
)
ALONE = (
    "One coupling changes at a time, with the nominal values of the others. The coupling with the largest "
    "effect is first. The limits are the train without the coupling and with a rigid coupling."
)


def chapter(findings: Findings) -> Iterator[Block]:
    """Bands where a coupling has a tolerance, aims where the file states them."""
    found = findings.need(Tolerances)
    yield Heading("Tolerances")
    if findings.study.has_tolerances:
        yield Paragraph(WHAT)
        rows = [
            (
                mode,
                number(f, 7),
                number(low, 7),
                number(high, 7),
                number(100.0 * (low / f - 1.0), 3),
                number(100.0 * (high / f - 1.0), 3),
            )
            for mode, (f, low, high) in enumerate(
                zip(found.frequency, found.lower, found.upper, strict=True), start=1
            )
        ]
        titles = "Mode -> | Frequency [Hz] -> Hz | Minimum [Hz] -> minimum | Maximum [Hz] -> maximum | Down [%] | Up [%]"
        yield table(
            titles,
            rows,
            "Natural frequencies within the tolerances",
            short="Frequencies within the tolerances",
        )
        yield from _matters(found)
        yield from _criticals(findings, found)
    yield from _alone(found)
    if found.aims:
        yield _aims(found)


def _matters(found: Tolerances) -> Iterator[Block]:
    """Figures by what their tolerances do to each mode."""
    if not found.figures:
        return
    yield Paragraph(MATTERS)
    rows = [
        (
            mode + 1,
            one.figure,
            number(100.0 * one.tolerance, 3),
            number(float(one.sensitivity[mode]), 3),
            number(100.0 * float(one.change[mode]), 3),
        )
        for mode in range(found.frequency.size)
        for one in sorted(found.figures, key=lambda one: -float(one.change[mode]))[:MOST_FIGURES]
    ]
    titles = (
        "Mode -> | < Parameter -> | Tolerance [%] | Sensitivity | Change of the mode, ± [%] -> ± %"
    )
    rest = f" (the first {MOST_FIGURES} of {len(found.figures)} of each mode)" * (
        len(found.figures) > MOST_FIGURES
    )
    yield table(titles, rows[:MOST_ROWS], f"Dominant parameters{rest}", short="Dominant parameters")


def _criticals(findings: Findings, found: Tolerances) -> Iterator[Block]:
    """Critical speeds that can lie in the speed range."""
    speeds, critical = findings.study.operation.speeds, findings.get(CriticalSpeeds)
    if speeds is None or critical is None or not found.critical_lower.size:
        return
    bands = zip(
        critical.crossings,
        found.critical_lower.tolist(),
        found.critical_upper.tolist(),
        strict=True,
    )
    met = [one for one in bands if one[1] <= speeds.last and one[2] >= speeds.first]
    rows: list[tuple[object, ...]] = [
        (
            rpm(low),
            rpm(c.speed),
            rpm(high),
            order(c.order),
            c.mode,
            c.line.named(reference(findings)),
            "" if c.is_inside else "only within the tolerances",
        )
        for c, low, high in met[:MOST_ROWS]
    ]
    within = f"{given_rpm(speeds.first)} to {given_rpm(speeds.last)} rpm"
    if not rows:
        yield Paragraph(f"Within the tolerances the speed range {within} has no critical speed.")
        return
    titles = "Minimum [rpm] | Critical speed [rpm] | Maximum [rpm] | Order | Mode | < Excited by | < In the range"
    if all(c.is_inside for c, *_ in met):
        rows, titles = [row[:-1] for row in rows], titles.rpartition(" | ")[0]
    rest = f" (the lowest {MOST_ROWS} of {len(met)})" if len(met) > MOST_ROWS else ""
    yield table(
        titles,
        rows,
        f"Critical speeds that can lie in the speed range {within} within the tolerances{rest}",
    )


def _alone(found: Tolerances) -> Iterator[Block]:
    """What each coupling does alone, mode by mode, the one that does most first."""
    if not found.couplings:
        return
    yield Paragraph(ALONE)
    rows = []
    for mode, frequency in enumerate(found.frequency.tolist()):

        def width(one: CouplingReach, at: int = mode) -> tuple[float, float]:
            return float(one.upper[at] - one.lower[at]), float(one.stiffest[at] - one.softest[at])

        for one in sorted(found.couplings, key=width, reverse=True):
            ends = (one.lower, one.upper) if one.tolerance else ()
            rows.append(
                (
                    mode + 1,
                    one.coupling,
                    number(100.0 * one.tolerance, 3) if one.tolerance else None,
                    *([number(float(end[mode]), 7) for end in ends] or (None, None)),
                    number(100.0 * width(one)[0] / frequency, 3) if one.tolerance else None,
                    number(float(one.softest[mode]), 7),
                    number(float(one.stiffest[mode]), 7),
                )
            )
    yield table(
        "Mode | < Coupling | Tolerance [%] | Soft [Hz] | Stiff [Hz] | Change [%] | Without it [Hz] | Rigid [Hz]",
        rows[:MOST_ROWS],
        "Effect of each coupling on each mode",
    )


def _aims(found: Tolerances) -> Block:
    """The stiffness of each coupling with which a mode is where it should be."""
    rows = [
        (
            one.mode,
            number(one.frequency, 7),
            one.coupling,
            None if one.stiffness is None else number(one.stiffness, 7),
            None if one.factor is None else number(one.factor, 5),
            "no stiffness reaches it" if one.stiffness is None else "",
            number(one.softest, 7),
            number(one.stiffest, 7),
        )
        for one in found.aims
    ]
    return table(
        "Mode -> | Target frequency [Hz] -> target, Hz | < Coupling -> | Required stiffness [N m/rad] -> k | "
        "Required / nominal stiffness -> k / nominal | < Remark -> | Without it [Hz] | Rigid [Hz]",
        rows,
        "Stiffness for a target frequency",
        short="Stiffness for a target frequency",
    )
