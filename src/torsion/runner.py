"""A study to its findings: only what is requested, and what that needs, is computed."""

import math
import time
from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from torsion.analyses import ANALYSES, ordered
from torsion.errors import Fault, InputError, SolveError, nearest
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
from torsion.rules import needed, not_judged, of_study, rule, standing_verdicts, verdicts
from torsion.rules.verdict_line import (
    VERIFIED_CLAUSE,
    BarredRange,
    Check,
    Checks,
    rank,
    with_basis,
    worst_checks,
)
from torsion.schema.scene_reader import located, read
from torsion.schema.study_faults import study_faults
from torsion.sources import SOURCES, Citations, collected
from torsion.study import Study, bytes_of
from torsion.user_files import printable

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
    total, cases = 1 + len(study.cases), dict[str, Findings]()
    part = _share(progress, f"case {NORMAL}", 0, total) if study.cases else progress
    findings = _solve_misfires(study, only, part, answered)
    for position, (name, case) in enumerate(study.cases.items(), start=1):
        part = _share(progress, f"case {name}", position, total)
        part("", 0.0)
        # A design is over all cases together.
        varied = {key: value for key, value in case.variations.items() if key != "design"}
        varied_case = replace(case, memory=study.memory, variations=varied)
        try:
            cases[name] = _solve_misfires(varied_case, only, part, answered)
        except (InputError, SolveError) as error:
            unanswered = _unanswered(case, "", error)
            left_out = ((unanswered.what, unanswered.words),)
            cases[name] = Findings(case, {}, Plan((), left_out, {}, (unanswered,)))
    return replace(findings, cases=cases)


def _solve_misfires(
    study: Study, only: Collection[str], progress: Progress, answered: Callable[..., Any] | None
) -> Findings:
    """Return the findings of a study, without its cases.

    If every cylinder of an engine is to misfire in turn, it is computed once for each: the checks are the worst of
    all with the barred ranges of all, no analysis without an answer is dropped, and all else is of the cylinder with
    the worst of these.
    """
    if not any(part.engine is not None and part.engine.tries_all for part in study.train.parts):
        return _solve_one(study, only, progress, answered)
    from torsion.model.engine.misfire_cases import misfire_cases

    cases, misfires = {}, list(misfire_cases(study.train.parts, study.train.torques))
    for position, (name, parts, torques) in enumerate(misfires):
        case = replace(study, train=replace(study.train, parts=parts, torques=torques))
        part = _share(progress, name, position, len(misfires))
        cases[name] = _solve_one(case, only, part, answered)
    return _select_worst(cases)


def _select_worst(cases: Mapping[str, Findings]) -> Findings:
    """Return the findings of the case with the worst check, with the worst check of all cases, each named."""
    lines = worst_checks({name: case.need(Checks).lines for name, case in cases.items()})
    checks = tuple(
        replace(
            check,
            misfire=name,
            note=f"{name}; {check.note}" if check.note else name,
            barred=merge_barred_ranges(check.barred),
        )
        for name, check in lines.values()
    )
    # A row that follows from the file alone, which all cases have, says nothing about a cylinder.
    judged = [line for line in lines.values() if line[1].fails or not math.isnan(line[1].value)]
    worst = max(judged, key=lambda line: rank(line[1]))[0] if judged else next(iter(cases))
    findings = cases[worst]
    unanswered = {
        answer.analysis: answer for case in cases.values() for answer in case.plan.unanswered
    }
    omitted = ((answer.what, answer.words) for answer in unanswered.values())
    plan = replace(
        findings.plan,
        unanswered=tuple(unanswered.values()),
        left_out=tuple(dict.fromkeys((*findings.plan.left_out, *omitted))),
    )
    united = replace(findings, plan=plan).having(checks=Checks(checks))
    superposing = next(iter(cases.values())).results.get("engines")  # the case with the misfires
    if superposing is None:
        return united
    pairs = zip(findings.results["engines"].each, superposing.each, strict=True)
    engines = tuple(replace(engine, superposed=first.superposed) for engine, first in pairs)
    return united.having(engines=replace(superposing, each=engines))


def merge_barred_ranges(ranges: Iterable[BarredRange]) -> tuple[BarredRange, ...]:
    """Merge overlapping barred ranges of the same shaft and order; sorted by shaft, order and speed."""
    merged: list[BarredRange] = []
    for barred in sorted(ranges, key=lambda row: (row.shaft, row.order or 0, row.lower)):
        previous = merged[-1] if merged else barred
        is_same = (previous.shaft, previous.order) == (barred.shaft, barred.order)
        if not merged or not is_same or barred.lower > previous.upper:
            merged.append(barred)
            continue

        # The misfire of each cylinder has its own barred range; the tachometer is marked once, from end to end.
        merged[-1] = replace(
            previous,
            upper=max(previous.upper, barred.upper),
            formula_lower=min(previous.formula_lower, barred.formula_lower),
            formula_upper=max(previous.formula_upper, barred.formula_upper),
        )
    return tuple(merged)


def _share(progress: Progress, name: str, position: int, total: int) -> Progress:
    """Return the progress of one of `total` runs as a share of the progress of all."""
    return lambda what, share: progress(
        f"{name}{': ' if what else ''}{what}", (position + share) / total
    )


