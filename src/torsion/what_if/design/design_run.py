"""A design: choices are tried, and the best is proven by the ordinary solution of the file with its values."""

import math
import time
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from torsion.analyses.undamped_modes import Modes, without_mode
from torsion.arrays import FloatArray
from torsion.errors import InputError, SolveError
from torsion.findings import Findings, Work
from torsion.processes import processors
from torsion.study import Variation
from torsion.what_if.design.design_results import Candidate, ChosenFigure, Design
from torsion.what_if.design.design_settings import DesignSettings
from torsion.what_if.design.search import search
from torsion.what_if.design.trials import Case, Trial, Trials, bare
from torsion.what_if.sweep.sweep_settings import SweepSettings
from torsion.what_if.variants.chunks import duration
from torsion.what_if.variants.one_by_one import TO_BE_VERIFIED, Answer, Answers
from torsion.what_if.variants.sampling import drawn, units

JUDGED, LOOKED_AT = 2000, 50_000  # trains where nothing else is said: judged, of frequencies alone
MOST_COMBINATIONS = 50_000  # of lists and steps, of which all are judged where nothing else is said
SAMPLES = 16  # of `sweep`, beside the file's own figures
TEN, TRIED = 10, 5  # best that are reported, and that are solved by themselves at most
APART = 0.02  # of a range, within which two choices are one
MISSED = 0.01, 1e-6  # by which the ordinary solution may differ: of a margin, of a frequency
MOST_FAULTS = 10


