"""The linear motion of a train while every element keeps its regime, in roots of its own: exact at any time.

    p'' + C p' + K p = B U,   y' = root y + force U,   p = turned + Re(place y) + constraint U
with all inputs U of the train; motions that nothing holds are kept apart. What is read of a motion are rows over
(p, p', U, U'). Elements that stick rigidly are constraints; modes above a band may be left out: their compliance F is in
series with the elements, u = ends p + rest - F T.
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from torsion.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from torsion.errors import SolveError
from torsion.kernels.motion.regimes.damped_modes import Roots, roots_of
from torsion.kernels.motion.regimes.exponential_answers import answers_and_turning
from torsion.kernels.motion.regimes.modal_loads import LoadedModes, Start, inputs_at
from torsion.kernels.motion.regimes.piecewise_elements import Law
from torsion.kernels.motion.torques.polynomial_torques import TURNED, answers, cut_short

Modes = tuple[int, ...]  # the regime of every element
HELD = 1e-10  # relative: rigid motions that springs and dampers twist by less are free
TINY = float(np.finfo(float).tiny)
BLOCK = 20_000  # answers at a time
NOTHING = 1e-12  # of the fastest: a slower mode stands still


@dataclass(frozen=True)
class Moved:
    """A regime's motion at some times."""

    y: ComplexArray  # (coordinates, times), speeds of the motions that nothing holds among them, which stand first
    turned: FloatArray  # (motions that nothing holds, times)
    inputs: FloatArray  # (inputs, times)
    input_rates: FloatArray  # (inputs, times, orders) of as many derivatives as are requested


