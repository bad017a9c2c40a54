"""Part of the chapter of natural frequencies: how far sharp steps between shafts would move them."""

from collections.abc import Iterator

from torsion.analyses.sharp_steps import SharpSteps
from torsion.output.blocks import Block, Heading, Paragraph, Points, table
from torsion.output.numbers import number, symbols

INTRODUCTION = (
    "Shafts of unlike diameter meet without a word on the corner between them. The frequencies above give such a step "
    "no twist of its own, that is `steps: none`. A sharp corner twists most; `steps: sharp` takes it, and `step` of a "
    "shaft its own fillet or chamfer."
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
            for mode, (f, change) in enumerate(zip(found.frequency.tolist(), found.change.tolist(), strict=True), 1)
        ],
        "Natural frequencies with sharp steps between the shafts",
    )
