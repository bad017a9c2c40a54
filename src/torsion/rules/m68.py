"""Rule `iacs-m68`: stresses, barred speed ranges and least diameters of shafts, IACS UR M68 (Rev. 3, 2021)."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from torsion.errors import Fault, Path
from torsion.findings import Results
from torsion.model.parts import ShaftRecord
from torsion.rules import m68_shafts, rule_over_speed
from torsion.rules.demands import engines_of, misfire_row, order_rows, unjudged, zero_pitch_rows
from torsion.rules.m68_shafts import (
    LAST_CONTINUOUS,
    LEAST_STRENGTH,
    LEAST_STRENGTH_IN_BARRED_RANGE,
    NEAR_TRANSIENT,
    ClassedShaft,
    M68Settings,
)
from torsion.rules.rule_over_speed import rated_speed
from torsion.rules.shaft_limits import ROUNDING, LimitedShaft, unknown_strengths, with_role
from torsion.rules.shaft_stress import SUBJECT, ShaftStress
from torsion.rules.verdict_line import TO_BE_VERIFIED, Check, Verdict, verdict_of
from torsion.study import Study

NOT_ROUND = (
    "its section is a mesh; limits, factors and minimum diameters of the rule hold for round shafts"
)
DIAMETER = "Outer diameter"
NO_POWER = "the rated power is not given: write `power` of `operation.rated`"
KW_PER_RPM = 2.0 * math.pi / 60.0 / 1e3  # power in kW per rpm of a torque of 1 N m


class M68(ShaftStress):
    """The rule, as the study reads it, and base of those of societies that take its formulas for line shafts."""

    name = "iacs-m68"
    edition = "IACS UR M68 as in KR Rules 2025 Pt 5 Ch 4"
    settings_class: type[M68Settings] = M68Settings
    title = "IACS UR M68"
    scope = LAST_CONTINUOUS  # speed ratio to which speeds are demanded
    source = "IACS UR M68 as in KR 2025 Pt 5 Ch 4, 206.1"  # of the states that it demands
    letters = "tau_C", "tau_T"  # of its limits, in continuous use and in passing
    has_limits_of: tuple[str, ...] = m68_shafts.ROLES

    def faults(self, study: Study) -> list[Fault]:
        """Return what the file lacks for this rule."""
        path, roles = self.path(study), self.has_limits_of
        shafts = {part.name: shaft for _, part, shaft in with_role(study.train, *roles)}
        if not shafts:
            hint = f"role: {', '.join(roles[:-1])} or {roles[-1]}; a shaft with a `section` is not judged"
            message = f"no round shaft has a `role`, so {self.name} has nothing to judge"
            return [Fault(path, message, hint)]
        faults = super().faults(study) + unknown_strengths(study, self, *m68_shafts.ROLES)
        return faults + self._settings_faults(study, shafts, path)

    def left_out(self, study: Study) -> tuple[tuple[str, str], ...]:
        """Return what was not judged, and why."""
        rows, names = [], []
        for part in study.train.parts:
            if part.shaft is not None and part.shaft.role is None:
                rows.append((f"{self.name} for {part.name}", "the shaft has no `role`"))
            elif part.shaft is not None and part.shaft.role not in self.has_limits_of:
                names.append(part.name)
        if not study.has_mean_torque and _is_generator_set(study):
            rows.append((f"{self.name}: least diameters", NO_POWER))
        if names:
            limited = f"limits of {', '.join(self.has_limits_of)} are known: {', '.join(names)}"
            rows.append((f"{self.name}: shafts of another role", limited))
        return tuple(rows)

    def shafts(self, study: Study) -> Iterator[LimitedShaft]:
        """Yield every round line shaft that has a role."""
        return m68_shafts.classed_shafts(study, self.settings, self.letters)

    def judge(self, evidence: Results) -> tuple[Check, ...]:
        """Return the checks of every shaft, and last the strengths of those that pass a barred range."""
        checks = super().judge(evidence)
        passing = {check.where: check for check in checks if check.barred}
        rows = [
            row
            for shaft in m68_shafts.classed_shafts(evidence.study, self.settings)
            if shaft.name in passing
            for row in self._strength_in_barred_range(shaft, passing[shaft.name])
        ]
        return *checks, *rows

    def demanded_rows(self, study: Study) -> tuple[Check, ...]:
        """Return strengths below the least one, and states of the train that neither the file nor a case of it has."""
        has_diameters = study.has_mean_torque or _is_generator_set(study)
        rows, train = list[Check](), study.train
        for shaft in m68_shafts.classed_shafts(study, self.settings):
            if shaft.stated is not None and shaft.stated < LEAST_STRENGTH * (1 - ROUNDING):
                what = "Tensile strength of the material"
                rows.append(_strength(self.name, shaft, what, LEAST_STRENGTH, "fail"))
            if not has_diameters:
                about = "minimum diameter", shaft.name, DIAMETER, NO_POWER
                rows.append(unjudged(self.name, *about, TO_BE_VERIFIED))
        round_shafts = {part.name for _, part, _ in with_role(train, *self.has_limits_of)}
        what = f"{SUBJECT}, section that is not round"
        rows += (
            unjudged(self.name, "section", bar.name, what, NOT_ROUND)
            for bar in train.bars
            if train.shaft(bar).role in self.has_limits_of and bar.name not in round_shafts
        )
        rows += order_rows(self.name, study)
        if not _is_generator_set(study):
            rows += misfire_row(self.name, study, self.source)
        return (*rows, *zero_pitch_rows(self.name, study, self.source))

    def _settings_faults(
        self, study: Study, shafts: Mapping[str, ShaftRecord], where: Path
    ) -> list[Fault]:
        """Return settings that name a shaft which the rule does not judge, or a slot that is no feature of it."""
        faults, hint = [], f"there is {', '.join(shafts)}"
        wholes = {part.whole for part in study.train.parts if part.name in shafts}
        path: Path = (*where, self.name)
        for position, name in enumerate(self.settings.alloy):
            if name not in shafts and name not in wholes:
                message = f"no shaft with a role is called '{name}'"
                faults.append(Fault((*path, "alloy", position), message, hint))
        for name in self.settings.slots:
            if name not in shafts or "slot" not in shafts[name].features:
                message = f"no shaft with a role and the feature `slot` is called '{name}'"
                faults.append(Fault((*path, "slots", name), message, hint, at_key=True))
        return faults

    def beyond_stress(self, evidence: Results, shaft: LimitedShaft) -> Iterator[Check]:
        """Yield the less favourable end of a line shaft against its least diameter, for the rated mean torque if known."""
        torque, drive = rule_over_speed.full_torque(evidence), self.settings.drive
        if torque is None or not isinstance(shaft, ClassedShaft):
            return
        factor = m68_shafts.drive_factor(shaft.role, smooth=drive != "other")
        firing = [
            sum(share for _, share in engine.drives)
            for engine in engines_of(evidence.study)
            if engine.drives
        ]
        mean = float(np.max(torque[rule_over_speed.spans_of(evidence.system, shaft.part)]))
        load = mean / min([*firing, 1.0]) * KW_PER_RPM  # rated power is that of all cylinders
        ends = [
            (outer, m68_shafts.least_diameter(load, shaft.strength, factor, shaft.k, bore / outer))
            for outer, bore in shaft.ends
        ]
        diameter, minimum = max(ends, key=lambda end: end[1] / end[0])
        yield Check(
            self.name,
            "minimum diameter",
            shaft.name,
            DIAMETER,
            diameter,
            minimum,
            "mm",
            verdict_of(diameter >= minimum, TO_BE_VERIFIED),
            TO_BE_VERIFIED,
            rated_speed(evidence.study),
            note=f"F {factor:g} (drive: {drive}), k {shaft.k:g}, {load:.5g} kW per rpm",
            at_least=True,
        )

    def _strength_in_barred_range(self, shaft: ClassedShaft, passing: Check) -> Iterator[Check]:
        """Yield the row about a strength below that which the rule demands near the limit of passing a barred range."""
        minimum, near = LEAST_STRENGTH_IN_BARRED_RANGE, self.settings.near_transient
        if (shaft.stated or 0.0) >= minimum * (1 - ROUNDING):
            return
        use = math.inf if passing.utilisation is None else passing.utilisation
        is_near = use >= near * (1 - ROUNDING)
        origin = "ours" if near == NEAR_TRANSIENT else "stated by user"
        words = f"the stress there is {use:.3g} of its limit, near is {near:g} ({origin})"
        if not is_near:
            words += (
                "; the rule demands 500 N/mm2 near the limit of passing and does not say how near"
            )
        verdict: Verdict = "fail" if is_near and shaft.stated is not None else "not judged"
        what = "Tensile strength where a barred range is passed"
        row = _strength(self.name, shaft, what, minimum, verdict)
        yield replace(row, speed=passing.speed, note=words)


def _is_generator_set(study: Study) -> bool:
    """Return whether the train has no propulsion, whose misfire and least diameters the rule demands."""
    roles = {part.shaft.role for part in study.train.parts if part.shaft is not None}
    return "generator" in roles and "propeller" not in roles


def _strength(rule: str, shaft: ClassedShaft, what: str, minimum: float, verdict: Verdict) -> Check:
    """Return the row of a stated tensile strength against the least one."""
    stated = math.nan if shaft.stated is None else shaft.stated
    about = rule, "material", shaft.name, what
    return Check(*about, stated, minimum, "N/mm2", verdict, "rule text", at_least=True)
