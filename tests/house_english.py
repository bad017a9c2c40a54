"""House English: flag long sentences, private words and inverted openings in pages, templates and messages.

`python -m tests.house_english [files] [--worst 40]` prints the flags of every file and the worst sentences;
test_house_english.py bounds their number. docs/develop/style.md explains the words.
"""

import argparse
import ast
import re
from collections.abc import Iterable
from pathlib import Path

LONG = 30  # words; aim at 25
ROOT = Path(__file__).parents[1]
PAGES = (
    "README.md",
    "CHANGELOG.md",
    "CONTRIBUTING.md",
    "docs/**/*.md",
    "shafting_specs/README.md",
    "reports/*.md",
    *(f"src/**/templates/*.{kind}" for kind in ("html", "typ", "md", "yaml")),
    "src/**/*.py",
)
NUMBER = (
    r"figures? (?:of|in|from) (?:the|a|its|this|every) (?:file|input|maker|drawing|train)|(?:file|input|maker)"
    r"[’']s figures?|(?:which|what|other|toleranced|varied|fitted|two|more|all) figures?(?! \d)|last figure|"
    r"figures (?:come|vary|enter|scatter|agree|are (?:in|est))"
)
PERSON = (
    r"(?:file|page|report|table|chapter|rule|figure|row|column|key|search|verdict|train|model|calculation)s? "
    r"(?:says?|knows?|wants?|speaks?|sees?|finds?|thinks?|names?)"
)
BANNED = {  # pattern, whole words in any case: what to write
    NUMBER: "parameter, value, input data, digit",
    PERSON: "name who acts: the report lists, the program finds",
    r"half[- ]ranges?": "amplitude (0 to peak)",
    r"greatest|(?<!at )least(?! squares)": "maximum, largest; minimum",
    r"synthes[ie]s(?: of (?:all )?orders)?": "total vibratory torque or stress (all orders in phase)",
    r"scenes?": "model file, example",
    r"findings": "results",
    r"standing": "basis (of a limit)",
    r"(?:largest|greatest|highest) use|shares? of (?:(?:the|every|each|all|a) )?limits?": "utilisation",
    r"(?:as (?:it|they|the file) |(?<!it ))(?:stands?|stood)(?! still| for)": "is, appears, is listed; unchanged",
    r"ha(?:s|ve) (?:it|all of (?:it|them))": "shows, contains",
    r"of which": "two sentences",
    r"in part": "partly",
    r"beside": "next to, together with",
    r"behind": "after, downstream of",
    r"those of|that of": "repeat the noun",
    r"(?:by|of) (?:itself|themselves)|of (?:its|their) own": "separately, automatically, its own",
    r"alone": "only",
    r"all else|what else|nothing else|whatever": "name the thing",
    r"is no|are no": "is not a, there is no",
    r"(?:not )?kept|keeps? (?:a|the|no|every|all|its) limits?": "exceeded, met, within the limit",
    r"(?:without|has|have|had|gives?|with) (?:no |an |no an )?answer|unanswered": "failed, not solved, no solution",
    r"left out": "omitted, not computed, not checked",
    r"at fault|faults?": "invalid; error, input error",
    r"from memory|(?:not )?at hand": "cite the edition, or 'not checked against the edition in force'",
    r"motions? over time": "transient response or analysis",
    r"(?<!to )play(?!s)": "backlash",
    r"goes? (?:with|on|by|out|whole|over)|takes? (?:no|none|nothing|every|all)": "continues, correlates with, stops",
    r"where (?:it|they|there|none|no|nothing|something|a|an|the file)": "if, when",
}
ANY_BANNED = re.compile(rf"(?<![\w-])(?:{'|'.join(BANNED)})(?![\w-])", re.IGNORECASE)
PATTERNS = [
    (re.compile(rf"(?<![\w-])(?:{pattern})(?![\w-])", re.IGNORECASE), word)
    for pattern, word in BANNED.items()
]
OPENINGS = {  # at the start of a sentence
    r"(?:Of|Beside|Behind|Beyond) |(?:So|Nor|Neither) (?:is|are|do|does|has|have|a|the)\b": "open with the subject",
    r"(?:In|On|At|From|With|Between|Under|By|To|For)(?: [\w`’'-]+){1,4} (?<!it )(?<!there )(?<!they )"
    r"(?:is|are|stands?|lies?|comes?|goes) (?:the|a|an|no|every|each|all|only|what|that)\b"
    r"|(?:Proven|Refused|Computed|Given|Counted|Named|Judged|"
    r"Outlined|Missing|Kept|Left out|Known|Inside|Outside) (?:is|are|was|by|in|with)\b": "subject before verb",
    r"What (?!.*\?)|(?:Where|Whether|Whatever|Whose) (?!.*\?)": "open with the subject, or with If or When",
    r"(?:That|Those|Both|One|Each|Such|None|All|More|Others?) (?:of|that|which|with|by|in|are|is)\b": "name the thing",
    r"[^.?!]{25,}; (?:of|so|what|that|those|nor|neither|with|in|else) ": "two sentences",
}


