"""The cases of a file: each an overlay of the same file, read, validated and planned as a file of its own."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, fields, is_dataclass, replace
from fractions import Fraction
from typing import Annotated, Any

import numpy as np
from pydantic import BaseModel

from torsion.errors import Fault, InputError, Path, Refusal, nearest
from torsion.fields import Declared, OneOrMany, Quantity, given, shown
from torsion.findings import NORMAL
from torsion.model.parts import CouplingRatings, GearRating
from torsion.schema.declaration_reader import declared
from torsion.schema.fault_text import input_error
from torsion.schema.variants.case_states import states_of_cases, with_states
from torsion.schema.variants.overlay import (
    Overlay,
    in_words,
    multiplied,
    remove_components,
    stiffness_paths,
)
from torsion.study import (
    Case,
    Change,
    SpeedRange,
    Study,
    case_folder,
)
from torsion.user_files import Node, Source, printable

FROM, TOLERANCES = "from", "tolerances"
CORNERS = {"soft": -1, "stiff": 1}  # cases of the tolerances: all couplings together at one end
Read = Callable[[Source], Study]
Factor = Annotated[float, Quantity("1", above=0, usual="factor of a case")]


class CaseKeys(Declared):
    """What one case changes of the file."""

    set: dict[str, Any] = given(
        "values in place of the file's, by `component.key`, or `section.key`", {}
    )
    scale: dict[str, Factor] = given("factors of the file's numbers, by the same words: 115 %", {})
    remove: Annotated[tuple[str, ...], OneOrMany] = given(
        "components that are taken away, or keys", ()
    )
    based_on: str | None = given("another case, whose changes are made first")
    rules: Any = given("the rules of this case, in place of the file's")
    speeds: SpeedRange | None = given("the speed range of this case, in place of the file's")
    judged: bool = given(
        "false: for information, no part of the verdict and of the exit status", True
    )


@dataclass(frozen=True)
class _Requested:
    """A case as the file states it; `corner` is that of the tolerances, 0 of a case with keys."""

    name: str
    path: Path
    keys: CaseKeys
    corner: int = 0


def with_cases(source: Source, read: Read, name: str = "") -> Study:
    """Return the study of a file, with that of every case; raises InputError with the faults of all of them.

    name: of the case that is meant alone, where the file was read before and now has other values.
    """
    faults: list[Fault] = []
    requested = list(_requested(source, faults))
    if name:
        bases = {case.name: case.keys.based_on for case in requested}
        requested = [case for case in requested if case.name in (name, bases[name])]
    try:
        study = read(source)
    except InputError as error:
        if not faults:
            raise
        raise input_error([*error.faults, *faults], source) from None
    studies: dict[str, Study | None] = {}
    for case in sorted(requested, key=lambda case: case.keys.based_on is not None):
        base = study if case.keys.based_on is None else studies.get(case.keys.based_on)
        # A case is left out if the case that it is based on is at fault.
        studies[case.name] = base and _case(case, base, study, source, read, faults)
    # Several cases may have a fault at one place: the first stands.
    kept: dict[Any, Fault] = {}
    for fault in faults:
        is_placed = fault.line is not None
        words = fault.message.partition(": ")[2] if is_placed else fault.message
        place = fault.line, fault.column, words, () if is_placed else fault.path
        kept.setdefault(place, fault)
    if kept:
        raise input_error(list(kept.values()), source)
    cases = {case.name: case_study for case in requested if (case_study := studies[case.name])}
    if name or not cases:
        return replace(study, cases=cases) if cases else study
    states = states_of_cases(replace(study, cases=cases), source)
    cases = {name: with_states(case, states) for name, case in cases.items()}
    return replace(with_states(study, states), cases=cases)


def in_case(name: str, faults: Iterable[Fault]) -> list[Fault]:
    """Return the faults, each with the case that has it."""
    return [replace(fault, message=f"case '{name}': {fault.message}") for fault in faults]


def _requested(source: Source, faults: list[Fault]) -> Iterator[_Requested]:
    """Yield the cases that the file states soundly; the faults of the others are noted."""
    body = source.data.get("cases") if isinstance(source.data, dict) else None
    if body is None:
        return
    if not isinstance(body, dict) or not body:
        example = "for example `{warm: {set: {coupling-1.stiffness: 150 kN*m/rad}}}`"
        faults.append(Fault(("cases",), f"{shown(body)} is not a mapping of cases", example))
        return
    corners = CORNERS if body.get(FROM) == TOLERANCES else {}
    names = [name for name in body if name != FROM] + list(corners)
    for name, keys in body.items():
        path = ("cases", name)
        if name == FROM:
            if keys != TOLERANCES:
                message = f"{in_words(keys)} is none of '{TOLERANCES}'"
                hint = "`from: tolerances` makes the cases soft and stiff"
                faults.append(Fault(path, message, hint))
            for corner_name, corner in corners.items():
                yield _Requested(corner_name, path, CaseKeys(), corner)
        elif why := _why_not(name, corners, names):
            faults.append(Fault(path, why, "give another name", at_key=True))
        else:
            before = len(faults)
            case = declared(CaseKeys, {} if keys is None else keys, path, faults)
            if case is not None:
                faults += _faults_of(name, case, body, names, path)
                if len(faults) == before:
                    yield _Requested(name, path, case)


def _why_not(name: str, corners: Iterable[str], names: list[str]) -> str:
    """Return why a case cannot have a name; empty where it can."""
    if not name.strip():
        return "a case needs a name"
    if name == NORMAL:
        return f"'{NORMAL}' is the name of the nominal case"
    if name in corners:
        return f"'{name}' is a case of `from: tolerances`"
    folder = case_folder(name).casefold()
    like = next(like for like in (NORMAL, *names) if case_folder(like).casefold() == folder)
    return "" if like == name else f"'{name}' and '{like}' would have one folder, `{folder}`"


def _faults_of(
    name: str, keys: CaseKeys, body: dict[str, Any], names: list[str], path: Path
) -> Iterator[Fault]:
    """Yield the faults of a case by itself: that it changes nothing, and those of the case that it is based on."""
    if not (keys.set or keys.scale or keys.remove or keys.rules is not None or keys.speeds):
        hint = "`set`, `scale`, `remove`, `speeds` or `rules`; the case without changes is called normal"
        yield Fault(path, f"the case '{name}' changes nothing", hint, at_key=True)
    base, fault_path = keys.based_on, (*path, "based_on")
    if base is None:
        return
    base_keys = body.get(base)
    if base not in names:
        near = nearest(base, names)
        hint = f"cases: {', '.join(names)}"
        if base == NORMAL:
            hint = "leave it out: every case is based on it"
        elif near and near != name:
            hint = f"did you mean '{near}'?"
        yield Fault(fault_path, f"no case is called '{printable(base)}'", hint)
    elif base == name:
        yield Fault(fault_path, "a case is not based on itself", "leave it out")
    elif isinstance(base_keys, dict) and base_keys.get("based_on") is not None:
        message = f"'{base}' is itself based on '{base_keys['based_on']}'"
        yield Fault(fault_path, message, "one level: repeat its changes here")


def _case(
    case: _Requested, base: Study, study: Study, source: Source, read: Read, faults: list[Fault]
) -> Study | None:
    """Return the study of a case; None with its faults noted."""
    overlay = Overlay(base.case.source if base.case else source, base)
    if case.corner:
        _tolerances(case, overlay)
    else:
        change_overlay(case.keys, case.path, source.at(case.path) or Node({}, 1, 1), overlay)
    overlay.removed["analyses", "fit"] = None  # what was measured is of the file as it stands
    if not overlay.faults:
        changed = overlay.applied()
        try:
            changed_study = read(changed)
        except InputError as error:
            overlay.faults += error.faults
        else:
            if not _is_same(_effect(changed_study), _effect(base)):
                changes = (*(base.case.changes if base.case else ()), *overlay.changes)
                is_corner = bool(case.corner or (base.case and base.case.is_corner))
                merged, is_judged = merge_changes(changes), case.keys.judged
                record = Case(case.name, merged, is_judged, is_corner, changed)
                return replace(changed_study, name=f"{study.name}, case {case.name}", case=record)
            message = "it changes no result that is requested"
            hint = "names, notes, sources and figures that nothing reads have no effect"
            overlay.faults.append(Fault(case.path, message, hint, at_key=True))
    faults += in_case(case.name, input_error(overlay.faults, source).faults)
    return None


def merge_changes(changes: Iterable[Change]) -> tuple[Change, ...]:
    """Return the changes, those of one thing as one."""
    merged: dict[str, Change] = {}
    for change in changes:
        merged[change.what] = replace(change, before=merged.get(change.what, change).before)
    return tuple(merged.values())


def change_overlay(keys: CaseKeys, path: Path, case_node: Node, overlay: Overlay) -> None:
    """Put everything into the overlay that the keys of a case state; `case_node` is their node, at `path`."""
    for key in ("set", "scale"):
        body = case_node.parts.get(key) or Node({}, 1, 1)
        for words, node in body.parts.items():
            name = str(words)
            factor = Fraction(repr(keys.scale[name])) if key == "scale" else None
            with overlay.noting((*path, key, words)):
                if factor == 1 and not overlay.permits_no_change:
                    message = f"{in_words(node.value)} of `{words}`: nothing changes"
                    raise Refusal(message, "a factor other than 1")
                overlay.change(name, node, factor)
    if keys.speeds is not None:
        with overlay.noting((*path, "speeds")):
            overlay.change("operation.speeds", case_node.parts["speeds"])
    if keys.rules is not None:
        stated, rules = overlay.source.at(("rules",)), case_node.parts["rules"]
        if stated is not None and stated.value == rules.value:
            message = "these are the rules of the file: nothing changes"
            fault = Fault((*path, "rules"), message, "leave it out", at_key=True)
            overlay.faults.append(fault)
        else:
            before = "none" if stated is None else in_words(stated.value)
            overlay.changes.append(Change("rules", before, in_words(rules.value)))
            overlay.put(("rules",), rules)
            # Without rules there is no limit that a design could keep; that of the file has this case among others.
            if not rules.value:
                overlay.removed["analyses", "design"] = None
    remove_components(overlay, keys.remove, (*path, "remove"))


def _tolerances(case: _Requested, overlay: Overlay) -> None:
    """Set all couplings with a tolerance together to one end of it."""
    node = overlay.source.at(case.path) or Node(None, 1, 1)
    varied = [part for part in overlay.study.train.parts if part.stiffness_tolerance]
    if not varied:
        hint = "give a coupling its `tolerance`, or leave `from` out"
        overlay.faults.append(Fault(case.path, "no coupling of the file has a tolerance", hint))
    for part in varied:
        tolerance = Fraction(repr(part.stiffness_tolerance))
        factor = 1 + case.corner * tolerance
        if factor <= 0:
            percent = f"{float(100 * tolerance):g} %"
            message = f"a tolerance of {percent} leaves '{part.name}' no stiffness"
            overlay.faults.append(Fault((*part.path, "tolerance"), message, "less than 100 %"))
            continue
        for path in stiffness_paths(overlay, part):
            stated = overlay.source.at(path)
            ratio = 1 / factor if path[-1] == "flexibility" else factor
            value = None if stated is None else multiplied(stated.value, ratio)
            if stated is not None and value is not None and value != stated.value:
                steps = path[len(part.path) :]
                keys = (str(step + 1) if isinstance(step, int) else step for step in steps)
                words = ".".join((part.name, *keys))
                overlay.changes.append(Change(words, in_words(stated.value), in_words(value)))
                overlay.put(path, Node(value, node.line, node.column))


def _effect(study: Study) -> Any:
    """Return everything of a study that a result can follow from: without names, notes and sources, and places of the file.

    Ratings have an effect where a rule or a motion over time reads them.
    """
    train = study.train
    plain = dict[str, Any](name="", note=None, source=None, is_named=False, path=())
    has_effect = study.rules or "transient" in study.analyses
    ratings = () if has_effect else (CouplingRatings, GearRating)
    parts = [replace(part.without(*ratings), **plain) for part in train.parts]
    torques = [replace(torque, path=(), source=None) for torque in train.torques]
    links = train.stations, train.inertias, train.springs, train.bars, train.constraints
    analyses = {name: settings for name, settings in study.analyses.items() if name != "fit"}
    settings = (study.operation, study.model, study.fem, analyses, study.rules, train.modal_damping)
    return settings, parts, torques, links, train.dampers, dict(train.materials)


def _is_same(first: Any, second: Any) -> bool:
    """Return whether two values are the same in all that they hold, arrays in every digit."""
    if first is second:
        return True
    if type(first) is not type(second):
        return False
    if isinstance(first, np.ndarray):
        kinds = [(array.dtype, array.shape) for array in (first, second)]
        return kinds[0] == kinds[1] and first.tobytes() == second.tobytes()
    if is_dataclass(first) and not isinstance(first, type):
        names = [field.name for field in fields(first) if field.repr]
        return all(_is_same(getattr(first, name), getattr(second, name)) for name in names)
    if isinstance(first, BaseModel):
        return _is_same(dict(first), dict(second))
    if isinstance(first, Mapping):
        return _is_same(tuple(first.items()), tuple(second.items()))
    if isinstance(first, tuple | list):
        return len(first) == len(second) and all(map(_is_same, first, second))
    return repr(first) == repr(second)
