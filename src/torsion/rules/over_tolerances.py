"""What the tolerances of a file do to what a rule judges: information; its verdict is of the figures of the file.

Frequencies and critical speeds within the tolerances are proven bands. Stresses are not monotone in any figure, so that
of a barred range only the width about its critical speed is known over the tolerances.
"""

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from torsion.analyses.critical import CriticalSpeeds
from torsion.findings import Results
from torsion.rules.shaft_limits import barred_range
from torsion.rules.verdict_line import BarredRange

if TYPE_CHECKING:
    from torsion.analyses.modes.tolerances import Tolerances


def tolerances_of(evidence: Results) -> "Tolerances | None":
    """Bands over the tolerances; None where the file has none, or a variant of it is solved."""
    if not evidence.study.has_tolerances:
        return None
    from torsion.analyses.modes.tolerances import Tolerances

    return evidence.get(Tolerances)


def over_tolerances(
    evidence: Results, barred: BarredRange, rated: float, tachometer: float
) -> BarredRange:
    """With the range that covers its critical speed at every tolerance, where an order meets a mode within it."""
    found, critical = tolerances_of(evidence), evidence.get(CriticalSpeeds)
    if found is None or critical is None or not found.critical_lower.size:
        return barred
    met = [
        (abs(one.speed - barred.critical), place)
        for place, one in enumerate(critical.crossings)
        if one.order == barred.order and barred.lower <= one.speed <= barred.upper
    ]
    if not met:
        return barred
    place = min(met)[1]
    share = barred.critical / critical.crossings[place].speed
    low = barred_range(share * float(found.critical_lower[place]), rated)[0] * (1.0 - tachometer)
    high = barred_range(share * float(found.critical_upper[place]), rated)[1] * (1.0 + tachometer)
    return replace(
        barred, tolerance_lower=min(low, barred.lower), tolerance_upper=max(high, barred.upper)
    )


def margin_words(evidence: Results, lowest: float, highest: float) -> list[str]:
    """How far every mode stays from lowest to highest (Hz) at the worst end of its band, as words of a check."""
    found = tolerances_of(evidence)
    if found is None or not found.lower.size:
        return []
    apart = np.maximum((lowest - found.upper) / lowest, (found.lower - highest) / highest)
    worst = int(np.argmin(apart))
    band = f"{found.lower[worst]:.5g} to {found.upper[worst]:.5g} Hz"
    least = max(float(apart[worst]), 0.0)
    return [
        f"within the tolerances mode {worst + 1} lies at {band}, {100 * least:.3g} % away at the worst end"
    ]
