"""The first page of the site where a browser looks for it: index.html leads to docs/index.html."""

from pathlib import Path

from sphinx.application import Sphinx

PAGE = '<!DOCTYPE html><meta charset="utf-8"><title>torsion</title><meta http-equiv="refresh" content="0; url={0}">'


def setup(app: Sphinx) -> dict[str, bool]:
    """Writes the page when all others are written."""
    app.connect("build-finished", _write)
    return {"parallel_read_safe": True}


def _write(app: Sphinx, failed: Exception | None) -> None:
    if failed is None and app.builder.format == "html":
        target = f"{app.config.root_doc}.html"
        page = PAGE.format(target) + f'<a href="{target}">torsion</a>\n'
        Path(app.outdir, "index.html").write_text(page, encoding="utf-8")
