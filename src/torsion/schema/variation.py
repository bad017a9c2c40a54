"""Figures of a file that vary in a sweep, a design or a fit: where they stand, and the study of any values of them."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Protocol, runtime_checkable

import numpy as np

from torsion import units
from torsion.analyses import VARYING
from torsion.analyses.variants.laws import Choice, Law
from torsion.analyses.variants.sampling import factors
from torsion.arrays import FloatArray
from torsion.components.lowering import Part
from torsion.errors import Fault, InputError, Path, nearest
from torsion.schema.cases import stiffness_paths
from torsion.schema.catalogues import alternatives
from torsion.schema.fault_text import Node, Source
from torsion.schema.overlay import Overlay, in_words, multiplied, node_at
from torsion.study import Study

ENDS = np.array([1e-4, 1.0 - 1e-4])  # of a law without ends, where the file is read as a trial


@runtime_checkable
class Varying(Protocol):
    """Settings of an analysis that varies figures of the file."""

    @property
    def together(self) -> tuple[tuple[str, ...], ...]:
        """Figures that vary as one."""

    @property
    def varied(self) -> tuple[str, Mapping[str, Choice]]:
        """The key that names the figures, and how each varies; none for every tolerance of the file."""


@dataclass(frozen=True)
class Row:
    """One alternative of a list or a catalogue."""

    label: str
    puts: tuple[tuple[Path, Node], ...]
    said: Mapping[str, float]  # what else it states, such as mass and cost


@dataclass(frozen=True)
class Figure:
    """One figure that varies.

    A value of it is, of a law, the factor of what the file gives; of a range, a number in its unit; of a list or a
    catalogue, the number of the row, from 0.
    """

    name: str  # as the file names it
    law: Choice
    paths: tuple[tuple[Path, int], ...]  # of its values, and the power of the factor that each takes
    column: int  # of the samples; figures that vary together share one
    nominal: float  # its value in the file as it stands; NaN where the file's is none of the alternatives
    rows: tuple[Row, ...] = ()

    def at(self, unit: FloatArray) -> FloatArray:
        """The values at samples (count,) evenly distributed within 0 and 1."""
        if isinstance(self.law, Law) and self.law.is_relative:
            return factors(self.law, unit)
        if not self.places:
            low, high = self.law.ends
            return np.asarray(low + unit * (high - low))
        return self.every()[np.minimum((unit * self.places).astype(np.intp), self.places - 1)]

    @property
    def places(self) -> int:
        """How many values it takes; 0 where any within its range, or by its law."""
        return len(self.rows) or (0 if self.law.first is None else self.law.places or 0)

    def every(self) -> FloatArray:
        """All of these values."""
        if self.rows:
            return np.arange(float(len(self.rows)))
        (low, high), step = self.law.ends, self.law.step
        if step is not None:
            high = low + float(units.amount(str(step))[0]) * (self.places - 1)
        return np.linspace(low, high, self.places)

    def words(self, value: float) -> str:
        """A value of it as the file would state it."""
        if self.rows:
            return self.rows[int(value)].label
        return f"{value:.6g} {self.law.unit}".strip() if self.law.first is not None else f"times {value:.6g}"

    def puts(self, value: float, source: Source) -> Iterator[tuple[Path, Node]]:
        """What stands in the file with a value of it."""
        if self.rows:
            yield from self.rows[int(value)].puts
            return
        exact = Fraction(repr(float(value)))
        for path, power in self.paths:
            there = node_at(source.root, path) or Node(None, 1, 1)
            if self.law.first is not None:
                new: object = f"{repr(value).removesuffix('.0')} {self.law.unit}" if self.law.unit else value
            else:
                new = multiplied(there.value, exact if power > 0 else 1 / exact)
            yield path, Node(new, there.line, there.column)


@dataclass(frozen=True)
class Variation:
    """The figures that vary, and how a study of other values is read."""

    figures: tuple[Figure, ...]
    source: Source
    read: Callable[[Source], Study]
    base: Study
    before: "Variation | None" = None  # whose figures are the first of these, and are put in before the others

    def study(self, values: Sequence[float]) -> Study:
        """The study with every figure at its value; raises InputError where the file would be at fault."""
        return self.read(self.file(values))

    def only(self, place: int, value: float) -> Study:
        """The study with one figure at a value, all others as in the file."""
        return replace(self, figures=(self.figures[place],)).study([value])

    def file(self, values: Sequence[float]) -> Source:
        """The file with every figure at its value, without what varies figures."""
        source, first = self.source, 0 if self.before is None else len(self.before.figures)
        if self.before is not None:
            source = self.before.file(values[:first])
        overlay = _overlay(self.base, source)
        for name in VARYING:
            overlay.remove(("analyses", name))
        for figure, value in zip(self.figures[first:], values[first:], strict=True):
            for path, node in figure.puts(float(value), source):
                overlay.put(path, node, (node.line, node.column))
        return overlay.applied()

    def behind(self, other: "Variation") -> "Variation":
        """Both as one: the figures of the other first, and these about what that puts in the file."""
        return replace(self, figures=(*other.figures, *self.figures), before=other)

    def written(self, values: Sequence[float]) -> str:
        """The text of the file with every figure at its value, and without its design; its comments are kept."""
        from torsion.schema.edited_text import edited

        puts = [
            put for figure, value in zip(self.figures, values, strict=True) for put in figure.puts(value, self.source)
        ]
        return edited(self.source, puts, ("analyses", "design"), self.file(values).data)


def with_variations(study: Study, source: Source, read: Callable[[Source], Study], faults: list[Fault]) -> Study:
    """The study with the figures that its sweep, design and fit vary; those that cannot vary are noted."""
    found = {}
    for name in VARYING:
        settings: object = study.analyses.get(name)
        if isinstance(settings, Varying):
            found[name] = _variation(study, source, read, faults, name, settings)
    return replace(study, variations=found)


def _variation(
    study: Study, source: Source, read: Callable[[Source], Study], faults: list[Fault], name: str, settings: Varying
) -> Variation:  # fmt: skip
    overlay, before, place = _overlay(study, source), len(faults), ("analyses", name)
    key, varied = settings.varied
    found = list(_named(varied, overlay, (*place, key)) if varied else _tolerances(study, overlay))
    faults += overlay.faults
    if not found and len(faults) == before:
        hint = "give a coupling its `tolerance`, or name figures: `{vary: {coupling-1.stiffness: {uniform: +-15 %}}}`"
        faults.append(Fault(place, "no figure of the file varies", hint))
    figures = list(_in_columns(found, settings.together, (*place, "together"), faults))
    variation = Variation(tuple(figures), source, read, study)
    if len(faults) == before:
        faults += _faults_at_ends(variation, (*place, key))
        clashes: Callable[[Study, Variation], Iterable[Fault]] = getattr(settings, "clashes", lambda *_: ())
        faults += clashes(study, variation)
    return variation


def _overlay(study: Study, source: Source) -> Overlay:
    return Overlay(source, study.train.parts, study.operation.at or study.train.parts[0].name)


def _named(vary: Mapping[str, Choice], overlay: Overlay, place: Path) -> Iterator[Figure]:
    """The figures that the file names; `*` stands for every component that has the key."""
    for words, law in vary.items():
        fault = (*place, words)
        part = next((part for part in overlay.parts if part.name == words.strip("\"'")), None)
        if law.catalogue is not None and part is not None:
            yield from _of_catalogue(law, law.catalogue, part, overlay)
            continue
        if not words.startswith("*."):
            each = [words]
        else:
            key = words.removeprefix("*.")
            held = (part.name for part in overlay.parts if node_at(overlay.source.root, (*part.path, key)) is not None)
            each = [f'"{name}".{key}' for name in held if f"{name}.{key}" not in vary]
            if not each:
                overlay.faults.append(Fault(fault, f"no component has a key `{key}`", "a key of the file", at_key=True))
        for one in each:
            path = overlay.path(one, fault)
            if path is None:
                continue
            there = node_at(overlay.source.root, path)
            if there is None:
                hint = "give its value in the file; a path varies what the file says"
                overlay.faults.append(Fault(fault, f"the file does not give `{one}`", hint, at_key=True))
            else:
                figure = _figure(one.replace('"', ""), law, path, there, overlay.faults, fault)
                if figure is not None:
                    yield figure


def _of_catalogue(law: Choice, name: str, part: Part, overlay: Overlay) -> Iterator[Figure]:
    """The figure whose values are the rows of a catalogue; none where those are at fault."""
    before = len(overlay.faults)
    rows = [Row(*one) for one in alternatives(name, part, overlay.source, overlay.faults)]
    there = {path: node.value for row in rows for path, _ in row.puts
             if (node := node_at(overlay.source.root, path)) is not None}  # fmt: skip
    own = (k for k, row in enumerate(rows)
           if all(there.get(path) == node.value for path, node in row.puts if path[-1] != "source"))  # fmt: skip
    if len(overlay.faults) == before:
        yield Figure(part.name, law, (), 0, float(next(own, np.nan)), tuple(rows))


def _figure(name: str, law: Choice, path: Path, there: Node, faults: list[Fault], fault: Path) -> Figure | None:
    """The figure whose value stands there; None with its fault noted where its law does not take such a value."""
    if law.values is not None:
        nodes = [Node(value, there.line, there.column) for value in law.values]
        rows = tuple(Row(in_words(node.value), ((path, node),), {}) for node in nodes)
        own = next((place for place, node in enumerate(nodes) if node.value == there.value), np.nan)
        return Figure(name, law, ((path, 1),), 0, float(own), rows)
    if law.catalogue is not None:
        faults.append(
            Fault(fault, "a catalogue is of a component, and of no key of it", f"`{name.rpartition('.')[0]}`")
        )
        return None
    if (made := multiplied(there.value, Fraction(3, 2))) is None or (made == there.value and law.first is None):
        message = f"`{name}` is {in_words(there.value)}, which no factor varies"
        faults.append(Fault(fault, message, "a number that is not 0, or `values`", at_key=True))
        return None
    return Figure(name, law, ((path, 1),), 0, 1.0 if law.first is None else _nominal(there.value, law.unit))


def _nominal(value: object, unit: str) -> float:
    """What the file gives in the unit of a range; NaN where that is not known."""
    if isinstance(value, str):
        try:
            return units.to_si(value, unit) if unit else float(units.amount(value)[0])
        except units.UnitFault:
            return np.nan
    return np.nan if unit or not isinstance(value, int | float) else float(value)


def _tolerances(study: Study, overlay: Overlay) -> Iterator[Figure]:
    """The stiffness of every coupling with a tolerance."""
    for part in study.train.parts:
        if part.ratings is None or not part.ratings.tolerance:
            continue
        paths = [(path, -1 if path[-1] == "flexibility" else 1) for path in stiffness_paths(overlay, part)]
        if paths:
            law = Law(uniform=part.ratings.tolerance)
            key = "flexibility" if paths[0][1] < 0 else "stiffness"
            yield Figure(f"{part.name}.{key}", law, tuple(paths), 0, 1.0)


def _in_columns(
    figures: Iterable[Figure], together: Sequence[Sequence[str]], place: Path, faults: list[Fault]
) -> Iterator[Figure]:  # fmt: skip
    """Each figure with the column of the samples that it takes."""
    known = {figure.name: figure for figure in figures}
    group: dict[str, int] = {}
    for number, names in enumerate(together):
        path = (*place, number)
        for name in names:
            if name not in known:
                near = nearest(name, list(known))
                hint = f"did you mean '{near}'?" if near else f"figures that vary: {', '.join(known)}"
                faults.append(Fault(path, f"no figure '{name}' varies", hint))
            elif name in group:
                faults.append(Fault(path, f"'{name}' varies together twice", "name it once"))
            elif known[name].law != known[names[0]].law:
                message = (
                    f"'{name}' ({known[name].law.words}) and '{names[0]}' ({known[names[0]].law.words}) vary as one"
                )
                faults.append(Fault(path, message, "give both the same law"))
            else:
                group[name] = number
    columns: dict[object, int] = {}
    for name, figure in known.items():
        yield replace(figure, column=columns.setdefault(group.get(name, name), len(columns)))


def _faults_at_ends(variation: Variation, where: Path) -> Iterator[Fault]:
    """Figures whose range, or any of whose alternatives, leaves what the file may say."""
    for place, figure in enumerate(variation.figures):
        relative = isinstance(figure.law, Law) and figure.law.lognormal is not None
        ends = figure.every() if figure.rows else figure.at(ENDS if relative else np.array([0.0, 1.0]))
        for value in ends.tolist():
            try:
                variation.only(place, value)
            except InputError as error:
                why = error.faults[0]
                message = f"{figure.name} {figure.words(value)}: {why.message}"
                if why.file:  # in the row of a catalogue
                    yield replace(why, message=message)
                    break
                yield Fault(where, message, why.hint or "a narrower law", at_key=True)
                break