def nodes(source: str) -> list[ast.AST]:
    """Return the nodes of a module, parents before their children, as `ast.walk` in a third of its time."""
    found: list[ast.AST] = [ast.parse(source)]
    for node in found:
        for value in vars(node).values():
            if isinstance(value, list):
                found += [item for item in value if isinstance(item, ast.AST)]
            elif isinstance(value, ast.AST) and value._fields:
                found.append(value)
    return found


def messages(source: str) -> list[str]:
    """Return the strings of six words or more of a module, without its docstrings."""
    skipped, texts = set(), []
    for node in nodes(source):
        body = getattr(node, "body", None)
        if isinstance(body, list) and body and isinstance(body[0], ast.Expr):
            skipped.add(id(body[0].value))
        if isinstance(node, ast.JoinedStr):
            skipped |= {id(value) for value in node.values}
            texts.append(
                "".join(v.value if isinstance(v, ast.Constant) else "x" for v in node.values)
            )
        elif (
            isinstance(node, ast.Constant)
            and isinstance(node.value, str)
            and id(node) not in skipped
        ):
            texts.append(node.value)
    return [text for text in texts if len(text.split()) >= 6]


def files(root: Path, patterns: Iterable[str]) -> list[Path]:
    """Return the files of a folder that match a pattern."""
    return sorted({file for pattern in patterns for file in root.glob(pattern)})


def sentences(path: Path) -> list[str]:
    """Return sentences, cells, list items and headings, without code, keys, formulas and targets of links."""
    text = path.read_text(encoding="utf-8")
    if path.suffix == ".py":
        text = "\n\n".join(messages(text))
    elif path.suffix == ".html":
        text = re.sub(r"(?s)<(script|style)\b.*?</\1>|\{[{%#].*?[}%#]\}|<[^>]+>", " ", text)
    elif path.suffix in {".yaml", ".typ"}:
        text = "\n\n".join(
            re.findall(r"(?<=# ).*" if path.suffix == ".yaml" else r"(?<=// ).*|\"[^\"\n]*\"", text)
        )
    text = re.sub(r"(?ms)^\s*```.*?^\s*```|^ {4,}\S[^\n]*$|^\|[-| :]+\|$", "\n", text)
    text = re.sub(r"`[^`\n]*`", "key", re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", text))
    text = re.sub(
        r"(?m)^\s*(?:[-*] |\d+\. |#+ )",
        "\n",
        re.sub(r"\s\|\s|^\||\|$", "\n\n", text, flags=re.MULTILINE),
    )
    blocks = [" ".join(block.replace("*", "").split()) for block in re.split(r"\n\s*\n", text)]
    parts = (part for block in blocks for part in re.split(r"(?<=[.!?])\s+(?=[A-Z(“])", block))
    return [
        part for part in parts if len(re.findall(r"[A-Za-z]{2,}", part)) >= 4 and "<svg" not in part
    ]


def flags(path: Path) -> list[tuple[float, str, list[str]]]:
    """Return score, sentence and what to write, of every flagged sentence of a file; a long one counts once more."""
    flagged = []
    for text in sentences(path):
        size = len(re.findall(r"[\w’'./%-]+", text))
        banned = [
            word
            for words, word in (PATTERNS if ANY_BANNED.search(text) else ())
            for _ in words.finditer(text)
        ]
        inverted = [word for pattern, word in OPENINGS.items() if re.match(pattern, text)]
        instead = banned + inverted + ["split it"] * (size > LONG)
        if instead:
            flagged.append(
                (max(0, size - LONG) / 5 + len(banned) + 2 * len(inverted), text, instead)
            )
    return flagged


def main() -> None:
    """Print the count of every file, and the worst sentences first."""
    parser = argparse.ArgumentParser()
    parser.add_argument("paths", nargs="*", type=Path)
    parser.add_argument("--worst", type=int, default=40)
    chosen = parser.parse_args()
    flagged = {path: flags(path) for path in chosen.paths or files(ROOT, PAGES)}
    counts = {path: sum(len(instead) for *_, instead in found) for path, found in flagged.items()}
    for path, count in sorted(counts.items(), key=lambda item: -item[1]):
        if count:
            print(f"{count:6} {path}")
    print(f"{sum(counts.values()):6} in {len(counts)} files")
    worst = sorted(
        ((score, path, *rest) for path, found in flagged.items() for score, *rest in found),
        reverse=True,
    )
    for score, path, text, instead in worst[: chosen.worst]:
        print(f"\n{path} ({score:.1f}): {text}\n    -> {'; '.join(sorted(set(instead)))}")


if __name__ == "__main__":
    main()
