"""Evidence of rules made by hand: a small train, and torques over speed as a test wants them."""

import math
from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from torsion.analyses.joints.joint_analysis import joints
from torsion.analyses.motion.transient_motion import TransientMotion, Transients
from torsion.analyses.response.amplitudes import Response, Synthesis
from torsion.analyses.response.harmonic_components import Line
from torsion.analyses.steady import Steady
from torsion.analyses.undamped_modes import modes_as_discretised
from torsion.assembly import assemble
from torsion.fields import Declared
from torsion.findings import Results
from torsion.model.component import Material, component_class
from torsion.rules import needed
from torsion.study import Operation, Study
from torsion.train import train

RPM = math.pi / 30.0
STEEL_600 = Material(shear_modulus=79.3e9, density=7850.0, tensile_strength=600e6)


@pytest.fixture
def study() -> Callable[..., Study]:
    """A study of components [(kind, fields)], with steel of 600 N/mm2, rated 1000 rpm unless stated otherwise."""

    def make(
        parts: Sequence[tuple[str, dict[str, Any]]],
        rules: Sequence[tuple[str, Declared]] = (),
        *,
        materials: Mapping[str, Material] | None = None,
        analyses: Mapping[str, Declared] | None = None,
        **operation: Any,
    ) -> Study:
        requested = {
            "speeds": {"from": "100 rpm", "to": "1200 rpm"},
            "rated": {"speed": "1000 rpm", "power": "100 kW"},
        }
        components = [component_class(kind).model_validate(body) for kind, body in parts]
        lowered = train(components, materials={"steel": STEEL_600, **(materials or {})})
        given = {
            key: value for key, value in {**requested, **operation}.items() if value is not None
        }
        return Study(
            "scene",
            lowered,
            operation=Operation.model_validate(given),
            analyses=analyses or {},
            rules=tuple(rules),
        )

    return make


@pytest.fixture
def evidence() -> Callable[..., Results]:
    """Evidence with torques by component: `half` ranges, `mean` torques, and the phasors of one line of order 4."""

    def make(
        study: Study,
        rpm: Any,
        *,
        half: Mapping[str, Any],
        mean: Mapping[str, Any] | None = None,
        status: Any = 0,
        line: Line = Line(Fraction(4), None, ("screw",)),  # noqa: B008
    ) -> Results:
        system = assemble(study.train)
        speed = np.asarray(rpm, dtype=float) * RPM
        number = len(system.spans)

        def by_span(values: Mapping[str, Any], kind: type) -> np.ndarray:
            rows = np.zeros((len(speed), number), dtype=kind)
            for span, place in enumerate(system.spans):
                rows[:, span] = values.get(
                    place.name, values.get(study.train.parts[place.part].name, 0.0)
                )
            return rows

        torque, steady = by_span(half, complex), by_span(mean or {}, float)
        order = (
            np.full(len(speed), line.frequency)
            if line.order is None
            else speed * float(line.order) / 2 / math.pi
        )
        flags = np.broadcast_to(np.asarray(status, dtype=np.uint8), speed.shape)[:, None].copy()
        stations = np.zeros((len(system.stations), len(speed)))
        response = Response(
            speed,
            np.ones(len(speed), dtype=bool),
            (line,),
            order[:, None],
            np.zeros((len(speed), 1, len(system.stations)), dtype=complex),
            torque[:, None, :],
            steady,
            np.zeros((len(speed), 1)),
            flags,
            np.zeros((len(speed), 1)),
            system,
        )
        size = np.abs(torque)
        together = Synthesis(
            size, np.abs(steady) + size, size / math.sqrt(2), 1.25 * size, Fraction(1)
        )
        still = Steady(speed, steady.T, stations, stations, "by hand", stations, stations)
        bent = joints(study.train, study.operation) if study.has_joints else None
        found = {
            "system": system,
            "mean": still,
            "response": response,
            "synthesis": together,
            "joints": bent,
        }
        if "modes" in needed(study):
            found["modes"] = modes_as_discretised(system, None)
        if "transient" in study.analyses:
            nothing, time = np.zeros(number), np.linspace(0.0, 10.0, 101)
            rest = np.zeros((number, 101)), np.zeros((len(system.stations), 101))
            ends = (nothing, nothing, nothing, nothing, nothing, nothing.astype(int), nothing)
            found["transient"] = Transients(
                (TransientMotion(time, *rest, *ends, 0.0, 100.0 * RPM, 1),)
            )
        return Results(study, found)

    return make
