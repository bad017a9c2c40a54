"""Where a polynomial falls below zero first, between 0 and 1; what is below zero by rounding is at zero.

A polynomial is the list of its coefficients, of ascending powers. An interval is halved until it is known to have no
root, or until the slope or the curvature has one sign in it; bounds are those of c0 + s (c1 + s (...)) from inside.

>>> first_root([1.0, -4.0, 0.0], 1e-15)
0.25
>>> first_root([0.25, -1.0, 1.0], 1e-15), first_root([0.1875, -1.0, 1.0], 1e-15)  # touches zero; passes it twice
(None, 0.25)
"""

import math
from operator import mul, neg

Polynomial = list[float]
SMALLEST = 0.5**40  # of an interval: what is narrower is a point
SOON = 0.125  # a function that is still below zero there was so from the begin
NOWHERE = math.inf
NEWTON = 100  # steps at most, which halve the interval at the worst


def first_root(polynomial: Polynomial, rounding: float) -> float | None:
    """The first point at which it falls below zero; 0 where it does so at once, or is below and stays."""
    if polynomial[0] < -rounding and value(polynomial, SOON) < -rounding:
        return 0.0
    # Begin, length, the polynomial in shares of it; the first interval stands last.
    waiting = [(0.0, 1.0, polynomial)]
    while waiting:
        begin, length, piece = waiting.pop()
        if _lower_bound(piece) >= -rounding:
            continue
        share = _fall(piece, rounding)
        if share is None and length > SMALLEST:
            left = [math.ldexp(coefficient, -power) for power, coefficient in enumerate(piece)]
            half = length / 2.0
            waiting += [(begin + half, half, _shifted(left)), (begin, half, left)]
        elif share is not None and share < NOWHERE:
            return begin + length * share
    return None


def value(polynomial: Polynomial, share: float) -> float:
    """Return the value at a share, by Horner's scheme."""
    total = 0.0
    for coefficient in reversed(polynomial):
        total = total * share + coefficient
    return total


def _fall(piece: Polynomial, rounding: float) -> float | None:
    """Where it falls below zero, between 0 and 1; None where neither its slope nor its curvature has one sign."""
    slope = _derivative(piece)
    begin, end, top, bottom = 0.0, 1.0, piece[0], sum(piece)
    if _upper_bound(slope) > 0.0:  # not falling all the way
        bend, first, last = _derivative(slope), slope[0], sum(slope)
        is_valley, is_hill = _lower_bound(bend) > 0.0, _upper_bound(bend) < 0.0
        if _lower_bound(slope) >= 0.0 or (is_valley and first >= 0.0) or (is_hill and last >= 0.0):
            return NOWHERE
        if not (is_valley or is_hill):
            return None
        if is_valley and last > 0.0:  # it falls before its deepest point
            end = _between(slope, (0.0, first), (1.0, last))
            bottom = value(piece, end)
        if is_hill and first > 0.0:  # it falls behind its top
            begin = _between(slope, (0.0, first), (1.0, last))
            top = value(piece, begin)
    if bottom >= -rounding:
        return NOWHERE
    return begin if top <= 0.0 else _between(piece, (begin, top), (end, bottom))


def _between(
    polynomial: Polynomial, left: tuple[float, float], right: tuple[float, float]
) -> float:
    """The root between two points (share, value) of unlike sign, by Newton's steps that stay between them."""
    (low, first), (high, last) = left, right
    share, falls, coefficients = (
        low + (high - low) * first / (first - last),
        first > 0.0,
        polynomial[::-1],
    )
    for _ in range(NEWTON):
        total = slope = 0.0
        for coefficient in coefficients:
            slope = slope * share + total
            total = total * share + coefficient
        if not total:
            break
        low, high = (share, high) if (total > 0.0) == falls else (low, share)
        following = share - total / slope if slope else low
        if not low < following < high:
            following = (low + high) / 2.0
        if abs(following - share) <= math.ulp(share):
            break
        share = following
    return share


def _derivative(polynomial: Polynomial) -> Polynomial:
    return list(map(mul, polynomial[1:], range(1, len(polynomial))))


def _shifted(polynomial: Polynomial) -> Polynomial:
    """In s - 1 in place of s."""
    shifted = polynomial.copy()
    for first in range(len(shifted) - 1):
        for power in range(len(shifted) - 2, first - 1, -1):
            shifted[power] += shifted[power + 1]
    return shifted


def _lower_bound(polynomial: Polynomial) -> float:
    """No more than its least value between 0 and 1."""
    bound = 0.0
    for coefficient in reversed(polynomial):
        bound = coefficient + bound if bound < 0.0 else coefficient
    return bound


def _upper_bound(polynomial: Polynomial) -> float:
    return -_lower_bound(list(map(neg, polynomial)))
