"""Style and script of a report's page, from their files; nothing else is imported here."""

import re
from pathlib import Path

TEMPLATES = Path(__file__).parent / "templates"
SCRIPTS = tuple(
    f"report_{part}.js" for part in ("numbers", "plots", "cursor", "input", "modes", "page")
)


def style() -> str:
    """Of the page on a screen and on paper."""
    return _text("report.css")


def script() -> str:
    """All of it, without indents."""
    return "\n".join(re.sub(r"\n\s+", "\n", _text(name)) for name in SCRIPTS)


def _text(name: str) -> str:
    return (TEMPLATES / name).read_text(encoding="utf-8").strip()
