"""A sweep: variants of the file solved one by one where they are judged, or all side by side where frequencies do."""

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from torsion.analyses.sweep.sampling import factors, probability, quantiles, units
from torsion.analyses.sweep.sweep_results import Sweep, SweptCheck, VariedFigure
from torsion.analyses.sweep.sweep_settings import CHECKED, SweepSettings
from torsion.analyses.undamped_modes import Modes
from torsion.arrays import BoolArray, FloatArray
from torsion.assembly.system import System
from torsion.errors import InputError, SolveError
from torsion.findings import Findings, Work
from torsion.kernels.tree import Tree
from torsion.study import Variation

UNJUDGED = 16384  # variants of frequencies alone
TRIALS = (1.07, 0.96)  # factors at which a figure is tried for how it enters the train
POWER = 1e-11  # relative, within which inertias and flexibilities are products of powers of the figures
LEAST_SPREAD = 1e-9  # of a share of a limit: below it nothing decides
MOST_FAULTS = 10
READ = "engine", "coupling temperatures", "nonlinear peaks", "stability", "joints", "lateral", "transient"  # by checks
Key = tuple[str, str, str, str]


def run(work: Work) -> None:
    """Where the file was read with figures that vary, and has modes or rules."""
    study, settings = work.study, work.settings("sweep", SweepSettings)
    variation, modes = study.variation, work.get(Modes)
    if variation is None or work.solve is None:
        work.log.without("sweep", "no figure of the file varies")
        return
    judged = "checks" in settings.results or (not settings.results and bool(study.rules))
    if judged and not study.rules:
        work.log.without("the probability that a check fails", "the file names no rules")
    count = settings.samples or (CHECKED if judged else UNJUDGED)
    drawn = units(count, 1 + max(one.column for one in variation.figures), settings.method, settings.seed)
    chosen = np.stack([factors(one.law, drawn[:, one.column]) for one in variation.figures], axis=1)
    with work.log.step("sweep", "the file names it") as step:
        nominal = np.empty(0) if modes is None else modes.frequency
        lines, faults = dict[Key, tuple[FloatArray, BoolArray]](), dict[int, str]()
        frequency = None if judged else _side_by_side(work.system, variation, chosen, nominal.size)
        if frequency is not None:
            step.method = "frequencies of all variants side by side, each certified by counts"
        else:
            frequency = np.full((nominal.size, count), np.nan)
            for place, found in enumerate(_each(work, work.solve, variation, chosen, judged)):
                if isinstance(found, str):
                    faults[place] = found
                else:
                    _keep(found, place, frequency, lines)
            step.method = "every variant solved" + (" and judged" if judged else "")
        step.size = f"{count} variants ({settings.method}) of {len(variation.figures)} figures"
    work.put(sweep=_summed(variation, settings, chosen, nominal, frequency, lines, faults))


def _each(
    work: Work, solve: Callable[..., Findings], variation: Variation, chosen: FloatArray, judged: bool
) -> Iterator[Findings | str]:  # fmt: skip
    """Of every variant its findings, or why it has none."""
    from torsion.analyses import ANALYSES

    own = [name for name in READ if name in work.study.analyses or ANALYSES[name].wanted(work.study)]
    only = ("modes", *((*work.ruled, *own) if judged else ()))
    begin = time.perf_counter()
    for place, factor in enumerate(chosen.tolist()):
        left = (time.perf_counter() - begin) / max(place, 1) * (len(chosen) - place)
        words = f", about {left:.0f} s left" if place else ""
        work.progress(f"sweep, variant {place + 1} of {len(chosen)}{words}", place / len(chosen))
        try:
            study = variation.study(factor)
            one = study if judged else replace(study, rules=())
            found = solve(one, only=only)
            yield "; ".join(f"{left.what}: {left.why}" for left in found.plan.unanswered) or found
        except (InputError, SolveError) as error:
            yield "; ".join(fault.message for fault in error.faults) if isinstance(error, InputError) else error.message


def _keep(found: Findings, place: int, frequency: FloatArray, lines: dict[Key, tuple[FloatArray, BoolArray]]) -> None:
    """Put the frequencies and the verdicts of a variant in its column."""
    own = found.get(Modes)
    if own is not None:
        here = own.frequency[: len(frequency)]
        frequency[: len(here), place] = here
    count = frequency.shape[1]
    for check in getattr(found.results.get("checks"), "lines", ()):
        if check.verdict == "outside":
            continue
        key = check.rule, check.clause, check.where, check.what
        used, fails = lines.setdefault(key, (np.full(count, np.nan), np.zeros(count, dtype=np.bool_)))
        used[place] = np.fmax(used[place], np.nan if check.utilisation is None else check.utilisation)
        fails[place] |= check.fails


