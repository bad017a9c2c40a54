"""What Typst is given to set: texts of the scene are nothing but text to it."""

import json
from pathlib import Path

import pytest
import typst

import torsion
from torsion.output.blocks import (
    Block,
    Column,
    Figure,
    Heading,
    KeyValues,
    Paragraph,
    Points,
    Table,
    Verbatim,
)
from torsion.output.document import Cover, Document, numbered
from torsion.output.pages.pdf import pdf, text, words


def made(*blocks: Block) -> Document:
    cover = Cover("Title", "scene", (("Date", "today"),), "as it is")
    return Document(cover, tuple(numbered(blocks)))


@pytest.fixture
def source(monkeypatch: pytest.MonkeyPatch):
    """The source of a document's PDF behind its style, and the drawings beside it."""

    def of(*blocks: Block) -> tuple[list[str], list[str]]:
        found: dict[str, list[str]] = {}

        def compiled(file: str, root: str) -> bytes:
            written = Path(file).read_text(encoding="utf-8")
            found["lines"] = written[written.index('#cover("Title"') :].splitlines()
            found["drawn"] = sorted(path.name for path in Path(root).glob("*.svg"))
            return b"%PDF-"

        monkeypatch.setattr(typst, "compile", compiled)
        assert pdf(made(*blocks)) == b"%PDF-"
        return found["lines"], found["drawn"]

    return of


def test_names_that_look_like_markup_do_not_stop_the_pdf(nasty: str) -> None:
    table = Table((Column(nasty, "N m"), Column("b")), ((nasty, "1"),), nasty, ("fail",))
    blocks = [
        Heading(nasty),
        Paragraph(nasty, "note"),
        Points((nasty,)),
        table,
        Verbatim(nasty + "\n#let x = 1"),
    ]
    cover = Cover(nasty, nasty, ((nasty, nasty),))
    assert pdf(Document(cover, tuple(numbered(blocks)))).startswith(b"%PDF-")


def test_a_subscript_is_set_as_one() -> None:
    assert words("tau_{C} = 1") == 'text("tau") + sub("C") + text(" = 1")'
    assert words("_{a}b_{c}") == 'sub("a") + text("b") + sub("c")'
    assert words("") == '""'


def test_letters_of_other_languages_stay_as_they_are() -> None:
    assert text('Größe "ψ"') == '"Größe \\"ψ\\""'


def test_every_kind_of_block_is_set_by_its_number(source) -> None:
    plot = Figure("one", "c_{d}", ())
    lines, _ = source(
        Heading("A"),
        Heading("B", 2),
        Paragraph("p", "note"),
        Points(("x", "y")),
        KeyValues((("k", "v"),)),
        Verbatim("v"),
    )
    assert plot.name == "one"
    assert lines == [
        '#cover("Title", "scene", "", basis((("Date", "today"), ), (), "as it is", ()))',
        '#title(1, "1", text("A"))',
        '#title(2, "1.1", text("B"))',
        '#sentences("note", text("p"))',
        '#points((text("x"), text("y"), ))',
        '#facts((("k", "v"), ))',
        '#verbatim("v")',
    ]


@pytest.mark.parametrize(("number", "size"), [(7, "7.5pt"), (8, "7pt"), (9, "7pt")])
def test_a_table_of_eight_columns_is_set_smaller(source, number: int, size: str) -> None:
    columns = tuple(Column(f"c{k}", "N m") for k in range(number))
    _, line = source(Table(columns, (tuple(str(k) for k in range(number)),)))[0]
    assert f", {size}, (" in line
    assert line.count('text("N m")') == number


def test_marks_colour_the_last_cell_of_their_row(source) -> None:
    columns = (Column("a", align="left"), Column("b"))
    _, marked = source(Table(columns, (("1", "2"), ("3", "4")), marks=("fail", "")))[0]
    assert marked.endswith('(left, right, ), 7.5pt, ("1", marked("#b3261e", "2"), "3", "4", ))')
    _, plain = source(Table(columns, (("1", "2"), ("3", "4"), ("5", "6"))))[0]
    assert plain.endswith('7.5pt, ("1", "2", "3", "4", "5", "6", ))')


def test_every_figure_is_drawn_in_a_file_of_its_own(source, bare) -> None:
    from torsion.output.chapters import chapters

    figure = next(block for block in chapters(bare) if isinstance(block, Figure))
    lines, drawn = source(figure, figure)
    assert drawn == ["figure-0.svg", "figure-1.svg"]
    assert [line.split(",")[0] for line in lines[1:]] == [
        '#drawing("figure-0.svg"',
        '#drawing("figure-1.svg"',
    ]


def test_no_number_of_a_wide_table_is_wider_than_its_column(tmp_path: Path) -> None:
    columns = (Column("Station", align="left"), *(Column(f"torque {k}", "N m") for k in range(10)))
    style = (
        Path(torsion.__file__).parent / "output" / "pages" / "templates" / "report.typ"
    ).read_text(encoding="utf-8")
    helper = style[style.index("#let widest(") : style.index("#let drawing(")]
    source = tmp_path / "wide.typ"
    source.write_text(
        f"""#let soft = black
#let caption(number, words) = words
{helper}
#let cells = range(44).map(k => [−1.2345678·10⁻¹²])
#let head = range(11).map(k => ([torque], [N m], [torque], [10⁻¹²]))
#let sides = (left, ..range(10).map(k => right))
#set page(width: 400pt, margin: 0pt)
#context [#metadata((
  widths(head, sides, 7pt, cells, 400pt).map(w => w / 1pt),
  measure(text(7pt, cells.first())).width / 1pt,
)) <found>]
""",
        encoding="utf-8",
    )
    ((found,),) = ([one["value"] for one in json.loads(typst.query(str(source), "<found>"))],)
    widths, number = found
    assert len(columns) == len(widths)
    assert all(one >= number + 7.0 - 1e-6 for one in widths[1:])
