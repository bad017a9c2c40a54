"""The steps between the shafts of a train, as springs that every model takes."""

import math
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import get_args

from torsion.assembly.junction.hubs import with_hubs, with_remark
from torsion.assembly.junction.profile import (
    Corner,
    CornerKind,
    Length,
    Profile,
    junction,
    mirrored,
)
from torsion.errors import Fault, InputError, SolveError
from torsion.kernels.junction_table import junction_table
from torsion.kernels.round_sections import polar_area_moment
from torsion.model.shafts.shaft_details import Step
from torsion.primitives import STEP, Bar, Inertia, Spring, Station, StepForm
from torsion.train import ENDS, Train

# Excess length / smaller diameter over larger / smaller diameter, from memory (Wilson; Ker Wilson), to be verified.
HANDBOOK = ((1.0, 0.0), (1.25, 0.055), (1.5, 0.085), (2.0, 0.100), (3.0, 0.107), (math.inf, 0.125))
SHORT = 2.0  # diameters; beyond it the stress at one end of a shaft between two larger ones knows nothing of the other
MOST = 0.5  # of its twist that large fillets may take from a shaft


@dataclass(frozen=True, order=True)
class End:
    """The end of a shaft at a step; the smaller outer diameter comes first."""

    outer: float  # m
    bore: float = field(compare=False)  # m
    bar: Bar = field(compare=False)


def with_steps(train: Train) -> Train:
    """The train with a spring at every step that twists, by its own words; raises InputError with every fault."""
    faults = list[Fault]()
    result = stepped(train, train.steps, faults)
    if faults:
        raise InputError(faults)
    return result


def stepped(train: Train, form: object, faults: list[Fault], *, by_table: bool = False) -> Train:
    """The train with a spring at every step that twists; form: of the steps that say none, faulty or not.

    A spring stands between the end of a shaft and a new station, at which the next shaft begins. A large fillet twists
    less than the shaft whose end it fills: then the shear modulus of that shaft is raised in place of a spring, as it
    is of a shaft in a hub. Steps
    that a train with `steps` None states are in it already. by_table: no finite elements run; steps that need them
    are left out, and said to be.
    """
    result, considered, shorter = train, set[int](), dict[str, float]()
    taken = {
        bar.name: sum(hub.length for hub in record.hubs)
        for bar in train.bars
        if (record := train.parts[bar.part].shaft) is not None
    }
    for before, after in _adjoining(train):
        record, path = train.shaft(before), (*train.parts[before.part].path, "step")
        considered.add(before.part)
        if train.steps is None and record.step is not None:
            continue
        step = record.step or Step(
            form=next((name for name in get_args(StepForm) if name == form), "none")
        )
        if step.form == "none":
            continue
        ends = _end(train, before, 1), _end(train, after, 0)
        smaller, larger = sorted(ends)
        # A step that cannot be computed is a fault where the shaft states it; where it follows from a setting of the
        # whole train, the shaft has a remark that its twist is left out.
        fault, excess, source = _fault(step, ends, path, taken), 0.0, ""
        if fault is None:
            try:
                excess, source = excess_length(step, smaller, larger, by_table=by_table)
            except SolveError as error:
                hint = "other dimensions, or `step: none`, which leaves its twist out"
                fault = Fault(path, str(error), hint)
        if fault or not source:
            is_apart = max(smaller.bore, larger.bore) >= smaller.outer
            if fault and (record.step is not None or is_apart):
                faults.append(fault)
            if not _is_smooth(before, after):
                why = fault.message if fault else "the table has no such step"
                result = with_remark(
                    result, before.part, f"its step to '{after.name}' is omitted: {why}"
                )
            continue
        remark = f"its step to '{after.name}' ({step.words}) twists as {1e3 * excess:.4g} mm of '{smaller.bar.name}'"
        result = with_remark(result, before.part, f"{remark} beyond both shafts, {source}")
        saved = shorter.get(smaller.bar.name, 0.0) - excess
        result = _with_inertias(result, step, before.driven, smaller, larger)
        # Negative: a large fillet is stiffer than the shaft it fills.
        if excess > 0.0:
            result = _with_spring(result, before, after, smaller, excess)
        elif saved <= MOST * smaller.bar.length:
            shorter[smaller.bar.name] = saved
        else:
            message = f"the fillets of '{smaller.bar.name}' take more than half of its twist"
            faults.append(
                Fault(path, message, "give the stiffness of both as a `coupling` in its place")
            )
    # Both ends of a shaft and its hubs stiffen it together.
    if train.steps is not None and train.has_hubs:
        result, shorter = with_hubs(result, shorter, faults)
    bars = [
        replace(
            bar, shear_modulus=bar.shear_modulus / (1.0 - shorter.get(bar.name, 0.0) / bar.length)
        )
        for bar in result.bars
    ]
    result = replace(result, bars=tuple(bars), steps=None)
    hint = "a step joins two shafts of the train, one right after the other, with nothing at the point between"
    faults += [
        Fault((*part.path, "step"), f"no shaft follows '{part.name}' directly", hint)
        for number, part in (() if train.steps is None else train.of_kind("shaft"))
        if part.shaft is not None and part.shaft.step is not None and number not in considered
    ]
    return result


