"""The truck in its gears and the ferry with two engines, beside full matrices that are written out from their files."""

import copy
import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from scipy.linalg import eigh
from tests.contracts.frozen import solved

from torsion.analyses.critical import CriticalSpeeds
from torsion.analyses.engine.engine_results import EngineFound, Engines
from torsion.analyses.response.amplitudes import Response, Synthesis
from torsion.analyses.response.synthesis import half_range
from torsion.analyses.undamped_modes import Modes
from torsion.arrays import ComplexArray, FloatArray
from torsion.findings import Findings
from torsion.kernels.trees.tree_response import Status
from torsion.model.component import STEEL
from torsion.rules.verdict_line import Checks
from torsion.units import to_si

SCENES = Path(__file__).parents[2] / "shafting_specs"
RPM = math.pi / 30.0
FIRES = {1: 0.0, 5: 120.0, 3: 240.0, 6: 360.0, 2: 480.0, 4: 600.0}  # deg, firing order 1-5-3-6-2-4


def si(value: Any, unit: str) -> float:
    return to_si(value, unit) if isinstance(value, str) else float(value)


@dataclass
class Dense:
    """Full matrices over stations at their own speeds; row k of `move` gives station k by the independent angles."""

    inertia: list[float] = field(default_factory=list)
    damping: list[float] = field(default_factory=list)
    ratio: list[float] = field(default_factory=list)
    joined: list[tuple[int, int, float]] = field(default_factory=list)  # driven = driving * ratio
    springs: list[tuple[str, int, int, float, float, float]] = field(
        default_factory=list
    )  # ..., k, eta, c
    cylinders: dict[tuple[str, int], int] = field(default_factory=dict)
    propeller: int = -1
    here: int = -1
    open: bool = False  # the last station awaits its component

    def point(self, inertia: float, ratio: float) -> int:
        if self.here >= 0 and self.open:
            self.inertia[self.here] += inertia
        else:
            before = self.here
            self._new(inertia, ratio)
            if before >= 0:
                self.joined.append((before, self.here, 1.0))
        self.open = False
        return self.here

    def _new(self, inertia: float, ratio: float) -> None:
        self.inertia.append(inertia)
        self.damping.append(0.0)
        self.ratio.append(ratio)
        self.here = len(self.inertia) - 1

    def link(
        self, name: str, ends: tuple[float, float], k: float, eta: float, c: float = 0.0
    ) -> None:
        before = self.here
        self.inertia[before] += ends[0]
        self._new(ends[1], self.ratio[before])
        self.springs.append((name, before, self.here, k, eta, c))
        self.open = True

    def mesh(self, ends: tuple[float, float], ratio: float) -> None:
        before = self.here
        self.inertia[before] += ends[0]
        self._new(ends[1], self.ratio[before] / ratio)
        self.joined.append((before, self.here, 1.0 / ratio))
        self.open = True

    def line(self, train: list[dict[str, Any]], materials: dict[str, Any]) -> None:
        for entry in train:
            ((kind, body),) = entry.items()
            getattr(self, f"_{kind}")(body, materials)

    def _disc(self, body: dict[str, Any], _: Any) -> None:
        at = self.point(si(body["inertia"], "kg*m**2"), self._ratio)
        self.damping[at] += si(body.get("damping", 0.0), "N*m*s/rad")

    def _damper(self, body: dict[str, Any], _: Any) -> None:
        at = self.point(float(body["housing"]), self._ratio)
        self._new(float(body["ring"]), self._ratio)
        self.springs.append(
            (f"{body['name']} ring", at, self.here, 0.0, 0.0, si(body["damping"], "N*m*s/rad"))
        )
        self.here, self.open = at, False

    def _coupling(self, body: dict[str, Any], _: Any) -> None:
        eta = si(body.get("loss_factor", 0.0), "1") or float(body.get("psi", 0.0)) / (2.0 * math.pi)
        ends = body.get("inertia", [0.0, 0.0])
        self.link(body["name"], (ends[0], ends[1]), si(body["stiffness"], "N*m/rad"), eta)

    def _shaft(self, body: dict[str, Any], materials: dict[str, Any]) -> None:
        material = materials.get(body.get("material"), {})
        modulus = si(material.get("shear_modulus", STEEL.shear_modulus), "Pa")
        density = si(material.get("density", STEEL.density), "kg/m**3")
        length, outer = si(body["length"], "m"), si(body["diameter"], "m")
        polar = math.pi / 32.0 * (outer**4 - si(body.get("bore", 0.0), "m") ** 4)
        eta = si(body.get("loss_factor", material.get("loss_factor", 0.0)), "1")
        half = density * polar * length / 2.0
        self.link(body["name"], (half, half), modulus * polar / length, eta)

    def _gear(self, body: dict[str, Any], _: Any) -> None:
        ratio = body["teeth"][1] / body["teeth"][0] if "teeth" in body else float(body["ratio"])
        self.mesh((body["inertia"][0], body["inertia"][1]), ratio)

    def _joint(self, body: dict[str, Any], _: Any) -> None:
        self.mesh((0.0, 0.0), 1.0)

    def _branch(self, body: dict[str, Any], materials: dict[str, Any]) -> None:
        kept = self.here
        self.line(body["train"], materials)
        self.here, self.open = kept, False

    def _propeller(self, body: dict[str, Any], _: Any) -> None:
        self.propeller = self.point(1.25 * float(body["inertia"]), self._ratio)

    def _engine(self, body: dict[str, Any], _: Any) -> None:
        geometry, mass = body["geometry"], si(body["masses"]["reciprocating"], "kg")
        r, rod = si(geometry["stroke"], "m") / 2.0, si(geometry["rod_length"], "m")
        a = 2.0 * math.pi / 4096 * np.arange(4096)
        lever = r * np.sin(a) * (1.0 + r * np.cos(a) / np.sqrt(rod**2 - (r * np.sin(a)) ** 2))
        own = float(body["crank_inertia"]) + mass * float(np.mean(lever**2))
        way = range(6, 0, -1) if body.get("reverse") else range(1, 7)
        previous = 0
        for number in way:
            if previous:
                low = min(number, previous)
                self.link(
                    f"{body['name']} crank {low}-{low + 1}",
                    (0.0, 0.0),
                    si(body["stiffness"], "N*m/rad"),
                    0.015,
                )
            at = self.point(own, self._ratio)
            self.damping[at] += si(body["damping"], "N*m*s/rad")
            self.cylinders[body["name"], number] = at
            previous = number

    @property
    def _ratio(self) -> float:
        return self.ratio[self.here] if self.here >= 0 else 1.0

    @property
    def move(self) -> FloatArray:
        """(stations, independent)."""
        rows = np.eye(len(self.inertia))
        for driving, driven, ratio in self.joined:
            rows[driven] = rows[driving] * ratio
        return rows[:, np.abs(rows).sum(axis=0) > 0]

    def frequencies(self) -> FloatArray:
        move, size = self.move, len(self.inertia)
        stiffness = np.zeros((size, size))
        for _, one, two, k, _, _ in self.springs:
            stiffness[np.ix_((one, two), (one, two))] += k * np.array([[1.0, -1.0], [-1.0, 1.0]])
        mass = move.T @ np.diag(self.inertia) @ move
        values = eigh(move.T @ stiffness @ move, mass)[0]
        return np.asarray(np.sqrt(np.abs(values)) / (2.0 * math.pi))

    def torque(self, w: float, force: ComplexArray) -> dict[str, complex]:
        """N m in every spring under forces (stations,) N m at w rad/s."""
        move, size = self.move, len(self.inertia)
        matrix = np.diag(-(w**2) * np.array(self.inertia) + 1j * w * np.array(self.damping))
        for _, one, two, k, eta, c in self.springs:
            matrix[np.ix_((one, two), (one, two))] += (k * (1 + 1j * eta) + 1j * w * c) * np.array(
                [[1, -1], [-1, 1]]
            )
        assert matrix.shape == (size, size)
        angle = move @ np.linalg.solve(move.T @ matrix @ move, move.T @ force)
        return {
            name: complex((k * (1 + 1j * eta) + 1j * w * c) * (angle[one] - angle[two]))
            for name, one, two, k, eta, c in self.springs
        }


