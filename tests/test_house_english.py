"""House English: the number of flagged sentences falls; lower a bound when it has fallen."""

from pathlib import Path

from tests.house_english import PAGES, ROOT, files, flags

GENERATED = ("docs/format.md", "docs/results.md")
MOST_OF_PAGES = 100  # of what is written by hand
MOST = 2000  # with generated manuals, studies, templates and messages


def count(paths: list[Path]) -> int:
    return sum(len(instead) for path in paths for *_, instead in flags(path))


def test_pages_are_written_in_house_english() -> None:
    patterns = ("README.md", "CHANGELOG.md", "CONTRIBUTING.md", "docs/**/*.md", "shafting_specs/README.md")
    generated = {ROOT / name for name in GENERATED}
    assert count([path for path in files(ROOT, patterns) if path not in generated]) <= MOST_OF_PAGES


def test_messages_manuals_and_studies_are_written_in_house_english() -> None:
    assert count(files(ROOT, PAGES)) <= MOST


def test_a_private_word_a_long_sentence_and_an_inverted_opening_are_flagged(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    sentences = "The half range is small here.", "Of the shaft it is the smaller part.", "The shaft is long enough."
    page.write_text("\n\n".join(sentences), encoding="utf-8")
    assert [text for _, text, _ in flags(page)] == list(sentences[:2])
    page.write_text("The shaft " + "turns and " * 20 + "stops.\n")
    assert [instead for *_, instead in flags(page)] == [["split it"]]
