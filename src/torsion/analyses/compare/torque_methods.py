"""Response torques of one train by every method, and where they are compared: couplings, gear meshes, ends of shafts.

Methods: the two-sided elimination; one dense dynamic stiffness a frequency with torques from differences; a sum over
modes of the undamped train, each damped by itself, with and without a static correction (mode displacement and mode
acceleration: Craig and Kurdila, Fundamentals of Structural Dynamics, 2006, chapter 11).
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from fractions import Fraction
from math import pi
from operator import itemgetter

import numpy as np

from torsion.analyses.response.harmonic_components import Line, Sources, excitations, sources
from torsion.analyses.response.solver import answer, ground_damping
from torsion.analyses.steady import steady_if_known
from torsion.analyses.undamped_modes import Modes, modes_as_discretised
from torsion.arrays import ComplexArray, FloatArray, IntArray
from torsion.assembly.matrices import Matrices, matrices
from torsion.assembly.shafts import bar_segments
from torsion.assembly.system import System
from torsion.primitives import Bar
from torsion.sources import source
from torsion.study import Study

_End = tuple[
    int, str, int, int, float, float, float
]  # number of the component, and a row of `Ends`
DRIVEN = ", driven end"
SLOW = 1e-7  # of the lowest frequency: its square is the relative error of the static torques


@dataclass(frozen=True)
class Ends:
    """Sections of a system in the order of its components, the same in every model.

    The torque of a lumped segment is that of its middle; at the end of the shaft it is the torque of the first (last)
    segment and what the half segment's inertia at that end takes.
    """

    name: tuple[str, ...]
    span: IntArray  # (ends,)
    station: IntArray  # (ends,) of the half segment's inertia
    lump: (
        FloatArray  # (ends,) kg m2: that inertia, negative at a driving end; 0 where there is none
    )
    loss_factor: FloatArray  # (ends,) of the elastic span there
    delay: FloatArray  # (ends,) s: viscous damping of that span / its stiffness

    def torque(self, w: FloatArray, angle: ComplexArray, torque: ComplexArray) -> ComplexArray:
        """Return (frequencies, ends) N m from angles (frequencies, stations) and torques (frequencies, spans), own speed.

        w: (frequencies,) rad/s.
        """
        inertia_torque = (w * w)[:, None] * self.lump * angle[:, self.station]
        return np.asarray(torque[:, self.span] + inertia_torque)


def elastic_ends(system: System) -> Ends:
    """Return every elastic span between two components, and both ends of every shaft; a massless one has one torque."""
    links = (k for k in range(_links(system)) if 0 < system.flexibility[k] < np.inf)
    return _ends(
        system, links, (end for bar in system.train.bars for end in _of_shaft(system, bar))
    )


def driving_ends(system: System) -> Ends:
    """Return one end for each shaft, coupling, gear mesh, joint or link; none where points join rigidly."""
    parts, spans, is_rigid = system.train.parts, system.spans, system.flexibility == 0
    links = (
        k for k in range(_links(system)) if not parts[spans[k].part].is_point or not is_rigid[k]
    )
    return _ends(system, links, (_of_shaft(system, bar)[0] for bar in system.train.bars))


def _links(system: System) -> int:
    """Return the number of the spans that are no shafts; they are the first."""
    return len(system.train.springs) + len(system.train.constraints)


def _ends(system: System, links: Iterable[int], shafts: Iterable[_End]) -> Ends:
    """Return both sorts of ends in the order of the components."""
    ends = list(shafts)
    for k in links:
        span, delay = system.spans[k], float(system.viscous[k] * system.flexibility[k])
        ends.append(
            (span.part, span.name, k, span.driving, 0.0, float(system.loss_factor[k]), delay)
        )
    _, names, *columns = zip(*sorted(ends, key=itemgetter(0)), strict=True) if ends else ((),) * 7
    places = [np.array(column, dtype=np.int64) for column in columns[:2]]
    return Ends(
        names, places[0], places[1], *(np.array(column, dtype=np.float64) for column in columns[2:])
    )


def _of_shaft(system: System, bar: Bar) -> list[_End]:
    """Return the driving end of a shaft, and its driven end unless it has no inertia and so one torque all along."""
    spans = [k for k, span in enumerate(system.spans) if span.part == bar.part]
    first = next(k for k in spans if system.spans[k].driving == bar.driving)
    half = (0.0, 0.0)
    if system.bars is None and bar.density > 0:
        lumps = bar_segments(bar, system.segments[bar.name])[1]
        half = float(lumps[0]), float(lumps[-1])
    driving = (bar.part, bar.name, first, bar.driving, -half[0], bar.loss_factor, 0.0)
    if bar.density == 0:
        return [driving]
    last = next(k for k in reversed(spans) if system.spans[k].driven == bar.driven)
    return [
        driving,
        (bar.part, f"{bar.name}{DRIVEN}", last, bar.driven, half[1], bar.loss_factor, 0.0),
    ]


@dataclass(frozen=True)
class Harmonics:
    """Some of the harmonics of a study, at some speeds, and where their torques are compared."""

    study: Study
    speed: FloatArray  # (speeds,) rad/s of the reference station
    orders: tuple[Fraction, ...] | None = None  # None: every order; fixed frequencies always
    keys: tuple[tuple[Fraction | None, float | None], ...] | None = (
        None  # order and frequency of those that are kept
    )
    ends: Callable[[System], Ends] = elastic_ends


@dataclass(frozen=True)
class Load:
    """One harmonic at every speed."""

    line: Line
    w: FloatArray  # (speeds,) rad/s
    sources: Sources
    ground: FloatArray  # (stations, speeds) N m s/rad


@dataclass(frozen=True)
class Loaded:
    """A system with what acts on it and where its torques are compared."""

    system: System
    ends: Ends
    loads: tuple[Load, ...]

    @property
    def highest(self) -> float:
        """The highest frequency at which the train is excited, Hz."""
        return max((float(load.w.max()) for load in self.loads), default=0.0) / (2.0 * pi)


@dataclass(frozen=True)
class Torques:
    """The answer to one harmonic at all ends."""

    torque: ComplexArray  # (speeds, ends) N m at own speed
    residual: FloatArray  # (speeds,) relative
    status: np.ndarray  # (speeds,) uint8: kernels.tree_response.Status


def loaded(system: System, harmonics: Harmonics) -> Loaded:
    """Return the system with the torques and joints that excite it, and its damping, at every speed.

    Raises InputError where a mean torque that an excitation or a damping follows is not given.
    """
    speed, loads = harmonics.speed, list[Load]()
    mean = steady_if_known(harmonics.study, system, speed)
    ground = ground_damping(system, speed, mean)
    for excitation in excitations(system, harmonics.orders):
        line = excitation.line
        if harmonics.keys is None or (line.order, line.frequency) in harmonics.keys:
            loads.append(
                Load(
                    line,
                    line.circular_frequency(speed),
                    sources(system, excitation, speed, mean),
                    ground,
                )
            )
    return Loaded(system, harmonics.ends(system), tuple(loads))


def elimination(given: Loaded) -> list[Torques]:
    """Return the torques of every harmonic by two-sided elimination, and how far they can be trusted."""
    answers = (
        (load, answer(given.system, load.w, load.sources, load.ground)) for load in given.loads
    )
    return [
        Torques(
            given.ends.torque(load.w, solution.angle, solution.torque),
            solution.residual,
            solution.status,
        )
        for load, solution in answers
    ]


def eliminated(given: Loaded) -> list[ComplexArray]:
    """Return torques (speeds, ends) N m of every harmonic by two-sided elimination."""
    return [torques.torque for torques in elimination(given)]


def statically(given: Loaded, low: float) -> list[ComplexArray]:
    """Return torques (speeds, spans) N m of the undamped train when they change slowly: at `low` rad/s.

    A free train then accelerates as a whole, and its spans carry what this takes.
    """
    system = given.system
    none = np.zeros(len(system.spans))
    still = replace(system, viscous=none, loss_factor=none, dampers=())
    return [
        answer(still, np.full(len(load.w), low), load.sources, np.zeros_like(load.ground)).torque
        for load in given.loads
    ]


@dataclass(frozen=True)
class Dense:
    """A lumped system in full matrices."""

    given: Loaded
    view: Matrices
    node: FloatArray  # (tree stations, free) angle referred to one speed, of every free angle
    across: FloatArray  # (spans, free) twist of each span at its driving station's speed
    stiffness: ComplexArray  # (spans,) N m/rad with loss; 0 where rigid, for rigid spans have no such torque


def dense(given: Loaded) -> Dense:
    """Return the matrices of a lumped system, without damping to ground, which follows the speed."""
    system = given.system
    view = matrices(system, ground_damping=np.zeros(len(system.stations)))
    referred = view.basis / system.speed_ratio[:, None]
    node = np.zeros((system.condensed.tree.size, referred.shape[1]))
    node[system.condensed.node] = referred
    elastic = (system.flexibility > 0) & np.isfinite(system.flexibility)
    stiffness = np.divide(1.0, system.flexibility, out=np.zeros(len(elastic)), where=elastic)
    return Dense(
        given, view, node, system.twist(referred), stiffness * (1.0 + 1j * system.loss_factor)
    )


def solved(full: Dense) -> list[ComplexArray]:
    """Return torques (speeds, ends) N m of every harmonic, from `numpy.linalg.solve` at each frequency."""
    return [_of_line(full, load) for load in full.given.loads]


def _of_line(full: Dense, load: Load) -> ComplexArray:
    system, view = full.given.system, full.view
    turned = _imposed(system, load)
    force = full.node.T @ load.sources.force
    constant = view.stiffness + 1j * view.loss
    angle = np.empty((len(load.w), len(system.stations)), dtype=np.complex128)
    torque = np.empty((len(load.w), len(system.spans)), dtype=np.complex128)
    inertia = np.where(system.held, 0.0, system.inertia)
    for k, w in enumerate(load.w.tolist()):
        ground = load.ground[:, k]
        stiffness = (
            constant
            - w * w * view.inertia
            + 1j * w * (view.damping + (view.basis.T * ground) @ view.basis)
        )
        spring = full.stiffness + 1j * w * system.viscous
        imposed = turned[:, k] * system.speed_ratio
        twist = system.twist(turned[:, k, None])[:, 0]
        acting = force[:, k] + view.basis.T @ ((w * w * inertia - 1j * w * ground) * imposed)
        free = np.linalg.solve(stiffness, acting - full.across.T @ (spring * twist))
        angle[k] = view.basis @ free + imposed
        torque[k] = spring * (full.across @ free + twist)
    return full.given.ends.torque(load.w, angle, torque)


def _imposed(system: System, load: Load) -> ComplexArray:
    """Return (stations, frequencies) rad referred to one speed: displacement by joints, at rest."""
    condensed, twist = system.condensed, load.sources.twist
    angle = np.zeros((condensed.tree.size, len(load.w)), dtype=np.complex128)
    if twist is not None:
        for station, parent in enumerate(condensed.tree.parents):
            if parent >= 0:
                angle[station] = angle[parent] + twist[station]
    return np.asarray(angle[condensed.node])


@source("CraigKurdila2006", "ch. 11")
def superposed(given: Loaded, count: int, *, corrected: bool) -> list[ComplexArray]:
    """Return torques (speeds, ends) N m of every harmonic from the lowest `count` modes.

    corrected: the modes that are left out answer as slowly as they would to torques that do not change. Without it a
    line that joints excite has no answer (NaN): the modes alone do not add up to a twist that is imposed. Shafts of the
    system are exact: their torques at both ends are those of spans.
    """
    solved_modes = modes_as_discretised(given.system, count)
    still = (
        statically(given, SLOW * 2.0 * np.pi * solved_modes.frequency[0])
        if corrected
        else [None] * len(given.loads)
    )
    return [
        _superposed(given, solved_modes, load, torque)
        for load, torque in zip(given.loads, still, strict=True)
    ]


def _superposed(
    given: Loaded, solved_modes: Modes, load: Load, still: ComplexArray | None
) -> ComplexArray:
    """Return the torques of one harmonic from modes each damped by itself; coupling of modes is left out."""
    system, w, n, twist = (
        given.system,
        load.w,
        2.0 * np.pi * solved_modes.frequency,
        load.sources.twist,
    )
    referred = solved_modes.shape / system.speed_ratio[:, None]  # (stations, modes) rad
    node = np.zeros((system.condensed.tree.size, referred.shape[1]))
    node[system.condensed.node] = referred
    loss_factor, of_spans = (
        system.loss_factor @ solved_modes.elastic,
        system.viscous @ system.twist(referred) ** 2,
    )
    force = load.sources.force.T @ node
    turned = np.zeros_like(force)
    if twist is not None:
        in_tree = np.flatnonzero(system.condensed.span >= 0)
        factor = (system.condensed.sign * system.span_ratio)[in_tree, None]
        turned = turned - twist[system.condensed.span[in_tree]].T @ (
            factor * solved_modes.torque[in_tree]
        )
    angle = (node[system.condensed.node] * system.speed_ratio[:, None]).T
    viscous = of_spans + load.ground.T @ (angle.T**2)
    lossy = n**2 * (1.0 + 1j * loss_factor)
    spring = lossy + 1j * np.outer(w, of_spans)  # a twist is resisted elastically and by damping
    amplitude = (force + spring * turned / n**2) / (
        lossy - (w * w)[:, None] + 1j * w[:, None] * viscous
    )
    ends = given.ends
    share = 1.0 + 1j * (
        ends.loss_factor + np.outer(w, ends.delay)
    )  # elastic and damping torque / elastic torque
    if still is not None:
        moved = amplitude - force / spring - turned / n**2
        return np.asarray(still[:, ends.span] + share * (moved @ solved_modes.torque[ends.span].T))
    if twist is not None:
        return np.full((len(w), len(ends.name)), np.nan, dtype=np.complex128)
    return np.asarray(share * (amplitude @ solved_modes.torque[ends.span].T))
