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
from torsion.errors import Fault, InputError, Path, nearest
from torsion.schema.cases import stiffness_paths
from torsion.schema.fault_text import Node, Source
from torsion.schema.overlay import Overlay, in_words, multiplied, node_at
from torsion.schema.yaml_source import parse_source
from torsion.study import Study

EXACT = "ratio", "order", "blade_order"  # keys of exact ratios and orders
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


@runtime_checkable
class Refusing(Protocol):
    """Such settings that do not take every set of figures."""

    def refused(self, study: Study, figures: Sequence["Figure"]) -> Iterator[Fault]:
        """What they refuse, at places below the analysis."""


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

    @property
    def ends(self) -> FloatArray:
        """Its lowest and its highest value."""
        is_endless = isinstance(self.law, Law) and self.law.lognormal is not None
        return self.at(ENDS if is_endless else np.array([0.0, 1.0]))

    @property
    def numbers(self) -> tuple[FloatArray, str]:
        """Its values as numbers, and their unit; NaN where they are no numbers of one unit."""
        if not self.rows:
            return self.every(), self.law.unit
        stated = [_amount(row.puts[0][1].value) if len(row.puts) == 1 else None for row in self.rows]
        units_of = {one[1] for one in stated if one is not None}
        if None in stated or len(units_of) != 1:
            return np.full(len(self.rows), np.nan), ""
        return np.array([one[0] for one in stated if one is not None]), units_of.pop()

    @property
    def in_file(self) -> float:
        """What the file gives, in the unit of its numbers; NaN where that is not known."""
        if not self.rows:
            return self.nominal
        return float(self.numbers[0][int(self.nominal)]) if self.nominal == self.nominal else np.nan

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
                new: object = f"{value!r} {self.law.unit}" if self.law.unit else value
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

    def study(self, values: Sequence[float]) -> Study:
        """The study with every figure at its value; raises InputError where the file would be at fault."""
        return self.read(self.file(values))

    def fixed(self, values: Mapping[int, float]) -> "Variation":
        """The variation of the other figures of the file, in which these, by their places, have values."""
        own = replace(self, figures=tuple(self.figures[place] for place in values))
        source = own.file(list(values.values()))
        others = tuple(one for place, one in enumerate(self.figures) if place not in values)
        return replace(self, figures=others, source=source, base=self.read(source))

    def only(self, place: int, value: float) -> Study:
        """The study with one figure at a value, all others as in the file."""
        return replace(self, figures=(self.figures[place],)).study([value])

    def stated(self, place: int, value: float) -> tuple[str, str]:
        """The first value of a figure in words, as the file has it and at a value."""
        path, node = next(self.figures[place].puts(value, self.source))
        there = node_at(self.source.root, path)
        return "not given" if there is None else in_words(there.value), in_words(node.value)

    def text(self, values: Sequence[float]) -> str:
        """That file as text, with the words and comments of the file where they can be kept."""
        from torsion.schema.csv_tables import with_tables
        from torsion.schema.scene_text import text_with

        each = zip(self.figures, values, strict=True)
        puts = [put for figure, value in each for put in figure.puts(float(value), self.source)]
        gone = [("analyses", name) for name in VARYING]
        name, tables = self.base.file, dict(self.base.tables)
        return text_with(
            self.source, puts, gone, self.file(values), lambda text: with_tables(parse_source(text, name), tables)
        )

    def file(self, values: Sequence[float]) -> Source:
        """The file with every figure at its value, without what varies figures."""
        overlay = _overlay(self.base, self.source)
        for name in VARYING:
            overlay.remove(("analyses", name))
        for figure, value in zip(self.figures, values, strict=True):
            for path, node in figure.puts(float(value), self.source):
                overlay.put(path, node, (node.line, node.column))
        return overlay.applied()


