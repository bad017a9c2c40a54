"""The linear motion of a train while every element keeps its regime, in roots of its own: exact at any time.

    p'' + C p' + K p = B U,   y' = root y + force U,   p = turned + Re(place y) + constraint U
with all inputs U of the train; motions that nothing holds are kept apart. What is read of a motion are rows over
(p, p', U, U'). Elements that stick rigidly are constraints; modes above a band may be left out: their compliance F is in
series with the elements, u = ends p + rest - F T.
"""

import math
from dataclasses import dataclass
from functools import cached_property
from itertools import zip_longest
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from torsion.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from torsion.errors import SolveError
from torsion.kernels.motion.loaded_modes import LoadedModes, Start, answers, turning

if TYPE_CHECKING:
    from torsion.kernels.motion.piecewise_elements import Law, Switch

Modes = tuple[int, ...]  # the regime of every element
HELD = 1e-10  # relative: rigid motions that springs and dampers twist by less are free
TINY = float(np.finfo(float).tiny)
ROUNDS = 2  # of inverse iteration: it converges with the square of the error
LARGEST_SETTLED = 150  # coordinates up to which every root is settled, which costs their number to the fourth power
NEARLY_CRITICAL = 0.999  # damping ratio up to which a mode is taken by itself
NOTHING = 1e-12  # of the fastest: a slower mode stands still


class Reading(NamedTuple):
    """A motion at some times; positions of rigid motions count from the begin of a step, or are whole ones."""

    position: FloatArray  # (motions, times)
    speed: FloatArray
    inputs: FloatArray  # (inputs, times)
    input_rates: FloatArray
    acceleration: FloatArray  # (motions, times)
    torque: FloatArray  # (elements, times) N m
    torque_rate: FloatArray  # (elements, times) N m/s


@dataclass(frozen=True)
class Roots:
    """Coordinates y' = root y + of_speed f of modes under generalised forces f, y = of_speed v + of_position q.

    Each stands for a pair where its root is complex. q is the real part of shape y, v that of shape (root y). Modes that
    no damping couples have factors (modes,) in place of matrices.
    """

    root: ComplexArray  # (coordinates,) 1/s
    shape: ComplexArray  # (modes, coordinates)
    of_speed: ComplexArray  # (coordinates, modes)
    of_position: ComplexArray  # (coordinates, modes)


def roots_of(w: FloatArray, damping: FloatArray, *, settles: bool = True) -> Roots:
    """The roots of modes of natural frequencies w (modes,) rad/s under a damping (modes, modes) 1/s.

    Where damping couples modes, roots r and shapes x answer (r**2 + r damping + w**2) x = 0. Their rough values are
    eigenvalues of the first-order form in speeds and w times positions; each is then settled by inverse iteration with
    the Rayleigh quotient of the second-order form, which keeps the digits of slow ones. settles: shapes are improved too;
    else only the roots, which takes less time.
    """
    half = np.diag(damping) / 2.0
    is_coupled = bool((damping - np.diag(2.0 * half)).any())
    if not is_coupled and (half < NEARLY_CRITICAL * w).all():
        vibrating = np.sqrt(w**2 - half**2)
        root = -half + 1j * vibrating
        return Roots(root, -1j / vibrating, np.ones_like(root), -root.conj())

    size, scale = len(w), np.where(w > 0.0, w, 1.0)
    first_order_form = np.block([[-damping, -np.diag(w)], [np.diag(scale), np.zeros((size, size))]])
    roots, vectors = np.linalg.eig(first_order_form)
    pairs = []
    for k in np.flatnonzero(np.imag(roots) >= 0.0):
        shape = np.asarray(vectors[size:, k] / scale, dtype=vectors.dtype)
        pairs.append(_settle(complex(roots[k]), shape, w, damping, settles=settles))
    root, shape = np.array([root for root, _ in pairs]), np.array([shape for _, shape in pairs]).T
    vibrates = root.imag != 0.0
    roots = np.concatenate([root, root[vibrates].conj()])
    shapes = np.concatenate([shape, shape[:, vibrates].conj()], axis=1)
    states = np.concatenate([shapes * roots, scale[:, None] * shapes])
    left = np.linalg.solve(states, np.eye(2 * size))[: len(root)]
    twice = np.where(vibrates, 2.0, 1.0)
    return Roots(root, shape * twice, left[:, :size], left[:, size:] * scale)


