"""The gallery: behind its introduction every scene, solved as the site is built: sketch, one figure, verdict."""

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
from torsion.output.numbers import number
from torsion.output.report_figures import ReportFigure
from torsion.rules.verdict_line import Check, Checks

PAGE, FOLDER = "docs/gallery", "shafting_specs"
ROW = re.compile(r"^\| `(\w+)` \| (.*?) \| (.*?) \|", re.MULTILINE)  # name, source, what it shows
CHOSEN = (
    "stability-map", "waterfall", "check-modes", "tilting", "stress", "torque", "motion", "sweep-torque", "joint-index",
    "joint-motion", "mode-1",
)  # fmt: skip


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
        for name, origin, shows in status_iterator(rows, "solving scenes... ", "brown", len(rows), app.verbosity):
            source[0] += "\n".join(_entry(app, name, origin, shows))


def _entry(app: Sphinx, name: str, origin: str, shows: str) -> Iterator[str]:
    """Markdown of one scene; its drawings and its file go beside the pages."""
    path = next(Path(app.srcdir, FOLDER).rglob(f"{name}.yaml"))
    app.env.note_dependency(str(path))
    findings = torsion.run(torsion.read(path))
    target = Path(app.outdir, "scenes")
    shutil.copy(path, target)
    yield f"\n## {findings.study.name}\n\n{shows[0].upper() + shows[1:]} ({origin}).\n"
    for figure in chosen(torsion.figures(findings)):
        file = target / re.sub(r"[^\w.-]", "-", f"{name}-{figure.name}.svg")
        file.write_text(f'<?xml version="1.0" encoding="UTF-8"?>\n{figure.svg}', encoding="utf-8")
        words = escape(re.sub(r"_\{(\w+)\}", r"\1", figure.caption))
        yield f'<img class="drawing" loading="lazy" src="../scenes/{file.name}" alt="{words}">\n'
    yield f'<p>{escape(verdict(findings))} <a href="../scenes/{path.name}">{path.name}</a></p>\n'


def chosen(figures: dict[str, ReportFigure]) -> Iterator[ReportFigure]:
    """The sketch, and the figure that says most of the train."""
    yield figures["plant"]
    yield next((one for start in CHOSEN for name, one in figures.items() if name.startswith(start)), figures["plant"])


def verdict(findings: Findings) -> str:
    """One line."""
    checks = findings.need(Checks).lines
    if not checks:
        return "No rule is requested."
    counts = {word: sum(one.verdict == word for one in checks) for word in ("fail", "not kept", "outside", "pass")}
    words = ", ".join(f"{count} {word}" for word, count in counts.items() if count)
    return f"Verdict of {len(checks)} checks: {words}{_worst(checks)}."


def _worst(checks: tuple[Check, ...]) -> str:
    """The check that uses most of its limit."""
    used = {one.utilisation: one for one in checks if one.utilisation is not None}
    if not used:
        return ""
    share, check = max(used.items())
    return f"; {number(100.0 * share, 3)} % of the limit used by {check.where} ({check.what})"
