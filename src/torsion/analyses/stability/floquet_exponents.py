"""Floquet exponents of a train about its periodic motion at one speed, by the monodromy matrix or by Hill's matrix."""

from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from torsion.analyses.law_slopes import mean_speed_slopes
from torsion.analyses.stability.equations_of_motion import entries, mean_angle, state
from torsion.analyses.stability.mean_speed import SLOW, drift_slope
from torsion.analyses.stability.mechanism import gathered
from torsion.analyses.stability.mechanism_loads import Scene, scene
from torsion.analyses.stability.periodic_orbits import Orbit, continued
from torsion.analyses.stability.straight_modes import Basis, at_coordinates, basis, reduced, viscous
from torsion.arrays import ComplexArray, FloatArray
from torsion.assembly.system import System
from torsion.errors import SolveError
from torsion.kernels.periodic.harmonic_balance import motion_of, points_in_time
from torsion.kernels.periodic.hill import DOUBLE, harmonics_of, hill_exponents
from torsion.kernels.periodic.monodromy import (
    GONE,
    STAGES,
    exponents,
    monodromy,
    rigid_motion,
    steps_for,
)
from torsion.study import Study

KEPT_VECTOR = 1e-5  # relative: how well a motion that must repeat does so, to be taken out of the monodromy matrix
REST = 1e-9  # relative: what a basis of modes may miss of a motion that repeats itself
APART = 1e-10  # relative: of a motion that others combine to, less is left
BEYOND = 2.0  # times the highest mode kept: what the steps resolve of the static shapes beside it
# Modes up to so many times the highest order of a joint times the highest speed are kept.
HIGHEST = 3.0
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


def variation(mechanism: Scene, orbit: Orbit, reduced: Basis | None = None) -> Variation:
    """Return the variation of the equations about an orbit, of the coordinates or on a basis of modes.

    The basis is widened by what the motions that repeat themselves have in addition: without that they would not quite
    repeat themselves, and seem to grow or to die out.

    A vibratory torque goes by the angle of its own station: by the clock it would hold the train to a phase. Of a train
    with loss factors, scene and orbit must be those of the dampers that stand for them (`straight_modes.viscous`):
    a loss factor has no meaning for a deviation that grows.
    """
    layout = mechanism.layout
    loading = orbit.operation.loading
    free = mechanism.layout.free
    times = points_in_time(orbit.balance.count)
    motion = motion_of(orbit.balance.harmonic, loading.w0, times)
    turned = mean_angle(loading, times)
    moving = state(layout, loading, motion, orbit.balance.load, turned)
    couplings = entries(layout, loading, moving)
    order = loading.order * loading.multiple
    phase = np.exp(1j * np.outer(order, turned))
    torque_rates = ((1j * loading.speed * order * loading.vibratory) @ phase).real
    couplings.stiffness[:free] -= gathered(
        layout, moving.turning.first * torque_rates / moving.rate
    )

    # What repeats itself unless something holds it: all that turns, turning further, and, where parts are joined by
    # damping alone, every part without a joint, turned by a fixed angle.
    repeated = list[FloatArray]()
    if layout.floating:
        turning = np.isin(np.arange(free), np.concatenate(layout.floating))[:, None]
        speed = loading.speed + motion.speed
        repeated.append(np.concatenate([turning * speed, turning * motion.acceleration]))
    driven = {int(layout.coordinate[step.outer]) for step in layout.steps}
    for group in layout.floating if len(layout.floating) > 1 else ():
        if not driven & set(group):
            angle = np.repeat(np.isin(np.arange(free), group)[:, None], times, axis=1)
            repeated.append(np.concatenate([angle, np.zeros((free, times))]))
    motions = np.reshape(repeated, (-1, 2, free, times))

    shape = np.eye(free)
    if reduced is not None:
        # Shapes of generalised inertia 1 for what the basis misses of the repeated motions.
        heavy = np.sqrt(reduced.inertia)[:, None]
        weighted = heavy * motions[:, 0].swapaxes(0, 1).reshape(free, -1)
        within = heavy * reduced.shape
        missing = weighted - within @ (within.T @ weighted)
        left, extent, _ = np.linalg.svd(missing, full_matrices=False)
        left = left[:, extent > REST * np.linalg.norm(weighted)]
        missed = np.divide(left, heavy, out=np.zeros_like(left), where=heavy > 0)
        shape = np.column_stack([reduced.shape, missed])
        by_coordinate = np.moveaxis(motions, 2, 0)
        beside = np.tensordot(missed.T * reduced.inertia, by_coordinate, 1)
        motions = np.moveaxis(np.concatenate([reduced.share(by_coordinate), beside]), 0, 2)
    mass, damping, stiffness = couplings.full(shape)
    if layout.dampers.size.size:
        twist = at_coordinates(layout, moving.turning.first) @ shape
        pull = np.swapaxes(layout.dampers.size[:, None] * twist, 1, 2)
        slope = at_coordinates(layout, moving.turning.second * moving.rate) @ shape
        damping, stiffness = damping + pull @ twist, stiffness + pull @ slope
    return Variation(
        mass,
        damping,
        stiffness,
        2.0 * np.pi / loading.w0,
        motions.reshape(len(motions), 2 * shape.shape[1], times),
        bool(layout.floating),
    )


