"""The committed pages of the papers are those that the program writes today."""

import re
from pathlib import Path

import pytest

PAGES = Path(__file__).parents[2] / "reports" / "papers"
NAMES = ("liu_2023", "ma_2011", "chang_li_tripod", "pump_lumped", "shafting")


@pytest.mark.parametrize("name", NAMES)
def test_committed_page_is_what_the_program_says(name: str, paper) -> None:
    page = paper[name].page()
    assert (PAGES / f"{name}.md").read_text(encoding="utf-8") == page.text(), (
        "run python -m benchmarks.papers"
    )
    assert page.misprints
    assert page.missing


@pytest.mark.parametrize("name", NAMES)
def test_every_figure_of_a_page_is_there(name: str) -> None:
    shown = re.findall(r"\]\((\S+\.svg)\)", (PAGES / f"{name}.md").read_text(encoding="utf-8"))
    assert shown
    for file in shown:
        assert "</svg>" in (PAGES / file).read_text(encoding="utf-8")


def test_a_bound_that_does_not_hold_stops_the_page(paper) -> None:
    with pytest.raises(ArithmeticError, match="promised"):
        paper["writing"].bound(1.0 + 1e-9, 1.0, "1e-10")
