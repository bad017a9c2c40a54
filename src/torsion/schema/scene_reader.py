"""The file of a shaft train as a study; every fault of the file at once, each with its line and column.

The kind of every entry of a train is decided first; the entry is then read in the words of that kind.
"""

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path as FilePath
from typing import Any

from torsion.analyses import ANALYSES, VARYING
from torsion.errors import Fault, InputError, Path
from torsion.fields import Declared, exclusive, given, required, shown
from torsion.model import KINDS
from torsion.model.component import STEEL, Material
from torsion.model.machine_torques import Excitation
from torsion.primitives import SectionMesh, StepForm
from torsion.rules import RULES
from torsion.rules import settings as rule_settings
from torsion.schema.declaration_reader import (
    components,
    declared,
    empty_lists,
    entries_of,
    of_its_number,
    one_component,
    unknown_word,
)
from torsion.schema.fault_text import input_error
from torsion.schema.study_faults import study_faults
from torsion.schema.yaml_source import parse_source, read_source
from torsion.study import (
    FiniteElements,
    FrontMatter,
    ModalDamping,
    Operation,
    Several,
    ShaftModel,
    Study,
)
from torsion.train import Link, lowered, name_fault, taken
from torsion.user_files import Source

LINKS = ("coupling", "shaft")  # kinds that can close a loop
EXAMPLES = {  # of the sections that are mappings of names, and of those that are lists
    "materials": (dict, "`my-steel: {shear_modulus: 79.3 GPa, ...}`"),
    "links": (list, "`- {between: [a, b], coupling: {stiffness: 2e4}}`"),
    "excitations": (list, "`- {at: motor-1, order: 2, torque: 100 N*m}`"),
    "analyses": (dict, "`modes: {count: 6}`"),
    "rules": (list, "`rules: [iacs-m68]`"),
}


class Scene(Declared):
    """The top level of the file; its sections are read one by one."""

    name: str = required("title of the scene")
    description: str = given("free text", "")
    document: Any = given("the front matter of a submission: what cover and running head say")
    materials: Any = given("materials by name; `steel` exists")
    operation: Any = given("speeds, rated point and law of load")
    damping: Any = given("damping by mode, in place of the damping of the components: {modal: 2 %}")
    train: Any = required("the components from one end to the other")
    steps: StepForm = given(
        "twist of corners between shafts that say no `step`: sharp, handbook or none", "none"
    )
    links: Any = given("links that close loops between named points")
    excitations: Any = given("torques beyond those that components bring")
    analyses: Any = given("what is computed (default: modes, and response when something excites)")
    rules: Any = given("the rules that are checked")
    cases: Any = given("variants of this file, solved in addition to it")


class LinkKeys(Declared):
    """An entry of `links`: two points, and what joins them."""

    clashes = (exclusive(*LINKS, hint="`{between: [a, b], coupling: {...}}`", needed=True),)

    between: tuple[str, str] = required("names of the two points that the link joins")
    coupling: Any = given("a coupling that closes the loop")
    shaft: Any = given("a shaft that closes the loop")


def read(path: str | FilePath) -> Study:
    """The study that a file describes; raises InputError with every fault in it."""
    return _read_with_cases(read_source(path))


def parse(text: str, name: str = "train.yaml") -> Study:
    """The study that a text describes; `name` is the file name in messages. Raises InputError."""
    return _read_with_cases(parse_source(text, name))


def located(error: InputError, study: Study) -> InputError:
    """The same faults with the places in the study's file and the lines quoted; for what is found after reading."""
    if not study.text or all(fault.line for fault in error.faults):
        return error
    source, _ = reread(study)
    if study.case is None:
        return input_error(error.faults, source)
    from torsion.schema.variants.cases import in_case

    return input_error(in_case(study.case.name, input_error(error.faults, source).faults), source)