@dataclass(frozen=True)
class Multipliers:
    """Floquet exponents of a train, without those of its free turning, the fastest growing first."""

    exponent: ComplexArray  # (exponents,) 1/s, imaginary part within half of w0
    vector: ComplexArray  # (coordinates or modes, exponents) deviation at reference angle zero; NaN where not computed
    speed: ComplexArray  # (coordinates or modes, exponents) its rate of change
    period: float  # s
    rigid: int | None = (
        None  # real exponent of a motion that is mostly a turning of the whole train
    )
    drift: float = (
        np.nan
    )  # 1/s: that one, where it was distinguished as the drift of the mean speed
    is_doubtful: bool = False

    @property
    def growth(self) -> float:
        """Growth of the fastest growing motion, 1/s; negative where all die out."""
        return float(self.exponent[0].real) if self.exponent.size else -np.inf

    @property
    def multiplier(self) -> ComplexArray:
        """(exponents,) factor over one common period."""
        return np.exp(self.exponent * self.period)


def by_monodromy(around: Variation, highest: float, stages: int = STAGES) -> Multipliers:
    """Return the exponents by the monodromy matrix, in steps that resolve a highest frequency (rad/s)."""
    size = around.mass.shape[1]
    scale = np.repeat([1.0, 2.0 * np.pi / around.period], size)
    visited = list[FloatArray]()
    steps = steps_for(around.period, highest)
    matrices = around.mass, around.damping, around.stiffness
    full = monodromy(*matrices, around.period, steps, stages, visited=visited)
    matrix = full / scale[:, None] * scale
    basis_of_rest = np.eye(2 * size)
    for motion in around.repeated[:, :, 0] / scale:
        start = matrix @ (basis_of_rest.T @ motion)  # once around: what has no inertia follows
        length = np.linalg.norm(start)
        if length <= APART * np.linalg.norm(motion):
            continue
        if np.linalg.norm(matrix @ start - start) <= KEPT_VECTOR * length:
            onto = np.linalg.qr(np.column_stack([start / length, np.eye(len(start))]))[0][:, 1:]
            matrix = onto.T @ matrix @ onto
            basis_of_rest = basis_of_rest @ onto
    value, vector = np.linalg.eig(matrix)
    order = np.argsort(-np.abs(value), kind="stable")
    shape = (basis_of_rest @ vector[:, order]) * scale[:, None]

    def share(place: int) -> float:
        """Return the share of a turning of it all in the motion exp(growth t) p(t) of a multiplier, 0 to 1.

        It is that of the mean of p along the turning in the mean square of p, both weighted with the mass; of what
        dies out at once it is 0.
        """
        multiplier = float(value[order[place]].real)
        if multiplier <= GONE:
            return 0.0
        mass, turning = around.mass.mean(axis=0), around.repeated[0, :size].mean(axis=1)
        missing = full / scale[:, None] * scale - multiplier * np.eye(2 * size)
        start = scale * np.linalg.svd(missing)[2][-1]
        decay = multiplier ** (-np.arange(len(visited)) / len(visited))
        motion = decay[:, None] * (np.array(visited) @ start)[:, :size]
        mean_square = np.einsum("ti,ij,tj->", motion, mass, motion) / len(visited)
        along = turning @ mass @ motion.mean(axis=0)
        return float(along**2 / (turning @ mass @ turning * mean_square))

    exponent = exponents(value[order], around.period)
    rigid = rigid_motion(np.angle(value[order]) / (2.0 * np.pi), share) if around.is_free else None
    return Multipliers(exponent, shape[:size], shape[size:], around.period, rigid)


