"""The states of the train that a file has in its cases, of those that rules demand, each with its component.

They are found in the cases as they are read, against the normal one: a misfire of an engine, another stiffness of a
coupling, a load at zero pitch.
"""

from collections.abc import Callable, Iterator
from dataclasses import replace
from fractions import Fraction
from functools import partial
from typing import Any

import numpy as np

from torsion import units
from torsion.errors import InputError, Refusal
from torsion.model.parts import Part
from torsion.schema.variants.overlay import Overlay, stiffness_paths
from torsion.study import MOST_AT_ZERO_PITCH, CaseStates, Study
from torsion.user_files import Source

ROUNDING = 1e-9  # relative: ends of a tolerance that are written in digits
POINTS = 65  # speeds at which loads are compared
Read = Callable[[Source], Study]


def with_states(study: Study, states: tuple[CaseStates, ...]) -> Study:
    """Return the study, and each variant of it, with the states of the file."""
    variations: dict[str, Any] = dict(study.variations)
    for name, variation in variations.items():
        base = replace(variation.base, case_states=states)
        read = partial(read_with_states, variation.read, states)
        variations[name] = replace(variation, base=base, read=read)
    return replace(study, case_states=states, variations=variations)


def read_with_states(read: Read, states: tuple[CaseStates, ...], source: Source) -> Study:
    """Return what is read, with the states of the file that it is a variant of."""
    return replace(read(source), case_states=states)


def states_of_cases(study: Study, source: Source) -> tuple[CaseStates, ...]:
    """Return the states of the normal case and of each case that counts for the verdict."""
    return tuple(
        CaseStates(
            frozenset(_states_of(case, study, source)), tuple(name for name, _ in case.rules)
        )
        for case in (study, *study.cases.values())
        if case.case is None or case.case.is_judged
    )


def _states_of(case: Study, study: Study, source: Source) -> Iterator[tuple[str, str]]:
    """Yield each state of a case with its component: of engines, of the load, and of figures against the normal case."""
    yield from (("misfire", name) for name in case.engines_with("motored"))
    if not case.engines_with("motored", "cut out"):
        yield "normal firing", ""
    if case.case is None:
        return
    if _is_at_zero_pitch(case, study):
        yield "zero pitch", ""
    for number, part in enumerate(case.train.parts):
        position = study.train.positions[part.name]
        normal, figures = study.train.parts[position], list[tuple[str, float, list[float]]]()
        if part.kind == "coupling":
            ratios = _stiffness_ratios(part, case.case.source, normal, Overlay(source, study))
            figures.append(("stiffness", normal.stiffness_tolerance, ratios))
        if tolerance := normal.inertia_tolerance:
            pairs = zip(
                (lump.inertia for lump in case.train.inertias if lump.part == number),
                (lump.inertia for lump in study.train.inertias if lump.part == position),
                strict=False,
            )
            ratios = [after / before for after, before in pairs if before]
            figures.append(("inertia", tolerance, ratios))
        for what, tolerance, ratios in figures:
            if any(abs(ratio - 1.0) > ROUNDING for ratio in ratios):
                yield f"other {what}", part.name
                if max(ratios) <= 1.0 - tolerance + ROUNDING:
                    yield f"lower {what}", part.name
                if min(ratios) >= 1.0 + tolerance - ROUNDING:
                    yield f"upper {what}", part.name


def _stiffness_ratios(part: Part, changed: Source, normal: Part, file: Overlay) -> list[float]:
    """Return each stiffness of a coupling in a case / that of the file; empty where they are not written alike."""
    ratios = []
    for path in stiffness_paths(file, normal):
        nodes = changed.at((*part.path, *path[len(normal.path) :])), file.source.at(path)
        texts = [str(None if node is None else node.value) for node in nodes]
        try:
            (after, unit), (before, unit_before) = map(units.amount, texts)
            if unit != unit_before:
                after, before = (Fraction(units.to_si(text, "N*m/rad")) for text in texts)
        except Refusal:
            return []
        if not (after and before):
            return []
        ratios.append(float(before / after if path[-1] == "flexibility" else after / before))
    return ratios


def _is_at_zero_pitch(case: Study, study: Study) -> bool:
    """Return whether the case has a table of the load that is a small share of the normal load at each of their speeds."""
    ranges, normal = [each.operation.speeds for each in (case, study)], study.operation.load
    if not case.operation.load.table or case.operation.load == normal or None in ranges:
        return False
    from torsion.analyses.power_balance import power_balance

    speeds = [speeds for speeds in ranges if speeds is not None]
    first, last = max(speeds.first for speeds in speeds), min(speeds.last for speeds in speeds)
    speed = np.linspace(first, last, POINTS)
    try:
        load, normal_load = (
            sum(load.torque_at(speed) for load in power_balance(each.train, each.operation).loads)
            for each in (case, study)
        )
    except InputError:
        return False
    return first <= last and bool(np.all(np.abs(load) <= MOST_AT_ZERO_PITCH * normal_load))
