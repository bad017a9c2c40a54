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
from torsion.arrays import ComplexArray, FloatArray, IntArray
from torsion.assembly.system import System
from torsion.errors import SolveError
from torsion.kernels.amplitude_equation import LARGEST, Amplitudes, amplitudes
from torsion.kernels.describing_functions import PiecewiseCoupling, Secant, Slider
from torsion.kernels.trees.tree_response import complex_compliance

Solved = Callable[[Mapping[int, Secant]], Sequence[Answer]]
ROUNDS = 181  # over several couplings, whose amplitudes depend on each other, until they change by SETTLED
LARGEST_FIRST = 40  # rounds that take the largest solution of every coupling; later ones that nearest to the last
WHOLE = 6  # every so many rounds all solutions are looked for, else that near the last
NEAR, NEAR_SAMPLES = 1.3, 8  # range about the last amplitude, to either side
HALF_WAY = 60  # rounds from which on an amplitude goes half the way
SETTLED = 1e-11
MOST_REDUCTIONS, BOTTOM = (
    12,
    1e-2,
)  # by which the lowest amplitude is reduced until it lies below all solutions
REMEDY = "use motion over time"


def balanced_spans(system: System) -> dict[int, PiecewiseCoupling]:
    """Return the spans with play, friction or stages; a clutch is taken as stuck."""
    couplings = {}
    for span, part in enumerate(system.span_part.tolist()):
        record = system.train.parts[part].nonlinear
        if record is None or record.capacity is not None:
            continue
        sliders = [Slider(torque, stiffness) for torque, stiffness in record.friction]
        for begin, _, (torque, stiffness) in record.stages:
            sliders += [Slider(torque, stiffness, begin)] if torque else []
        stages = tuple((begin, stiffness) for begin, stiffness, _ in record.stages)
        made = PiecewiseCoupling(record.stiffness, record.play, stages, tuple(sliders))
        couplings[span] = made
    return couplings


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
    amplitudes_of = dict[int, Amplitudes]()
    for span, coupling in couplings.items():
        if span not in fixed:
            tiny = np.full(columns, 1e-9 * max(coupling.scale, 1e-9))
            amplitudes_of[span] = Amplitudes(tiny, tiny, tiny, np.ones(columns, dtype=np.int64))
    settled = np.zeros(columns, dtype=bool)
    for number in range(ROUNDS):
        is_same = np.ones(columns, dtype=bool)
        for span, former in amplitudes_of.items():
            unsettled = np.flatnonzero(~settled)
            new = rows.solutions(span, amplitudes_of, unsettled, number)
            is_same &= np.abs(new.largest - former.largest) <= SETTLED * former.largest
            amplitudes_of[span] = new
        if len(amplitudes_of) < 2 or number % WHOLE == 0:
            settled = settled | is_same if len(amplitudes_of) > 1 else ~settled
        if settled.all():
            break
    amplitudes_of |= {span: rows.unchanged(span, amplitudes_of) for span in fixed}

    # A column without a solution is not settled.
    sizes = amplitudes_of.values()
    secants = rows.secants(amplitudes_of).values()
    solutions = np.array([size.number for size in sizes]).T
    return Balanced(
        tuple(amplitudes_of),
        solutions,
        settled & (solutions > 0).all(axis=1),
        np.array([size.largest for size in sizes]).T,
        np.array([size.smallest for size in sizes]).T,
        np.array([couplings[span].first(rows.mean[span]) for span in amplitudes_of]).T,
        np.array([secant.share for secant in secants]).T,
        np.array([secant.extra for secant in secants]).T,
    )


