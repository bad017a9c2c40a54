"""The page of `torsion live`, from its files: two frames with the style and script of the report, and sliders."""

import json
from pathlib import Path

from torsion.output.page_files import script, style

FILES = Path(__file__).parent
NOTHING = '{"lengths":[],"names":[],"doubles":"eJwDAAAAAAE="}'  # numbers of a page without figures
POLICY = (  # of the page and, as it has no address of its own, of its frames
    "default-src 'none'; script-src 'nonce-{nonce}'; style-src 'unsafe-inline'; img-src data:; connect-src 'self'; "
    "frame-ancestors 'none'; base-uri 'none'; form-action 'none'"
)


def page() -> str:
    """Return the page, in which `@NONCE@` stands for what its policy allows to run."""
    frame = _filled(
        "frame.html", STYLE=style(), SCRIPT=f"{script()}\n{_text('frame.js')}", NUMBERS=NOTHING
    )
    shell = json.dumps(frame, ensure_ascii=False).replace("<", "\\u003c")
    return _filled(
        "live.html", STYLE=f"{style()}\n{_text('live.css')}", SCRIPT=_text("live.js"), FRAME=shell
    )


def _filled(name: str, **texts: str) -> str:
    """Return the text of a file with `@KEY@` replaced; nothing is replaced in what was put there."""
    first, *parts = _text(name).split("@")
    return first + "".join(
        texts.get(part, f"@{part}@" if position % 2 == 0 else part)
        for position, part in enumerate(parts)
    )


def _text(name: str) -> str:
    return (FILES / name).read_text(encoding="utf-8")
