"""States of the train that the cases of a file have, as rules demand them: misfire, zero pitch, other stiffness."""

from collections.abc import Iterator
from typing import Any

from torsion.study import CaseStates

STATES = {  # last word of a key that a case sets, scales or removes: state
    "misfire": "misfire",
    "stiffness": "other stiffness",
    "flexibility": "other stiffness",
}
LOAD = "operation.load"  # as a table of its own it is what a propeller takes at zero pitch; a law in a word is not


def states_of_cases(body: Any) -> tuple[CaseStates, ...]:
    """Return the states of each case that counts for the verdict; body: `cases` as the file has it."""
    cases = body if isinstance(body, dict) else {}
    return tuple(CaseStates(*_states_of(name, cases)) for name in cases if _is_judged(cases[name]))


def _is_judged(case: Any) -> bool:
    return not isinstance(case, dict) or case.get("judged", True) is not False


def _states_of(name: str, cases: dict[str, Any]) -> tuple[frozenset[str], tuple[str, ...] | None]:
    """Return the states of a case and of the case that it is based on, and the rules that it names in place of others."""
    case = cases[name]
    if not isinstance(case, dict):  # `from: tolerances`
        return frozenset({"other stiffness"} if case == "tolerances" else ()), None
    states = frozenset(_own_states(case))
    rules = None if case.get("rules") is None else tuple(_names(case["rules"]))
    base = case.get("based_on")
    if (
        base in cases
        and base != name
        and isinstance(cases[base], dict)
        and "based_on" not in cases[base]
    ):
        before, of_base = _states_of(base, cases)
        return states | before, of_base if rules is None else rules
    return states, rules


def _own_states(case: dict[str, Any]) -> Iterator[str]:
    changes = case.get("set")
    for key, value in (changes if isinstance(changes, dict) else {}).items():
        state = STATES.get(str(key).rpartition(".")[2])
        if str(key) == LOAD and isinstance(value, list):
            state = "zero pitch"
        if state is not None and value not in (None, []):
            yield state
    factors = case.get("scale")
    for key in factors if isinstance(factors, dict) else ():
        if str(key).rpartition(".")[2] in ("stiffness", "flexibility"):
            yield "other stiffness"


def _names(rules: Any) -> Iterator[str]:
    """Yield the names of the rules of a list, each with or without settings."""
    for rule in rules if isinstance(rules, list) else [rules]:
        yield from rule if isinstance(rule, dict) else [str(rule)]
