"""Grades of use: areas by colour and pattern, their key, and shares of limits as areas beside a line at the limit."""

import math
from collections.abc import Iterable

from torsion.output.drawing.frame import END, MIDDLE, WIDTH
from torsion.output.drawing.pens import BAD, GRADES, GREY, INK, MARKED, MARKS, Stroke
from torsion.output.drawing.plot import hatching
from torsion.output.drawing.text import shown, words
from torsion.output.drawing.words import GROWTH, SIZE, fitted, width
from torsion.output.figures.figure import Grade, Share, Shares, Use

Box = tuple[float, float, float, float]
SAMPLE, KEY_ROW = 24.0, 16.0  # px
LEFT, RIGHT, ROW, HEAD = (
    240.0,
    430.0,
    13.2,
    16.0,
)  # px: of the shares, whose names and words stand beside them
SIGN = 6.5  # px: radius of the disc around a sign
FEWEST = 30.0  # px of a name that stands before a very long clause
MOST = 2.0  # times the limit: a larger share is cut
BEYOND = 1.05  # times the largest share: as far the axis goes
BOLD = ' font-weight="bold"'


def hatched(box: Box, grade: Grade) -> tuple[Stroke, str]:
    """Return strokes of a grade's hatching in a box in tenths of px; '' if it has none."""
    pattern = GRADES[grade]
    path = "".join(hatching(box, pattern.apart, slope) for slope in pattern.slopes)
    return Stroke(pattern.colour or INK, 0.8, pattern.dash), path


def area(box: Box, grade: Grade) -> str:
    """Return a rectangle in tenths of px."""
    left, top, right, foot = (round(edge) for edge in box)
    edges = f'x="{left}" y="{top}" width="{right - left}" height="{foot - top}"'
    look, path = hatched((left, top, right, foot), grade)
    inside = f'<path d="{path}" fill="none" {look.attributes(10.0)}/>' if path else ""
    return f'<rect {edges} fill="{GRADES[grade].fill}" stroke="{INK}" stroke-width="8"/>{inside}'


def marked(x: float, y: float, sign: str) -> str:
    """Return the sign of a failed limit in a disc, in px."""
    disc = f'<circle cx="{shown(x)}" cy="{shown(y)}" r="{SIGN:g}" fill="#ffffff" stroke="{BAD}"/>'
    return disc + words(x, y + 3.7, sign, f'{MIDDLE}{BOLD} fill="{BAD}"')


def key(uses: Iterable[Use], top: float) -> tuple[float, str]:
    """Return height in px and elements of the key of the grades and marks that are there."""
    known_uses = list(uses)
    grades, marks = {use.grade for use in known_uses}, {use.mark for use in known_uses}
    box = (0.0, -50.0, 10 * SAMPLE, 50.0)
    entries = [(area(box, grade), "", GRADES[grade].words) for grade in GRADES if grade in grades]
    outline = f'<path d="M0-50h{10 * SAMPLE:g}v100h-{10 * SAMPLE:g}z" fill="none" {MARKED.attributes(10.0)}/>'
    entries += [
        (outline, marked(SAMPLE / 2, 0.0, sign), MARKS[sign]) for sign in MARKS if sign in marks
    ]
    x, y, made = 4.0, top + KEY_ROW / 2, list[str]()
    for sample, sign, label in entries:
        need = SAMPLE + 5 + GROWTH * width(label) + 10
        if x + need > WIDTH and x > 4.0:
            x, y = 4.0, y + KEY_ROW
        group = f'<g transform="translate({shown(x)} {shown(y)})">'
        made.append(
            f'{group}<g transform="scale(.1)">{sample}</g>{sign}{words(SAMPLE + 5, 3.7, label)}</g>'
        )
        x += need
    text = f'<g class="key" font-size="{SIZE:g}" fill="{INK}">{"".join(made)}</g>'
    return y + KEY_ROW / 2 - top if made else 0.0, text if made else ""


def shares(panel: Shares, top: float) -> tuple[float, str]:
    """Return height in px and elements of the shares below `top`."""
    largest = max((row.share for row in panel.rows if math.isfinite(row.share)), default=1.0)
    end = BEYOND * min(max(largest, 1.0), MOST)
    limit = LEFT + (RIGHT - LEFT) / end
    foot = top + HEAD + ROW * len(panel.rows)
    rows = "".join(_row(row, end, top + HEAD + ROW * k) for k, row in enumerate(panel.rows))
    parts = [
        f'<g class="shares" font-size="{SIZE:g}" fill="{INK}">',
        rows,
        f'<path d="M{shown(LEFT)} {shown(top + HEAD - 3)}V{shown(foot)}" stroke="{GREY}" stroke-width=".8"/>',
        f'<path d="M{shown(limit)} {shown(top + HEAD - 4)}V{shown(foot)}" stroke="{BAD}" stroke-width="1.6"/>',
        words(limit, top + HEAD - 7, "limit, 100 %", f'{MIDDLE} fill="{BAD}"'),
        "</g>",
    ]
    return foot + 3.0 - top, "".join(parts)


def _row(share: Share, end: float, top: float) -> str:
    """Return a name, the area of its share, and its words; a share beyond the end is cut, which two strokes show."""
    middle, shown_share = top + ROW / 2, min(share.share, end)
    right = LEFT + (RIGHT - LEFT) * shown_share / end
    box = (10 * LEFT, 10 * (top + 2.0), 10 * max(right, LEFT + 0.8), 10 * (top + ROW - 2.0))
    cut = ""
    if share.share > end:
        x, y = shown(right - 14), shown(top + ROW - 1)
        cut = f'<path d="M{x} {y}l5-{ROW - 2:g}m4 0l-5 {ROW - 2:g}" stroke="#ffffff" stroke-width="2"/>'
    bold = BOLD + f' fill="{BAD}"' if share.use.is_bad else ""
    room, clause = (LEFT - 8) / GROWTH, f", {share.clause}"
    name = fitted(fitted(share.name, max(room - width(clause), FEWEST)) + clause, room)
    label = words(RIGHT + 8, middle + 3.7, share.use.words, bold)
    return f'{words(LEFT - 6, middle + 3.7, name, END)}<g transform="scale(.1)">{area(box, share.use.grade)}</g>{cut}{label}'
