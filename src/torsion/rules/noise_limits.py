"""Rule `nvh`: angular acceleration and speed fluctuation at a station against limits of the file.

Gears rattle where a gearbox's input is shaken; there is no standard, so that no limit is assumed.
"""

import math
from collections.abc import Iterator
from typing import Annotated

import numpy as np

from torsion import fields
from torsion.analyses.response.amplitudes import Response
from torsion.analyses.response.harmonic_components import excited_orders
from torsion.analyses.response.synthesis import half_range
from torsion.arrays import ComplexArray, FloatArray, IntArray
from torsion.errors import Fault, nearest
from torsion.fields import Quantity, given
from torsion.findings import Results
from torsion.model.lowering import Part
from torsion.rules.judgement import (
    MOSTLY,
    Clause,
    Continuous,
    RuleOverSpeed,
    UseSettings,
    curve_of,
    within,
)
from torsion.study import Study

RPM = 30.0 / math.pi


class NoiseSettings(UseSettings):
    """Settings of `nvh`."""

    at: str | None = given(
        "name of the component; of a link its driving end, of a gear its driving wheel"
    )
    acceleration: Annotated[float, Quantity("rad/s**2", above=0)] | None = given(
        "maximum amplitude of its angular acceleration (rattle of gears: 200 to 500 rad/s2, to be verified)"
    )
    fluctuation: fields.Speed | None = given(
        "maximum of (max - min)/2 of its speed over a cycle, as `15 rpm`"
    )
    order: fields.Exact | None = given(
        "order of the component's speed, for the acceleration only (default: all)"
    )
    continuous: Continuous | None = given("speeds that are judged: {from, to} (default: all)")


class NoiseLimits(RuleOverSpeed[NoiseSettings]):
    """The rule, as the study reads it."""

    name = "nvh"
    settings_class = NoiseSettings

    def faults(self, study: Study) -> list[Fault]:
        """What the file lacks for this rule."""
        where = (*self.path(study), self.name)
        found = self.vibration_faults(study)
        example = f"- {self.name}: {{at: gearbox, acceleration: 300 rad/s**2, fluctuation: 15 rpm}}"
        if self.settings.acceleration is None and self.settings.fluctuation is None:
            message = f"{self.name} has no limit: `acceleration` and `fluctuation` are missing"
            found.append(Fault(where[:-1], message, example))
        if self.settings.at is None:
            return [
                *found,
                Fault(
                    where[:-1],
                    f"`at` of {self.name} is missing: the component that is judged",
                    example,
                ),
            ]
        names = [part.name for part in study.train.parts]
        if self.settings.at not in names:
            near = nearest(self.settings.at, names)
            hint = f"did you mean '{near}'?" if near else f"there is {', '.join(names)}"
            return [
                *found,
                Fault((*where, "at"), f"no component is called '{self.settings.at}'", hint),
            ]
        if not study.train.part(self.settings.at).stations:
            points = ", ".join(part.name for part in study.train.parts if part.is_point)
            return [
                *found,
                Fault(
                    (*where, "at"), f"'{self.settings.at}' has no one speed", f"points: {points}"
                ),
            ]
        ratio, excited = (
            study.train.stations[_station(study, self.settings)].ratio,
            excited_orders(study.train),
        )
        if self.settings.order is not None and self.settings.order * ratio not in excited:
            own = ", ".join(str(order / ratio) for order in excited)
            message = (
                f"nothing excites the train by order {self.settings.order} of '{self.settings.at}'"
            )
            found.append(Fault((*where, "order"), message, f"of its own speed there is {own}"))
        return found

    def left_out(self, study: Study) -> tuple[tuple[str, str], ...]:
        """What it does not judge, and why."""
        limits = (
            ("acceleration", self.settings.acceleration),
            ("fluctuation", self.settings.fluctuation),
        )
        return tuple(
            (f"{self.name}: {key}", "the file gives no limit")
            for key, limit in limits
            if limit is None
        )

    def clauses(self, evidence: Results) -> Iterator[Clause]:
        """At the component, over the speeds that are judged."""
        response, station = evidence.need(Response), _station(evidence.study, self.settings)
        system, circular = response.system, 2.0 * math.pi * response.frequency
        spans = np.flatnonzero((system.driving == station) | (system.driven == station))
        velocity = 1j * circular * response.angle[:, :, station]
        acceleration, words, ratio = 1j * circular * velocity, "", system.stations[station].ratio
        if self.settings.order is not None:
            alone = np.array(
                [line.order == self.settings.order * ratio for line in response.lines], dtype=bool
            )
            acceleration, words = (
                np.where(alone, acceleration, 0.0),
                f", order {self.settings.order} of its own speed",
            )
        use = within(self.use, response.speed)
        rows: tuple[tuple[str, str, ComplexArray, float | None, float, str], ...] = (
            (
                "acceleration",
                f"Angular acceleration{words}",
                acceleration,
                self.settings.acceleration,
                1.0,
                "rad/s2",
            ),
            ("fluctuation", "Speed fluctuation", velocity, self.settings.fluctuation, RPM, "rpm"),
        )
        for clause, what, phasors, limit, unit, name in rows:
            if limit is not None:
                value = half_range(response, phasors) * _surplus(evidence, spans)
                curve, notes = (
                    curve_of(response, value * unit, limit * unit),
                    (self.use_words, MOSTLY),
                )
                at, size = self.settings.at or "", np.abs(phasors)
                yield Clause(clause, at, what, "setting", curve, use, name, notes, spans, size)


def _station(study: Study, settings: NoiseSettings) -> int:
    part: Part = study.train.part(settings.at or "")
    return part.stations[0]


def _surplus(evidence: Results, spans: IntArray) -> FloatArray | float:
    """By which the exact motion of nonlinear couplings exceeds the torques about the station; 1 without them."""
    if not evidence.study.train.has_nonlinear_couplings or not spans.size:
        return 1.0
    from torsion.analyses.motion.raised_synthesis import surplus

    return np.asarray(surplus(evidence)[0][:, spans].max(axis=1))
