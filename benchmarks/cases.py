"""Trains that every program is given alike: free chains and geared trees, benign and stiff, from a seed."""

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np

# Few gear pairs whatever the size: openTorsion multiplies two full matrices for every pair, four times an assembly.
GEAR_PAIRS = {10: 2, 100: 5, 1000: 10}


@dataclass(frozen=True)
class Gear:
    """A pair of wheels at the far end of a span; the driven wheel sits on the span's own station."""

    driving_teeth: int
    driven_teeth: int
    driving_inertia: float  # kg m2
    driven_inertia: float  # kg m2


@dataclass(frozen=True)
class Case:
    """A free tree of discs; span i joins station i to `parent[i] < i` and turns at the parent's speed."""

    name: str
    parent: tuple[int, ...]  # -1 at the root, which is station 0
    inertia: tuple[float, ...]  # kg m2, of the disc at its own speed
    stiffness: tuple[float, ...]  # N m/rad; unused at the root
    gear: tuple[Gear | None, ...]
    damping: tuple[float, ...]  # N m s/rad, disc to ground
    viscous: tuple[float, ...]  # N m s/rad, in the span

    @property
    def size(self) -> int:
        """Number of stations, which is the number of free angles."""
        return len(self.parent)

    @property
    def is_chain(self) -> bool:
        """Every span joins neighbours at one speed."""
        return self.parent == tuple(range(-1, self.size - 1)) and not any(self.gear)

    @property
    def ratio(self) -> list[Fraction]:
        """Speed of each station over that of the root; wheels in mesh turn against each other."""
        ratio = [Fraction(1)]
        for parent, gear in zip(self.parent[1:], self.gear[1:], strict=True):
            step = Fraction(-gear.driving_teeth, gear.driven_teeth) if gear else Fraction(1)
            ratio.append(ratio[parent] * step)
        return ratio


@dataclass(frozen=True)
class Condensed:
    """A case referred to the speed of its root, in the numbers of any arithmetic."""

    parent: tuple[int, ...]
    inertia: list[Any]
    stiffness: list[Any]  # unused at the root
    damping: list[Any]
    viscous: list[Any]
    ratio: list[Any]  # speed of each station over that of the root
    span_ratio: list[Any]  # speed of each span over that of the root


def condensed(case: Case, number: Callable[[Any], Any] = float) -> Condensed:
    """The case with its gears condensed: products and sums of positive terms, in the arithmetic of `number`."""
    ratio = [number(r.numerator) / number(r.denominator) for r in case.ratio]
    span = [ratio[max(parent, 0)] for parent in case.parent]
    inertia = []
    for own, gear, r, s in zip(case.inertia, case.gear, ratio, span, strict=True):
        total = r * r * number(own)
        if gear:
            total = (
                total + r * r * number(gear.driven_inertia) + s * s * number(gear.driving_inertia)
            )
        inertia.append(total)
    return Condensed(
        parent=case.parent,
        inertia=inertia,
        stiffness=[s * s * number(k) for s, k in zip(span, case.stiffness, strict=True)],
        damping=[r * r * number(c) for r, c in zip(ratio, case.damping, strict=True)],
        viscous=[s * s * number(c) for s, c in zip(span, case.viscous, strict=True)],
        ratio=ratio,
        span_ratio=span,
    )


def chain(size: int, *, stiff: bool, seed: int = 0) -> Case:
    """A free chain of `size` discs."""
    random = np.random.default_rng([seed, size, stiff])
    return _case(
        f"chain {_word(stiff)}", tuple(range(-1, size - 1)), [None] * size, random, stiff=stiff
    )


def geared_tree(size: int, *, stiff: bool, seed: int = 0) -> Case:
    """A free tree of `size` discs: a main line with branches of every depth, gear pairs strewn over its spans."""
    random = np.random.default_rng([seed, size, stiff, 1])
    parent = [-1]
    for station in range(1, size):
        back = 0 if random.random() < 0.7 else int(random.integers(0, min(station, 10)))
        parent.append(station - 1 - back)
    gear: list[Gear | None] = [None] * size
    for station in random.choice(
        np.arange(1, size), GEAR_PAIRS.get(size, 1), replace=False
    ).tolist():
        teeth = random.integers(17, 61, 2).tolist()
        driving, driven = (float(v) for v in _inertia(2, random, stiff=stiff) / 10)
        gear[station] = Gear(teeth[0], teeth[1], driving, driven)
    return _case(f"geared tree {_word(stiff)}", tuple(parent), gear, random, stiff=stiff)


def with_span_dampers(case: Case, share: float = 0.05) -> Case:
    """The same train damped in its spans in place of its discs: c = share k / (a frequency in the middle of all)."""
    middle = _middle_frequency(np.array(case.inertia), np.array(case.stiffness[1:]))
    viscous = tuple(share * k / middle for k in case.stiffness)
    zero = (0.0,) * case.size
    return Case(
        f"{case.name}, dampers in spans",
        case.parent,
        case.inertia,
        case.stiffness,
        case.gear,
        zero,
        viscous,
    )


def undamped(case: Case) -> Case:
    """The same train with no damper."""
    zero = (0.0,) * case.size
    return Case(case.name, case.parent, case.inertia, case.stiffness, case.gear, zero, zero)


def _case(
    name: str,
    parent: tuple[int, ...],
    gear: list[Gear | None],
    random: np.random.Generator,
    *,
    stiff: bool,
) -> Case:
    size = len(parent)
    inertia = _inertia(size, random, stiff=stiff)
    stiffness = 10 ** random.uniform(0, 12, size) if stiff else random.uniform(1e4, 5e4, size)
    damping = 0.02 * _middle_frequency(inertia, stiffness[1:]) * inertia
    zero = (0.0,) * size
    return Case(
        name, parent, _floats(inertia), _floats(stiffness), tuple(gear), _floats(damping), zero
    )


def _inertia(size: int, random: np.random.Generator, *, stiff: bool) -> np.ndarray:
    return 10 ** random.uniform(-6, 4, size) if stiff else random.uniform(0.5, 2.0, size)


def _middle_frequency(inertia: np.ndarray, stiffness: np.ndarray) -> float:
    """sqrt of geometric mean stiffness over geometric mean inertia, rad/s."""
    return float(np.exp(0.5 * (np.log(stiffness).mean() - np.log(inertia).mean())))


def _floats(values: np.ndarray) -> tuple[float, ...]:
    return tuple(float(v) for v in values)


def _word(stiff: bool) -> str:
    return "stiff" if stiff else "benign"
