"""A study to its findings: only what is requested, and what that needs, is computed."""

from collections.abc import Collection

from torsion import rules
from torsion.analyses import ANALYSES, ordered
from torsion.errors import InputError
from torsion.findings import Findings, Progress, Work, silent
from torsion.rules import speeds
from torsion.rules.check import Checks
from torsion.schema.read import located
from torsion.study import Study


def run(study: Study, *, only: Collection[str] = (), progress: Progress = silent) -> Findings:
    """Compute everything that the study requests, or of it `only` those analyses and what they need.

    Raises InputError (located in the study's file) and SolveError.
    """
    work = Work(study, {}, progress=progress, ruled=rules.needed(study), rules=speeds)
    try:
        for name in ordered({key: ANALYSES[key] for key in _with_needs(only)} if only else ANALYSES):
            analysis = ANALYSES[name]
            if name in study.analyses or name in only or analysis.wanted(study):
                analysis.function()(work)
        _judge(work)
    except InputError as error:
        raise located(error, study) from None
    return Findings(study, work.results, work.log.plan())


def _with_needs(only: Collection[str]) -> list[str]:
    """The names, each behind those that it needs."""
    found: dict[str, None] = {}
    for name in only:
        found |= dict.fromkeys([*_with_needs(ANALYSES[name].needs), name])
    return list(found)


def _judge(work: Work) -> None:
    """The verdicts of the rules: of those that always hold, and of those that the file names."""
    checks = rules.standing_verdicts(work)
    if not work.study.rules:
        work.log.without("rules", "the file names none")
    else:
        with work.log.step("rules", "the file names them") as step:
            found = rules.verdicts(work)
            step.method = ", ".join(name for name, _ in work.study.rules)
            step.size = f"{len(found)} checks"
        checks += found
        for what, why in rules.not_judged(work.study):
            work.log.without(what, why)
    work.put(checks=Checks(checks))
