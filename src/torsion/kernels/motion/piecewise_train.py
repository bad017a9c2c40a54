"""A train of modes and the elements between them, which is linear as long as no element changes its regime.

The state is z = (x of the elements, w q of the elastic modes, speeds of all motions, states of the torques, angles of
the rigid motions where torques follow them, 1). x of an element is a state of its own, so that no twist is a difference
of large angles; it is scaled by the root of the element's stiffness, as the modes are by their frequencies, so that A
is balanced.

Modes above a band may be left out: their `compliance` F is then in series with the elements, u = x + rest - F T.
"""

import math
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from torsion.arrays import ComplexArray, FloatArray
from torsion.errors import SolveError
from torsion.kernels.motion.generated_signals import Signals
from torsion.kernels.motion.linear_regime import RADIANS, Regime, fastest
from torsion.kernels.motion.piecewise_elements import Clearance, Element, Friction, Law, Switch

State = tuple[int, ...]  # the regime of every element


@dataclass(frozen=True)
class PiecewiseTrain:
    """Rigid motions and elastic modes of generalised inertia 1, the elements between them, and what acts on them."""

    w: FloatArray  # (modes,) rad/s
    damping: FloatArray  # (rigid motions + modes, the same) 1/s
    elements: tuple[Element, ...]
    signals: Signals
    force: ComplexArray  # (rigid motions + modes, signals); the torque is Re(force * signal)
    # (elements, elements) rad/(N m) of the modes that are left out
    compliance: FloatArray | None = None
    # (elements, signals) rad/(N m): their answer to the signals
    higher_answer: ComplexArray | None = None

    @property
    def rigid(self) -> int:
        """How many rigid motions stand before the modes."""
        return len(self.damping) - len(self.w)

    @cached_property
    def layout(self) -> tuple[slice, slice, slice, slice, slice]:
        """Where x, w q, the speeds, the signals and the angles stand in a state; 1 stands last."""
        angles = self.rigid if self.signals.polynomials else 0
        sizes = [len(self.elements), len(self.w), len(self.damping), self.signals.size, angles]
        ends = np.cumsum([0, *sizes]).tolist()
        x, position, speed, signal, turned = (slice(*pair) for pair in pairwise(ends))
        return x, position, speed, signal, turned

    @property
    def size(self) -> int:
        """How many states the train has, the constant 1 included."""
        return int(self.layout[4].stop) + 1

    def at_first(self, twist: FloatArray, position: FloatArray, speed: FloatArray) -> FloatArray:
        """(state,) from x (elements,) rad, positions (modes,), speeds (rigid motions + modes,), without signals."""
        z = np.zeros(self.size)
        values = np.concatenate([self.root * twist, self.w * position, speed])
        z[: len(values)], z[-1] = values, 1.0
        return z

    @cached_property
    def root(self) -> FloatArray:
        """(elements,) sqrt(N m/rad), by which x is scaled."""
        stiffness = np.array([element.stiffness for element in self.elements])
        return np.sqrt(np.where(np.isfinite(stiffness), stiffness, 1.0))

    @cached_property
    def ends(self) -> FloatArray:
        """(elements, rigid motions + modes) scaled."""
        rows = [element.ends for element in self.elements]
        return np.asarray(self.root[:, None] * np.array(rows).reshape(-1, len(self.damping)))

    def rows(self, factor: ComplexArray | FloatArray) -> FloatArray:
        """(rows, state) of Re(factor (rows, signals) * signals)."""
        rows = np.zeros((len(factor), self.size))
        real, imaginary = self.signals.rows
        rows[:, self.layout[3]] = factor.real @ real - factor.imag @ imaginary
        return rows

    @cached_property
    def unforced(self) -> FloatArray:
        """Matrix A of the train without its elements, (state, state)."""
        matrix, (_, position, speed, signal, turned) = np.zeros((self.size, self.size)), self.layout
        elastic, angles = speed.start + self.rigid, turned.stop - turned.start
        matrix[position, elastic : speed.stop] = np.diag(self.w)
        matrix[elastic : speed.stop, position] = -np.diag(self.w)
        matrix[speed, speed] = -self.damping
        matrix[speed] += self.rows(self.force)
        matrix[signal, signal] = self.signals.matrix
        matrix[turned, speed.start : speed.start + angles] = np.eye(angles)
        return matrix

    @cached_property
    def relative_speed(self) -> FloatArray:
        """Rows of the relative speed of the ends of each element, (elements, state), scaled."""
        return np.pad(self.ends, ((0, 0), (self.layout[2].start, self.size - self.layout[2].stop)))

    @cached_property
    def resting(self) -> FloatArray:
        """(elements, state) scaled twists that the modes left out add by themselves."""
        if self.higher_answer is None:
            return np.zeros((len(self.elements), self.size))
        return np.asarray(self.root[:, None] * self.rows(self.higher_answer))

    @cached_property
    def series(self) -> FloatArray:
        """(elements, elements) scaled compliance of the modes that are left out."""
        scale = np.multiply.outer(self.root, self.root)
        return 0.0 * scale if self.compliance is None else self.compliance * scale

    @cached_property
    def capacity(self) -> FloatArray:
        """Rows of the capacity of each element, (elements, state) N m; 0 of those without."""
        chosen = np.zeros((len(self.elements), self.signals.number))
        constant = np.array([getattr(element, "capacity", 0.0) for element in self.elements])
        for number, element in enumerate(self.elements):
            if isinstance(element, Friction) and element.signal is not None:
                chosen[number, element.signal], constant[number] = 1.0, 0.0
        rows = self.rows(chosen)
        rows[:, -1] = constant
        return rows

    def lag(self, number: int) -> float:
        """s, viscous damping of an element over its stiffness."""
        element = self.elements[number]
        return element.viscous / element.stiffness if isinstance(element, Clearance) else 0.0

    def twisting(self, is_spring: list[bool]) -> FloatArray:
        """(elements, state) scaled rates of the twists of elements, of which some are springs.

        The modes left out take the share of it that their compliance has beside the springs; dampers change it little.
        """
        rate = self.relative_speed + self.resting @ self.unforced
        if self.compliance is None:
            return rate
        return np.asarray(np.linalg.solve(np.eye(len(is_spring)) + self.series * is_spring, rate))


