"""Fixed points that nothing elastic keeps apart: their reactions are not determined, or a joint cannot turn."""

import math
from collections.abc import Iterator

from torsion.errors import Fault
from torsion.primitives import Constraint, Spring
from torsion.train import Train

Rigid = dict[int, list[tuple[int, Spring | Constraint]]]  # of each station: (the other one, the rigid span between)


def fixed_point_faults(train: Train) -> list[Fault]:
    """A fault for every fixed point that rigid spans alone join to an earlier one."""
    held = {lump.station for lump in train.inertias if math.isinf(lump.inertia)}
    if len(held) < 2:
        return []
    near: Rigid = {}
    spans: list[Spring | Constraint] = [*train.springs, *train.constraints]
    for span in spans:
        if span.flexibility == 0:
            near.setdefault(span.driving, []).append((span.driven, span))
            near.setdefault(span.driven, []).append((span.driving, span))
    return [fault for station in sorted(held) for fault in _fault(train, station, held, near)]


def _fault(train: Train, station: int, held: set[int], near: Rigid) -> Iterator[Fault]:
    """The fault of a fixed station, by the shortest rigid way to one before it."""
    way: dict[int, list[Spring | Constraint]] = {station: []}
    for here in (met := [station]):
        for other, span in near.get(here, []):
            if other not in way:
                way[other] = [*way[here], span]
                met.append(other)
    before = [other for other in met if other in held and other < station]
    if not before:
        return
    part, earlier = (train.parts[train.stations[one].part] for one in (station, before[0]))
    uneven = [span for span in way[before[0]] if isinstance(span, Constraint) and span.error]
    hint = "put a stiffness between them, or fix one of them only"
    if uneven:
        joint = train.parts[uneven[-1].part]
        ends = f"'{earlier.name}' and '{part.name}'"
        message = f"'{joint.name}' cannot turn: {ends} are fixed, with nothing elastic between"
        yield Fault(joint.path, message, hint)
    else:
        message = f"'{part.name}' is fixed, and rigid parts alone join it to '{earlier.name}', which is fixed too"
        yield Fault((*part.path, "held"), message, hint)
