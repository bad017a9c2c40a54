"""The picture on the cover: read, checked, and as a data URI, so that a page holds it."""

from base64 import b64encode
from pathlib import Path

from torsion.errors import Fault, InputError
from torsion.user_files import read_file

MOST = 300_000  # bytes: it stands in the page and in results.json
PLACE = ("document", "logo")
FORMS = (  # how each begins and ends, and what may follow
    ("png", b"\x89PNG\r\n\x1a\n", b"IEND\xaeB`\x82", b""),
    ("jpeg", b"\xff\xd8\xff", b"\xff\xd9", b"\0"),
)


def read_logo(file: Path) -> str:
    """The data URI; raises InputError where the file is missing, too large, damaged, or of another form."""
    try:
        content = read_file(file, MOST)
    except FileNotFoundError:
        raise _refused(f"{file} is not there", "a PNG or JPEG file") from None
    except (OSError, ValueError) as error:
        hint = "a PNG or JPEG file: it stands in every page that is made"
        raise _refused(
            f"{file} cannot be read: {getattr(error, 'strerror', None) or error}", hint
        ) from None
    for kind, begins, ends, padding in FORMS:
        if content.startswith(begins):
            if content.rstrip(padding).endswith(ends):
                return f"data:image/{kind};base64,{b64encode(content).decode()}"
            raise _refused(f"{file} is a damaged {kind.upper()} file", "save it again")
    raise _refused(f"{file} is not a readable picture", "a PNG or JPEG file, with its marks")


def _refused(message: str, hint: str) -> InputError:
    return InputError([Fault(PLACE, message, hint)])
