"""Words that are no kind or key of the format, and what the format has for them: templates/other_words.txt."""

import re
from functools import cache

from torsion.schema import template


@cache
def other_words() -> tuple[tuple[str, str, str], ...]:
    """Return the rows of the file: a word, the key that may be meant (empty for a kind), and its meaning."""
    lines = template("other_words.txt").splitlines()
    rows = (line.split(" | ") for line in lines if not line.startswith("#"))
    return tuple((word, key.strip(), meaning) for word, key, meaning in rows)


def kind_for(written: str, otherwise: str) -> str:
    """Return what to write for a word that is no kind; `otherwise` for a word that means none."""
    words = {word: meaning for word, key, meaning in other_words() if not key}
    return words.get(written.casefold(), otherwise)


def key_for(written: str, keys: list[str]) -> str:
    """Return what to write for a word of the trade among these keys; empty for a word that means none of them."""
    spelled = re.sub("[ -]", "_", written.casefold())
    possible = [
        f"`{key}` ({meaning})"
        for word, key, meaning in other_words()
        if word == spelled and key in keys
    ]
    return f"write {' or '.join(possible)}" if possible else ""


def of_its_number(word: str, candidates: list[str]) -> list[str]:
    """Return the candidates with the digits of the word, in any order: iacs-m86 is a slip for iacs-m68, iacs-m54 is none."""
    digits = sorted(re.findall(r"\d", word))
    return [
        name for name in candidates if not digits or sorted(re.findall(r"\d", name)) in ([], digits)
    ]
