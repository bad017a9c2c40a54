"""What is found of an engine: harmonics of a cylinder, sums over the cylinders, varying inertia, misfires."""

from collections.abc import Callable, Sequence
from dataclasses import field
from fractions import Fraction
from typing import Literal

import numpy as np

from torsion.arrays import FloatArray
from torsion.assembly.elements import elements
from torsion.assembly.system import System
from torsion.results import derived, reported, result


@reported
class CylinderFound:
    """One cylinder of an engine, and how it runs."""

    number: int = result("as the file counts, from 1")
    station: str = result("its throw")
    firing: float = result("rad", "crank angle at which it fires, from reference angle zero")
    state: Literal["firing", "motored", "cut out"] = result("firing, motored (misfire) or cut out")
    share: float = result(
        "1",
        "its heat / heat of a cylinder of the balanced engine; 0 for a cylinder without firing",
    )


@reported
class HarmonicFound:
    """One order of the torque of a firing cylinder; phases of a cosine from its firing top dead centre."""

    order: Fraction = result("per revolution of the crankshaft, exact")
    gas: complex = result("N*m", "of the gas")
    masses: complex = result("N*m", "of the moving masses")
    motored: complex | None = result("N*m", "gas torque of a misfiring cylinder; null if unknown")
    tangential: float | None = result(
        "Pa", "magnitude of the sum / (piston area times half the stroke), or null"
    )
    rigid: float = result(
        "1", "magnitude of the sum of exp(-i order firing angle) over the cylinders"
    )
    by_mode: tuple[float, ...] = result(
        "1",
        "the same of each elastic mode, weighted with its angle at the throws / the largest of these",
    )

    @derived("N*m", "of gas and masses together")
    def total(self) -> complex:
        """Phasor of the whole torque of the order."""
        return self.gas + self.masses


@reported
class CurveFound:
    """A pressure over the cycle."""

    name: str = result("file of the diagram, or cycle")
    angle: FloatArray = result("rad", "crank angle", "from firing top dead centre")
    pressure: FloatArray = result("Pa", "crank angle", "absolute")
    motored: FloatArray = result("Pa", "crank angle", "the same without heat")
    tangential: FloatArray = result(
        "Pa", "crank angle", "torque of the gas / (piston area times half the stroke)"
    )
    imep: float = result("Pa", "indicated mean effective pressure found")
    stated: float | None = result(
        "Pa", "the same as the file states it, or null", key="stated_imep_Pa"
    )


@reported
class VaryingInertia:
    """How much the inertia that a mode sees varies over a revolution; an estimate of its parametric resonance."""

    mode: int = result("number of the elastic mode, from 1")
    harmonic: int = result("of the crank's revolution: that whose share is largest")
    share: float = result("1", "its amplitude / mean inertia of the mode")
    lower: float = result("rad/s", "own speed from which the undamped mode would be unstable")
    upper: float = result("rad/s", "up to which")
    damping: float | None = result("1", "damping ratio of the mode, or null")

    @derived("the damping ratio exceeds a quarter of the share")
    def is_stable(self) -> bool:
        """Its damping ratio exceeds a quarter of the share."""
        return self.damping is not None and self.damping > self.share / 4.0


@reported
class MisfireFound:
    """The engine with one cylinder motored, all others in balance."""

    cylinder: int = result("number; 0 of the engine with every cylinder firing")
    speed: FloatArray = result(
        "rad/s", "speed", "reference speeds: some of those requested, and every peak"
    )
    half_range: FloatArray = result(
        "N*m",
        ("speed", "span"),
        "(max - min)/2 of all orders together",
        printed=("element", "speed"),
    )


