"""A design: candidates are tried, and the best is solved and judged the ordinary way as a file with its values."""

import math
import time
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import chain, repeat

import numpy as np

from torsion.analyses.undamped_modes import Modes, without_mode
from torsion.arrays import FloatArray
from torsion.errors import InputError, SolveError
from torsion.findings import Work
from torsion.processes import processors
from torsion.study import Variation
from torsion.what_if.design.candidates import Candidates, Case, Tried, bare
from torsion.what_if.design.design_results import Candidate, ChosenFigure, Design
from torsion.what_if.design.design_settings import DesignSettings
from torsion.what_if.design.search import search
from torsion.what_if.sweep.sweep_settings import SweepSettings
from torsion.what_if.variants.chunks import TO_BE_VERIFIED, Answers, duration
from torsion.what_if.variants.laws import drawn, uniform_samples

JUDGED, LOOKED_AT = 2000, 50_000  # trains where nothing else is said: judged, of frequencies alone
MOST_COMBINATIONS = 50_000  # of lists and steps, of which all are judged where nothing else is said
SAMPLES = 16  # of `sweep`, in addition to the file's own figures
TEN, TRIED = 10, 5  # best that are reported, and that are solved separately at most
APART = 0.02  # of a range, within which two candidates are one
MISSED = 0.01, 1e-6  # by which the ordinary solution may differ: of a margin, of a frequency
MOST_FAULTS = 10
Confirmation = tuple[str, float, str]  # kept, not kept or disagrees; the margin; the verdict


