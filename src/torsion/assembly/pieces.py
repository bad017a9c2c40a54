"""What the models `fem` and `exact` divide a shaft into."""

from dataclasses import dataclass

from torsion.arrays import FloatArray
from torsion.assembly.segments import area_along
from torsion.primitives import Bar


@dataclass(frozen=True)
class Piece:
    """A part of a shaft with distributed inertia: the one of the given position among so many of equal length."""

    bar: Bar
    position: int
    number: int

    @property
    def length(self) -> float:
        return self.bar.length / self.number

    def polar_area_moment(self, x: FloatArray) -> FloatArray:
        """Return I_p in m4 at `x`, from 0 at the driving to 1 at the driven end of the piece."""
        return area_along(self.bar, (self.position + x) / self.number)
