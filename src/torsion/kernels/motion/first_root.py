"""Where a polynomial falls below zero first, between 0 and 1; what is below zero by rounding is at zero.

A polynomial is the list of its coefficients, of ascending powers. An interval is halved until it is known to have no
root, or until the slope or the curvature has one sign in it; bounds are those of c0 + s (c1 + s (...)) from inside.

>>> first_root([1.0, -4.0, 0.0], 1e-15)
0.25
>>> first_root([0.25, -1.0, 1.0], 1e-15), first_root([0.1875, -1.0, 1.0], 1e-15)  # touches zero; passes it twice
(None, 0.25)
"""

import math
from operator import mul

Polynomial = list[float]
SMALLEST = 0.5**40  # of an interval: what is narrower is a point
SOON = 0.125  # a function that is still below zero there was so from the begin
NOWHERE = math.inf
NEWTON = 100  # steps at most, which halve the interval at the worst


def first_root(polynomial: Polynomial, rounding: float) -> float | None:
    """The first point at which it falls below zero; 0 where it does so at once, or is below and stays."""
    if polynomial[0] < -rounding and value(polynomial, SOON) < -rounding:
        return 0.0
    waiting = [
        (0.0, 1.0, polynomial)
    ]  # begin, length, the polynomial in shares of it; the first interval stands last
    while waiting:
        begin, length, here = waiting.pop()
        if _least(here) >= -rounding:
            continue
        found = _fall(here, rounding)
        if found is None and length > SMALLEST:
            left = [math.ldexp(coefficient, -power) for power, coefficient in enumerate(here)]
            waiting += [
                (begin + length / 2.0, length / 2.0, _shifted(left)),
                (begin, length / 2.0, left),
            ]
        elif found is not None and found < NOWHERE:
            return begin + length * found
    return None


def value(polynomial: Polynomial, at: float) -> float:
    """By Horner's scheme."""
    total = 0.0
    for coefficient in reversed(polynomial):
        total = total * at + coefficient
    return total


def _fall(here: Polynomial, rounding: float) -> float | None:
    """Where it falls below zero, between 0 and 1; None where neither its slope nor its curvature has one sign."""
    slope = _derivative(here)
    begin, end, top, bottom = 0.0, 1.0, here[0], sum(here)
    if _most(slope) > 0.0:  # not falling all the way
        bend, first, last = _derivative(slope), slope[0], sum(slope)
        if _least(slope) >= 0.0:
            return NOWHERE
        if _least(bend) > 0.0:  # a valley: it falls before its deepest point
            if first >= 0.0:
                return NOWHERE
            if last > 0.0:
                end = _between(slope, (0.0, first), (1.0, last))
                bottom = value(here, end)
        elif _most(bend) < 0.0:  # a hill: it falls behind its top
            if last >= 0.0:
                return NOWHERE
            if first > 0.0:
                begin = _between(slope, (0.0, first), (1.0, last))
                top = value(here, begin)
        else:
            return None
    if bottom >= -rounding:
        return NOWHERE
    return begin if top <= 0.0 else _between(here, (begin, top), (end, bottom))


def _between(
    polynomial: Polynomial, left: tuple[float, float], right: tuple[float, float]
) -> float:
    """The root between two points (place, value) of unlike sign, by Newton's steps that stay between them."""
    (low, first), (high, last) = left, right
    at, falls, coefficients = (
        low + (high - low) * first / (first - last),
        first > 0.0,
        polynomial[::-1],
    )
    for _ in range(NEWTON):
        total = slope = 0.0
        for coefficient in coefficients:
            slope = slope * at + total
            total = total * at + coefficient
        if not total:
            break
        low, high = (at, high) if (total > 0.0) == falls else (low, at)
        following = at - total / slope if slope else low
        if not low < following < high:
            following = (low + high) / 2.0
        if abs(following - at) <= math.ulp(at):
            break
        at = following
    return at


def _derivative(polynomial: Polynomial) -> Polynomial:
    return list(map(mul, polynomial[1:], range(1, len(polynomial))))


def _shifted(polynomial: Polynomial) -> Polynomial:
    """In s - 1 in place of s."""
    found = polynomial.copy()
    for first in range(len(found) - 1):
        for power in range(len(found) - 2, first - 1, -1):
            found[power] += found[power + 1]
    return found


def _least(polynomial: Polynomial) -> float:
    """No more than its least value between 0 and 1."""
    bound = 0.0
    for coefficient in reversed(polynomial):
        bound = coefficient + bound if bound < 0.0 else coefficient
    return bound


def _most(polynomial: Polynomial) -> float:
    """No less than its largest value between 0 and 1."""
    bound = 0.0
    for coefficient in reversed(polynomial):
        bound = coefficient + bound if bound > 0.0 else coefficient
    return bound
