"""Play, dry friction and stages in the steady vibration, by harmonic balance at the amplitude that is found.

A coupling twisted by a mean and a vibration answers at the order of the vibration as a share of its own spring and
damper with a complex stiffness beside it (kernels.describing_functions; (T115) to (T115d)). The reciprocal of the
twist in one span is linear in its dynamic stiffness K, 1/u = a + b K, so two answers of the linear train give
A |a + b K(A)| = 1, of which all solutions are found and the largest is taken. The largest harmonic component of the
span sets its amplitude for all of them.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from torsion.analyses.response.amplitudes import Balanced
from torsion.analyses.response.solver import Answer
from torsion.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from torsion.assembly.system import System
from torsion.errors import SolveError
from torsion.kernels.amplitude_equation import LARGEST, Amplitudes, Ratio, amplitudes
from torsion.kernels.describing_functions import PiecewiseCoupling, Secant, Slider
from torsion.kernels.tree_response import complex_compliance
from torsion.model.parts import NonlinearRecord

Solved = Callable[[Mapping[int, Secant]], Sequence[Answer]]
ROUNDS = 181  # over several couplings, whose amplitudes depend on each other, until they change by SETTLED
LARGEST_FIRST = 40  # rounds that take the largest solution of every coupling; later ones that nearest to the last
WHOLE = 6  # every so many rounds all solutions are looked for, else that near the last
NEAR, NEAR_SAMPLES = 1.3, 8  # range about the last amplitude, to either side
HALF_WAY = 60  # rounds from which on an amplitude goes half the way
SETTLED = 1e-11
BOTTOM = 1e-2  # by which the lowest amplitude is reduced until it lies below all solutions
REMEDY = "use motion over time"


@dataclass(frozen=True)
class Trials:
    """1/twist = a + b K of every harmonic component, about the dynamic stiffness of a coupling taken as linear."""

    own: ComplexArray  # (components, columns) N m/rad
    inverse: ComplexArray  # (components, columns) 1/rad, of the linear coupling
    slope: ComplexArray  # (components, columns) 1/(N m)
    moves: BoolArray  # (components, columns)
    linear: float  # N m/rad beside its own stiffness in the first

    def twist(self, secant: Secant, columns: IntArray) -> FloatArray:
        """Return the twist (columns,) rad of the largest component, of the columns `at`."""
        change = (secant.share - 1.0) * self.own[:, columns] + (secant.extra - self.linear)
        with np.errstate(divide="ignore"):
            twist = 1.0 / np.abs(self.inverse[:, columns] + self.slope[:, columns] * change)
        return np.asarray(np.where(self.moves[:, columns], twist, 0.0).max(axis=0))


def piecewise(record: NonlinearRecord) -> PiecewiseCoupling:
    """Return what a coupling with play, friction or stages is to harmonic balance."""
    sliders = [Slider(torque, stiffness) for torque, stiffness in record.friction]
    sliders += [
        Slider(torque, stiffness, begin)
        for begin, _, (torque, stiffness) in record.stages
        if torque
    ]
    stages = tuple((begin, stiffness) for begin, stiffness, _ in record.stages)
    return PiecewiseCoupling(record.stiffness, record.play, stages, tuple(sliders))


def balanced_spans(system: System) -> dict[int, PiecewiseCoupling]:
    """Return the spans with play, friction or stages; a clutch is taken as stuck."""
    records = {
        number: part.nonlinear
        for number, part in enumerate(system.train.parts)
        if part.nonlinear is not None
    }
    spans = ((span, records.get(part)) for span, part in enumerate(system.span_part.tolist()))
    return {
        span: piecewise(coupling)
        for span, coupling in spans
        if coupling is not None and coupling.capacity is None
    }


def balanced(
    system: System, w: Sequence[FloatArray], mean: FloatArray, solved: Solved
) -> Balanced | None:
    """Return what every coupling with play, friction or stages is at the amplitudes found; None without any.

    w: circular frequencies (columns,) rad/s of every harmonic component. mean: torques (spans, columns) N m. solved:
    its answer with such couplings. Raises SolveError where one would have to change in a loop or in a train that is
    damped by mode.
    """
    couplings = balanced_spans(system)
    columns = len(w[0]) if w else 0
    if not (couplings and columns):
        return None
    rows = _Rows(system, w, np.abs(mean), solved, couplings)
    fixed = [
        span for span in couplings if system.train.modal_damping or system.condensed.span[span] < 0
    ]
    free = [span for span in couplings if span not in fixed]
    amplitudes_of = {span: rows.at_rest(span) for span in free}
    settled = np.zeros(columns, dtype=bool)
    for number in range(ROUNDS):
        before = {span: amplitudes_of[span].largest for span in free}
        for span in free:
            amplitudes_of[span] = rows.solutions(
                span, amplitudes_of, np.flatnonzero(~settled), number
            )
        is_same = [
            np.abs(amplitudes_of[span].largest - before[span]) <= SETTLED * before[span]
            for span in free
        ]
        if len(free) < 2 or number % WHOLE == 0:
            settled = settled | np.all(is_same, axis=0) if len(free) > 1 else ~settled
        if settled.all():
            break
    return rows.collected(
        amplitudes_of | {span: rows.unchanged(span, amplitudes_of) for span in fixed}, settled
    )


@dataclass(frozen=True)
class _Rows:
    """The balances of every coupling; `largest` of its amplitudes is the one that stands."""

    system: System
    w: Sequence[FloatArray]
    mean: FloatArray
    solved: Solved
    couplings: Mapping[int, PiecewiseCoupling]

    def at_rest(self, span: int) -> Amplitudes:
        """Return the amplitudes with which an iteration begins."""
        columns = len(self.w[0])
        tiny = np.full(columns, 1e-9 * max(self.couplings[span].scale, 1e-9))
        return Amplitudes(tiny, tiny, tiny, np.ones(columns, dtype=np.int64))

    def unchanged(self, span: int, amplitudes_of: Mapping[int, Amplitudes]) -> Amplitudes:
        """Return the amplitudes of a coupling that has to stay as it is in the linear train; raises SolveError."""
        coupling = self.couplings[span]
        name = self.system.spans[span].name
        path = self.system.train.parts[self.system.spans[span].part].path
        reason = "is in a train that is damped by mode"
        if self.system.condensed.span[span] < 0:
            reason = "closes a loop"
        hint = "give the damping of the components" if self.system.train.modal_damping else REMEDY
        if coupling.stuck:
            message = f"'{name}' {reason}, and its friction in the response is not built"
            raise SolveError(message, hint, path)
        answers = self.solved(self._secants(amplitudes_of))
        amplitude = np.abs(self._twists(span, answers, self._stiffness(span))).max(axis=0)
        opens = (self.mean[span] == 0.0) & (coupling.half > 0.0)
        if (opens | (amplitude >= coupling.first(self.mean[span]))).any():
            message = f"'{name}' {reason}, and its backlash or stages in the response are not supported yet"
            raise SolveError(message, hint, path)
        return Amplitudes(amplitude, amplitude, amplitude, np.ones(len(amplitude), dtype=np.int64))

    def solutions(
        self, span: int, amplitudes_of: Mapping[int, Amplitudes], unsettled: IntArray, number: int
    ) -> Amplitudes:
        """Return the amplitudes of a coupling, new in the unsettled columns, while the others stand.

        number: of the round, on which it depends whether all solutions are looked for.
        """
        coupling = self.couplings[span]
        former = amplitudes_of[span]
        mean = self.mean[span]
        trials = self._trials(span, self._secants(amplitudes_of))

        def ratio(amplitude: FloatArray, columns: IntArray) -> FloatArray:
            chosen = unsettled[columns]
            with np.errstate(divide="ignore"):
                return amplitude / trials.twist(coupling.secant(amplitude, mean[chosen]), chosen)

        is_whole = number % WHOLE == 0
        last = former.largest[unsettled]
        bottom, top = _range(coupling, trials, mean, unsettled, ratio)
        if is_whole:
            new = amplitudes(ratio, bottom, top, last)
        else:
            new = amplitudes(ratio, last / NEAR, last * NEAR, last, NEAR_SAMPLES)
            lacks = np.flatnonzero(new.number == 0)
            if lacks.size:
                lacking = amplitudes(
                    lambda amplitude, columns: ratio(amplitude, lacks[columns]),
                    bottom[lacks],
                    top[lacks],
                    last[lacks],
                )
                new = new.having(lacking, lacks)
        taken = new.largest if is_whole and number < LARGEST_FIRST else new.nearest
        if number >= HALF_WAY:
            taken = np.sqrt(taken * former.largest[unsettled])
        still = ~trials.moves[:, unsettled].any(axis=0)
        taken = np.where(still, bottom, np.where(new.number > 0, taken, LARGEST))
        rows = (taken, new.smallest, new.nearest, np.where(still, 1, new.number))
        return former.having(Amplitudes(*rows), unsettled)

    def _secants(self, amplitudes_of: Mapping[int, Amplitudes]) -> dict[int, Secant]:
        """Return what each coupling is at the amplitude that stands."""
        return {
            span: self.couplings[span].secant(size.largest, self.mean[span])
            for span, size in amplitudes_of.items()
        }

    def collected(self, amplitudes_of: Mapping[int, Amplitudes], settled: BoolArray) -> Balanced:
        """Return all couplings together; a column without a solution is not settled."""
        sizes = amplitudes_of.values()
        secants = self._secants(amplitudes_of).values()
        number = np.array([size.number for size in sizes]).T
        return Balanced(
            tuple(amplitudes_of),
            number,
            settled & (number > 0).all(axis=1),
            np.array([size.largest for size in sizes]).T,
            np.array([size.smallest for size in sizes]).T,
            np.array([self.couplings[span].first(self.mean[span]) for span in amplitudes_of]).T,
            np.array([secant.share for secant in secants]).T,
            np.array([secant.extra for secant in secants]).T,
        )

    def _trials(self, span: int, secants: Mapping[int, Secant]) -> Trials:
        coupling = self.couplings[span]
        stiffness = self._stiffness(span)
        step = coupling.total_stiffness * (0.5 + 0.5j)
        columns = len(self.w[0])
        twists = list[ComplexArray]()
        for extra in (coupling.stuck, coupling.stuck + step):
            secant = Secant(np.ones(columns), np.full(columns, extra, dtype=complex))
            answers = self.solved({**secants, span: secant})
            twists.append(self._twists(span, answers, stiffness + extra))
        moves = (twists[0] != 0.0) & (twists[1] != 0.0)
        first, second = (
            np.asarray(1.0 / np.where(moves, twist, 1.0), dtype=np.complex128) for twist in twists
        )
        return Trials(stiffness, first, (second - first) / step, moves, coupling.stuck)

    def _stiffness(self, span: int) -> ComplexArray:
        """Return the stiffness (components, columns) N m/rad of the spring and damper of a span."""
        system = self.system
        given = (
            values[[span]] for values in (system.flexibility, system.viscous, system.loss_factor)
        )
        flexibility, viscous, loss = given
        rows = [complex_compliance(flexibility, viscous, loss, w).reshape(-1) for w in self.w]
        return np.array(
            [np.broadcast_to(1.0 / compliance, len(self.w[0])) for compliance in rows],
            dtype=complex,
        )

    def _twists(
        self, span: int, answers: Sequence[Answer], stiffness: ComplexArray
    ) -> ComplexArray:
        """Return the twists (components, columns) rad of a span."""
        return np.array([answer.torque[:, span] for answer in answers]) / stiffness


def _range(
    coupling: PiecewiseCoupling,
    trials: Trials,
    mean: FloatArray,
    unsettled: IntArray,
    ratio: Ratio,
) -> tuple[FloatArray, FloatArray]:
    """Return amplitudes (columns,) rad below and above all solutions."""
    columns = np.arange(len(unsettled))
    bottom = 0.5 * np.maximum(coupling.first(mean[unsettled]), 1e-6 * coupling.scale)
    for _ in range(12):
        above = ratio(bottom, columns) >= 1.0
        if not above.any():
            break
        bottom = np.where(above, BOTTOM * bottom, bottom)
    stiffness = trials.own[:, unsettled]
    slope = np.abs(trials.slope[:, unsettled])
    differs = coupling.offset * np.abs(stiffness) / coupling.stiffness
    limit = np.abs(
        trials.inverse[:, unsettled]
        + trials.slope[:, unsettled] * (coupling.lasting - trials.linear)
    )
    with np.errstate(divide="ignore", invalid="ignore"):
        upper = np.where(trials.moves[:, unsettled], (1.0 + slope * differs) / limit, 0.0).max(
            axis=0
        )
    return bottom, np.minimum(
        np.maximum(1.1 * upper, 100.0 * np.maximum(coupling.scale, bottom)), LARGEST
    )
