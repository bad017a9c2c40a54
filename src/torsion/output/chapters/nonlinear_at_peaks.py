"""Chapter: couplings with play, friction or stages at the peaks of the response, by harmonic balance and exact."""

from collections.abc import Iterator

from torsion.analyses.motion.nonlinear_peaks import NonlinearPeak, NonlinearPeaks
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, table
from torsion.output.numbers import NONE, number, rpm

DIFFERS = 0.10  # of the exact amplitude: more is pointed at
METHOD = (
    "The response models backlash, stages and dry friction by harmonic balance: each coupling has one "
    "stiffness for its largest harmonic twist about the mean twist. Natural frequencies are for closed "
    "backlash, without friction, in the first stage. The program also computes the exact motion at the "
    "largest amplitude of each coupling and in each quarter of its nonlinear speed range. The total and the "
    "checks use the larger value. If no exact motion settles, no check passes. The last columns give the mode"
    " with the largest share in the coupling, and its frequency at this amplitude."
)
TITLES = (
    "< Coupling -> | < Order | Speed [rpm] -> rpm | Response [N m] -> | Exact [N m] -> | Difference [%] -> | "
    "Exact total [N m] | Mode | Frequency [Hz]"
)


def chapter(findings: Findings) -> Iterator[Block]:
    """Nothing without such couplings, or without a response."""
    found = findings.get(NonlinearPeaks)
    if found is None or not found.each:
        return
    yield Heading("Backlash and friction at the peaks of the response")
    yield Paragraph(METHOD)
    rows = [
        (
            one.coupling,
            one.component,
            rpm(one.speed),
            number(one.response),
            NONE if one.exact is None else number(one.exact),
            NONE if one.difference is None else number(100.0 * one.difference, 2),
            number(one.half_range),
            one.mode,
            number(one.natural_frequency),
        )
        for one in found.each
    ]
    yield table(
        TITLES, rows, "Torque amplitudes at the peaks", short="Backlash and friction at the peaks"
    )
    for name in dict.fromkeys(one.coupling for one in found.each):
        own = [one for one in found.each if one.coupling == name]
        if notes := " ".join([*_ranges(own[0]), *(note for one in own for note in _notes(one))]):
            yield Paragraph(f"{name}: {notes}", "note")


def _ranges(one: NonlinearPeak) -> Iterator[str]:
    """Where its play opens, and where there are several solutions."""
    if one.opens_from is not None and one.opens_to is not None:
        where = f"between {rpm(one.opens_from)} and {rpm(one.opens_to)} rpm"
        where = f"at {rpm(one.opens_from)} rpm" if one.opens_from == one.opens_to else where
        yield f"the backlash opens {where}: the faces separate and hammer."
    if one.several_from is not None and one.several_to is not None:
        yield (
            f"Between {rpm(one.several_from)} and {rpm(one.several_to)} rpm the response has several solutions, and "
            "the amplitude can jump between them. The report shows the largest."
        )


def _notes(one: NonlinearPeak) -> Iterator[str]:
    """What a reader must know of a comparison."""
    here = f"At {rpm(one.speed)} rpm"
    if one.from_rest is not None:
        yield f"{here} the exact motion that starts without vibration reaches {number(one.from_rest)} N m."
    if not one.ended:
        yield (
            f"{here} the exact motion needs too much computing time. Compute the transient response at this speed."
        )
    elif one.exact is None:
        yield (
            f"{here} the motion that starts from the response does not settle. Compute the transient "
            "response at this speed."
        )
    elif one.difference is not None and abs(one.difference) > DIFFERS:
        text = f"{here} the response differs by more than {100.0 * DIFFERS:.0f} %; use the exact motion"
        leaves = one.solutions > 1 and one.response > one.exact
        yield text + (", which leaves the largest solution." if leaves else ".")
