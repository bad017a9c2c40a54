"""Style and script of a report's page, from their files; nothing else is imported here."""

import re
from pathlib import Path

TEMPLATES = Path(__file__).parent / "templates"
SCRIPTS = tuple(
    f"report_{part}.js" for part in ("numbers", "plots", "cursor", "input", "modes", "page")
)


def style() -> str:
    """Return the style of the page on a screen and on paper, and of its drawings on a dark screen."""
    return f"{template_text('report.css')}\n{template_text('report_dark.css')}"


def script() -> str:
    """Return the scripts of the page in one text, without indents."""
    return "\n".join(re.sub(r"\n\s+", "\n", template_text(name)) for name in SCRIPTS)


def template_text(name: str, folder: Path = TEMPLATES) -> str:
    """Return the text of a file of the page without the blank space around it."""
    return (folder / name).read_text(encoding="utf-8").strip()