def with_variations(study: Study, source: Source, read: Callable[[Source], Study], faults: list[Fault]) -> Study:
    """The study with the figures that its sweep, design and fit vary; those that cannot vary are noted."""
    found = {}
    for name in VARYING:
        settings: object = study.analyses.get(name)
        if isinstance(settings, Varying):
            found[name] = _variation(study, source, read, faults, name, settings)
    return replace(study, variations=found)


def movable(study: Study, source: Source, read: Callable[[Source], Study]) -> Variation:
    """Every figure of a file that its sweep, design or fit varies, and its other tolerances, for moving by hand."""
    columns: dict[object, int] = {}
    figures: dict[str, Figure] = {}
    for name, variation in study.variations.items():
        for figure in variation.figures:
            column = columns.setdefault((name, figure.column), len(columns))
            figures.setdefault(figure.name, replace(figure, column=column))
    for figure in _tolerances(study, _overlay(study, source)):
        figures.setdefault(figure.name, replace(figure, column=columns.setdefault(figure.name, len(columns))))
    return Variation(tuple(figures.values()), source, read, study)


def _variation(
    study: Study, source: Source, read: Callable[[Source], Study], faults: list[Fault], name: str, settings: Varying
) -> Variation:  # fmt: skip
    overlay, before, place = _overlay(study, source), len(faults), ("analyses", name)
    key, varied = settings.varied
    found = list(_named(varied, overlay, (*place, key)) if varied else _tolerances(study, overlay))
    faults += overlay.faults
    if not found and len(faults) == before:
        hint = "give components their `tolerance`, or name figures: `{vary: {coupling-1.stiffness: {uniform: +-15 %}}}`"
        faults.append(Fault(place, "no figure of the file varies", hint))
    figures = list(_in_columns(found, settings.together, (*place, "together"), faults))
    variation = Variation(tuple(figures), source, read, study)
    if len(faults) == before and isinstance(settings, Refusing):
        faults += [replace(one, path=(*place, *one.path)) for one in settings.refused(study, figures)]
    if len(faults) == before:
        faults += _faults_at_ends(variation, (*place, key), varied)
    return variation


def _overlay(study: Study, source: Source) -> Overlay:
    return Overlay(source, study.train.parts, study.operation.at or study.train.parts[0].name)


def _named(vary: Mapping[str, Choice], overlay: Overlay, place: Path) -> Iterator[Figure]:
    """The figures that the file names; `*` stands for every component that has the key and no line of its own."""
    taken: dict[Path, str] = {}
    for words, law in sorted(vary.items(), key=lambda item: item[0].startswith("*.")):
        fault = (*place, words)
        each = _of_all(words, law, overlay, fault) if words.startswith("*.") else _of_one(words, overlay, fault)
        for name, path in each:
            if path in taken and not words.startswith("*."):
                message = f"`{words}` varies as `{taken[path]}` already"
                overlay.faults.append(Fault(fault, message, "vary it once", at_key=True))
            if path in taken:
                continue
            taken[path] = words
            there = node_at(overlay.source.root, path)
            figure = None if there is None else _figure(name, law, path, there, overlay.faults, fault)
            if figure is not None:
                yield figure


def _of_one(words: str, overlay: Overlay, fault: Path) -> Iterator[tuple[str, Path]]:
    """The figure of a path, with its name."""
    path = overlay.path(words, fault)
    if path is not None and node_at(overlay.source.root, path) is None:
        hint = "give its value in the file; a path varies what the file says"
        overlay.faults.append(Fault(fault, f"the file does not give `{words}`", hint, at_key=True))
    elif path is not None:
        yield words.replace('"', ""), path


