"""The train of all variants of a file at once: its declarations with columns where a parameter varies, lowered."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path as FilePath
from typing import Any

import numpy as np

from torsion.arrays import FloatArray
from torsion.columns import Column, NotInColumns, copied, field_names, joined, opened
from torsion.errors import Fault, Path, Refusal
from torsion.fields import Amount, Declared
from torsion.model import KINDS
from torsion.model.component import Material
from torsion.model.machine_torques import Excitation
from torsion.schema.declaration_reader import declared, one_component
from torsion.schema.variants.overlay import Overlay
from torsion.schema.variants.varied_figures import Figure
from torsion.study import Study
from torsion.train import Link, Train, lowered
from torsion.user_files import Source

SECTIONS = {name: name for name in ("links", "excitations", "materials")} | {"train": "components"}
Operation = Callable[[Any], Any]
Pieces = tuple[
    Path, Declared, list[Declared]
]  # of one figure: path, as it stands, each alternative


def train_in_columns(
    study: Study,
    source: Source,
    declarations: Mapping[str, Any],
    pieces: dict[str, Pieces],
    figures: Sequence[Figure],
    values: FloatArray,
) -> Train:
    """Lower the declarations of a file with columns for the values (variants, figures) of what varies.

    pieces: alternatives that were read before, by the name of their figure; new ones are added. Raises NotInColumns if
    a component takes no column, or the variants have not one layout.
    """
    train = study.train
    if train.steps != "none" or train.has_steps or train.has_meshed_sections or train.follows_speed:
        raise NotInColumns(
            "steps of shafts, meshed sections and a stiffness over speed follow the lowering"
        )
    changed, touched = dict(declarations), set[Path]()
    try:
        for figure, column in sorted(
            zip(figures, values.T, strict=True), key=lambda pair: pair[0].stage
        ):
            takes_place = bool(figure.rows) or figure.law.first is not None
            if takes_place and figure.name not in pieces:
                pieces[figure.name] = _read_alternatives(figure, study, source)
            own_pieces = pieces[figure.name] if takes_place else None
            for path, operation in _changes(figure, column, own_pieces, touched):
                if path[0] not in SECTIONS:
                    raise NotInColumns(f"`{path[0]}` is no part of the train")
                section = SECTIONS[str(path[0])]
                changed[section] = with_change(changed[section], path[1:], operation)
        for section in SECTIONS.values():
            _refuse_clashes(declarations[section], changed[section])
        reference, folder = study.operation.at, str(FilePath(source.name).parent)
        lowered_train, faults = lowered(**changed, reference=reference, folder=folder)
    except (TypeError, AttributeError, Refusal) as error:
        raise NotInColumns(str(error)) from error
    if lowered_train is None or faults:
        raise NotInColumns("; ".join(fault.message for fault in faults))
    return replace(lowered_train, modal_damping=train.modal_damping, steps=train.steps)


def with_change(item: Any, path: Path, operation: Operation) -> Any:
    """Return a declaration, or a tuple or mapping of them, with `operation` applied to what stands at a path."""
    if not path:
        return operation(item)
    step, deeper = path[0], path[1:]
    if isinstance(item, Link):
        # The path has the kind of the component between the link and its key.
        return replace(item, component=with_change(item.component, deeper, operation))
    items, make = opened(item)
    if isinstance(item, Declared):
        fields = type(item).model_fields.items()
        step = next((name for name, field in fields if step == field.alias), step)
    if step not in items:
        raise NotInColumns(f"no declaration has the key `{step}`")
    if isinstance(item, tuple) and deeper and deeper[0] == getattr(items[step], "keyword", None):
        deeper = deeper[1:]
    return make({step: with_change(items[step], deeper, operation)})


def _changes(
    figure: Figure, column: FloatArray, pieces: Pieces | None, touched: set[Path]
) -> Iterator[tuple[Path, Operation]]:
    """Yield where a parameter changes the declarations, and how; `touched`: fields that have changed already.

    pieces: of values in place of the file's; None for factors of what the file gives.
    """
    if pieces is None:
        for path, power in figure.paths:
            factor = Column(column if power > 0 else 1.0 / column)
            touched.add(path[: len(piece_path(path)) + 1])
            yield path, partial(multiplied, factor=factor)
        return
    if figure.rows and figure.layer:
        raise NotInColumns("a list varies what another parameter puts into the file")
    path, original, alternatives = pieces
    low, high = (0.0, 1.0) if figure.rows else figure.law.ends
    share = (column - low) / (high - low)

    combine = (
        (lambda numbers: numbers[column.astype(np.intp)])
        if figure.rows
        else (lambda numbers: np.asarray(numbers[0] + share * (numbers[1] - numbers[0])))
    )
    fields = {
        name: joined([getattr(piece, name) for piece in alternatives], combine)
        for name in field_names(type(original))
        if name not in ("source", "note")
        and any(getattr(piece, name) != getattr(original, name) for piece in alternatives)
    }
    paths = {(*path, name) for name in fields}
    if paths & touched:
        raise NotInColumns("two parameters vary items of one key")
    touched |= paths
    yield path, lambda item: copied(item, **fields)


def _read_alternatives(figure: Figure, study: Study, source: Source) -> Pieces:
    """Read the declaration that a parameter is in, as it stands, with each row of a list, or both ends of a range."""
    path: Path = ()
    sources = [source]
    for value in range(len(figure.rows)) if figure.rows else figure.law.ends:
        overlay = Overlay(source, study)
        for put_path, node in figure.puts(float(value), source):
            if path not in ((), piece_path(put_path)):
                raise NotInColumns("one parameter varies several components")
            path = piece_path(put_path)
            overlay.put(put_path, node)
        sources.append(overlay.applied())
    pieces = list[Declared]()
    for changed in sources:
        stated, faults = changed.at(path), list[Fault]()
        body = None if stated is None else stated.value
        if path[0] in ("materials", "excitations"):
            kind: type[Declared] = Material if path[0] == "materials" else Excitation
            piece: Declared | None = declared(kind, body, path, faults)
        else:
            piece = one_component(str(path[-1]), body, path, faults)
        if piece is None or faults:
            raise NotInColumns("an alternative is at fault")
        pieces.append(piece)
    return path, pieces[0], pieces[1:]


def piece_path(path: Path) -> Path:
    """Return the path of the component, material or excitation in which a path lies.

    >>> piece_path(("train", 2, "branch", 0, "disc", "inertia"))
    ('train', 2, 'branch', 0, 'disc')
    """
    if path[0] in ("materials", "excitations"):
        return path[:2]
    kinds = (
        k for k in range(len(path) - 1, 0, -1) if path[k] in KINDS and isinstance(path[k - 1], int)
    )
    return path[: next(kinds, 0) + 1]


def multiplied(item: Any, factor: Column) -> Any:
    """Return a number of a declaration, or the numbers of a tuple, times a column."""
    if isinstance(item, tuple):
        return tuple(multiplied(number, factor) for number in item)
    if isinstance(item, Amount):
        return Amount(item.torque * factor, item.of_mean * factor)
    if not isinstance(item, float | Column):
        raise NotInColumns("an order, a ratio and a number of teeth belong to the layout")
    return item * factor


def _refuse_clashes(before: Any, after: Any) -> None:
    """Refuse changed declarations whose values do not go together, as their reading does."""
    if after is before:
        return
    if isinstance(after, Declared):
        after.refuse_clashes()
    items = opened(before)[0]
    for name, item in opened(after)[0].items():
        _refuse_clashes(items.get(name), item)
