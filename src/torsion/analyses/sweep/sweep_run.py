"""A sweep: variants of the file solved one by one where they are judged, or all side by side where frequencies do."""

import numpy as np

from torsion.analyses.sweep.sweep_points import Points
from torsion.analyses.sweep.sweep_settings import SweepSettings
from torsion.analyses.sweep.sweep_summary import summed
from torsion.analyses.undamped_modes import Modes
from torsion.analyses.variants.one_by_one import solved
from torsion.analyses.variants.row_by_row import row_by_row
from torsion.findings import Work


def run(work: Work) -> None:
    """Where the file was read with figures that vary, and has modes or rules."""
    study, settings = work.study, work.settings("sweep", SweepSettings)
    variation, modes = study.variations.get("sweep"), work.get(Modes)
    if variation is None or work.solve is None:
        work.log.without("sweep", "no figure of the file varies")
        return
    judged, points = settings.judges(study), Points.of(study, settings, variation.figures)
    values = points.values()
    with work.log.step("sweep", "the file names it") as step:
        nominal = np.empty(0) if modes is None else modes.frequency
        answers = None if judged else row_by_row(work.system, variation, values, nominal.size)
        step.method = "frequencies of all variants side by side, each certified by counts"
        if answers is None:
            answers = solved(work, variation, values, nominal.size, judged=judged)
            step.method = "every variant solved" + (" and judged" if judged else "")
        step.size = points.words
    work.put(sweep=summed(variation, settings, points, values, nominal, answers))
