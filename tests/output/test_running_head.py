"""What cover and running head of a submission say, on every page of the PDF; `browser/` has the page as printed."""

import re
import shutil
import subprocess
from hashlib import sha256
from pathlib import Path

import pytest
from tests.output.conftest import BARE, solved
from tests.schema.test_front_matter import PNG

import torsion
from torsion.output.document import Document, document
from torsion.output.pages.html import html
from torsion.output.pages.pdf import pdf

READER = shutil.which("pdftotext")
FRONT = """document:
  {vessel: "Example <Star>", yard: "Yard #1", imo_number: 9074729, society: 'A "B" \\ C', revision: B,
   document_number: "TVC_{1} 100 %", prepared: "A. & B.", logo: logo.png}
train:"""
needs_reader = pytest.mark.skipif(READER is None, reason="pdftotext is not installed")


@pytest.fixture
def submission(tmp_path: Path) -> Document:
    return submitted(tmp_path)


def submitted(tmp_path: Path) -> Document:
    """A scene with all of a front matter in it."""
    (tmp_path / "logo.png").write_bytes(PNG)
    file = tmp_path / "scene.yaml"
    file.write_text(BARE.replace("train:", FRONT), encoding="utf-8")
    return document(torsion.run(torsion.read(file)))


def pages(file: Path) -> list[str]:
    """The text of every page, in the order in which it is read, each blank as one."""
    assert READER is not None
    done = subprocess.run([READER, "-layout", str(file), "-"], capture_output=True, check=True)
    return [re.sub(r"\s+", " ", page) for page in done.stdout.decode().split("\f")[:-1]]


def every_page_is_marked(found: list[str], made: Document, identity: str) -> None:
    assert len(found) > 1
    for place, page in enumerate(found, 1):
        assert f"Torsional vibration calculation · {identity} " in page
        assert f" {made.cover.origin} · page {place} of {len(found)} " in page


@needs_reader
def test_the_pdf_has_number_revision_origin_and_page_on_every_page(
    submission: Document, tmp_path: Path
) -> None:
    for made, identity in (
        (submission, "TVC_{1} 100 % · revision B"),
        (document(solved(BARE)), "two discs"),
    ):
        (tmp_path / "a.pdf").write_bytes(pdf(made))
        every_page_is_marked(pages(tmp_path / "a.pdf"), made, identity)


@needs_reader
def test_the_cover_has_all_of_the_front_matter_and_lines_to_sign(
    submission: Document, tmp_path: Path
) -> None:
    (tmp_path / "a.pdf").write_bytes(pdf(submission))
    first, page = (
        " ".join(pages(tmp_path / "a.pdf")[:2]),
        html(submission),
    )  # the facts stand behind the first page
    for text in (
        "Example <Star>",
        "Yard #1",
        "9074729",
        'A "B" \\ C',
        "Prepared",
        "A. & B.",
        "Checked",
        "Approved",
    ):
        assert text in first
        assert (
            text.replace("&", "&amp;")
            .replace("<", "&lt;")
            .replace(">", "&gt;")
            .replace('"', "&#34;")
            in page
        )
    assert first.count("date, signature") == page.count("date, signature") == 3
    assert '<img class="logo" alt="" src="data:image/png;base64,' in page
    assert "date, signature" not in html(document(solved(BARE)))


def test_the_origin_is_the_beginning_of_the_checksum_of_the_input(submission: Document) -> None:
    text = BARE.replace("train:", FRONT)
    assert submission.cover.origin == f"input SHA-256 {sha256(text.encode()).hexdigest()[:12]}"


@pytest.mark.parametrize("content", [PNG], ids=["png"])
def test_a_logo_is_set_in_the_pdf(content: bytes, tmp_path: Path) -> None:
    (tmp_path / "logo").write_bytes(content)
    (tmp_path / "scene.yaml").write_text(
        BARE.replace("train:", "document: {logo: logo}\ntrain:"), encoding="utf-8"
    )
    made = document(torsion.run(torsion.read(tmp_path / "scene.yaml")))
    assert pdf(made).startswith(b"%PDF-")
    assert made.cover.identity == made.cover.subtitle


def test_a_logo_that_a_pdf_cannot_show_is_said_at_its_place(tmp_path: Path) -> None:
    """Its marks are those of a JPEG file, and nothing stands between them."""
    (tmp_path / "logo").write_bytes(b"\xff\xd8\xff\xe0abc\xff\xd9")
    file = tmp_path / "scene.yaml"
    file.write_text(BARE.replace("train:", "document: {logo: logo}\ntrain:"), encoding="utf-8")
    with pytest.raises(
        torsion.InputError,
        match=r"scene.yaml:2:18: the pdf cannot be made: this picture cannot be set in a PDF",
    ):
        torsion.solve(file, tmp_path / "out", pdf=True)
