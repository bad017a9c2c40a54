"""The file of a shaft train as a study; every fault of the file at once, each with its line and column."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path as FilePath
from typing import Any

from torsion.components.harmonic_torques import Excitation
from torsion.errors import Fault, InputError, Path
from torsion.fields import Declared, given, required
from torsion.primitives import SectionMesh
from torsion.schema import scene_sections as sections
from torsion.schema.declaration_reader import declared
from torsion.schema.fault_text import input_error
from torsion.schema.study_faults import study_faults
from torsion.schema.train_reader import components, kinds_by_name, repeated_names
from torsion.schema.yaml_source import Source, parse_source, read_source
from torsion.study import FiniteElements, Operation, Study
from torsion.train import Link, Train, lowered, name_fault


class Scene(Declared):
    """The top level of the file; its sections are read one by one."""

    name: str = required("title of the scene")
    description: str = given("free text", "")
    materials: Any = given("materials by name; `steel` exists")
    operation: Any = given("speeds, rated point and law of load")
    train: Any = required("the components from one end to the other")
    links: Any = given("links that close loops between named points")
    excitations: Any = given("torques beyond those that components bring")
    analyses: Any = given("what is computed (default: modes, and response when something excites)")
    rules: Any = given("the rules that are checked")


def read(path: str | FilePath) -> Study:
    """The study that a file describes; raises InputError with every fault in it."""
    return _study(read_source(path))


def parse(text: str, name: str = "train.yaml") -> Study:
    """The study that a text describes; `name` is the file name in messages. Raises InputError."""
    return _study(parse_source(text, name))


def located(error: InputError, study: Study) -> InputError:
    """The same faults with the places in the study's file and the lines quoted; for what is found after reading."""
    if not study.text or all(fault.line for fault in error.faults):
        return error
    return input_error(list(error.faults), parse_source(study.text, study.file))


def _study(source: Source) -> Study:
    faults: list[Fault] = []
    study = _sections(source, faults)
    if study is not None:
        if "train" not in _faulty(faults):
            study = _with_meshes(study, faults)
        faults += study_faults(study, _faulty(faults))
    if faults or study is None:
        raise input_error(faults, source)
    return study


def _with_meshes(study: Study, faults: list[Fault]) -> Study:
    """The study with every mesh found from the folder of its file, and read; faulty meshes are noted."""
    if not study.has_meshed_sections:
        return study
    from torsion.assembly.section.solved_sections import mesh_faults

    folder, bars = FilePath(study.file).parent, list(study.train.bars)
    for place, bar in enumerate(bars):
        if isinstance(bar.section, SectionMesh):
            bars[place] = replace(bar, section=replace(bar.section, file=str(folder / bar.section.file)))
    train = replace(study.train, bars=tuple(bars))
    faults += mesh_faults(train)
    return replace(study, train=train)


def _faulty(faults: list[Fault]) -> set[str]:
    """The sections with faults; all of them where a key of the top level is unknown, which may be one misspelt."""
    first = {str(fault.path[0]) if fault.path else "" for fault in faults}
    return first if first <= Scene.model_fields.keys() else set(Scene.model_fields)


def _sections(source: Source, faults: list[Fault]) -> Study | None:
    """The study, where its train can be looked at; its faulty sections are left empty."""
    data = source.data
    scene = declared(Scene, _top(data), (), faults)
    if not isinstance(data, dict):
        return None
    materials = sections.materials(data.get("materials"), faults)
    operation = declared(Operation, data.get("operation"), ("operation",), faults)
    analyses = sections.analyses(data.get("analyses"), faults)
    model = sections.shaft_model(data.get("analyses"), faults)
    rules = sections.rules(data.get("rules"), faults)
    found = _train(data, materials, operation, faults)
    if found is None:
        return None
    return Study(
        name=scene.name if scene is not None else "",
        description=scene.description if scene is not None else "",
        train=found,
        operation=operation or Operation(),
        model=model.model,
        fem=model.fem or FiniteElements(),
        analyses=analyses,
        rules=tuple(rules),
        file=source.name,
        text=source.text,
    )


def _top(data: object) -> object:
    """The keys of the top level alone: `present` stands for a section."""
    if not isinstance(data, dict):
        return {} if data is None else data
    plain = ("name", "description")
    return {key: value if key in plain or value is None else "present" for key, value in data.items()}


def _train(
    data: dict[str, Any], materials: dict[str, Any], operation: Operation | None, faults: list[Fault]
) -> Train | None:
    """The train as a whole, without the links and excitations that are faulty; None where a component is."""
    excitations = sections.excitations(data.get("excitations"), faults)
    links = sections.links(data.get("links"), faults)
    before = len(faults)
    parts = components(data["train"], ("train",), faults) if data.get("train") is not None else ()
    reference = None if operation is None else operation.at
    if len(faults) > before or data.get("train") is None:
        faults += repeated_names(data.get("train"))
        faults += _unknown_names(data, reference, excitations, links)
        return None
    found, more = lowered(parts, excitations=excitations, links=links, materials=materials, reference=reference)
    faults += more
    return found


def _unknown_names(
    data: dict[str, Any], reference: str | None, excitations: list[Excitation | None], links: list[Link | None]
) -> Iterator[Fault]:
    """Names that no component goes by, of a train that is too faulty to be lowered."""
    known = kinds_by_name(data.get("train"))
    if known is None:
        return
    named: list[tuple[str, Path]] = []
    for place, link in enumerate(links):
        for side, end in enumerate(() if link is None else link.between):
            named.append((end, ("links", place, "between", side)))
    for place, excitation in enumerate(excitations):
        if excitation is not None:
            named.append((excitation.at, ("excitations", place, "at")))
    found = [name_fault(name, path, known) for name, path in named]
    if reference is not None and not data.get("links"):  # a component of `links` may be meant
        found.append(name_fault(reference, ("operation", "at"), known, point=False))
    yield from (fault for fault in found if fault is not None)
