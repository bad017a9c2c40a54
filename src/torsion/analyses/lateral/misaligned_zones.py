"""Ranges of speed in which a misaligned shaft is unstable, with their boundaries and what meets in them."""

import numpy as np

from torsion.analyses.lateral.misaligned import (
    EXACT,
    NEUTRAL,
    Growth,
    MisalignedShaft,
    Model,
    growth,
    natural_frequencies,
)
from torsion.arrays import FloatArray
from torsion.results import derived, reported, result

POINTS = 400
SPAN = 0.05  # rad/s / the sum of both frequencies: how far around a resonance points are added
PERIODS = 3  # whole multiples of twice the speed that are looked at for a zone's name
EVEN = 1e-6  # imaginary / real part: a multiplier that is real
EXACTLY = 1e-15  # relative, of a boundary


@reported
class Zone:
    """An unstable range."""

    lower: float  # rad/s
    upper: float  # rad/s
    is_open: tuple[bool, bool] = result("", (), "[from, to] the range goes on beyond the speeds looked at")
    kind: str = result(  # "principal of 2", "sum of 1 and 2", "difference of 2 and 1", "/n" behind where n is not 1
        "", (), "principal, sum, difference, several, or mean couple", key="type"
    )
    worst: float  # rad/s of the fastest growth
    rate: float = result("1/s", (), "fastest growth in the range", key="growth_per_s")
    ratio: float = 1.0  # of these speeds / reference speed

    @derived("rad/s", (), "reference speed at which an unstable range begins", key="from_rad_per_s")
    def first(self) -> float:
        """Of the train."""
        return self.lower / self.ratio

    @derived("rad/s", (), "and ends", key="to_rad_per_s")
    def last(self) -> float:
        """Of the train."""
        return self.upper / self.ratio

    @derived("rad/s", (), "reference speed of the fastest growth", key="at_rad_per_s")
    def at(self) -> float:
        """Of the train."""
        return self.worst / self.ratio


def zones(
    shaft: MisalignedShaft, first: float, last: float, model: Model = EXACT, points: int = POINTS
) -> tuple[Zone, ...]:
    """Every unstable range between two positive speeds, ascending.

    Growth is sampled evenly and more densely where the frequencies meet; each local greatest value is sought out, so
    that a zone narrower than the spacing is still found where its growth has a slope that leads to it.
    """
    speed, rate = _sampled(shaft, first, last, model, points)
    high = rate > NEUTRAL * speed
    edges = np.flatnonzero(high[1:] != high[:-1])
    roots = [_boundary(shaft, model, speed[k : k + 2], rate[k : k + 2]) for k in edges]
    bounds = [*([first] if high[0] else []), *roots, *([last] if high[-1] else [])]
    out = []
    for low, up in zip(bounds[::2], bounds[1::2], strict=True):
        inside = (speed >= low) & (speed <= up)
        worst = float(speed[inside][rate[inside].argmax()])
        worst, most = _greatest(shaft, model, worst, max(low, worst - (up - low) / 8), min(up, worst + (up - low) / 8))
        kind = _kind(shaft, growth(shaft, np.array([worst]), model), low, up)
        out.append(Zone(low, up, (low == first and bool(high[0]), up == last and bool(high[-1])), kind, worst, most))
    return tuple(out)


def resonances(shaft: MisalignedShaft) -> dict[str, float]:
    """Speeds at which n times twice the speed is twice a frequency, their sum or their difference, by name; rad/s."""
    one, two = natural_frequencies(shaft).frequency[0]
    parts = {"principal of 1": 2.0 * one, "principal of 2": 2.0 * two, "sum of 1 and 2": one + two}
    parts["difference of 2 and 1"] = two - one
    return {
        name + (f" /{n}" if n > 1 else ""): float(total) / (2.0 * n)
        for name, total in parts.items()
        for n in range(1, PERIODS + 1)
    }


def _sampled(
    shaft: MisalignedShaft, first: float, last: float, model: Model, points: int
) -> tuple[FloatArray, FloatArray]:
    """Speeds and growth: an even grid, points around every resonance, and every local greatest value below zero."""
    known = np.array(list(resonances(shaft).values()))
    width = SPAN * float(natural_frequencies(shaft).frequency.sum())
    near = (known[:, None] + width * np.linspace(-1.0, 1.0, 41) ** 3).ravel()
    speed = np.unique(np.concatenate([np.linspace(first, last, points), near[(near > first) & (near < last)]]))
    rate = growth(shaft, speed, model).rate
    peak = np.flatnonzero((rate[1:-1] > rate[:-2]) & (rate[1:-1] >= rate[2:]) & (rate[1:-1] <= 0.0)) + 1
    more = [_greatest(shaft, model, speed[k], speed[k - 1], speed[k + 1]) for k in peak]
    if not more:
        return speed, rate
    speed, rate = np.append(speed, [one[0] for one in more]), np.append(rate, [one[1] for one in more])
    rank = np.argsort(speed)
    return speed[rank], rate[rank]


def _greatest(shaft: MisalignedShaft, model: Model, start: float, low: float, up: float) -> tuple[float, float]:
    """Speed and rate of the fastest growth between two speeds; `start` where nothing better is found."""
    from scipy.optimize import minimize_scalar

    def down(at: float) -> float:
        return -float(growth(shaft, np.array([at]), model).rate[0])

    found = minimize_scalar(down, bounds=(low, up), method="bounded", options={"xatol": 1e-9 * up, "maxiter": 40})
    best = max((-down(start), float(start)), (-float(found.fun), float(found.x)))
    return best[1], best[0]


def _boundary(shaft: MisalignedShaft, model: Model, speed: FloatArray, rate: FloatArray) -> float:
    """Speed of no growth between two speeds; beside a range without growth or decay, of growth beyond rounding."""
    from scipy.optimize import brentq

    level = 0.0 if rate.min() < -NEUTRAL * speed.max() else NEUTRAL

    def above(at: float) -> float:
        return float(growth(shaft, np.array([at]), model).rate[0] - level * at)

    return float(brentq(above, speed[0], speed[1], xtol=EXACTLY * speed[1], rtol=4 * EXACTLY))


def _kind(shaft: MisalignedShaft, at: Growth, low: float, up: float) -> str:
    """The resonance nearest to the zone's worst speed among those whose multipliers are of its sort."""
    if sum(low < speed < up for name, speed in resonances(shaft).items() if "/" not in name) > 1:
        return "several"
    speed, half = float(at.speed[0]), float(np.pi * at.frequency[0] / at.speed[0])
    is_real = abs(np.sin(half)) < EVEN
    known = resonances(shaft)
    fitting = [name for name in known if name.startswith("principal") == is_real]
    return min(fitting, key=lambda name: abs(known[name] - speed))