def _solve_one(
    study: Study,
    only: Collection[str],
    progress: Progress,
    answered: Callable[..., Any] | None = None,
) -> Findings:
    """Return the findings of a study with its cylinders as they are, without its cases."""
    names = _with_dependencies(only) if only else ANALYSES
    judged_rules = (entry for entry in study.rules if {*rule(*entry).needs} <= {*names})
    judged = replace(study, rules=tuple(judged_rules))
    work = Work(
        judged,
        progress=progress,
        ruled=needed(judged),
        solve=run,
        answered=answered,
    )
    for name, _ in study.rules:
        if name not in dict(judged.rules):
            work.log.without(f"the rule {name}", "what it reads is not requested")
    try:
        with collected() as citations:
            _run_analyses(work, study, only, names)
            _judge(work)
    except InputError as error:
        raise located(error, study) from None
    except SolveError as error:
        if error.path and study.text:
            fault = Fault(error.path, error.message, error.hint)
            error.located = str(located(InputError([fault]), study))
        raise
    plan = replace(work.log.plan(), sources=used_sources(study, citations, work.need(Checks)))
    return _add_demanded_speeds(Findings(study, work.results, plan), judged, progress)


def _run_analyses(work: Work, study: Study, only: Collection[str], names: Collection[str]) -> None:
    """Run the analyses that are requested or needed; an error is raised if a rule reads it or nothing else answers."""
    errors = []
    for name in ordered({key: ANALYSES[key] for key in names}):
        analysis = ANALYSES[name]
        if not (name in study.analyses or name in only or analysis.is_wanted(study)):
            continue
        lacks = analysis.lacks and analysis.imported(analysis.lacks)
        if lacks and (why := lacks(study, work.system, work.ruled)):
            work.log.without(analysis.title, why)
            continue
        try:
            analysis.imported(analysis.run)(work)
        except (InputError, SolveError) as error:
            if name in work.ruled or name in ESSENTIAL:
                raise
            errors.append(error)
            unanswered = _unanswered(study, name, error)
            work.log.unanswered.append(unanswered)
            work.log.without(unanswered.what, unanswered.words)
    if errors and not any(work.results.get(key) is not None for key in ANSWERS):
        raise errors[0]


def used_sources(study: Study, citations: Citations, checks: Checks) -> tuple[UsedSource, ...]:
    """Return the literature of the train and of its analyses by key, then the editions of the rules that judged."""
    places: dict[str, dict[str, None]] = {}
    for key, where in (*study.train.sources, *citations):
        places.setdefault(key, {})[where] = None
    literature = (
        UsedSource(key, SOURCES[key].words, tuple(filter(None, places[key])), SOURCES[key].compared)
        for key in sorted(places)
    )
    clauses: dict[tuple[str, str], dict[str, bool]] = {}
    for check in checks.lines:
        if check.basis is not None and check.basis.kind in ("text", "confirmed", "unconfirmed"):
            compared = clauses.setdefault((check.rule, check.basis.edition), {})
            compared.setdefault(check.clause, True)
            compared[check.clause] &= check.basis.kind != "unconfirmed"
    editions = (
        UsedSource(rule, words, tuple(compared), all(compared.values()), is_rule=True)
        for (rule, words), compared in clauses.items()
    )
    return (*literature, *editions)


def _add_demanded_speeds(findings: Findings, study: Study, progress: Progress) -> Findings:
    """Return the findings with the worst of each check up to the speeds that its rule demands above the operation.

    They are computed for the rules only. If they have no answer, the checks of those rules are not judged there.
    """
    if not study.rules:
        return findings
    from torsion.rules.demands import demanded_study, in_rpm, unjudged

    above = demanded_study(study)
    if above is None or above.operation.speeds is None:
        return findings
    end, names = in_rpm(above.operation.speeds.last), [name for name, _ in above.rules]
    lines = findings.need(Checks).lines
    demanding = tuple(check for check in lines if check.rule in names)
    unchanged = tuple(check for check in lines if check.rule not in names)
    start = time.perf_counter()
    try:
        # With them go those that change the response, where the rules of vibration read it.
        analyses = needed(above) | {
            name
            for name in ("engine", "coupling temperatures", "nonlinear peaks")
            if name in above.analyses or ANALYSES[name].is_wanted(above)
        }
        settings = {name: value for name, value in study.analyses.items() if name in analyses}
        above = replace(above, analyses=settings)
        if faults := study_faults(above):
            raise InputError(faults)
        further = _solve_one(above, analyses, progress).need(Checks).lines
    except (InputError, SolveError) as error:
        why = error.faults[0].message if isinstance(error, InputError) else error.message
        what, rows = "Torsional stress amplitude above the computed speeds", dict[Any, Check]()
        for check in demanding:
            reason = f"demanded up to {end}: {why}"
            row = unjudged(check.rule, "speeds", check.where, what, reason, check.standing)
            rows[check.rule, check.where] = replace(row, basis=check.basis)
        further = tuple(rows.values())

    origin = f"above `operation.speeds`, computed up to {end} for the rule"
    further_demanding = tuple(check for check in further if check.rule in names)
    merged = (
        replace(check, note=f"{words}; {check.note}" if check.note else words)
        if words and not math.isnan(check.value)
        else check
        for words, check in worst_checks({"": demanding, origin: further_demanding}).values()
    )
    line = PlanLine(
        f"speeds up to {end}",
        "the same model",
        f"{len(further)} checks",
        time.perf_counter() - start,
        f"{', '.join(names)}: demanded above `operation.speeds`",
    )
    # The order of the rules of the study; checks of rules that need no name come first.
    order = {name: position for position, (name, _) in enumerate(study.rules)}
    checks = sorted((*unchanged, *merged), key=lambda check: order.get(check.rule, -1))
    plan = replace(findings.plan, done=(*findings.plan.done, line))
    return replace(findings, plan=plan).having(checks=Checks(tuple(checks)))


