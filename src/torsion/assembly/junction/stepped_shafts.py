"""The steps between the shafts of a train, as springs that every model takes."""

import math
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TYPE_CHECKING, get_args

from torsion.components.lowering import STEP, Step, StepForm
from torsion.errors import Fault, InputError
from torsion.kernels.junction_table import junction_table
from torsion.kernels.round_sections import polar_area_moment
from torsion.primitives import Bar, Spring, Station
from torsion.train import ENDS, Train

if TYPE_CHECKING:
    from torsion.assembly.junction.profile import Profile

# Excess length / smaller diameter over larger / smaller diameter, from memory (Wilson; Ker Wilson), to be verified.
HANDBOOK = ((1.0, 0.0), (1.25, 0.055), (1.5, 0.085), (2.0, 0.100), (3.0, 0.107), (math.inf, 0.125))
MOST = 0.5  # of its twist that large fillets may take from a shaft


@dataclass(frozen=True)
class End:
    """The end of a shaft at a step."""

    bar: Bar
    outer: float  # m
    bore: float  # m


def with_steps(train: Train) -> Train:
    """The train with a spring at every step that twists, by its own words; raises InputError with every fault."""
    faults = list[Fault]()
    found = stepped(train, train.steps, faults)
    if faults:
        raise InputError(faults)
    return found


def stepped(train: Train, form: object, faults: list[Fault], *, by_table: bool = False) -> Train:
    """The train with a spring at every step that twists; form: of the steps that say none, faulty or not.

    A spring stands between the end of a shaft and a new station, at which the next shaft begins. A large fillet twists
    less than the shaft whose end it fills: then the shear modulus of that shaft is raised in place of a spring. Steps
    that a train with `steps` None states are in it already. by_table: no finite elements run; steps that need them
    are left out, and said to be.
    """
    found, said, shorter = train, set[int](), dict[str, float]()
    for one, two in _adjoining(train):
        record, path = train.shaft(one), (*train.parts[one.part].path, "step")
        said.add(one.part)
        if train.steps is None and record.step is not None:
            continue
        step = record.step or Step(form=next((one for one in get_args(StepForm) if one == form), "none"))
        if step.form == "none":
            continue
        ends = End(one, one.outer[1], one.bore[1]), End(two, two.outer[0], two.bore[0])
        fault = _fault(step, ends, path)
        excess, source = (0.0, "") if fault else excess_length(step, *ends, by_table=by_table)
        if fault or not source:
            faults += [fault] if fault and record.step is not None else []
            if not _is_smooth(one, two):
                why = fault.message if fault else "the table has no such step"
                found = _remarked(found, one.part, f"its step to '{two.name}' is left out: {why}")
            continue
        smaller = min(ends, key=lambda end: end.outer)
        form_words = step.form or f"{'fillet' if step.fillet else 'chamfer'} of {1e3 * step.size:g} mm"
        remark = f"its step to '{two.name}' ({form_words}) twists as {1e3 * excess:.4g} mm of '{smaller.bar.name}'"
        found = _remarked(found, one.part, f"{remark} beyond both shafts, {source}")
        saved = shorter.get(smaller.bar.name, 0.0) - excess
        if excess > 0.0:
            found = _with_spring(found, one, two, smaller, excess)
        elif saved <= MOST * smaller.bar.length:
            shorter[smaller.bar.name] = saved
        else:
            message = f"the fillets of '{smaller.bar.name}' take more than half of its twist"
            faults.append(Fault(path, message, "give the stiffness of both as a `coupling` in its place"))
    bars = [
        replace(bar, shear_modulus=bar.shear_modulus / (1.0 - shorter.get(bar.name, 0.0) / bar.length))
        for bar in found.bars
    ]
    found = replace(found, bars=tuple(bars), steps=None)
    for number, part in () if train.steps is None else train.of_kind("shaft"):
        if part.shaft is not None and part.shaft.step is not None and number not in said:
            hint = "a step joins two shafts of the train, one right after the other, with nothing at the point between"
            faults.append(Fault((*part.path, "step"), f"no shaft follows '{part.name}' directly", hint))
    return found


def has_unstated(train: Train) -> bool:
    """Shafts of unlike diameter or bore meet, and neither says anything of their step."""
    return any(train.shaft(one).step is None and not _is_smooth(one, two) for one, two in _adjoining(train))


def _is_smooth(one: Bar, two: Bar) -> bool:
    return one.section is two.section and (one.outer[1], one.bore[1]) == (two.outer[0], two.bore[0])


def _adjoining(train: Train) -> Iterator[tuple[Bar, Bar]]:
    """Every two shafts, the second of which begins where the first ends, with nothing else there."""
    touching = Counter(
        getattr(one, end)
        for kind in (train.inertias, train.springs, train.bars, train.constraints, train.dampers, train.torques)
        for one in kind for end in ENDS if hasattr(one, end)
    )  # fmt: skip
    ends = {bar.driven: bar for bar in train.bars}
    for bar in train.bars:
        before = ends.get(bar.driving)
        if before is None or touching[bar.driving] != 2 or train.stations[bar.driving].part != before.part:
            continue
        if all(train.parts[one.part].shaft is not None for one in (before, bar)):
            yield before, bar


