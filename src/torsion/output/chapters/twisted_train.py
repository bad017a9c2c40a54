"""Chapter, printed when `--vtu` requests it: the train twisted by each of its modes."""

from collections.abc import Iterator

import numpy as np

from torsion.analyses.undamped_modes import Modes
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph
from torsion.output.figures.figure import Figure, Twisted
from torsion.output.numbers import number
from torsion.output.station_layout import label
from torsion.output.surface.axes import Axis, axes
from torsion.output.surface.surface import TWIST, Rings, angles, rings, shapes, turned
from torsion.output.surface.vtu import NAME

MOST_MODES = 6  # of which a picture is printed
MOST_STRIPS = 2_000  # of the surface, in all pictures together: about 1 MB
ENLARGED = 2.0  # times the angle in the file: what a small picture needs
NEAR = 0.04  # of the length of the train: what is so near stands in the way of a label
TALL, TALLEST = 0.2, 0.42  # of the length of the train: the widest body, and all axes together, as drawn
STEPS = (1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0)  # and ten, a hundred, ... times as much


def chapter(findings: Findings) -> Iterator[Block]:
    """A picture of every mode."""
    modes, placed = shapes(findings), axes(findings.system)
    found = rings(findings.system, placed)
    larger, count = _larger(found), modes.frequency.size
    yield Heading("The twisted train")
    yield Paragraph(
        f"{_scale(found, larger)} Axes are drawn straight, also through joints, and parallel behind gears, branches "
        "and links. The stripes run along the axis while the train is at rest; the largest angle of each mode is drawn "
        f"as {ENLARGED * TWIST:g} rad, in the sense in which each shaft turns. The same surface, with displacement, "
        f"angle, torque and shear stress of every mode, is in {NAME}."
    )
    shown = min(count, MOST_MODES, MOST_STRIPS // max(found.strip.size, 1))
    for mode in range(shown):
        yield _figure(findings, modes, mode, (found, placed, larger))
    if count > shown:
        which = f"Modes {shown + 1} to {count}" if shown else "A train of so many components is not pictured: modes"
        yield Paragraph(f"{which} are in {NAME} alone.")


def _scale(found: Rings, larger: float) -> str:
    """What of the picture is to scale."""
    if not found.to_scale.any():
        return "Nothing in these pictures is to scale: no component has a diameter."
    if larger > 1:
        shafts = f"diameters and distances of axes are drawn {larger:g} times as large as lengths"
    else:
        shafts = "lengths and diameters are to one scale"
    return f"Shafts are drawn by their dimensions; {shafts}. Components without dimensions are not to scale."


def _larger(found: Rings) -> float:
    """How many times larger than lengths diameters are drawn."""
    length = float(np.ptp(found.x))
    across = np.ptp(np.concatenate([found.place + found.radius[:, None], found.place - found.radius[:, None]]), axis=0)
    most = min(TALL * length / (2.0 * float(found.radius.max())), TALLEST * length / float(across.max()))
    if most <= 1:
        return 1.0
    decade = 10.0 ** np.floor(np.log10(most))
    return float(decade * max(step for step in STEPS if step * decade <= most))


def _figure(findings: Findings, modes: Modes, mode: int, drawn: tuple[Rings, list[Axis], float]) -> Figure:
    found, placed, larger = drawn
    angle = angles(found, modes, mode)
    surface = Twisted(
        x=found.x, radius=larger * found.radius, place=larger * found.place, turn=ENLARGED * turned(found, angle),
        angle=angle / np.abs(angle).max(), strip=found.strip, body=found.body,
        labels=_labels(findings, placed, larger), ties=_ties(placed, larger),
    )  # fmt: skip
    f = number(float(modes.frequency[mode]))
    enlarged = f", diameters × {larger:g}" if larger > 1 else ""
    scale = f"shafts to scale{enlarged}; discs, couplings, gears not" if found.to_scale.any() else "not to scale"
    return Figure(f"twisted-{mode + 1}", f"Mode {mode + 1}, {f} Hz, twisted ({scale})", (surface,))


def _labels(findings: Findings, placed: list[Axis], larger: float) -> list[tuple[tuple[float, ...], float, str]]:
    """Number and name of every component at its first body: above what is there, or below on axes that lie below."""
    every = [(axis.place[1], body) for axis in placed for body in axis.bodies]
    tops = np.array([(body.x[0], body.x[-1], z + body.widest, z - body.widest) for z, body in every])
    near = NEAR * float(tops[:, 1].max() - tops[:, 0].min())
    found: dict[int, tuple[tuple[float, ...], float, str]] = {}
    for axis in placed:
        y, z = axis.place
        for body in axis.bodies:
            x = float(body.x[0] + body.x[-1]) / 2
            beside = tops[(tops[:, 0] <= x + near) & (tops[:, 1] >= x - near)]
            end = float(beside[:, 3].min() if z < 0 else beside[:, 2].max())
            text = label(findings.study.train.parts, body.part)
            found.setdefault(body.part, ((x, larger * y, larger * z), larger * (end - z), text))
    return sorted(found.values(), key=lambda label: label[0][0])


def _ties(placed: list[Axis], larger: float) -> list[tuple[tuple[float, ...], tuple[float, ...]]]:
    """From every axis to what carries it without a gear."""

    def point(x: float, axis: Axis) -> tuple[float, ...]:
        return x, larger * axis.place[0], larger * axis.place[1]

    return [(point(x, placed[a.parent]), point(x, a)) for a in placed if a.parent is not None for x in a.ties]
