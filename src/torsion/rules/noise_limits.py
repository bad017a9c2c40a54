"""Rule `nvh`: angular acceleration and speed fluctuation at a station against limits of the file.

Gears rattle where a gearbox's input is shaken; there is no standard, so that no limit is assumed.
"""

import math
from collections.abc import Iterable, Iterator
from typing import Annotated

import numpy as np

from torsion import fields
from torsion.analyses.response.amplitudes import Response
from torsion.analyses.response.harmonic_components import excited_orders
from torsion.analyses.response.synthesis import half_range
from torsion.errors import Fault
from torsion.fields import Quantity, given
from torsion.findings import Results
from torsion.rules.rule_over_speed import (
    Clause,
    Continuous,
    RuleOverSpeed,
    UseSettings,
)
from torsion.study import Study
from torsion.train import name_fault

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

    def faults(self, study: Study) -> Iterable[Fault]:
        """Return what the file lacks for this rule."""
        path, component, settings = (*self.path(study), self.name), self.settings.at, self.settings
        yield from self.vibration_faults(study)
        example = f"- {self.name}: {{at: gearbox, acceleration: 300 rad/s**2, fluctuation: 15 rpm}}"
        if settings.acceleration is None and settings.fluctuation is None:
            message = f"{self.name} has no limit: `acceleration` and `fluctuation` are missing"
            yield Fault(path[:-1], message, example)
        if component is None:
            message = f"`at` of {self.name} is missing: the component that is judged"
            yield Fault(path[:-1], message, example)
            return
        known = {part.name: (part.kind, bool(part.stations)) for part in study.train.parts}
        if (fault := name_fault(component, (*path, "at"), known)) is not None:
            yield fault
            return
        ratio = study.train.stations[study.train[component].stations[0]].ratio
        orders = excited_orders(study.train)
        if settings.order is not None and settings.order * ratio not in orders:
            excited = ", ".join(str(order / ratio) for order in orders)
            message = f"nothing excites the train by order {settings.order} of '{component}'"
            yield Fault((*path, "order"), message, f"of its own speed there is {excited}")

    def left_out(self, study: Study) -> Iterable[tuple[str, str]]:
        """Return what the rule does not judge, and why."""
        keys = ("acceleration", "fluctuation")
        lacking = (key for key in keys if getattr(self.settings, key) is None)
        return ((f"{self.name}: {key}", "the file gives no limit") for key in lacking)

    def clauses(self, evidence: Results) -> Iterator[Clause]:
        """Yield acceleration and fluctuation at the component, as far as they have limits."""
        response, settings, name = evidence.need(Response), self.settings, self.settings.at or ""
        station = evidence.study.train[name].stations[0]
        system, circular = response.system, 2.0 * math.pi * response.frequency
        spans = np.flatnonzero((system.driving == station) | (system.driven == station))
        velocity = 1j * circular * response.angle[:, :, station]
        acceleration, words = 1j * circular * velocity, ""
        if settings.order is not None:
            order = settings.order * system.stations[station].ratio
            is_chosen = np.array([line.order == order for line in response.lines], dtype=bool)
            acceleration = np.where(is_chosen, acceleration, 0.0)
            words = f", order {settings.order} of its own speed"
        raised = np.ones(len(response.speed))  # by exact motions of nonlinear couplings
        if evidence.study.train.has_nonlinear_couplings and spans.size:
            from torsion.analyses.motion.derived.raised_synthesis import surplus

            raised = surplus(evidence)[0][:, spans].max(axis=1)
        rows = (
            ("acceleration", f"Angular acceleration{words}", acceleration, 1.0, "rad/s2"),
            ("fluctuation", "Speed fluctuation", velocity, RPM, "rpm"),
        )
        for key, what, phasors, factor, unit in rows:
            if (limit := getattr(settings, key)) is not None:
                value = half_range(response, phasors) * raised
                yield self.compare(
                    response,
                    (key, name, what),
                    "setting",
                    value * factor,
                    limit * factor,
                    unit,
                    spans=spans,
                    size=np.abs(phasors),
                )
