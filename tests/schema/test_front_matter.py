"""The front matter of a submission: IMO numbers by their check digit, texts of one line, and the file of a logo."""

import struct
import zlib
from base64 import b64decode
from pathlib import Path

import pytest
from tests.for_all import for_all

import torsion
from torsion.schema.logo import MOST

SCENE = "name: two discs\ndocument: {%s}\ntrain: [disc: {inertia: 2}, coupling: {stiffness: 120}, disc: {inertia: 3}]\n"


def chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


PNG = b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 1, 1, 8, 0, 0, 0, 0))
PNG += chunk(b"IDAT", zlib.compress(b"\0\0")) + chunk(b"IEND", b"")


def faults(text: str, file: Path | None = None) -> str:
    """What is wrong with a front matter."""
    with pytest.raises(torsion.InputError) as refused:
        torsion.parse(SCENE % text, str(file or "scene.yaml"))
    return str(refused.value)


@pytest.mark.parametrize(
    "number", [9074729, 9241061, 9811000, 9321483, "IMO 9074729", "IMO9241061"]
)
def test_the_imo_numbers_of_ships_that_sail_are_taken(number: int | str) -> None:
    """Queen Mary 2, Ever Given, Emma Maersk; 9074729 is the example that is worked in the literature."""
    found = torsion.parse(SCENE % f"imo_number: {number}").document
    assert found is not None
    assert found.imo_number == str(number)[-7:]


@for_all("last", range(10))
def test_of_ten_last_digits_one_is_right(last: int) -> None:
    """9 * 7 + 0 * 6 + 7 * 5 + 4 * 4 + 7 * 3 + 2 * 2 = 139."""
    if last == 9:
        assert torsion.parse(SCENE % "imo_number: 9074729").document
    else:
        assert "after 907472 it is 9" in faults(f"imo_number: 907472{last}")


@for_all(
    "text",
    [
        "907472",
        "90747290",
        "true",
        "9074729.5",
        "IMO",
        "'90747 29'",
        "[9074729]",
        "'٩٠٧٤٧٢٩'",
        "'0000000'",
        "0000000",
        "0x8A77F9",
        "0o42474771",
    ],
)
def test_what_is_no_imo_number_is_refused_at_its_place(text: str) -> None:
    assert "scene.yaml:2:24: " in faults(f"imo_number: {text}")


@for_all(
    ("text", "words"),
    [
        ("vesel: a", "did you mean `vessel`"),
        ("revision: 2", "2 is not text (put it in quotes)"),
        ("vessel: ' '", "is empty"),
        ('vessel: "a\\nb"', "not on one line"),
        (f"yard: {'a' * 101}", "too long: 101 characters (at most 100)"),
        (f"document_number: {'a' * 51}", "too long: 51 characters (at most 50)"),
        ("logo: a, vessel: 5", "5 is not text"),
    ],
)
def test_a_faulty_text_is_refused(text: str, words: str) -> None:
    assert words in faults(text)


@pytest.mark.parametrize(
    ("content", "kind"),
    [(PNG, "png"), (b"\xff\xd8\xff\xe0abc\xff\xd9", "jpeg")],
    ids=lambda v: str(v)[:6],
)
def test_a_logo_is_found_beside_the_scene_and_kept_byte_for_byte(
    content: bytes, kind: str, tmp_path: Path
) -> None:
    (tmp_path / "own logo").write_bytes(content)
    (tmp_path / "scene.yaml").write_text(SCENE % "logo: own logo", encoding="utf-8")
    head, _, packed = torsion.read(tmp_path / "scene.yaml").logo.partition(",")
    assert head == f"data:image/{kind};base64"
    assert b64decode(packed) == content


@for_all(
    ("content", "words"),
    [
        (PNG[:-1], "damaged PNG"),
        (PNG[:8], "damaged PNG"),
        (b"\xff\xd8\xffabc", "damaged JPEG"),
        (b"", "not a readable picture"),
        (b"GIF89a", "not a readable picture"),
        (b"<html/>", "not a readable picture"),
        (b"<svg/>", "a PNG or JPEG file"),
        (b"x" * (MOST + 1), "at most 300 kB"),
    ],
)
def test_a_picture_that_is_none_is_refused_at_its_place(
    content: bytes, words: str, tmp_path: Path
) -> None:
    (tmp_path / "logo").write_bytes(content)
    found = faults("logo: logo", tmp_path / "scene.yaml")
    assert words in found
    assert "scene.yaml:2:18: " in found


@pytest.mark.parametrize(
    ("name", "words"), [("none.png", "is not there"), (".", "is a folder"), ("'a\\0b'", "")]
)
def test_a_logo_that_is_not_there_is_refused(name: str, words: str, tmp_path: Path) -> None:
    assert words in faults(f"logo: {name}", tmp_path / "scene.yaml")