def reread(study: Study) -> tuple[Source, Callable[[Source], Study]]:
    """The file of a study as it was read, of a case with its values, and what reads one with other values."""
    case, read = None if study.case is None else study.case.source, _study
    if study.case_states:
        from torsion.schema.variants.case_states import read_with_states

        read = partial(read_with_states, _study, study.case_states)
    return case or _with_tables(parse_source(study.text, study.file), dict(study.tables)), read


def _with_tables(source: Source, tables: dict[str, str] | None = None) -> Source:
    """The source with the rows of the tables that it names, from their files or as they were read before."""
    if not any(
        word in source.text for word in ("table", "size", "torsiogram", "catalogue", "sections")
    ):
        return source
    from torsion.schema.scene_tables import with_tables

    return with_tables(source, tables)


def _read_with_cases(source: Source) -> Study:
    """The study of a file with its tables, and of its cases where it states any."""
    source = _with_tables(source)
    source = replace(source, faults=(*source.faults, *empty_lists(source.data)))
    if not isinstance(source.data, dict) or source.data.get("cases") is None:
        return _study(source)
    from torsion.schema.variants.cases import with_cases

    return with_cases(source, _study)


def _study(source: Source) -> Study:
    faults = list(source.faults)
    study = _sections(source, faults)
    if study is not None:
        study = _completed(study, source.data.get("steps", "none"), faults)
        faults += study_faults(study, _faulty(faults))
        if not faults and any(name in study.analyses for name in VARYING):
            from torsion.schema.variants.variation import with_variations

            study = with_variations(study, source, _study, declarations, faults)
    if faults or study is None:
        raise input_error(faults, source)
    if study.train.follows_speed:
        from torsion.analyses.modes.frequencies_by_torque import at_operating_point

        try:
            study = at_operating_point(study)
        except InputError as error:
            raise input_error(list(error.faults), source) from None
    return study


def _completed(study: Study, steps: Any, faults: list[Fault]) -> Study:
    """The study with its steps between shafts, and with the meshes and the logo from the folder of its file.

    What is faulty of them is noted.
    """
    folder, train = FilePath(study.file).parent, study.train
    is_sound = "train" not in _faulty(faults)
    if is_sound and train.has_meshed_sections:
        from torsion.assembly.section.solved_sections import mesh_faults

        bars = (
            replace(bar, section=replace(bar.section, file=str(folder / bar.section.file)))
            if isinstance(bar.section, SectionMesh)
            else bar
            for bar in train.bars
        )
        train = replace(train, bars=tuple(bars))
        faults += mesh_faults(train)
    if is_sound and replace(train, steps=steps or "none").has_steps:
        from torsion.assembly.junction.stepped_shafts import stepped

        train = stepped(train, steps, faults)
    study = replace(study, train=train)
    if study.document is not None and study.document.logo is not None:
        from torsion.schema.logo import read_logo

        try:
            study = replace(study, logo=read_logo(folder / study.document.logo))
        except InputError as error:
            faults += error.faults
    return study


def _faulty(faults: list[Fault]) -> set[str]:
    """The sections with faults; all of them where a key of the top level is unknown, which may be one misspelt."""
    first = {str(fault.path[0]) if fault.path else "" for fault in faults}
    return first if first <= Scene.model_fields.keys() else set(Scene.model_fields)


