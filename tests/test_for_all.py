"""A law held for many cases names those that break it."""

from pathlib import Path

import pytest
from tests.for_all import for_all


def test_every_case_that_breaks_a_law_is_named_with_its_own_words() -> None:
    @for_all("number, root", [(4, 2), (9, 4), (16, 4), (25, 6)])
    def law(number: int, root: int) -> None:
        assert root**2 == number, f"{root} is not the root"

    with pytest.raises(ExceptionGroup, match="2 of 4 cases") as raised:
        law()
    offenders = raised.value.exceptions
    assert ["4 is not the root" in str(offenders[0]), "6 is not" in str(offenders[1])] == [True] * 2
    assert [offender.__notes__ for offender in offenders] == [["case 1: 9, 4"], ["case 3: 25, 6"]]


def test_a_law_without_a_case_is_refused() -> None:
    with pytest.raises(AssertionError, match="cannot fail"):
        for_all("number", [])


folders = set[Path]()


@for_all("number", range(3))
def test_every_case_has_a_folder_of_its_own(number: int, tmp_path: Path) -> None:
    assert not list(tmp_path.iterdir())
    (tmp_path / "file").write_text(str(number), encoding="utf-8")
    folders.add(tmp_path)
    assert len(folders) == number + 1
