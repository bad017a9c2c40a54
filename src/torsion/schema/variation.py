"""Figures of a file that a sweep varies: which values of the file they are, and the study of any factors of them."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np

from torsion.analyses.sweep.sampling import factors
from torsion.analyses.sweep.sweep_settings import Law, SweepSettings
from torsion.errors import Fault, InputError, Path, nearest
from torsion.schema.cases import stiffness_paths
from torsion.schema.fault_text import Node, Source
from torsion.schema.overlay import Overlay, in_words, multiplied, node_at
from torsion.study import Study

SWEEP: Path = ("analyses", "sweep")
ENDS = np.array([1e-4, 1.0 - 1e-4])  # of a law without ends, where the file is read as a trial


@dataclass(frozen=True)
class Figure:
    """One figure that varies."""

    name: str  # as the file names it
    law: Law
    paths: tuple[tuple[Path, int], ...]  # of its values, and the power of the factor that each takes
    column: int  # of the samples; figures that vary together share one


@dataclass(frozen=True)
class Variation:
    """The figures that vary, and how a study of other values is read."""

    figures: tuple[Figure, ...]
    source: Source
    read: Callable[[Source], Study]
    base: Study

    def study(self, factor: Sequence[float]) -> Study:
        """The study with every figure times its factor; raises InputError where the file would be at fault."""
        overlay = _overlay(self.base, self.source)
        overlay.remove(SWEEP)
        for figure, times in zip(self.figures, factor, strict=True):
            exact = Fraction(repr(float(times)))
            for path, power in figure.paths:
                there = node_at(self.source.root, path) or Node(None, 1, 1)
                value = multiplied(there.value, exact if power > 0 else 1 / exact)
                overlay.put(path, Node(value, there.line, there.column), (there.line, there.column))
        return self.read(overlay.applied())


def with_variation(study: Study, source: Source, read: Callable[[Source], Study], faults: list[Fault]) -> Study:
    """The study with the figures that its sweep varies; those that cannot vary are noted."""
    settings = study.analyses["sweep"]
    if not isinstance(settings, SweepSettings):
        return study
    overlay, before = _overlay(study, source), len(faults)
    found = list(_named(settings.vary, overlay) if settings.vary else _tolerances(study, overlay))
    faults += overlay.faults
    if not found and len(faults) == before:
        hint = "give components their `tolerance`, or name figures: `{vary: {coupling-1.stiffness: {uniform: +-15 %}}}`"
        faults.append(Fault(SWEEP, "no figure of the file varies", hint))
    figures = list(_in_columns(found, settings.together, faults))
    variation = Variation(tuple(figures), source, read, study)
    if len(faults) == before:
        faults += _faults_at_ends(variation)
    return replace(study, variation=variation)


def _overlay(study: Study, source: Source) -> Overlay:
    return Overlay(source, study.train.parts, study.operation.at or study.train.parts[0].name)


def _named(vary: dict[str, Law], overlay: Overlay) -> Iterator[Figure]:
    """The figures that the file names; `*` stands for every component that has the key."""
    for words, law in vary.items():
        fault = (*SWEEP, "vary", words)
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
            elif (made := multiplied(there.value, Fraction(3, 2))) is None or made == there.value:
                message = f"`{one}` is {in_words(there.value)}, which no factor varies"
                overlay.faults.append(Fault(fault, message, "a number that is not 0", at_key=True))
            else:
                yield Figure(one.replace('"', ""), law, ((path, 1),), 0)


def _tolerances(study: Study, overlay: Overlay) -> Iterator[Figure]:
    """The stiffness, or the inertia with its water, of every component with a tolerance."""
    for part in study.train.parts:
        if part.inertia_tolerance:
            made = (*part.path, "inertia"), (*part.path, "entrained")
            there = [(path, node_at(overlay.source.root, path)) for path in made]
            given = [(path, 1) for path, node in there if node is not None and "%" not in str(node.value)]
            yield Figure(f"{part.name}.inertia", Law(uniform=part.inertia_tolerance), tuple(given), 0)
        if not part.stiffness_tolerance:
            continue
        paths = [(path, -1 if path[-1] == "flexibility" else 1) for path in stiffness_paths(overlay, part)]
        if paths:
            law = Law(uniform=part.stiffness_tolerance)
            yield Figure(f"{part.name}.{'flexibility' if paths[0][1] < 0 else 'stiffness'}", law, tuple(paths), 0)


def _in_columns(
    figures: Iterable[Figure], together: Sequence[Sequence[str]], faults: list[Fault]
) -> Iterator[Figure]:  # fmt: skip
    """Each figure with the column of the samples that it takes."""
    known = {figure.name: figure for figure in figures}
    group: dict[str, int] = {}
    for place, names in enumerate(together):
        path = (*SWEEP, "together", place)
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
                group[name] = place
    columns: dict[object, int] = {}
    for name, figure in known.items():
        yield replace(figure, column=columns.setdefault(group.get(name, name), len(columns)))


def _faults_at_ends(variation: Variation) -> Iterator[Fault]:
    """Figures whose range leaves what the file may say."""
    for place, figure in enumerate(variation.figures):
        ends = np.array([0.0, 1.0]) if figure.law.lognormal is None else ENDS
        for factor in factors(figure.law, ends).tolist():
            chosen = [1.0] * len(variation.figures)
            chosen[place] = factor
            try:
                variation.study(chosen)
            except InputError as error:
                why = error.faults[0]
                message = f"{figure.name} times {factor:.6g}: {why.message}"
                yield Fault((*SWEEP, "vary"), message, why.hint or "a narrower law", at_key=True)
                break
