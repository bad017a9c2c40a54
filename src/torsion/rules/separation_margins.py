"""Rules `api-610`, `api-617`, `api-618`, `api-684`: natural frequencies away from every possible excitation.

From memory of the standards, to be verified: over the operating range a natural frequency is 10 % away from once and
twice the speed of every shaft, gear mesh and blade passing, and once and twice the line frequency; API 618 has 5 % for
multiples of the speed above the first, up to 10.
"""

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Annotated, Any

import numpy as np
from pydantic import BeforeValidator

from torsion import fields
from torsion.analyses.response.harmonic_components import in_runs, lines
from torsion.analyses.undamped_modes import Modes, ModesSettings, modes_up_to
from torsion.arrays import FloatArray
from torsion.errors import Fault
from torsion.fields import Declared, Quantity, given, required
from torsion.findings import Results
from torsion.rules.demands import distinct, in_rpm, unjudged, with_reach
from torsion.rules.over_tolerances import margin_words
from torsion.rules.rule_over_speed import Continuous, UseSettings
from torsion.rules.verdict_line import TO_BE_VERIFIED, Check, Rule, rank, verdict_of
from torsion.study import Study
from torsion.train import Train

RADIANS = 2.0 * math.pi
ROUNDING = 1e-9  # relative: a margin this near to its limit is at the limit
STRESS_ANALYSIS = "a stress analysis must show that the resonance does no harm"
CLAUSE, WHERE = "separation", "train"
STATE_LINE = "write `line_frequency: 50 Hz`, or `line_frequency: none` without a grid"
MACHINES = ("motor", "generator")  # kinds of components that may be joined to a grid


@dataclass(frozen=True)
class Margins:
    """The margins of one standard."""

    edition: str
    multiples: int  # of every shaft's speed that count whether the file excites them or not
    first: float = 0.10  # of shaft speeds themselves, meshes, blades and the line frequency
    further: float = 0.10  # of every other order


STANDARDS: Mapping[str, Margins] = {
    "api-610": Margins("API 610 (pumps)", 2),
    "api-617": Margins("API 617 (axial and centrifugal compressors)", 2),
    "api-618": Margins("API 618 (reciprocating compressors)", 10, further=0.05),
    "api-684": Margins("API 684 (rotor dynamics tutorial)", 2),
}


class LineFrequency(Declared):
    """The frequency of a grid, as a band."""

    nominal: fields.Frequency = required("nominal frequency")
    tolerance: Annotated[float, Quantity("1", at_least=0, below=1, usual="tolerance")] = given(
        "how far the grid departs from it, for example 2 %", 0.0
    )


NO_GRID = LineFrequency.model_construct(nominal=0.0, tolerance=0.0)


def _read_line_frequency(value: Any) -> Any:
    if value == "none":
        return NO_GRID
    return value if isinstance(value, dict | LineFrequency | None) else {"nominal": value}


Grid = Annotated[LineFrequency, BeforeValidator(_read_line_frequency, float | str | LineFrequency)]


class MarginSettings(UseSettings):
    """Settings of the separation margins."""

    continuous: Continuous | None = given(
        "operating range: {from, to} (default: all of `operation.speeds`)"
    )
    line_frequency: Grid | None = given(
        "of the electric supply, once and twice it count: a frequency, {nominal: 50 Hz, tolerance: 2 %}, or none where "
        "there is no grid; a train with an electric machine is not judged without it"
    )


@dataclass(frozen=True)
class Excitation:
    """A possible excitation, and how far natural frequencies stay away from it."""

    name: str
    margin: float
    lowest: float  # Hz, over the operating range
    highest: float  # Hz
    order: Fraction | None = None  # of the reference; None at a fixed frequency

    @property
    def reach(self) -> float:
        """Frequency (Hz) up to which the modes are judged."""
        return (1.0 + self.margin) * self.highest


