"""The navigation beside a page: every chapter, and of its own chapter all pages; a whole tree on each page is slow."""

from typing import Any

from sphinx.application import Sphinx


def setup(app: Sphinx) -> dict[str, bool]:
    """Collapse the chapters before the theme reads the tree."""
    app.connect("html-page-context", _collapse, priority=400)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def _collapse(app: Sphinx, page: str, template: str, context: dict[str, Any], _: object) -> None:
    if "toctree" in context:
        whole = context["toctree"]
        context["toctree"] = lambda **options: whole(**{**options, "collapse": True})
