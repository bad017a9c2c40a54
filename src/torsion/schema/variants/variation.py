"""Figures of a file that vary in a sweep, a design or a fit: where they stand, and the study of any values of them."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from torsion.analyses import VARYING
from torsion.arrays import FloatArray
from torsion.columns import NotInColumns, picker
from torsion.errors import Fault, InputError, Path, nearest
from torsion.model import KINDS
from torsion.schema.declaration_reader import one_component
from torsion.schema.study_faults import study_faults
from torsion.schema.variants.overlay import Overlay, in_words
from torsion.schema.variants.train_in_columns import Pieces, train_in_columns
from torsion.schema.variants.varied_figures import Figure, named, with_tolerance
from torsion.study import Study
from torsion.study import Variation as VariationOfStudy
from torsion.train import Train
from torsion.user_files import Node, Source

FEW = 100  # rows of a list or a catalogue, of which the whole file is read with each
MOST_TRIALS = 500  # readings of the file for one figure


@dataclass(frozen=True)
class Variation(VariationOfStudy):
    """The figures that vary, and how a study of other values is read."""

    figures: tuple[Figure, ...]
    source: Source
    read: Callable[[Source], Study]
    base: Study
    declare: Callable[[Source], Mapping[str, Any]] | None = None  # None: each value is read alone

    def study(self, values: Sequence[float]) -> Study:
        """The study with every figure at its value; raises InputError where the file would be at fault."""
        return self.read(self.changed(values)[0])

    def stated(self, place: int, value: float) -> tuple[str, str]:
        """The first value of a figure in words, as the file has it and at a value."""
        path, node = next(self.figures[place].puts(value, self.source))
        given = self.source.at(path)
        return "not given" if given is None else in_words(given.value), in_words(node.value)

    def text(self, values: Sequence[float], without: Iterable[str] = VARYING) -> str:
        """That file as text without some analyses, with its words and comments where they can be kept."""
        from torsion.schema.edited_text import edited

        source, changes = self.changed(values)
        return edited(
            self.source,
            list(changes.items()),
            [("analyses", name) for name in without],
            source.data,
        )

    def changed(self, values: Sequence[float]) -> tuple[Source, dict[Path, Node]]:
        """The file with every figure at its value, without what varies figures; and what is put in it, where."""
        source, changes = self.source, dict[Path, Node]()
        for stage in sorted({figure.stage for figure in self.figures}) or [(0, True)]:
            overlay = Overlay(source, self.base)
            for name in VARYING:
                overlay.removed["analyses", name] = None
            for figure, value in zip(self.figures, values, strict=True):
                if figure.stage == stage:
                    for path, node in figure.puts(float(value), source):
                        overlay.put(path, node)
                        changes[path] = node
            source = overlay.applied()
        return source, changes

    def in_case(self, case: Study) -> "Variation":
        """The same figures of a case of the file: they are put in before the case changes the file."""
        from torsion.schema.variants.cases import with_cases

        if case.case is None:
            return self
        name, changed = case.case.name, case.case.source
        read = lambda source: with_cases(source, self.read, name).cases[name]  # noqa: E731
        # Columns can only be put in behind what the case changes, which is the same where it changes none of them.
        paths = [path for figure in self.figures for path in figure.all_paths]
        before, after = (
            [
                part.name
                for path in paths
                for part in study.train.parts
                if path[: len(part.path)] == part.path
            ]
            for study in (self.base, case)
        )
        is_same = before == after and all(
            changed.at(path) == self.source.at(path) for path in paths
        )
        return replace(self, read=read, base=case, declare=self.declare if is_same else None)

    @cached_property
    def _of_columns(self) -> tuple[Source, Mapping[str, Any], dict[str, Pieces]]:
        """The file that columns are put in (of a case as the case changes it), its declarations, read alternatives."""
        if self.declare is None:
            raise NotInColumns("the declarations of the file are not known")
        source = self.source if self.base.case is None else self.base.case.source
        return source, self.declare(source), {}

    def in_columns(self, values: FloatArray) -> Train:
        """Return the train with columns for the values (variants, figures); raises NotInColumns."""
        return train_in_columns(self.base, *self._of_columns, self.figures, values)

    def studies(self, values: FloatArray) -> Callable[[int], Study]:
        """Return the function from the number of a variant of the values (variants, figures) to its study.

        The study is what the file with these values would be read as; it raises InputError as the reading does.
        """
        try:
            train = self.in_columns(values)
        except NotInColumns:
            return lambda variant: self.study(values[variant].tolist())
        analyses = {
            name: settings for name, settings in self.base.analyses.items() if name not in VARYING
        }
        plain = replace(self.base, analyses=analyses, variations={}, cases={}, case=None)
        pick = picker(train) or (lambda _: train)

        def study_of(variant: int) -> Study:
            study = replace(plain, train=pick(variant))
            if faults := study_faults(study):
                raise InputError(faults)
            return study

        return study_of

    def behind(self, other: "Variation") -> "Variation":
        """Return both as one: the figures of the other first, and these about what those put in the file."""
        figures = (replace(figure, layer=figure.layer + 1) for figure in self.figures)
        return replace(other, figures=(*other.figures, *figures))


def with_variations(
    study: Study,
    source: Source,
    read: Callable[[Source], Study],
    declare: Callable[[Source], Mapping[str, Any]],
    faults: list[Fault],
) -> Study:
    """The study with the figures that its sweep, design and fit vary; those that cannot vary are noted."""
    variations = {}
    for name in VARYING:
        settings: Any = study.analyses.get(name)
        if not hasattr(settings, "varied"):
            continue
        overlay, before, path = Overlay(source, study), len(faults), ("analyses", name)
        key, laws = settings.varied
        varied = list(
            named(laws, overlay, (*path, key)) if laws else with_tolerance(study, overlay)
        )
        faults += overlay.faults
        if not varied and len(faults) == before:
            hint = "give components their `tolerance`, or name figures: `{vary: {coupling-1.stiffness: {uniform: +-15 %}}}`"
            faults.append(Fault(path, "no parameter of the file varies", hint))
        together = getattr(settings, "together", ())  # names of figures
        figures = tuple(_with_columns(varied, together, (*path, "together"), faults))
        variation = Variation(figures, source, read, study, declare)
        if len(faults) == before and hasattr(settings, "refused"):
            refused = settings.refused(study, figures)
            faults += [replace(fault, path=(*path, *fault.path)) for fault in refused]
        if len(faults) == before:
            faults += _faults_at_ends(variation, (*path, key))
        variations[name] = variation
    return replace(study, variations=variations)


def movable(study: Study, source: Source, read: Callable[[Source], Study]) -> Variation:
    """Return every figure that a sweep, design or fit of the file varies, and its other tolerances, for moving by hand."""
    columns: dict[object, int] = {}
    figures: dict[str, Figure] = {}
    varied = [
        ((name, figure.column), figure)
        for name, variation in study.variations.items()
        for figure in variation.figures
    ]
    tolerances = with_tolerance(study, Overlay(source, study))
    for column, figure in [*varied, *((figure.name, figure) for figure in tolerances)]:
        if figure.name not in figures:
            figures[figure.name] = replace(figure, column=columns.setdefault(column, len(columns)))
    return Variation(tuple(figures.values()), source, read, study)


def _with_columns(
    varied: Iterable[Figure], together: Sequence[Sequence[str]], path: Path, faults: list[Fault]
) -> Iterator[Figure]:
    """Yield each figure with the column of the samples that it takes; `together`: names that share one."""
    figures = {figure.name: figure for figure in varied}
    group: dict[str, int] = {}
    for number, names in enumerate(together):
        for name in names:
            figure, first = figures.get(name), figures.get(names[0])
            if figure is None:
                near = nearest(name, list(figures))
                varies = f"figures that vary: {', '.join(figures)}"
                hint = f"did you mean '{near}'?" if near else varies
                message = f"no figure '{name}' varies"
            elif first is None:
                continue
            elif name in group:
                message, hint = f"'{name}' varies together twice", "name it once"
            elif figure.law != first.law and not 0 < figure.places == first.places:
                laws = f"'{name}' ({figure.law.words}) and '{names[0]}' ({first.law.words})"
                message = f"{laws} vary as one"
                hint = "give both the same law, or lists of as many values"
            else:
                group[name] = number
                continue
            faults.append(Fault((*path, number), message, hint))
    columns: dict[object, int] = {}
    for name, figure in figures.items():
        yield replace(figure, column=columns.setdefault(group.get(name, name), len(columns)))


def _faults_at_ends(variation: Variation, path: Path) -> Iterator[Fault]:
    """Yield the fault of every figure with a value, an end of its range or a row, that the file may not state.

    The whole file is read as a trial with every row of a few. Of many with `FEW` spread over all, the least and the
    greatest number, and those whose component alone is at fault; others are read as variants, and are variants without
    an answer if they are at fault.
    """
    for figure in variation.figures:
        single, count = replace(variation, figures=(figure,)), len(figure.rows)
        numbers = {*range(count)}
        if count > FEW:
            stated, _ = figure.numbers
            spread = np.linspace(0, count - 1, FEW).astype(int)
            numbers = {*spread.tolist(), int(stated.argmin()), int(stated.argmax())}
        for number, row in enumerate(figure.rows if count > FEW else ()):
            component, faults = row.puts[0][0][:-1], list[Fault]()
            if component[-1] in KINDS:
                node = variation.source.at(component)
                body = {} if node is None else dict(node.value or {})
                body |= {str(key[-1]): node.value for key, node in row.puts}
                one_component(str(component[-1]), body, component, faults)
            numbers |= {number} if faults else set()
        for value in [float(row) for row in sorted(numbers)[:MOST_TRIALS]] or figure.ends.tolist():
            try:
                single.study([value])
            except InputError as error:
                fault = error.faults[0]
                message = f"{figure.name} {figure.words(value)}: {fault.message}"
                if fault.file:  # in the row of a catalogue
                    yield replace(fault, message=message)
                else:
                    fault_path = (*path, figure.key) if figure.key else path
                    yield Fault(fault_path, message, fault.hint or "a narrower law", at_key=True)
                break