def _settle(
    root: complex, shape: ComplexArray, w: FloatArray, damping: FloatArray, *, settles: bool
) -> tuple[complex, ComplexArray]:
    """One root with its shape, whose largest component is 1."""
    shape = np.asarray(shape / np.abs(shape).max(), dtype=complex)
    for _ in range(ROUNDS if len(w) <= LARGEST_SETTLED else 0):
        if settles:
            matrix = np.diag(w.astype(complex) ** 2) + root * damping
            matrix[np.diag_indices_from(matrix)] += root**2
            try:
                shape = np.asarray(np.linalg.solve(matrix, (2.0 * root) * shape + damping @ shape))
            except np.linalg.LinAlgError:
                break  # the root is exact
            shape = np.asarray(shape / np.abs(shape).max())
        # The solution of a r**2 + b r + c = 0 that is nearest to the root, without cancellation; real where it was.
        a, b = complex(shape @ shape), complex(shape @ damping @ shape)
        c = complex((w * shape) @ (w * shape))
        split = np.sqrt(complex(b * b - 4.0 * a * c))
        far = -(b + split if abs(b + split) >= abs(b - split) else b - split) / 2.0
        solutions, real = [far / a, c / far] if far != 0 else [root], root.imag == 0.0
        distances = [abs(solution - root) for solution in solutions]
        root = complex(solutions[int(np.argmin(distances))])
        root = complex(root.real) if real else root
    return root, shape


@dataclass(eq=False)
class Regime:
    """One linear motion; rows are over positions and speeds of the train's motions, its inputs and their rates.

    is_alone: every motion stands for itself.
    """

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
    # (motions, modes) of what an element ties; None: the last of the motions themselves
    basis: FloatArray | None
    free: FloatArray  # (motions, motions that nothing holds)
    constraint: FloatArray  # (motions, elements) of what sticks
    roots: Roots  # of what an element ties
    force: ComplexArray  # (coordinates, inputs)

    def __post_init__(self) -> None:
        train, self.is_alone = self.train, self.basis is None and self.roots.shape.ndim == 1
        # (coordinates,) 1/s, 0 of motions that nothing holds
        self.root = np.concatenate([np.zeros(self.free.shape[1]), self.roots.root])
        self.fastest = max(float(np.abs(self.root).max(initial=0.0)), train.fastest)  # 1/s
        # (rigid motions, tied elements) rad by which rigid motions twist elements by 1 rad
        ends = train.ends[self.tied, : train.modes.rigid]
        self.untwisting = np.asarray(np.linalg.pinv(ends, rcond=HELD))

    def held(self, rows: FloatArray) -> FloatArray:
        """Rows over motions (..., motions) as rows over the modes of what an element ties."""
        return rows[..., self.free.shape[1] :] if self.basis is None else rows @ self.basis

    def begin(
        self, position: FloatArray, speed: FloatArray, offset: FloatArray
    ) -> tuple[ComplexArray, FloatArray]:
        """Coordinates and positions of what nothing holds, from positions and speeds (motions,)."""
        position = position - self.constraint @ offset
        q, v, roots = self.held(position), self.held(speed), self.roots
        tied = _times(roots.of_speed, v[:, None]) + _times(roots.of_position, q[:, None])
        return np.concatenate([self.free.T @ speed, tied[:, 0]]), self.free.T @ position

    def coordinates(
        self, interval: int, start: Start, time: FloatArray
    ) -> tuple[ComplexArray, FloatArray]:
        """Coordinates and positions of what nothing holds at times (s) since a start in an interval of the history."""
        train, root, number = self.train, self.root, self.free.shape[1]
        acting = train.history.acting[interval]
        decay = np.exp(np.multiply.outer(root, time))
        y = start.y * decay
        turned = start.turned + start.y[:number].real * time
        # By rates of exponentials: generalised forces (coordinates, columns) by powers of time.
        loads = {0.0j: [self.force[:, :1] + self.force[:, train.following.stop :] @ start.offset]}
        if start.polynomial.any():
            powers = self.force[:, train.following] @ start.polynomial
            loads[0.0j] = [loads[0.0j][0] + powers[0], *powers[1:]]
        columns = acting.later(start.time - train.history.begin[interval])
        for rate, terms, count in acting.by_rate:
            force = self.force[:, 1 + acting.load[terms]]
            pushed = (force @ column[terms] for column in columns[:count])
            both = zip_longest(loads.get(rate, ()), pushed, fillvalue=0.0)
            loads[rate] = [np.add(first, second) for first, second in both]
        for rate, forces in loads.items():
            late = np.cumprod([time] * len(forces), axis=0)
            answered = answers(root, rate, time, len(forces), decay)
            y += np.einsum("kct,kct,kt->ct", forces, answered, late)
            if number:
                once = late * time * turning(rate, time, len(forces))
                turned = (
                    turned + np.einsum("kct,kt->ct", [row[:number] for row in forces], once).real
                )
        return y, turned

    def read(self, interval: int, start: Start, time: FloatArray) -> Reading:
        """The motion at times since its start, (times,) s."""
        y, turned = self.coordinates(interval, start, time)
        inputs, rates = self.train.inputs_at(interval, start, time, 2).transpose(2, 0, 1)
        position, speed = self.positions(y, turned, start.offset), self.speeds(y)
        gained = self.speeds(self.root[:, None] * y + self.force @ inputs)
        torque, changes = np.empty((2, len(self.torque), len(time)))
        if len(self.torque):
            torque = self.torque @ np.concatenate([position, speed, inputs, rates])
            changes = self.torque @ np.concatenate([speed, gained, rates, 0.0 * rates])
        return Reading(position, speed, inputs, rates, gained, torque, changes)

    @cached_property
    def rows(self) -> tuple[FloatArray, FloatArray]:
        """(motions, parts) of positions and of speeds, over real and imaginary parts of the coordinates."""
        eye = np.eye(self.train.motions)
        rows = self.reading(eye, 0.0 * eye), self.reading(0.0 * eye, eye)
        position, speed = (np.concatenate([row.real, -row.imag], axis=1) for row in rows)
        return position, speed

    def positions(self, y: ComplexArray, turned: FloatArray, offset: FloatArray) -> FloatArray:
        """(motions, times) of coordinates (coordinates, times), what nothing holds, and offsets of elements."""
        if self.is_alone:
            return np.concatenate([turned, (self.roots.shape[:, None] * y[len(turned) :]).real])
        position = self.rows[0] @ np.concatenate([y.real, y.imag])
        return np.asarray(position + self.free @ turned + self.constraint @ offset)

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
        roots = self.roots
        shape = np.diag(roots.shape) if roots.shape.ndim == 1 else roots.shape
        tied = self.held(position) @ shape + self.held(speed) @ (shape * roots.root)
        return np.concatenate([speed @ self.free, tied], axis=1)


