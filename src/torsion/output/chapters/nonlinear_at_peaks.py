"""Chapter: couplings with play, friction or stages at the peaks of the response, by harmonic balance and exact."""

from collections.abc import Iterator
from itertools import chain

from torsion.analyses.motion.derived.nonlinear_peaks import NonlinearPeak, NonlinearPeaks
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, table
from torsion.output.numbers import number, rpm

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
    "coupling: < Coupling -> | component: < Order | speed: Speed [rpm] -> rpm | response: Response -> | "
    "exact: Exact -> | difference: Difference [%]:2 -> | half_range: Exact total | mode: Mode | "
    "natural_frequency: Frequency"
)


def chapter(findings: Findings) -> Iterator[Block]:
    """Nothing without such couplings, or without a response."""
    peaks = findings.get(NonlinearPeaks)
    if peaks is None or not peaks.each:
        return
    yield Heading("Backlash and friction at the peaks of the response")
    yield Paragraph(METHOD)
    title = "Backlash and friction at the peaks"
    yield table(TITLES, peaks.each, "Torque amplitudes at the peaks", short=title)
    for name in dict.fromkeys(peak.coupling for peak in peaks.each):
        peaks_of_coupling = [peak for peak in peaks.each if peak.coupling == name]
        notes = [
            *_ranges(peaks_of_coupling[0]),
            *chain.from_iterable(map(_notes, peaks_of_coupling)),
        ]
        if notes:
            yield Paragraph(f"{name}: {' '.join(notes)}", "note")


def _ranges(peak: NonlinearPeak) -> Iterator[str]:
    """Where its play opens, and where there are several solutions."""
    if peak.opens_from is not None and peak.opens_to is not None:
        where = f"between {rpm(peak.opens_from)} and {rpm(peak.opens_to)} rpm"
        where = f"at {rpm(peak.opens_from)} rpm" if peak.opens_from == peak.opens_to else where
        yield f"the backlash opens {where}: the faces separate and hammer."
    if peak.several_from is not None and peak.several_to is not None:
        yield (
            f"Between {rpm(peak.several_from)} and {rpm(peak.several_to)} rpm the response has several solutions, and "
            "the amplitude can jump between them. The report shows the largest."
        )


def _notes(peak: NonlinearPeak) -> Iterator[str]:
    """What a reader must know of a comparison."""
    speed_words = f"At {rpm(peak.speed)} rpm"
    if peak.from_rest is not None:
        yield f"{speed_words} the exact motion that starts without vibration reaches {number(peak.from_rest)} N m."
    if not peak.ended:
        yield (
            f"{speed_words} the exact motion needs too much computing time. Compute the transient response at this speed."
        )
    elif peak.exact is None:
        yield (
            f"{speed_words} the motion that starts from the response does not settle. Compute the transient "
            "response at this speed."
        )
    elif peak.difference is not None and abs(peak.difference) > DIFFERS:
        text = f"{speed_words} the response differs by more than {100.0 * DIFFERS:.0f} %; use the exact motion"
        leaves = peak.solutions > 1 and peak.response > peak.exact
        yield text + (", which leaves the largest solution." if leaves else ".")
