"""Pages that lead to another one: index.html to docs/index.html, and each old address to its page (`moved_pages`)."""

from os.path import relpath
from pathlib import Path

from sphinx.application import Sphinx

PAGE = '<!DOCTYPE html><meta charset="utf-8"><title>torsion</title><meta http-equiv="refresh" content="0; url={0}">'


def setup(app: Sphinx) -> dict[str, bool]:
    """Write these pages after all others."""
    app.add_config_value("moved_pages", {}, "html")  # old name: new name, both below docs/
    app.connect("build-finished", _write)
    return {"parallel_read_safe": True}


def _write(app: Sphinx, failed: Exception | None) -> None:
    if failed is None and app.builder.format == "html":
        _lead(app, "index", app.config.root_doc)
        for old, new in app.config.moved_pages.items():
            _lead(app, f"docs/{old}", f"docs/{new}")


def _lead(app: Sphinx, old: str, new: str) -> None:
    page = Path(app.outdir, f"{old}.html")
    target = relpath(Path(app.outdir, f"{new}.html"), page.parent).replace("\\", "/")
    page.write_text(f'{PAGE.format(target)}<a href="{target}">torsion</a>\n', encoding="utf-8")