def scene(name: str, **changes: Any) -> Dense:
    """Of the file, with changes {component: {key: value}} as a case has them."""
    data = yaml.safe_load((SCENES / f"{name}.yaml").read_text(encoding="utf-8"))
    found = Dense()
    train = copy.deepcopy(data["train"])
    for entry in train:
        for body in entry.values():
            body.update(changes.get(body.get("name", ""), {}))
    found.line(train, data.get("materials", {}))
    return found


def compared(
    dense: Dense, found: Findings, speed: float, force: Any, lines: list[int]
) -> ComplexArray:
    """(lines, springs) N m of the dense matrices after they were compared with the response."""
    response = found.need(Response)
    at = int(np.argmin(np.abs(response.speed - speed)))
    assert response.speed[at] == pytest.approx(speed, rel=1e-9)
    spans = {span.name: k for k, span in enumerate(response.system.spans)}
    shown = [one[0] for one in dense.springs if one[0] in spans]
    assert len(shown) >= len(dense.springs) - 4
    every = []
    for k in lines:
        order = float(response.lines[k].order or 0)
        wanted = dense.torque(order * speed, force(order))
        mine = np.array([response.torque[at, k, spans[name]] for name in shown])
        every.append([wanted[name] for name in shown])
        largest = max(abs(one) for one in every[-1])
        np.testing.assert_allclose(mine, every[-1], atol=2e-9 * largest, err_msg=str(order))
    return np.array(every)