class SeparationMargins(Rule[MarginSettings]):
    """The rule of one standard."""

    settings_class = MarginSettings
    needs = ("modes",)

    def __init__(self, settings: MarginSettings, name: str) -> None:
        super().__init__(settings, name)
        self.standard = STANDARDS[name]
        self.edition = self.standard.edition

    def faults(self, study: Study) -> Iterable[Fault]:
        """Return what the file lacks for this rule."""
        for spring in study.train.springs:
            if spring.table is not None and spring.table.over != "frequency":
                message = f"{self.name} judges one natural frequency a mode, and '{spring.name}' leaves a mode many"
                hint = (
                    "give the coupling a `stiffness`, the softest and the stiffest as two `cases`"
                )
                path = study.train.parts[spring.part].path
                return [Fault((*path, spring.table.key), message, hint)]
        if self.settings.continuous is not None or study.operation.speeds is not None:
            return []
        hint = f"speeds: {{from: 300 rpm, to: 1800 rpm}}, or `continuous` of `{self.name}`"
        message = f"`speeds` is missing; {self.name} judges an operating range"
        return [Fault(("operation", "speeds"), message, hint)]

    def left_out(self, study: Study) -> Iterable[tuple[str, str]]:
        """Return what the rule does not judge, and why."""
        if_excited = "judged where the file excites the train by their orders, and not otherwise"
        stress = "it is the rules' about stress"
        return (
            (f"{self.name}: vane passing, harmonics of converters", if_excited),
            (f"{self.name}: stress analysis of what is not apart", stress),
        )

    def judge(self, evidence: Results) -> Iterable[Check]:
        """Return the worst mode of every order and fixed frequency."""
        study, use = evidence.study, self.settings.continuous
        excitations = tuple(list_excitations(evidence, self.settings, self.standard))
        requested = study.analyses.get("modes")
        count = (requested if isinstance(requested, ModesSettings) else ModesSettings()).count
        highest = max((excitation.reach for excitation in excitations), default=0.0)
        frequency, known_to = modes_up_to(evidence.need(Modes), count, highest)
        if not frequency.size:
            return ()

        worst = dict[str, Check]()  # of several frequencies of one source
        for excitation in excitations:
            check = self._judge(evidence, excitation, frequency, known_to)
            worst[check.what] = max(worst.get(check.what, check), check, key=rank)
        rows = list(worst.values())

        # What the file does not state: the grid of a machine, teeth of a gear, blades of a machine.
        train = study.train
        machines = [
            part.name
            for part in train.parts
            if part.kind in MACHINES or (part.shaft is not None and part.shaft.role == "generator")
        ]
        if machines and self.settings.line_frequency is None:
            note = f"the line frequency of {in_runs(machines)} is not stated: {STATE_LINE}"
            row = self._row(WHERE, "1 x line frequency", note)
            rows.append(replace(row, limit=self.standard.first))
        counts = [
            (mesh.name, "gear mesh", "teeth")
            for mesh in train.constraints
            if train.parts[mesh.part].kind == "gear" and not mesh.meshings
        ]
        counts += (
            (part.name, "blade passing", "blades")
            for part in train.parts
            if part.impeller is not None and not part.impeller.blades
        )
        for name, passing, key in counts:
            words = f"{passing} frequency of '{name}' not judged: its `{key}` are not given"
            row = self._row(name, passing, words)
            rows.append(replace(row, verdict="restricted", restrictions=(words,)))
        return distinct(
            row for check in rows for row in with_reach(check, study, use=use, subject="Separation")
        )

    def _judge(
        self, evidence: Results, excitation: Excitation, frequency: FloatArray, known_to: float
    ) -> Check:
        """Return the check of one excitation; all modes up to `known_to` (Hz) are in `frequency`."""
        below = (excitation.lowest - frequency) / excitation.lowest
        above = (frequency - excitation.highest) / excitation.highest
        margin = np.maximum(np.maximum(below, above), 0.0)
        near = np.flatnonzero(margin < excitation.margin * (1.0 - ROUNDING))
        worst = int(np.argmin(margin))

        nearest, speed = float(frequency[worst]), None
        words = [f"mode {worst + 1}, {nearest:.5g} Hz"]
        if excitation.order is not None:
            speed = RADIANS * nearest / float(excitation.order)
            words[0] += f", critical speed {in_rpm(speed)}"
        else:
            ends = f"{excitation.lowest:.5g}", f"{excitation.highest:.5g}"
            words.append(" to ".join(dict.fromkeys(ends)) + " Hz")
        words += margin_words(evidence, excitation.lowest, excitation.highest)
        if near.size:
            modes = ", ".join(str(mode + 1) for mode in near.tolist())
            words.append(f"modes {modes}: {STRESS_ANALYSIS}")
        is_known = known_to >= excitation.reach * (1.0 - ROUNDING)
        if not is_known:
            words.append(
                f"modes are known up to {known_to:.5g} Hz and are needed up to {excitation.reach:.5g} Hz"
            )
        verdict = verdict_of(not near.size, TO_BE_VERIFIED)
        return replace(
            self._row(WHERE, excitation.name, "; ".join(words)),
            value=float(margin[worst]),
            limit=excitation.margin,
            verdict=verdict if is_known or near.size else "not judged",
            speed=speed,
            order=excitation.order,
        )

    def _row(self, where: str, excitation: str, note: str) -> Check:
        """Return a row about an excitation that is not judged."""
        what = f"Separation from {excitation}"
        row = unjudged(self.name, CLAUSE, where, what, note, TO_BE_VERIFIED, "1")
        return replace(row, at_least=True)


