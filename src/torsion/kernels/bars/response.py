"""What bars bring to the equations of a forced response, and the torques at their ends that follow from the answer."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from torsion.errors import SolveError
from torsion.kernels.bars.spans import Bars
from torsion.kernels.bars.tree import BarTree
from torsion.kernels.tree import ComplexArray, FloatArray, Tree


@dataclass(frozen=True)
class BarTerms:
    """Of every bar at some frequencies, (bars, frequencies), rad/(N m) and N m/rad; complex with a loss factor."""

    train: BarTree
    flexibility: NDArray[Any]
    inner: NDArray[Any]  # dynamic stiffness of the inner end inertia, -w^2 J
    outer: NDArray[Any]

    def compliance(self, given: NDArray[Any]) -> NDArray[Any]:
        """Of all spans (stations, frequencies); `given` is that of the plain ones, alike or (stations,)."""
        columns = self.flexibility.shape[1]
        kind = np.result_type(given, self.flexibility)
        rows = np.empty((self.train.tree.size, columns), dtype=kind)
        rows[:] = given[:, None] if given.ndim == 1 else given
        rows[self.train.bars.node] = self.flexibility
        return rows

    def loaded(self, own: NDArray[Any]) -> NDArray[Any]:
        """The dynamic stiffness of the stations (stations, frequencies) with the ends of the bars at them."""
        total = own.astype(np.result_type(own, self.inner), copy=False)
        self.train.add_ends(total, self.inner, self.outer)
        return total

    def to_ends(self, angle: ComplexArray, torque: ComplexArray, outer: ComplexArray) -> None:
        """Turn the torques in the flexibilities into those at the inner ends and write those at the `outer`, in place.

        All (stations, frequencies).
        """
        node = self.train.bars.node
        outer[:] = torque
        outer[node] -= self.outer * angle[node]
        torque[node] += self.inner * angle[self.train.parent]

    def from_inner(self, angle: ComplexArray, torque: ComplexArray) -> ComplexArray:
        """The torques in the flexibilities (stations, frequencies) from those at the inner ends."""
        between: ComplexArray = torque.copy()
        between[self.train.bars.node] -= self.inner * angle[self.train.parent]
        return between


@dataclass(frozen=True)
class BarsOfResponse:
    """The bars of a problem and the loss factor of each."""

    train: BarTree
    loss: FloatArray  # (bars,)

    @property
    def lossy(self) -> bool:
        """Whether any bar has a loss factor, so that all is complex."""
        return bool(self.loss.any())

    def at(self, w: FloatArray) -> BarTerms:
        """What the bars bring at `w` (frequencies,) rad/s."""
        square, bars = w * w, self.train.bars
        flexibility, inner, outer = bars.lossy(square, self.loss) if self.lossy else bars.at(square)
        return BarTerms(self.train, flexibility, inner * -square, outer * -square)


def bars_of_response(tree: Tree, bars: Bars, loss: FloatArray | None, w: FloatArray) -> BarsOfResponse:
    """The bars of a problem; `loss` (bars,), none if not given.

    Raises ValueError for a shape that does not fit, SolveError for a frequency at which the series of a profile end.
    """
    eta = np.zeros(bars.size) if loss is None else np.asarray(loss, dtype=np.float64)
    if eta.shape != (bars.size,):
        raise ValueError(f"bar_loss has shape {eta.shape}; expected {(bars.size,)}")
    highest = float(np.max(w, initial=0.0))
    if highest > bars.reach:
        raise SolveError(
            f"{highest:.6g} rad/s is above {bars.reach:.6g} rad/s, to which the pieces of the shafts are short enough"
            "; divide the shafts more finely"
        )
    return BarsOfResponse(BarTree(tree, bars), eta)
