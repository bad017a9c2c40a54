"""What the report of every scene says, block by block in digests: `python -m tests.contracts.frozen` writes them anew.

They prove nothing: that a number is right is shown elsewhere, by closed forms. They name the block that has changed.
"""

import hashlib
import io
import json
import re
from collections.abc import Iterable, Mapping
from dataclasses import asdict, is_dataclass
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console

from torsion.output.blocks import Heading
from torsion.output.document import Document
from torsion.output.figures.figure import Figure
from torsion.output.renderers import OUTPUTS

ROOT = Path(__file__).parents[2]
DIGITS = 6  # of a figure's or a file's numbers, of the largest in their list
NOTHING = 1e-10  # a list of smaller numbers alone is rounding
LEFT_OUT = {  # chapters and keys that hold times or versions, or digits of an iteration that ends where it may
    "what was computed", "comparison of the models", "frequencies and shapes", "response torques",
    "exact periodic response", "plan", "program", "check", "periodic", "stability_map", "motion over time",
    "nonlinear peaks", "transient", "nonlinear_peaks",
}  # fmt: skip
NOISE = re.compile(r"[−-]?[\d.]+(·10⁻|e-)(¹[⁰¹²³⁴⁵⁶⁷⁸⁹]|²[⁰¹²³⁴⁵⁶⁷⁸⁹]|[12]\d)")  # 3.1·10⁻¹⁷: rounding, none of a train


def digest(value: Any) -> str:
    """Of texts, numbers and lists of them, rounded."""
    return hashlib.sha256(json.dumps(_rounded(value)).encode()).hexdigest()[:6]


def _rounded(value: Any) -> Any:
    if isinstance(value, str):
        return NOISE.sub("~0", value)
    if value is None or isinstance(value, bool | int):
        return value
    if is_dataclass(value):
        value = vars(value) if hasattr(value, "__dict__") else asdict(value)
    if isinstance(value, Mapping):
        return {str(key): _rounded(value[key]) for key in sorted(value, key=str)}
    try:
        array = np.array(value, dtype=complex if np.iscomplexobj(value) else float)
    except (TypeError, ValueError):
        return [_rounded(one) for one in value] if isinstance(value, Iterable) else type(value).__name__
    pairs = array.view(float) if array.ndim and array.dtype == complex else np.atleast_1d(array).astype(float)
    largest = float(np.max(np.abs(pairs), where=np.isfinite(pairs), initial=0.0))
    if largest < NOTHING:
        return [pairs.size]
    near = np.round(pairs / largest * 10.0**DIGITS).astype(float) + 0.0
    return [f"{largest:.{DIGITS}g}", np.nan_to_num(near).tolist()]


def of_pages(whole: Document, every: dict[str, Any]) -> dict[str, dict[str, str]]:
    """Digests by chapter of the report and name of the block, of the terminal's texts, and of the keys of the JSON."""
    found, chapter = dict[str, dict[str, str]](), ""
    for item in whole.body:
        block = item.block
        chapter = block.text if isinstance(block, Heading) else chapter
        if chapter.lower() not in LEFT_OUT:
            blocks = found.setdefault(chapter, {})
            name = getattr(block, "caption", "") or type(block).__name__
            blocks[f"{len(blocks)} {name}"] = digest(block.panels if isinstance(block, Figure) else asdict(block))
    if every["check"] is None:
        found["terminal"] = {"all": digest(terminal(whole))}
    made = _kept(every)
    made["cases"] = {name: _kept(one) for name, one in made["cases"].items()}
    return found | {"results.json": {key: digest(one) for key, one in made.items()}}


def _kept(made: dict[str, Any]) -> dict[str, Any]:
    return {key: one for key, one in made.items() if key not in LEFT_OUT}


def terminal(whole: Document) -> list[str]:
    """The lines on a wide terminal."""
    console = Console(file=io.StringIO(), width=200, color_system="truecolor", force_terminal=True)
    for item in OUTPUTS["terminal"](whole):
        console.print(item)
    return console.file.getvalue().splitlines()  # type: ignore[attr-defined]


def packed(pages: dict[str, dict[str, str]]) -> dict[str, str]:
    """The digests alone, in a row by chapter."""
    return {chapter: " ".join(blocks.values()) for chapter, blocks in pages.items()}