@dataclass(frozen=True)
class _Rows:
    """The balances of every coupling; `largest` of its amplitudes is the one that stands."""

    system: System
    w: Sequence[FloatArray]
    mean: FloatArray
    solved: Solved
    couplings: Mapping[int, PiecewiseCoupling]

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
        torque = [answer.torque[:, span] for answer in self.solved(self.secants(amplitudes_of))]
        amplitude = np.abs(np.array(torque) / self._stiffness(span)).max(axis=0)
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
        mean = self.mean[span, unsettled]
        secants = self.secants(amplitudes_of)

        # 1/twist = a + b K of every harmonic component (components, columns), about the coupling taken as linear.
        stiffness = self._stiffness(span)
        step = (0.5 + 0.5j) * (
            sum(spring for _, spring in coupling.springs)
            + sum(dry.stiffness for dry in coupling.sliders)
        )
        twists = list[ComplexArray]()
        for extra in (coupling.stuck, coupling.stuck + step):
            columns = len(self.w[0])
            secants[span] = Secant(np.ones(columns), np.full(columns, extra, dtype=complex))
            torque = np.array([answer.torque[:, span] for answer in self.solved(secants)])
            twists.append((torque / (stiffness + extra))[:, unsettled])
        own = stiffness[:, unsettled]
        moves = (twists[0] != 0.0) & (twists[1] != 0.0)
        inverse, second = (1.0 / np.where(moves, twist, 1.0) for twist in twists)
        slope = (second - inverse) / step

        def ratio(amplitude: FloatArray, columns: IntArray) -> FloatArray:
            """Return amplitude over the twist (columns,) rad of the largest component."""
            secant = coupling.secant(amplitude, mean[columns])
            change = (secant.share - 1.0) * own[:, columns] + (secant.extra - coupling.stuck)
            with np.errstate(divide="ignore"):
                twist = 1.0 / np.abs(inverse[:, columns] + slope[:, columns] * change)
                return np.asarray(amplitude / np.where(moves[:, columns], twist, 0.0).max(axis=0))

        # Amplitudes below and above all solutions.
        bottom = 0.5 * np.maximum(coupling.first(mean), 1e-6 * coupling.scale)
        for _ in range(MOST_REDUCTIONS):
            above = ratio(bottom, np.arange(len(unsettled))) >= 1.0
            bottom = np.where(above, BOTTOM * bottom, bottom)
            if not above.any():
                break
        differs = coupling.offset * np.abs(own) / coupling.stiffness
        limit = np.abs(inverse + slope * (coupling.lasting - coupling.stuck))
        with np.errstate(divide="ignore", invalid="ignore"):
            upper = np.where(moves, (1.0 + np.abs(slope) * differs) / limit, 0.0).max(axis=0)
        lowest = 100.0 * np.maximum(coupling.scale, bottom)
        top = np.minimum(np.maximum(1.1 * upper, lowest), LARGEST)

        is_whole = number % WHOLE == 0
        last = former.largest[unsettled]
        if is_whole:
            new = amplitudes(ratio, bottom, top, last)
        else:
            new = amplitudes(ratio, last / NEAR, last * NEAR, last, NEAR_SAMPLES)
            lacks = np.flatnonzero(new.number == 0)
            if lacks.size:
                ends = bottom[lacks], top[lacks], last[lacks]
                new = new.having(
                    amplitudes(lambda amplitude, row: ratio(amplitude, lacks[row]), *ends), lacks
                )
        taken = new.largest if is_whole and number < LARGEST_FIRST else new.nearest
        if number >= HALF_WAY:
            taken = np.sqrt(taken * last)
        still = ~moves.any(axis=0)
        taken = np.where(still, bottom, np.where(new.number > 0, taken, LARGEST))
        rows = (taken, new.smallest, new.nearest, np.where(still, 1, new.number))
        return former.having(Amplitudes(*rows), unsettled)

    def secants(self, amplitudes_of: Mapping[int, Amplitudes]) -> dict[int, Secant]:
        """Return what each coupling is at the amplitude that stands."""
        return {
            span: self.couplings[span].secant(size.largest, self.mean[span])
            for span, size in amplitudes_of.items()
        }

    def _stiffness(self, span: int) -> ComplexArray:
        """Return the stiffness (components, columns) N m/rad of the spring and damper of a span."""
        system = self.system
        given = system.flexibility[[span]], system.viscous[[span]], system.loss_factor[[span]]
        stiffness = np.empty((len(self.w), len(self.w[0])), dtype=np.complex128)
        for row, w in zip(stiffness, self.w, strict=True):
            row[:] = 1.0 / complex_compliance(*given, w).reshape(-1)
        return stiffness
