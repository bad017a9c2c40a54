"""The cases of a file: each an overlay of the same file, read, validated and planned as a file of its own."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, fields, is_dataclass, replace
from fractions import Fraction
from typing import Annotated, Any

import numpy as np
from pydantic import BaseModel

from torsion.errors import Fault, InputError, Path, nearest, printable
from torsion.fields import Declared, OneOrMany, Quantity, given, shown
from torsion.findings import NORMAL
from torsion.model.lowering import Part
from torsion.schema.declaration_reader import declared, entries_of
from torsion.schema.fault_text import Node, Source, input_error
from torsion.schema.overlay import Overlay, in_words, multiplied, node_at
from torsion.schema.removal import remove_components
from torsion.study import Case, Change, SpeedRange, Study, case_folder

FROM, TOLERANCES = "from", "tolerances"
CORNERS = {"soft": -1, "stiff": 1}  # cases of the tolerances: all couplings together at one end
STIFFNESSES = (  # of a coupling
    ("stiffness",),
    ("clearance", "stiffness"),
    ("prony", "stiffness"),
    ("fractional", "stiffness"),
    ("fractional", "k1"),
)
LISTED = (
    (("stages",), ("stiffness",)),
    (("table", "stiffness"), ()),
    (("prony", "terms"), (0,)),
)  # lists, and where
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


def with_cases(source: Source, read: Read) -> Study:
    """The study of a file, with that of every case; raises InputError with the faults of all of them."""
    faults: list[Fault] = []
    requested = list(_requested(source, faults))
    try:
        study = read(source)
    except InputError as error:
        if not faults:
            raise
        raise input_error([*error.faults, *faults], source) from None
    found: dict[str, Study | None] = {}
    for one in sorted(requested, key=lambda one: one.keys.based_on is not None):
        base = (
            study if one.keys.based_on is None else found.get(one.keys.based_on)
        )  # None of one that is at fault
        found[one.name] = None if base is None else _case(one, base, study, source, read, faults)
    if faults:
        raise input_error(_each_once(faults), source)
    made = {one.name: case for one in requested if (case := found[one.name]) is not None}
    return replace(study, cases=made) if made else study


def case_of(name: str, source: Source, read: Read) -> Study:
    """The study of one case of a file whose values are others than when it was read; raises InputError."""
    faults: list[Fault] = []
    requested = {one.name: one for one in _requested(source, faults)}
    own, study = requested[name], read(source)
    based_on = own.keys.based_on
    base = (
        study
        if based_on is None
        else _case(requested[based_on], study, study, source, read, faults)
    )
    found = None if base is None else _case(own, base, study, source, read, faults)
    if found is None:
        raise input_error(_each_once(faults), source)
    return found


def located_in_case(error: InputError, case: Case) -> InputError:
    """The same faults in the values of the file as the case changes them."""
    return input_error(
        in_case(case.name, input_error(error.faults, case.source).faults), case.source
    )


def in_case(name: str, faults: Iterable[Fault]) -> list[Fault]:
    """The faults, each with the case that has it."""
    return [replace(fault, message=f"case '{name}': {fault.message}") for fault in faults]


def _each_once(faults: list[Fault]) -> list[Fault]:
    """The faults without those that several cases have at one place, of which the first stands."""
    kept: dict[Any, Fault] = {}
    for fault in faults:
        words = fault.message.partition(": ")[2] if fault.line is not None else fault.message
        kept.setdefault(
            (fault.line, fault.column, words, fault.path if fault.line is None else ()), fault
        )
    return list(kept.values())


def _requested(source: Source, faults: list[Fault]) -> Iterator[_Requested]:
    """The cases that the file states soundly; the faults of the others are noted."""
    body = source.data.get("cases") if isinstance(source.data, dict) else None
    if body is None:
        return
    example = "for example `{warm: {set: {coupling-1.stiffness: 150 kN*m/rad}}}`"
    if not isinstance(body, dict) or not body:
        faults.append(Fault(("cases",), f"{shown(body)} is not a mapping of cases", example))
        return
    corners = CORNERS if body.get(FROM) == TOLERANCES else {}
    names = [name for name in body if name != FROM] + list(corners)
    for name, keys in body.items():
        path = ("cases", name)
        if name == FROM:
            if keys != TOLERANCES:
                message = f"{in_words(keys)} is none of '{TOLERANCES}'"
                faults.append(
                    Fault(path, message, "`from: tolerances` makes the cases soft and stiff")
                )
            yield from (
                _Requested(name, path, CaseKeys(), corner) for name, corner in corners.items()
            )
        elif why := _why_not(name, corners, names):
            faults.append(Fault(path, why, "give another name", at_key=True))
        else:
            before = len(faults)
            read = declared(CaseKeys, {} if keys is None else keys, path, faults)
            if read is not None:
                faults += _faults_of(name, read, body, names, path)
            if read is not None and len(faults) == before:
                yield _Requested(name, path, read)


def _why_not(name: str, corners: Iterable[str], names: list[str]) -> str:
    """Why a case cannot have a name; empty where it can."""
    if not name.strip():
        return "a case needs a name"
    if name == NORMAL:
        return f"'{NORMAL}' is the name of the nominal case"
    if name in corners:
        return f"'{name}' is a case of `from: tolerances`"
    folder = case_folder(name).casefold()
    like = next((one for one in (NORMAL, *names) if case_folder(one).casefold() == folder), name)
    return "" if like == name else f"'{name}' and '{like}' would have one folder, `{folder}`"


def _faults_of(
    name: str, keys: CaseKeys, body: dict[str, Any], names: list[str], path: Path
) -> Iterator[Fault]:
    """Faults of a case by itself: that it changes nothing, and those of the case that it is based on."""
    if not (keys.set or keys.scale or keys.remove or keys.rules is not None or keys.speeds):
        hint = "`set`, `scale`, `remove`, `speeds` or `rules`; the case without changes is called normal"
        yield Fault(path, f"the case '{name}' changes nothing", hint, at_key=True)
    base, place = keys.based_on, (*path, "based_on")
    if base is None:
        return
    if base not in names:
        near = nearest(base, names)
        hint = "leave it out: every case is based on it" if base == NORMAL else ""
        hint = hint or (
            f"did you mean '{near}'?" if near and near != name else f"cases: {', '.join(names)}"
        )
        yield Fault(place, f"no case is called '{printable(base)}'", hint)
        return
    other = body.get(base)
    if base == name:
        yield Fault(place, "a case is not based on itself", "leave it out")
    elif isinstance(other, dict) and other.get("based_on") is not None:
        yield Fault(
            place,
            f"'{base}' is itself based on '{other['based_on']}'",
            "one level: repeat its changes here",
        )


def _case(
    one: _Requested, base: Study, study: Study, source: Source, read: Read, faults: list[Fault]
) -> Study | None:
    """The study of a case; None with its faults noted."""
    before = source if base.case is None else base.case.source
    overlay = Overlay(before, base.train.parts, base.operation.at or base.train.parts[0].name)
    if one.corner:
        _tolerances(one, overlay)
    else:
        change_overlay(
            one.keys, one.path, node_at(source.root, one.path) or Node({}, 1, 1), overlay
        )
    overlay.remove(("analyses", "fit"))  # what was measured is of the file as it stands
    if not overlay.faults:
        changed = overlay.applied()
        try:
            found = read(changed)
        except InputError as error:
            overlay.faults += error.faults
        else:
            changes = merge_changes((*(base.case.changes if base.case else ()), *overlay.changes))
            is_corner = bool(one.corner) or (base.case is not None and base.case.is_corner)
            case = Case(one.name, changes, one.keys.judged, is_corner, changed)
            if _effect(found) != _effect(base):
                return replace(found, name=f"{study.name}, case {one.name}", case=case)
            hint = "names, notes, sources and figures that nothing reads have no effect"
            overlay.faults.append(
                Fault(one.path, "it changes no result that is requested", hint, at_key=True)
            )
    faults += in_case(one.name, input_error(overlay.faults, source).faults)
    return None


def merge_changes(changes: Iterable[Change]) -> tuple[Change, ...]:
    """The changes, those of one thing as one."""
    found: dict[str, Change] = {}
    for change in changes:
        found[change.what] = replace(change, before=found.get(change.what, change).before)
    return tuple(found.values())


def change_overlay(keys: CaseKeys, path: Path, own: Node, overlay: Overlay) -> None:
    """Put everything into the overlay that the keys of a case state; `own` is their node, at `path`."""
    for key in ("set", "scale"):
        body = own.parts.get(key)
        for words, node in body.parts.items() if body is not None else ():
            at, fault = (body or own).keys[str(words)], (*path, key, words)
            if key == "set":
                overlay.replace(str(words), node, at, fault)
            else:
                factor = Fraction(repr(keys.scale[str(words)]))
                if factor == 1 and not overlay.permits_no_change:
                    message = f"{in_words(node.value)} of `{words}`: nothing changes"
                    overlay.faults.append(
                        Fault(fault, message, "a factor other than 1", at_key=True)
                    )
                else:
                    overlay.multiply(str(words), factor, node, at, fault)
    if keys.speeds is not None:
        overlay.replace(
            "operation.speeds", own.parts["speeds"], own.keys["speeds"], (*path, "speeds")
        )
    if keys.rules is not None:
        _rules(overlay, own, (*path, "rules"))
    remove_components(overlay, keys.remove, (*path, "remove"))


def _rules(overlay: Overlay, own: Node, fault: Path) -> None:
    """The rules of a case in place of the file's."""
    there, value = node_at(overlay.source.root, ("rules",)), own.parts["rules"]
    if there is not None and there.value == value.value:
        overlay.faults.append(
            Fault(fault, "these are the rules of the file: nothing changes", "leave it out", True)
        )
        return
    before = "none" if there is None else in_words(there.value)
    overlay.changes.append(Change("rules", before, in_words(value.value)))
    overlay.put(("rules",), value, own.keys["rules"])
    if (
        not value.value
    ):  # no limit that a design could keep; that of the file has this case among others
        overlay.remove(("analyses", "design"))


