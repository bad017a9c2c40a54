"""The figures that a file names for varying, or that have a tolerance."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from fractions import Fraction

import numpy as np

from torsion import units
from torsion.errors import Fault, Path
from torsion.model.parts import Part
from torsion.schema.cases import stiffness_paths
from torsion.schema.catalogues import alternatives
from torsion.schema.fault_text import Node, Source
from torsion.schema.overlay import Overlay, in_words, multiplied, node_at
from torsion.schema.varied_figure import Figure, Row, amount_of
from torsion.study import Study
from torsion.what_if.variants.laws import Choice, Law

EXACT = "ratio", "order", "blade_order"  # keys of exact ratios and orders


def overlay_of(study: Study, source: Source) -> Overlay:
    return Overlay(source, study.train.parts, study.reference)


def named(vary: Mapping[str, Choice], overlay: Overlay, section: Path) -> Iterator[Figure]:
    """The figures that the file names; `*` stands for every component that has the key and no line of its own."""
    taken: dict[Path, str] = {}
    for words, law in sorted(vary.items(), key=lambda item: item[0].startswith("*.")):
        fault = (*section, words)
        part = next((part for part in overlay.parts if part.name == words.strip("\"'")), None)
        if law.catalogue is not None and part is not None:
            yield from (
                replace(figure, key=words)
                for figure in _of_catalogue(law, law.catalogue, part, overlay)
            )
            continue
        pairs = (
            _of_all(words, law, overlay, fault)
            if words.startswith("*.")
            else _of_one(words, overlay, fault)
        )
        for name, path in pairs:
            if path in taken and not words.startswith("*."):
                message = f"`{words}` varies as `{taken[path]}` already"
                overlay.faults.append(Fault(fault, message, "vary it once", at_key=True))
            if path in taken:
                continue
            taken[path] = words
            given = node_at(overlay.source.root, path)
            figure = (
                None if given is None else _figure(name, law, path, given, overlay.faults, fault)
            )
            if figure is not None:
                yield replace(figure, key=words)


def _of_one(words: str, overlay: Overlay, fault: Path) -> Iterator[tuple[str, Path]]:
    """The figure of a path, with its name."""
    path = overlay.path(words, fault)
    if path is not None and node_at(overlay.source.root, path) is None:
        hint = "give its value in the file; a path varies only a value of the file"
        overlay.faults.append(Fault(fault, f"the file does not give `{words}`", hint, at_key=True))
    elif path is not None:
        yield words.replace('"', ""), path


def _of_all(words: str, law: Choice, overlay: Overlay, fault: Path) -> Iterator[tuple[str, Path]]:
    """The figures of a key of any component; of a list each item, and none that is 0, which no factor varies."""
    key, has = words.removeprefix("*."), False
    for part in overlay.parts:
        given = node_at(overlay.source.root, (*part.path, key))
        if given is None:
            continue
        has = True
        is_list = isinstance(given.value, list) and not any(
            isinstance(alternative, list) for alternative in law.values or ()
        )
        for steps in [(key, number) for number in range(len(given.value))] if is_list else [(key,)]:
            node = node_at(overlay.source.root, (*part.path, *steps))
            amount = None if node is None else amount_of(node.value)
            if not law.is_relative or amount is None or amount[0] != 0.0:
                name = ".".join([part.name, key, *(str(int(step) + 1) for step in steps[1:])])
                yield name, (*part.path, *steps)
    if not has:
        overlay.faults.append(
            Fault(fault, f"no component has a key `{key}`", "a key of the file", at_key=True)
        )


def _of_catalogue(law: Choice, name: str, part: Part, overlay: Overlay) -> Iterator[Figure]:
    """The figure whose values are the rows of a catalogue; none where those are at fault."""
    before = len(overlay.faults)
    rows = list(alternatives(name, part, overlay.source, overlay.faults))
    given = {
        path: node.value
        for row in rows
        for path, _ in row.puts
        if (node := node_at(overlay.source.root, path)) is not None
    }
    matching = (
        k
        for k, row in enumerate(rows)
        if all(given.get(path) == node.value for path, node in row.puts if path[-1] != "source")
    )
    if len(overlay.faults) == before:
        yield Figure(part.name, law, (), 0, float(next(matching, np.nan)), tuple(rows))


def _figure(
    name: str, law: Choice, path: Path, given: Node, faults: list[Fault], fault: Path
) -> Figure | None:
    """The figure whose value stands there; None with its fault noted where its law does not take such a value."""
    if law.values is not None:
        alternatives_of_law = [
            list(value) if isinstance(value, tuple) else value for value in law.values
        ]
        nodes = [Node(value, given.line, given.column) for value in alternatives_of_law]
        rows = tuple(Row(in_words(node.value), ((path, node),), {}) for node in nodes)
        nominal = next(
            (number for number, node in enumerate(nodes) if node.value == given.value), np.nan
        )
        return Figure(name, law, ((path, 1),), 0, float(nominal), rows)
    if law.catalogue is not None:
        faults.append(
            Fault(
                fault,
                "a catalogue is of a component, and of no key of it",
                f"`{name.rpartition('.')[0]}`",
            )
        )
        return None
    if path[-1] in EXACT:
        message = f"`{name}` is exact, and varies only by `values`"
        faults.append(Fault(fault, message, "for example {values: [41/17, 43/17]}", at_key=True))
        return None
    if (made := multiplied(given.value, Fraction(3, 2))) is None or (
        made == given.value and law.first is None
    ):
        message = f"`{name}` is {in_words(given.value)}, which no factor varies"
        hint = f"one of its items by number, as `{name}.1`" if isinstance(given.value, list) else ""
        faults.append(
            Fault(fault, message, hint or "a number that is not 0, or `values`", at_key=True)
        )
        return None
    return Figure(
        name, law, ((path, 1),), 0, 1.0 if law.first is None else _nominal(given.value, law.unit)
    )


def _nominal(value: object, unit: str) -> float:
    """What the file gives in the unit of a range; NaN where that is not known."""
    if isinstance(value, str):
        try:
            return units.to_si(value, unit) if unit else float(units.amount(value)[0])
        except units.UnitFault:
            return np.nan
    return np.nan if unit or not isinstance(value, int | float) else float(value)


def with_tolerance(study: Study, overlay: Overlay) -> Iterator[Figure]:
    """The stiffness, or the inertia with its water, of every component with a tolerance."""
    for part in study.train.parts:
        if part.inertia_tolerance:
            made = (*part.path, "inertia"), (*part.path, "entrained")
            pairs = [(path, node_at(overlay.source.root, path)) for path in made]
            given = [
                (path, 1) for path, node in pairs if node is not None and "%" not in str(node.value)
            ]
            law = Law.model_construct(
                uniform=part.inertia_tolerance
            )  # of any width, as of the stiffness
            yield Figure(f"{part.name}.inertia", law, tuple(given), 0, 1.0)
        if not part.stiffness_tolerance:
            continue
        law = Law.model_construct(uniform=part.stiffness_tolerance)
        if paths := [
            (path, -1 if path[-1] == "flexibility" else 1)
            for path in stiffness_paths(overlay, part)
        ]:
            key = "flexibility" if paths[0][1] < 0 else "stiffness"
            yield Figure(f"{part.name}.{key}", law, tuple(paths), 0, 1.0)
