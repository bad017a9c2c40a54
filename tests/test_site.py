"""The documentation site builds without a warning, all its links lead somewhere, and it needs no network."""

import os
import re
import subprocess
import sys
from html import unescape
from pathlib import Path
from urllib.parse import unquote

import pytest

pytest.importorskip("furo", reason="the site needs pip install -e '.[docs]'")
pytest.importorskip("myst_parser", reason="the site needs pip install -e '.[docs]'")

ROOT = Path(__file__).parents[1]
SCENES = 3  # of the gallery
OUTSIDE = re.compile(r"[a-z]+:|//")  # another site, or data in the page


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of the site, as the command of the README builds it."""
    folder = tmp_path_factory.mktemp("site")
    command = [
        sys.executable,
        "-m",
        "sphinx",
        "-W",
        "--keep-going",
        "-n",
        "-q",
        "-c",
        "docs",
        "-d",
        str(folder / "pages"),
        "-D",
        f"gallery_most={SCENES}",
        ".",
        str(folder / "site"),
    ]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert not done.stderr
    return folder / "site"


def pages(site: Path) -> dict[Path, str]:
    return {path: path.read_text(encoding="utf-8") for path in sorted(site.rglob("*.html"))}


def test_every_link_leads_to_a_file_and_a_place(site: Path) -> None:
    found = pages(site)
    places = {str(path): set(re.findall(r'\sid="([^"]+)"', text)) for path, text in found.items()}
    files = {str(path) for path in site.rglob("*") if path.is_file()}
    count = 0
    for path, text in found.items():
        for link in map(unescape, re.findall(r'\s(?:href|src)="([^"]+)"', text)):
            if not OUTSIDE.match(link):
                file, _, anchor = link.partition("#")
                file = unquote(file.partition("?")[0]) or path.name
                target = os.path.normpath(os.path.join(path.parent, file))
                assert target in files, f"{path.name}: {link}"
                assert not anchor or target not in places or unquote(anchor) in places[target], (
                    f"{path.name}: {link}"
                )
                count += 1
    assert count > 1000


def test_nothing_is_fetched_from_elsewhere(site: Path) -> None:
    for path, text in pages(site).items():
        loaded = re.findall(r'<(?:script|img|source|iframe)[^>]*\ssrc="([^"]+)"', text)
        loaded += re.findall(
            r'<link[^>]*rel="(?:stylesheet|preload|icon)"[^>]*href="([^"]+)"', text
        )
        assert not [one for one in loaded if OUTSIDE.match(one) and not one.startswith("data:")], (
            path.name
        )


def test_no_page_names_a_place_of_this_machine(site: Path) -> None:
    for path in site.rglob("*"):
        if path.suffix in {".html", ".js", ".css", ".svg", ".yaml", ".txt"}:
            text = path.read_text(encoding="utf-8")
            assert str(ROOT) not in text, path
            assert not re.search(r"(?<![\w.])/(?:home|root|tmp|work)/\w", text), path


def test_every_numbered_equation_is_a_place_that_is_linked(site: Path) -> None:
    theory = "docs/explanation/theory/natural-frequencies"
    for name in (theory, "docs/explanation/theory/class-rules", "docs/tutorials/two-discs-by-hand"):
        text = (ROOT / f"{name}.md").read_text(encoding="utf-8")
        numbers = re.findall(r"^    .*\S +\(([AT]\d+[a-z]?)\)$", text, re.MULTILINE)
        page = (site / f"{name}.html").read_text(encoding="utf-8")
        assert numbers
        assert {
            number for number in numbers if f'class="equation" id="{number}"' not in page
        } == set()

    page = (site / f"{theory}.html").read_text(encoding="utf-8")
    assert 'href="#T3"' in page
    assert "Z<sub>i</sub> is the" in page
    conventions = (site / "docs" / "reference" / "conventions.html").read_text(encoding="utf-8")
    assert 'href="../explanation/theory/joints.html#T35"' in conventions


def test_the_gallery_has_sketch_figure_and_verdict_of_every_scene(site: Path) -> None:
    page = (site / "docs" / "gallery.html").read_text(encoding="utf-8")
    assert page.count('<img class="drawing"') == 2 * SCENES
    assert len(re.findall(r'<a href="\.\./scenes/\w+\.yaml">', page)) == SCENES
    assert len(re.findall(r"No rule is requested\.|<p>(?:PASS|FAIL|NOT JUDGED)", page)) == SCENES


def test_the_gallery_links_full_reports(site: Path) -> None:
    page = (site / "docs" / "gallery.html").read_text(encoding="utf-8")
    reports = re.findall(r'<a href="\.\./(full/\w+/report\.html)">', page)
    assert len(reports) == SCENES
    assert all("Appendix" in (site / report).read_text(encoding="utf-8") for report in reports)


def test_the_first_page_is_where_a_browser_looks(site: Path) -> None:
    assert "docs/index.html" in (site / "index.html").read_text(encoding="utf-8")


def test_an_old_address_leads_to_its_page(site: Path) -> None:
    assert 'href="tutorials/first-report.html"' in (site / "docs" / "tutorial.html").read_text(
        encoding="utf-8"
    )


def test_the_example_of_an_equation_holds() -> None:
    module = ROOT / "docs" / "site" / "equations.py"
    done = subprocess.run(
        [sys.executable, "-m", "doctest", str(module)], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout


def test_the_list_for_assistants_has_conventions_then_recipes_then_every_page(site: Path) -> None:
    text = (site / "llms.txt").read_text(encoding="utf-8")
    headings = re.findall(r"^## (.*)$", text, re.MULTILINE)
    assert headings == ["Conventions", "Exit statuses", "Recipes", "Pages"]
    addresses = re.findall(r"^- \[.+\]\((.+?\.html)\)(?:: .+)?$", text, re.MULTILINE)
    assert sum(address.startswith("docs/recipes/") for address in addresses) == 15
    assert set(addresses) <= {path.relative_to(site).as_posix() for path in pages(site)}
    sources = {
        path.relative_to(ROOT).with_suffix(".html").as_posix()
        for path in (ROOT / "docs").rglob("*.md")
    }
    assert sources <= set(addresses)
    assert (
        "[Stepped shaft from a drawing](docs/recipes/from_drawing.html): a drawing gives lengths"
        in text
    )
