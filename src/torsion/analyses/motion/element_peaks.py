"""What a motion over time means for every elastic element: its maximum and minimum torque, stress and damage."""

from typing import Any

import numpy as np

from torsion.analyses.response.component_loads import NOTHING
from torsion.arrays import FloatArray
from torsion.assembly.elements import Element, elements
from torsion.assembly.system import System
from torsion.results import derived, reported, result

TransientMotion = Any  # analyses.motion.transient_motion, whose module imports this one


@reported
class ElementPeak:
    """Torques of one element, including the mean; 0 for what is rounding beside the largest torque of the train."""

    component: str = result("", "name of the element")
    maximum: float = result("N*m", "maximum torque")
    maximum_at: float = result("s", "when")
    minimum: float = result("N*m", "minimum torque")
    minimum_at: float = result("s", "when")
    before: float = result("N*m", "mean torque before the events")
    rated: float = result("N*m", "mean torque at the rated point; 0 if it is not known")
    reversals: int = result("", "sign changes of the torque")
    unresolved: float = result("N*m", "what the samples do not resolve may add so much")
    stress: float | None = result("Pa", "largest shear stress; null except for a shaft")
    damage: float | None = result("1", "Miner's sum; null if not requested")

    @derived("1", "largest magnitude / mean torque before the events; null without such a torque")
    def of_before(self) -> float | None:
        return self._share(self.before)

    @derived("1", "largest magnitude / mean torque at the rated point; null without such a torque")
    def of_rated(self) -> float | None:
        return self._share(self.rated)

    def _share(self, mean: float) -> float | None:
        return max(abs(self.maximum), abs(self.minimum)) / abs(mean) if mean else None


def element_peaks(motion: TransientMotion, system: System) -> tuple[ElementPeak, ...]:
    """Return the peaks of all elements in the order of the train."""
    nothing = NOTHING * motion.peak.max(initial=0.0)
    return tuple(_peak(motion, element, nothing) for element in elements(system))


def _peak(motion: TransientMotion, element: Element, nothing: float) -> ElementPeak:
    spans, first = list(element.spans), element.spans[0]
    high, low = spans[motion.greatest[spans].argmax()], spans[motion.least[spans].argmin()]

    def torque(values: FloatArray, span: int) -> float:
        return float(values[span]) if abs(values[span]) >= nothing else 0.0

    def largest(values: FloatArray | None) -> float | None:
        value = None if values is None else float(element.largest(values))
        return None if value is None or np.isnan(value) else value

    return ElementPeak(
        element.name,
        torque(motion.greatest, high),
        float(motion.greatest_at[high]),
        torque(motion.least, low),
        float(motion.least_at[low]),
        torque(motion.before, first),
        0.0 if motion.rated is None else float(motion.rated[first]),
        int(motion.reversals[spans].max()),
        float(element.largest(motion.unresolved)),
        largest(motion.stress),
        largest(motion.damage),
    )
