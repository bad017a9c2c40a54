"""Rules `api-610`, `api-617`, `api-618`, `api-684`: natural frequencies away from every possible excitation.

From memory of the standards, to be verified: over the operating range a natural frequency is 10 % away from the
multiples of every shaft's speed and of the line frequency; API 618 has 5 % for multiples above the first, up to 10.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from torsion import fields
from torsion.analyses.response.harmonic_components import in_runs, lines
from torsion.analyses.undamped_modes import Modes, ModesSettings
from torsion.errors import Fault
from torsion.fields import Declared, given
from torsion.findings import Results
from torsion.rules.judgement import Continuous
from torsion.rules.over_tolerances import margin_words
from torsion.rules.reached_speeds import distinct, in_rpm, with_reach
from torsion.rules.verdict_line import TO_BE_VERIFIED, Check, Rule, verdict_of
from torsion.study import Study

RADIANS = 2.0 * math.pi
ROUNDING = 1e-9  # relative: a margin this near to its limit is at the limit
MORE_MODES = "give a larger `count` of `modes`"
STRESS_ANALYSIS = "a stress analysis must show that the resonance does no harm"


@dataclass(frozen=True)
class Margins:
    """What one standard wants."""

    edition: str
    multiples: int  # of every shaft's speed that count whether the file excites them or not
    first: float = 0.10  # of the shaft speeds themselves and of the line frequency
    other: float = 0.10  # of every other order


STANDARDS: Mapping[str, Margins] = {
    "api-610": Margins("API 610 (pumps)", 2),
    "api-617": Margins("API 617 (axial and centrifugal compressors)", 2),
    "api-618": Margins("API 618 (reciprocating compressors)", 10, other=0.05),
    "api-684": Margins("API 684 (rotor dynamics tutorial)", 2),
}


class MarginSettings(Declared):
    """Settings of the separation margins."""

    continuous: Continuous | None = given("operating range: {from, to} (default: all of `operation.speeds`)")
    line_frequency: fields.Frequency | None = given("of the electric supply; once and twice it count (default: none)")


@dataclass(frozen=True)
class Excited:
    """A possible excitation, and how far natural frequencies stay away from it."""

    name: str
    margin: float
    lowest: float  # Hz, over the operating range
    highest: float  # Hz
    order: Fraction | None = None  # of the reference; None at a fixed frequency


class SeparationMargins(Rule):
    """The rule of one standard."""

    settings = MarginSettings
    needs = ("modes",)

    def __init__(self, name: str) -> None:
        self.name, self.standard = name, STANDARDS[name]

    def faults(self, study: Study, settings: MarginSettings) -> list[Fault]:
        """What the file lacks for this rule."""
        following = next(
            (one for one in study.train.springs if one.table is not None and one.table.over != "frequency"), None
        )
        if following is not None and following.table is not None:
            message = f"{self.name} judges one natural frequency a mode, and '{following.name}' leaves a mode many"
            hint = "give the coupling a `stiffness`, the softest and the stiffest as two `cases`"
            return [Fault((*study.train.parts[following.part].path, following.table.key), message, hint)]
        if settings.continuous is not None or study.operation.speeds is not None:
            return []
        hint = f"speeds: {{from: 300 rpm, to: 1800 rpm}}, or `continuous` of `{self.name}`"
        message = f"`speeds` is missing; {self.name} judges an operating range"
        return [Fault(("operation", "speeds"), message, hint)]

    def left_out(self, study: Study, settings: MarginSettings) -> tuple[tuple[str, str], ...]:
        """What it does not judge, and why."""
        other = "judged where the file excites the train by their orders, and not otherwise"
        found = [(f"{self.name}: gear mesh, vane and blade passing", other)]
        if settings.line_frequency is None:
            found.append((f"{self.name}: line frequency", "`line_frequency` is not given"))
        return (*found, (f"{self.name}: stress analysis of what is not apart", "it is the rules' about stress"))

    def check(self, evidence: Results, settings: MarginSettings) -> tuple[Check, ...]:
        """Of every order and fixed frequency the natural frequency that comes nearest to it."""
        modes = evidence.get(Modes)
        if modes is None:
            raise ValueError("a rule about natural frequencies needs them")
        requested = evidence.study.analyses.get("modes")
        count = (requested if isinstance(requested, ModesSettings) else ModesSettings()).count
        is_whole = modes.frequency.size < count
        found = (
            self._of(one, modes, margin_words(evidence, one.lowest, one.highest), is_whole=is_whole)
            for one in _excited(evidence, settings, self.standard)
        )
        study, use = evidence.study, settings.continuous
        return distinct(row for line in found if line is not None for row in with_reach(line, study, use=use))

    def _of(self, one: Excited, modes: Modes, tolerated: list[str], *, is_whole: bool) -> Check | None:
        """Of one excitation; None where the train has no elastic mode. is_whole: there are no more modes than these."""
        frequency, last = modes.frequency, float(modes.frequency.max(initial=0.0))
        apart = np.maximum((one.lowest - frequency) / one.lowest, (frequency - one.highest) / one.highest)
        apart = np.maximum(apart, 0.0)
        reach = (1.0 + one.margin) * one.highest
        is_known = is_whole or last >= reach
        if not frequency.size:
            return None
        near = np.flatnonzero(apart < one.margin * (1.0 - ROUNDING))
        worst = int(np.argmin(apart))
        words = [*tolerated, f"{self.standard.edition}, from memory, to be verified against the edition in force"]
        if near.size:
            words += [f"modes {', '.join(str(mode + 1) for mode in near.tolist())}: {STRESS_ANALYSIS}"]
        if not is_known:
            words += [f"modes are known up to {last:.5g} Hz and are needed up to {reach:.5g} Hz: {MORE_MODES}"]
        speed = None if one.order is None else RADIANS * float(frequency[worst]) / float(one.order)
        if speed is not None:
            words.insert(0, f"critical speed {in_rpm(speed)}")
        what = f"mode {worst + 1}, {float(frequency[worst]):.5g} Hz, away from it"
        return Check(
            self.name, "separation margin", one.name, what,
            float(apart[worst]), one.margin, "1", verdict_of(is_known and not near.size, TO_BE_VERIFIED),
            TO_BE_VERIFIED, speed, one.order, "; ".join(words), at_least=True,
        )  # fmt: skip


def _excited(evidence: Results, settings: MarginSettings, standard: Margins) -> Iterator[Excited]:
    """Every order once, ascending, then every fixed frequency; of each the largest margin."""
    use = settings.continuous or evidence.study.operation.speeds
    if use is None:
        raise ValueError("a rule about an operating range needs one")
    orders, fixed = dict[Fraction, tuple[float, str]](), dict[float, str]()
    for line in lines(evidence.system):
        if line.order is not None:
            orders[line.order] = standard.other, in_runs(dict.fromkeys(line.sources))
        elif line.frequency is not None:
            fixed[line.frequency] = in_runs(dict.fromkeys(line.sources))
    ratios = sorted({abs(station.ratio) for station in evidence.study.train.stations if not station.is_ground})
    for ratio in ratios:
        for multiple in range(1, standard.multiples + 1):
            margin, by = orders.get(multiple * ratio, (0.0, ""))
            own = standard.first if multiple == 1 else standard.other
            shaft = "shaft speed" if len(ratios) == 1 else f"speed of the shaft at {ratio} of the reference"
            orders[multiple * ratio] = max(margin, own), by or f"{multiple} x {shaft}"
    for order, (margin, name) in sorted(orders.items()):
        turns = float(order) / RADIANS
        yield Excited(f"order {order} ({name})", margin, use.first * turns, use.last * turns, order)
    if settings.line_frequency is not None:
        fixed |= {n * settings.line_frequency: f"{n} x line frequency" for n in (1, 2)}
    for frequency, name in sorted(fixed.items()):
        yield Excited(f"{frequency:.5g} Hz ({name})", standard.first, frequency, frequency)
