"""The look of lines, ranges and symbols: each differs by dashes or pattern as well as by colour, and so in gray too."""

from dataclasses import dataclass

from torsion.output.figures.figure import Grade, Pen

# Okabe and Ito (2008), without the yellow, which is too light on paper
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00", "#444444")
DASHES = (
    "",
    "7 2.5",
    "1.6 2",
    "7 2 1.6 2",
    "3.5 2",
    "9 2 1.6 2 1.6 2",
)  # with seven colours 42 different lines
INK, GREY, GRID, BAD = "#222222", "#777777", "#dddddd", "#b3261e"


@dataclass(frozen=True)
class Stroke:
    """Colour, width in px and dashes."""

    colour: str
    width: float = 1.3
    dash: str = ""

    def attributes(self, unit: float = 1.0) -> str:
        """Return the attributes in SVG, where so many units are one px."""
        dash = " ".join(f"{unit * float(part):g}" for part in self.dash.split())
        dashed = f' stroke-dasharray="{dash}"' if dash else ""
        return f'stroke="{self.colour}" stroke-width="{unit * self.width:.3g}"{dashed}'


ROLES = {
    "synthesis": Stroke(INK, 2.6),
    "limit": Stroke(BAD, 1.5, "10 3"),
    "second limit": Stroke(COLOURS[1], 1.3, "4 2.5"),
    "rated": Stroke(INK, 0.9, "10 2.5 1.6 2.5"),
    "natural": Stroke(GREY, 0.8, "1.6 2"),
    "zero": Stroke(GREY, 0.8),
    "plain": Stroke(INK, 1.2),
    "pale": Stroke("#999999", 0.9),
    "first": Stroke(INK, 1.1, "6 2.5"),
    "forward": Stroke(COLOURS[0], 1.4),
    "nearly in a plane": Stroke(COLOURS[2], 1.4, "7 2 1.6 2"),
    "backward": Stroke(COLOURS[1], 1.4, "5 2.5"),
    "unstable": Stroke(BAD, 1.4),
    "best": Stroke(COLOURS[2], 2.0),
    "outside": Stroke("#888888", 1.2),
    "at rest": Stroke("#7b3294", 1.3, "5 2.5"),
}
BANDS = {  # fill, colour of the hatching ('' for none), its distance in px, sign of its slope
    "range": ("#e8eef4", "", 0.0, 1),
    "barred": ("#f9ebc8", "#b98900", 9.0, 1),
    "unstable": ("#f6d9d6", BAD, 12.0, -1),
    "no answer": ("#f6e4e2", BAD, 4.5, 1),
    "doubt": ("#ececec", "", 0.0, 1),
    "spread": ("#c3ccd4", "#6a7682", 5.0, 1),
}


@dataclass(frozen=True)
class Pattern:
    """Fill and hatching of an area, and what it stands for."""

    fill: str
    words: str
    colour: str = ""  # of the hatching; "" for none
    apart: float = 0.0  # px
    slopes: tuple[int, ...] = ()
    dash: str = ""


GRADES: dict[Grade, Pattern] = {  # from light to dark in gray too
    "low": Pattern("#e9f1f8", "below 50 % of the limit"),
    "middle": Pattern("#b3d0e8", "50 to 80 %"),
    "high": Pattern("#dd9430", "80 to 100 %"),
    "over": Pattern(BAD, "FAIL", "#ffffff", 4.0, (1,)),
    "no answer": Pattern("#ffffff", "no answer", BAD, 4.0, (1, -1)),
    "not judged": Pattern("#ffffff", "stress or torque not judged", "#888888", 3.0, (1,), "1 2.5"),
}
MARKED = Stroke(BAD, 2.2)  # outline of what does not keep a limit, of whatever kind
SYMBOLS = {  # path around (0, 0) in tenths of px, filled or not; about 6 px wide
    "disc": ("m-30 0a30 30 0 1 0 60 0a30 30 0 1 0-60 0z", True),
    "ring": ("m-65 0a65 65 0 1 0 130 0a65 65 0 1 0-130 0z", False),
    "square": ("m-27-27h54v54h-54z", True),
    "box": ("m-32-32h64v64h-64z", False),
    "triangle": ("m0-36l34 60h-68z", True),
    "down": ("m0 36l34-60h-68z", True),
    "diamond": ("m0-38l32 38l-32 38l-32-38z", True),
    "cross": ("m-30-30l60 60m0-60l-60 60", False),
    "plus": ("m-36 0h72m-36-36v72", False),
    "open triangle": ("m0-40l35 66h-70z", False),
    "open diamond": ("m0-42l36 42l-36 42l-36-42z", False),
    "star": ("m0-60l14 41h44l-36 26l14 42l-36-26l-36 26l14-42l-36-26h44z", True),
    "dot": ("m-17 0a17 17 0 1 0 34 0a17 17 0 1 0-34 0z", True),
}


def stroke(pen: Pen, weight: float = 1.0) -> Stroke:
    """Return the stroke of a role, or of the line of that number: no two of the first 42 look alike."""
    if isinstance(pen, str):
        role = ROLES[pen]
        return Stroke(role.colour, role.width * weight, role.dash)
    return Stroke(COLOURS[pen % len(COLOURS)], 1.3 * weight, DASHES[pen % len(DASHES)])
