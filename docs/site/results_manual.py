"""The manual of the results, as Markdown pages, from the declarations that every output reads.

`python -m docs.site.results_manual` writes the pages to docs/reference/results.
"""

import sys
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path

from docs.site.model_file_manual import toctree, write_pages

from torsion.analyses import ANALYSES
from torsion.findings import Plan, UsedSource
from torsion.output.stored import stored_report
from torsion.output.stored.results_json import LEGEND, LISTED
from torsion.output.stored.scene import Scene, SpanRow, StationRow
from torsion.results import is_list, parts, quantities
from torsion.rules.verdict_line import Checks

FOLDER = "docs/reference/results"
FEW = 4  # keys or fewer: a section of the index, not a page
HEAD = """# results.json: keys, units and axes (format 1)

`torsion solve` writes `results.json` next to the report; `--json` prints it.

- Every number is finite or `null`. A result that was not requested is `null` or an empty list.
- Format 1 may gain keys. The meaning of a key does not change.
- `[]` in a key means every element of a list. Axes belong to the nested lists, from the outermost to the innermost.
- These pages are generated from the declarations: `python -m docs.site.results_manual`.

## Conventions
"""
POSITIONS = {
    "named station": "positions in `stations` of the angles reported: those of the stations that the train names",
    "end span": "positions in `spans` of the torques reported: of an element its first and last",
    "element": "names of the elements; of each its largest span is reported",
}


@dataclass(frozen=True)
class Key:
    """A key of the results; `[]` in its path is every element of a list."""

    path: str
    unit: str
    axes: tuple[str, ...]  # of the nested lists that stand there
    meaning: str


FIXED = (
    Key("format", "", (), "number of this format; a later one may change the meaning of keys"),
    Key("program.name", "", (), "torsion"),
    Key("program.version", "", (), "version of the program"),
    Key("legend", "", (), "conventions in words"),
    Key(
        stored_report.FILES,
        "",
        (),
        "only in files: names of the files of the report, this one among them",
    ),
    Key(
        stored_report.KEY,
        "",
        (),
        "only in files: the report, from which `torsion report` draws it again",
    ),
)

CASES = Key(
    "cases",
    "",
    (),
    "of every case by its name all keys of this list but `cases` and those above; a case without an "
    "answer has `plan` alone, which says why; {} where the file states no case",
)


def pages() -> dict[str, str]:
    """Return the text of every page by its path in `FOLDER`: an index, and one page for every long top-level key."""
    groups = {name: list(keys) for name, keys in groupby(documented(), key=_top_level)}
    long = {name: keys for name, keys in groups.items() if len(keys) > FEW}
    conventions = "".join(
        f"- {name.replace('_', ' ')}: {words}\n" for name, words in LEGEND.items()
    )
    sections = [
        f"\n## `{name}`\n\n{_table(keys)}" for name, keys in groups.items() if name not in long
    ]
    texts = {
        f"{name}.md": f"# `{name}` in results.json\n\n{_table(keys)}" for name, keys in long.items()
    }
    index = f"{HEAD}\n{conventions}\n## Results with a page\n\n{toctree(long)}{''.join(sections)}"
    return {"index.md": index, **texts}


def _top_level(key: Key) -> str:
    return key.path.partition(".")[0].removesuffix("[]")


def _table(keys: list[Key]) -> str:
    rows = ["| key | unit | axes | meaning |", "|---|---|---|---|"]
    for key in keys:
        cells = (f"`{key.path}`", key.unit, ", ".join(key.axes), key.meaning)
        rows.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
    return "\n".join(rows) + "\n"


def documented() -> tuple[Key, ...]:
    """Return every key of the results, as the manual of results lists them."""
    kinds = {
        name: analysis.imported(word)
        for analysis in ANALYSES.values()
        for name, word in analysis.results.items()
    }
    head = {"scene": Scene, "stations[]": StationRow, "spans[]": SpanRow}
    all_kinds = head | kinds | {"checks": Checks, "plan": Plan, "sources[]": UsedSource}
    return (
        *FIXED,
        CASES,
        *(key for path, kind in all_kinds.items() for key in _keys(kind, path, ())),
    )


def _keys(kind: type, path: str, above: tuple[type, ...]) -> Iterator[Key]:
    """Yield the keys of a result under a path `modes` or `checks[]`; `above` are the results that it is part of."""
    declared = quantities(kind)
    records = {quantity.axes[0]: quantity for quantity in declared if quantity.record is not None}
    shown = {axis for quantity in declared for axis in quantity.printed}
    for axis, name in LISTED.items():
        if axis in shown:
            yield Key(f"{path}.{name}", "", (axis,), POSITIONS[axis])
    for quantity in declared:
        inner = parts(kind, quantity)
        record = next(
            (axis for axis in quantity.axes if axis in records and records[axis] is not quantity),
            None,
        )
        full_path = path if record is None else f"{path}.{records[record].key}[]"
        full_path = f"{full_path}.{quantity.key}" if quantity.key else full_path
        full_path = (
            f"{full_path}[]"
            if (inner is not None and is_list(kind, quantity)) or quantity.record
            else full_path
        )
        if inner is None or inner in above:
            axes = tuple(shown for shown in quantity.printed if shown not in records)
            key = f"{full_path}.{quantity.record}" if quantity.record else full_path
            yield Key(key, quantity.unit, axes, quantity.meaning)
        else:
            yield from _keys(inner, full_path, (*above, kind, inner))


if __name__ == "__main__":
    write_pages(Path(*sys.argv[1:] or [FOLDER]), pages())
