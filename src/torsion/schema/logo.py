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
    hint = "a PNG or JPEG file"
    try:
        content = read_file(file, MOST)
    except FileNotFoundError:
        message = "is not there"
    except (OSError, ValueError) as error:
        message = f"cannot be read: {getattr(error, 'strerror', None) or error}"
        hint += ": it stands in every page that is made"
    else:
        message, hint = "is not a readable picture", f"{hint}, with its marks"
        for kind, begins, ends, padding in FORMS:
            if content.startswith(begins):
                if content.rstrip(padding).endswith(ends):
                    return f"data:image/{kind};base64,{b64encode(content).decode()}"
                message, hint = f"is a damaged {kind.upper()} file", "save it again"
    raise InputError([Fault(PLACE, f"{file} {message}", hint)])
