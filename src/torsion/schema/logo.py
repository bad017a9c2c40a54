"""The picture on the cover: read, checked, and as a data URI, so that a page holds it."""

import re
import zlib
from base64 import b64encode
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

from torsion.errors import Fault, InputError, printable
from torsion.study import Study
from torsion.user_files import read_file

MOST = 300_000  # bytes: it stands in the page and in results.json
PLACE = ("document", "logo")
_URL = re.compile(r"url\(\s*[\"']?([^\"')]*)|@import\s*[\"']([^\"']*)", re.IGNORECASE)
_INSTRUCTION = re.compile(rb"<\?xml-stylesheet[^>]*href\s*=\s*[\"']([^\"']*)")
PNG = b"\x89PNG\r\n\x1a\n"


def read_logo(file: Path) -> str:
    """The data URI; raises InputError where the file is missing, too large, damaged, or of another form."""
    try:
        content = read_file(file, MOST)
    except FileNotFoundError:
        raise _refused(f"{file} is not there", "a PNG, JPEG or SVG file") from None
    except (OSError, ValueError) as error:
        hint = "a PNG, JPEG or SVG file: it stands in every page that is made"
        raise _refused(
            f"{file} cannot be read: {getattr(error, 'strerror', None) or error}", hint
        ) from None
    for kind, begins, is_whole in FORMS:
        if content.startswith(begins):
            if is_whole(content):
                return f"data:image/{kind};base64,{b64encode(content).decode()}"
            if begins:
                raise _refused(f"{file} is a damaged {kind.upper()} file", "save it again")
    raise _refused(f"{file} is not a readable picture", "a PNG, JPEG or SVG file, with its marks")


def with_logo(study: Study, file: str, faults: list[Fault]) -> Study:
    """The study with the picture of a file, found from the folder of its own; a faulty one is noted."""
    try:
        return replace(study, logo=read_logo(Path(study.file).parent / file))
    except InputError as error:
        faults += error.faults
        return study


def _refused(message: str, hint: str) -> InputError:
    return InputError([Fault(PLACE, message, hint)])


def _is_png(content: bytes) -> bool:
    """Every chunk has its checksum, and the last one is there."""
    chunks = content[len(PNG) :]
    while len(chunks) >= 12:
        end = int.from_bytes(chunks[:4], "big") + 8
        if zlib.crc32(chunks[4:end]).to_bytes(4, "big") != chunks[end : end + 4]:
            return False
        if chunks[4:8] == b"IEND":
            return True
        chunks = chunks[end + 4 :]
    return False


def _is_jpeg(content: bytes) -> bool:
    return content.rstrip(b"\0").endswith(b"\xff\xd9")


def _is_svg(content: bytes) -> bool:
    """A drawing without entities of its own; raises InputError where it needs another file or holds a program."""
    if b"<!ENTITY" in content.replace(b"\0", b""):
        return False
    try:
        root = ElementTree.fromstring(content)
    except (ElementTree.ParseError, ValueError, LookupError):
        return False
    if _local(root.tag) != "svg":
        return False
    hint = "a logo is one file: embed its pictures, or save it as PNG"
    references = [link.decode() for link in _INSTRUCTION.findall(content)]
    for element in root.iter():
        if _local(element.tag) in ("script", "foreignobject"):
            raise _refused(f"the picture holds a `{_local(element.tag)}`", hint)
        for key, value in element.items():
            if _local(key).startswith("on"):
                raise _refused("the picture holds a script", hint)
            references += [value] * (_local(key) in ("href", "src")) + _urls(value)
        references += _urls(element.text or "") if _local(element.tag) == "style" else []
    for reference in references:
        if not re.match(r"\s*(#|data:|$)", reference, re.IGNORECASE):
            raise _refused(f"the picture refers to '{printable(reference.strip())}'", hint)
    return True


def _local(name: str) -> str:
    """Return a name without its namespace, in small letters."""
    return name.rpartition("}")[2].casefold()


def _urls(text: str) -> list[str]:
    return [url or imported for url, imported in _URL.findall(text)]


FORMS = (
    ("png", PNG, _is_png),
    ("jpeg", b"\xff\xd8\xff", _is_jpeg),
    ("svg+xml", b"", _is_svg),
)  # how each begins
