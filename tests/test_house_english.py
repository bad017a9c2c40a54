"""House English: the number of flagged sentences falls; lower a bound when it has fallen."""

from pathlib import Path

from tests.house_english import PAGES, ROOT, files, flags

GENERATED = ("docs/reference/model-file/", "docs/reference/results/", "docs/reference/python/")
MOST_OF_PAGES = 70  # of what is written by hand
MOST = 380  # with generated manuals, studies, templates and messages


def count(paths: list[Path]) -> int:
    return sum(len(instead) for path in paths for *_, instead in flags(path))


def test_pages_are_written_in_house_english() -> None:
    patterns = (
        "README.md",
        "CHANGELOG.md",
        "CONTRIBUTING.md",
        "docs/**/*.md",
        "shafting_specs/README.md",
    )
    pages = files(ROOT, patterns)
    by_hand = [
        page for page in pages if not page.relative_to(ROOT).as_posix().startswith(GENERATED)
    ]
    assert count(by_hand) <= MOST_OF_PAGES


def test_messages_manuals_and_studies_are_written_in_house_english() -> None:
    assert count(files(ROOT, PAGES)) <= MOST


def test_a_private_word_a_long_sentence_and_an_inverted_opening_are_flagged(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    sentences = (
        "The half range is small here.",
        "Of the shaft it is the smaller part.",
        "The shaft is long enough.",
    )
    page.write_text("\n\n".join(sentences), encoding="utf-8")
    assert [text for _, text, _ in flags(page)] == list(sentences[:2])
    page.write_text("The shaft " + "turns and " * 20 + "stops.\n")
    assert [instead for *_, instead in flags(page)] == [["split it"]]
