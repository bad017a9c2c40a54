"""How much of its steady amplitude a mode reaches while the exciting frequency passes it at a constant rate.

With the exciting phase w t + a t**2/2 and x = t sqrt(a) the amplitude is that of A, A' + p A = exp(i x**2/2) to within
w/sqrt(a), p = zeta w/sqrt(a), from long before: |A| = sqrt(pi/2) |W(i (p/(2 b) - b x))|, b = exp(-i pi/4)/sqrt(2), with
W Faddeeva's function; the steady amplitude is 1/p.

>>> [round(share_of_steady(p), 3) for p in (0.08, 0.4, 1.58, 20.0)]
[0.204, 0.649, 0.964, 1.0]
"""

import cmath
import math

import numpy as np

from torsion.sources import source

LATEST = 4.0  # x by which every amplitude has been at its greatest: without damping at 2.16
GRID = 801  # points; the second search is between two of the first


@source("Lewis1932")
def share_of_steady(p: float) -> float:
    """The greatest amplitude over the steady one."""
    from scipy.special import wofz

    turn = cmath.exp(-0.25j * math.pi) / math.sqrt(2.0)
    low, high, best = 0.0, LATEST, 0.0
    for _ in range(2):
        x = np.linspace(low, high, GRID)
        size = p * math.sqrt(math.pi / 2.0) * np.abs(wofz(1j * (p / (2.0 * turn) - turn * x)))
        top = int(np.argmax(size))
        best = float(size[top])
        low, high = float(x[max(top - 1, 0)]), float(x[min(top + 1, GRID - 1)])
    return best