def _tolerances(one: _Requested, overlay: Overlay) -> None:
    """All couplings with a tolerance together at one end of it."""
    at = node_at(overlay.source.root, one.path) or Node(None, 1, 1)
    varied = [part for part in overlay.parts if part.stiffness_tolerance]
    if not varied:
        hint = "give a coupling its `tolerance`, or leave `from` out"
        overlay.faults.append(Fault(one.path, "no coupling of the file has a tolerance", hint))
    for part in varied:
        tolerance = Fraction(repr(part.stiffness_tolerance))
        factor = 1 + one.corner * tolerance
        if factor <= 0:
            message = (
                f"a tolerance of {float(100 * tolerance):g} % leaves '{part.name}' no stiffness"
            )
            overlay.faults.append(Fault((*part.path, "tolerance"), message, "less than 100 %"))
            continue
        for path in stiffness_paths(overlay, part):
            node = node_at(overlay.source.root, path)
            by = 1 / factor if path[-1] == "flexibility" else factor
            made = None if node is None else multiplied(node.value, by)
            if node is not None and made is not None and made != node.value:
                words = ".".join(
                    [
                        part.name,
                        *(str(s + 1) if isinstance(s, int) else s for s in path[len(part.path) :]),
                    ]
                )
                overlay.changes.append(Change(words, in_words(node.value), in_words(made)))
                overlay.put(path, Node(made, at.line, at.column), (at.line, at.column))


