"""Chapter: couplings with play, friction or stages at the peaks of the response, by harmonic balance and exact."""

from collections.abc import Iterator

from torsion.analyses.transient.nonlinear_peaks import NonlinearPeak, NonlinearPeaks
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, table
from torsion.output.numbers import NONE, number, rpm

DIFFERS = 0.10  # of the exact amplitude: more is pointed at
METHOD = (
    "The response takes play, stages and dry friction by harmonic balance: at the twist amplitude of its largest "
    "harmonic component, about the mean twist under the mean torque, a coupling is a stiffness of its own. Natural "
    "frequencies are those of a closed play, without friction, in the first stage. At the largest torque amplitude of "
    "each such coupling, and in each quarter of the speeds at which it is not linear, the motion is also computed "
    "exactly, from event to event, beginning as the response is, until it repeats itself. The synthesis and the "
    "verdicts take the larger of both; where no exact motion settles, the synthesis has no value and no verdict "
    "passes. The last columns are the mode that the coupling takes most part in, and its frequency as stiff as the "
    "couplings are at these amplitudes."
)
TITLES = (
    "< Coupling -> | < Harmonic component | rpm -> | Response [N m] -> | Exact [N m] -> | Difference [%] -> | "
    "Exact, half range [N m] | Mode | Its frequency there [Hz]"
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
            NONE if one.difference is None else number(100.0 * one.difference, 2), number(one.half_range),
            one.mode, number(one.natural_frequency),
        )
        for one in found.each
    ]  # fmt: skip
    yield table(TITLES, rows, "Torque amplitudes at the peaks", short="Play and friction at the peaks")
    for name in dict.fromkeys(one.coupling for one in found.each):
        own = [one for one in found.each if one.coupling == name]
        if notes := " ".join([*_ranges(own[0]), *(note for one in own for note in _notes(one))]):
            yield Paragraph(f"{name}: {notes}", "note")


def _ranges(one: NonlinearPeak) -> Iterator[str]:
    """Where its play opens, and where there are several solutions."""
    if one.opens_from is not None and one.opens_to is not None:
        where = f"between {rpm(one.opens_from)} and {rpm(one.opens_to)} rpm"
        where = f"at {rpm(one.opens_from)} rpm" if one.opens_from == one.opens_to else where
        yield f"its play opens {where}: the faces separate and hammer."
    if one.several_from is not None and one.several_to is not None:
        yield (
            f"Between {rpm(one.several_from)} and {rpm(one.several_to)} rpm the response has several solutions, and "
            "the amplitude jumps from one to another; the largest stands everywhere."
        )


def _notes(one: NonlinearPeak) -> Iterator[str]:
    """What a reader must know of a comparison."""
    here = f"At {rpm(one.speed)} rpm"
    if one.from_rest is not None:
        yield f"{here} the exact motion that begins without vibration settles at {number(one.from_rest)} N m."
    if not one.ended:
        yield (
            f"{here} the exact motion is too much work beside a response, and was not followed until it settles: "
            "compute the motion over time there."
        )
    elif one.exact is None:
        yield f"{here} the motion that begins as the response is does not settle: compute the motion over time there."
    elif one.difference is not None and abs(one.difference) > DIFFERS:
        text = (
            f"{here} the response differs by more than {100.0 * DIFFERS:.0f} %, and the exact motion is to be trusted"
        )
        leaves = one.solutions > 1 and one.response > one.exact
        yield text + (", which does not stay with the largest of the solutions." if leaves else ".")
