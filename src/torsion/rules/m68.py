"""Rule `iacs-m68`: stresses, barred speed ranges and least diameters of shafts, IACS UR M68 (Rev. 3, 2021)."""

import math
from collections.abc import Iterable, Iterator, Mapping
from functools import partial
from typing import Any

import numpy as np

from torsion.errors import Fault, Path
from torsion.findings import Results
from torsion.kernels.tree_response import Status
from torsion.model.lowering import ShaftRecord
from torsion.model.material import STEEL
from torsion.rules import judgement, m68_shafts
from torsion.rules.demanded_states import misfire_row, order_rows, unjudged, zero_pitch_rows
from torsion.rules.judgement import Clause, Curve, rated_speed
from torsion.rules.m68_shafts import (
    FLAT_FROM,
    LAST_CONTINUOUS,
    LEAST_STRENGTH,
    LEAST_STRENGTH_IN_BARRED_RANGE,
    NEAR_TRANSIENT,
    ClassedShaft,
    M68Settings,
    tau_c,
    tau_t,
)
from torsion.rules.reached_speeds import BARRED_BELOW
from torsion.rules.shaft_limits import ROUNDING, LimitCurve, LimitedShaft, Piece
from torsion.rules.shaft_stress import SUBJECT, ShaftStress
from torsion.rules.verdict_line import TO_BE_VERIFIED, Check, verdict_of
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
    is_pointwise = True
    settings_class: type[M68Settings] = M68Settings
    title = "IACS UR M68"
    scope = LAST_CONTINUOUS  # speed ratio to which speeds are demanded
    source = "IACS UR M68 as in KR 2025 Pt 5 Ch 4, 206.1"  # of the states that it demands
    has_limits_of: tuple[str, ...] = m68_shafts.ROLES

    def faults(self, study: Study) -> list[Fault]:
        """What the file lacks for this rule."""
        every, where = (
            m68_shafts.judged(study.train, self.has_limits_of),
            self.path(study),
        )
        if not every:
            roles = ", ".join(self.has_limits_of[:-1]) + f" or {self.has_limits_of[-1]}"
            hint = f"role: {roles}; a shaft with a `section` is not judged"
            return [
                Fault(
                    where, f"no round shaft has a `role`, so {self.name} has nothing to judge", hint
                )
            ]
        found, classed = super().faults(study), m68_shafts.judged(study.train)
        for part, shaft in classed:
            made_of = study.train.materials[shaft.material]
            if made_of.tensile_strength is None and made_of != STEEL:
                about = f"`tensile_strength` of '{shaft.material}' is not given"
                message = f"{about}, and {self.name} needs it for '{part.name}'"
                hint = f"materials: {{{shaft.material}: {{..., tensile_strength: 600 MPa}}}}"
                found.append(Fault((*part.path, "material"), message, hint))
        return found + self._settings_faults(
            study, {part.name: shaft for part, shaft in every}, where
        )

    def left_out(self, study: Study) -> tuple[tuple[str, str], ...]:
        """What was not judged, and why."""
        found, others = [], []
        for part in study.train.parts:
            if part.shaft is not None and part.shaft.role is None:
                found.append((f"{self.name} for {part.name}", "the shaft has no `role`"))
            elif part.shaft is not None and part.shaft.role not in self.has_limits_of:
                others.append(part.name)
        if not study.has_mean_torque and _is_generator_set(study):
            found.append((f"{self.name}: least diameters", NO_POWER))
        if others:
            limits_of = ", ".join(self.has_limits_of)
            found.append(
                (
                    f"{self.name}: shafts of another role",
                    f"limits of {limits_of} are known: {', '.join(others)}",
                )
            )
        return tuple(found)

    def shafts(self, study: Study) -> Iterator[LimitedShaft]:
        """Every round line shaft that has a role."""
        return map(_limited, m68_shafts.classed_shafts(study, self.settings))

    def judge(self, evidence: Results) -> tuple[Check, ...]:
        """Stress in continuous use, while barred ranges are passed, and above 1.05; least diameter; of every shaft."""
        found = list(super().judge(evidence))
        for shaft in m68_shafts.classed_shafts(evidence.study, self.settings):
            if (least := self._diameter(evidence, shaft)) is not None:
                last = max(place for place, line in enumerate(found) if line.where == shaft.name)
                found.insert(last + 1, least)  # behind its stresses
            found += _in_barred_range(self.name, shaft, found, self.settings)
        return tuple(found)

    def demanded_rows(self, study: Study) -> tuple[Check, ...]:
        """Strengths below the least one, and states of the train that neither the file nor a case of it has."""
        rows = [
            Check(
                self.name,
                "material",
                shaft.name,
                "Tensile strength of the material",
                shaft.stated,
                LEAST_STRENGTH,
                "N/mm2",
                "fail",
                "rule text",
                at_least=True,
            )
            for shaft in m68_shafts.classed_shafts(study, self.settings)
            if shaft.stated is not None and shaft.stated < LEAST_STRENGTH * (1 - ROUNDING)
        ]
        if not study.has_mean_torque and not _is_generator_set(study):
            rows += [
                unjudged(
                    self.name, "minimum diameter", shaft.name, DIAMETER, NO_POWER, TO_BE_VERIFIED
                )
                for shaft in m68_shafts.classed_shafts(study, self.settings)
            ]
        round_shafts = {part.name for part, _ in m68_shafts.judged(study.train, self.has_limits_of)}
        rows += [
            unjudged(
                self.name, "section", bar.name, f"{SUBJECT}, section that is not round", NOT_ROUND
            )
            for bar in study.train.bars
            if study.train.shaft(bar).role in self.has_limits_of and bar.name not in round_shafts
        ]
        rows += order_rows(self.name, study)
        if not _is_generator_set(study):
            rows += misfire_row(self.name, study, self.source)
        return (*rows, *zero_pitch_rows(self.name, study, self.source))

    def settling(self, evidence: Results) -> Iterator[Clause]:
        """Stress in continuous use, and least diameters."""
        yield from super().settling(evidence)
        for shaft in m68_shafts.classed_shafts(evidence.study, self.settings):
            if (least := self._diameter(evidence, shaft)) is not None:
                share = np.array([least.limit / least.value])
                curve = Curve(np.array([least.speed]), share, np.ones(1), np.full(1, Status.OK))
                yield Clause(
                    least.clause,
                    least.where,
                    least.what,
                    TO_BE_VERIFIED,
                    curve,
                    np.ones(1, dtype=np.bool_),
                )

    def _settings_faults(
        self, study: Study, shafts: Mapping[str, ShaftRecord], where: Path
    ) -> list[Fault]:
        """Settings that name a shaft which the rule does not judge, or a slot that is no feature of it."""
        found, names = [], f"there is {', '.join(shafts)}"
        wholes = {part.whole for part in study.train.parts if part.name in shafts}
        for position, name in enumerate(self.settings.alloy):
            if name not in shafts and name not in wholes:
                path = (*where, self.name, "alloy", position)
                found.append(Fault(path, f"no shaft with a role is called '{name}'", names))
        for name in self.settings.slots:
            if name not in shafts or "slot" not in shafts[name].features:
                path = (*where, self.name, "slots", name)
                found.append(
                    Fault(
                        path,
                        f"no shaft with a role and the feature `slot` is called '{name}'",
                        names,
                        at_key=True,
                    )
                )
        return found

    def _diameter(self, evidence: Results, shaft: ClassedShaft) -> Check | None:
        """The less favourable end against its least diameter, for the rated mean torque."""
        every = judgement.full_torque(evidence)
        if every is None:
            return None
        factor = m68_shafts.drive_factor(shaft.role, smooth=self.settings.drive != "other")
        engines = [part.engine for part in evidence.study.train.parts if part.engine is not None]
        firing = min(
            (sum(share for _, share in one.drives) for one in engines if one.drives), default=1.0
        )
        mean = float(np.max(every[judgement.spans_of(evidence.system, shaft.part)]))
        load = mean / min(firing, 1.0) * KW_PER_RPM  # rated power is that of all cylinders
        ends = [
            (outer, m68_shafts.least_diameter(load, shaft.strength, factor, shaft.k, bore / outer))
            for outer, bore in shaft.ends
        ]
        diameter, least = max(ends, key=lambda end: end[1] / end[0])
        used = f"F {factor:g} (drive: {self.settings.drive}), k {shaft.k:g}, {load:.5g} kW per rpm"
        return Check(
            self.name,
            "minimum diameter",
            shaft.name,
            DIAMETER,
            diameter,
            least,
            "mm",
            verdict_of(diameter >= least, TO_BE_VERIFIED),
            TO_BE_VERIFIED,
            rated_speed(evidence.study),
            note=used,
            at_least=True,
        )


