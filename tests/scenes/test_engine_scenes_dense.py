"""Both engine sets computed again from their files: cycle, harmonics, full matrices and synthesis by other means.

Nothing of the program is used but the plain content of the file: heat by a Legendre series, harmonics by Gauss
quadrature between the corners of the cycle, modes and response by LAPACK on full matrices, extremes by Newton's method.
"""

import math
from functools import cached_property, partial
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from numpy.polynomial import legendre
from scipy.linalg import eigh
from scipy.optimize import brentq, minimize_scalar
from tests.contracts.frozen import solved

from torsion.analyses.engine.engine_results import Engines
from torsion.analyses.response.amplitudes import Response, Synthesis
from torsion.analyses.undamped_modes import Modes
from torsion.findings import Findings
from torsion.rules.verdict_line import Checks

SCENES = Path(__file__).parents[2] / "shafting_specs"
NODE, WEIGHT = legendre.leggauss(120)
FEWER = legendre.leggauss(64)[0]
UNITS = {
    "rpm": math.pi / 30.0,
    "kW": 1e3,
    "mm": 1e-3,
    "m": 1.0,
    "bar": 1e5,
    "deg": math.pi / 180.0,
    "%": 0.01,
    "kg": 1.0,
    "MN*m/rad": 1e6,
    "kN*m/rad": 1e3,
    "N*m*s/rad": 1.0,
    "kN*m*s/rad": 1e3,
    "GPa": 1e9,
    "N*m": 1.0,
    "kg/m**3": 1.0,
}


def si(value: Any) -> Any:
    """Numbers of a text with a unit; all else as it stands."""
    if isinstance(value, dict):
        return {key: si(one) for key, one in value.items()}
    if isinstance(value, list):
        return [si(one) for one in value]
    words = value.split() if isinstance(value, str) else []
    return float(words[0]) * UNITS[words[1]] if len(words) == 2 and words[1] in UNITS else value