@reported
class EngineFound:
    """An engine at the rated speed, else at the highest."""

    name: str = result("the engine")
    gas_words: str = result("how the gas torque is given", key="gas")
    speed: float | None = result(
        "rad/s", "own speed of the harmonics: rated, else the highest; or null"
    )
    mean_torque: float | None = result("N*m", "that it gives at that speed, as it runs; or null")
    balanced_torque: float | None = result(
        "N*m", "the same with every cylinder firing alike, or null"
    )
    gas_mean: float | None = result("N*m", "mean gas torque of a firing cylinder for that, or null")
    imep: float | None = result(
        "Pa", "the indicated mean effective pressure that this needs, or null"
    )
    stated: float | None = result(
        "Pa", "that at which the gas torque is given, or null", key="stated_imep_Pa"
    )
    efficiency: float = result("1", "mechanical: mean torque / mean gas torque")
    keeps_power: bool = result("the other cylinders make up for those that do not fire")
    cylinders: tuple[CylinderFound, ...] = result("in the order of their numbers")
    harmonics: tuple[HarmonicFound, ...] = result("ascending")
    curves: tuple[CurveFound, ...] = result("indicator diagrams, or the cycle")
    inertia: float = result("kg*m**2", "mean of the moving masses of a cylinder")
    inertia_harmonics: tuple[complex, ...] = result(
        "kg*m**2", "of a revolution, 1, 2, ..: complex amplitudes"
    )
    varying: tuple[VaryingInertia, ...] = result("by mode; empty without masses or modes")
    stress_modulus: float | None = result("m**3", "minimum of journal and pin, or null")
    words: tuple[tuple[str, str], ...] = result(
        "figures of its data sheet: what, and value with unit"
    )
    remarks: tuple[str, ...] = result("what is estimated or omitted")
    superposed: Callable[[], Sequence[MisfireFound]] = field(
        default=tuple, repr=False, compare=False
    )

    @derived("every cylinder in turn, first none; empty if not known")
    def misfires(self) -> tuple[MisfireFound, ...]:
        """Superposed where an output first needs them: no verdict reads them."""
        return tuple(self.superposed())


@reported
class MisfireLoad:
    """Total vibratory torque in one elastic element with every cylinder firing, and with the worst one motored."""

    component: str = result("name of the element")
    firing: float | None = result("N*m", "with every cylinder firing; null if unreliable")
    firing_speed: float | None = result("rad/s", "reference speed of that")
    worst: float | None = result("N*m", "with the worst cylinder motored; null if unreliable")
    speed: float | None = result("rad/s", "reference speed of that")
    cylinder: int = result("number of that cylinder")
    ratio: float | None = result("1", "worst / firing; null without torque")
    stress: float | None = result("Pa", "nominal stress of that in a crank; null elsewhere")


def misfire_loads(
    engine: EngineFound, system: System
) -> tuple[tuple[MisfireLoad, ...], FloatArray]:
    """Return the loads of the elastic elements of a train, and their torques (elements, cases, speeds) N m."""
    elastic = [element for element in elements(system) if system.flexibility[element.spans[0]] > 0]
    cases = engine.misfires
    torque = np.array(
        [[element.largest(case.half_range) for case in cases] for element in elastic]
    ).reshape(len(elastic), len(cases), -1)
    loads = []
    for element, curves in zip(elastic, torque, strict=True):
        case = 1 + int(np.argmax(curves[1:].max(axis=1)))
        # The largest value and its speed; None where any is not known, which may be larger.
        peaks: list[tuple[float | None, float | None]] = []
        for curve in curves[[0, case]]:
            place = int(np.argmax(curve))  # the first NaN, where there is one
            value, speed = float(curve[place]), float(cases[0].speed[place])
            peaks.append((value, speed) if np.isfinite(value) else (None, None))
        (firing, firing_speed), (worst, worst_speed) = peaks
        stress = None
        if element.kind == "crank" and engine.stress_modulus is not None and worst is not None:
            stress = worst / engine.stress_modulus
        loads.append(
            MisfireLoad(
                component=element.name,
                firing=firing,
                firing_speed=firing_speed,
                worst=worst,
                speed=worst_speed,
                cylinder=cases[case].cylinder,
                ratio=worst / firing if firing and worst else None,
                stress=stress,
            )
        )
    return tuple(loads), torque


@reported
class Engines:
    """The engines of the train."""

    each: tuple[EngineFound, ...] = result("in the order of the train", key="")
