"""The reference of the Python front, written from the docstrings as the site is built."""

import inspect
import re
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import torsion
from torsion.model import KINDS
from torsion.model.component import component_class
from torsion.results import Keyed

if TYPE_CHECKING:
    from sphinx.application import Sphinx

PAGE = "docs/reference/python-api"


def setup(app: "Sphinx") -> dict[str, bool]:
    """Fill the page when it is read."""
    app.connect("source-read", _fill)
    return {"parallel_read_safe": True}


def _fill(app: "Sphinx", page: str, source: list[str]) -> None:
    if page == PAGE:
        source[0] += "\n".join(reference())


def reference() -> Iterator[str]:
    """Yield the lines of the page: functions, classes, components, formulas."""
    public = {name: getattr(torsion, name) for name in torsion.__all__ if name not in KINDS}
    yield "\n## Functions\n"
    for name, value in public.items():
        if inspect.isfunction(value):
            yield from _function(f"torsion.{name}", value)
    yield "\n## Classes\n"
    for name, value in public.items():
        if inspect.isclass(value):
            yield from _class(f"torsion.{name}", value)
    yield from _class("Result", Keyed)
    yield "\n## Components\n\nThe keywords are the keys of the [model file](model-file/index.md).\n"
    yield "| function | component |\n|---|---|"
    for kind in KINDS:
        yield f"| `torsion.{kind}(name, ...)` | {_escaped(_first(component_class(kind)))} |"
    yield "\n## Formulas\n"
    for name in torsion.formulas.__all__:
        yield from _function(f"torsion.formulas.{name}", getattr(torsion.formulas, name))


def _function(name: str, function: Any) -> Iterator[str]:
    prose, mark, examples = (inspect.getdoc(function) or "").partition(">>> ")
    yield f"### {name}\n\n```python\n{name}{_arguments(function)}\n```\n\n{_escaped(prose.strip())}\n"
    if mark:
        yield f"```pycon\n{mark}{examples}\n```\n"


def _class(name: str, kind: type) -> Iterator[str]:
    rows = list(_attributes(kind))
    head = ["| attribute | meaning |\n|---|---|"] if rows else []
    yield "\n".join([f"### {name}\n\n{_escaped(_first(kind))}\n", *head, *rows, ""])


def _attributes(kind: type) -> Iterator[str]:
    """Yield a row for each method and property of a class that is public."""
    for attribute, value in inspect.getmembers_static(kind):
        is_method, is_value = (
            inspect.isfunction(value),
            isinstance(value, property) or hasattr(value, "func"),
        )
        if (is_method or is_value) and not attribute.startswith("_"):
            shown = f"{attribute}{_arguments(value)}" if is_method else attribute
            words = _first(value.func if hasattr(value, "func") else value)
            yield f"| `{shown}` | {_escaped(words)} |"


def _arguments(function: Any) -> str:
    """Return names and defaults of the arguments, without their types."""
    signature = inspect.signature(function)
    bare = [
        p.replace(annotation=p.empty) for p in signature.parameters.values() if p.name != "self"
    ]
    return re.sub(r"<.*?>", "...", str(inspect.Signature(bare)))


def _first(documented: Any) -> str:
    """Return the first sentences of a docstring, up to a blank line."""
    return " ".join((inspect.getdoc(documented) or "").partition("\n\n")[0].split())


def _escaped(text: str) -> str:
    """Return text with the signs of Markdown as they stand; code in backticks stays."""
    return "".join(
        piece if piece.startswith("`") else re.sub(r"([*_<>\[\]|\\])", r"\\\1", piece)
        for piece in re.split(r"(`[^`]*`)", text)
    )