def _is_generator_set(study: Study) -> bool:
    """The train has no propulsion, whose misfire and least diameters the rule demands."""
    roles = {part.shaft.role for part in study.train.parts if part.shaft is not None}
    return "generator" in roles and "propeller" not in roles


def _in_barred_range(
    rule: str, shaft: ClassedShaft, checks: Iterable[Check], settings: M68Settings
) -> Iterator[Check]:
    """Yield the row about a strength below that which the rule demands near the limit of passing a barred range."""
    passing = [check for check in checks if check.where == shaft.name and check.barred]
    if not passing or (shaft.stated or 0.0) >= LEAST_STRENGTH_IN_BARRED_RANGE * (1 - ROUNDING):
        return
    use = max(math.inf if check.utilisation is None else check.utilisation for check in passing)
    is_near = use >= settings.near_transient * (1 - ROUNDING)
    words = (
        f"the stress there is {use:.3g} of its limit, near is {settings.near_transient:g} (ours)"
    )
    if settings.near_transient != NEAR_TRANSIENT:
        words = words.replace("(ours)", "(stated by user)")
    if not is_near:
        words += "; the rule demands 500 N/mm2 near the limit of passing and does not say how near"
    stated = math.nan if shaft.stated is None else shaft.stated
    yield Check(
        rule,
        "material",
        shaft.name,
        "Tensile strength where a barred range is passed",
        stated,
        LEAST_STRENGTH_IN_BARRED_RANGE,
        "N/mm2",
        "fail" if is_near and shaft.stated is not None else "not judged",
        "rule text",
        passing[0].speed,
        note=words,
        at_least=True,
    )


def _limited(shaft: ClassedShaft) -> LimitedShaft:
    """With the limits of the rule."""
    made_of: tuple[Any, ...] = shaft.strength, shaft.diameter, shaft.c_k
    continuous = partial(tau_c, *made_of)
    pieces = Piece("tau_C", FLAT_FROM, continuous), Piece("tau_C", LAST_CONTINUOUS, continuous)
    curve = LimitCurve(pieces, Piece("tau_T", BARRED_BELOW, partial(tau_t, *made_of)))
    return LimitedShaft(
        shaft.part,
        shaft.name,
        curve,
        shaft.standing,
        shaft.notes,
        shaft.keyways,
        shaft.restrictions,
        shaft.doubts,
        shaft.near_limit,
    )
