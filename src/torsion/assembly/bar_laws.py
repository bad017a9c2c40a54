"""The pieces of shafts on the tree, as the kernels take them: referred to one speed, from inner to outer end."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from torsion.arrays import BoolArray, FloatArray, IntArray
from torsion.assembly.shafts import is_uniform
from torsion.kernels.distributed.profiled_shaft import profile_points, profile_shafts
from torsion.kernels.distributed.span_laws import Law, Shafts
from torsion.kernels.distributed.uniform_shaft import uniform_shafts

if TYPE_CHECKING:
    from torsion.assembly.system import BarSpans, Piece


def folded_bars(bars: "BarSpans", node: IntArray, ratio: FloatArray, turned: BoolArray) -> Shafts:
    """The spans with distributed inertia of a system, in the order of its `bars`.

    (bars,) each: node of the tree at its outer end, speed ratio, and whether its driven end is the inner one.
    """
    if not bars.degree:
        return Shafts(node, _continua(bars, ratio**2)).turned(turned)
    from torsion.assembly.element_matrices import element_law

    return Shafts(node, (element_law(bars, ratio**2),)).turned(turned)


def _continua(bars: "BarSpans", ratio2: FloatArray) -> tuple[Law, ...]:
    """Uniform pieces, which come first, and conical ones."""
    uniform = [piece for piece in bars.pieces if is_uniform(piece.bar)]
    conical = bars.pieces[len(uniform) :]
    first, rest = ratio2[: len(uniform)], ratio2[len(uniform) :]
    laws: list[Law] = []
    if uniform:
        laws.append(uniform_shafts(_lengths(uniform), *_along(uniform, np.zeros(1), first)[..., 0]))
    if conical:
        rigidity, inertia = _along(conical, profile_points(), rest)
        laws.append(profile_shafts(_lengths(conical), 1.0 / rigidity, inertia))
    return tuple(laws)


def _lengths(pieces: Sequence["Piece"]) -> FloatArray:
    return np.array([piece.length for piece in pieces])


def _along(pieces: Sequence["Piece"], at: FloatArray, ratio2: FloatArray) -> FloatArray:
    """G I in N m2 and rho I in kg m, (2, pieces, points), referred to one speed, at points `at` of every piece."""
    across = np.array([piece.polar_area_moment(at) for piece in pieces]) * ratio2[:, None]
    modulus = np.array([piece.bar.shear_modulus for piece in pieces])[:, None]
    density = np.array([piece.bar.density for piece in pieces])[:, None]
    return np.stack([modulus * across, density * across])
