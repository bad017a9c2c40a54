"""The words of the field in place of private ones: what not to write, checked in pages, comments and strings."""

import ast
import io
import re
import tokenize
from collections.abc import Iterator
from pathlib import Path

from tests.for_all import for_all
from tests.house_english import nodes

ROOT = Path(__file__).parents[1]
CHECKED = (  # files; folders of *.md and *.py
    "README.md",
    "shafting_specs/README.md",
    "docs",
    "reports",
    "benchmarks",
    "src/torsion",
    "tests/kernels/joints",
    *(f"tests/kernels/{name}" for name in ("damping", "distributed")),
)
WORDS = (
    (r"told|tells?|telling", "reports, states, names; reported, stated"),
    (r"asks?|asked|asking", "requests; requested, settings"),
    (r"(?:in|out)wards?", "toward the root, toward the leaves"),
    (r"(?:sub)?divisions?", "discretisation"),
    (r"brothers?", "siblings"),
    (r"hung|hangs?", "re-rooted; is carried by, follows"),
    (r"closing spans?", "chord of a loop"),
    (
        r"(?:first|second|both|one|two|backward|forward|upward|downward) pass(?:es)?",
        "sweep; seen from both sides",
    ),
    (r"proofs?", "enclosure"),
    (r"(?:per|a|an|one|two|each|every|half|quarter|the|whole) turns?(?! (?:of|to) )", "revolution"),
    (r"turns (?:of|per) (?:the|a) (?:shaft|reference|motor|cycle)", "revolutions"),
    (r"held", "fixed, grounded; compared with, kept"),
    (r"stations? (?:left )?alone", "free node"),
    (
        r"(?:response|harmonic|synthesis) lines?|lines? of (?:fixed frequency|an order|the response)",
        "harmonic component",
    ),
    (r"sw(?:ings?|inging|ung)", "amplitude, range; oscillates"),
    (r"stretch(?:es)?", "segment group, range"),
    (r"(?<!-)fold(?:s|ed|ing)?", "condensed"),
    (r"(?<!\d\s)(?<!\[)bars?", "distributed shaft; rod"),  # not the unit of a pressure
)  # a word, whole, without its case; what to write in its place
ANY_WORD = re.compile(  # one search for all, in small letters: most texts have none
    rf"\b(?:{'|'.join(pattern for pattern, _ in WORDS)})\b".replace(" ", r"\s+")
)
NAMES = {
    "told",
    "asked",
    "brother",
    "brothers",
    "hung",
    "folded",
    "liveliest",
    "outward",
    "inward",
    "stretch",
    "stretches",
    "swing",
    "proof",
}  # parts of a name in the code that are private words of the same kind
ANY_NAME = re.compile(rf"(?<![^\W_])(?:{'|'.join(sorted(NAMES))})(?![^\W_])", re.IGNORECASE)
JOINED = re.compile(  # between two parts of a string, and within it at the end of a line
    r"""["']\s*[bfru]*["']|\\\n""", re.IGNORECASE
)
QUOTED = re.compile(
    r"```.*?^```|`[^`\n]*`|\]\([^)\n]*\)", re.MULTILINE | re.DOTALL
)  # keys, code, targets of links


def has_word(text: str) -> bool:
    return ANY_WORD.search(text.lower()) is not None


def private_words(text: str) -> list[tuple[int, str, str]]:
    """Line, word and what to use instead, of every private word outside code, keys in backticks and targets."""
    prose = QUOTED.sub(lambda match: re.sub(r"[^\n]", "_", match[0]), text)
    if not has_word(prose):
        return []
    found = []
    for pattern, instead in WORDS:
        for match in re.finditer(rf"\b(?:{pattern})\b".replace(" ", r"\s+"), prose, re.IGNORECASE):
            found.append((prose.count("\n", 0, match.start()) + 1, match[0], instead))
    return sorted(found)