def regime(train: PiecewiseTrain, state: State, *, longest: float, fineness: float) -> Regime:
    """The linear motion while every element stays in its regime; longest: s of a step at most."""
    pairs = list(zip(train.elements, state, strict=True))
    laws = [element.law(mode) for element, mode in pairs]
    offset = np.zeros((len(laws), train.size))
    offset[:, -1] = [law.offset for law in laws] * train.root
    torque, elastic = _torques(train, laws, offset)
    matrix = train.unforced.copy()
    matrix[train.layout[2]] -= train.ends.T @ torque
    moves = [number for number, law in enumerate(laws) if law.moves]
    matrix[moves] = train.relative_speed[moves]
    turning = train.relative_speed
    if train.compliance is not None:
        turning = turning + (train.resting - train.series @ torque) @ matrix
    rows = _Rows(elastic + offset, torque, turning, laws)
    events = [
        _switching_function(train, number, switch, rows)
        for number, (element, mode) in enumerate(pairs)
        for switch in element.switches(mode)
    ]
    inner = train.layout[3].start
    w = max(fastest(matrix[:inner, :inner]), train.signals.fastest)
    step = fineness * min(longest, RADIANS / w if w else math.inf)
    for number, (law, (element, _)) in enumerate(zip(laws, pairs, strict=True)):
        if law.kind in ("free", "stuck") or math.isinf(element.stiffness):
            elastic[number] = 0.0
        elif law.kind == "given":
            elastic[number] = torque[number]
    functions = np.array(events).reshape(-1, train.size)
    return Regime(matrix, functions, torque * train.root[:, None], elastic, step)


def _torques(
    train: PiecewiseTrain, laws: list[Law], offset: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Rows (elements, state) of the scaled torques, and of the scaled twists without offset (free and spring)."""
    left, right = np.eye(len(laws)), np.zeros((len(laws), train.size))
    elastic = train.resting - offset
    elastic[:, train.layout[0]] += np.eye(len(laws))
    twisting = train.twisting([law.kind == "spring" for law in laws])
    for number, law in enumerate(laws):
        if law.kind == "spring":
            left[number] += train.series[number]
            right[number] = elastic[number] + train.lag(number) * twisting[number]
        elif law.kind == "given":
            right[number] = law.sign * train.capacity[number] / train.root[number]
        elif law.kind == "stuck":
            left[number] = train.ends @ train.ends[number]
            right[number] = train.ends[number] @ train.unforced[train.layout[2]]
    try:
        torque = np.asarray(np.linalg.solve(left, right)) if laws else right
    except np.linalg.LinAlgError:
        message = "rigid clutches are parallel to each other, and nothing divides their torque"
        raise SolveError(message, "give one a stiffness") from None
    return torque, elastic - train.series @ torque


@dataclass(frozen=True)
class _Rows:
    """(elements, state) scaled, of a regime."""

    twist: FloatArray
    torque: FloatArray
    turning: FloatArray  # rates of the twists, also of those that the modes left out add
    laws: list[Law]


def _switching_function(
    train: PiecewiseTrain, number: int, switch: Switch, rows: _Rows
) -> FloatArray:
    """(state,) a switching function; its size is of no account."""
    root, element = train.root[number], train.elements[number]
    unit = 1.0 / root if switch.of in ("torque", "contact") else root
    if switch.of == "speed":
        # That of the slider: of the ends less what a changing capacity takes up in the spring.
        changing = train.capacity[number] @ train.unforced
        row = rows.turning[number] - switch.factor * changing * root / element.stiffness
    elif switch.of == "torque":
        row = rows.torque[number]
    elif switch.of == "twist":
        row = rows.twist[number]
    else:  # the torque that contact would have
        springs = [law.kind == "spring" or k == number for k, law in enumerate(rows.laws)]
        row = rows.twist[number] + train.lag(number) * train.twisting(springs)[number]
        if isinstance(element, Clearance):
            row[-1] += np.sign(switch.factor) * element.half * root
    function = switch.factor * row + switch.share * train.capacity[number] * unit
    function[-1] += switch.level * unit
    return np.asarray(function)