def _end(train: Train, bar: Bar, end: int) -> End:
    """One end of a shaft, of its material's modulus: what hubs and fillets take from its twist is not there."""
    if bar.section is None:
        bar = replace(bar, shear_modulus=train.materials[train.shaft(bar).material].shear_modulus)
    return End(bar.outer[end], bar.bore[end], bar)


def has_unstated(train: Train) -> bool:
    """Shafts of unlike diameter or bore meet, and neither says anything of their step."""
    return any(
        train.shaft(before).step is None and not _is_smooth(before, after)
        for before, after in _adjoining(train)
    )


def _is_smooth(before: Bar, after: Bar) -> bool:
    return before.section is after.section and (before.outer[1], before.bore[1]) == (
        after.outer[0],
        after.bore[0],
    )


def _adjoining(train: Train) -> Iterator[tuple[Bar, Bar]]:
    """Every two shafts, the second of which begins where the first ends, with nothing else there."""
    touching = Counter(
        getattr(primitive, end)
        for kind in (
            train.inertias,
            train.springs,
            train.bars,
            train.constraints,
            train.dampers,
            train.torques,
        )
        for primitive in kind
        for end in ENDS
        if hasattr(primitive, end)
    )
    ends = {bar.driven: bar for bar in train.bars}
    for bar in train.bars:
        before = ends.get(bar.driving)
        if before is None or train.stations[bar.driving].part != before.part:
            continue
        if touching[bar.driving] == 2 and all(
            train.parts[shaft.part].shaft is not None for shaft in (before, bar)
        ):
            yield before, bar


def _fault(
    step: Step, ends: tuple[End, End], path: tuple[str | int, ...], taken: dict[str, float]
) -> Fault | None:
    """taken: m of each shaft under the corners and hubs so far."""
    (first, second), (smaller, larger) = ends, sorted(ends)
    bore = max(first.bore, second.bore)
    names = f"'{first.bar.name}' and '{second.bar.name}'"
    if any(end.bar.section is not None for end in ends):
        return Fault(
            path, f"one of {names} has a `section` by mesh", "a step lies between two round shafts"
        )
    if bore >= smaller.outer:
        return Fault(
            path,
            f"{names} do not touch",
            "the bore of one is not smaller than the diameter of the other",
        )
    face = larger.outer
    if step.flange is not None:
        face = step.flange.diameter
        if face <= larger.outer:
            return Fault(
                (*path, "flange"),
                f"the flange is not larger than {names}",
                "`diameter` is its outer one",
            )
    elif first.outer == second.outer:
        return Fault(
            path, f"{names} have the same diameter", "leave `step` out, or give a `flange`"
        )
    height, reach = (face - smaller.outer) / 2.0, 0.0
    if step.undercut is not None:
        floor, reach = smaller.outer - 2.0 * step.undercut.depth, step.undercut.width
        if floor <= bore:
            return Fault(
                (*path, "undercut"),
                "the undercut is deeper than the wall of the shaft",
                "a smaller `depth`",
            )
        if step.round >= min(reach, height + step.undercut.depth):
            return Fault(
                (*path, "undercut"),
                "its fillet does not fit into the undercut",
                "a smaller `fillet`",
            )
    elif step.size:
        kind: CornerKind = "fillet" if step.round else "chamfer"
        reach = Corner(kind, step.size).legs(height)[0]
    name = smaller.bar.name
    if reach >= smaller.bar.length:
        return Fault(
            path, f"the corner reaches beyond '{name}'", "a fillet is shorter than its shaft"
        )
    taken[name] = taken.get(name, 0.0) + reach
    if reach and taken[name] > smaller.bar.length:
        hint = "the corners at both of its ends, and its hubs, together have room in its length"
        return Fault(path, f"the corner reaches into another detail of '{name}'", hint)
    return None


