"""What the tolerances of a file do to what a rule judges: information; its verdict is of the figures of the file.

Frequencies and critical speeds within the tolerances are proven bands. Stresses are not monotone in any figure, so that
of a barred range only the width about its critical speed is known over the tolerances.
"""

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from torsion.analyses.critical import CriticalSpeeds
from torsion.findings import Results
from torsion.rules.class_rules.shaft_limits import barred_range
from torsion.rules.verdict_line import BarredRange

if TYPE_CHECKING:
    from torsion.analyses.modes.tolerances import Tolerances


def tolerances_of(evidence: Results) -> "Tolerances | None":
    """Return bands over the tolerances; None where the file has none, or a variant of it is solved."""
    if not evidence.study.has_tolerances:
        return None
    from torsion.analyses.modes.tolerances import Tolerances

    return evidence.get(Tolerances)


def over_tolerances(
    evidence: Results, barred: BarredRange, rated: float, tachometer: float
) -> BarredRange:
    """Return a range with one that covers its critical speed at every tolerance, if an order meets a mode within it."""
    tolerances, critical = tolerances_of(evidence), evidence.get(CriticalSpeeds)
    if tolerances is None or critical is None or not tolerances.critical_lower.size:
        return barred
    distances = [
        (abs(crossing.speed - barred.critical), index)
        for index, crossing in enumerate(critical.crossings)
        if crossing.order == barred.order and barred.lower <= crossing.speed <= barred.upper
    ]
    if not distances:
        return barred
    nearest = min(distances)[1]
    share = barred.critical / critical.crossings[nearest].speed
    lower, upper = (
        share * float(speeds[nearest])
        for speeds in (tolerances.critical_lower, tolerances.critical_upper)
    )
    low = barred_range(lower, rated)[0] * (1.0 - tachometer)
    high = barred_range(upper, rated)[1] * (1.0 + tachometer)
    return replace(
        barred, tolerance_lower=min(low, barred.lower), tolerance_upper=max(high, barred.upper)
    )


def margin_words(evidence: Results, lowest: float, highest: float) -> list[str]:
    """Return how far every mode stays from lowest to highest (Hz) at the worst end of its band, as words of a check."""
    bands = tolerances_of(evidence)
    if bands is None or not bands.lower.size:
        return []
    margin = np.maximum((lowest - bands.upper) / lowest, (bands.lower - highest) / highest)
    mode = int(np.argmin(margin))
    band = f"{bands.lower[mode]:.5g} to {bands.upper[mode]:.5g} Hz"
    percent = 100.0 * max(float(margin[mode]), 0.0)
    return [
        f"within the tolerances mode {mode + 1} lies at {band}, {percent:.3g} % away at the worst end"
    ]
