"""Published cases are met within their digits, and the page lists every case with its deviation."""

import re

import pytest
from tests.validation.published import CASES, PAGE, largest_deviation, solve_case


@pytest.mark.parametrize("case", CASES)
def test_a_published_case_is_met_within_its_digits(case: str) -> None:
    deviation = largest_deviation(case, solve_case(case))
    assert deviation.size <= CASES[case]["within"], deviation
    row = re.search(
        rf"^\| `{case}` .*\| (\S+|below \S+) \| (\S+) \|$",
        PAGE.read_text(encoding="utf-8"),
        re.MULTILINE,
    )
    assert row, f"docs/validation/index.md lacks {case}: python -m tests.validation.published"
    printed = float(row[1].removeprefix("below "))
    assert deviation.size <= 1.1 * printed  # two digits are printed
    assert row[1].startswith("below ") or deviation.size >= 0.9 * printed
