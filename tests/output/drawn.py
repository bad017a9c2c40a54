"""What a figure holds, by name: levels, ranges and marks of its first plot."""

from torsion.output.figures.figure import Axis, Figure, Line, Panel


def plot(figure: Figure) -> Panel:
    """The first plot."""
    return figure.plots[0]


def levels(figure: Figure) -> dict[str, list[float]]:
    """Values by name, or by label."""
    found: dict[str, list[float]] = {}
    for level in plot(figure).levels:
        found.setdefault(level.name or level.label, []).append(level.value)
    return found


def bands(figure: Figure, kind: str) -> list[tuple[float, float]]:
    """Ends of the ranges of a kind."""
    return [(band.low, band.high) for band in plot(figure).bands if band.kind == kind]


def marks(figure: Figure, name: str) -> list[tuple[float, float]]:
    """Points of that name."""
    return [
        place
        for one in plot(figure).marks
        if one.name == name
        for place in zip(one.x, one.y, strict=True)
    ]


def named(panel: Panel) -> dict[str, Line]:
    """The lines that have a name."""
    return {line.name: line for line in panel.lines if line.name}


def titles(figure: Figure) -> list[str]:
    """What the y axes say."""
    return [panel.y.title for panel in figure.plots]


def unit(figure: Figure) -> str:
    """Of the first y axis."""
    axis: Axis = plot(figure).y
    return axis.unit
