"""Shafts in pieces and elements, and their transfer matrices in many digits, for the tests of distributed shafts."""

import sys
from collections.abc import Callable, Iterator
from itertools import pairwise
from types import ModuleType

import mpmath as mp
import numpy as np
import pytest
from numpy.polynomial import legendre

from torsion.kernels.distributed.continuous_shafts import (
    profile_points,
    profile_shafts,
    uniform_shafts,
)
from torsion.kernels.distributed.finite_elements import condensed_elements
from torsion.kernels.distributed.span_laws import Shafts
from torsion.kernels.trees.tree import Tree

DIGITS = 60


@pytest.fixture(autouse=True)
def _many_digits() -> Iterator[None]:
    with mp.workdps(DIGITS):
        yield


@pytest.fixture
def trains() -> ModuleType:
    """The functions of this file."""
    return sys.modules[__name__]


def chain(bars: int, discs: dict[int, float] | None = None, held: tuple[int, ...] = ()) -> Tree:
    """A chain of stations with nothing but distributed shafts between them and discs on some."""
    inertia = np.zeros(bars + 1)
    for station, value in (discs or {}).items():
        inertia[station] = value
    return Tree(
        np.arange(-1, bars), np.zeros(bars + 1), inertia, np.isin(np.arange(bars + 1), held)
    )


def pieces(length: float, rigidity: float, heavy: float, number: int) -> Shafts:
    """A uniform shaft in equal pieces along a chain."""
    law = uniform_shafts(np.full(number, length / number), rigidity, heavy)
    return Shafts(np.arange(1, number + 1), (law,))


def tapered(profile: Callable[[np.ndarray], np.ndarray], number: int) -> Shafts:
    """A shaft of length 1 with G I = rho I = `profile` in pieces along a chain, as a continuum."""
    at = profile((np.arange(number)[:, None] + profile_points()) / number)
    return Shafts(
        np.arange(1, number + 1), (profile_shafts(np.full(number, 1.0 / number), 1.0 / at, at),)
    )


def elements(
    degree: int,
    number: int,
    length: float = 1.0,
    rigidity: Callable[[np.ndarray], np.ndarray] = np.ones_like,
    heavy: Callable[[np.ndarray], np.ndarray] | None = None,
) -> Shafts:
    """Finite elements along a chain; `rigidity` and `heavy` (the same by default) are of x from 0 to 1."""
    made = [
        element(degree, length / number, rigidity, heavy or rigidity, i, number)
        for i in range(number)
    ]
    stiffness, inertia = (np.array(part) for part in zip(*made, strict=True))
    return Shafts(np.arange(1, number + 1), (condensed_elements(stiffness, inertia),))


def element(degree, length, rigidity, heavy, position=0, number=1):
    """Matrices of one element by Gauss and Legendre, with integrated Legendre polynomials inside."""
    x, weight = legendre.leggauss(degree + 8)
    legs = np.eye(degree + 1)
    scale = [np.sqrt(j - 0.5) for j in range(2, degree + 1)]
    bubbles = [
        a * (legendre.legval(x, legs[j]) - legendre.legval(x, legs[j - 2])) / (2 * j - 1)
        for j, a in enumerate(scale, 2)
    ]
    slopes = [a * legendre.legval(x, legs[j - 1]) for j, a in enumerate(scale, 2)]
    shape = np.array([(1 - x) / 2, (1 + x) / 2, *bubbles])
    slope = np.array([np.full_like(x, -0.5), np.full_like(x, 0.5), *slopes])
    at = (position + (x + 1) / 2) / number
    return (slope * (weight * 2 / length * rigidity(at))) @ slope.T, (
        shape * (weight * length / 2 * heavy(at))
    ) @ shape.T


def line(parts: list[tuple], s) -> "mp.matrix":
    """Transfer matrix of (angle, torque towards the far end) along a line at s = w^2, in many digits.

    parts: ("shaft", length, G I, rho I), ("disc", J), ("spring", h); numbers as they stand, complex G I allowed.
    """
    whole = mp.eye(2)
    for kind, *values in parts:
        v = [mp.mpmathify(value) for value in values]
        if kind == "disc":
            step = mp.matrix([[1, 0], [s * v[0], 1]])
        elif kind == "spring":
            step = mp.matrix([[1, -v[0]], [0, 1]])
        else:
            k = mp.sqrt(s * v[2] / v[1])
            sine, cosine = mp.sin(k * v[0]), mp.cos(k * v[0])
            step = mp.matrix([[cosine, -sine / (k * v[1])], [k * v[1] * sine, cosine]])
        whole = step * whole
    return whole


def root_near(function: Callable, w: float):
    """The root of `function` next to w, in many digits, by the secant rule."""
    near = mp.mpf(float(w))
    return mp.findroot(
        function, (near * (1 - mp.mpf("1e-9")), near * (1 + mp.mpf("1e-9"))), tol=1e-60
    )


def sign_changes(function: Callable, highest: float, steps: int) -> int:
    """Of a function of w on a grid over 0..highest."""
    values = [
        mp.sign(function(mp.mpf(highest) * (k + mp.mpf("0.5")) / steps)) for k in range(steps)
    ]
    return sum(a != b for a, b in pairwise(values))


def off(found, exact) -> float:
    """Largest relative difference of floats from mpf."""
    return max(float(abs(mp.mpf(float(a)) / b - 1)) for a, b in zip(found, exact, strict=True))
