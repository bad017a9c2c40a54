"""Grades of use: areas by colour and pattern, their key, and shares of limits as areas beside a line at the limit."""

import math
from collections.abc import Iterable

from torsion.output.drawing.frame import END, MIDDLE, WIDTH
from torsion.output.drawing.pens import BAD, GRADES, GREY, INK, MARKED, Stroke
from torsion.output.drawing.plot import hatching
from torsion.output.drawing.words import GROWTH, SIZE, clean, fitted, plain, shown, width, words
from torsion.output.figures.figure import Grade, Shares, Use

Box = tuple[float, float, float, float]
SAMPLE, KEY_ROW = 24.0, 16.0  # px: length of a sample; height of a row of a key
LEFT, RIGHT, ROW, HEAD = (
    240.0,
    430.0,
    13.2,
    16.0,
)  # px: of the shares, whose names and words stand beside them
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


def key(uses: Iterable[Use], top: float) -> tuple[float, str]:
    """Return height in px and elements of the key of the grades and marks that are there."""
    known_uses = list(uses)
    grades = {use.grade for use in known_uses}
    box = (0.0, -50.0, 10 * SAMPLE, 50.0)
    entries = [(area(box, grade), GRADES[grade].words) for grade in GRADES if grade in grades]
    if any(use.mark for use in known_uses):
        outline = f'<path d="M0-50h{10 * SAMPLE:g}v100h-{10 * SAMPLE:g}z" fill="none" {MARKED.attributes(10.0)}/>'
        entries.append((outline, "a limit of any kind fails"))
    samples = [
        (SAMPLE, f'<g transform="scale(.1)">{sample}</g>', label) for sample, label in entries
    ]
    foot, text = key_rows(samples, 4.0, top + KEY_ROW / 2, "grades")
    return foot - top, text


def key_rows(
    entries: Iterable[tuple[float, str, str]], left: float, middle: float, kind: str = "key"
) -> tuple[float, str]:
    """Return foot in px and elements of samples with their names, in rows from the middle of the first.

    entries: width in px of a sample, its elements around the middle of a row, its name.
    """
    x, y, made = left, middle, list[str]()
    for wide, sample, name in entries:
        need = wide + 5 + GROWTH * width(plain(name)) + 12
        if x + need > WIDTH and x > left:
            x, y = left, y + KEY_ROW
        group = f'<g data-name="{clean(plain(name))}" transform="translate({shown(x)} {shown(y)})">'
        made.append(f"{group}{sample}{words(wide + 5, 3.7, name)}</g>")
        x += need
    if not made:
        return middle - KEY_ROW / 2, ""
    text = f'<g class="{kind}" font-size="{SIZE:g}" fill="{INK}">{"".join(made)}</g>'
    return y + KEY_ROW / 2, text


def shares(panel: Shares, top: float) -> tuple[float, str]:
    """Return height in px and elements of the shares below `top`."""
    largest = max((row.share for row in panel.rows if math.isfinite(row.share)), default=1.0)
    end = BEYOND * min(max(largest, 1.0), MOST)
    limit = LEFT + (RIGHT - LEFT) / end
    foot = top + HEAD + ROW * len(panel.rows)
    parts = [f'<g class="shares" font-size="{SIZE:g}" fill="{INK}">']
    for k, row in enumerate(panel.rows):
        upper = top + HEAD + ROW * k
        right = LEFT + (RIGHT - LEFT) * min(row.share, end) / end
        room, clause = (LEFT - 8) / GROWTH, f", {row.clause}"
        name = fitted(fitted(row.name, max(room - width(clause), FEWEST)) + clause, room)
        box = (10 * LEFT, 10 * (upper + 2.0), 10 * max(right, LEFT + 0.8), 10 * (upper + ROW - 2.0))
        parts.append(words(LEFT - 6, upper + ROW / 2 + 3.7, name, END))
        parts.append(f'<g transform="scale(.1)">{area(box, row.use.grade)}</g>')
        if row.share > end:  # two strokes show that it is cut
            cut = f"M{shown(right - 14)} {shown(upper + ROW - 1)}l5-{ROW - 2:g}m4 0l-5 {ROW - 2:g}"
            parts.append(f'<path d="{cut}" stroke="#ffffff" stroke-width="2"/>')
        bold = BOLD + f' fill="{BAD}"' if row.use.mark else ""
        parts.append(words(RIGHT + 8, upper + ROW / 2 + 3.7, row.use.words, bold))
    for x, begin, look in (
        (LEFT, 3, f'stroke="{GREY}" stroke-width=".8"'),
        (limit, 4, f'stroke="{BAD}" stroke-width="1.6"'),
    ):
        parts.append(f'<path d="M{shown(x)} {shown(top + HEAD - begin)}V{shown(foot)}" {look}/>')
    parts.append(words(limit, top + HEAD - 7, "limit, 100 %", f'{MIDDLE} fill="{BAD}"'))
    return foot + 3.0 - top, "".join([*parts, "</g>"])
