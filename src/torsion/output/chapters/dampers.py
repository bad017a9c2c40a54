"""Chapter: the rings of dampers beside what would be best for each mode that they reach."""

from collections.abc import Iterator

from torsion.analyses.damper_optimum import Dampers
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, table
from torsion.output.numbers import given, number

WHAT = (
    "Each mode of the train without the ring is taken as one undamped mass, the inertia that the mode has at the "
    "housing; the best ring makes its greatest magnification (angle over static angle) smallest: by oil or silicone "
    "alone (Den Hartog), or on a spring with viscous damping beside it (Nishihara and Asami). It is a first choice: "
    "other modes, damping of the train and the orders that excite are in the response, which judges."
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
            one.damper, one.mode, number(one.frequency), number(one.inertia), number(one.ratio, 4),
            number(one.viscous), number(one.viscous_peak, 4), number(one.stiffness), number(one.damping),
            number(one.tuned_peak, 4), given(one.given_peak, 4) if one.given_peak else None,
        )
        for one in found
    ]  # fmt: skip
    yield table(
        "< Damper -> | Mode without the ring -> mode | At [Hz] -> Hz | Inertia of the mode [kg m²] | "
        "Ring / inertia of the mode | Best viscous damping [N m s/rad] -> best c alone | Magnification with it | "
        "Best stiffness [N m/rad] -> best k | Best damping beside it [N m s/rad] -> its c | Magnification with both | "
        "Magnification as given -> as given",
        rows,
        "Best rings, at the damper's own speed",
        short="Best rings of the dampers",
    )
