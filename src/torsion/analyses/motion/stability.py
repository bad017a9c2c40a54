"""Stability of a train with joints over speed: growth rates, unstable ranges with their boundaries, and their names."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import minimize_scalar

from torsion.analyses.motion.asked import Method
from torsion.analyses.motion.floquet import MOST_HILL, Multipliers, by_hill, by_monodromy, hill_count, variation
from torsion.analyses.motion.loading import Scene, scene
from torsion.analyses.motion.losses import viscous
from torsion.analyses.motion.modes import Basis, basis, reduced
from torsion.analyses.motion.periodic import Orbit, continued
from torsion.analyses.motion.ranges import UNSTABLE, UnstableRange, indicator, unstable_ranges
from torsion.analyses.motion.zones import candidates
from torsion.arrays import ComplexArray, FloatArray
from torsion.assembly.system import System
from torsion.errors import SolveError
from torsion.findings import Progress, silent
from torsion.results import reported, result
from torsion.study import Study

MOST_SEEDS = 60  # combination resonances that are looked at between the speeds asked for
LOOK_AROUND = 0.02  # relative: how far from a combination its zone is looked for, and
UNEVEN_AROUND = 2.0  # times the unevenness of the joints beside that
BEYOND = 2.0  # times the highest mode kept: what the steps resolve of the static shapes beside it
CHECKED = 3  # speeds at which the other method checks the growth rate
MOST_CHECKED = 600  # rows of Hill's matrix for that: beyond, its eigenvalues take far longer than the growth rate


@reported
class Stability:
    """Growth rates over speed; NaN where there is no periodic motion."""

    speed: FloatArray = result("rad/s", ("speed",), "reference speeds, more of them in and around unstable ranges")
    asked: np.ndarray = result("", ("speed",), "the speed is one of those requested", key="is_asked")
    growth: FloatArray = result(
        "1/s", ("speed",), "of the fastest growing small deviation; null where there is no periodic motion"
    )
    frequency: FloatArray = result("rad/s", ("speed",), "of that motion, within half of the common frequency")
    amplitude_growth: FloatArray = result(
        "1", ("speed",), "growth over a revolution of the reference", key="factor_per_turn"
    )
    ranges: tuple[UnstableRange, ...] = result("", (), "unstable ranges of speed")
    modes: FloatArray = result("rad/s", ("mode",), "elastic ones of the train with straight joints")
    method: str = result("", (), "monodromy or hill")
    check: float = result("1/s", (), "largest difference to the other method; null where it was too large")
    unsolved: FloatArray = result("rad/s", ("unsolved",), "speeds without a periodic motion")
    loses: bool = result(
        "", (), "something damps; where nothing does, a growth of 0 is the best there is", key="something_damps"
    )
    kept: int | None = result(
        "", (), "elastic modes that the train is reduced to; null for all", key="modes_kept", default=None
    )
    left_out: float = result(
        "1/s", (), "largest change of the growth rate with twice as many, where that was tried",
        key="reduction_error_per_s", default=0.0,
    )  # fmt: skip

    @property
    def unknown(self) -> tuple[tuple[float, float], ...]:
        """Stretches of speed (rad/s) between neighbours with a periodic motion in which none was found."""
        bare = np.concatenate([[False], np.isnan(self.growth), [False]])
        first = np.maximum(np.flatnonzero(~bare[:-1] & bare[1:]) - 1, 0)
        last = np.minimum(np.flatnonzero(bare[:-1] & ~bare[1:]), len(self.speed) - 1)
        return tuple(zip(self.speed[first].tolist(), self.speed[last].tolist(), strict=True))


@dataclass
class Search:
    """A train whose growth rate is asked at many speeds; remembers what it computed."""

    at: Scene
    shapes: Basis
    reduced: Basis | None
    method: Method
    known: dict[float, tuple[Orbit, Multipliers] | None]

    def __call__(self, speed: float) -> tuple[Orbit, Multipliers] | None:
        """Orbit and exponents at a speed (rad/s); None where there is no periodic motion."""
        if speed not in self.known:
            solved = [(abs(there - speed), one) for there, one in self.known.items() if one is not None]
            near = min(solved, key=lambda one: one[0])[1][0] if solved else None
            orbit, _ = continued(self.at, speed, near)
            self.known[speed] = None if orbit is None else (orbit, self.exponents(orbit, self.method))
        return self.known[speed]

    def exponents(self, orbit: Orbit, method: Method, most: int = MOST_HILL) -> Multipliers:
        """By one of the methods; raises SolveError where Hill's matrix has more than `most` rows."""
        around = variation(self.at, orbit)
        highest = self.shapes.highest
        if self.reduced is not None:
            around, highest = around.on(self.reduced), BEYOND * self.reduced.highest
        if method == "hill":
            return by_hill(around, hill_count(around, highest, orbit.found.count), most)
        return by_monodromy(around, highest)

    def growth(self, speed: float) -> float:
        """1/s; NaN where there is no periodic motion."""
        found = self(speed)
        return np.nan if found is None else found[1].growth

    def is_unstable(self, speed: float) -> bool:
        """Growth beyond rounding."""
        found = self(speed)
        return found is not None and found[1].growth * found[1].period > UNSTABLE

    @property
    def loses(self) -> bool:
        """Something damps."""
        return self.at.system.damps and self.at.damping > 0


