"""How far a model is from the reference: relative errors of frequencies, of mode shapes and of response torques."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial
from math import pi
from operator import itemgetter
from typing import Any

import numpy as np

from torsion.analyses.compare.timing import Candidate, Effort
from torsion.analyses.discretisation import assembled
from torsion.analyses.response.harmonic_components import Line, Sources, excitations, sources
from torsion.analyses.response.solver import answer, ground_damping
from torsion.analyses.steady import steady_if_known
from torsion.analyses.undamped_modes import Modes, modes, modes_as_discretised, undamped_tree
from torsion.arrays import ComplexArray, FloatArray, IntArray
from torsion.assembly import assemble
from torsion.assembly.section.solved_sections import resolved
from torsion.assembly.segments import bar_segments
from torsion.assembly.system import System
from torsion.errors import Fault, Path
from torsion.sources import source
from torsion.study import FiniteElements, Study
from torsion.train import Train

TOGETHER = 1e-6  # relative; modes nearer to each other than that are one, and any mixture of their shapes is right
NEGLIGIBLE = 1e-9  # of the largest torque of a harmonic: torques that stay below are rounding and are not compared


def relative_errors(
    values: Sequence[float] | FloatArray, reference: Sequence[Any] | FloatArray
) -> FloatArray:
    """Return (values,) signed errors over the reference; infinite for values that are missing at the end.

    The difference is taken in the numbers of the reference, which may have more digits than double precision.
    """
    exact = np.asarray(reference)
    error = np.full(len(reference), np.inf)
    count = min(len(exact), len(values))
    error[:count] = (np.asarray(values, dtype=float)[:count] - exact[:count]) / exact[:count]
    return error


@source("AllemangBrown1982")
def shape_errors(
    shape: FloatArray, exact: FloatArray, frequency: FloatArray, weight: FloatArray
) -> FloatArray:
    """Return (modes,) 1 - MAC of every shape (stations, modes) against the exact one of the same number.

    exact: (stations, at least as many modes) with their `frequency`; weight: (stations,) inertias. MAC is the modal
    assurance criterion (Allemang & Brown 1982) weighted by inertia: the squared cosine of the angle between two shapes
    or, where exact frequencies are the same, between a shape and the space of theirs. It is found as the rest outside
    of that space, so that nothing cancels. NaN where no station of any inertia moves.
    """
    root = np.sqrt(weight)[:, None]
    ours = shape * root
    theirs = exact * root
    errors = np.full(shape.shape[1], np.nan)
    for mode in range(shape.shape[1]):
        close = np.abs(frequency - frequency[mode]) <= TOGETHER * frequency[mode]
        size = float(np.linalg.norm(ours[:, mode]))
        sizes = np.linalg.norm(theirs, axis=0)
        moving = theirs[:, close & (sizes > 0)] / sizes[close & (sizes > 0)]
        if size == 0 or moving.shape[1] == 0:
            continue
        # Orthonormal columns that span the same space.
        space, singular, _ = np.linalg.svd(moving, full_matrices=False)
        smallest = max(moving.shape) * np.finfo(float).eps * singular[0]
        space = space[:, singular > smallest]
        vector = ours[:, mode] / size
        remainder = vector - space @ (space.T @ vector)
        errors[mode] = min(float(remainder @ remainder), 1.0)
    return errors


def over_largest(torque: ComplexArray, exact: ComplexArray) -> FloatArray:
    """Return (speeds,) largest error of any torque (speeds, ends) over the largest exact torque at that speed.

    NaN where there is no torque.
    """
    with np.errstate(invalid="ignore", divide="ignore"):
        size = np.abs(exact).max(axis=1, initial=0.0)
        return np.where(size > 0, np.abs(torque - exact).max(axis=1, initial=0.0) / size, np.nan)


def over_peaks(exact: Sequence[ComplexArray], torques: Sequence[ComplexArray]) -> tuple[float, ...]:
    """Return for every harmonic the largest error of a torque (speeds, ends) over its peak of all speeds.

    NaN in what was found makes it infinite.
    """
    errors = []
    for exact_torque, torque in zip(exact, torques, strict=True):
        peak = np.abs(exact_torque).max(axis=0)
        compared = peak > NEGLIGIBLE * peak.max()
        share = np.abs(torque - exact_torque)[:, compared] / peak[compared]
        share[~np.isfinite(torque[:, compared])] = np.inf
        errors.append(float(share.max(initial=0.0)))
    return tuple(errors)


@dataclass(frozen=True)
class Ends:
    """Sections of a system in the order of its components, the same in every model."""

    name: tuple[str, ...]
    span: IntArray  # (ends,)
    station: IntArray  # (ends,) of the half segment's inertia
    lump: FloatArray  # (ends,) kg m2: that inertia; 0 where there is none


def driving_ends(system: System) -> Ends:
    """Return one end for each shaft, coupling, gear mesh, joint or link; none where points join rigidly."""
    train = system.train
    ends = list[tuple[int, str, int, int, float]]()
    for k, span in enumerate(system.spans[: len(train.springs) + len(train.constraints)]):
        if not train.parts[span.part].is_point or system.flexibility[k] != 0:
            ends.append((span.part, span.name, k, span.driving, 0.0))
    for bar in train.bars:
        spans = (k for k, span in enumerate(system.spans) if span.part == bar.part)
        first = next(k for k in spans if system.spans[k].driving == bar.driving)
        is_lumped = system.bars is None and bar.density > 0
        lump = float(bar_segments(bar, system.segments[bar.name])[1][0]) if is_lumped else 0.0
        ends.append((bar.part, bar.name, first, bar.driving, lump))
    ends.sort(key=itemgetter(0))
    _, names, spans_of, stations, lumps = zip(*ends, strict=True) if ends else ((),) * 5
    return Ends(names, np.array(spans_of, int), np.array(stations, int), np.array(lumps, float))


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
    """The response to one harmonic at all ends."""

    torque: ComplexArray  # (speeds, ends) N m at own speed
    residual: FloatArray  # (speeds,) relative
    status: np.ndarray  # (speeds,) uint8: kernels.tree_response.Status


def loaded(
    system: System, study: Study, speed: FloatArray, orders: tuple[Fraction, ...] | None = None
) -> Loaded:
    """Return the system with the torques and joints that excite it, and its damping, at every speed (speeds,) rad/s.

    orders: None for every order; fixed frequencies always. Raises InputError where a mean torque that an excitation or
    a damping follows is not given.
    """
    mean = steady_if_known(study, system, speed)
    ground = ground_damping(system, speed, mean)
    loads = []
    for excitation in excitations(system, orders):
        w = excitation.line.circular_frequency(speed)
        loads.append(Load(excitation.line, w, sources(system, excitation, speed, mean), ground))
    return Loaded(system, driving_ends(system), tuple(loads))


def response_torques(given: Loaded) -> list[Torques]:
    """Return the torques of every harmonic, and how far they can be trusted."""
    ends = given.ends
    torques = []
    for load in given.loads:
        solution = answer(given.system, load.w, load.sources, load.ground)
        half_segment = (load.w**2)[:, None] * ends.lump * solution.angle[:, ends.station]
        at_ends = solution.torque[:, ends.span] - half_segment
        torques.append(Torques(at_ends, solution.residual, solution.status))
    return torques


Named = Callable[
    [str, str, int, Callable[[], System]], Candidate
]  # of method, words, size and what assembles it
COUNT = 6  # elastic modes, where neither the file nor an excitation says how many


def loop_faults(study: Study, path: Path) -> list[Fault]:
    """Return the fault of closed loops in a train whose shafts have inertia: there is no exact model of it."""
    if not (study.train.has_shafts and study.train.has_loops):
        return []
    message = "errors are against the exact model, which does not support closed loops, and `links` closes one"
    return [Fault(path, message, "leave `links` or the check out")]


def plain(study: Study) -> Study:
    """Return the study in the exact model, its shafts without a number of segments of their own, sections already solved."""
    train = divided(resolved(study.train), None)
    return replace(
        study, train=train, model="exact" if train.has_shafts else "lumped", fem=FiniteElements()
    )


def divided(train: Train, number: int | Mapping[str, int] | None) -> Train:
    """Return the train with so many segments a shaft (or by its name); a massless shaft is a spring and stays as it is."""
    numbers = number if isinstance(number, Mapping) else {bar.name: number for bar in train.bars}
    bars = (
        replace(bar, segments=numbers[bar.name]) if bar.density > 0 else bar for bar in train.bars
    )
    return replace(train, bars=tuple(bars))


def ready(
    train: Train,
    model: str,
    *,
    frequency: float = 0.0,
    degree: int | None = None,
    elements: int | None = None,
) -> System:
    """Return a system with its tree and the laws of its shafts, which are made when first used."""
    system = assemble(train, model, frequency=frequency, degree=degree, elements=elements)
    _ = system.condensed, system.condensed_shafts
    return system


def candidates(
    train: Train, frequency: float, effort: Effort, named: Named
) -> list[list[Candidate]]:
    """Return every discretisation of the shafts, a list a curve; frequency (Hz): what the exact model is divided for."""

    def curve(method: str, what: str, most: int, made: Callable[[int], System]) -> list[Candidate]:
        numbers = (2**k for k in range(most.bit_length()))
        return [named(method, counted(n, what), n, partial(made, n)) for n in numbers]

    def finite(degree: int, elements: int) -> System:
        return ready(train, "fem", frequency=frequency, degree=degree, elements=elements)

    curves = [
        curve("lumped", "segment", effort.segments, lambda n: ready(divided(train, n), "lumped"))
    ]
    for degree in effort.degrees:
        most = max(1, effort.unknowns // degree)
        curves.append(curve(f"fem, degree {degree}", "element", most, partial(finite, degree)))
    exact = partial(ready, train, "exact", frequency=frequency)
    pieces = max(exact().segments.values())
    return [*curves, [named("exact", counted(pieces, "piece"), pieces, exact)]]


def counted(number: int, what: str) -> str:
    """Return a number with its noun in the right form."""
    return f"{number} {what}{'' if number == 1 else 's'}"


def reference(study: Study, highest: float, count: int | None) -> tuple[Modes, Modes]:
    """Return the lowest `count` modes (None: those up to `highest`, Hz) of the exact model, and of twice as many pieces."""
    system = assembled(study, highest)
    if count is None:
        count = COUNT
        if highest > 0.0 and system.condensed_shafts is not None:
            from torsion.analyses.modes.mode_nodes import reach

            count = max(1, reach(undamped_tree(system), 2.0 * math.pi * highest).count)
    solved_modes = modes(system, count)
    doubled = {name: 2 * number for name, number in solved_modes.system.segments.items()}
    finer = ready(divided(study.train, doubled), "exact")
    return solved_modes, modes_as_discretised(finer, count)
