"""Figures of a file that vary in a sweep, a design or a fit: where they stand, and the study of any values of them."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Protocol, runtime_checkable

from torsion.analyses import VARYING
from torsion.analyses.variants.laws import Choice
from torsion.errors import Fault, InputError, Path, nearest
from torsion.schema.fault_text import Source
from torsion.schema.figures_by_name import named, overlay_of, with_tolerance
from torsion.schema.overlay import in_words, node_at
from torsion.schema.varied_figure import Figure
from torsion.study import Study


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

    def text(self, values: Sequence[float], without: Iterable[str] = VARYING) -> str:
        """That file as text without some analyses, with its words and comments where they can be kept."""
        from torsion.schema.edited_text import edited

        each = zip(self.figures, values, strict=True)
        puts = [put for figure, value in each for put in figure.puts(float(value), self.source)]
        return edited(self.source, puts, [("analyses", name) for name in without], self.file(values).data)

    def file(self, values: Sequence[float]) -> Source:
        """The file with every figure at its value, without what varies figures."""
        source, first = self.source, 0 if self.before is None else len(self.before.figures)
        if self.before is not None:
            source = self.before.file(values[:first])
        overlay = overlay_of(self.base, source)
        for name in VARYING:
            overlay.remove(("analyses", name))
        for figure, value in zip(self.figures[first:], values[first:], strict=True):
            for path, node in figure.puts(float(value), source):
                overlay.put(path, node, (node.line, node.column))
        return overlay.applied()

    def behind(self, other: "Variation") -> "Variation":
        """Both as one: the figures of the other first, and these about what that puts in the file."""
        return replace(self, figures=(*other.figures, *self.figures), before=other)


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
    for figure in with_tolerance(study, overlay_of(study, source)):
        figures.setdefault(figure.name, replace(figure, column=columns.setdefault(figure.name, len(columns))))
    return Variation(tuple(figures.values()), source, read, study)


def _variation(
    study: Study, source: Source, read: Callable[[Source], Study], faults: list[Fault], name: str, settings: Varying
) -> Variation:  # fmt: skip
    overlay, before, place = overlay_of(study, source), len(faults), ("analyses", name)
    key, varied = settings.varied
    found = list(named(varied, overlay, (*place, key)) if varied else with_tolerance(study, overlay))
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
                if why.file:  # in the row of a catalogue
                    yield replace(why, message=message)
                    break
                at = (*where, figure.name) if figure.name in named else where
                yield Fault(at, message, why.hint or "a narrower law", at_key=True)
                break
