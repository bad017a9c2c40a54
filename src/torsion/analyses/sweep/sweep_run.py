"""A sweep: variants of the file solved one by one where they are judged, or all side by side where frequencies do."""

import numpy as np

from torsion.analyses.sweep.sweep_settings import CHECKED, SweepSettings
from torsion.analyses.sweep.sweep_summary import summed
from torsion.analyses.undamped_modes import Modes
from torsion.analyses.variants.one_by_one import Answers, solved
from torsion.analyses.variants.sampling import units
from torsion.analyses.variants.side_by_side import side_by_side
from torsion.findings import Work

UNJUDGED = 16384  # variants of frequencies alone


def run(work: Work) -> None:
    """Where the file was read with figures that vary, and has modes or rules."""
    study, settings = work.study, work.settings("sweep", SweepSettings)
    variation, modes = study.variations.get("sweep"), work.get(Modes)
    if variation is None or work.solve is None:
        work.log.without("sweep", "no figure of the file varies")
        return
    judged = "checks" in settings.results or (not settings.results and bool(study.rules))
    if judged and not study.rules:
        work.log.without("the probability that a check fails", "the file names no rules")
    count = settings.samples or (CHECKED if judged else UNJUDGED)
    drawn = units(count, 1 + max(one.column for one in variation.figures), settings.method, settings.seed)
    values = np.stack([one.at(drawn[:, one.column]) for one in variation.figures], axis=1)
    with work.log.step("sweep", "the file names it") as step:
        nominal = np.empty(0) if modes is None else modes.frequency
        frequency = None if judged else side_by_side(work.system, variation, values, nominal.size)
        if frequency is not None:
            answers = Answers(frequency)
            step.method = "frequencies of all variants side by side, each certified by counts"
        else:
            answers = solved(work, variation, values, nominal.size, judged=judged)
            step.method = "every variant solved" + (" and judged" if judged else "")
        step.size = f"{count} variants ({settings.method}) of {len(variation.figures)} figures"
    work.put(sweep=summed(variation, settings, values, nominal, answers))
