"""The elastic elements of a train as people name them: all segments of a shaft are one element."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from torsion.arrays import FloatArray
from torsion.assembly.system import System


@dataclass(frozen=True)
class Element:
    """A coupling, shaft, gear mesh, joint or other link, with the spans that it was divided into."""

    name: str
    kind: str  # the component's keyword
    part: int
    spans: Sequence[int]
    ratio: float  # speed at which its torque is stated / reference speed

    def largest(self, values: FloatArray) -> FloatArray:
        """The largest over the element's spans of values (..., spans)."""
        return np.asarray(values[..., list(self.spans)].max(axis=-1))


def elements(system: System) -> tuple[Element, ...]:
    """Every element in the order of the train; points that are rigidly joined have none between them."""
    bars = {bar.part: bar.name for bar in system.train.bars}
    found: dict[tuple[int, str], list[int]] = {}
    for index, span in enumerate(system.own_spans):
        if not _joins_points_rigidly(system, index):
            found.setdefault((span.part, bars.get(span.part, span.name)), []).append(index)
    named: list[tuple[int, str, Sequence[int]]] = [(part, name, tuple(spans)) for (part, name), spans in found.items()]
    first = len(system.own_spans)
    for row in system.rows:
        named.append((row.bar.part, row.bar.name, range(first, first + row.number)))
        first += row.number
    made = [
        Element(name, system.train.parts[part].kind, part, spans, float(system.span_ratio[spans[0]]))
        for part, name, spans in named
    ]
    return tuple(sorted(made, key=lambda element: (element.part, element.spans[0])))


def _joins_points_rigidly(system: System, index: int) -> bool:
    span = system.spans[index]
    return system.train.parts[span.part].is_point and bool(system.flexibility[index] == 0)
