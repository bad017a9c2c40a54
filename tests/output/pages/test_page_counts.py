"""The length of the printed report: what a surveyor reads in one sitting, with every other number in results.json."""

import re

import pytest
from tests.contracts.frozen import solved

from torsion.output.blocks import Figure, Heading, Table
from torsion.output.document import document
from torsion.output.pages.pdf import pdf

pytest.importorskip("typst")


@pytest.mark.parametrize(
    ("scene", "pages"),
    [
        ("usv", 12),
        ("haixun_06402", 12),
        ("v12_generator_set", 18),
        ("two_stroke_ship", 18),
        ("truck_gears", 18),
    ],
)
def test_a_report_has_at_most_so_many_pages(scene: str, pages: int) -> None:
    made = pdf(document(solved(scene)))
    count = max(
        int(number) for number in re.findall(rb"/Type\s*/Pages.*?/Count\s+(\d+)", made, re.DOTALL)
    )
    assert 5 < count <= pages


def test_the_full_report_has_all_of_the_report_and_its_further_appendices() -> None:
    findings = solved("two_stroke_ship")
    brief, full = (
        [item.block for item in document(findings, is_full=is_full).body]
        for is_full in (False, True)
    )

    def titles(blocks: list[object]) -> list[str]:
        return [block.text for block in blocks if isinstance(block, Heading) and block.level == 1]

    more = [title for title in titles(full) if title not in titles(brief)]
    assert more == [
        "Appendix: angular amplitudes",
        "Appendix: engine harmonics",
        "Appendix: all modes",
        "Appendix: remarks on the checks",
    ]
    assert [title for title in titles(full) if title not in more] == titles(brief)
    for kind in (Table, Figure):
        captions = [
            [block.caption for block in blocks if isinstance(block, kind)]
            for blocks in (brief, full)
        ]
        assert set(captions[0]) < set(captions[1])
