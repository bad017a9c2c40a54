"""The command of a study: its options, and its page with figures beside it, printed and written."""

import argparse
from collections.abc import Mapping
from pathlib import Path

REPORTS = Path(__file__).parents[1] / "reports"


def options(about: str | None, page: str, quick: str = "") -> argparse.ArgumentParser:
    """--out, and --quick where `quick` says what it does; `page` is the name of the page in reports/."""
    parser = argparse.ArgumentParser(description=about)
    if quick:
        parser.add_argument("--quick", action="store_true", help=f"{quick}, nothing written unless --out")
    parser.add_argument("--out", type=Path, help=f"the page to write (default: reports/{page})")
    parser.set_defaults(page=page)
    return parser


def publish(text: str, chosen: argparse.Namespace, figures: Mapping[str, str] | None = None) -> None:
    """Prints the page, and writes it and its figures (SVG by file name) unless the run is quick and has no --out."""
    print(text)
    target: Path | None = chosen.out or (None if getattr(chosen, "quick", False) else REPORTS / chosen.page)
    if target:
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(text, encoding="utf-8")
        for name, svg in (figures or {}).items():
            (target.parent / name).write_text(svg, encoding="utf-8")