def _of_all(words: str, law: Choice, overlay: Overlay, fault: Path) -> Iterator[tuple[str, Path]]:
    """The figures of a key of any component; of a list each item, and none that is 0, which no factor varies."""
    key, has = words.removeprefix("*."), False
    for part in overlay.parts:
        there = node_at(overlay.source.root, (*part.path, key))
        if there is None:
            continue
        has = True
        is_list = isinstance(there.value, list) and not any(isinstance(one, list) for one in law.values or ())
        for steps in [(key, place) for place in range(len(there.value))] if is_list else [(key,)]:
            node = node_at(overlay.source.root, (*part.path, *steps))
            amount = None if node is None else _amount(node.value)
            if not law.is_relative or amount is None or amount[0] != 0.0:
                name = ".".join([part.name, key, *(str(int(step) + 1) for step in steps[1:])])
                yield name, (*part.path, *steps)
    if not has:
        overlay.faults.append(Fault(fault, f"no component has a key `{key}`", "a key of the file", at_key=True))


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
    if path[-1] in EXACT:
        message = f"`{name}` is exact, and varies by `values` alone"
        faults.append(Fault(fault, message, "for example {values: [41/17, 43/17]}", at_key=True))
        return None
    if (made := multiplied(there.value, Fraction(3, 2))) is None or (made == there.value and law.first is None):
        message = f"`{name}` is {in_words(there.value)}, which no factor varies"
        hint = f"one of its items by number, as `{name}.1`" if isinstance(there.value, list) else ""
        faults.append(Fault(fault, message, hint or "a number that is not 0, or `values`", at_key=True))
        return None
    return Figure(name, law, ((path, 1),), 0, 1.0 if law.first is None else _nominal(there.value, law.unit))


def _amount(value: object) -> tuple[float, str] | None:
    """A number of the file and its unit; None of anything else."""
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        return None
    try:
        amount, unit = units.amount(value) if isinstance(value, str) else (value, "")
    except units.UnitFault:
        return None
    return float(amount), unit


def _nominal(value: object, unit: str) -> float:
    """What the file gives in the unit of a range; NaN where that is not known."""
    if isinstance(value, str):
        try:
            return units.to_si(value, unit) if unit else float(units.amount(value)[0])
        except units.UnitFault:
            return np.nan
    return np.nan if unit or not isinstance(value, int | float) else float(value)


def _tolerances(study: Study, overlay: Overlay) -> Iterator[Figure]:
    """The stiffness, or the inertia with its water, of every component with a tolerance."""
    for part in study.train.parts:
        if part.inertia_tolerance:
            made = (*part.path, "inertia"), (*part.path, "entrained")
            there = [(path, node_at(overlay.source.root, path)) for path in made]
            given = [(path, 1) for path, node in there if node is not None and "%" not in str(node.value)]
            yield Figure(f"{part.name}.inertia", Law(uniform=part.inertia_tolerance), tuple(given), 0, 1.0)
        if not part.stiffness_tolerance:
            continue
        law = Law(uniform=part.stiffness_tolerance)
        if paths := [(path, -1 if path[-1] == "flexibility" else 1) for path in stiffness_paths(overlay, part)]:
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
            elif known[name].law != known[names[0]].law and not _in_pairs(known[name], known[names[0]]):
                message = (
                    f"'{name}' ({known[name].law.words}) and '{names[0]}' ({known[names[0]].law.words}) vary as one"
                )
                faults.append(Fault(path, message, "give both the same law, or lists of as many values"))
            else:
                group[name] = number
    columns: dict[object, int] = {}
    for name, figure in known.items():
        yield replace(figure, column=columns.setdefault(group.get(name, name), len(columns)))


def _in_pairs(one: Figure, other: Figure) -> bool:
    """Both take as many values, of which the first goes with the first."""
    return 0 < one.places == other.places


def _faults_at_ends(variation: Variation, where: Path, named: Mapping[str, Choice]) -> Iterator[Fault]:
    """Figures whose range, or any of whose alternatives, leaves what the file may say."""
    for place, figure in enumerate(variation.figures):
        for value in (figure.every() if figure.rows else figure.ends).tolist():
            try:
                variation.only(place, value)
            except InputError as error:
                why = error.faults[0]
                message = f"{figure.name} {figure.words(value)}: {why.message}"
                at = (*where, figure.name) if figure.name in named else where
                yield Fault(at, message, why.hint or "a narrower law", at_key=True)
                break
