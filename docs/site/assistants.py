"""llms.txt at the root of the site, for assistants: conventions, exit statuses, recipes, then one line a page."""

import re
from pathlib import Path

from docutils import nodes
from sphinx.application import Sphinx

HEAD = """\
# torsion

> Torsional vibration analysis of shaft trains: one YAML file in, a report for the class society out.

## Conventions

- Write units: `12 kN*m/rad`, `1500 rpm`, `60 mm`. A number without a unit is in SI units; a speed needs its unit.
- An amplitude is zero to peak. The amplitude of a total is half of its peak-to-peak value.
- An order counts the revolutions of the component that is excited. `blade_order: 1` is blades × its speed.
- `ratio` of a gear is driving speed / driven speed. `teeth: [23, 71]` states the driving wheel first.
- Points carry inertia, links join them; `train` lists both in the order of the drawing.
- A torque in % is a share of the mean torque at its station. `psi` = 2π × `loss_factor`.
- The verdict is PASS, PASS with restrictions, FAIL or NOT JUDGED. The program ignores no key: it rejects unknown keys.

## Exit statuses

- 0: solved, PASS or PASS with restrictions, or no rule is requested.
- 1: solved, FAIL or NOT JUDGED. `compare`: something changed. `check`: a model exceeds the tolerance.
- 2: input error; the message has file, line and column.
- 3: not solved to the promised accuracy, in total or in part.
"""


def setup(app: Sphinx) -> dict[str, bool]:
    """Write the list after all pages; a page that was read is not read again for its first sentence."""
    openings = dict[str, str]()
    app.connect("doctree-read", lambda app, tree: openings.update({app.env.docname: opening(tree)}))
    app.connect("build-finished", lambda app, failed: _write(app, failed, openings))
    return {"parallel_read_safe": True}


def _write(app: Sphinx, failed: Exception | None, openings: dict[str, str]) -> None:
    if failed is None and app.builder.format == "html":
        titles = {page: title.astext() for page, title in app.env.titles.items()}
        entries = {}
        for page, title in titles.items():
            if page not in openings:  # of an earlier build, or read by another process
                openings[page] = opening(app.env.get_doctree(page))
            entries[page] = entry(page, title, openings[page])
        Path(app.outdir, "llms.txt").write_text(list_pages(entries), encoding="utf-8")


def opening(doctree: nodes.document) -> str:
    """Return the first paragraph of a page."""
    return next((found.astext() for found in doctree.findall(nodes.paragraph)), "")


def entry(page: str, title: str, paragraph: str) -> str:
    """Return title, address and first sentence of a page."""
    sentence = re.split(
        r"(?<=[.:!?]) (?=[A-Z])", re.sub(r"^(?:When|Task): ", "", " ".join(paragraph.split()))
    )[0]
    return f"- [{title}]({page}.html): {sentence}" if sentence else f"- [{title}]({page}.html)"


def list_pages(entries: dict[str, str]) -> str:
    """Return the list: recipes first, then the other pages by address."""
    recipes = [line for page, line in sorted(entries.items()) if page.startswith("docs/recipes/")]
    others = [
        line for page, line in sorted(entries.items()) if not page.startswith("docs/recipes/")
    ]
    return "\n".join([HEAD, "## Recipes", "", *recipes, "", "## Pages", "", *others]) + "\n"
