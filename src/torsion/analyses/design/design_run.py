"""A design: choices are tried, and the best is proven by the ordinary solution of the file with its values."""

import math
from collections.abc import Iterator, Sequence

import numpy as np

from torsion.analyses.design.design_results import Candidate, ChosenFigure, Design
from torsion.analyses.design.design_settings import DesignSettings
from torsion.analyses.design.search import search
from torsion.analyses.design.trials import Trial, Trials
from torsion.analyses.sweep.sweep_settings import SweepSettings
from torsion.analyses.undamped_modes import Modes
from torsion.analyses.variants.one_by_one import TO_BE_VERIFIED, Answers
from torsion.analyses.variants.sampling import units
from torsion.arrays import FloatArray
from torsion.errors import Fault, InputError, SolveError
from torsion.findings import Findings, Work
from torsion.study import Variation

JUDGED, UNJUDGED = 2000, 50_000  # trains solved where nothing else is said
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
        work.log.without("design", "no figure of the file is chosen")
        return
    modes = _modes(work, settings)
    sweep = study.variations.get("sweep") if settings.robust else None
    samples = np.empty((1, 0)) if sweep is None else _samples(work, sweep)
    most = settings.evaluations or (JUDGED if settings.target is None else UNJUDGED)
    trials = Trials(work, settings, variation, modes, max(most // len(samples), 20), sweep, samples)
    with work.log.step("design", "the file names it") as step:
        before = trials.as_it_stands()
        step.method = method = search(trials)
        step.size = f"{len(trials.done)} choices of {len(variation.figures)} figures"
    with work.log.step("design, solved by itself", "the search only finds it") as step:
        best = list(_best(trials))
        proofs = list(_proven(trials, best))
        step.size = f"{len(proofs)} files"
    work.put(design=_result(trials, before, best, proofs, method))


def _modes(work: Work, settings: DesignSettings) -> int:
    """How many modes are needed; raises InputError where the file computes fewer."""
    found, target = work.get(Modes), settings.target
    there = 0 if found is None else len(found.frequency)
    wanted = [(("analyses", "design", "aim"), target[0].mode)] if target is not None else []
    wanted += [(("analyses", "design", "keep"), one.subject.mode) for one in settings.kept]
    for path, mode in wanted:
        if mode > there:
            hint = f"`modes: {{count: {mode}}}`"
            raise InputError([Fault(path, f"mode {mode} is none of the {there} that are computed", hint)])
    return max((mode for _, mode in wanted), default=0)


def _samples(work: Work, sweep: Variation) -> FloatArray:
    """(samples, figures) of the sweep, the file's own first."""
    seed = work.settings("sweep", SweepSettings).seed
    drawn = units(SAMPLES, 1 + max(one.column for one in sweep.figures), "latin", seed)
    own = [one.nominal if np.isfinite(one.nominal) else one.at(np.array([0.5]))[0] for one in sweep.figures]
    return np.vstack([own, np.stack([one.at(drawn[:, one.column]) for one in sweep.figures], axis=1)])


def _best(trials: Trials) -> Iterator[Trial]:
    """The ten best, none of them beside a better one."""
    figures, kept = trials.variation.figures, list[FloatArray]()
    width = np.array([
        0.5 * float(np.diff(one.every()).min()) if one.places else APART * (one.law.ends[1] - one.law.ends[0])
        for one in figures
    ])  # fmt: skip
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
    """A choice solved as a file of its own."""
    if trials.work.solve is None:
        raise LookupError("nothing solves")
    try:
        found = trials.work.solve(trials.variation.study(list(one.values)))
    except (InputError, SolveError) as error:
        return "disagrees", math.nan, f"no answer: {str(error).splitlines()[0]}"
    own = Answers(np.full((trials.modes, 1), np.nan))
    own.keep(0, found)
    again = trials.judge(own, np.array([[one.mass, one.cost]]))
    is_margin, aim, score = trials.judged, float(again.aim[0]), float(again.score[0])
    nearby = abs(score - one.nominal_score) <= MISSED[0 if is_margin else 1]
    kept = not (found.failed or found.is_partial or found.plan.unanswered)
    agrees = nearby and (not is_margin or not one.is_allowed or kept)
    return ("kept" if kept else "not kept") if agrees else "disagrees", aim, _verdict(found)


def _verdict(found: Findings) -> str:
    """How many checks there are of each verdict, and what has no answer."""
    lines = found.results["checks"].lines
    counts = {
        name: sum(one.verdict == name for one in lines) for name in ("pass", "fail", "not kept", "in part", "outside")
    }
    words = ", ".join(f"{count} {name}" for name, count in counts.items() if count) or "no check"
    unknown = "".join(f"; no answer: {one.what}" for one in found.plan.unanswered)
    return f"{words}{unknown}"


def _result(
    trials: Trials, before: Trial | None, best: Sequence[Trial], proofs: Sequence[tuple[str, float, str]], method: str
) -> Design:  # fmt: skip
    settings, figures = trials.settings, trials.variation.figures
    at = next((k for k, (said, *_) in enumerate(proofs) if said != "disagrees"), None)
    picked = () if at is None else best[at].values
    done, target = list(trials.done.values()), settings.target
    amounts = np.array([getattr(one, settings.against) if settings.against else np.nan for one in done])
    aims, allowed = np.array([one.aim for one in done]), np.array([one.is_allowed for one in done])
    front = _front(amounts, np.where([one.score > -50.0 for one in done], aims, np.nan))
    uncounted = [
        f"{where}: {clause}, {rule}"
        for (rule, clause, where, _), said in trials.standing.items()
        if said == TO_BE_VERIFIED
    ]
    return Design(
        "the greatest smallest margin" if target is None else f"{target[0].name} at {target[1]:.6g} Hz",
        tuple(one.words for one in settings.kept), method, len(done), len(done) * len(trials.samples), trials.unsolved,
        tuple(trials.faults)[:MOST_FAULTS],
        tuple(
            ChosenFigure(one.name, one.law.words, one.words(one.nominal) if np.isfinite(one.nominal) else "",
                         one.words(value) if picked else "")
            for one, value in zip(figures, picked or [0.0] * len(figures), strict=True)
        ),
        _known(before.aim) if before is not None and target is None else None,
        _known(before.frequency) if before is not None else None,
        tuple(_candidate(trials, one, *(proofs[k] if k < len(proofs) else ("", math.nan, ""))[:2])
              for k, one in enumerate(best)),
        None if at is None else at + 1, proofs[at][2] if at is not None else "; ".join(one[2] for one in proofs),
        tuple(dict.fromkeys(uncounted)), settings.against or "", amounts[front], aims[front],
        np.array([one.values for one in done]), aims, amounts, allowed,
        tuple(tuple(row.label for row in one.rows) for one in figures), tuple(one.law.unit for one in figures),
        np.array(picked),
    )  # fmt: skip


def _candidate(trials: Trials, one: Trial, said: str, aim: float) -> Candidate:
    rule, clause, where, what = one.decides or ("", "", "", "")
    sample = trials.samples[one.worst]
    varied = () if trials.sweep is None else trials.sweep.figures
    worst = ", ".join(f"{figure.name} {figure.words(value)}" for figure, value in zip(varied, sample, strict=True))
    is_margin = trials.judged
    return Candidate(
        tuple(figure.words(value) for figure, value in zip(trials.variation.figures, one.values, strict=True)),
        _known(one.aim) if is_margin else None, f"{where}: {what} ({clause}, {rule})" if rule else "",
        worst if one.worst else "as in the file" if varied else "", _known(one.frequency), _known(one.mass),
        _known(one.cost), one.is_allowed, said, _known(aim) if is_margin and said else None,
    )  # fmt: skip


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