def regime_of(train: LoadedModes, modes: Modes) -> Regime:
    """The linear motion while every element stays in its regime."""
    elements, ends = train.elements, train.ends
    laws = [element.law(mode) for element, mode in zip(elements, modes, strict=True)]
    kinds = np.array([law.kind for law in laws], dtype=object)
    springs, stuck = np.flatnonzero(kinds == "spring"), np.flatnonzero(kinds == "stuck")
    moves = np.array([law.moves for law in laws], dtype=bool)
    position, speed, inputs, input_rates = train.columns
    one, offsets = inputs.start, inputs.start + train.following.stop

    twist, given = np.zeros((2, len(laws), input_rates.stop))
    twist[:, position] = ends
    if train.higher_answer is not None:
        twist[:, one + 1 : offsets] = train.higher_answer
    twist[moves, offsets + np.flatnonzero(moves)] = -1.0
    given[:, inputs] = np.array([[law.sign] for law in laws]).reshape(-1, 1) * train.capacity

    torque = given.copy()
    torque[springs] = _of_springs(train, twist, given, springs)
    if stuck.size:
        try:
            torque[stuck] = np.linalg.solve(
                ends[stuck] @ ends[stuck].T, ends[stuck] @ _balance(train, torque)
            )
        except np.linalg.LinAlgError:
            message = "rigid clutches are parallel to each other, and nothing divides their torque"
            raise SolveError(message, "give one a stiffness") from None
    bent = twist - train.soft @ torque  # the springs' own, without their offsets

    accelerations = _balance(train, torque) if laws else np.zeros((0, input_rates.stop))

    def function(number: int, switch: "Switch") -> FloatArray:
        """(rows,) a switching function of an element."""
        capacity = train.capacity[number]
        if switch.of == "torque":
            row = torque[number].copy()
        elif switch.of == "speed":
            # That of the slider: of the ends less what a changing capacity takes up in the spring.
            row = bent[number, speed] @ accelerations
            row[speed] += bent[number, position]
            row[input_rates] += bent[number, inputs]
            row[input_rates] -= switch.factor * capacity / elements[number].stiffness
        elif switch.of == "twist":
            row = bent[number].copy()
            row[one] += laws[number].offset
        else:  # the torque that contact would have
            closed = np.union1d(springs, [number])
            row = _of_springs(train, twist, given, closed)[closed == number][0]
        row *= switch.factor
        row[inputs] += switch.share * capacity
        row[one] += switch.level
        return np.asarray(row)

    watched = [(number, switch) for number, law in enumerate(laws) for switch in law.switches]

    return Regime(
        train,
        torque,
        _elastic(train, laws, bent, torque),
        bent,
        np.array([function(*pair) for pair in watched]).reshape(-1, input_rates.stop),
        tuple((number, switch.to) for number, switch in watched),
        np.array([law.offset for law in laws]),
        moves,
        kinds == "stuck",
        np.concatenate([springs, stuck]),
        *_in_roots(train, accelerations, torque, springs, stuck),
    )


