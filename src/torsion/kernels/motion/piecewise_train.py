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
    compliance: FloatArray | None = (
        None  # (elements, elements) rad/(N m) of the modes that are left out
    )
    rest: ComplexArray | None = None  # (elements, signals) rad/(N m): their answer to the signals

    @property
    def rigid(self) -> int:
        """Number of rigid motions."""
        return len(self.damping) - len(self.w)

    @cached_property
    def layout(self) -> tuple[slice, slice, slice, slice, slice]:
        """Where x, w q, the speeds, the signals and the angles stand in a state; 1 stands last."""
        angles = self.rigid if self.signals.polynomials else 0
        ends = np.cumsum(
            [0, len(self.elements), len(self.w), len(self.damping), self.signals.size, angles]
        ).tolist()
        x, place, speed, signal, turned = (slice(*pair) for pair in pairwise(ends))
        return x, place, speed, signal, turned

    @property
    def size(self) -> int:
        """Of a state."""
        return int(self.layout[4].stop) + 1

    def at_first(self, twist: FloatArray, place: FloatArray, speed: FloatArray) -> FloatArray:
        """(state,) from x (elements,) rad, places (modes,), speeds (rigid motions + modes,), without signals."""
        z = np.zeros(self.size)
        for part, values in zip(
            self.layout, (self.root * twist, self.w * place, speed), strict=False
        ):
            z[part] = values
        z[-1] = 1.0
        return z

    @cached_property
    def root(self) -> FloatArray:
        """(elements,) sqrt(N m/rad), by which x is scaled."""
        return np.array(
            [
                math.sqrt(one.stiffness) if math.isfinite(one.stiffness) else 1.0
                for one in self.elements
            ]
        )

    @cached_property
    def ends(self) -> FloatArray:
        """(elements, rigid motions + modes) scaled."""
        rows = np.array([one.ends for one in self.elements]).reshape(-1, len(self.damping))
        return np.asarray(self.root[:, None] * rows)

    def rows(self, factor: ComplexArray | FloatArray) -> FloatArray:
        """(rows, state) of Re(factor (rows, signals) * signals)."""
        found = np.zeros((len(factor), self.size))
        real, imaginary = self.signals.rows
        found[:, self.layout[3]] = factor.real @ real - factor.imag @ imaginary
        return found

    @cached_property
    def unforced(self) -> FloatArray:
        """(state, state) A without elements."""
        matrix, (_, place, speed, signal, turned) = np.zeros((self.size, self.size)), self.layout
        elastic = slice(speed.start + self.rigid, speed.stop)
        matrix[place, elastic] = np.diag(self.w)
        matrix[elastic, place] = -np.diag(self.w)
        matrix[speed, speed] = -self.damping
        matrix[speed] += self.rows(self.force)
        matrix[signal, signal] = self.signals.matrix
        matrix[turned, speed.start : speed.start + turned.stop - turned.start] = np.eye(
            turned.stop - turned.start
        )
        return matrix

    @cached_property
    def relative_speed(self) -> FloatArray:
        """(elements, state) scaled."""
        return np.pad(self.ends, ((0, 0), (self.layout[2].start, self.size - self.layout[2].stop)))

    @cached_property
    def resting(self) -> FloatArray:
        """(elements, state) scaled twists that the modes left out add by themselves."""
        if self.rest is None:
            return np.zeros((len(self.elements), self.size))
        return np.asarray(self.root[:, None] * self.rows(self.rest))

    @cached_property
    def series(self) -> FloatArray:
        """(elements, elements) scaled compliance of the modes that are left out."""
        size = len(self.elements)
        return (
            np.zeros((size, size))
            if self.compliance is None
            else self.root[:, None] * self.compliance * self.root
        )

    @cached_property
    def capacity(self) -> FloatArray:
        """(elements, state) N m."""
        constant, chosen = (
            np.zeros(len(self.elements)),
            np.zeros((len(self.elements), self.signals.number)),
        )
        for number, element in enumerate(self.elements):
            if isinstance(element, Friction) and element.signal is not None:
                chosen[number, element.signal] = 1.0
            elif not isinstance(element, Clearance):
                constant[number] = element.capacity
        rows = self.rows(chosen)
        rows[:, -1] = constant
        return rows