def excess_length(
    step: Step, smaller: End, larger: End, *, by_table: bool = False
) -> tuple[float, str]:
    """m of the smaller shaft, whose twist the step has beyond both shafts; and where that is from, in words.

    by_table: without words where the table has no such step, in place of finite elements.
    """
    unit = smaller.outer
    if step.form == "handbook":
        return unit * handbook(larger.outer / unit), (
            "by a handbook's table, not checked against the edition in force, to be verified"
        )
    # The table has plain fillets between shafts of one bore and one material.
    is_plain = step.chamfer is None and step.undercut is None and step.flange is None
    if (
        is_plain
        and smaller.bore == larger.bore
        and smaller.bar.shear_modulus == larger.bar.shear_modulus
    ):
        height = (larger.outer - unit) / 2.0
        tabled = junction_table().excess_length(
            smaller.bore / unit, height / unit, step.size / unit
        )
        if tabled is not None:
            return (
                unit * tabled,
                f"from the table of finite elements, within {junction_table().error:.1g} diameters",
            )
    if by_table:
        return 0.0, ""
    from torsion.assembly.junction.axisymmetric import solved

    solution = solved(profile_of(step, smaller, larger))
    pieces = _between(step, smaller)
    area = float(polar_area_moment(smaller.outer, smaller.bore))
    beyond = sum(
        piece.length * area / float(polar_area_moment(piece.outer[0], piece.bore[0]))
        for piece in pieces
    )
    inside = step.undercut.width if step.undercut is not None else 0.0
    excess = unit * solution.excess_length + beyond - inside
    return excess, f"by finite elements, within {solution.error:.1g} diameters"


def _between(step: Step, smaller: End, unit: float = 1.0) -> tuple[Length, ...]:
    """What stands between the shafts of a step, in m over a unit."""
    if step.undercut is not None:
        size, length = smaller.outer - 2.0 * step.undercut.depth, step.undercut.width
    elif step.flange is not None:
        size, length = step.flange.diameter, step.flange.thickness
    else:
        return ()
    bore = smaller.bore / unit
    return (Length(length / unit, (size / unit, size / unit), (bore, bore)),)


def profile_of(step: Step, smaller: End, larger: End) -> Profile:
    """The outline of a step, in units of its smaller diameter."""
    unit = smaller.outer
    corner = (
        Corner("chamfer" if step.chamfer else "fillet", step.size / unit) if step.size else None
    )
    sizes = [(end.outer / unit, end.bore / unit) for end in (smaller, larger)]
    moduli = 1.0, larger.bar.shear_modulus / smaller.bar.shear_modulus
    between = _between(step, smaller, unit)
    return junction(sizes[0], sizes[1], corner, moduli=moduli, between=between)


def stressed_profile(train: Train, step: Step, smaller: End, larger: End) -> tuple[Profile, float]:
    """That of `profile_of`, and where on its axis the fillet lies behind.

    Both steps of a short shaft between two larger ones are in it, as they share their field.
    """
    profile, bar = profile_of(step, smaller, larger), smaller.bar
    opposite = next(
        (
            (stated or Step(form="sharp"), low, high)
            for stated, before, after, low, high in corners(train)
            if low.bar.name == bar.name
            and larger.bar.name not in (before.name, after.name)
            and high.outer > low.outer
        ),
        None,
    )
    if (
        opposite is None
        or len({*bar.outer}) > 1
        or len({*bar.bore}) > 1
        or bar.length >= SHORT * smaller.outer
    ):
        return profile, 0.0
    behind = mirrored(profile_of(*opposite))
    grooves = sum(
        detail.undercut.width for detail in (step, opposite[0]) if detail.undercut is not None
    )
    between = replace(profile.lengths[0], length=(bar.length - grooves) / smaller.outer)
    both_steps = Profile(
        (*behind.lengths[:-1], between, *profile.lengths[1:]), (*behind.corners, *profile.corners)
    )
    return both_steps, behind.places[-2] + between.length / 2.0


