"""Chapter: couplings with play, friction or stages at the peaks of the response, linear and exact."""

from collections.abc import Iterator

from torsion.analyses.transient.nonlinear_peaks import NonlinearPeaks
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, table
from torsion.output.numbers import NONE, number, rpm

DIFFERS = 0.05  # of the exact amplitude: more is pointed at
METHOD = (
    "The response takes a play as closed, the first of several stages, and dry friction as a complex stiffness at the "
    "amplitude of its largest harmonic component. At the largest torque amplitude of each such coupling the motion is "
    "also computed exactly, from event to event, until it repeats itself."
)


def chapter(findings: Findings) -> Iterator[Block]:
    """Nothing without such couplings, or without a response."""
    found = findings.get(NonlinearPeaks)
    if found is None or not found.each:
        return
    yield Heading("Play and friction at the peaks of the response")
    yield Paragraph(METHOD)
    rows = [
        (
            one.coupling, one.component, rpm(one.speed), number(one.response),
            NONE if one.exact is None else number(one.exact),
            NONE if one.difference is None else number(100.0 * one.difference, 2),
        )
        for one in found.each
    ]  # fmt: skip
    titles = "< Coupling -> | < Harmonic component | rpm -> | Response [N m] -> | Exact [N m] -> | Difference [%] ->"
    yield table(titles, rows, "Torque amplitudes at the peaks", short="Play and friction at the peaks")
    doubtful = [one.coupling for one in found.each if one.difference is None or abs(one.difference) > DIFFERS]
    if doubtful:
        text = (
            f"The response is off by more than 5 % for {', '.join(doubtful)}, or the motion never settles: "
            "compute the motion over time there."
        )
        yield Paragraph(text, "note")
