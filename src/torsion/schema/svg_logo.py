"""What a drawing in SVG needs beyond its own file: pictures, style sheets and programs that no report may need."""

import re
from collections.abc import Iterator
from xml.parsers import expat

from torsion.errors import printable

Need = tuple[int, str]  # its line in the drawing, and what it is
_SVG = "http://www.w3.org/2000/svg"
_URL = re.compile(r"url\(\s*[\"']?([^\"')]*)|@import\s*[\"']([^\"']*)", re.IGNORECASE)
_LINK = re.compile(r"href\s*=\s*[\"']([^\"']*)")  # of an instruction to the reader of XML


class _NotSvgError(Exception):
    """The document is another one, or has entities of its own."""


def needs(content: bytes) -> list[Need] | None:
    """What the drawing needs of other files, and programs in it, by line; None where it is no drawing.

    >>> needs(b'<svg><image href="a.png"/></svg>')
    [(1, "the picture refers to 'a.png'")]
    >>> needs(b"<html/>") is None
    True
    """
    reader = _Reader()
    try:
        reader.parser.Parse(content, True)
    except (expat.ExpatError, _NotSvgError, ValueError, LookupError):
        return None
    return reader.found


class _Reader:
    """Notes every need while the drawing is read."""

    def __init__(self) -> None:
        self.found: list[Need] = []
        self.depth = 0
        self.style: list[str] | None = None  # the text of a style sheet so far
        self.line = 1  # where it begins
        self.parser = expat.ParserCreate(namespace_separator=" ")
        self.parser.StartElementHandler = self.start
        self.parser.EndElementHandler = self.end
        self.parser.CharacterDataHandler = self.text
        self.parser.ProcessingInstructionHandler = self.instruction
        self.parser.EntityDeclHandler = self.entity

    def start(self, tag: str, attributes: dict[str, str]) -> None:
        name = tag.rpartition(" ")[2]
        if not self.depth and tag not in ("svg", f"{_SVG} svg"):
            raise _NotSvgError
        self.depth += 1
        self.line = self.parser.CurrentLineNumber
        if name == "script":
            self.note("the picture holds a script")
        elif name.casefold() == "foreignobject":
            self.note("the picture holds `foreignObject`")
        self.style = [] if name == "style" else self.style
        for key, value in attributes.items():
            plain = key.rpartition(" ")[2].casefold()
            if plain in ("href", "src"):
                self.refer(value)
            elif plain.startswith("on"):
                self.note("the picture holds a script")
            self.refer(*_urls(value))

    def end(self, tag: str) -> None:
        self.depth -= 1
        if tag.rpartition(" ")[2] == "style" and self.style is not None:
            text, self.style = "".join(self.style), None
            for found in _URL.finditer(text):
                self.refer(found[1] or found[2] or "", further=text.count("\n", 0, found.start()))

    def text(self, text: str) -> None:
        if self.style is not None:
            self.style.append(text)

    def instruction(self, target: str, text: str) -> None:
        self.line = self.parser.CurrentLineNumber
        self.refer(*_LINK.findall(text))

    def entity(self, *_: object) -> None:
        raise _NotSvgError

    def refer(self, *targets: str, further: int = 0) -> None:
        """Note what a target names, unless it is in the drawing itself."""
        for target in targets:
            if (place := target.strip()) and not re.match("#|data:", place, re.IGNORECASE):
                self.note(f"the picture refers to '{printable(place)}'", further)

    def note(self, message: str, further: int = 0) -> None:
        self.found.append((self.line + further, message))


def _urls(text: str) -> Iterator[str]:
    return (found[1] or found[2] or "" for found in _URL.finditer(text))
