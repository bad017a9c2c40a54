"""Chapters: details of shafts: steps and hubs that move the natural frequencies, stress in fillets and notches."""

from collections.abc import Iterator

from torsion.analyses.modes.steps_and_hubs import HubMoves, SharpSteps
from torsion.analyses.response.fillet_stresses import Fillets
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, Points, table
from torsion.output.numbers import symbols
from torsion.output.records import along

STEPS = (
    "The file does not describe the corner between shafts of different diameter. The frequencies above "
    "neglect the flexibility of the shoulder (`steps: none`). To include it, set `steps: sharp` (upper limit)"
    " or state a fillet or chamfer with `step` of the shaft."
)
HUBS = (
    "A part of the seat of a hub twists with the shaft. The model is bonded (finite elements) or keyed "
    "(formula); slip at the mouth of the seat is not included. The comparison without a hub assumes that the "
    "whole seat twists."
)
FILLETS = (
    "K_{t} is the maximum shear stress in the fillet over the nominal stress T/W_{p} of the smaller end, for "
    "a shoulder between two long shafts (finite elements of axisymmetric torsion). The column Peterson gives "
    "the fit of chart 3.12 (Pilkey 1997, edition not confirmed) for solid shafts and 0.25 ≤ shoulder height /"
    " radius ≤ 4. The peak stress is K_{t} times the total nominal stress amplitude at its worst speed. Class"
    " limits apply to nominal stresses and include their own factors. Corners without a stated radius, the "
    "second corner of a flange or undercut, corners between different bores and hub mouths are not included. "
    "A short shaft between two larger shafts is computed with both shoulders. At a larger shaft with a thin "
    "wall the peak is at least its nominal stress."
)
NOTCHES = (
    "Keyways and splines: K_{t} of the section over T/W_{p} of the plain shaft, by plane finite elements. The"
    " pressure of the key and the ends of the groove are not included. For a keyway of width d/4 and depth "
    "d/8 the column Peterson gives the fit of chart 5.2 (edition not confirmed), 2 % (radius d/100) to 7 % "
    "(0.07 d) above the finite elements; their error is below 1e-3. Radial oil holes: the formula of IACS UR "
    "M53 for the maximum normal stress, over √3. The nominal stress is at the end of the shaft with the "
    "highest notch stress."
)


def steps_and_hubs(findings: Findings) -> Iterator[Block]:
    """Yield how far sharp steps would move the natural frequencies, and how far hubs do; nothing without either."""
    if (sharp := findings.get(SharpSteps)) is not None:
        yield Heading("Steps between shafts", 2)
        yield Paragraph(STEPS)
        yield Points(tuple(f"{step.shaft}: {symbols(step.remark)}." for step in sharp.steps))
        if any(step.flexibility for step in sharp.steps):
            yield table(
                "mode: Mode -> | frequency: With sharp steps [Hz]:7 -> Hz | change: Change [%]:3 -> change, %",
                along(sharp, "mode"),
                "Natural frequencies with sharp steps between the shafts",
            )

    if (hubs := findings.get(HubMoves)) is not None:
        yield Heading("Hubs on shafts", 2)
        yield Paragraph(HUBS)
        yield table(
            "shaft: < Shaft | end: < End | seat: Seat [mm] | twisting: Twists as [mm]:4 | error: Error [mm]:1",
            hubs.each,
            "Hubs on the ends of shafts",
        )
        yield table(
            "shaft: < Shaft | end: < End | mode: Mode | frequency: Without the hub [Hz]:7 | change: Change [%]:3",
            [row for hub in hubs.each for row in along(hub, "mode")],
            "Effect of each hub on the natural frequencies",
        )


def fillets(findings: Findings) -> Iterator[Block]:
    """Yield the shear stress in the stated fillets and notches of shafts, with K_t and its error."""
    details = findings.need(Fillets).each
    yield Heading("Stress in fillets")
    yield Paragraph(FILLETS)
    if any(detail.following is None for detail in details):
        yield Paragraph(NOTCHES)
    yield table(
        "shaft: < Shaft | label: < Detail | radius: Radius [mm]:4 | diameter: d [mm] | larger: D [mm] | "
        "factor: K_{t}:4 | error: Error of K_{t} [%]:2 | peterson: Peterson:4 | nominal: Nominal [N/mm²]:4 | "
        "peak: Peak [N/mm²]:4 | speed: Speed [rpm] | endurance: Endurance limit [N/mm²]:4 -> endurance | "
        "utilisation: Utilisation [%]:4",
        details,
        "Shear stress in fillets and notches",
        marks=["fail" if (detail.utilisation or 0.0) > 1.0 else "" for detail in details],
    )
