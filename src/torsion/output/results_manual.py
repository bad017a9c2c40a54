"""The manual of the results, as Markdown, from the declarations that every output reads."""

from itertools import groupby

from torsion.output.results_json import LEGEND, Key, documented

HEAD = """# The results: results.json, format 1

Written beside the report by `torsion solve`, printed by `--json`. Every number is finite or `null`. Format 1 may gain
keys; a key that is there keeps its meaning. `[]` in a key stands for every element of a list; axes are those of the
nested lists that stand there, from the outermost on. What was not requested is `null` or an empty list.

This page is generated: `python -m torsion.output.results_manual > docs/results.md`.

## Conventions
"""


def manual() -> str:
    """The page."""
    conventions = "".join(f"- {name.replace('_', ' ')}: {words}\n" for name, words in LEGEND.items())
    sections = [
        f"\n## `{name}`\n\n" + _table(list(rows))
        for name, rows in groupby(documented(), key=lambda key: key.path.partition(".")[0].removesuffix("[]"))
    ]
    return HEAD + "\n" + conventions + "".join(sections)


def _table(keys: list[Key]) -> str:
    rows = ["| key | unit | axes | meaning |", "|---|---|---|---|"]
    for key in keys:
        cells = (f"`{key.path}`", key.unit, ", ".join(key.axes), key.meaning)
        rows.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
    return "\n".join(rows) + "\n"


if __name__ == "__main__":
    print(manual(), end="")
