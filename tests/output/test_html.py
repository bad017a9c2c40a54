"""The page: self-contained, escaped, complete, true to the results."""

import re
from base64 import b64encode
from datetime import date
from hashlib import sha256
from html import escape
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from tests.output.drawn import bands

import torsion
from torsion.analyses.response.amplitudes import Synthesis
from torsion.analyses.undamped_modes import Modes
from torsion.findings import Findings
from torsion.output import check_words
from torsion.output.blocks import Figure, Heading, Paragraph, Table
from torsion.output.document import Cover, Document, Numbered, document, numbered
from torsion.output.numbers import given, number, symbols
from torsion.output.pages.html import SCRIPTS, anchor, css_text, has_long_word, html
from torsion.output.stored.scene import elements
from torsion.rules.verdict_line import WORDS, Checks

VOID = {"meta", "br", "link", "img", "hr"}


@pytest.fixture(scope="module")
def page(train: Findings) -> str:
    return html(document(train, date(2024, 2, 29)))


class Outline(HTMLParser):
    """Checks that every element is closed, and notes what is loaded from elsewhere and what runs."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.loads: list[str] = []
        self.tags: set[str] = set()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.add(tag)
        for key, value in attrs:
            if key in ("src", "href", "xlink:href", "data") and not (value or "").startswith("#"):
                self.loads.append(f"{tag} {key}={value}")
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.handle_starttag(tag, attrs)
        if tag not in VOID:
            self.open.pop()

    def handle_endtag(self, tag: str) -> None:
        assert self.open
        assert self.open.pop() == tag


def test_the_page_needs_nothing_from_elsewhere_and_runs_its_own_script_alone(page: str) -> None:
    outline = Outline()
    outline.feed(page)
    assert outline.open == []
    assert outline.loads == []
    (script,) = re.findall(r"<script>(.*?)</script>", page, re.DOTALL)
    templates = Path(torsion.__file__).parent / "output/pages/templates"
    whole = "\n".join((templates / name).read_text(encoding="utf-8") for name in SCRIPTS)
    assert re.sub(r"\s+", " ", script).strip() == re.sub(r"\s+", " ", whole).strip()
    assert sorted(SCRIPTS) == sorted(path.name for path in templates.glob("*.js"))
    allowed = b64encode(sha256(script.encode()).digest()).decode()
    assert (
        f"default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'sha256-{allowed}'"
        in page
    )
    assert "url(http" not in page
    assert "@import" not in page


def test_names_are_escaped_everywhere(page: str, nasty: str) -> None:
    assert page.count("<script>") == 1
    assert "<b>#1</b>" not in page
    assert escape(nasty, quote=False).replace('"', "&#34;") in page
    assert page.count("</style>") >= 1
    assert "a &lt;/style&gt; b" in page


def test_a_name_cannot_end_the_style_sheet() -> None:
    assert "<" not in css_text('"; } </style><b>')
    assert '"' not in css_text('"; } </style><b>')


def test_letters_of_a_style_sheet_stay_and_signs_are_code_points() -> None:
    assert css_text('Größe 1.5 (a-b), x: {"}') == "Größe 1.5 (a-b), x: \\7b \\22 \\7d "


@pytest.mark.parametrize(
    ("text", "is_long"), [("x" * 20, False), ("x" * 21, True), (f"a {'x' * 21} b", True)]
)
def test_a_word_of_more_than_twenty_letters_may_be_broken(text: str, is_long: bool) -> None:
    assert has_long_word(text) is is_long


def test_an_anchor_is_the_number_in_small_letters() -> None:
    assert [anchor(Numbered(Paragraph("x"), one)) for one in ("4.2", "Table 4.1")] == [
        "s4-2",
        "stable-4-1",
    ]


def test_the_contents_list_the_chapters_alone_and_the_page_has_no_blank_lines(
    bare: Findings,
) -> None:
    blocks = [Heading("One"), Paragraph("p"), Heading("Within", 2), Heading("Two")]
    page = html(Document(Cover("t", "s", ()), tuple(numbered(blocks))))
    assert page.count(">1.1&ensp;Within<") == page.count("Within<") == 1
    assert (page.count("One<"), page.count("Two<")) == (2, 2)
    body = page[page.index("<body") :]
    assert [line for line in body.splitlines() if not line.strip()] == []


def test_no_chapter_is_empty_and_numbers_have_no_gap(train: Findings) -> None:
    body = document(train).body
    chapters = [item for item in body if isinstance(item.block, Heading) and item.block.level == 1]
    assert [item.number for item in chapters] == [str(k + 1) for k in range(len(chapters))]
    for item, after in zip(body, [*body[1:], None], strict=True):
        if isinstance(item.block, Heading):
            assert after is not None
            assert not (
                isinstance(after.block, Heading) and after.block.level <= item.block.level
            ), item.block.text


def test_what_a_scene_does_not_have_is_not_printed(bare: Findings) -> None:
    titles = [
        i.block.text
        for i in document(bare).body
        if isinstance(i.block, Heading) and i.block.level == 1
    ]
    assert titles == [
        "Verdict",
        "The plant",
        "Natural frequencies and mode shapes",
        "Appendix: Holzer tables",
        "Appendix: mass-elastic system",
        "Appendix: what was computed",
        "Appendix: the input as read",
    ]


def _table(findings: Findings, caption: str) -> Table:
    found = [
        i.block
        for i in document(findings).body
        if isinstance(i.block, Table) and caption in i.block.caption
    ]
    assert found, caption
    return found[0]


def test_the_frequencies_in_the_table_are_those_found(train: Findings, page: str) -> None:
    rows = _table(train, "Natural frequencies of the undamped").rows
    assert [row[1] for row in rows] == [number(f, 7) for f in train.need(Modes).frequency.tolist()]
    assert all(f">{row[1]}<" in page for row in rows)


def test_the_verdicts_in_the_table_are_the_checks(train: Findings) -> None:
    rows = _table(train, "Checks, each at").rows
    lines = train.need(Checks).lines
    assert len(rows) > 5
    wanted = [
        (
            check.what,
            check.where,
            check_words.value(check),
            "≥" if check.at_least else "≤" if check.has_limit else "",
            given(check.limit),
            WORDS[check.verdict],
            f"{check.rule}: {symbols(check.clause)} ({check_words.basis(check)})",
        )
        for check in lines
        if check.utilisation is None or check.utilisation >= 0.1
    ]
    assert sorted((*row[:5], row[10][2:], row[9]) for row in rows) == sorted(wanted)


def test_the_largest_torque_in_the_table_is_that_of_the_synthesis(train: Findings) -> None:
    table = _table(train, "Maximum vibratory torque of every component")
    factor = {"N m": 1.0, "kN m": 1e-3}[table.columns[1].unit]
    by_name = {element.name: element for element in elements(train.system)}
    for row in table.rows:
        top = train.need(Synthesis).half_range[:, list(by_name[row[0]].spans)].max()
        assert row[1] == number(float(top) * factor)


def test_every_number_of_the_input_stands_in_the_appendix(train: Findings, page: str) -> None:
    for word in re.findall(r"[\w.]+", train.study.text):
        assert word in page


def test_a_resonance_without_an_answer_is_said_and_not_plotted(undamped: Findings) -> None:
    body = document(undamped).body
    figures = [
        i.block for i in body if isinstance(i.block, Figure) and i.block.name.startswith("torque")
    ]
    assert figures
    for figure in figures:
        assert bands(figure, "no answer")
        for line in figure.lines.values():
            for low, high in bands(figure, "no answer"):
                assert np.isnan(line.y[(line.x > low) & (line.x < high)]).all()
    text = html(document(undamped))
    assert "no reliable finite value" in text
    assert 'class="no-answer"' in text


def test_the_same_findings_give_the_same_page(bare: Findings) -> None:
    assert html(document(bare, date(2024, 1, 1))) == html(document(bare, date(2024, 1, 1)))