def run(work: Work) -> None:
    """Search, if the file was read with figures to choose."""
    study, settings = work.study, work.settings("design", DesignSettings)
    variation = study.variations.get("design")
    if variation is None or work.solve is None:
        of_all = study.case is not None and "design" in study.analyses
        why = (
            "searched once for the file and all its cases"
            if of_all
            else "no parameter of the file is a design variable"
        )
        work.log.without("design", why)
        return
    sweep = study.variations.get("sweep") if settings.robust else None
    samples = np.empty((1, 0)) if sweep is None else _samples(work, sweep)
    cases = dict(_cases(work, variation, sweep))
    modes = _modes(work, settings)
    candidates = Candidates(work, settings, variation, modes, sweep, samples, cases)
    with work.log.step("design", "the file names it") as step:
        begin = time.perf_counter()
        nominal = candidates.nominal()
        seconds = (time.perf_counter() - begin) / len(cases)
        searched = len(candidates.searched) * len(samples)
        combinations = math.prod(figure.places for figure in variation.figures)
        trains = combinations * searched if combinations <= MOST_COMBINATIONS else 0
        default = max(JUDGED, trains) if candidates.judged else LOOKED_AT
        evaluations = settings.evaluations or default
        if candidates.judged:
            words = duration(evaluations * seconds / processors())
            work.progress(f"design, trains solved separately: at most {words}", 0.0)
        candidates.limit = max(evaluations // searched, 20)
        method = search(candidates)
        best = _best(candidates)
        step.method = method
        step.size = f"{len(candidates.tried)} choices of {len(variation.figures)} figures"
    with work.log.step("design, solved by itself", "the search only finds it") as step:
        # The best are solved until one is as the search has it.
        confirmations = list[Confirmation]()
        for candidate in best[:TRIED]:
            confirmations.append(_solved(candidates, candidate))
            if confirmations[-1][0] != "disagrees":
                break
        step.size = f"{len(confirmations)} files"
    work.put(design=_result(candidates, nominal, best, confirmations, method))


def _cases(work: Work, variation: Variation, sweep: Variation | None) -> Iterator[tuple[str, Case]]:
    """Yield the nominal case, and every case of the file that is judged."""
    for name, study in {"": work.study, **work.study.cases}.items():
        case_work, chosen = work, variation
        if name:
            if study.case is None or not study.case.is_judged:
                continue
            ruled = work.rules.analyses_read(study)
            case_work = replace(work, study=bare(study), results={}, ruled=ruled)
            chosen = variation.in_case(study)
        yield name, Case(case_work, chosen, chosen if sweep is None else sweep.behind(chosen))


def _modes(work: Work, settings: DesignSettings) -> int:
    """Return how many modes a candidate has; raises InputError if the file computes fewer than are needed.

    Lumped shafts are divided for the last mode, so that frequencies are those of the ordinary solution only if a
    candidate has as many modes.
    """
    modes, target = work.get(Modes), settings.target
    computed = 0 if modes is None else len(modes.frequency)
    needed = [(("analyses", "design", "keep"), kept.subject.mode) for kept in settings.kept]
    if target is not None:
        needed.insert(0, (("analyses", "design", "aim"), target[0].mode))
    for path, mode in needed:
        if mode > computed:
            raise InputError([without_mode(work.study, mode, computed, path)])
    if target is not None:
        return computed
    return max((mode for _, mode in needed), default=0)


def _samples(work: Work, sweep: Variation) -> FloatArray:
    """Return (samples, figures) of the sweep, the file's own first."""
    seed = work.settings("sweep", SweepSettings).seed
    unit = uniform_samples(
        SAMPLES, 1 + max(figure.column for figure in sweep.figures), "latin", seed
    )
    nominal = [
        figure.nominal if np.isfinite(figure.nominal) else figure.at(np.array([0.5]))[0]
        for figure in sweep.figures
    ]
    return np.vstack([nominal, drawn(sweep.figures, unit)])


def _best(candidates: Candidates) -> list[Tried]:
    """Return the ten best, none of them beside a better one."""
    widths = np.array(
        [
            0.5 * float(np.diff(figure.all_values()).min(initial=1.0 if figure.rows else np.inf))
            if figure.places
            else APART * np.ptp(figure.law.ends)
            for figure in candidates.variation.figures
        ]
    )
    best, rows = list[Tried](), list[FloatArray]()
    for candidate in candidates.best:
        row = np.array(candidate.values)
        if not any(np.all(np.abs(row - row_kept) < widths) for row_kept in rows):
            rows.append(row)
            best.append(candidate)
        if len(best) == TEN:
            break
    return best


def _solved(candidates: Candidates, candidate: Tried) -> Confirmation:
    """Solve a candidate as a file of its own, with every case of it that is judged."""
    if candidates.work.solve is None:
        raise LookupError("nothing solves")
    worst, kept, verdicts = (math.inf, math.nan), True, list[str]()
    for name, case in candidates.cases.items():
        words = f"case {name}: " if name else ""
        try:
            findings = candidates.work.solve(case.variation.study(list(candidate.values)))
        except (InputError, SolveError) as error:
            return "disagrees", math.nan, f"{words}no answer: {str(error).splitlines()[0]}"
        answers = Answers.of_findings(findings, candidates.modes)
        amounts = np.array([[candidate.mass, candidate.cost]])
        judged = candidates.judge(answers, amounts, of_case=bool(name))
        kept &= not (findings.failed or findings.is_partial or findings.plan.unanswered)
        kept &= bool(judged.allowed[0])
        if name in candidates.searched and judged.score[0] < worst[0]:
            worst = float(judged.score[0]), float(judged.aim[0])
        verdicts.append(f"{words}{findings.results['checks'].counts}")
        verdicts[-1] += "".join(
            f"; no answer: {analysis.what}" for analysis in findings.plan.unanswered
        )
    score, aim = worst
    is_near = abs(score - candidate.nominal_score) <= MISSED[0 if candidates.judged else 1]
    agrees = is_near and (not candidates.judged or not candidate.is_allowed or kept)
    return ("kept" if kept else "not kept") if agrees else "disagrees", aim, "; ".join(verdicts)


def _result(
    candidates: Candidates,
    nominal: Tried | None,
    best: Sequence[Tried],
    confirmations: Sequence[Confirmation],
    method: str,
) -> Design:
    settings, figures = candidates.settings, candidates.variation.figures
    chosen = next((k for k, (word, *_) in enumerate(confirmations) if word != "disagrees"), None)
    picked = () if chosen is None else best[chosen].values
    tried, target = list(candidates.tried.values()), settings.target
    amounts = np.array([getattr(candidate, settings.against or "", np.nan) for candidate in tried])
    aims = np.array([candidate.aim for candidate in tried])
    scores = np.array([candidate.score for candidate in tried])
    # The choices than which no lighter or cheaper one is as good, by their amount.
    front, greatest = list[int](), -math.inf
    good = np.where(scores > -50.0, aims, np.nan)
    for position in np.lexsort((-good, amounts)).tolist():
        if np.isfinite(amounts[position]) and good[position] > greatest:
            greatest = float(good[position])
            front.append(position)
    uncounted = (
        f"{where}: {clause}, {rule}"
        for (rule, clause, where, _), standing in candidates.standing.items()
        if standing == TO_BE_VERIFIED
    )
    chosen_figures = (
        ChosenFigure(
            figure.name,
            figure.law.words,
            figure.words(figure.nominal) if np.isfinite(figure.nominal) else "",
            figure.words(value) if picked else "",
        )
        for figure, value in zip(figures, picked or [0.0] * len(figures), strict=True)
    )
    unconfirmed: Confirmation = ("", math.nan, "")
    confirmed = zip(best, chain(confirmations, repeat(unconfirmed)), strict=False)
    aimed = "" if target is None else f"{target[0].name} at {target[1]:.6g} Hz"
    return Design(
        aimed or "the greatest smallest margin",
        tuple(condition.words for condition in settings.kept),
        method,
        len(tried),
        len(tried) * len(candidates.samples) * len(candidates.searched),
        candidates.unsolved,
        tuple(candidates.faults)[:MOST_FAULTS],
        tuple(chosen_figures),
        _finite(nominal.aim) if nominal is not None and target is None else None,
        _finite(nominal.frequency) if nominal is not None else None,
        tuple(_candidate(candidates, *pair) for pair in confirmed),
        None if chosen is None else chosen + 1,
        "; ".join(confirmation[2] for confirmation in confirmations)
        if chosen is None
        else confirmations[chosen][2],
        tuple(dict.fromkeys(uncounted)),
        settings.against or "",
        amounts[front],
        aims[front],
        np.array([candidate.values for candidate in tried]),
        aims,
        amounts,
        np.array([candidate.is_allowed for candidate in tried]),
        tuple(tuple(row.label for row in figure.rows) for figure in figures),
        tuple(figure.law.unit for figure in figures),
        np.array(picked),
        tuple(name for name in candidates.cases if name),
        set(candidates.cases) == set(candidates.searched),
    )


def _candidate(candidates: Candidates, tried: Tried, confirmation: Confirmation) -> Candidate:
    rule, clause, where, what = tried.decides or ("", "", "", "")
    varied = () if candidates.sweep is None else candidates.sweep.figures
    sample = zip(varied, candidates.samples[tried.worst], strict=True)
    worst = ", ".join(f"{figure.name} {figure.words(value)}" for figure, value in sample)
    if not tried.worst:
        worst = "as in the file" if varied else ""
    values = zip(candidates.variation.figures, tried.values, strict=True)
    word, margin, _ = confirmation
    return Candidate(
        tuple(figure.words(value) for figure, value in values),
        _finite(tried.aim) if candidates.judged else None,
        f"{where}: {what} ({clause}, {rule})" if rule else "",
        ", ".join(filter(None, (f"case {tried.case}" if tried.case else "", worst))),
        _finite(tried.frequency),
        _finite(tried.mass),
        _finite(tried.cost),
        tried.is_allowed,
        word,
        _finite(margin) if candidates.judged and word else None,
    )


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