def _of_springs(
    train: LoadedModes, twist: FloatArray, given: FloatArray, chosen: IntArray
) -> FloatArray:
    """(chosen, rows) N m of elements that are springs together, beside what modes left out give way."""
    elements, soft = [train.elements[number] for number in chosen.tolist()], train.soft[chosen]
    stiffness, viscous = (
        np.array([getattr(element, name) for element in elements])
        for name in ("stiffness", "viscous")
    )
    series = np.eye(len(chosen)) + soft[:, chosen] * stiffness
    share = np.linalg.solve(series, np.eye(len(chosen)))
    torque = (stiffness[:, None] * share) @ (twist[chosen] - soft @ given)
    torque[:, train.columns[1]] += share.T @ (viscous[:, None] * share) @ train.ends[chosen]
    return np.asarray(torque)


def _balance(train: LoadedModes, torque: FloatArray) -> FloatArray:
    """(motions, rows) accelerations under torques (elements, rows) of the elements."""
    position, speed, inputs, _ = train.columns
    rows = np.zeros((train.motions, train.columns[-1].stop))
    rows[:, position] = -np.diag(train.modes.w_of_all**2)
    rows[:, speed] = -train.modes.damping
    rows[:, inputs] = train.push
    return np.asarray(rows - train.ends.T @ torque)


def _elastic(
    train: LoadedModes, laws: "list[Law]", bent: FloatArray, torque: FloatArray
) -> FloatArray:
    """(elements, rows) sqrt(N m): of springs, also such as give up their energy, and of those that slip."""
    rows = np.zeros_like(bent)
    for number, law in enumerate(laws):
        root_of_stiffness = math.sqrt(train.elements[number].stiffness)
        if law.kind in ("spring", "parted"):
            rows[number] = bent[number] * root_of_stiffness
        elif law.kind == "given" and math.isfinite(root_of_stiffness):
            rows[number] = torque[number] / root_of_stiffness
    return rows


def _in_roots(
    train: LoadedModes, balance: FloatArray, torque: FloatArray, springs: IntArray, stuck: IntArray
) -> tuple[FloatArray | None, FloatArray, FloatArray, Roots, ComplexArray]:
    """Basis, what is free, constraint, roots and force of a regime."""
    n, rigid, damping, w = (
        train.motions,
        train.modes.rigid,
        train.modes.damping,
        train.modes.w_of_all,
    )
    position, speed, inputs, _ = train.columns
    size = np.abs(damping[:rigid]).max(axis=1, initial=0.0)
    is_damped = size > NOTHING * np.abs(damping).max(initial=0.0)
    constraint = np.zeros((n, len(train.elements)))
    push = balance[:, inputs] if train.elements else train.push
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
        constraint[:, stuck] = np.linalg.pinv(fixed)
        inside = np.linalg.qr(fixed.T, mode="complete")[0][:, len(stuck) :]
    beside = inside.T @ free
    basis = inside @ np.linalg.qr(beside, mode="complete")[0][:, beside.shape[1] :]
    offsets = inputs.start + train.following.stop + springs
    root_of_springs = np.linalg.cholesky(-torque[np.ix_(springs, offsets)]).T @ ends
    # Singular values know slow modes better than eigenvalues of the stiffness do.
    values, turned = np.linalg.svd(np.concatenate([np.diag(w)[rigid:], root_of_springs]) @ basis)[
        1:
    ]
    w = np.pad(values, (0, len(turned) - len(values)))
    w[w < NOTHING * w.max(initial=0.0)] = 0.0
    basis = basis @ turned.T
    roots = roots_of(w, basis.T @ -balance[:, speed] @ basis, settles=False)
    push = push.copy()
    push[:, train.following.stop :] += balance[:, position] @ constraint
    force = np.concatenate([free.T @ push, _times(roots.of_speed, basis.T @ push)])
    return basis, free, constraint, roots, force


def _times(factors: ComplexArray, columns: np.ndarray) -> ComplexArray:
    return np.asarray(factors[:, None] * columns if factors.ndim == 1 else factors @ columns)
