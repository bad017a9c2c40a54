"""The speeds of the operation with what is barred, unstable or unknown, critical speeds and the rated speed."""

from collections.abc import Sequence

from torsion.output.drawing.words import fitted
from torsion.output.figures.figure import Axis, Band, Figure, Level, Panel
from torsion.output.figures.ranges import SPEED, Bands, barred_bands
from torsion.output.numbers import number
from torsion.output.reported_values import widened

HEIGHT, ROOM = 46.0, 0.03  # px; of the range, free beyond its ends
LONGEST = 480.0  # px of the names of all orders together
Critical = tuple[float, str]  # rpm, what excites it


def speed_range(
    name: str,
    caption: str,
    *,
    speeds: tuple[float, float],
    rated: float | None,
    barred: Bands,
    unstable: Bands,
    unknown: Sequence[Band],
    critical: Sequence[Critical],
) -> Figure:
    """Draw all speeds in rpm; ranges of a single speed are as wide as can be seen."""
    ends = [*speeds, *([] if rated is None else [rated])]
    room = ROOM * ((max(ends) - min(ends)) or max(ends))
    bands = [
        Band("speeds of the operation", *speeds, "range"),
        *(_labelled(band) for band in barred_bands(barred, unstable)),
        *unknown,
    ]
    levels = (
        []
        if rated is None
        else [Level("rated speed", rated, "rated", "x", f"rated {number(rated, 4)}")]
    )
    levels += [
        Level(
            "critical speed",
            speed,
            "second limit",
            "x",
            f"{number(speed, 4)}: {fitted(words, LONGEST / len(critical))}",
        )
        for speed, words in critical
    ]
    across = Axis(SPEED.quantity, SPEED.unit, max(min(ends) - room, 0.0), max(ends) + room)
    plot = Panel(
        across,
        Axis("", "", 0.0, 1.0, places=((0.0, ""),)),
        (),
        tuple(levels),
        tuple(bands),
        height=HEIGHT,
    )
    return Figure(name, caption, (plot,))


def _labelled(band: Band) -> Band:
    kind = band.name.removesuffix(" range")
    words = f"{kind} {' to '.join(widened((band.low, band.high)))}"
    return Band(band.name, band.low, band.high, band.kind, label=words)
