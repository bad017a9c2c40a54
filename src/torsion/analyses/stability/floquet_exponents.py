"""Floquet exponents of a train about its periodic motion at one speed, by the monodromy matrix or by Hill's matrix."""

from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from torsion.analyses.law_slopes import mean_speed_slopes
from torsion.analyses.stability.equations_of_motion import (
    damper_matrices,
    entries,
    mean_angle,
    state,
    torque_rates,
)
from torsion.analyses.stability.mean_speed import SLOW, agrees, drift_slope
from torsion.analyses.stability.mechanism import Layout, gathered
from torsion.analyses.stability.mechanism_loads import Scene, scene
from torsion.analyses.stability.periodic_orbits import Orbit, continued, nearest
from torsion.analyses.stability.straight_modes import Basis, basis, reduced, viscous
from torsion.arrays import ComplexArray, FloatArray
from torsion.assembly.system import System
from torsion.errors import SolveError
from torsion.kernels.periodic.harmonic_balance import Motion, motion_of, points_in_time
from torsion.kernels.periodic.hill import DOUBLE, couplings_of, harmonics_of, hill_exponents
from torsion.kernels.periodic.monodromy import (
    exponents,
    monodromy,
    mostly_rigid,
    real_motions,
    rigid_motion,
    steps_for,
)
from torsion.study import Study

KEPT_VECTOR = 1e-5  # relative: how well a motion that must repeat does so, to be taken out of the monodromy matrix
REST = 1e-9  # relative: what a basis of modes may miss of a motion that repeats itself
APART = 1e-10  # relative: of a motion that others combine to, less is left
BEYOND = 2.0  # times the highest mode kept: what the steps resolve of the static shapes beside it
HIGHEST = (
    3.0  # times the highest order of a joint times the highest speed: modes up to there are kept
)
FEWEST_MODES, MOST_MODES = 1, 12  # elastic ones
UNSTABLE = 1e-7  # growth over one common period: less is rounding
Method = Literal["hill", "monodromy"]
MOST_HILL = 2500  # rows of the eigenvalue problem


@dataclass(frozen=True)
class Variation:
    """Linear equations of a small deviation from a periodic motion, over one common period."""

    mass: FloatArray  # (times, size, size)
    damping: FloatArray
    stiffness: FloatArray
    period: float  # s
    repeated: FloatArray  # (motions, 2 size, times) motions (y, y') that repeat themselves exactly
    is_free: bool = False  # nothing holds the train: the first of these is its own motion

    @property
    def size(self) -> int:
        """Number of coordinates or modes."""
        return int(self.mass.shape[1])

    @property
    def w0(self) -> float:
        """rad/s."""
        return 2.0 * np.pi / self.period

    def on(self, reduced: Basis) -> "Variation":
        """The same on a basis of modes and, behind them, of what the motions that repeat themselves have beside it.

        Without that they would not quite repeat themselves, and seem to grow or to die out.
        """
        missed = _beyond(reduced, self.repeated[:, : self.size])
        shape = np.column_stack([reduced.shape, missed])
        mass, damping, stiffness = (
            shape.T @ part @ shape for part in (self.mass, self.damping, self.stiffness)
        )
        parts = [part for motion in self.repeated for part in np.split(motion, 2)]
        repeated = [
            np.concatenate([reduced.share(part), (missed.T * reduced.inertia) @ part])
            for part in parts
        ]
        form = len(self.repeated), 2 * shape.shape[1], len(self.mass)
        return Variation(
            mass, damping, stiffness, self.period, np.reshape(repeated, form), self.is_free
        )

    @property
    def turning(self) -> FloatArray:
        """(size,) deviation of a train whose mean motion goes on further; only of a free one."""
        return np.asarray(self.repeated[0, : self.size].mean(axis=1))


def _beyond(reduced: Basis, motions: FloatArray) -> FloatArray:
    """(size, shapes) of generalised inertia 1: what motions (motions, size, times) have that a basis has not."""
    heavy = np.sqrt(reduced.inertia)[:, None]
    weighted = heavy * np.concatenate([np.zeros((len(heavy), 0)), *motions], axis=1)
    within = heavy * reduced.shape
    rest = weighted - within @ (within.T @ weighted)
    left, size, _ = np.linalg.svd(rest, full_matrices=False)
    left = left[:, size > REST * np.linalg.norm(weighted)]
    return np.asarray(np.divide(left, heavy, out=np.zeros_like(left), where=heavy > 0))