def corners(train: Train) -> Iterator[tuple[Step | None, Bar, Bar, End, End]]:
    """Where shafts meet in a train whose steps are springs: what is stated, both shafts, smaller and larger end."""
    starts = {bar.driving: bar for bar in train.bars}
    behind = {
        spring.driving: spring.driven for spring in train.springs if spring.name.endswith(STEP)
    }
    for before in train.bars:
        after = starts.get(behind.get(before.driven, before.driven))
        if after is not None and all(
            train.parts[bar.part].shaft is not None for bar in (before, after)
        ):
            ends = _end(train, before, 1), _end(train, after, 0)
            smaller, larger = sorted(ends)
            yield train.shaft(before).step, before, after, smaller, larger


def unrounded(train: Train) -> Iterator[tuple[Bar, Bar, str]]:
    """Both shafts at every corner of no stated radius, and what it is: also beside a fillet, and in the bore."""
    wide = {inertia.station for inertia in train.inertias}
    for step, before, after, smaller, larger in corners(train):
        if step is not None and (step.round or not _is_smooth(before, after)):
            if not step.round:
                yield (
                    before,
                    after,
                    "sharp step" if step.form == "sharp" else "step" if step.form else step.words,
                )
            elif not step.fillet:
                yield before, after, f"other corner of the {step.words}"
            if step.round and smaller.bore != larger.bore:
                yield before, after, f"corner in the bore, at the {step.words},"
        elif step is None and before.driven not in wide and not _is_smooth(before, after):
            yield before, after, "step"


def handbook(larger: float) -> float:
    """Excess length / smaller diameter by the handbook's table, straight over smaller / larger diameter.

    >>> handbook(2.0), round(handbook(1e9), 6)
    (0.1, 0.125)
    """
    for (begin, low), (end, high) in pairwise(HANDBOOK):
        if begin <= larger <= end:
            return low + (high - low) * (1.0 / begin - 1.0 / larger) / (1.0 / begin - 1.0 / end)
    raise ValueError("the larger diameter is the smaller one")


def _with_inertias(train: Train, step: Step, station: int, smaller: End, larger: End) -> Train:
    """The train with the inertia of what fills the corner of a step, and of its flange."""
    density, part, inertias = smaller.bar.density, smaller.bar.part, list[Inertia]()
    if step.size and step.undercut is None:
        kind: CornerKind = "fillet" if step.round else "chamfer"
        face = larger.outer if step.flange is None else step.flange.diameter
        moment = Corner(kind, step.size).polar_moment(
            smaller.outer / 2.0, (face - smaller.outer) / 2.0
        )
        inertias.append(Inertia(station, density * moment, part, kind))
    if step.flange is not None:
        area = float(polar_area_moment(step.flange.diameter, smaller.bore))
        inertias.append(Inertia(station, density * area * step.flange.thickness, part, "flange"))
    return replace(train, inertias=(*train.inertias, *inertias))


def _with_spring(
    train: Train, before_step: Bar, after_step: Bar, smaller: End, excess: float
) -> Train:
    """The train with a spring between two of its shafts; excess: m of the smaller shaft."""
    area = float(polar_area_moment(smaller.outer, smaller.bore))
    flexibility = excess / smaller.bar.shear_modulus / area
    before, new = train.stations[before_step.driven], len(train.stations)
    spring = Spring(
        f"{before_step.name}{STEP}",
        before_step.part,
        before_step.driven,
        new,
        flexibility,
        loss_factor=smaller.bar.loss_factor,
    )
    parts = list(train.parts)
    parts[after_step.part] = replace(
        parts[after_step.part], stations=(new, *parts[after_step.part].stations[1:])
    )
    return replace(
        train,
        springs=(*train.springs, spring),
        parts=tuple(parts),
        bars=tuple(
            replace(bar, driving=new) if bar.name == after_step.name else bar for bar in train.bars
        ),
        stations=(
            *train.stations,
            Station(f"{after_step.name} start", after_step.part, before.ratio, before.sense),
        ),
    )
