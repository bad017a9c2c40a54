"""A study to its findings: only what is requested, and what that needs, is computed."""

import math
import time
from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import replace
from typing import Any

from torsion import rules
from torsion.analyses import ANALYSES, Analysis, ordered
from torsion.errors import Fault, InputError, SolveError
from torsion.findings import (
    NORMAL,
    Findings,
    Plan,
    PlanLine,
    Progress,
    Unanswered,
    UsedSource,
    Work,
    silent,
)
from torsion.rules import judgement
from torsion.rules.demanded_states import unjudged, unjudged_variants
from torsion.rules.reached_speeds import demanded_study, in_rpm
from torsion.rules.verdict_line import BarredRange, Check, Checks, rank, with_basis, worst_checks
from torsion.schema.scene_reader import located
from torsion.schema.study_faults import study_faults
from torsion.sources import SOURCES, Citations, collected
from torsion.study import Study, bytes_of

ESSENTIAL = ("sections", "assembly")  # without which nothing else stands
DEFAULT = ("modes", "response")  # analyses of a file that names none
ANSWERS = (  # results of which one at least makes a report
    "modes",
    "damped_modes",
    "response",
    "frequency_response",
    "joints",
    "lateral",
    "stability",
    "stability_map",
    "transient",
    "check",
)


def run(
    study: Study,
    *,
    only: Collection[str] = (),
    memory: str | float | None = None,
    progress: Progress = silent,
    answered: Callable[..., Any] | None = None,
) -> Findings:
    """Compute everything that the study requests, and its cases, or of it `only` those analyses and what they need.

    An analysis without an answer is reported in the plan (`plan.unanswered`) and takes no other with it; its error is
    raised where a rule of the file reads it, or nothing else has an answer. Raises InputError (located in the study's
    file) and SolveError. memory: bytes, or text such as "4 GB", that a response may need (default: 2 GB). answered: of
    a sweep, what takes its chunks to their parts in place of this process.
    """
    if memory is not None:
        study = replace(study, memory=bytes_of(memory))
    if study.train.has_steps:  # of a train that no file was read for
        from torsion.assembly.junction.stepped_shafts import with_steps

        study = replace(study, train=with_steps(study.train))
    if not study.cases:
        return _misfires(study, only, progress, answered)
    total = 1 + len(study.cases)
    found = _misfires(study, only, _part_of(progress, f"case {NORMAL}", (0, total)), answered)
    cases = {}
    for place, (name, case) in enumerate(study.cases.items(), start=1):
        part = _part_of(progress, f"case {name}", (place, total))
        part("", 0.0)
        others = {
            key: one for key, one in case.variations.items() if key != "design"
        }  # which is over all cases
        try:
            cases[name] = _misfires(
                replace(case, memory=study.memory, variations=others), only, part, answered
            )
        except (InputError, SolveError) as error:
            cases[name] = _without_answer(case, error)
    return replace(found, cases=cases)


def _misfires(
    study: Study, only: Collection[str], progress: Progress, answered: Callable[..., Any] | None
) -> Findings:
    """The findings of a study, without its cases.

    Where every cylinder of an engine is to misfire in turn, it is computed once for each: the checks are the worst of
    all with the barred ranges of all, no analysis without an answer is dropped, and all else is of the cylinder with
    the worst of these.
    """
    if not any(part.engine is not None and part.engine.tries_all for part in study.train.parts):
        return _one(study, only, progress, answered)
    from torsion.model.engine.misfire_cases import misfire_cases

    each = list(misfire_cases(study.train.parts, study.train.torques))
    return _worst(
        {
            words: _one(
                replace(study, train=replace(study.train, parts=parts, torques=torques)),
                only,
                _part_of(progress, words, (place, len(each))),
                answered,
            )
            for place, (words, parts, torques) in enumerate(each)
        }
    )


def _worst(cases: Mapping[str, Findings]) -> Findings:
    """The findings of the case with the worst check, its checks replaced by the worst of all cases, each named."""
    lines = worst_checks({words: found.need(Checks).lines for words, found in cases.items()})
    named = [
        replace(
            check,
            misfire=words,
            note="; ".join(filter(None, (words, check.note))),
            barred=_united(check.barred),
        )
        for words, check in lines.values()
    ]
    worst = max(lines.values(), key=lambda line: rank(line[1]))[0] if lines else next(iter(cases))
    found = cases[worst]
    unanswered = {one.analysis: one for case in cases.values() for one in case.plan.unanswered}
    left_out = dict.fromkeys(
        (*found.plan.left_out, *((one.what, one.words) for one in unanswered.values()))
    )
    plan = replace(found.plan, unanswered=tuple(unanswered.values()), left_out=tuple(left_out))
    whole = replace(found, plan=plan).having(checks=Checks(tuple(named)))
    first = next(iter(cases.values())).results.get("engines")  # that which has the misfires
    if first is None:
        return whole
    pairs = zip(found.results["engines"].each, first.each, strict=True)
    return whole.having(
        engines=replace(
            first, each=tuple(replace(own, superposed=one.superposed) for own, one in pairs)
        )
    )