def _unanswered(study: Study, name: str, error: InputError | SolveError) -> Unanswered:
    """Return cause, remedy and line of an error, without the names of the case and of the analysis it is of.

    name: of the analysis, whose error is located in the file if it says its place or the file names the analysis;
    empty for a whole case.
    """
    is_named, title, known = True, "", error
    if name:
        path, title = ANALYSES[name].place or ("analyses", name), ANALYSES[name].title
        by_default = name == "steady" or (not study.analyses and name in DEFAULT)
        is_named = by_default or study.setting(*path) is not None
        if isinstance(error, SolveError):
            place = error.path or (path if is_named and study.analyses else ())
            known = InputError([Fault(place, error.message, error.hint)], str(error))
        if isinstance(known, InputError) and all(fault.path for fault in known.faults):
            known = located(InputError(known.faults), study)
    if isinstance(known, InputError):
        faults, text = known.faults, str(known)
    else:
        faults = (Fault((), known.message, known.hint),)
        text = known.located or str(known)
    case = study.case.name if study.case is not None else ""
    messages = (
        fault.message.removeprefix(f"case '{case}': ").removeprefix(f"{title}: ")
        for fault in faults
    )
    return Unanswered(
        name,
        title or f"case '{case}'",
        "; ".join(messages),
        "; ".join(fault.hint for fault in faults if fault.hint),
        next((fault.line for fault in faults if not fault.file), None) if name else None,
        is_named,
        isinstance(error, InputError),
        text,
    )


def _with_dependencies(only: Collection[str]) -> list[str]:
    """Return the names, each after the names of the analyses that it needs; raise InputError for an unknown name."""
    names: dict[str, None] = {}
    for name in only:
        if name not in ANALYSES:
            fault = Fault(("only",), f"no analysis is called '{name}'", ", ".join(ANALYSES))
            raise InputError([fault])
        names |= dict.fromkeys([*_with_dependencies(ANALYSES[name].needs), name])
    return list(names)


def _judge(work: Work) -> None:
    """Return the verdicts of the rules: of those that always hold, and of those that the file names."""
    checks = standing_verdicts(work)
    if not work.study.rules:
        work.log.without("rules", "the file names none")
    else:
        with work.log.step("rules", "the file names them") as step:
            checks_found = verdicts(work)
            step.method = ", ".join(name for name, _ in work.study.rules)
            step.size = f"{len(checks_found)} checks"
        from torsion.rules.demands import unjudged_variants

        of_variants = (with_basis(check, "") for check in unjudged_variants(work.study))
        checks += (*checks_found, *of_variants)
        for judging in of_study(work.study):
            judged = (check.clause for check in checks_found if check.rule == judging.name)
            clauses = dict.fromkeys(judged)
            verified = judging.settings.verified
            for clause in (verified.clauses or ()) if verified else ():
                if clause not in clauses:
                    near = nearest(clause, clauses)
                    reason = f"did you mean '{near}'? " if near else ""
                    reason += f"its clauses are {', '.join(clauses)}"
                    work.log.without(f"{judging.name}: {VERIFIED_CLAUSE} '{clause}'", reason)
        for what, why in not_judged(work.study):
            work.log.without(what, why)
    work.put(checks=Checks(checks))


def solved(
    file: str | Path,
    *,
    case: str | None = None,
    memory: str | float | None = None,
    progress: Progress = silent,
) -> Findings:
    """Read, solve and judge a scene; nothing is written. memory: as of `run`; case: one alone, "normal" without any."""
    study = read(file)
    return run(study if case is None else one_case(study, case), memory=memory, progress=progress)


def one_case(study: Study, case: str | None) -> Study:
    """Return the study without its cases, or one of them; raise InputError where none goes by that name."""
    if case is None or (case == NORMAL and study.cases):
        return replace(study, cases={})
    if case in study.cases:
        return study.cases[case]
    hint = "a file states them under `cases: {...}`"
    if near := nearest(case, study.cases):
        hint = f"did you mean '{near}'?"
    elif study.cases:
        hint = f"there is {', '.join((NORMAL, *study.cases))}"
    fault = Fault(("cases",), f"no case is called '{printable(case)}'", hint, at_key=True)
    raise located(InputError([fault]), study)
