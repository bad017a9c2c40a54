"""Numbers of chapters, sections, tables and figures: what a scene does not have leaves no gap."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from torsion.output.blocks import Block, Figure, Heading, Table


@dataclass(frozen=True)
class Numbered:
    """A block with its number ('' where it has none): '4', '4.2', 'Table 4.1', 'Figure 4.3'."""

    block: Block
    number: str = ""


def numbered(blocks: Sequence[Block]) -> Iterator[Numbered]:
    """The blocks in their order, with their numbers; tables and figures without a caption have none."""
    chapter = section = table = figure = 0
    for block in blocks:
        match block:
            case Heading(level=1):
                chapter, section, table, figure = chapter + 1, 0, 0, 0
                yield Numbered(block, str(chapter))
            case Heading():
                section += 1
                yield Numbered(block, f"{chapter}.{section}")
            case Table(caption=caption) if caption:
                table += 1
                yield Numbered(block, f"Table {chapter}.{table}")
            case Figure():
                figure += 1
                yield Numbered(block, f"Figure {chapter}.{figure}")
            case _:
                yield Numbered(block)
