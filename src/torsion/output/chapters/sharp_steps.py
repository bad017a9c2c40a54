"""Part of the chapter of natural frequencies: how far sharp steps would move them, and how far hubs do."""

from collections.abc import Iterator

from torsion.analyses.modes.hub_moves import HubMoves
from torsion.analyses.modes.sharp_steps import SharpSteps
from torsion.output.blocks import Block, Heading, Paragraph, Points, table
from torsion.output.numbers import NONE, number, symbols

INTRODUCTION = (
    "The file does not describe the corner between shafts of different diameter. The frequencies above "
    "neglect the flexibility of the shoulder (`steps: none`). To include it, set `steps: sharp` (upper limit)"
    " or state a fillet or chamfer with `step` of the shaft."
)
HUBS = (
    "A part of the seat of a hub twists with the shaft. The model is bonded (finite elements) or keyed "
    "(formula); slip at the mouth of the seat is not included. The comparison without a hub assumes that the "
    "whole seat twists."
)


def sharp_steps(found: SharpSteps) -> Iterator[Block]:
    """The steps, and the frequencies with sharp corners at them."""
    yield Heading("Steps between shafts", 2)
    yield Paragraph(INTRODUCTION)
    yield Points(tuple(f"{step.shaft}: {symbols(step.remark)}." for step in found.steps))
    if not any(step.flexibility for step in found.steps):
        return
    yield table(
        "Mode -> | With sharp steps [Hz] -> Hz | Change [%] -> change, %",
        [
            (mode, number(f, 7), number(100.0 * change, 3))
            for mode, (f, change) in enumerate(
                zip(found.frequency.tolist(), found.change.tolist(), strict=True), 1
            )
        ],
        "Natural frequencies with sharp steps between the shafts",
    )


def moved_by_hubs(found: HubMoves) -> Iterator[Block]:
    """The hubs, and the frequencies without each of them."""
    yield Heading("Hubs on shafts", 2)
    yield Paragraph(HUBS)
    yield table(
        "< Shaft | < End | Seat [mm] | Twists as [mm] | Error [mm]",
        [
            (
                hub.shaft,
                hub.end,
                number(1e3 * hub.seat, 5),
                number(1e3 * hub.twisting, 4),
                NONE if hub.error is None else number(1e3 * hub.error, 1),
            )
            for hub in found.each
        ],
        "Hubs on the ends of shafts",
    )
    yield table(
        "< Shaft | < End | Mode | Without the hub [Hz] | Change [%]",
        [
            (hub.shaft, hub.end, mode, number(f, 7), number(100.0 * change, 3))
            for hub in found.each
            for mode, (f, change) in enumerate(
                zip(hub.frequency.tolist(), hub.change.tolist(), strict=True), 1
            )
        ],
        "Effect of each hub on the natural frequencies",
    )
