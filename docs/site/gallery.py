"""The gallery, solved as the site is built: full reports of some examples; sketch, one figure and verdict of each."""

import contextlib
import logging
import re
import shutil
from collections.abc import Iterator
from html import escape
from pathlib import Path

from sphinx.application import Sphinx
from sphinx.util.display import status_iterator

import torsion
from torsion.findings import Findings
from torsion.output.report_figures import ReportFigure
from torsion.output.write import write
from torsion.rules.verdict_line import WORDS, Checks, worst_verdict

PAGE, FOLDER = "docs/gallery", "shafting_specs"
ROW = re.compile(r"^\| `(\w+)` \| (.*?) \| (.*?) \|", re.MULTILINE)  # name, source, what it shows
FULL = ("usv", "haixun_06402", "v12_generator_set", "two_stroke_ship", "wind_gearbox", "fan_start")
CHOSEN = (
    "stability-map",
    "waterfall",
    "tilting",
    "stress",
    "torque",
    "motion",
    "sweep-torque",
    "joint-motion",
    "mode-1",
)
FILTER = """
## All examples

<p><label>Filter: <input type="search" id="filter" placeholder="diesel, cardan, transient ..."></label></p>
<script>
document.getElementById("filter").addEventListener("input", (event) => {
  for (const entry of document.querySelectorAll("section section section")) {
    entry.hidden = !entry.textContent.toLowerCase().includes(event.target.value.toLowerCase());
  }
});
</script>
"""


def setup(app: Sphinx) -> dict[str, bool]:
    """Fills the page when it is read; of the first `gallery_most` scenes, 0 for all."""
    app.add_config_value("gallery_most", 0, "env")
    app.connect("source-read", _fill)
    return {"parallel_read_safe": True}


def _fill(app: Sphinx, page: str, source: list[str]) -> None:
    if page == PAGE:
        logging.getLogger("skfem").setLevel(logging.WARNING)
        table = Path(app.srcdir, FOLDER, "README.md").read_text(encoding="utf-8")
        rows = ROW.findall(table)[: app.config.gallery_most or None]
        Path(app.outdir, "scenes").mkdir(parents=True, exist_ok=True)
        subjects = {name: subject for name, _, subject in ROW.findall(table)}
        source[0] += "\n| full report | subject |\n|---|---|\n"
        for name in FULL[: app.config.gallery_most or None]:
            source[0] += f"{_report(app, name)} | {subjects[name]} |\n"
        source[0] += FILTER
        for name, origin, shows in status_iterator(
            rows, "solving examples... ", "brown", len(rows), app.verbosity
        ):
            source[0] += "\n".join(_entry(app, name, origin, shows))


def _report(app: Sphinx, name: str) -> str:
    """Solve an example with its cases, write its full report next to the pages, and return the row that links to it."""
    folder = Path(app.outdir, "full", name)
    with contextlib.chdir(app.srcdir):  # a report names its file as the command would
        findings = torsion.run(torsion.read(f"{FOLDER}/{name}.yaml"))
    write(findings, folder)
    return f'| <a href="../full/{name}/report.html">{escape(findings.study.name)}</a>'


def _entry(app: Sphinx, name: str, origin: str, shows: str) -> Iterator[str]:
    """Markdown of one scene; its drawings and its file go beside the pages."""
    path = next(Path(app.srcdir, FOLDER).rglob(f"{name}.yaml"))
    app.env.note_dependency(str(path))
    findings = torsion.run(torsion.read(path))
    target = Path(app.outdir, "scenes")
    shutil.copy(path, target)
    yield f"\n### {findings.study.name}\n\n{shows[0].upper() + shows[1:]} ({origin}).\n"
    for figure in chosen(torsion.figures(findings)):
        file = target / re.sub(r"[^\w.-]", "-", f"{name}-{figure.name}.svg")
        file.write_text(f'<?xml version="1.0" encoding="UTF-8"?>\n{figure.svg}', encoding="utf-8")
        words = escape(re.sub(r"_\{(\w+)\}", r"\1", figure.caption))
        yield f'<img class="drawing" loading="lazy" src="../scenes/{file.name}" alt="{words}">\n'
    yield f'<p>{escape(verdict(findings))} <a href="../scenes/{path.name}">{path.name}</a></p>\n'


def chosen(figures: dict[str, ReportFigure]) -> Iterator[ReportFigure]:
    """The sketch, and the figure that says most of the train."""
    sketch = figures.get(
        "plant", figures.get("utilisation")
    )  # the cover of a judged train has its sketch
    chosen = (
        figure for start in CHOSEN for name, figure in figures.items() if name.startswith(start)
    )
    yield from filter(None, (sketch, next(chosen, sketch)))


def verdict(findings: Findings) -> str:
    """Return the verdict of all checks, how many have each word, and the highest utilisation."""
    checks = findings.need(Checks)
    if not checks.lines:
        return "No rule is requested."
    used = {check.utilisation: check for check in checks.lines if check.utilisation is not None}
    share, check = max(used.items(), default=(None, None))
    highest = (
        ""
        if check is None
        else f"; highest utilisation {100.0 * share:.3g} %: {check.where} ({check.what})"
    )
    return f"{WORDS[worst_verdict(checks.lines)]}: {checks.counts}{highest}."
