"""The manual of the results, as Markdown pages, from the declarations that every output reads.

`python -m torsion.output.results_manual` writes the pages to docs/reference/results.
"""

import sys
from itertools import groupby
from pathlib import Path

from torsion.output.results_json import LEGEND, Key, documented
from torsion.schema.manual import toctree, write_pages

FOLDER = "docs/reference/results"
FEW = 4  # keys or fewer: a section of the index, not a page
HEAD = """# results.json: keys, units and axes (format 1)

`torsion solve` writes `results.json` next to the report; `--json` prints it.

- Every number is finite or `null`. A result that was not requested is `null` or an empty list.
- Format 1 may gain keys. The meaning of a key does not change.
- `[]` in a key means every element of a list. Axes belong to the nested lists, from the outermost to the innermost.
- These pages are generated from the declarations: `python -m torsion.output.results_manual`.

## Conventions
"""


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


if __name__ == "__main__":
    write_pages(Path(*sys.argv[1:] or [FOLDER]), pages())
