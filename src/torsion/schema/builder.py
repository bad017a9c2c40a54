"""A model file written in Python: components by kind, a study of them, or of a file with other values.

The text is read as any file is.

>>> disc, coupling = Constructor("disc"), Constructor("coupling")
>>> study = build("Two discs", [disc("first", inertia=2), coupling("spring", stiffness="120 N*m/rad"), disc(inertia=3)])
>>> print(study.text)
name: Two discs
train:
- disc: {name: first, inertia: 2}
- coupling: {name: spring, stiffness: 120 N*m/rad}
- disc: {inertia: 3}
<BLANKLINE>
"""

import keyword
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from inspect import Parameter, Signature
from typing import Any

import numpy as np

from torsion.errors import Fault, refusal
from torsion.model import KINDS
from torsion.model.component import component_class
from torsion.schema.declaration_reader import declared, keys_of
from torsion.schema.edited_text import edited
from torsion.schema.fault_text import input_error
from torsion.schema.scene_reader import parse, reread
from torsion.schema.variants.cases import CaseKeys, change_overlay, merge_changes
from torsion.schema.variants.overlay import Overlay
from torsion.schema.yaml_source import in_brackets, parse_source, yaml_text
from torsion.study import Study

FIRST = ("name", "description", "operation", "materials", "damping")  # sections before the train


@dataclass(frozen=True)
class Entry:
    """An entry of `train`: a kind of component with the keys of the model file."""

    kind: str
    keys: Mapping[str, Any]

    def __repr__(self) -> str:
        """The line of the model file."""
        return f"- {self.kind}: {in_brackets(plain_value(self.keys))}"

    text = property(__repr__)


@dataclass(frozen=True)
class Constructor:
    """Write a component as an entry of `train`; the keywords are the keys of the model file.

    A number is in SI units, a text carries its unit, and a quantity of pint is written with its own.
    """

    kind: str

    def __call__(self, name: str | None = None, /, **keys: Any) -> Entry:
        return Entry(self.kind, keys if name is None else {"name": name, **keys})

    @property
    def __signature__(self) -> Signature:
        """The keys of the kind, for completion."""
        keys = [
            key
            for key in keys_of(component_class(self.kind))
            if key != "name" and key.isidentifier() and not keyword.iskeyword(key)
        ]
        name = Parameter("name", Parameter.POSITIONAL_ONLY, default=None)
        return Signature(
            [
                name,
                *(Parameter(key, Parameter.KEYWORD_ONLY, default=Parameter.empty) for key in keys),
            ]
        )


def plain_value(value: Any) -> Any:
    """Return a value as YAML holds it: entries as mappings, numbers of numpy as those of Python, quantities as text."""
    if isinstance(value, Entry):
        return {value.kind: plain_value(value.keys)}
    if isinstance(value, Mapping):
        return {str(key): plain_value(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain_value(item) for item in value]
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    if hasattr(value, "magnitude") and hasattr(value, "units"):
        return f"{value:~C}"
    if value is None or isinstance(value, str | int | float):
        return value
    raise refusal(
        f"a {type(value).__name__} is no value of a model file",
        "a number, a text, a list or a mapping",
    )


def build(name: str, train: Iterable[Entry], **sections: Any) -> Study:
    """Write a model file of components and of its other sections, and read it; raises InputError.

    sections: those of the file, such as operation, excitations, analyses and rules. The text is `study.text`.
    """
    given = {"name": name, **sections}
    lines = {key: f"{key}: {in_brackets(plain_value(value))}" for key, value in given.items()}
    begin = [lines.pop(key) for key in FIRST if key in lines]
    return parse(
        "\n".join([*begin, "train:", *(entry.text for entry in train), *lines.values()]) + "\n"
    )


def vary(
    study: Study, values: Mapping[str, Any], factors: Mapping[str, Any], removed: Sequence[str]
) -> Study:
    """Return the study of the changed text, without its cases; raises InputError. A value as it stands is no fault."""
    if not study.text:
        raise refusal(
            "the study was not read from a text, so that it has no keys to change", "torsion.build"
        )
    names = [removed] if isinstance(removed, str) else list(removed)
    keys = {"set": plain_value(values), "scale": plain_value(factors), "remove": names}
    case = parse_source(yaml_text({key: value for key, value in keys.items() if value}), "with_")
    faults: list[Fault] = []
    stated = declared(CaseKeys, case.data, (), faults)
    if stated is None or faults:
        raise input_error(faults, case)

    source, _ = reread(study)
    overlay = Overlay(source, study, permits_no_change=True)
    change_overlay(stated, (), case.root, overlay)
    if overlay.faults:
        raise input_error(overlay.faults, case)
    overlay.removed["cases",] = None

    changes = overlay.puts
    text = edited(source, changes, overlay.removed, overlay.applied().data)
    earlier = study.changes if study.case is None else study.case.changes
    changed = parse(text, study.file or "train.yaml")
    return replace(
        changed, changes=merge_changes((*earlier, *overlay.changes)), memory=study.memory
    )


def __getattr__(kind: str) -> Constructor:
    """Return the constructor of a kind of component: `disc`, `coupling`, ..."""
    if kind not in KINDS:
        raise AttributeError(kind)
    return Constructor(kind)
