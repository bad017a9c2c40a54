"""States of the train that the cases of a file have, as rules demand them: misfire, zero pitch, other stiffness."""

from collections.abc import Iterator
from typing import Any

from torsion.study import CaseStates

SCALED = {"stiffness": "other stiffness", "flexibility": "other stiffness"}  # last word of a key
STATES = {"misfire": "misfire", **SCALED}  # the same of a key that a case sets
LOAD = "operation.load"  # as a table of its own it is what a propeller takes at zero pitch; a law in a word is not


def states_of_cases(body: Any) -> tuple[CaseStates, ...]:
    """Return the states of each case that counts for the verdict; body: `cases` as the file has it."""
    cases = body if isinstance(body, dict) else {}
    return tuple(
        _states_of(name, cases)
        for name, case in cases.items()
        if not isinstance(case, dict) or case.get("judged", True) is not False
    )


def _states_of(name: str, cases: dict[str, Any]) -> CaseStates:
    """Return the states of a case and of the case that it is based on, and the rules that it names in place of others."""
    case = cases[name]
    if not isinstance(case, dict):  # `from: tolerances`
        return CaseStates(frozenset({"other stiffness"} if case == "tolerances" else ()))
    states = frozenset(_own_states(case))
    rules = None if case.get("rules") is None else tuple(_names(case["rules"]))
    base: Any = case.get("based_on")
    base_case = None if base == name else cases.get(base)
    if not isinstance(base_case, dict) or "based_on" in base_case:
        return CaseStates(states, rules)
    before = _states_of(base, cases)
    return CaseStates(states | before.states, before.rules if rules is None else rules)


def _own_states(case: dict[str, Any]) -> Iterator[str]:
    for section, states in (("set", STATES), ("scale", SCALED)):
        changes = case.get(section)
        for key, value in (changes if isinstance(changes, dict) else {}).items():
            state = states.get(str(key).rpartition(".")[2])
            if section == "set" and key == LOAD and isinstance(value, list):
                state = "zero pitch"
            if state is not None and value not in (None, []):
                yield state


def _names(rules: Any) -> Iterator[str]:
    """Yield the names of the rules of a list, each with or without settings."""
    for rule in rules if isinstance(rules, list) else [rules]:
        yield from rule if isinstance(rule, dict) else [str(rule)]