def search(study: Study, system: System, *, method: Method = "monodromy", modes: int | None = None) -> Search:
    """A train ready to be asked; `modes`: reduce to so many elastic modes."""
    at = scene(study, system, vibratory=False)
    shapes = basis(at.layout)
    fewer = None if modes is None else reduced(at.layout, shapes, shapes.rigid + modes)
    return Search(damped(at, fewer or shapes), shapes, fewer, method, {})


def damped(at: Scene, shapes: Basis) -> Scene:
    """The scene with dampers on the shapes of a basis for its loss factors."""
    return replace(at, layout=viscous(at.layout, shapes))


def stability(
    study: Study,
    system: System,
    speeds: FloatArray,
    *,
    method: Method = "monodromy",
    modes: int | None = None,
    progress: Progress | None = None,
) -> Stability:
    """Growth rates at reference speeds (speeds,) rad/s and everything unstable between the first and the last.

    Zones narrower than the steps are looked for around every combination of two modes. Vibratory torques are left out:
    they shift the orbit, not its stability, to first order.
    """
    tell = progress or (silent)
    ask = search(study, system, method=method, modes=modes)
    asked = np.unique(np.asarray(speeds, dtype=float))
    for k, speed in enumerate(asked.tolist()):
        tell("stability", 0.6 * k / len(asked))
        ask(speed)
    _look_between(ask, asked, tell)
    ranges = unstable_ranges(ask, tell)
    speed = np.array(sorted(ask.known))
    solved = [ask.known[one] for one in speed.tolist()]
    growth = np.array([np.nan if one is None else one[1].growth for one in solved])
    frequency = np.array(
        [np.nan if one is None or not one[1].exponent.size else one[1].exponent.imag[0] for one in solved]
    )
    with np.errstate(over="ignore"):
        factor = np.exp(growth * 2.0 * np.pi / speed)
    unsolved = speed[np.isnan(growth)]
    shapes = ask.shapes.frequency[ask.shapes.rigid :]
    return Stability(
        speed, np.isin(speed, asked), growth, frequency, factor, ranges, shapes, method, _check(ask, asked), unsolved,
        ask.loses,
    )  # fmt: skip


def _look_between(ask: Search, asked: FloatArray, tell: Progress) -> None:
    """Ask around each combination resonance for zones that fall between the speeds."""
    if len(asked) < 2:
        return
    uneven = max((step.joint.strength for step in ask.at.layout.steps), default=0.0)
    if uneven == 0.0:
        return
    seeds = candidates(ask.shapes, ask.at.layout.orders, float(asked[0]), float(asked[-1]))
    around = LOOK_AROUND * min(1.0, 20.0 * uneven) + UNEVEN_AROUND * uneven**2
    for k, seed in enumerate(seeds[:MOST_SEEDS].tolist()):
        tell("stability between the speeds", 0.6 + 0.2 * k / len(seeds))
        low, high = max(seed * (1.0 - around), float(asked[0])), min(seed * (1.0 + around), float(asked[-1]))
        inside = [speed for speed in ask.known if low <= speed <= high]
        if any(ask.is_unstable(speed) for speed in [*inside, seed]):
            continue

        def height(speed: float) -> float:
            value = indicator(ask, speed, None)
            return np.inf if np.isnan(value) else -value

        minimize_scalar(
            height, bounds=(low, high), method="bounded", options={"xatol": around * seed * 1e-2, "maxiter": 10}
        )


def _check(ask: Search, asked: FloatArray) -> float:
    """1/s: largest difference between the growth rates of both methods at a few speeds."""
    other: Method = "monodromy" if ask.method == "hill" else "hill"
    worst = np.nan
    known = [found for speed in asked.tolist() if (found := ask(speed)) is not None]
    known = known or [found for found in ask.known.values() if found is not None]
    for place in np.unique(np.linspace(0, len(known) - 1, min(CHECKED, len(known))).astype(int)).tolist():
        found = known[place]
        try:
            apart = abs(ask.exponents(found[0], other, MOST_CHECKED).growth - found[1].growth)
        except SolveError:
            continue
        worst = apart if np.isnan(worst) else max(worst, apart)
    return float(worst)


def exponents_at(ask: Search, speed: float) -> ComplexArray:
    """(exponents,) 1/s at a speed; raises SolveError where there is no periodic motion."""
    found = ask(speed)
    if found is None:
        raise SolveError(f"no periodic motion at {speed:.8g} rad/s")
    return found[1].exponent