def run(work: Work) -> None:
    """Where the file was read with figures to choose."""
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
    modes = _modes(work, settings)
    sweep = study.variations.get("sweep") if settings.robust else None
    samples = np.empty((1, 0)) if sweep is None else _samples(work, sweep)
    trials = Trials(work, settings, variation, modes, sweep=sweep, samples=samples)
    trials.cases = dict(_cases(work, trials))
    with work.log.step("design", "the file names it") as step:
        begin = time.perf_counter()
        before = trials.as_it_stands()
        seconds = (time.perf_counter() - begin) / len(trials.cases)
        searched = len(trials.searched) * len(samples)
        most = settings.evaluations or _most(trials)
        if trials.judged:
            words = duration(most * seconds / processors())
            work.progress(f"design, trains solved separately: at most {words}", 0.0)
        trials.limit = max(most // searched, 20)
        method = search(trials)
        best = list(_best(trials))
        step.method = method
        step.size = f"{len(trials.done)} choices of {len(variation.figures)} figures"
    with work.log.step("design, solved by itself", "the search only finds it") as step:
        proofs = list(_proven(trials, best))
        step.size = f"{len(proofs)} files"
    work.put(design=_result(trials, before, best, proofs, method))


def _cases(work: Work, trials: Trials) -> Iterator[tuple[str, Case]]:
    """The file as it stands, and every case of it that is judged."""
    for name, study in {"": work.study, **work.study.cases}.items():
        own, variation = work, trials.variation
        if name:
            if study.case is None or not study.case.is_judged:
                continue
            own = replace(
                work, study=bare(study), results={}, ruled=work.rules.analyses_read(study)
            )
            variation = variation.in_case(study)
        sampled = variation if trials.sweep is None else trials.sweep.behind(variation)
        yield name, Case(study, own, variation, sampled)


def _most(trials: Trials) -> int:
    """Trains that are solved at most where the file does not say."""
    if not trials.judged:
        return LOOKED_AT
    combinations = math.prod(figure.places for figure in trials.variation.figures)
    trains = combinations * len(trials.searched) * len(trials.samples)
    return max(JUDGED, trains if combinations <= MOST_COMBINATIONS else 0)


def _modes(work: Work, settings: DesignSettings) -> int:
    """How many modes a trial has; raises InputError where the file computes fewer than are needed.

    Lumped shafts are divided for the last mode, so that frequencies are those of the ordinary solution only where a
    trial has as many modes.
    """
    found, target = work.get(Modes), settings.target
    there = 0 if found is None else len(found.frequency)
    wanted = [(("analyses", "design", "aim"), target[0].mode)] if target is not None else []
    wanted += [(("analyses", "design", "keep"), one.subject.mode) for one in settings.kept]
    for path, mode in wanted:
        if mode > there:
            raise InputError([without_mode(work.study, mode, there, path)])
    return max((mode for _, mode in wanted), default=0) if target is None else there


def _samples(work: Work, sweep: Variation) -> FloatArray:
    """(samples, figures) of the sweep, the file's own first."""
    seed = work.settings("sweep", SweepSettings).seed
    unit = units(SAMPLES, 1 + max(one.column for one in sweep.figures), "latin", seed)
    own = [
        one.nominal if np.isfinite(one.nominal) else one.at(np.array([0.5]))[0]
        for one in sweep.figures
    ]
    return np.vstack([own, drawn(sweep.figures, unit)])


def _best(trials: Trials) -> Iterator[Trial]:
    """The ten best, none of them beside a better one."""
    figures, kept = trials.variation.figures, list[FloatArray]()
    width = np.array(
        [
            0.5 * float(np.diff(one.every()).min(initial=1.0))
            if one.rows
            else 0.5 * float(np.diff(one.every()).min())
            if one.places
            else APART * one.law.width
            for one in figures
        ]
    )
    for one in trials.best:
        row = np.array(one.values)
        if not any(np.all(np.abs(row - other) < width) for other in kept):
            kept.append(row)
            yield one
        if len(kept) == TEN:
            return


def _proven(trials: Trials, best: Sequence[Trial]) -> Iterator[tuple[str, float, str]]:
    """Of the best until one is as the search has it: kept, not kept or disagrees; the margin, and the verdict."""
    for one in best[:TRIED]:
        said, aim, verdict = _solved(trials, one)
        yield said, aim, verdict
        if said != "disagrees":
            return


def _solved(trials: Trials, one: Trial) -> tuple[str, float, str]:
    """A choice solved as a file of its own, with every case of it that is judged."""
    if trials.work.solve is None:
        raise LookupError("nothing solves")
    worst, kept, verdicts = None, True, list[str]()
    for name, case in trials.cases.items():
        words = f"case {name}: " if name else ""
        try:
            found = trials.work.solve(case.variation.study(list(one.values)))
        except (InputError, SolveError) as error:
            return "disagrees", math.nan, f"{words}no answer: {str(error).splitlines()[0]}"
        own = Answers.unknown(trials.modes, 1)
        own.keep(0, Answer.of(found))
        again = trials.judge(own, np.array([[one.mass, one.cost]]), of_case=bool(name))
        kept &= not (found.failed or found.is_partial or found.plan.unanswered)
        kept &= bool(again.allowed[0])
        if name in trials.searched and (worst is None or again.score[0] < worst.score[0]):
            worst = again
        verdicts.append(f"{words}{_verdict(found)}")
    aim, score = (
        (math.nan, math.nan) if worst is None else (float(worst.aim[0]), float(worst.score[0]))
    )
    nearby = abs(score - one.nominal_score) <= MISSED[0 if trials.judged else 1]
    agrees = nearby and (not trials.judged or not one.is_allowed or kept)
    return ("kept" if kept else "not kept") if agrees else "disagrees", aim, "; ".join(verdicts)


def _verdict(found: Findings) -> str:
    """How many checks there are of each verdict, and what has no answer."""
    unknown = "".join(f"; no answer: {one.what}" for one in found.plan.unanswered)
    return f"{found.results['checks'].counts}{unknown}"


def _result(
    trials: Trials,
    before: Trial | None,
    best: Sequence[Trial],
    proofs: Sequence[tuple[str, float, str]],
    method: str,
) -> Design:
    settings, figures = trials.settings, trials.variation.figures
    at = next((k for k, (said, *_) in enumerate(proofs) if said != "disagrees"), None)
    picked = () if at is None else best[at].values
    done, target = list(trials.done.values()), settings.target
    amounts = np.array(
        [getattr(one, settings.against) if settings.against else np.nan for one in done]
    )
    aims, allowed = np.array([one.aim for one in done]), np.array([one.is_allowed for one in done])
    front = _front(amounts, np.where([one.score > -50.0 for one in done], aims, np.nan))
    uncounted = [
        f"{where}: {clause}, {rule}"
        for (rule, clause, where, _), said in trials.standing.items()
        if said == TO_BE_VERIFIED
    ]
    return Design(
        "the greatest smallest margin"
        if target is None
        else f"{target[0].name} at {target[1]:.6g} Hz",
        tuple(one.words for one in settings.kept),
        method,
        len(done),
        len(done) * len(trials.samples) * len(trials.searched),
        trials.unsolved,
        tuple(trials.faults)[:MOST_FAULTS],
        tuple(
            ChosenFigure(
                one.name,
                one.law.words,
                one.words(one.nominal) if np.isfinite(one.nominal) else "",
                one.words(value) if picked else "",
            )
            for one, value in zip(figures, picked or [0.0] * len(figures), strict=True)
        ),
        _known(before.aim) if before is not None and target is None else None,
        _known(before.frequency) if before is not None else None,
        tuple(
            _candidate(trials, one, *(proofs[k] if k < len(proofs) else ("", math.nan, ""))[:2])
            for k, one in enumerate(best)
        ),
        None if at is None else at + 1,
        proofs[at][2] if at is not None else "; ".join(one[2] for one in proofs),
        tuple(dict.fromkeys(uncounted)),
        settings.against or "",
        amounts[front],
        aims[front],
        np.array([one.values for one in done]),
        aims,
        amounts,
        allowed,
        tuple(tuple(row.label for row in one.rows) for one in figures),
        tuple(one.law.unit for one in figures),
        np.array(picked),
        tuple(name for name in trials.cases if name),
        set(trials.cases) == set(trials.searched),
    )


def _candidate(trials: Trials, one: Trial, said: str, aim: float) -> Candidate:
    rule, clause, where, what = one.decides or ("", "", "", "")
    sample = trials.samples[one.worst]
    varied = () if trials.sweep is None else trials.sweep.figures
    worst = ", ".join(
        f"{figure.name} {figure.words(value)}" for figure, value in zip(varied, sample, strict=True)
    )
    worst = worst if one.worst else "as in the file" if varied else ""
    is_margin = trials.judged
    return Candidate(
        tuple(
            figure.words(value)
            for figure, value in zip(trials.variation.figures, one.values, strict=True)
        ),
        _known(one.aim) if is_margin else None,
        f"{where}: {what} ({clause}, {rule})" if rule else "",
        ", ".join(filter(None, (f"case {one.case}" if one.case else "", worst))),
        _known(one.frequency),
        _known(one.mass),
        _known(one.cost),
        one.is_allowed,
        said,
        _known(aim) if is_margin and said else None,
    )


def _known(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _front(amounts: FloatArray, aims: FloatArray) -> list[int]:
    """Places of the choices than which no lighter or cheaper one is as good, by their amount."""
    found, best = list[int](), -math.inf
    for place in np.lexsort((-aims, amounts)).tolist():
        if np.isfinite(amounts[place]) and aims[place] > best:
            best = float(aims[place])
            found.append(place)
    return found