def list_excitations(
    evidence: Results, settings: MarginSettings, standard: Margins
) -> Iterator[Excitation]:
    """Yield every order once, ascending, then every fixed frequency; the largest margin counts."""
    use = settings.continuous or evidence.study.operation.speeds
    if use is None:
        raise ValueError("a rule about an operating range needs one")
    train = evidence.study.train
    acting = lines(evidence.system)
    orders = dict[Fraction, tuple[str, float]]()
    for order, name, margin in _possible(train, standard):
        first_name, largest = orders.get(order, (name, 0.0))
        orders[order] = first_name, max(largest, margin)
    # Orders of the file, by the shaft whose own order is whole, or else the first: '7 x motor speed'.
    for line in acting:
        if line.order is not None and line.order not in orders:
            own_orders = line.own_orders
            turns = next((turn for turn in own_orders if turn.denominator == 1), own_orders[0])
            shaft = _name_shaft(train, abs(line.order / turns)) if line.order else ""
            orders[line.order] = f"{turns} x {shaft} speed", standard.further
    for order, (name, margin) in sorted(orders.items()):
        hertz = float(order) / RADIANS
        yield Excitation(name, margin, use.first * hertz, use.last * hertz, order)

    for line in acting:
        if line.frequency is not None:
            name = f"the frequency of {in_runs(dict.fromkeys(line.sources))}"
            yield Excitation(name, standard.first, line.frequency, line.frequency)
    if settings.line_frequency is not None and settings.line_frequency.nominal:
        nominal, tolerance = settings.line_frequency.nominal, settings.line_frequency.tolerance
        for multiple in (1, 2):
            ends = multiple * nominal * (1.0 - tolerance), multiple * nominal * (1.0 + tolerance)
            yield Excitation(f"{multiple} x line frequency", standard.first, *ends)


def _possible(train: Train, standard: Margins) -> Iterator[tuple[Fraction, str, float]]:
    """Yield what counts whether the file excites it or not: order of the reference, name, margin.

    Multiples of the speed of every shaft, then gear meshes and blades whose number the file states. What is once one
    shaft's speed is named by that shaft.
    """
    ratios = sorted({abs(station.ratio) for station in train.stations if not station.is_ground})
    for multiple in range(1, standard.multiples + 1):
        for ratio in ratios:
            margin = standard.first if multiple == 1 else standard.further
            yield multiple * ratio, f"{multiple} x {_name_shaft(train, ratio)} speed", margin
    for mesh in train.constraints:
        if mesh.meshings:
            order = mesh.meshings * abs(train.stations[mesh.driving].ratio)
            yield order, f"gear mesh of {mesh.name}", standard.first
    for part in train.parts:
        if part.impeller is not None and part.impeller.blades:
            order = part.impeller.blades * abs(part.ratio)
            yield order, f"blade passing of {part.name}", standard.first


def _name_shaft(train: Train, ratio: Fraction) -> str:
    """Return the component that names all that turns at a ratio to the reference: a machine before a disc, a gear last."""
    turning = [part for part in train.parts if part.stations and abs(part.ratio) == ratio]
    if turning:
        ranks = [(part.kind == "gear", not part.is_point, part.kind == "disc") for part in turning]
        return turning[ranks.index(min(ranks))].name
    return next(station.name for station in train.stations if abs(station.ratio) == ratio)