def _sections(source: Source, faults: list[Fault]) -> Study | None:
    """The study, where its train can be looked at; its faulty sections are left empty."""
    data = source.data
    top: list[Fault] = []
    scene = declared(Scene, _shallow(data, ("name", "description", "steps")), (), top)
    for fault in top:
        kind = fault.path[0] if fault.path else ""
        hint = f"a component is an entry of `train`, with a dash: `- {kind}: ...`"
        faults.append(replace(fault, hint=hint) if kind in KINDS else fault)
    if not isinstance(data, dict):
        return None
    operation = declared(Operation, data.get("operation"), ("operation",), faults)
    analyses, rules = _analyses(data, faults), _rules(data, faults)
    stated = dict(entries_of(data.get("analyses")))
    named = {key: stated[key] for key in ShaftModel.model_fields if key in stated}
    if "fem" in named and named["fem"] is None:
        named["fem"] = {}
    model = declared(ShaftModel, named, ("analyses",), faults) or ShaftModel()
    damping, document = data.get("damping"), data.get("document")
    if damping is not None:
        damping = declared(ModalDamping, damping, ("damping",), faults)
    if document is not None:
        document = declared(FrontMatter, document, ("document",), faults)
    parts, reference = _declarations(data, faults), None if operation is None else operation.at
    if parts["components"] is None:
        faults += _name_faults(data, reference, parts["excitations"], parts["links"])
        return None
    folder = str(FilePath(source.name).parent)
    train, train_faults = lowered(**parts, reference=reference, folder=folder)
    faults += train_faults
    if train is None:
        return None
    if damping is not None:
        train = replace(train, modal_damping=damping.modal)
    return Study(
        name=getattr(scene, "name", ""),
        description=getattr(scene, "description", ""),
        train=train,
        operation=operation or Operation(),
        model=model.model,
        fem=model.fem or FiniteElements(),
        analyses=analyses,
        rules=tuple(rules),
        file=source.name,
        text=source.text,
        document=document,
        tables=tuple((name, table.text) for name, table in source.tables),
    )


def _shallow(data: object, read_here: Sequence[str]) -> object:
    """The keys of a mapping alone: `present` stands for what is read by itself."""
    if not isinstance(data, dict):
        return data
    return {
        key: value if key in read_here or value is None else "present"
        for key, value in data.items()
    }


def _entries(data: dict[str, Any], section: str, faults: list[Fault]) -> Iterator[tuple[Path, Any]]:
    """Place and content of every entry of a section; none where it is not the mapping or list that it must be."""
    body, (kind, example) = data.get(section), EXAMPLES[section]
    if body is not None and not isinstance(body, kind):
        what = "mapping" if kind is dict else "list"
        faults.append(Fault((section,), f"{shown(body)} is not a {what}", f"for example {example}"))
        return
    for step, entry in entries_of(body):
        yield (section, step), entry


def _analyses(data: dict[str, Any], faults: list[Fault]) -> dict[str, Declared]:
    """The settings of every analysis that is named; defaults where it is named without any."""
    read: dict[str, Declared] = {}
    for path, body in _entries(data, "analyses", faults):
        name = str(path[-1])
        if name in ShaftModel.model_fields:
            continue
        if name not in ANALYSES or not ANALYSES[name].settings:
            names = [key for key, analysis in ANALYSES.items() if analysis.settings]
            faults.append(unknown_word(path, "analysis", name, [*ShaftModel.model_fields, *names]))
            continue
        kind = ANALYSES[name].imported(ANALYSES[name].settings)
        if isinstance(body, list) and ANALYSES[name].is_listed:
            several = [declared(kind, entry, (*path, k), faults) for k, entry in enumerate(body)]
            read[name] = Several(each=tuple(filter(None, several)))
        elif (settings := declared(kind, body, path, faults)) is not None:
            read[name] = settings
    return read


def _rules(data: dict[str, Any], faults: list[Fault]) -> list[tuple[str, Declared]]:
    """The rules with their settings, in the order of the file."""
    read: list[tuple[str, Declared]] = []
    seen: set[str] = set()
    for entry_path, entry in _entries(data, "rules", faults):
        named = {entry: None} if isinstance(entry, str) else entry
        if not isinstance(named, dict) or len(named) != 1:
            hint = "`- iacs-m68`, or `- gear-hammer: {limit: 0.35}`"
            faults.append(Fault(entry_path, f"{shown(entry)} is not a rule", hint))
            continue
        ((name, body),) = named.items()
        path, names = (*entry_path, name), list(RULES)
        if name not in RULES:
            faults.append(unknown_word(path, "rule", name, of_its_number(name, names), names))
            continue
        if name in seen:
            message = f"the rule `{name}` is named twice"
            faults.append(Fault(path, message, "keep one of them", at_key=True))
        seen.add(name)
        if (settings := declared(rule_settings(name), body, path, faults)) is not None:
            read.append((name, settings))
    return read