def _united(bands: Iterable[BarredRange]) -> tuple[BarredRange, ...]:
    """Barred ranges of a shaft, those of one order that overlap as one, from the lowest to the highest speed."""
    found: list[BarredRange] = []
    for band in sorted(bands, key=lambda one: (one.shaft, one.order or 0, one.lower)):
        last = found[-1] if found else None
        if (
            last is None
            or (last.shaft, last.order) != (band.shaft, band.order)
            or band.lower > last.upper
        ):
            found.append(band)
            continue
        ends = [min(last.lower, band.lower), max(last.upper, band.upper)]
        formula = [
            min(last.formula_lower, band.formula_lower),
            max(last.formula_upper, band.formula_upper),
        ]
        found[-1] = replace(
            last, lower=ends[0], upper=ends[1], formula_lower=formula[0], formula_upper=formula[1]
        )
    return tuple(found)


def _part_of(progress: Progress, name: str, place: tuple[int, int]) -> Progress:
    """The progress of one of several runs as a share of that of all."""
    at, total = place
    return lambda what, share: progress(f"{name}{': ' if what else ''}{what}", (at + share) / total)


def _without_answer(case: Study, error: InputError | SolveError) -> Findings:
    """The findings of a case that has none, whose plan says why."""
    name = case.case.name if case.case is not None else ""
    if isinstance(error, InputError):
        why = "; ".join(_message(fault, case) for fault in error.faults)
        remedy, text = "; ".join(fault.hint for fault in error.faults if fault.hint), str(error)
    else:
        why, remedy, text = error.message, error.hint, error.located or str(error)
    one = Unanswered(
        "", f"case '{name}'", why, remedy, None, True, isinstance(error, InputError), text
    )
    return Findings(case, {}, Plan((), ((one.what, one.words),), {}, (one,)))


def _message(fault: Fault, study: Study) -> str:
    """The message of a fault, without the case that it is of."""
    return (
        fault.message.removeprefix(f"case '{study.case.name}': ")
        if study.case is not None
        else fault.message
    )


def _one(
    study: Study,
    only: Collection[str],
    progress: Progress,
    answered: Callable[..., Any] | None = None,
) -> Findings:
    """The findings of a study with its cylinders as they are, without its cases."""
    names = _with_needs(only) if only else list(ANALYSES)
    judged = replace(
        study,
        rules=tuple(pair for pair in study.rules if set(rules.rule(*pair).needs) <= set(names)),
    )
    work = Work(
        judged,
        {},
        progress=progress,
        ruled=rules.needed(judged),
        rules=judgement,
        solve=run,
        answered=answered,
    )
    for name, _ in study.rules:
        if name not in dict(judged.rules):
            work.log.without(f"the rule {name}", "what it reads is not requested")
    errors = []
    try:
        with collected() as citations:
            for name in ordered({key: ANALYSES[key] for key in names}):
                analysis = ANALYSES[name]
                if name in study.analyses or name in only or analysis.wanted(study):
                    try:
                        analysis.function()(work)
                    except (InputError, SolveError) as error:
                        if name in work.ruled or name in ESSENTIAL:
                            raise
                        errors.append(error)
                        work.log.unanswered.append(one := _unanswered(study, name, analysis, error))
                        work.log.without(one.what, one.words)
            if errors and not any(work.results.get(key) is not None for key in ANSWERS):
                raise errors[0]
            _judge(work)
    except InputError as error:
        raise located(error, study) from None
    except SolveError as error:
        if error.path and study.text:
            error.located = str(
                located(InputError([Fault(error.path, error.message, error.hint)]), study)
            )
        raise
    plan = replace(work.log.plan(), sources=used_sources(study, citations, work.need(Checks)))
    found = Findings(study, work.results, plan)
    return _with_demanded_speeds(found, judged, progress)


def used_sources(study: Study, citations: Citations, checks: Checks) -> tuple[UsedSource, ...]:
    """Return the literature of the train and of its analyses by key, then the editions of the rules that judged."""
    places: dict[str, dict[str, None]] = {}
    for key, where in (*study.train.sources, *citations):
        places.setdefault(key, {})[where] = None
    literature = [
        UsedSource(key, SOURCES[key].words, tuple(filter(None, places[key])), SOURCES[key].compared)
        for key in sorted(places)
    ]
    clauses: dict[tuple[str, str], dict[str, bool]] = {}
    for check in checks.lines:
        if check.basis is not None and check.basis.kind in ("text", "confirmed", "unconfirmed"):
            compared = clauses.setdefault((check.rule, check.basis.edition), {})
            compared[check.clause] = (
                compared.get(check.clause, True) and check.basis.kind != "unconfirmed"
            )
    editions = [
        UsedSource(rule, words, tuple(compared), all(compared.values()), is_rule=True)
        for (rule, words), compared in clauses.items()
    ]
    return (*literature, *editions)