def by_hill(
    around: Variation, highest: float, fewest: int, most_rows: int = MOST_HILL
) -> Multipliers:
    """Return the exponents by the eigenvalues of Hill's matrix, with harmonics up to a highest frequency (rad/s).

    fewest: harmonics of the common period, at least. Raises SolveError where it has more than `most` rows.
    """
    size = around.mass.shape[1]
    w0 = 2.0 * np.pi / around.period
    count = int(max(fewest, np.ceil(highest / w0) + 4))
    if 2 * size * (2 * count + 1) > most_rows:
        message = f"Hill's matrix of {size} coordinates and {count} harmonics is too large"
        raise SolveError(message, "`method: monodromy`", ("analyses", "stability", "method"))
    matrices = around.mass, around.damping, around.stiffness
    repeated = harmonics_of(around.repeated[:, :size], count)
    value, start = hill_exponents(*matrices, w0, count, repeated)
    order = np.argsort(-value.real, kind="stable")
    value, start = value[order], start[order]
    rate = (value[:, None, None] + 1j * w0 * np.arange(-count, count + 1)) * start
    within = value.real + 1j * (np.mod(value.imag / w0 + 0.5, 1.0) - 0.5) * w0

    def share(place: int) -> float:
        """Return the share of a turning of it all in the motion of an exponent."""
        if abs(within[place]) < DOUBLE * w0:
            # The second of a double exponent 0 is that of the mean speed; its vector lacks the free turning.
            return 1.0
        mass, motion = around.mass.mean(axis=0), start[place]
        turning = around.repeated[0, :size].mean(axis=1)
        mean_square = np.vdot(motion, mass @ motion).real * (turning @ mass @ turning)
        return float(np.abs(motion[:, count] @ mass @ turning) ** 2 / mean_square)

    rigid = rigid_motion(within.imag / w0, share) if around.is_free else None
    return Multipliers(within, start.sum(axis=2).T, rate.sum(axis=2).T, around.period, rigid)