def stiffness_paths(overlay: Overlay, part: Part) -> Iterator[Path]:
    """Where the file states the stiffnesses, or the flexibility, of a coupling."""
    for keys in (*STIFFNESSES, ("flexibility",)):
        if node_at(overlay.source.root, (*part.path, *keys)) is not None:
            yield (*part.path, *keys)
    for keys, own in LISTED:
        listed = node_at(overlay.source.root, (*part.path, *keys))
        for step, _ in entries_of(None if listed is None else listed.value):
            yield (*part.path, *keys, step, *own)


def _effect(study: Study) -> Any:
    """Everything of a study that a result can follow from: without names, notes and sources, and places of the file.

    Ratings have an effect where a rule or a motion over time reads them.
    """
    train = study.train
    plain: dict[str, Any] = {
        "name": "",
        "note": None,
        "source": None,
        "is_named": False,
        "path": (),
    }
    if not study.rules and "transient" not in study.analyses:
        plain |= {"ratings": None, "application_factor": None, "max_torque": None}
    parts = [replace(part, **plain) for part in train.parts]
    torques = [replace(torque, path=(), source=None) for torque in train.torques]
    rest = (
        train.stations,
        train.inertias,
        train.springs,
        train.bars,
        train.constraints,
        train.dampers,
    )
    analyses = {name: settings for name, settings in study.analyses.items() if name != "fit"}
    settings = (study.operation, study.model, study.fem, analyses, study.rules, train.modal_damping)
    return _content((parts, torques, rest, settings, dict(train.materials)))


def _content(value: Any) -> Any:
    """The same in tuples, bytes and words that compare; of an array every digit, where its own words leave some out."""
    if isinstance(value, np.ndarray):
        return value.dtype.str, value.shape, value.tobytes()
    if is_dataclass(value) and not isinstance(value, type):
        return type(value), *(
            _content(getattr(value, one.name)) for one in fields(value) if one.repr
        )
    if isinstance(value, BaseModel):
        return type(value), _content(dict(value))
    if isinstance(value, Mapping):
        return tuple((_content(key), _content(one)) for key, one in value.items())
    return tuple(map(_content, value)) if isinstance(value, tuple | list) else repr(value)
