"""Chapter: bands of the natural frequencies over the tolerances, which figure matters, and what each coupling does."""

from collections.abc import Iterator

from torsion.analyses.critical import CriticalSpeeds
from torsion.analyses.modes.tolerances import Tolerances
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, table
from torsion.output.numbers import given_rpm
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
    """Yield bands if a component has a tolerance, and target stiffnesses if the file states targets."""
    tolerances = findings.need(Tolerances)
    yield Heading("Tolerances")
    if findings.study.has_tolerances:
        yield Paragraph(WHAT)
        bands = zip(tolerances.frequency, tolerances.lower, tolerances.upper, strict=True)
        yield table(
            "Mode -> | Frequency [Hz]:7 -> Hz | Minimum [Hz]:7 -> minimum | Maximum [Hz]:7 -> maximum | "
            "Down [%]:3 | Up [%]:3",
            [
                (mode, nominal, low, high, low / nominal - 1.0, high / nominal - 1.0)
                for mode, (nominal, low, high) in enumerate(bands, start=1)
            ],
            "Natural frequencies within the tolerances",
            short="Frequencies within the tolerances",
        )
        if tolerances.figures:
            yield Paragraph(MATTERS)
            yield _dominant_parameters(tolerances)
        yield from _critical_speeds(findings, tolerances)
    if tolerances.couplings:
        yield Paragraph(ALONE)
        yield _single_couplings(tolerances)
    if tolerances.aims:
        rows = [
            (
                aim.mode,
                aim.frequency,
                aim.coupling,
                aim.stiffness,
                aim.factor,
                "no stiffness reaches it" if aim.stiffness is None else "",
                aim.softest,
                aim.stiffest,
            )
            for aim in tolerances.aims
        ]
        yield table(
            "Mode -> | Target frequency [Hz]:7 -> target, Hz | < Coupling -> | Required stiffness [N m/rad]:7 -> k | "
            "Required / nominal stiffness:5 -> k / nominal | < Remark -> | Without it [Hz]:7 | Rigid [Hz]:7",
            rows,
            "Stiffness for a target frequency",
            short="Stiffness for a target frequency",
        )


def _dominant_parameters(tolerances: Tolerances) -> Block:
    rows = [
        (
            mode + 1,
            figure.figure,
            figure.tolerance,
            float(figure.sensitivity[mode]),
            float(figure.change[mode]),
        )
        for mode in range(tolerances.frequency.size)
        for figure in sorted(tolerances.figures, key=lambda figure: -float(figure.change[mode]))[
            :MOST_FIGURES
        ]
    ]
    count = len(tolerances.figures)
    extent = f" (the first {MOST_FIGURES} of {count} of each mode)" * (count > MOST_FIGURES)
    return table(
        "Mode -> | < Parameter -> | Tolerance [%]:3 | Sensitivity:3 | Change of the mode, ± [%]:3 -> ± %",
        rows[:MOST_ROWS],
        f"Dominant parameters{extent}",
        short="Dominant parameters",
    )


def _critical_speeds(findings: Findings, tolerances: Tolerances) -> Iterator[Block]:
    """Yield the critical speeds that can lie in the speed range."""
    speeds, critical = findings.study.operation.speeds, findings.get(CriticalSpeeds)
    if speeds is None or critical is None or not tolerances.critical_lower.size:
        return
    bands = zip(
        critical.crossings, tolerances.critical_lower, tolerances.critical_upper, strict=True
    )
    possible = [
        (low, crossing, high)
        for crossing, low, high in bands
        if low <= speeds.last and high >= speeds.first
    ]
    within = f"{given_rpm(speeds.first)} to {given_rpm(speeds.last)} rpm"
    if not possible:
        yield Paragraph(f"Within the tolerances the speed range {within} has no critical speed.")
        return
    is_certain = all(crossing.is_inside for _, crossing, _ in possible)
    rows = [
        (
            low,
            crossing.speed,
            high,
            crossing.order,
            crossing.mode,
            crossing.line.named(reference(findings)),
            *([] if is_certain else ["" if crossing.is_inside else "only within the tolerances"]),
        )
        for low, crossing, high in possible[:MOST_ROWS]
    ]
    count = len(possible)
    extent = f" (the lowest {MOST_ROWS} of {count})" if count > MOST_ROWS else ""
    yield table(
        "Minimum [rpm] | Critical speed [rpm] | Maximum [rpm] | Order:o | Mode | < Excited by"
        + " | < In the range" * (not is_certain),
        rows,
        f"Critical speeds that can lie in the speed range {within} within the tolerances{extent}",
    )


def _single_couplings(tolerances: Tolerances) -> Block:
    """Return what each coupling alone does, mode by mode, the largest effect first."""
    rows = []
    for mode, frequency in enumerate(tolerances.frequency.tolist()):
        effects = [
            (
                float(coupling.upper[mode] - coupling.lower[mode]),
                float(coupling.stiffest[mode] - coupling.softest[mode]),
                coupling,
            )
            for coupling in tolerances.couplings
        ]
        for width, _, coupling in sorted(effects, key=lambda effect: effect[:2], reverse=True):
            band = coupling.tolerance, coupling.lower[mode], coupling.upper[mode], width / frequency
            rows.append(
                (
                    mode + 1,
                    coupling.coupling,
                    *(band if coupling.tolerance else [None] * 4),
                    coupling.softest[mode],
                    coupling.stiffest[mode],
                )
            )
    return table(
        "Mode | < Coupling | Tolerance [%]:3 | Soft [Hz]:7 | Stiff [Hz]:7 | Change [%]:3 | Without it [Hz]:7 | "
        "Rigid [Hz]:7",
        rows[:MOST_ROWS],
        "Effect of each coupling on each mode",
    )