def declarations(source: Source) -> dict[str, Any]:
    """Return what `lowered` takes of a file without faults: components, links, excitations and materials."""
    faults = list(source.faults)
    stated = _declarations(source.data, faults)
    if faults:
        raise input_error(faults, source)
    return stated


def _declarations(data: dict[str, Any], faults: list[Fault]) -> dict[str, Any]:
    """Return the same, None for each faulty link or excitation; of a train that is faulty or missing no components."""
    of_train, train = list[Fault](), data.get("train")
    parts = () if train is None else components(train, ("train",), of_train)
    faults += of_train
    links = list[Link | None]()
    for path, entry in _entries(data, "links", faults):
        # The component that closes the loop is read in the words of its kind.
        keys = declared(LinkKeys, _shallow(entry, ("between",)), path, faults)
        kinds = entry if isinstance(entry, dict) else {}
        kind = next((kind for kind in LINKS if kinds.get(kind) is not None), None)
        link = None if kind is None else one_component(kind, kinds[kind], (*path, kind), faults)
        links.append(Link(keys.between, link) if keys and link else None)
    return {
        "components": None if of_train or train is None else parts,
        "links": tuple(links),
        "excitations": tuple(
            declared(Excitation, body, path, faults)
            for path, body in _entries(data, "excitations", faults)
        ),
        # Steel stands in for a faulty material, so that the train can still be looked at.
        "materials": {
            str(path[-1]): declared(Material, body, path, faults) or STEEL
            for path, body in _entries(data, "materials", faults)
        },
    }


def _name_faults(
    data: dict[str, Any],
    reference: str | None,
    excitations: Sequence[Excitation | None],
    links: Sequence[Link | None],
) -> Iterator[Fault]:
    """Yield the faults of names given twice, or that no component can go by, of a train too faulty to be lowered."""
    paths: dict[str, Path] = {}
    for path, value in _values(data.get("train"), ("train",), "name"):
        if isinstance(value, str):
            if value in paths:
                yield taken(value, path[:-1], paths[value])
            paths.setdefault(value, path[:-1])
    # The names that components may go by, given or by kind and number; where a kind is unknown, so are the numbers.
    count, possible = Counter[str](), set(paths)
    for _, train in [((), data.get("train")), *_values(data.get("train"), (), "train")]:
        for entry in train if isinstance(train, list) else [None]:
            if not isinstance(entry, dict) or len(entry) != 1 or not entry.keys() <= KINDS.keys():
                return
            ((kind, body),) = entry.items()
            if not isinstance(body, dict | None):
                return
            count[kind] += 1
            possible.add(f"{kind}-{count[kind]}")
    named: list[tuple[str, Path]] = [
        (end, ("links", number, "between", side))
        for number, link in enumerate(links)
        for side, end in enumerate(link.between if link else ())
    ]
    named += [
        (excitation.at, ("excitations", number, "at"))
        for number, excitation in enumerate(excitations)
        if excitation is not None
    ]
    if reference is not None and not data.get("links"):  # a component of `links` may be meant
        named.append((reference, ("operation", "at")))
    components_by_name = dict.fromkeys(sorted(possible), ("component", True))
    for name, path in named:
        # A point within a component has the name of the component in front of its own.
        if not any(name.startswith(f"{owner} ") for owner in possible):
            fault = name_fault(name, path, components_by_name)
            if fault is not None:
                yield fault


def _values(body: object, path: Path, key: str) -> Iterator[tuple[Path, Any]]:
    """Yield what stands anywhere in a body at a key, with its path."""
    for step, item in entries_of(body):
        if step == key:
            yield (*path, step), item
        yield from _values(item, (*path, step), key)
