"""Equations of the pages: subscripts and exponents are set as such, numbers are places to link to, as `(T12)` does."""

import re
from collections.abc import Iterator
from functools import cache
from html import escape
from pathlib import Path

from docutils import nodes
from sphinx.application import Sphinx

PAGES = "docs/explanation/theory", "docs/tutorials/two-discs-by-hand"  # a folder, and a page
NUMBER = re.compile(r"\(([AT]\d+[a-z]?)\)")  # (T12), (A1), (T115a)
SYMBOL = re.compile(
    r"(?<=[A-Za-zα-ωΑ-Ω])_(\([^()]*\)|\{[^}]*\}|[A-Za-z0-9]+)(?![A-Za-z0-9_])"
)  # the index of τ_C, in the text
NUMBERED = re.compile(r"(\S.*?) +\(([AT]\d+[a-z]?)\)$")
IN_BRACKETS = r"\((?:[^()]|\([^()]*\))*\)"
PIECE = re.compile(
    rf"_(?P<below>{IN_BRACKETS}|\{{[^}}]*\}}|[A-Za-z0-9α-ωΑ-Ω]+)"
    rf"|\^(?P<above>{IN_BRACKETS}|−?[A-Za-z0-9.½⅓]+)"
    r"|(?P<letters>(?:[A-Za-zα-ωΑ-Ω][\u0300-\u036f]*)+)"  # with their dots
)
UPRIGHT = {
    "ln",
    "Re",
    "Im",
    "or",
    "of",
    "in",
    "at",
    "is",
    "by",
    "if",
    "as",
    "to",
    "on",
    "no",
    "up",
    "so",
    "kW",
    "Σ",
    "Π",
    "Δ",
}
LONGEST_SYMBOL = (
    2  # Latin letters beside each other that are a product; more are a word or a function
)


def setup(app: Sphinx) -> dict[str, bool]:
    """Acts on every page that is written."""
    app.connect("doctree-resolved", _resolved)
    return {"parallel_read_safe": True}


@cache
def page_of_equations(root: Path) -> dict[str, str]:
    """Return the page, as Sphinx names it, that defines each equation; `root` is that of the repository."""
    files = [
        path
        for name in PAGES
        for path in (*sorted((root / name).glob("*.md")), root / f"{name}.md")
    ]
    return {
        match[2]: path.relative_to(root).with_suffix("").as_posix()
        for path in files
        if path.exists()
        for line in path.read_text(encoding="utf-8").splitlines()
        if line.startswith("    ") and (match := NUMBERED.search(line))
    }


def _resolved(app: Sphinx, doctree: nodes.document, page: str) -> None:
    if app.builder.format != "html":
        return
    has_equations = page.startswith(PAGES)
    defined = set[str]()
    for block in [*doctree.findall(nodes.literal_block)]:
        if has_equations and block.get("language", "none") in ("none", "default"):
            block.replace_self(nodes.raw("", rendered(block.astext(), defined), format="html"))

    pages = page_of_equations(Path(app.srcdir))
    addresses = {of: app.builder.get_relative_uri(page, of) for of in {*pages.values()} - {page}}
    targets = {name: addresses.get(of, "") for name, of in pages.items()}
    for text in [*doctree.findall(nodes.Text)]:
        if isinstance(text.parent, nodes.TextElement) and not _is_verbatim(text):
            made = [*_linked(str(text), targets, has_symbols=has_equations)]
            if len(made) > 1:
                text.parent.replace(text, made)


def _is_verbatim(text: nodes.Text) -> bool:
    ancestor = text.parent
    while ancestor is not None:
        if isinstance(
            ancestor,
            nodes.literal | nodes.literal_block | nodes.raw | nodes.reference | nodes.title,
        ):
            return True
        ancestor = ancestor.parent
    return False


def _linked(text: str, targets: dict[str, str], *, has_symbols: bool) -> Iterator[nodes.Node]:
    """Text, in which the numbers of equations lead to these, and symbols have their indices."""
    numbers = (match for match in NUMBER.finditer(text) if match[1] in targets)
    found = [*numbers, *(SYMBOL.finditer(text) if has_symbols else ())]
    place = 0
    for one in sorted(found, key=lambda match: match.start()):
        yield nodes.Text(text[place : one.start()])
        if one.re is NUMBER:
            yield nodes.reference("", one[0], refuri=f"{targets[one[1]]}#{one[1]}", internal=True)
        else:
            yield nodes.subscript("", one[1].strip("(){}"))
        place = one.end()
    yield nodes.Text(text[place:])


def rendered(block: str, defined: set[str]) -> str:
    """HTML of the lines of a block; the first line with a number is the place that it names."""
    lines = []
    for line in block.splitlines():
        found = NUMBERED.search(line)
        formula = line if found is None else line[: found.end(1)]
        name = "" if found is None or found[2] in defined else f' id="{found[2]}"'
        number = "" if found is None else f'<span class="number">({found[2]})</span>'
        defined |= set() if found is None else {found[2]}
        lines.append(
            f'<div class="equation"{name}><span class="formula">{typeset(formula)}</span>{number}</div>'
        )
    return f'<div class="equations">{"".join(lines)}</div>'


def typeset(formula: str) -> str:
    """A formula as the pages write it, `ω_n² = K_(r−c)/J`, in HTML.

    >>> typeset("t_(i+1) < e^(−2x) sin α")
    '<i>t</i><sub><i>i</i>+1</sub> &lt; <i>e</i><sup>−2<i>x</i></sup> sin <i>α</i>'
    """
    formula, made, place = formula.replace("sqrt(", "√("), list[str](), 0
    for found in PIECE.finditer(formula):
        made.append(escape(formula[place : found.start()], quote=False))
        place = found.end()
        if letters := found["letters"]:
            is_symbol = len(letters) <= LONGEST_SYMBOL or not letters.isascii()
            made.append(f"<i>{letters}</i>" if is_symbol and letters not in UPRIGHT else letters)
        else:
            kind, inside = ("sub", found["below"]) if found["below"] else ("sup", found["above"])
            is_enclosed = inside[0] in "({" and inside[-1] in ")}"
            made.append(f"<{kind}>{typeset(inside[1:-1] if is_enclosed else inside)}</{kind}>")
    return "".join([*made, escape(formula[place:], quote=False)])