def variation(at: Scene, orbit: Orbit) -> Variation:
    """The variation of the equations about an orbit.

    A vibratory torque goes by the angle of its own station: by the clock it would hold the train to a phase. Of a train
    with loss factors, scene and orbit must be those of the dampers that stand for them (`straight_modes.viscous`):
    a loss factor has no meaning for a deviation that grows.
    """
    loading, free = orbit.now.loading, at.layout.free
    times = points_in_time(orbit.found.count)
    motion = motion_of(orbit.found.harmonic, loading.w0, times)
    turned = mean_angle(loading, times)
    now = state(at.layout, loading, motion, orbit.found.load, turned)
    mass, damping, stiffness = entries(at.layout, loading, now).full(free)
    own = np.arange(free)
    stiffness[:, own, own] -= gathered(
        at.layout, now.turning.first * torque_rates(loading, turned) / now.rate
    ).T
    if at.layout.dampers.size.size:
        damper_damping, damper_stiffness = damper_matrices(at.layout, now)
        damping, stiffness = damping + damper_damping, stiffness + damper_stiffness
    repeated = _repeated(at.layout, loading.speed, motion)
    return Variation(mass, damping, stiffness, loading.period, repeated, bool(at.layout.floating))


def _repeated(layout: Layout, mean: float, motion: Motion) -> FloatArray:
    """(motions, 2 free, times) what repeats itself unless something holds it: all that turns, turning further.

    Where parts are joined by damping alone, so does every one without a joint, turned by a fixed angle.
    """
    free, times = motion.speed.shape
    found = list[FloatArray]()
    if layout.floating:
        turning = np.isin(np.arange(free), np.concatenate(layout.floating))[:, None]
        found.append(
            np.concatenate([turning * (mean + motion.speed), turning * motion.acceleration])
        )
    for group in layout.loose:
        found.append(
            np.concatenate([np.repeat(group[:, None], times, axis=1), np.zeros((free, times))])
        )
    return np.array(found).reshape(-1, 2 * free, times)


@dataclass(frozen=True)
class Multipliers:
    """Floquet exponents of a train, without those of its free turning, the fastest growing first."""

    exponent: ComplexArray  # (exponents,) 1/s, imaginary part within half of w0
    vector: ComplexArray  # (coordinates or modes, exponents) deviation at reference angle zero; NaN where not computed
    speed: ComplexArray  # (coordinates or modes, exponents) its rate of change
    period: float  # s
    rigid: int | None = (
        None  # the real exponent whose motion is mostly a turning of the whole train, if there is one
    )
    drift: float = (
        np.nan
    )  # 1/s: that exponent, where it was distinguished as the drift of the mean speed
    is_doubtful: bool = False

    def distinguished(self, correction: float) -> "Multipliers":
        """The torsional exponents alone; the drift of the mean speed beside them, with a correction in 1/s."""
        rest = np.arange(len(self.exponent)) != self.rigid
        drift = float(self.exponent[self.rigid].real) + correction
        return replace(
            self,
            exponent=self.exponent[rest],
            vector=self.vector[:, rest],
            speed=self.speed[:, rest],
            rigid=None,
            drift=drift,
        )

    @property
    def fastest(self) -> tuple[float, float]:
        """Growth (1/s) of the fastest growing motion, negative where all die out, and its frequency (rad/s)."""
        return (
            (self.exponent[0].real, self.exponent[0].imag)
            if self.exponent.size
            else (-np.inf, np.nan)
        )

    @property
    def growth(self) -> float:
        """1/s of the fastest growing motion."""
        return float(self.fastest[0])

    @property
    def multiplier(self) -> ComplexArray:
        """(exponents,) factor over one common period."""
        return np.asarray(np.exp(self.exponent * self.period))


