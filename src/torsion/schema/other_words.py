"""Words that the format writes otherwise: aliases of keys, and what a word of the trade may mean."""

import re
from functools import cache
from itertools import chain
from typing import Literal

from torsion.model import KINDS_BY_ALIAS
from torsion.schema import template

KEYS_BY_ALIAS = {  # of components, and of mappings within them
    "OD": "diameter",
    "outer_diameter": "diameter",
    "ID": "bore",
    "inner_diameter": "bore",
    "fixed": "held",
    "relative_damping": "psi",
    "entrained_water": "entrained",
    "T_KN": "rated_torque",
    "T_KW": "vibratory_torque",
    "T_Kmax": "max_torque",
    "P_KW": "heat_limit",
}
SECTIONS_BY_ALIAS = {  # of the top level, of `operation` and of `analyses: {design: }`
    "": {"shoulders": "steps"},
    "operation": {"reference": "at"},
    "design": {
        "variables": "choose",
        "constraints": "keep",
        "objective": "aim",
        "pareto": "against",
    },
}
_ALIASES = {*KINDS_BY_ALIAS, *KEYS_BY_ALIAS, *chain(*SECTIONS_BY_ALIAS.values())}
ALIAS = re.compile(rf"(?<![\w-])(?:{'|'.join(sorted(_ALIASES))})[\"']?\s*:")


@cache
def other_words() -> tuple[tuple[str, ...], ...]:
    """Return the rows of the file: word, key that may be meant or `<component>` or `<analysis>`, meaning."""
    lines = template("other_words.txt").splitlines()
    return tuple(tuple(line.split(" | ")) for line in lines if not line.startswith("#"))


def _meanings(written: str) -> dict[str, str]:
    spelled = _spelled(written)
    return {key: meaning for word, key, meaning in other_words() if word == spelled}


def _spelled(written: str) -> str:
    return re.sub("[ -]", "_", written.casefold())


def word_for(subject: Literal["component", "analysis"], written: str, otherwise: str) -> str:
    """Return what to write for a word that is no component or analysis; `otherwise` for an unknown word."""
    return _meanings(written).get(f"<{subject}>", otherwise)


def key_for(written: str, keys: list[str]) -> str:
    """Return what to write for a word of the trade among these keys; empty for a word that means none of them.

    A word without an entry means the last key that is a part of it.

    >>> key_for("gear_teeth", ["teeth", "ratio"])
    'write `teeth`'
    """
    meanings = _meanings(written)
    possible = [f"`{key}` ({meanings[key]})" for key in meanings if key in keys]
    if not possible:
        possible = [f"`{part}`" for part in _spelled(written).split("_") if part in keys][-1:]
    return f"write {' or '.join(possible)}" if possible else ""


def of_its_number(word: str, candidates: list[str]) -> list[str]:
    """Return the candidates with the digits of the word, in any order: iacs-m86 is a slip for iacs-m68, iacs-m54 is none."""
    digits = sorted(re.findall(r"\d", word))
    return [
        name for name in candidates if not digits or sorted(re.findall(r"\d", name)) in ([], digits)
    ]