@dataclass(frozen=True)
class Regime:
    """One linear motion; rows are over positions and speeds of the train's motions, its inputs and their rates."""

    train: LoadedModes
    torque: FloatArray  # (elements, rows) N m
    elastic: FloatArray  # (elements, rows) sqrt(N m): half its square is the energy stored in the element
    twist: FloatArray  # (elements, rows) rad
    events: FloatArray  # (functions, rows), positive while the regime lasts
    switches: tuple[tuple[int, int], ...]  # the element of each, and the regime that it enters
    offset: FloatArray  # (elements,) rad, of the springs' laws
    moves: BoolArray  # (elements,) its own coordinate moves with the ends
    sticks: BoolArray  # (elements,) rigidly
    tied: IntArray  # elements that spring or stick
    basis: (
        FloatArray | None
    )  # (motions, modes) of what an element ties; None: the last of the motions themselves
    free: FloatArray  # (motions, motions that nothing holds)
    constraint: FloatArray  # (motions, inputs)
    roots: Roots  # of what an element ties
    force: ComplexArray  # (coordinates, inputs)

    @cached_property
    def root(self) -> ComplexArray:
        """(coordinates,) 1/s, 0 of motions that nothing holds."""
        return np.concatenate([np.zeros(self.free.shape[1]), self.roots.root])

    @cached_property
    def untwisting(self) -> FloatArray:
        """(rigid motions, tied elements) rad by which rigid motions twist elements by 1 rad."""
        ends = self.train.ends[self.tied, : self.train.modes.rigid]
        return np.asarray(np.linalg.pinv(ends, rcond=HELD))

    @cached_property
    def fastest(self) -> float:
        """1/s."""
        return max(float(np.abs(self.root).max(initial=0.0)), self.train.fastest)

    def begin(
        self, position: FloatArray, speed: FloatArray, inputs: FloatArray
    ) -> tuple[ComplexArray, FloatArray]:
        """Coordinates and positions of what nothing holds, from positions and speeds (motions,)."""
        position = position - self.constraint @ inputs
        first = self.free.shape[1]
        q, v = (
            row[first:] if self.basis is None else self.basis.T @ row for row in (position, speed)
        )
        roots = self.roots
        held = _times(roots.of_speed, v[:, None]) + _times(roots.of_position, q[:, None])
        return np.concatenate([self.free.T @ speed, held[:, 0]]), self.free.T @ position

    def moved(self, start: Start, time: FloatArray, orders: int = 1) -> Moved:
        """The motion at times since its start, (times,) s, with some derivatives of its inputs."""
        train, root, number = self.train, self.root, self.free.shape[1]
        acting = train.acting[start.interval]
        decay = np.exp(np.multiply.outer(root, time))
        y = start.y * decay
        turned = start.turned + start.y[:number].real * time
        steady = self.force[:, :1] + self.force[:, train.following.stop :] @ start.offset
        loads = [(0.0 + 0.0j, [steady])]
        columns = acting.later(start.time - train.history.begin[start.interval])
        for rate, terms, count in acting.by_rate:
            force = self.force[:, 1 + acting.load[terms]]
            loads.append((rate, [force @ column[terms] for column in columns[:count]]))
        for rate, forces in loads:
            answers, turning = answers_and_turning(root, rate, time, len(forces), decay)
            for force, answer, once in zip(forces, answers, turning, strict=True):
                y += force * answer
                turned = turned + (force[:number] * once).real
        if start.series.any():
            added = self._under(time, cut_short(start.series, time / start.length))
            y, turned = y + added[0], turned + added[1]
        inputs = inputs_at(train, start, time, orders)
        return Moved(y, turned, inputs[:, :, 0], inputs[:, :, 1:])

    def _under(self, time: FloatArray, series: FloatArray) -> tuple[ComplexArray, FloatArray]:
        """Coordinates and positions of what nothing holds, from rest, under torques that follow the motion.

        These have series (coefficients, interfaces, times) from the begin to each of the times (s).
        """
        force, number = self.force[:, self.train.following], self.free.shape[1]
        y = np.empty((len(force), len(time)), dtype=complex)
        for block in np.array_split(np.arange(len(time)), 1 + y.size // BLOCK):
            answer = answers(self.root[:, None] * time[block])
            y[:, block] = time[block] * np.sum(force @ series[:, :, block] * answer, axis=0)
        turned = np.tensordot(TURNED, force[:number].real @ series[:2], 1)
        return y, np.square(time) * turned

    def rates_of(self, moved: Moved) -> ComplexArray:
        """(coordinates, times) rates of the coordinates."""
        return np.asarray(self.root[:, None] * moved.y + self.force @ moved.inputs)

    @cached_property
    def rows(self) -> tuple[FloatArray, FloatArray]:
        """(motions, parts) of positions and of speeds, over real and imaginary parts of the coordinates."""
        eye = np.eye(self.train.motions)
        rows = self.reading(eye, 0.0 * eye), self.reading(0.0 * eye, eye)
        position, speed = (np.concatenate([row.real, -row.imag], axis=1) for row in rows)
        return position, speed

    @property
    def is_alone(self) -> bool:
        """Every motion stands for itself."""
        return self.basis is None and self.roots.shape.ndim == 1

    def positions(self, moved: Moved) -> FloatArray:
        """(motions, times)"""
        if self.is_alone:
            held = moved.y[len(moved.turned) :]
            return np.concatenate([moved.turned, (self.roots.shape[:, None] * held).real])
        position = self.rows[0] @ np.concatenate([moved.y.real, moved.y.imag])
        return np.asarray(position + self.free @ moved.turned + self.constraint @ moved.inputs)

    def speeds(self, y: ComplexArray) -> FloatArray:
        """(motions, times) of coordinates; accelerations of their rates."""
        if self.is_alone:
            number, factors = self.free.shape[1], self.roots.shape * self.roots.root
            return np.concatenate([y[:number].real, (factors[:, None] * y[number:]).real])
        return np.asarray(self.rows[1] @ np.concatenate([y.real, y.imag]))

    def reading(self, position: FloatArray, speed: FloatArray) -> ComplexArray:
        """(rows, coordinates) whose real part times y is rows (rows, motions) of positions and speeds together.

        Positions of what nothing holds are `position @ free`.
        """
        first, roots = self.free.shape[1], self.roots
        by_position, by_speed = (
            row[:, first:] if self.basis is None else row @ self.basis for row in (position, speed)
        )
        shape = np.diag(roots.shape) if roots.shape.ndim == 1 else roots.shape
        held = by_position @ shape + by_speed @ (shape * roots.root)
        return np.concatenate([speed @ self.free, held], axis=1)


@dataclass(frozen=True)
class Layout:
    """Where positions, speeds, inputs and their rates stand in a row."""

    train: LoadedModes

    @property
    def size(self) -> int:
        """Number of columns."""
        return 2 * (self.train.motions + self.train.inputs)

    @property
    def position(self) -> slice:
        """Positions of the motions."""
        return slice(0, self.train.motions)

    @property
    def speed(self) -> slice:
        """Speeds of the motions."""
        return slice(self.train.motions, 2 * self.train.motions)

    @property
    def inputs(self) -> slice:
        """Inputs; the first of them is 1."""
        return slice(2 * self.train.motions, 2 * self.train.motions + self.train.inputs)

    @property
    def input_rates(self) -> slice:
        """Their rates."""
        return slice(self.inputs.stop, self.size)

    def balance(self, torque: FloatArray) -> FloatArray:
        """(motions, columns) accelerations under torques (elements, columns) of the elements."""
        train = self.train
        rows = np.zeros((train.motions, self.size))
        rows[:, self.position] = -np.diag(train.modes.w_of_all**2)
        rows[:, self.speed] = -train.modes.damping
        rows[:, self.inputs] = train.push
        return np.asarray(rows - train.ends.T @ torque)

    def rates(self, rows: FloatArray, balance: FloatArray) -> FloatArray:
        """Rates of rows that have no rates of inputs."""
        rates = rows[:, self.speed] @ balance if len(rows) else rows.copy()
        rates[:, self.speed] += rows[:, self.position]
        rates[:, self.input_rates] += rows[:, self.inputs]
        return np.asarray(rates)


def regime_of(train: LoadedModes, modes: Modes) -> Regime:
    """The linear motion while every element stays in its regime."""
    laws = tuple(element.law(mode) for element, mode in zip(train.elements, modes, strict=True))
    layout, ends = Layout(train), train.ends
    springs, stuck = (_of_kind(laws, kind) for kind in ("spring", "stuck"))
    moves = np.array([law.moves for law in laws], dtype=bool)
    soft = np.zeros((len(laws),) * 2) if train.compliance is None else train.compliance
    offsets = layout.inputs.start + train.following.stop

    twist, given = np.zeros((2, len(laws), layout.size))
    twist[:, layout.position] = ends
    if train.higher_answer is not None:
        twist[:, layout.inputs.start + 1 : offsets] = train.higher_answer
    twist[moves, offsets + np.flatnonzero(moves)] = -1.0
    given[:, layout.inputs] = np.array([[law.sign] for law in laws]).reshape(-1, 1) * train.capacity

    def of_springs(chosen: IntArray) -> FloatArray:
        """(chosen, rows) N m of elements that are springs together, beside what modes left out give way."""
        stiffness = train.stiffness[chosen]
        series = np.eye(len(chosen)) + soft[np.ix_(chosen, chosen)] * stiffness
        share = np.linalg.solve(series, np.eye(len(chosen)))
        torque = (stiffness[:, None] * share) @ (twist[chosen] - soft[chosen] @ given)
        damped = share.T @ (train.viscous[chosen, None] * share)
        torque[:, layout.speed] += damped @ ends[chosen]
        return np.asarray(torque)

    torque = given.copy()
    torque[springs] = of_springs(springs)
    if stuck.size:
        try:
            torque[stuck] = np.linalg.solve(
                ends[stuck] @ ends[stuck].T, ends[stuck] @ layout.balance(torque)
            )
        except np.linalg.LinAlgError:
            message = "rigid clutches are parallel to each other, and nothing divides their torque"
            raise SolveError(message, "give one a stiffness") from None
    bent = twist - soft @ torque  # the springs' own, without their offsets
    balance = layout.balance(torque) if laws else np.zeros((0, layout.size))
    turning = layout.rates(bent, balance)

    watched, switches = list[FloatArray](), list[tuple[int, int]]()
    for number, (element, mode) in enumerate(zip(train.elements, modes, strict=True)):
        capacity = train.capacity[number]
        for switch in element.switches(mode):
            if switch.of == "torque":
                row = torque[number].copy()
            elif switch.of == "speed":
                # That of the slider: of the ends less what a changing capacity takes up in the spring.
                row = turning[number].copy()
                row[layout.input_rates] -= switch.factor * capacity / element.stiffness
            elif switch.of == "twist":
                row = bent[number].copy()
                row[layout.inputs.start] += laws[number].offset
            else:  # the torque that contact would have
                closed = np.union1d(springs, [number])
                row = of_springs(closed)[closed == number][0]
            row *= switch.factor
            row[layout.inputs] += switch.share * capacity
            row[layout.inputs.start] += switch.level
            watched.append(row)
            switches.append((number, switch.to))
    return Regime(
        train,
        torque,
        _elastic(train, laws, bent, torque),
        bent,
        np.array(watched).reshape(-1, layout.size),
        tuple(switches),
        np.array([law.offset for law in laws]),
        moves,
        np.array([law.kind == "stuck" for law in laws], dtype=bool),
        np.concatenate([springs, stuck]),
        *_in_roots(train, layout, balance, torque, springs, stuck),
    )


def _elastic(
    train: LoadedModes, laws: tuple[Law, ...], bent: FloatArray, torque: FloatArray
) -> FloatArray:
    """(elements, rows) sqrt(N m): of springs, also such as give up their energy, and of those that slip."""
    rows = np.zeros_like(bent)
    for number, (law, stiffness) in enumerate(zip(laws, train.stiffness.tolist(), strict=True)):
        if law.kind in ("spring", "parted"):
            rows[number] = bent[number] * math.sqrt(stiffness)
        elif law.kind == "given" and math.isfinite(stiffness):
            rows[number] = torque[number] / math.sqrt(stiffness)
    return rows


def _of_kind(laws: tuple[Law, ...], kind: str) -> IntArray:
    """Numbers of the elements that have a law of a kind."""
    return np.array([number for number, law in enumerate(laws) if law.kind == kind], dtype=np.int64)


def _in_roots(
    train: LoadedModes,
    layout: Layout,
    balance: FloatArray,
    torque: FloatArray,
    springs: IntArray,
    stuck: IntArray,
) -> tuple[FloatArray | None, FloatArray, FloatArray, Roots, ComplexArray]:
    """Basis, what is free, constraint, roots and force of a regime."""
    n, rigid, damping, w = (
        train.motions,
        train.modes.rigid,
        train.modes.damping,
        train.modes.w_of_all,
    )
    size = np.abs(damping[:rigid]).max(axis=1, initial=0.0)
    is_damped = size > NOTHING * np.abs(damping).max(initial=0.0)
    constraint = np.zeros((n, train.inputs))
    push = balance[:, layout.inputs] if train.elements else train.push
    ends, fixed = train.ends[springs], train.ends[stuck]
    held = np.concatenate([ends, fixed])
    held = held[:, :rigid] / np.abs(held).max(axis=1, initial=TINY)[:, None]
    damped = np.where(is_damped, damping[:, :rigid], 0.0) / max(size.max(initial=0.0), TINY)
    values, turned = np.linalg.svd(np.concatenate([held, damped]))[1:]
    count = rigid - np.count_nonzero(values > HELD)
    if not (len(held) or is_damped[:count].any()):
        # The motions that nothing holds stand first.
        roots = roots_of(w[count:], damping[count:, count:])
        force = np.concatenate([push[:count], _times(roots.of_speed, push[count:])])
        return None, np.eye(n)[:, :count], constraint, roots, force

    free = np.pad(turned[rigid - count :].T, ((0, n - rigid), (0, 0)))
    inside = np.eye(n)
    if stuck.size:
        constraint[:, train.following.stop + stuck] = np.linalg.pinv(fixed)
        inside = np.linalg.qr(fixed.T, mode="complete")[0][:, len(stuck) :]
    beside = inside.T @ free
    basis = inside @ np.linalg.qr(beside, mode="complete")[0][:, beside.shape[1] :]
    offsets = layout.inputs.start + train.following.stop + springs
    root_of_springs = np.linalg.cholesky(-torque[np.ix_(springs, offsets)]).T @ ends
    # Singular values know slow modes better than eigenvalues of the stiffness do.
    values, turned = np.linalg.svd(np.concatenate([np.diag(w)[rigid:], root_of_springs]) @ basis)[
        1:
    ]
    w = np.pad(values, (0, len(turned) - len(values)))
    w[w < NOTHING * w.max(initial=0.0)] = 0.0
    basis = basis @ turned.T
    damping = -balance[:, layout.speed]
    roots = roots_of(w, basis.T @ damping @ basis, settles=False)
    push = push + balance[:, layout.position] @ constraint
    force = np.concatenate([free.T @ push, _times(roots.of_speed, basis.T @ push)])
    return basis, free, constraint, roots, force


def _times(factors: ComplexArray, columns: np.ndarray) -> ComplexArray:
    return np.asarray(factors[:, None] * columns if factors.ndim == 1 else factors @ columns)
