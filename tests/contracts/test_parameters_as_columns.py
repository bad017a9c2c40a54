"""Every number of every example as a column of two values: the train of the file read again, or refused aloud."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields, is_dataclass, replace
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from torsion.analyses import VARYING
from torsion.columns import Column, NotInColumns
from torsion.errors import InputError
from torsion.schema import scene_reader
from torsion.schema.variants import overlay
from torsion.schema.variants.train_in_columns import SECTIONS
from torsion.schema.variants.variation import Variation
from torsion.schema.variants.varied_figures import Figure
from torsion.study import Study
from torsion.what_if.variants.laws import Law

ROOT = Path(__file__).parents[2]
SCENES = sorted((ROOT / "shafting_specs").glob("*.yaml"))
FACTOR = 1.03
MOST = 30  # numbers of an example, evenly spread over it, each of another key
PLAIN = {float, int, complex, str, bool, type(None), Fraction}
RECORDS = (
    "stations",
    "inertias",
    "springs",
    "bars",
    "constraints",
    "dampers",
    "torques",
    "parts",
    "materials",
)


def numbers(node: Any, path: tuple[Any, ...]) -> Iterator[tuple[Any, ...]]:
    if isinstance(node.value, dict | list):
        for step, inner in node.parts.items():
            yield from numbers(inner, (*path, step))
    elif overlay.multiplied(node.value, Fraction(repr(FACTOR))) is not None:
        yield path


@cache
def names_of(kind: type) -> tuple[str, ...]:
    names = (field.name for field in fields(kind)) if is_dataclass(kind) else kind.model_fields
    return tuple(names)


def difference(first: Any, second: Any) -> float:
    """The largest relative difference of two records; infinite if they differ in kind or a column is left."""
    if type(first) is type(second) and type(first) in PLAIN and first == second:
        return 0.0
    if isinstance(first, Column) or isinstance(second, Column):
        return np.inf
    if isinstance(first, float | int | complex) and isinstance(second, float | int | complex):
        is_same = first == second or bool(np.isnan(first) and np.isnan(second))
        return 0.0 if is_same else abs(first - second) / max(abs(first), abs(second))
    if isinstance(first, np.ndarray):
        if np.array_equal(first, second):
            return 0.0
        is_alike = first.shape == second.shape
        return difference(first.ravel().tolist(), second.ravel().tolist()) if is_alike else np.inf
    if isinstance(first, Mapping):
        first, second = tuple(first.items()), tuple(second.items())
    if isinstance(first, tuple | list):
        pairs = zip(first, second, strict=True) if len(first) == len(second) else ((0.0, np.inf),)
        return max((difference(*pair) for pair in pairs), default=0.0)
    if type(first) is type(second) and (
        is_dataclass(first) or hasattr(type(first), "model_fields")
    ):
        each = (
            difference(getattr(first, name), getattr(second, name))
            for name in names_of(type(first))
        )
        return max(each, default=0.0)
    return 0.0 if first == second else np.inf


class InColumns(Variation):
    """Figures whose values are never read alone."""

    def study(self, values: Sequence[float]) -> Study:
        raise NotInColumns("the file would be read for each variant")


def train_read_again(study: Study, source: Any, path: tuple[Any, ...]) -> Any:
    changed = overlay.Overlay(source, study)
    for name in VARYING:
        changed.removed["analyses", name] = None
    node = source.at(path)
    value = overlay.multiplied(node.value, Fraction(repr(FACTOR)))
    changed.put(path, replace(node, plain=value, parts={}))
    return scene_reader._study(changed.applied()).train


@pytest.mark.parametrize("scene", SCENES, ids=[scene.stem for scene in SCENES])
def test_a_column_is_the_file_read_again_or_is_refused(scene: Path) -> None:
    study = scene_reader.read(scene)
    source, read = scene_reader.reread(study)
    nodes = [(name, source.at((name,))) for name in SECTIONS]
    paths = [path for name, node in nodes if node for path in numbers(node, (name,))]
    # What enters the train the same way does so alike for every disc of an example.
    keys = {tuple(step for step in path if isinstance(step, str)): path for path in paths}
    paths = list(keys.values())
    declarations = scene_reader.declarations(source)  # the same for each number
    answers = Counter[str]()
    for path in paths[:: len(paths) // MOST + 1]:
        try:
            expected = train_read_again(study, source, path)
        except InputError:
            continue
        law = Law.model_construct(uniform=0.05)
        figure = Figure("any", law, ((path, 1),), 0, 1.0)
        variation = InColumns((figure,), source, read, study, lambda _: declarations)
        try:
            found = variation.studies(np.array([[1.0], [FACTOR]]))(1).train
        except NotInColumns:
            answers["refused"] += 1
            continue
        apart = max(difference(getattr(found, name), getattr(expected, name)) for name in RECORDS)
        assert apart < 1e-12, path
        answers["equal"] += 1
    assert answers


def test_a_component_asks_what_a_number_is_not() -> None:
    """`isinstance(value, float)` would take the branch of no number for a column, silently."""
    model = ROOT / "src" / "torsion" / "model"
    texts = {path: path.read_text(encoding="utf-8") for path in model.rglob("*.py")}
    assert not [path.name for path, text in texts.items() if ", float) else 0.0" in text]