def pushed(
    dense: Dense, engine: EngineFound, name: str, phase: float = 0.0, motored: int = 0
) -> Any:
    """Forces of an engine by order of its crankshaft."""
    own = {float(one.order): one for one in engine.harmonics}

    def force(order: float) -> ComplexArray:
        found = np.zeros(len(dense.inertia), dtype=complex)
        if order in own:
            for number, degrees in FIRES.items():
                at, one = dense.cylinders[name, number], own[order]
                gas = one.motored if number == motored else one.gas
                assert gas is not None
                found[at] += (gas + one.masses) * np.exp(
                    -1j * order * (math.radians(degrees) + phase)
                )
        return found

    return force


GEARS: dict[str, dict[str, Any]] = {
    "normal": {},
    "gear 11": {"ratio": 1.27, "inertia": [0.13, 0.06]},
    "gear 10": {"ratio": 1.62, "inertia": [0.15, 0.06]},
    "gear 9": {"ratio": 2.06, "inertia": [0.16, 0.06]},
}


@pytest.fixture(scope="module")
def truck() -> Findings:
    return solved("truck_gears")


@pytest.mark.parametrize("gear", GEARS)
def test_every_gear_of_the_truck_answers_as_dense_matrices(gear: str, truck: Findings) -> None:
    """All lines of the engine alone; order 2 of the joints has tests of its own."""
    dense, found = scene("truck_gears", gearbox=GEARS[gear]), truck.each[gear]
    frequency = found.need(Modes).frequency
    elastic = dense.frequencies()
    elastic = elastic[elastic > 0.01]
    np.testing.assert_allclose(frequency, elastic[: len(frequency)], rtol=1e-9)
    engine, speed = found.need(Engines).each[0], 1400.0 * RPM
    lines = [
        k
        for k, one in enumerate(found.need(Response).lines)
        if all("engine" in name for name in one.sources)
    ]
    assert len(lines) >= 14
    compared(dense, found, speed, pushed(dense, engine, "engine"), lines)


@pytest.mark.parametrize("gear", GEARS)
def test_critical_speeds_of_a_gear_are_its_frequencies_over_the_orders(
    gear: str, truck: Findings
) -> None:
    elastic = scene("truck_gears", gearbox=GEARS[gear]).frequencies()
    elastic = elastic[elastic > 0.01]
    for one in truck.each[gear].need(CriticalSpeeds).crossings:
        assert one.speed == pytest.approx(
            2.0 * math.pi * elastic[one.mode - 1] / float(one.order), rel=1e-9
        )


def test_the_truck_rattles_in_its_lower_gears_alone(truck: Findings) -> None:
    bad = {
        name
        for name, one in truck.each.items()
        if any(line.verdict == "fail" for line in one.need(Checks).lines)
    }
    assert bad == {"gear 10", "gear 9"}


@pytest.fixture(scope="module")
def ferry() -> Findings:
    return solved("twin_diesel_ferry")


def both(dense: Dense, found: Findings, phase: float, motored: int = 0) -> Any:
    port, starboard = (
        pushed(dense, engine, f"{side} engine", turned, missing)
        for engine, side, turned, missing in zip(
            found.need(Engines).each, ("port", "starboard"), (0.0, phase), (motored, 0), strict=True
        )
    )

    def force(order: float) -> ComplexArray:
        made = port(order) + starboard(order)
        mean = 1.8e6 / (900.0 * RPM) * 4.0 * (11.0 / 12.0 if motored else 1.0)
        for blades, share in ((1.25, 0.05), (2.5, 0.015)):
            if order == blades:  # five blades at a quarter of the speed
                made[dense.propeller] += share * mean
        return made

    return force