def regime(
    train: PiecewiseTrain, state: State, *, longest: float, fineness: float, dips: bool
) -> Regime:
    """The linear motion while every element stays in its regime; longest: s of a step at most."""
    laws = [one.law(own) for one, own in zip(train.elements, state, strict=True)]
    torque, elastic = _torques(train, laws)
    matrix = train.unforced.copy()
    matrix[train.layout[2]] -= train.ends.T @ torque
    for number, law in enumerate(laws):
        if law.moves:
            matrix[number] = train.relative_speed[number]
    twist, turning = elastic + _offsets(train, laws), train.relative_speed
    if train.compliance is not None:
        turning = turning + (train.resting - train.series @ torque) @ matrix
    events = [
        _function(train, number, switch, _Rows(twist, torque, turning, laws))
        for number, (element, own) in enumerate(zip(train.elements, state, strict=True))
        for switch in element.switches(own)
    ]
    inner = train.layout[3].start
    w = max(fastest(matrix[:inner, :inner]), train.signals.fastest)
    step = fineness * min(longest, RADIANS / w if w else math.inf)
    for number, (law, element) in enumerate(zip(laws, train.elements, strict=True)):
        if law.kind in ("free", "stuck") or math.isinf(element.stiffness):
            elastic[number] = 0.0
        elif law.kind == "given":
            elastic[number] = torque[number]
    rows = np.array(events).reshape(-1, train.size)
    return Regime(matrix, rows, torque * train.root[:, None], elastic, step, dips)


def _offsets(train: PiecewiseTrain, laws: list[Law]) -> FloatArray:
    rows = np.zeros((len(laws), train.size))
    rows[:, -1] = [law.offset for law in laws] * train.root
    return rows


def _torques(train: PiecewiseTrain, laws: list[Law]) -> tuple[FloatArray, FloatArray]:
    """Rows (elements, state) of the scaled torques, and of the scaled twists without offset (free and spring)."""
    left, right = np.eye(len(laws)), np.zeros((len(laws), train.size))
    elastic = train.resting - _offsets(train, laws)
    elastic[:, train.layout[0]] += np.eye(len(laws))
    twisting = _twisting(train, laws)
    for number, law in enumerate(laws):
        if law.kind == "spring":
            left[number] += train.series[number]
            right[number] = elastic[number] + _lag(train, number) * twisting[number]
        elif law.kind == "given":
            right[number] = law.sign * train.capacity[number] / train.root[number]
        elif law.kind == "stuck":
            left[number] = train.ends @ train.ends[number]
            right[number] = train.ends[number] @ train.unforced[train.layout[2]]
    try:
        torque = np.asarray(np.linalg.solve(left, right)) if len(laws) else right
    except np.linalg.LinAlgError:
        message, hint = (
            "rigid clutches are parallel to each other, and nothing divides their torque",
            "give one a stiffness",
        )
        raise SolveError(message, hint) from None
    return torque, elastic - train.series @ torque


def _twisting(train: PiecewiseTrain, laws: list[Law], touching: int | None = None) -> FloatArray:
    """(elements, state) scaled rates of the twists of elements, one more taken as `touching`.

    The modes left out take the share of it that their compliance has beside the springs; dampers change it little.
    """
    rate = train.relative_speed + train.resting @ train.unforced
    if train.compliance is None:
        return rate
    springs = np.array(
        [law.kind == "spring" or number == touching for number, law in enumerate(laws)], dtype=float
    )
    return np.asarray(np.linalg.solve(np.eye(len(laws)) + train.series * springs, rate))


def _lag(train: PiecewiseTrain, number: int) -> float:
    """s, viscous damping of an element over its stiffness."""
    element = train.elements[number]
    return float(getattr(element, "viscous", 0.0)) / element.stiffness


@dataclass(frozen=True)
class _Rows:
    """(elements, state) scaled, of a regime."""

    twist: FloatArray
    torque: FloatArray
    turning: FloatArray  # rates of the twists, also of those that the modes left out add
    laws: list[Law]


def _function(train: PiecewiseTrain, number: int, switch: Switch, rows: _Rows) -> FloatArray:
    """(state,) a switching function; its size is of no account."""
    root = train.root[number]
    if (
        switch.of == "speed"
    ):  # of the slider: that of the ends less what a changing capacity takes up in the spring
        changing = train.capacity[number] @ train.unforced
        row, unit = (
            rows.turning[number]
            - switch.factor * changing * root / train.elements[number].stiffness,
            root,
        )
    elif switch.of == "torque":
        row, unit = rows.torque[number], 1.0 / root
    elif switch.of == "twist":
        row, unit = rows.twist[number], root
    else:  # the torque that contact would have
        row = rows.twist[number] + _lag(train, number) * _twisting(train, rows.laws, number)[number]
        offset = float(getattr(train.elements[number], "half", 0.0)) * root
        row, unit = row - np.sign(-switch.factor) * offset * np.eye(train.size)[-1], 1.0 / root
    function = switch.factor * row + switch.share * train.capacity[number] * unit
    function[-1] += switch.level * unit
    return np.asarray(function)