def _with_demanded_speeds(found: Findings, study: Study, progress: Progress) -> Findings:
    """The findings with the worst of each check up to the speeds that its rule demands above those of the operation.

    They are computed for the rules alone. Where they have no answer, the checks of those rules are not judged there.
    """
    above = demanded_study(study)
    if above is None or above.operation.speeds is None:
        return found
    end, names = in_rpm(above.operation.speeds.last), [name for name, _ in above.rules]
    mine = [check for check in found.need(Checks).lines if check.rule in names]
    start = time.perf_counter()
    try:
        analyses = rules.needed(above) | _beside_response(above)
        above = replace(
            above, analyses={name: one for name, one in study.analyses.items() if name in analyses}
        )
        if faults := study_faults(above):
            raise InputError(faults)
        further = _one(above, analyses, progress).need(Checks).lines
    except (InputError, SolveError) as error:
        why = error.faults[0].message if isinstance(error, InputError) else error.message
        rows = {(check.rule, check.where): _not_computed(check, end, why) for check in mine}
        further = tuple(rows.values())
    own = f"above `operation.speeds`, computed up to {end} for the rule"
    worst = worst_checks(
        {"": tuple(mine), own: tuple(check for check in further if check.rule in names)}
    )
    merged = tuple(
        replace(check, note="; ".join(filter(None, (words, check.note))))
        if words and not math.isnan(check.value)
        else check
        for words, check in worst.values()
    )
    others = tuple(check for check in found.need(Checks).lines if check.rule not in names)
    line = PlanLine(
        f"speeds up to {end}",
        "the same model",
        f"{len(further)} checks",
        time.perf_counter() - start,
        f"{', '.join(names)}: demanded above `operation.speeds`",
    )
    plan = replace(found.plan, done=(*found.plan.done, line))
    return replace(found, plan=plan).having(checks=Checks(_in_order(study, (*others, *merged))))


def _in_order(study: Study, checks: Iterable[Check]) -> tuple[Check, ...]:
    """The checks in the order of the rules of the study, those of rules that need no name first."""
    order = {name: place for place, (name, _) in enumerate(study.rules)}
    return tuple(sorted(checks, key=lambda check: order.get(check.rule, -1)))


def _beside_response(study: Study) -> frozenset[str]:
    """Analyses that change the response, of those that a rule of vibration reads."""
    names = ("engine", "coupling temperatures", "nonlinear peaks")
    return frozenset(
        name for name in names if name in study.analyses or ANALYSES[name].wanted(study)
    )


def _not_computed(check: Check, end: str, why: str) -> Check:
    """The row of the speeds that a rule demands and that have no answer."""
    what = "Torsional stress amplitude above the computed speeds"
    row = unjudged(
        check.rule, "speeds", check.where, what, f"demanded up to {end}: {why}", check.standing
    )
    return replace(row, basis=check.basis)


def _unanswered(
    study: Study, name: str, analysis: Analysis, error: InputError | SolveError
) -> Unanswered:
    """The error, located in the file where it says its place or the file names the analysis."""
    place = analysis.place or ("analyses", name)
    by_default = name == "steady" or (not study.analyses and name in DEFAULT)
    named = by_default or study.setting(*place) is not None
    if isinstance(error, InputError):
        faults = list(error.faults)
    else:
        faults = [
            Fault(
                error.path or (place if named and study.analyses else ()), error.message, error.hint
            )
        ]
    known = (
        located(InputError(faults), study)
        if all(fault.path for fault in faults)
        else InputError(faults, str(error))
    )
    why = "; ".join(
        _message(fault, study).removeprefix(f"{analysis.title}: ") for fault in known.faults
    )
    remedy = "; ".join(fault.hint for fault in known.faults if fault.hint)
    line = next((fault.line for fault in known.faults if not fault.file), None)
    return Unanswered(
        name, analysis.title, why, remedy, line, named, isinstance(error, InputError), str(known)
    )


def _with_needs(only: Collection[str]) -> list[str]:
    """The names, each behind those that it needs."""
    found: dict[str, None] = {}
    for name in only:
        if name not in ANALYSES:
            raise InputError(
                [Fault(("only",), f"no analysis is called '{name}'", ", ".join(ANALYSES))]
            )
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
        checks += (*found, *(with_basis(check, "") for check in unjudged_variants(work.study)))
        for rule in rules.of_study(work.study):
            clauses = dict.fromkeys(check.clause for check in found if check.rule == rule.name)
            verified = rule.settings.verified
            for clause in (verified.clauses or ()) if verified else ():
                if clause not in clauses:
                    reason = f"its clauses are {', '.join(clauses)}"
                    work.log.without(f"{rule.name}: verified clause '{clause}'", reason)
        for what, why in rules.not_judged(work.study):
            work.log.without(what, why)
    work.put(checks=Checks(checks))