@dataclass
class Search:
    """The growth rates of a train at any speeds; keeps what it has computed."""

    mechanism: Scene
    shapes: Basis
    reduced: Basis | None
    method: Method = "monodromy"
    known: dict[float, tuple[Orbit, Multipliers] | None] = field(default_factory=dict)
    # The same train without the slopes that damp its mean speed only.
    unhelped: "Search | None" = None
    stages: int = STAGES  # of a step through the period

    def __call__(self, speed: float) -> tuple[Orbit, Multipliers] | None:
        """Return orbit and exponents at a speed (rad/s); None where there is no periodic motion."""
        if speed not in self.known:
            orbits = (solved[0] for solved in self.known.values() if solved is not None)
            orbit, _ = continued(self.mechanism, speed, orbits)
            if orbit is None or (self.unhelped is not None and self.unhelped(speed) is None):
                self.known[speed] = None
            else:
                self.known[speed] = orbit, self.exponents(orbit, self.method)
        return self.known[speed]

    def exponents(self, orbit: Orbit, method: Method, most_rows: int = MOST_HILL) -> Multipliers:
        """Return the exponents by a method; raises SolveError where Hill's matrix has more than `most` rows.

        Drive and load do not follow a torsional vibration as they follow the mean speed: of the torsional exponents
        with and without the slopes that act on the mean speed only the worse ones count. The drift is that with all.
        """
        around = variation(self.mechanism, orbit, self.reduced)
        highest = self.shapes.highest
        if self.reduced is not None:
            highest = BEYOND * self.reduced.highest
        if method == "hill":
            multipliers = by_hill(around, highest, orbit.balance.count, most_rows)
        else:
            multipliers = by_monodromy(around, highest, self.stages)

        # The drift of the mean speed is apart where both tests say that there is one; a fast growing one has to have
        # the sign that the torque lost by the vibration gives it.
        loading = orbit.operation.loading
        if multipliers.rigid is None or not (self.loses or loading.damping.any()):
            multipliers = replace(multipliers, rigid=None)
        else:
            inertia = float(self.mechanism.layout.inertia.sum())
            correction = -orbit.operation.on_mean_speed / inertia
            growth = float(multipliers.exponent[multipliers.rigid].real) + correction
            if not growth > SLOW or drift_slope(self.mechanism, loading.speed, orbit)[0] < 0.0:
                torsional = np.arange(len(multipliers.exponent)) != multipliers.rigid
                multipliers = replace(
                    multipliers,
                    exponent=multipliers.exponent[torsional],
                    vector=multipliers.vector[:, torsional],
                    speed=multipliers.speed[:, torsional],
                    rigid=None,
                    drift=growth,
                )
            else:
                multipliers = replace(multipliers, rigid=None, is_doubtful=True)
        unhelped = None if self.unhelped is None else self.unhelped(loading.speed)
        if self.unhelped is None or unhelped is None:
            return multipliers
        bare = unhelped[1]
        if method != self.unhelped.method:
            bare = self.unhelped.exponents(unhelped[0], method, most_rows)
        return replace(
            max(multipliers, bare, key=lambda side: side.growth),
            rigid=None,
            drift=multipliers.drift,
            is_doubtful=multipliers.is_doubtful or bare.is_doubtful,
        )

    def drift(self, speed: float) -> float:
        """Return the drift of the mean speed, 1/s; NaN where it was not distinguished."""
        solved = self(speed)
        return np.nan if solved is None else solved[1].drift

    def growth(self, speed: float) -> float:
        """Return the growth rate, 1/s; NaN where there is no periodic motion."""
        solved = self(speed)
        return np.nan if solved is None else solved[1].growth

    def is_unstable(self, speed: float) -> bool:
        """Return whether the growth at a speed is beyond rounding."""
        solved = self(speed)
        return solved is not None and solved[1].growth * solved[1].period > UNSTABLE

    @property
    def loses(self) -> bool:
        """Something damps; a slope that acts on the mean speed only does not."""
        if self.unhelped is not None:
            return self.unhelped.loses
        return bool(self.mechanism.system.damps and self.mechanism.damping > 0) or any(
            solved is not None and bool(solved[0].operation.loading.damping.any())
            for solved in self.known.values()
        )


def growth_search(
    study: Study, system: System, *, method: Method = "monodromy", modes: int | None = None
) -> Search:
    """Return the search of a train whose growth rates are wanted; `modes`: reduce to so many elastic modes."""
    mechanism = scene(study, system, vibratory=False)
    shapes = basis(mechanism.layout)
    fewer = None if modes is None else reduced(mechanism.layout, shapes, shapes.rigid + modes)
    lossy = damped(mechanism, fewer or shapes)
    search = Search(lossy, shapes, fewer, method)
    if mean_speed_slopes(study):
        search.unhelped = Search(replace(lossy, laws="negative"), shapes, fewer, method)
    return search


def damped(mechanism: Scene, shapes: Basis) -> Scene:
    """Return the scene with dampers on the shapes of a basis for its loss factors."""
    return replace(mechanism, layout=viscous(mechanism.layout, shapes))


def modes_that_matter(
    mechanism: Scene, shapes: Basis, fastest: float, requested: int | None = None
) -> Basis:
    """Return the rigid motions and as many elastic modes as requested.

    Else the modes up to three times the highest order of a joint at the fastest speed (rad/s): 1 to 12 elastic ones.
    """
    elastic = shapes.frequency[shapes.rigid :]
    highest = HIGHEST * float(max(mechanism.layout.orders, default=mechanism.order)) * fastest
    number = int(np.clip(np.count_nonzero(elastic <= highest), FEWEST_MODES, MOST_MODES))
    number = number if requested is None else requested
    return reduced(mechanism.layout, shapes, shapes.rigid + min(number, len(elastic)))