def _fault(step: Step, ends: tuple[End, End], path: tuple[str | int, ...]) -> Fault | None:
    one, two = ends
    names = f"'{one.bar.name}' and '{two.bar.name}'"
    if any(end.bar.section is not None for end in ends):
        return Fault(path, f"one of {names} has a `section` by mesh", "a step is that of two round shafts")
    if max(one.bore, two.bore) >= min(one.outer, two.outer):
        return Fault(path, f"{names} do not touch", "the bore of one is not smaller than the diameter of the other")
    if one.outer == two.outer:
        return Fault(path, f"{names} have the same diameter", "leave `step` out")
    smaller = min(ends, key=lambda end: end.outer)
    height = abs(one.outer - two.outer) / 2.0
    reach = math.sqrt(step.fillet * step.fillet - max(step.fillet - height, 0.0) ** 2) if step.fillet else step.size
    if reach >= smaller.bar.length:
        return Fault(path, f"the corner reaches beyond '{smaller.bar.name}'", "a fillet is shorter than its shaft")
    return None


def excess_length(step: Step, one: End, two: End, *, by_table: bool = False) -> tuple[float, str]:
    """m of the smaller shaft, whose twist the step has beyond both shafts; and where that is from, in words.

    by_table: without words where the table has no such step, in place of finite elements.
    """
    smaller, larger = sorted((one, two), key=lambda end: end.outer)
    unit = smaller.outer
    if step.form == "handbook":
        return unit * handbook(larger.outer / unit), "by a handbook's table, from memory, to be verified"
    if step.chamfer is None and one.bore == two.bore and one.bar.shear_modulus == two.bar.shear_modulus:
        height = (larger.outer - unit) / 2.0
        known = junction_table().excess_length(smaller.bore / unit, height / unit, step.size / unit)
        if known is not None:
            return unit * known, f"from the table of finite elements, within {junction_table().error:.1g} diameters"
    if by_table:
        return 0.0, ""
    from torsion.assembly.junction.axisymmetric import solved

    found = solved(profile_of(step, one, two))
    return unit * found.excess_length, f"by finite elements, within {found.error:.1g} diameters"


def profile_of(step: Step, one: End, two: End) -> "Profile":
    """The outline of a step, in units of its smaller diameter."""
    from torsion.assembly.junction.profile import Corner, junction

    smaller, larger = sorted((one, two), key=lambda end: end.outer)
    unit = smaller.outer
    corner = Corner("chamfer" if step.chamfer else "fillet", step.size / unit) if step.size else None
    sizes = [(end.outer / unit, end.bore / unit) for end in (smaller, larger)]
    return junction(sizes[0], sizes[1], corner, moduli=(1.0, larger.bar.shear_modulus / smaller.bar.shear_modulus))


def filleted(train: Train) -> Iterator[tuple[Step, Bar, Bar, End, End]]:
    """Every step with a fillet of a train whose steps are springs: both shafts, smaller and larger end."""
    starts = {bar.driving: bar for bar in train.bars}
    behind = {spring.driving: spring.driven for spring in train.springs if spring.name.endswith(STEP)}
    for one in train.bars:
        step = train.shaft(one).step if train.parts[one.part].shaft is not None else None
        two = starts.get(behind.get(one.driven, one.driven))
        if step is not None and step.fillet is not None and two is not None:
            ends = End(one, one.outer[1], one.bore[1]), End(two, two.outer[0], two.bore[0])
            smaller, larger = sorted(ends, key=lambda end: end.outer)
            yield step, one, two, smaller, larger


def handbook(larger: float) -> float:
    """Excess length / smaller diameter by the handbook's table, straight over smaller / larger diameter.

    >>> handbook(2.0), round(handbook(1e9), 6)
    (0.1, 0.125)
    """
    for (begin, low), (end, high) in pairwise(HANDBOOK):
        if begin <= larger <= end:
            return low + (high - low) * (1.0 / begin - 1.0 / larger) / (1.0 / begin - 1.0 / end)
    raise ValueError("the larger diameter is the smaller one")


def _remarked(train: Train, part: int, remark: str) -> Train:
    parts = list(train.parts)
    parts[part] = replace(parts[part], remark=remark)
    return replace(train, parts=tuple(parts))


def _with_spring(train: Train, one: Bar, two: Bar, smaller: End, excess: float) -> Train:
    """The train with a spring between two of its shafts; excess: m of the smaller shaft."""
    area = float(polar_area_moment(smaller.outer, smaller.bore))
    flexibility = excess / smaller.bar.shear_modulus / area
    before, new = train.stations[one.driven], len(train.stations)
    spring = Spring(
        f"{one.name}{STEP}", one.part, one.driven, new, flexibility, loss_factor=smaller.bar.loss_factor
    )  # fmt: skip
    parts = list(train.parts)
    parts[two.part] = replace(parts[two.part], stations=(new, *parts[two.part].stations[1:]))
    return replace(
        train, springs=(*train.springs, spring), parts=tuple(parts),
        bars=tuple(replace(bar, driving=new) if bar.name == two.name else bar for bar in train.bars),
        stations=(*train.stations, Station(f"{two.name} start", two.part, before.ratio, before.sense)),
    )  # fmt: skip
