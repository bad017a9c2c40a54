"""The elastic elements of a train as people name them, each with the spans that it was divided into."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import groupby

import numpy as np

from torsion.arrays import FloatArray, IntArray
from torsion.assembly.system import System
from torsion.primitives import STEP


@dataclass(frozen=True)
class Element:
    """A coupling, shaft, gear mesh, joint or other link, with the spans that it was divided into."""

    name: str
    kind: str  # the component's keyword
    part: int
    spans: Sequence[int]
    ratio: float  # speed at which its torque is stated / reference speed

    def largest(self, values: FloatArray) -> FloatArray:
        """Return the largest over the element's spans of values (..., spans)."""
        return np.asarray(values[..., list(self.spans)].max(axis=-1))


def elements(system: System) -> tuple[Element, ...]:
    """Return every element in the order of the train, all sections of a shaft as one with the steps between them."""
    whole = list[Element]()
    for name, sections in groupby(
        pieces(system), key=lambda piece: system.train.parts[piece.part].whole
    ):
        first, *further = sections
        if name == system.train.parts[first.part].name:
            whole += (first, *further)
        else:
            spans = (span for section in (first, *further) for span in section.spans)
            whole.append(replace(first, name=name, spans=tuple(spans)))
    return tuple(whole)


def pieces(system: System) -> list[Element]:
    """Return the same with sections and steps each by itself; points that are rigidly joined have none between them."""
    bars = {bar.part: bar.name for bar in system.train.bars}
    spans_by_element: dict[tuple[int, str], list[int]] = {}
    for index, span in enumerate(system.own_spans):
        is_point = system.train.parts[span.part].is_point
        if (
            not is_point or system.flexibility[index] != 0
        ):  # a spring of a shaft is that of its step
            name = (
                span.name if index < len(system.train.springs) else bars.get(span.part, span.name)
            )
            spans_by_element.setdefault((span.part, name), []).append(index)
    named: list[tuple[int, str, Sequence[int]]] = [
        (part, name, tuple(spans)) for (part, name), spans in spans_by_element.items()
    ]
    first = len(system.own_spans)
    for row in system.rows:
        named.append((row.bar.part, row.bar.name, range(first, first + row.number)))
        first += row.number
    made = [
        Element(
            name, system.train.parts[part].kind, part, spans, float(system.span_ratio[spans[0]])
        )
        for part, name, spans in named
    ]
    return sorted(made, key=lambda one: (one.part, one.name.endswith(STEP), one.spans[0]))


def spans_by_name(system: System) -> dict[str, list[int]]:
    """Return the spans of every component by its name, and every segment by its own."""
    spans: dict[str, list[int]] = {}
    for position, span in enumerate(system.spans):
        part = system.train.parts[span.part]
        for name in {part.whole, part.name, span.name}:
            spans.setdefault(name, []).append(position)
    return spans


def by_part(part: IntArray) -> dict[int, IntArray]:
    """Return positions of the stations or spans (any,) of every component, ascending.

    >>> by_part(np.array([2, 0, 2]))
    {0: array([1]), 2: array([0, 2])}
    """
    order = np.argsort(part, kind="stable")
    parts, first = np.unique(part[order], return_index=True)
    return dict(zip(parts.tolist(), np.split(order, first[1:]), strict=True)) if part.size else {}


def damps(system: System, element: Element) -> bool:
    """Return whether its internal damping takes energy out of a vibration."""
    first = element.spans[0]
    if first in system.tables:
        return system.tables[first].damps
    return bool(system.loss_factor[first] > 0 or system.viscous[first] > 0)