@pytest.mark.parametrize(("case", "motored"), [("normal", 0), ("misfire", 3)])
def test_two_engines_answer_as_dense_matrices(case: str, motored: int, ferry: Findings) -> None:
    dense, found, speed = scene("twin_diesel_ferry"), ferry.each[case], 900.0 * RPM
    elastic = dense.frequencies()
    np.testing.assert_allclose(found.need(Modes).frequency, elastic[elastic > 0.01][:8], rtol=1e-9)
    mean = 1.8e6 / speed * 4.0 * (11.0 / 12.0 if motored else 1.0)
    dense.damping[dense.propeller] += math.pi * mean / (speed / 4.0)
    response = found.need(Response)
    assert (response.status == Status.OK).all()
    wanted = compared(
        dense,
        found,
        speed,
        both(dense, found, math.radians(60.0), motored),
        list(range(len(response.lines))),
    )
    angle = np.linspace(0.0, 8.0 * math.pi, 80001)
    orders = np.array([float(one.order or 0) for one in response.lines])
    wave = np.real(np.exp(1j * np.outer(angle, orders)) @ wanted)
    spans = {span.name: k for k, span in enumerate(response.system.spans)}
    shown = [spans[one[0]] for one in dense.springs if one[0] in spans]
    at = int(np.argmin(np.abs(response.speed - speed)))
    half = found.need(Synthesis).half_range[at, shown]
    np.testing.assert_allclose(half, np.ptp(wave, axis=0) / 2.0, rtol=2e-5, atol=1e-9 * half.max())


def test_any_phase_is_the_sum_of_the_magnitudes_of_both(ferry: Findings) -> None:
    dense, found, speed = scene("twin_diesel_ferry"), ferry.each["any phase"], 900.0 * RPM
    dense.damping[dense.propeller] += math.pi * 1.8e6 / speed * 4.0 / (speed / 4.0)
    response = found.need(Response)
    at = int(np.argmin(np.abs(response.speed - speed)))
    spans = {span.name: k for k, span in enumerate(response.system.spans)}
    engines = found.need(Engines).each
    for k, line in enumerate(response.lines):
        order = float(line.order or 0)
        rest = both(dense, found, 0.0)(order) - pushed(dense, engines[1], "starboard engine")(order)
        other = pushed(dense, engines[1], "starboard engine")(order)
        one, two = (dense.torque(order * speed, force) for force in (rest, other))
        for name in ("port rubber coupling", "starboard engine crank 4-5", "propeller shaft"):
            mine = abs(response.torque[at, k, spans[name]])
            assert mine == pytest.approx(abs(one[name]) + abs(two[name]), rel=1e-7)


def test_limits_of_noise_add_the_magnitudes_of_engines_in_any_phase_as_torques_do(
    ferry: Findings,
) -> None:
    found = ferry.each["any phase"]
    response, synthesis = found.need(Response), found.need(Synthesis)
    for span in (2, 9, -1):
        np.testing.assert_allclose(
            half_range(response, response.torque[:, :, span]), synthesis.half_range[:, span]
        )


def test_opposed_orders_do_not_reach_the_propeller_and_have_an_answer(ferry: Findings) -> None:
    """At 60 degrees orders 3 and 9 of two equal engines cancel to rounding behind the wheel, which is no doubt."""
    response = ferry.each["normal"].need(Response)
    spans = {span.name: k for k, span in enumerate(response.system.spans)}
    lines = [k for k, line in enumerate(response.lines) if line.order in (3, 9)]
    behind = np.abs(response.torque[:, lines, spans["propeller shaft"]])
    assert behind.max() < 1e-12 * np.abs(response.torque[:, lines]).max()
    assert (response.status[:, lines] == Status.OK).all()


def test_names_of_the_crank_spans_stay_where_an_engine_is_taken_away(ferry: Findings) -> None:
    names = {part.name for part in ferry.each["one engine"].study.train.parts}
    assert {"port engine", "port engine crank 1-2", "port engine cylinder 6"} <= names
