"""Verdicts where a coupling by table over vibratory torque has several solutions: the worst of each check stands."""

from collections.abc import Callable
from dataclasses import replace

from torsion.analyses.response.amplitudes import Response
from torsion.analyses.response.synthesis import synthesis
from torsion.findings import Results
from torsion.rules.verdict_line import Check, worst_checks

LARGEST = "largest"
Judge = Callable[[Results], tuple[Check, ...]]  # by all rules of the study


def worst_of_solutions(evidence: Results, judge: Judge) -> tuple[Check, ...]:
    """Return the checks of the largest solution, each replaced by that of another solution where it is worse."""
    checks = judge(evidence)
    response = evidence.get(Response)
    if response is None or not response.others:
        return checks
    cases = {LARGEST: checks}
    for number, solution in enumerate(response.others, 2):
        with_solution = evidence.having(response=solution, synthesis=synthesis(solution))
        cases[f"at solution {number} of the vibratory torque, the largest first"] = judge(
            with_solution
        )
    return tuple(
        check
        if words == LARGEST
        else replace(check, note="; ".join(filter(None, (words, check.note))))
        for words, check in worst_checks(cases).values()
    )
