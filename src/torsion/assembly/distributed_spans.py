"""The spans of a system with distributed inertia, and the laws by which the kernels take them."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from torsion.arrays import BoolArray, FloatArray, IntArray
from torsion.assembly.pieces import Piece
from torsion.assembly.segments import is_uniform

if TYPE_CHECKING:
    from torsion.kernels.distributed.span_laws import Law, Shafts


@dataclass(frozen=True)
class BarSpans:
    """The spans with distributed inertia, of the models `fem` and `exact`; pieces of uniform shafts come first.

    Such a span has two torques. The one reported is that at its driving station; the one at the driven end of the whole
    shaft is that of the massless rigid span `<shaft>, driven end`.
    """

    span: IntArray  # (spans,) position of the span
    lumped: FloatArray  # (stations,) kg m2 at own speed, without their inertia
    ends: IntArray  # (spans, 2) stations at which half the inertia of each is reported: driving and driven
    pieces: tuple[Piece, ...]  # (spans,)
    degree: int = 0  # of the finite elements; 0 for the exact model
    error: float = 0.0  # estimated, relative, of a shaft's highest frequency requested

    def laws(self, node: IntArray, ratio: FloatArray, turned: BoolArray) -> "Shafts":
        """The spans as the kernels take them: referred to one speed, in the order of `span`.

        (spans,) each: node of the tree at its end toward the leaves, speed ratio, whether its driven end is the other.
        """
        from torsion.kernels.distributed.span_laws import Shafts

        ratio2, laws = ratio**2, list["Law"]()
        if self.degree:
            from torsion.assembly.element_matrices import element_law

            return Shafts(node, (element_law(self.pieces, self.degree, ratio2),)).turned(turned)
        from torsion.kernels.distributed.continuous_shafts import (
            profile_points,
            profile_shafts,
            uniform_shafts,
        )

        uniform = sum(is_uniform(piece.bar) for piece in self.pieces)
        length = np.array([piece.length for piece in self.pieces])
        if uniform:
            along = self._along(slice(uniform), np.zeros(1), ratio2)[..., 0]
            laws.append(uniform_shafts(length[:uniform], *along))
        if uniform < len(self.pieces):
            rigidity, inertia = self._along(slice(uniform, None), profile_points(), ratio2)
            laws.append(profile_shafts(length[uniform:], 1.0 / rigidity, inertia))
        return Shafts(node, tuple(laws)).turned(turned)

    def _along(self, which: slice, points: FloatArray, ratio2: FloatArray) -> FloatArray:
        """G I in N m2 and rho I in kg m, (2, pieces, points), referred to one speed, at points `at` of every piece."""
        pieces = self.pieces[which]
        across = (
            np.array([piece.polar_area_moment(points) for piece in pieces]) * ratio2[which, None]
        )
        material = np.array([(piece.bar.shear_modulus, piece.bar.density) for piece in pieces])
        return material.T[..., None] * across
