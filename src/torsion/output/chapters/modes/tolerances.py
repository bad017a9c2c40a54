"""Chapter: bands of the natural frequencies over the tolerances, which figure matters, and what each coupling does."""

from collections.abc import Iterator

import numpy as np

from torsion.analyses.critical import CriticalSpeeds
from torsion.analyses.modes.tolerances import Tolerances
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, table
from torsion.output.records import along
from torsion.output.reported_values import speed_range

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
    """Yield bands if a component has a tolerance, and target stiffnesses if the file states targets."""
    tolerances = findings.need(Tolerances)
    yield Heading("Tolerances")
    if findings.study.has_tolerances:
        yield Paragraph(WHAT)
        yield table(
            "mode: Mode -> | frequency: Frequency:7 -> Hz | lower: Minimum:7 -> minimum | "
            "upper: Maximum:7 -> maximum | down: Down [%]:3 | up: Up [%]:3",
            along(tolerances, "mode"),
            "Natural frequencies within the tolerances",
            short="Frequencies within the tolerances",
        )
        if tolerances.figures:
            yield Paragraph(MATTERS)
            rows, count = [], len(tolerances.figures)
            for mode in range(tolerances.frequency.size):  # the largest change first
                changes = [-float(figure.change[mode]) for figure in tolerances.figures]
                for k in np.argsort(changes, kind="stable")[:MOST_FIGURES].tolist():
                    rows += along(tolerances.figures[k], "mode", [mode])
            extent = f" (the first {MOST_FIGURES} of {count} of each mode)"
            yield table(
                "mode: Mode -> | figure: < Parameter -> | tolerance: Tolerance [%]:3 | sensitivity: Sensitivity:3 | "
                "change: Change of the mode, ± [%]:3 -> ± %",
                rows[:MOST_ROWS],
                "Dominant parameters" + extent * (count > MOST_FIGURES),
                short="Dominant parameters",
            )
        yield from _critical_speeds(findings, tolerances)
    if tolerances.couplings:
        yield Paragraph(ALONE)
        rows = []
        for mode in range(tolerances.frequency.size):  # the largest effect first
            places = [along(coupling, "mode", [mode])[0] for coupling in tolerances.couplings]
            places.sort(key=lambda k: (k.lower - k.upper, k.softest - k.stiffest))
            rows += places
        yield table(
            "mode: Mode | coupling: < Coupling | tolerance: Tolerance [%]:3 | lower: Soft:7 | upper: Stiff:7 | "
            "change: Change [%]:3 | softest: Without it:7 | stiffest: Rigid:7",
            rows[:MOST_ROWS],
            "Effect of each coupling on each mode",
        )
    if tolerances.aims:
        yield table(
            "mode: Mode -> | frequency: Target frequency:7 -> target, Hz | coupling: < Coupling -> | "
            "stiffness: Required stiffness:7 -> k | factor: Required / nominal stiffness:5 -> k / nominal | "
            "softest: Without it:7 | stiffest: Rigid:7",
            tolerances.aims,
            "Stiffness for a target frequency; none (–) if no stiffness reaches it",
            short="Stiffness for a target frequency",
        )


def _critical_speeds(findings: Findings, tolerances: Tolerances) -> Iterator[Block]:
    """Yield the critical speeds that can lie in the speed range."""
    speeds, critical = findings.study.operation.speeds, findings.get(CriticalSpeeds)
    if speeds is None or critical is None or not tolerances.critical_lower.size:
        return
    rows = [
        (place, crossing, crossing.line.named(findings.study.reference))
        for place, crossing in zip(
            along(tolerances, "critical speed"), critical.crossings, strict=True
        )
        if place.critical_lower <= speeds.last and place.critical_upper >= speeds.first
    ]
    within = speed_range(findings)
    if not rows:
        yield Paragraph(f"Within the tolerances the speed range {within} has no critical speed.")
        return
    yield table(
        "critical_lower: Minimum [rpm] | speed: Critical speed [rpm] | critical_upper: Maximum [rpm] | "
        "order: Order:o | mode: Mode | < Excited by | "
        "is_inside: < Nominally in the range",
        rows,
        f"Critical speeds that can lie in the speed range {within} within the tolerances",
        most=MOST_ROWS,
    )