def by_monodromy(around: Variation, highest: float) -> Multipliers:
    """Exponents by the monodromy matrix, in steps that resolve a highest frequency (rad/s)."""
    size = around.size
    scale = np.concatenate([np.ones(size), np.full(size, around.w0)])
    visited, steps = list[FloatArray](), steps_for(around.period, highest)
    full = monodromy(
        around.mass, around.damping, around.stiffness, around.period, steps, visited=visited
    )
    whole = full / scale[:, None] * scale
    back = np.eye(2 * size)
    for one in around.repeated:
        start = whole @ (back.T @ (one[:, 0] / scale))  # once around: what has no inertia follows
        size_of = np.linalg.norm(start)
        if size_of <= APART * np.linalg.norm(one[:, 0] / scale):
            continue
        if np.linalg.norm(whole @ start - start) <= KEPT_VECTOR * size_of:
            turned = np.linalg.qr(np.column_stack([start / size_of, np.eye(len(start))]))[0][:, 1:]
            whole, back = turned.T @ whole @ turned, back @ turned
    value, vector = np.linalg.eig(whole)
    order = np.argsort(-np.abs(value), kind="stable")
    shape = (back @ vector[:, order]) * scale[:, None]
    exponent = exponents(value[order], around.period)

    rigid = None
    if around.is_free:
        mass = around.mass.mean(axis=0)
        rigid = rigid_motion(full, np.array(visited), value[order], mass, around.turning, around.w0)
    return Multipliers(exponent, shape[:size], shape[size:], around.period, rigid)


def by_hill(around: Variation, highest: float, fewest: int, most: int = MOST_HILL) -> Multipliers:
    """Exponents by the eigenvalues of Hill's matrix, with harmonics up to a highest frequency (rad/s).

    fewest: harmonics of the common period, at least. Raises SolveError where it has more than `most` rows.
    """
    size, count = around.size, int(max(fewest, np.ceil(highest / around.w0) + 4))
    if 2 * size * (2 * count + 1) > most:
        message = f"Hill's matrix of {size} coordinates and {count} harmonics is too large"
        raise SolveError(message, "`method: monodromy`", ("analyses", "stability", "method"))
    entries = couplings_of(around.mass, around.damping, around.stiffness)
    found = hill_exponents(
        entries, around.w0, count, size, harmonics_of(around.repeated[:, :size], count)
    )
    value = found.exponent
    order = np.argsort(-value.real, kind="stable")
    start = found.vector[order]
    rate = (value[order, None, None] + 1j * around.w0 * np.arange(-count, count + 1)) * start
    within = (
        value[order].real
        + 1j * (np.mod(value[order].imag / around.w0 + 0.5, 1.0) - 0.5) * around.w0
    )

    rigid = None
    if around.is_free:
        mass, turning = around.mass.mean(axis=0), around.turning
        places = real_motions(within.imag / around.w0)
        mean_square = np.einsum("nik,ij,njk->n", start[places].conj(), mass, start[places]).real
        along = np.abs(start[places][:, :, count] @ mass @ turning) ** 2
        share = along / (turning @ mass @ turning * mean_square)
        # The second of a double exponent 0 is that of the mean speed; its vector lacks the free turning.
        rigid = mostly_rigid(
            places, np.where(np.abs(within[places]) < DOUBLE * around.w0, 1.0, share)
        )
    return Multipliers(within, start.sum(axis=2).T, rate.sum(axis=2).T, around.period, rigid)