def _summed(
    variation: Variation, settings: SweepSettings, factor: FloatArray, nominal: FloatArray, frequency: FloatArray,
    lines: dict[Key, tuple[FloatArray, BoolArray]], faults: dict[int, str],
) -> Sweep:  # fmt: skip
    """Statistics of what all variants gave."""
    names = [one.name for one in variation.figures]
    unsolved = np.zeros(len(factor), dtype=np.bool_)
    unsolved[list(faults)] = True
    checks = [
        _check(key, used, fails | unsolved, factor, names, settings.method) for key, (used, fails) in lines.items()
    ]
    whole = None
    if lines:
        used = np.fmax.reduce([one.utilisation for one in checks])
        fails = np.any([one.fails for one in checks], axis=0)
        whole = _check(("", "", "", "any check"), used, fails, factor, names, settings.method)
    known = frequency[:, np.isfinite(frequency).all(axis=0)] if frequency.size else frequency
    known = known if known.size else np.full((len(nominal), 1), np.nan)
    low, high = quantiles(known, (0.025, 0.975)).T.reshape(2, -1)
    return Sweep(
        tuple(VariedFigure(one.name, one.law.words, one.column + 1) for one in variation.figures), len(factor),
        settings.method, settings.seed, len(faults), tuple(dict.fromkeys(faults.values()))[:MOST_FAULTS], nominal,
        known.mean(axis=1), known.std(axis=1), low, high, known.min(axis=1), known.max(axis=1),
        tuple(sorted(checks, key=lambda one: (-one.probability, -(one.worst or 0.0)))), whole, factor, frequency,
    )  # fmt: skip


def _check(
    key: Key, used: FloatArray, fails: BoolArray, factor: FloatArray, names: Sequence[str], method: str
) -> SweptCheck:  # fmt: skip
    share, low, high = probability(fails, method)
    known = used[np.isfinite(used)]
    decides, correlation = _decides(used, factor)
    return SweptCheck(
        *key, int(fails.sum()), share, low, high, float(np.median(known)) if known.size else None,
        float(known.max()) if known.size else None, names[decides] if correlation is not None else "", correlation,
        used, fails,
    )  # fmt: skip


def _decides(used: FloatArray, factor: FloatArray) -> tuple[int, float | None]:
    """The figure whose ranks go most with those of the share of a limit, and how much."""
    known = np.isfinite(used)
    values = used[known]
    if values.size < 3 or np.ptp(values) <= LEAST_SPREAD * np.abs(values).max():
        return 0, None
    ranks = np.argsort(np.argsort(np.column_stack([values, factor[known]]), axis=0), axis=0).astype(float)
    found = np.corrcoef(ranks, rowvar=False)[0, 1:]
    best = int(np.argmax(np.abs(found)))
    return best, float(found[best])


def _side_by_side(system: System, variation: Variation, factor: FloatArray, count: int) -> FloatArray | None:
    """Frequencies (modes, variants) Hz by the kernel of many trains; None where it does not take them.

    Inertias and flexibilities have to be products of powers of the figures (a stiffness, a length, a diameter of a
    shaft whose inertia is not summed with another), which trials show.
    """
    if not count or system.bars is not None or system.tables or system.whole.condensed.extra.size:
        return None
    base = _tree(system)
    ones, powers = [1.0] * len(variation.figures), []
    for place in range(len(ones)):
        tried = [_tried(variation, system, [*ones[:place], one, *ones[place + 1 :]]) for one in TRIALS]
        power = _powers(base, tried)
        if power is None:
            return None
        powers.append(power)
    flexibility, inertia = (_product(own, [power[k] for power in powers], factor) for k, own in enumerate(_both(base)))
    last = _tried(variation, system, factor[-1].tolist())
    if last is None or not all(map(_same, _both(last), (flexibility[:, -1], inertia[:, -1]))):
        return None
    from torsion.kernels.variant_modes import variant_modes

    return variant_modes(base, flexibility, inertia, count).frequency / (2.0 * np.pi)


def _tree(system: System) -> Tree:
    from torsion.analyses.undamped_modes import undamped_tree

    return undamped_tree(system.whole)


def _tried(variation: Variation, system: System, factor: Sequence[float]) -> Tree | None:
    """The tree of a variant, as finely divided; None where its layout is another."""
    from torsion.assembly import rediscretised

    try:
        tree = _tree(rediscretised(replace(system, train=variation.study(factor).train), system.requested.frequency))
    except (InputError, SolveError):
        return None
    return tree if np.array_equal(tree.parent, _tree(system).parent) else None


def _both(tree: Tree) -> tuple[FloatArray, FloatArray]:
    return tree.flexibility, tree.moving_inertia


def _same(one: FloatArray, other: FloatArray) -> bool:
    return bool(np.allclose(one, other, rtol=POWER, atol=0.0))


def _powers(base: Tree, tried: Sequence[Tree | None]) -> tuple[FloatArray, FloatArray] | None:
    """The power of the figure in every flexibility and inertia; None where it enters otherwise."""
    found = []
    for own, *others in zip(_both(base), *(_both(one) for one in tried if one is not None), strict=True):
        used = (own > 0.0) & np.isfinite(own)
        if len(others) < len(TRIALS) or any(not np.array_equal(used, (one > 0.0) & np.isfinite(one)) for one in others):
            return None
        power = np.zeros(len(own))
        power[used] = np.log(others[0][used] / own[used]) / np.log(TRIALS[0])
        power = np.round(power, 9)
        if any(not _same(own * factor**power, one) for factor, one in zip(TRIALS, others, strict=True)):
            return None
        found.append(power)
    return found[0], found[1]


def _product(own: FloatArray, powers: Sequence[FloatArray], factor: FloatArray) -> FloatArray:
    """(stations, variants)."""
    return np.asarray(own[:, None] * np.exp(np.stack(powers, axis=1) @ np.log(factor.T)))
