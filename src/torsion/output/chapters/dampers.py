"""Chapter: the rings of dampers beside what would be best for each mode that they reach."""

from collections.abc import Iterator

from torsion.analyses.modes.damper_optimum import Dampers
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, table
from torsion.output.numbers import given, number

WHAT = (
    "Each mode of the train without the ring is one undamped mass, with the modal inertia at the housing. The"
    " optimum ring minimises the peak magnification (amplitude / static twist): viscous (Den Hartog), or "
    "tuned with a spring and viscous damping (Nishihara and Asami). Use this as a first estimate. Check it in"
    " the forced response, which includes all modes, the damping and the excitation."
)


def chapter(findings: Findings) -> Iterator[Block]:
    """Nothing where no ring reaches a mode."""
    found = findings.need(Dampers).each
    if not found:
        return
    yield Heading("Dampers")
    yield Paragraph(WHAT)
    rows = [
        (
            one.damper,
            one.mode,
            number(one.frequency),
            number(one.inertia),
            number(one.ratio, 4),
            number(one.viscous),
            number(one.viscous_peak, 4),
            number(one.stiffness),
            number(one.damping),
            number(one.tuned_peak, 4),
            given(one.given_peak, 4) if one.given_peak else None,
        )
        for one in found
    ]
    yield table(
        "< Damper -> | Mode without the ring -> mode | Frequency [Hz] -> Hz | Modal inertia [kg m²] | "
        "Ring / modal inertia | Optimum viscous c [N m s/rad] -> viscous c | Magnification, viscous | "
        "Optimum k, tuned [N m/rad] -> tuned k | Optimum c, tuned [N m s/rad] -> tuned c | Magnification, tuned | "
        "Magnification as given -> as given",
        rows,
        "Optimum damper rings, at the speed of the damper",
        short="Optimum damper rings",
    )
