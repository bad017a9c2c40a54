"""Rule `gear-hammer`: vibratory torque in a gear mesh against its rating (K_A) and against the mean torque."""

from collections.abc import Iterator
from typing import Annotated

import numpy as np

from torsion.components.lowering import Part
from torsion.errors import Fault
from torsion.fields import Declared, Quantity, given
from torsion.findings import Results
from torsion.rules.judgement import (
    MOSTLY,
    RATED,
    Clause,
    Continuous,
    RuleOverSpeed,
    continuous_faults,
    continuous_words,
    coverage,
    curve_of,
    rated_speed,
    rated_torque,
    rule_path,
    spans_of,
    vibration,
    vibration_faults,
    within,
)
from torsion.rules.verdict_line import TO_BE_VERIFIED, Standing
from torsion.study import Operation, Study

RULE = "gear-hammer"
USUAL_SHARE = 0.35  # K_A - 1 with the usual application factor 1.35 (to be verified)
NO_LOAD = 1e-9  # a mesh with a smaller share of the train's greatest mean torque is unloaded


class GearHammerSettings(Declared):
    """Settings of `gear-hammer`."""

    limit: Annotated[float, Quantity("1", above=0, usual=(None, 5.0), slip=("%",))] | None = given(
        "vibratory torque / rated torque (default: application_factor - 1 of the gear, else 0.35)"
    )
    continuous: Continuous | None = given(
        "speeds of continuous use, for the torque reversal: {from, to} (default: all)"
    )


class GearHammer(RuleOverSpeed):
    """The rule, as the study reads it."""

    settings = GearHammerSettings

    def faults(self, study: Study, settings: GearHammerSettings) -> list[Fault]:
        """What the file lacks for this rule."""
        if not any(study.train.of_kind("gear")):
            return [Fault(rule_path(study, settings), f"{RULE} finds no gear in the train", "leave the rule out")]
        missing = [*_rated_faults(study.operation), *continuous_faults(study, settings, RULE, settings.continuous)]
        return missing + vibration_faults(study, settings, RULE)

    def clauses(self, evidence: Results, settings: GearHammerSettings) -> Iterator[Clause]:
        """Of every mesh, at the driving gear's speed.

        Vibratory torque against (K_A - 1) T_rated over all speeds, and against the mean torque in continuous use.
        """
        response, synthesis = vibration(evidence)
        every = rated_torque(evidence, np.arange(len(evidence.system.spans)))
        if every is None:
            raise ValueError("the torque at the rated speed is not known")
        use, words = within(settings.continuous, response.speed), continuous_words(settings.continuous)
        reach = coverage(float(response.speed[-1]), rated_speed(evidence.study))
        for number, part in evidence.study.train.of_kind("gear"):
            share, origin, standing = _share(part, settings)
            for span in spans_of(evidence.system, number):
                at, where, vibratory = np.array([span]), evidence.system.spans[span].name, synthesis.half_range[:, span]
                rated = float(every[span]) if every[span] > NO_LOAD * np.max(every) else 0.0  # nothing but rounding
                curve = curve_of(response.speed, vibratory, share * rated, response)
                notes, what = (
                    (f"{share:.4g} ({origin}) x {rated:.5g} N m", reach, MOSTLY),
                    "vibratory mesh torque, synthesis",
                )
                if rated > 0:
                    yield Clause(RULE, "(K_A - 1) T_rated", where, what, standing, curve, use | True, "N m", notes, at)
                curve = curve_of(response.speed, vibratory, np.abs(response.mean[:, span]), response)
                notes = ("" if rated > 0 else "the mesh carries no mean torque", words, MOSTLY)
                what = "vibratory against mean mesh torque"
                yield Clause(RULE, "torque reversal", where, what, TO_BE_VERIFIED, curve, use, "N m", notes, at)


def _share(part: Part, settings: GearHammerSettings) -> tuple[float, str, Standing]:
    """Permissible vibratory share of the rated torque, where it comes from and how that stands."""
    factor = part.application_factor
    if settings.limit is not None:
        return settings.limit, "setting `limit`", "setting"
    share, origin = (USUAL_SHARE, "usual K_A 1.35") if factor is None else (factor - 1.0, f"K_A {factor:.4g}")
    return share, origin, TO_BE_VERIFIED


def _rated_faults(operation: Operation) -> list[Fault]:
    """The rated torque must be known."""
    rated = operation.rated
    if rated is None:
        return [Fault(("operation", "rated"), f"`rated` is missing; {RULE} compares with the rated torque", RATED)]
    if not operation.has_mean_torque:
        message = f"`power` is missing; {RULE} compares with the rated torque"
        return [Fault(("operation", "rated", "power"), message, RATED)]
    return []