class Cylinder:
    """Harmonics 0 to 24 (four strokes) or 15 of one cylinder, Re sum C_n exp(i n angle / revolutions)."""

    def __init__(self, engine: dict[str, Any]) -> None:
        size, self.gas, self.masses = engine["geometry"], engine["gas"], engine["masses"]
        self.turns, self.count = engine["strokes"] // 2, 24 if engine["strokes"] == 4 else 15
        self.r, self.rod, self.area = (
            size["stroke"] / 2,
            size["rod_length"],
            math.pi / 4 * size["bore"] ** 2,
        )
        self.swept, self.g = self.area * size["stroke"], 1.35
        self.ends = (
            (-math.pi, math.pi)
            if self.turns == 2
            else (-self.gas["exhaust_opens"], self.gas["exhaust_opens"])
        )

    def piston(self, a):
        """Way of the piston and its derivatives by the angle."""
        w = np.sqrt(self.rod**2 - (self.r * np.sin(a)) ** 2)
        first = -self.r * np.sin(a) - self.r**2 * np.sin(a) * np.cos(a) / w
        return self.r * np.cos(a) + w, first

    def volume(self, a):
        return self.swept / (self.gas["compression_ratio"] - 1) + self.area * (
            self.r + self.rod - self.piston(a)[0]
        )

    def released(self, start: float):
        """Integral of V^(g-1) dx_b as a function of the angle."""
        long, a = self.gas["duration"], 6.908
        nodes = start + (FEWER + 1) / 2 * long
        y = (nodes - start) / long
        rate = (
            self.volume(nodes) ** (self.g - 1)
            * a
            * 2
            * y
            / long
            * np.exp(-a * y**2)
            / (1 - math.exp(-a))
        )
        series = legendre.legfit(2 * y - 1, rate, 63)
        whole = legendre.legint(series, lbnd=-1)
        return lambda at: (
            legendre.legval(np.clip(2 * (at - start) / long - 1, -1, 1), whole) * long / 2
        )

    def closed(self, start: float, heat: float, charge: float, a):
        one = charge * self.volume(self.ends[0]) ** self.g + (self.g - 1) * heat * self.released(
            start
        )(a)
        return one / self.volume(a) ** self.g

    def harmonics(self, start: float, heat: float, charge: float, exhaust: float, count: int = 0):
        """(count + 1,) N m."""
        low, high = self.ends
        period = 2 * math.pi * self.turns
        burnt = start + self.gas["duration"]
        open_ = [self.gas["scavenge_opens"]] if self.turns == 1 else [2 * math.pi]
        corners = [low, start, burnt, high, *open_, low + period]
        end = self.closed(start, heat, charge, np.array(high))
        found = np.zeros(count + 1, complex)
        for one, two in pairwise(corners):
            a, w = one + (NODE + 1) / 2 * (two - one), WEIGHT * (two - one) / 2
            if two <= high + 1e-12:
                p = self.closed(start, heat, charge, a)
            elif self.turns == 1:
                p = end + (charge - end) * np.clip((a - high) / (open_[0] - high), 0, 1)
            else:
                p = np.full(len(a), exhaust if two <= 2 * math.pi + 1e-12 else charge)
            acting = -(p - 101325.0) * self.area * self.piston(a)[1]
            found += [
                2 / period * np.sum(w * acting * np.exp(-1j * n / self.turns * a))
                for n in range(count + 1)
            ]
        found[0] /= 2
        return found

    def fitted(self, imep: float, peak: float, charge: float, exhaust: float):
        """Harmonics with heat and without: the latest start of heat that gives the peak pressure."""
        mean = imep * self.swept / (2 * math.pi * self.turns)
        none = self.harmonics(0.0, 0.0, charge, exhaust, self.count)

        def heat(start: float) -> float:
            return (
                (mean - none[0].real)
                / (self.harmonics(start, 1e6, charge, exhaust)[0].real - none[0].real)
                * 1e6
            )

        def over(start: float) -> float:
            burn = heat(start)
            grid = np.linspace(min(start, -0.1), start + self.gas["duration"], 400)
            at = int(np.argmax(self.closed(start, burn, charge, grid)))
            ends = grid[max(at - 1, 0)], grid[min(at + 1, 399)]
            top = minimize_scalar(
                lambda a: -self.closed(start, burn, charge, a),
                bounds=ends,
                method="bounded",
                options={"xatol": 1e-10},
            )
            return -float(top.fun) - peak

        late = math.radians(25.0)
        while over(late - 0.05) < 0:
            late -= 0.05
        start = brentq(over, late - 0.05, late, xtol=1e-14)
        return self.harmonics(start, heat(start), charge, exhaust, self.count), none

    @cached_property
    def law(self):
        """(points,) N m mean, (points, count + 1) with heat, the same without."""
        gas = {key: one if isinstance(one, list) else [one] for key, one in self.gas.items()}
        rows = [
            self.fitted(
                imep, gas["p_max"][k], gas["charge"][k], gas.get("exhaust", gas["charge"])[k]
            )
            for k, imep in enumerate(gas["imep"])
        ]
        firing, none = (np.stack(each) for each in zip(*rows, strict=True))
        at = np.append(none[0, 0].real, firing[:, 0].real)
        return at, np.concatenate([none[:1], firing]), np.concatenate([none[:1], none])

    def gas_torque(self, load: float, *, with_heat: bool, share: float = 1.0):
        at, firing, none = self.law
        along = partial(self._along, at=at, load=load)
        return along(none) + share * (along(firing) - along(none)) if with_heat else along(none)

    def _along(self, values, at, load: float):
        if len(at) == 2:  # one load: linear in the heat
            return values[0] + (load - at[0]) / (at[1] - at[0]) * (values[1] - values[0])
        return np.array([np.interp(load, at, row) for row in values.T])

    @cached_property
    def moving(self):
        """Mean inertia, and harmonics of the torque of the masses at 1 rad/s."""
        rod, l = self.masses["rod"], self.rod  # noqa: E741
        mass = self.masses["piston"] + rod["mass"] * rod["centre"] / l
        moment = rod["inertia"] - rod["mass"] * rod["centre"] * (l - rod["centre"])
        a = np.arange(4096) * 2 * math.pi / 4096
        tilt = self.r * np.cos(a) / np.sqrt(l**2 - (self.r * np.sin(a)) ** 2)
        energy = np.fft.rfft(mass * self.piston(a)[1] ** 2 + moment * tilt**2) / 4096
        torque = -0.5 * 1j * np.arange(len(energy)) * energy * 2
        found = np.zeros(self.count + 1, complex)
        found[:: self.turns] = torque[: self.count // self.turns + 1]
        return energy[0].real + rod["mass"] * (l - rod["centre"]) / l * self.r**2, found


class Train:
    """Full matrices of a chain from the content of the file."""

    def __init__(self, name: str, **changed: Any) -> None:
        data = si(yaml.safe_load((SCENES / f"{name}.yaml").read_text(encoding="utf-8")))
        self.data, self.inertia, self.spans, self.ground, self.rings = data, [], [], {}, []
        steel = data["materials"]["shaft steel"]
        for entry in data["train"]:
            ((kind, one),) = entry.items()
            if kind == "damper":
                self.ring = one
                self.inertia.append(one["housing"])
            elif kind == "coupling":
                loss = one.get("psi", 0.0) / (2 * math.pi)
                halves = one.get("inertia", [0.0, 0.0])
                self.inertia[-1] += halves[0]
                self.join(one["stiffness"], loss, halves[1])
            elif kind == "shaft":
                k = steel["shear_modulus"] * math.pi / 32 * one["diameter"] ** 4 / one["length"]
                half = steel["density"] * math.pi / 64 * one["diameter"] ** 4 * one["length"]
                self.inertia[-1] += half
                self.join(k, steel["loss_factor"], half)
            elif kind == "engine":
                self.engine = one | changed
                self.cylinder = Cylinder(one)
                self.lanes = one.get("throws", [[k + 1] for k in range(one["cylinders"])])
                self.first = len(self.inertia) - 1
                for place, lane in enumerate(self.lanes):
                    if place:
                        self.join(one["stiffness"], one["loss_factor"], 0.0)
                    self.inertia[-1] += one["crank_inertia"] + len(lane) * self.cylinder.moving[0]
                    self.ground[len(self.inertia) - 1] = one["damping"]
            else:
                self.inertia[-1] += one["inertia"] * (1.27 if kind == "propeller" else 1.0)
        self.propeller = next(
            (one["propeller"] for one in data["train"] if "propeller" in one), None
        )

    def join(self, k: float, loss: float, inertia: float) -> None:
        self.spans.append((k, loss))
        self.inertia.append(inertia)

    def matrices(self, w: float, damped: bool):
        """Inertia and (complex) stiffness; the ring stands last."""
        n = len(self.inertia)
        k = np.zeros((n + 1, n + 1), complex)
        pairs = [
            (j, j + 1, one * (1 + 1j * loss * damped)) for j, (one, loss) in enumerate(self.spans)
        ]
        pairs.append(
            (0, n, self.ring.get("stiffness", 0.0) + 1j * w * self.ring["damping"] * damped)
        )
        for one, two, value in pairs:
            k[np.ix_([one, two], [one, two])] += value * np.array([[1, -1], [-1, 1]])
        return np.diag([*self.inertia, self.ring["ring"]]), k

    def frequencies(self):
        mass, k = self.matrices(0.0, damped=False)
        return np.sqrt(np.abs(eigh(k.real, mass, eigvals_only=True))) / (2 * math.pi)

    def load(self, speed: float) -> float:
        told = self.data["operation"]
        if told["load"] == "propeller":
            return (
                told["rated"]["power"]
                / told["rated"]["speed"]
                * (speed / told["rated"]["speed"]) ** 2
            )
        return float(np.interp(speed, *zip(*told["load"], strict=True)))

    def half_ranges(self, speed: float, out: int = 0):
        """(spans,) N m, the ring's first; cylinder `out` has no heat, and the others give its power."""
        own, z, turns = self.cylinder, self.engine["cylinders"], self.cylinder.turns
        mean, order = self.load(speed), self.engine["firing_order"]
        share = z / (z - 1) if out else 1.0
        each = mean / z / self.engine["mechanical_efficiency"]
        force = np.zeros((len(self.inertia) + 1, own.count + 1), complex)
        n = np.arange(own.count + 1)
        for place, lane in enumerate(self.lanes):
            for number in lane:
                torque = (
                    own.gas_torque(each, with_heat=number != out, share=share)
                    + own.moving[1] * speed**2
                )
                force[self.first + place] += torque * np.exp(
                    -2j * math.pi * n * order.index(number) / z
                )
        ground = dict(self.ground)
        if self.propeller is not None:
            last = len(self.inertia) - 1
            ground[last] = self.propeller["damping"]["factor"] * mean / (speed * 30 / math.pi)
            for one in self.propeller["excitation"]:
                force[last, 4 * one["blade_order"]] += one["torque"] * mean
        twist = np.zeros((len(self.spans) + 1, own.count + 1), complex)
        for k in range(1, own.count + 1):
            w = k / turns * speed
            mass, stiff = self.matrices(w, damped=True)
            for at, c in ground.items():
                stiff[at, at] += 1j * w * c
            angle = np.linalg.solve(stiff - w**2 * mass, force[:, k])
            links = [
                (self.ring.get("stiffness", 0.0) + 1j * w * self.ring["damping"])
                * (angle[0] - angle[-1])
            ]
            links += [
                one * (1 + 1j * loss) * (angle[j] - angle[j + 1])
                for j, (one, loss) in enumerate(self.spans)
            ]
            twist[:, k] = links
        return np.array([_half_range(row, own.count) for row in twist])


def _half_range(row, count: int) -> float:
    """(max - min)/2 of Re sum c_n exp(i n a): samples, each extreme by Newton's method."""
    n, a = np.arange(count + 1), np.arange(2000) * 2 * math.pi / 2000
    every = (row[None, :] * np.exp(1j * np.outer(a, n))).real.sum(axis=1)
    ends = []
    for begin in (a[every.argmax()], a[every.argmin()]):
        at = begin
        for _ in range(20):
            wave = row * np.exp(1j * n * at)
            at += (1j * n * wave).real.sum() / (n**2 * wave).real.sum()
        ends.append((row * np.exp(1j * n * at)).real.sum())
    return (ends[0] - ends[1]) / 2


@pytest.fixture(scope="module", params=["v12_generator_set", "two_stroke_ship"])
def both(request: pytest.FixtureRequest) -> tuple[Findings, Train]:
    return solved(request.param), Train(request.param)


def test_frequencies_are_those_of_the_full_matrices(both: tuple[Findings, Train]) -> None:
    found = both[0].need(Modes).frequency
    own = both[1].frequencies()
    np.testing.assert_allclose(
        found, own[own > 1e-2][: len(found)], rtol=1e-12
    )  # the free train, and a free ring


def test_half_ranges_are_those_of_the_full_matrices(both: tuple[Findings, Train]) -> None:
    found, train = both
    response, synthesis = found.need(Response), found.need(Synthesis)
    for at in range(3, len(response.speed), len(response.speed) // 5):
        own = train.half_ranges(float(response.speed[at]))
        np.testing.assert_allclose(synthesis.half_range[at], own, rtol=1e-9, atol=1e-9 * own.max())


def test_a_misfire_is_that_of_the_full_matrices(both: tuple[Findings, Train]) -> None:
    """Of one cylinder; of `worst` every check names its cylinder, and no other has more at that speed."""
    found, train = both[0].cases["misfire"], both[1]
    (out,) = (one.number for one in found.need(Engines).each[0].cylinders if one.state == "motored")
    response, synthesis = found.need(Response), found.need(Synthesis)
    for at in (2, len(response.speed) // 2):
        own = train.half_ranges(float(response.speed[at]), out)
        np.testing.assert_allclose(synthesis.half_range[at], own, rtol=1e-9, atol=1e-9 * own.max())
    names, judged = [one.name for one in found.system.spans], 0
    for check in found.need(Checks).lines:
        if check.misfire and check.unit == "N/mm2" and check.speed is not None:
            span, judged = names.index(check.where), judged + 1
            own = [train.half_ranges(check.speed, number)[span] for number in range(1, 7)]
            assert check.misfire == f"cylinder {int(np.argmax(own)) + 1} of main engine motored"
    assert judged == (
        9 if "misfire: worst" in found.study.text[found.study.text.index("cases:") :] else 0
    )