@dataclass
class Search:
    """The growth rates of a train at any speeds; keeps what it has computed."""

    at: Scene
    shapes: Basis
    reduced: Basis | None
    method: Method = "monodromy"
    known: dict[float, tuple[Orbit, Multipliers] | None] = field(default_factory=dict)
    unhelped: "Search | None" = (
        None  # the same train without the slopes that damp its mean speed alone
    )

    def __call__(self, speed: float) -> tuple[Orbit, Multipliers] | None:
        """Orbit and exponents at a speed (rad/s); None where there is no periodic motion."""
        if speed not in self.known:
            solved = (one[0] for one in self.known.values() if one is not None)
            orbit, _ = continued(self.at, speed, nearest(speed, solved))
            is_lost = orbit is None or (self.unhelped is not None and self.unhelped(speed) is None)
            self.known[speed] = (
                None if orbit is None or is_lost else (orbit, self.exponents(orbit, self.method))
            )
        return self.known[speed]

    def exponents(self, orbit: Orbit, method: Method, most: int = MOST_HILL) -> Multipliers:
        """By one of the methods; raises SolveError where Hill's matrix has more than `most` rows.

        Drive and load do not follow a torsional vibration as they follow the mean speed: of the torsional exponents
        with and without the slopes that act on the mean speed alone the worse ones count. The drift is that with all.
        """
        found = self._exponents(orbit, method, most)
        without = None if self.unhelped is None else self.unhelped(orbit.now.loading.speed)
        if self.unhelped is None or without is None:
            return found
        bare = self.unhelped.exponents(without[0], method, most)
        worse = max(found, bare, key=lambda side: side.growth)
        return replace(
            worse, rigid=None, drift=found.drift, is_doubtful=found.is_doubtful or bare.is_doubtful
        )

    def _exponents(self, orbit: Orbit, method: Method, most: int) -> Multipliers:
        """Return the exponents with whatever slopes act in the scene."""
        around = variation(self.at, orbit)
        highest = self.shapes.highest
        if self.reduced is not None:
            around, highest = around.on(self.reduced), BEYOND * self.reduced.highest
        if method == "hill":
            return self._distinguish(orbit, by_hill(around, highest, orbit.found.count, most))
        return self._distinguish(orbit, by_monodromy(around, highest))

    def _distinguish(self, orbit: Orbit, found: Multipliers) -> Multipliers:
        """The exponents with the drift of the mean speed beside them, where both tests say that there is one.

        A fast growing one has to have the sign that the torque lost by the vibration gives it.
        """
        if found.rigid is None or not (self.loses or orbit.now.loading.damping.any()):
            return replace(found, rigid=None)
        inertia = float(self.at.layout.inertia.sum())
        growth = float(found.exponent[found.rigid].real) - orbit.now.beside / inertia
        if growth > SLOW and not agrees(
            growth, drift_slope(self.at, orbit.now.loading.speed, orbit)[0], inertia
        ):
            return replace(found, rigid=None, is_doubtful=True)
        return found.distinguished(-orbit.now.beside / inertia)

    def drift(self, speed: float) -> float:
        """1/s of the mean speed; NaN where it was not distinguished."""
        found = self(speed)
        return np.nan if found is None else found[1].drift

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
        """Something damps; a slope that acts on the mean speed alone does not."""
        if self.unhelped is not None:
            return self.unhelped.loses
        if self.at.system.damps and self.at.damping > 0:
            return True
        return any(
            found is not None and bool(found[0].now.loading.damping.any())
            for found in self.known.values()
        )


def growth_search(
    study: Study, system: System, *, method: Method = "monodromy", modes: int | None = None
) -> Search:
    """A train whose growth rates are wanted; `modes`: reduce to so many elastic modes."""
    at = scene(study, system, vibratory=False)
    shapes = basis(at.layout)
    fewer = None if modes is None else reduced(at.layout, shapes, shapes.rigid + modes)
    lossy = damped(at, fewer or shapes)
    search = Search(lossy, shapes, fewer, method)
    if mean_speed_slopes(study):
        search.unhelped = Search(replace(lossy, laws="negative"), shapes, fewer, method)
    return search


def damped(at: Scene, shapes: Basis) -> Scene:
    """The scene with dampers on the shapes of a basis for its loss factors."""
    return replace(at, layout=viscous(at.layout, shapes))


def modes_that_matter(
    at: Scene, shapes: Basis, fastest: float, requested: int | None = None
) -> Basis:
    """The rigid motions and as many elastic modes as requested.

    Else the modes up to three times the highest order of a joint at the fastest speed (rad/s): 1 to 12 elastic ones.
    """
    elastic = shapes.frequency[shapes.rigid :]
    highest = HIGHEST * float(max(at.layout.orders, default=at.order)) * fastest
    number = int(np.count_nonzero(elastic <= highest))
    number = min(max(number, FEWEST_MODES), MOST_MODES) if requested is None else requested
    return reduced(at.layout, shapes, shapes.rigid + min(number, len(elastic)))
