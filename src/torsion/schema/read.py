"""The file of a shaft train as a study; every fault of the file at once, each with its line and column."""

from pathlib import Path as FilePath
from typing import Any

from torsion.errors import Fault, InputError
from torsion.fields import Declared, given, required
from torsion.schema import sections
from torsion.schema.checks import study_faults
from torsion.schema.faults import input_error
from torsion.schema.meshes import with_meshes
from torsion.schema.messages import declared
from torsion.schema.models import model_of
from torsion.schema.source import Source, parse_source, read_source
from torsion.schema.train_reader import components, repeated_names
from torsion.study import Operation, Study
from torsion.train import Train, train


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
        study = with_meshes(study, faults)
    if study is not None and not faults:
        faults += study_faults(study)
    if faults or study is None:
        raise input_error(faults, source)
    return study


def _sections(source: Source, faults: list[Fault]) -> Study | None:
    data = source.data
    scene = declared(Scene, _top(data), (), faults)
    if not isinstance(data, dict):
        return None
    materials = sections.materials(data.get("materials"), faults)
    operation = declared(Operation, data.get("operation"), ("operation",), faults)
    analyses = sections.analyses(data.get("analyses"), faults)
    model, fem = model_of(data.get("analyses"), faults)
    rules = sections.rules(data.get("rules"), faults)
    lowered = _train(data, materials, operation, faults)
    if scene is None or operation is None or lowered is None:
        return None
    return Study(
        name=scene.name,
        description=scene.description,
        train=lowered,
        operation=operation,
        model=model,
        fem=fem,
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
    """The train as a whole, if all that it is made of is sound."""
    before = len(faults)
    excitations = sections.excitations(data.get("excitations"), faults)
    links = sections.links(data.get("links"), faults)
    between = len(faults)
    parts = components(data["train"], ("train",), faults) if data.get("train") is not None else ()
    if len(faults) > between or data.get("train") is None:
        faults += repeated_names(data.get("train"))
        return None
    reference = None if operation is None else operation.at
    try:
        lowered = train(parts, excitations=excitations, links=links, materials=materials, reference=reference)
    except InputError as error:
        faults += error.faults
        return None
    return lowered if len(faults) == before else None
