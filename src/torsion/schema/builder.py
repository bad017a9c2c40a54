"""A model file written in Python: components by kind, and a study of them; the text is read as any file is.

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
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from inspect import Parameter, Signature
from typing import Any

import numpy as np

from torsion.errors import refusal
from torsion.model import KINDS, component_class
from torsion.schema.scene_reader import parse
from torsion.schema.yaml_source import in_brackets
from torsion.study import Study

FIRST = ("name", "description", "operation", "materials", "damping")  # sections before the train


@dataclass(frozen=True)
class Entry:
    """An entry of `train`: a kind of component with the keys of the model file."""

    kind: str
    keys: Mapping[str, Any]

    @property
    def text(self) -> str:
        """The line of the model file."""
        return f"- {self.kind}: {in_brackets(plain_value(self.keys))}"

    def __repr__(self) -> str:
        return self.text


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
        fields = component_class(self.kind).model_fields
        names = [
            field.alias or name for name, field in fields.items() if (field.alias or name) != "name"
        ]
        keys = [name for name in names if name.isidentifier() and not keyword.iskeyword(name)]
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
    begin = [f"{key}: {in_brackets(plain_value(given[key]))}" for key in FIRST if key in given]
    sections_after = [
        f"{key}: {in_brackets(plain_value(value))}"
        for key, value in given.items()
        if key not in FIRST
    ]
    return parse(
        "\n".join([*begin, "train:", *(entry.text for entry in train), *sections_after]) + "\n"
    )


def __getattr__(kind: str) -> Constructor:
    """Return the constructor of a kind of component: `disc`, `coupling`, ..."""
    if kind not in KINDS:
        raise AttributeError(kind)
    return Constructor(kind)
