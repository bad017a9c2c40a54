"""Rule `gear-hammer`: vibratory torque in a gear mesh against its rating (K_A) and against the mean torque."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from torsion.analyses.response.amplitudes import Response, Synthesis
from torsion.arrays import FloatArray, IntArray
from torsion.errors import Fault, Path
from torsion.fields import Quantity, given
from torsion.findings import Results
from torsion.model.parts import GearRating, Part
from torsion.rules import rule_over_speed
from torsion.rules.demands import coverage
from torsion.rules.rule_over_speed import RATED, Clause, Continuous, RuleOverSpeed, UseSettings
from torsion.rules.verdict_line import TO_BE_VERIFIED
from torsion.study import Study

USUAL_SHARE = 0.35  # K_A - 1 with the usual application factor 1.35 (to be verified)
VIBRATORY = "Vibratory torque in the mesh"
REVERSAL = f"{VIBRATORY} against the mean torque"
NO_LOAD = 1e-9  # a mesh with a smaller share of the train's greatest mean torque is unloaded


@dataclass(frozen=True)
class Mesh:
    """A gear mesh; torques in N m at the driving gear's speed."""

    part: Part
    name: str
    spans: IntArray  # (1,)
    vibratory: FloatArray  # (speeds,) half range of the synthesis
    mean: FloatArray  # (speeds,) magnitude
    rated: float  # magnitude; 0 where it carries nothing


class GearHammerSettings(UseSettings):
    """Settings of `gear-hammer`."""

    limit: Annotated[float, Quantity("1", above=0, usual="limit of tooth separation")] | None = (
        given(
            "vibratory torque / rated torque (default: application_factor - 1 of the gear, else 0.35)"
        )
    )
    continuous: Continuous | None = given(
        "speeds of continuous use, for the torque reversal: {from, to} (default: all)"
    )


class GearHammer(RuleOverSpeed[GearHammerSettings]):
    """The rule, as the study reads it."""

    name = "gear-hammer"
    edition = "application factor of ISO 6336-1"
    settings_class = GearHammerSettings

    def faults(self, study: Study) -> Iterable[Fault]:
        """Return what the file lacks for this rule."""
        if not any(study.train.of_kind("gear")):
            message = f"{self.name} finds no gear in the train"
            yield Fault(self.path(study), message, "leave the rule out")
            return
        yield from self.vibration_faults(study)
        path: Path = ("operation", "rated")
        if study.operation.rated is None or not study.has_mean_torque:
            path = path if study.operation.rated is None else (*path, "power")
            message = f"`{path[-1]}` is missing; {self.name} compares with the rated torque"
            yield Fault(path, message, RATED)

    def clauses(self, evidence: Results) -> Iterator[Clause]:
        """Yield the vibratory torque of every mesh, at the driving gear's speed.

        Against (K_A - 1) T_rated over all speeds, and against the mean torque in continuous use.
        """
        response = evidence.need(Response)
        always = np.ones(len(response.speed), dtype=bool)
        reach = coverage(float(response.speed[-1]), rule_over_speed.rated_speed(evidence.study))
        for mesh in meshes(evidence):
            torque, spans = mesh.vibratory, mesh.spans
            rating, standing = mesh.part.get(GearRating), TO_BE_VERIFIED
            share, origin = USUAL_SHARE, "usual K_A 1.35"
            if self.settings.limit is not None:
                share, origin, standing = self.settings.limit, "setting `limit`", "setting"
            elif rating is not None and (factor := rating.application_factor) is not None:
                share, origin = factor - 1.0, f"K_A {factor:.4g}"
            if mesh.rated > 0:
                yield self.compare(
                    response,
                    ("(K_A - 1) T_rated", mesh.name, VIBRATORY),
                    standing,
                    torque,
                    share * mesh.rated,
                    spans=spans,
                    notes=(f"{share:.4g} ({origin}) x {mesh.rated:.5g} N m", reach),
                    is_judged=always,
                )
            yield self.compare(
                response,
                ("torque reversal", mesh.name, REVERSAL),
                TO_BE_VERIFIED,
                torque,
                mesh.mean,
                spans=spans,
                notes=("" if mesh.rated > 0 else "the mesh carries no mean torque",),
            )


def meshes(evidence: Results) -> Iterator[Mesh]:
    """Yield every gear mesh of the train; raises ValueError where the torque at the rated speed is not known."""
    response, synthesis = evidence.need(Response), evidence.need(Synthesis)
    torque = rule_over_speed.rated_torque(evidence)
    if torque is None:
        raise ValueError("the torque at the rated speed is not known")
    # Rated torque over what a table of load gives at the rated speed: more load rates nothing up.
    rated, table = evidence.study.operation.rated, evidence.study.operation.load.table
    if table and rated is not None and rated.power is not None:
        given_torque = abs(float(np.interp(rated.speed, *np.array(table).T[:2])))
        if given_torque:
            torque = torque * min(1.0, rated.power / rated.speed / given_torque)
    for number, part in evidence.study.train.of_kind("gear"):
        for span in rule_over_speed.spans_of(evidence.system, number):
            # A torque of a share below NO_LOAD is nothing but rounding.
            is_loaded = torque[span] > NO_LOAD * np.max(torque)
            yield Mesh(
                part,
                evidence.system.spans[span].name,
                np.array([span]),
                synthesis.half_range[:, span],
                np.abs(response.mean[:, span]),
                float(torque[span]) if is_loaded else 0.0,
            )