def is_groups(node: ast.AST) -> bool:
    """Whether it declares the groups of the keys of a component: names of keys, parted by blanks."""
    return (
        isinstance(node, ast.Assign)
        and isinstance(node.targets[0], ast.Name)
        and node.targets[0].id == "groups"
    )


def prose_of(source: str) -> Iterator[tuple[int, str]]:
    """Line and text of the comments and the strings of a module that has a private word.

    Strings of one word and groups of keys are no prose.
    """
    if not (has_word(source) or has_word(JOINED.sub("", source.replace("\\n", " ")))):
        return  # a tree takes long
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type == tokenize.COMMENT:
            yield token.start[0], token.string
    found = nodes(source)
    keys = {id(node) for node in found if is_groups(node) for node in ast.walk(node)}
    for node in found:
        if (
            id(node) not in keys
            and isinstance(node, ast.Constant)
            and isinstance(node.value, str)
            and re.search(r"\w\s+\w", node.value)
        ):
            yield node.lineno, node.value


def names_of(source: str) -> Iterator[tuple[int, str]]:
    """Line and text of every name in a module of which a part is a private word."""
    if not ANY_NAME.search(source):
        return
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type == tokenize.NAME and NAMES & set(token.string.lower().split("_")):
            yield token.start[0], token.string


def checked_files() -> list[Path]:
    found: list[Path] = []
    for name in CHECKED:
        root = ROOT / name
        found += (
            [root]
            if root.is_file()
            else sorted(path for path in root.rglob("*") if path.suffix in {".md", ".py"})
        )
    return found


def test_pages_comments_and_sentences_are_written_in_the_words_of_the_field() -> None:
    faults = []
    for path in checked_files():
        text = path.read_text(encoding="utf-8")
        parts = [(1, text)] if path.suffix == ".md" else prose_of(text)
        faults += [
            f"{path.relative_to(ROOT)}:{start + line - 1}: '{word}': write {instead}"
            for start, part in parts
            for line, word, instead in private_words(part)
        ]
    assert not faults, "\n".join(faults)


def test_names_are_words_of_the_field() -> None:
    faults = [
        f"{path.relative_to(ROOT)}:{line}: {name}"
        for path in sorted((ROOT / "src").rglob("*.py"))
        for line, name in names_of(path.read_text(encoding="utf-8"))
    ]
    assert not faults, "\n".join(faults)


def test_a_private_word_in_a_name_is_found() -> None:
    assert [
        line for line, _ in names_of("told_apart = 1\nhas_Asked(x)\ntasked = foretold = 2\n")
    ] == [1, 2]


def test_the_roots_that_are_checked_exist() -> None:
    assert all((ROOT / name).exists() for name in CHECKED)


@for_all(
    "text",
    [
        "The value is told.",
        "speeds asked for",
        "counted outward",
        "a second\npass",
        "cycles per turn",
        "a held end",
        "the swing of the yoke",
        "Lines of fixed frequency",
        "folded into one",
        "a bar of steel",
    ],
)
def test_a_private_word_is_found(text: str) -> None:
    assert len(private_words(text)) == 1


@for_all(
    "text",
    [
        "`held: true` grounds it",
        "every check passes",
        "programs taken in turn",
        "it turns at its own speed",
        "in a barred range",
        "twofold, an e-fold",
        "[page](told/held.md)",
        "joints in line",
        "line 3 of the file",
        "```\nasked = held\n```",
        "a charge of 2.4 bar",
        "pressure [bar]",
        "half a revolution",
        "tasked, withheld, foretold",
    ],
)
def test_ordinary_words_and_quoted_keys_are_no_fault(text: str) -> None:
    assert private_words(text) == []


def test_prose_of_a_module_is_its_comments_and_sentences() -> None:
    source = 'key = "held"  # a comment\nwords = f"is {key} told here"\nasked = 1\n'
    assert [line for line, _ in prose_of(source)] == [1, 2]
