"""Draw two_discs.svg from the closed forms of the tutorial: python docs/tutorials/two_discs.py."""

from math import pi, sqrt
from pathlib import Path

MOTOR, PROPELLER = 0.8, 0.2  # inertias, kg m2
STIFFNESS, LOSS_FACTOR = 14400.0, 0.1  # of the spring, N m/rad
TORQUE, ORDER = 25.0, 2  # at the propeller: amplitude, N m
SLOW, FAST = 300.0, 1800.0  # operation, rpm
NATURAL = sqrt(STIFFNESS * (1 / MOTOR + 1 / PROPELLER))  # (A3), rad/s
INK, GREY, BLUE, RED = "#222222", "#888888", "#0b5fa5", "#c0392b"
TOP, BOTTOM = 40.0, 240.0  # of every panel, px

Scale = tuple[float, float, float, float]  # a value and its place in px, twice


def spring_torque(speed: float) -> float:
    """Return the amplitude of the torque in the spring, N m, at a speed in rpm: (A7) with F at the propeller."""
    ratio = (ORDER * speed * pi / 30 / NATURAL) ** 2
    return TORQUE * MOTOR / (MOTOR + PROPELLER) / abs(1 - ratio / (1 + 1j * LOSS_FACTOR))


def at(value: float, scale: Scale) -> float:
    """Where a value stands, px."""
    low, start, high, end = scale
    return start + (value - low) / (high - low) * (end - start)


def text(x: float, y: float, words: str, anchor: str = "middle", colour: str = INK) -> str:
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" fill="{colour}">{words}</text>'


def path(
    points: list[tuple[float, float]], colour: str, width: float = 1.5, dash: str = "none"
) -> str:
    steps = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
    return f'<polyline points="{steps}" fill="none" stroke="{colour}" stroke-width="{width}" stroke-dasharray="{dash}"/>'


def axes(
    x: Scale, y: Scale, names: tuple[str, str, str], ticks: tuple[list[int], list[int]]
) -> list[str]:
    """Frame, numbers and names (title, x, y) of a panel."""
    parts = [path([(x[1], TOP), (x[1], BOTTOM), (x[3], BOTTOM)], INK, 1)]
    parts += [text(at(value, x), BOTTOM + 14, str(value)) for value in ticks[0]]
    parts += [text(x[1] - 5, at(value, y) + 4, str(value), "end") for value in ticks[1]]
    middle = (x[1] + x[3]) / 2
    return [
        *parts,
        text(middle, 20, names[0]),
        text(middle, BOTTOM + 30, names[1]),
        text(x[1], TOP - 6, names[2]),
    ]


def shape() -> list[str]:
    """The train and below it its mode: angle along the spring, with the node."""
    left, right, middle, unit = 40.0, 200.0, 185.0, 11.0
    node = left + (right - left) * PROPELLER / (MOTOR + PROPELLER)
    coils = [
        (left + (right - left) * (0.3 + 0.02 * k), 85 + 8 * (-1) ** k * (0 < k < 20))
        for k in range(21)
    ]
    ratio = -MOTOR / PROPELLER
    return [
        text((left + right) / 2, 20, "train and mode shape"),
        path([(left, 85), *coils, (right, 85)], INK),
        f'<rect x="{left - 6}" y="50" width="12" height="70" fill="{BLUE}"/>',
        f'<rect x="{right - 6}" y="66" width="12" height="38" fill="{BLUE}"/>',
        text(left, 134, "motor"),
        text(right, 134, "propeller"),
        path([(left, middle), (right, middle)], GREY, 1),
        path(
            [
                (left, middle),
                (left, middle - unit),
                (right, middle - ratio * unit),
                (right, middle),
            ],
            RED,
        ),
        f'<circle cx="{node:.1f}" cy="{middle}" r="3.5" fill="{INK}"/>',
        text(node + 4, middle - 8, "node", "start"),
        text(left - 8, middle - unit + 4, "1", "end"),
        text(right + 8, middle - ratio * unit, f"{ratio:.0f}", "start"),
    ]


def campbell() -> list[str]:
    """Frequency of orders over speed, the natural frequency, and where they meet."""
    x, y = (0.0, 290.0, 2000.0, 490.0), (0.0, BOTTOM, 70.0, TOP)
    natural = NATURAL / (2 * pi)
    low, high = at(SLOW, x), at(FAST, x)
    parts = [
        f'<rect x="{low:.1f}" y="{TOP}" width="{high - low:.1f}" height="{BOTTOM - TOP}" fill="#eef3f8"/>'
    ]
    parts += axes(
        x, y, ("Campbell diagram", "speed, rpm", "Hz"), ([0, 1000, 2000], [0, 20, 40, 60])
    )
    parts.append(path([(x[1], at(natural, y)), (x[3], at(natural, y))], BLUE, 2))
    for order in (1, 2, 3, 4):
        end = min(x[2], 60 * y[2] / order)
        parts.append(path([(x[1], BOTTOM), (at(end, x), at(order * end / 60, y))], GREY))
        parts.append(text(at(end, x) + 3, at(order * end / 60, y) - 2, f"n={order}", "start", GREY))
        if SLOW <= 60 * natural / order <= FAST:
            parts.append(
                f'<circle cx="{at(60 * natural / order, x):.1f}" cy="{at(natural, y):.1f}" r="4" fill="{RED}"/>'
            )
    return parts


def response() -> list[str]:
    """Torque in the spring over speed."""
    x, y = (SLOW, 570.0, FAST, 770.0), (0.0, BOTTOM, 220.0, TOP)
    critical = 30 * NATURAL / pi / ORDER
    speeds = sorted({*(SLOW + 10 * k for k in range(int((FAST - SLOW) / 10) + 1)), critical})
    names = (f"torque in the spring, order {ORDER}", "speed, rpm", "N m, amplitude")
    return [
        *axes(x, y, names, ([300, 800, 1300, 1800], [0, 50, 100, 150, 200])),
        path([(at(critical, x), BOTTOM), (at(critical, x), TOP)], GREY, 1, "4 3"),
        path([(at(one, x), at(spring_torque(one), y)) for one in speeds], RED),
    ]


def figure() -> str:
    """The whole picture as SVG."""
    head = (
        '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 790 280" width="790" height="280" '
        'font-family="Helvetica, Arial, sans-serif" font-size="11">'
    )
    back = '<rect width="790" height="280" fill="white"/>'
    return "\n".join([head, back, *shape(), *campbell(), *response(), "</svg>", ""])


if __name__ == "__main__":
    Path(__file__).with_suffix(".svg").write_text(figure(), encoding="utf-8")
