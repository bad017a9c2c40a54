"""Reciprocating compressors of the train: balance of torque, pressures of their ends, harmonics of their throws."""

import math

import numpy as np

from torsion.analyses.engine.engine_analysis import VARYING, running_point, varying_inertia
from torsion.analyses.engine.engine_results import VaryingInertia
from torsion.arrays import FloatArray
from torsion.findings import Work
from torsion.model.compressor.record import CompressorRecord, ThrowRecord
from torsion.model.parts import Part
from torsion.results import derived, reported, result

DRAWN = 361  # points of the effort over a revolution


@reported
class EndFound:
    """One working side of a piston."""

    end: str = result("head end or crank end")
    given: str = result("its file, or its constant pressure", key="pressures")
    area: float = result("m**2", "of the piston on this side")
    clearance: float | None = result(
        "1", "volume at its dead centre / swept volume; null without volumes"
    )
    imep: float = result(
        "Pa", "indicated mean effective pressure, positive if the cylinder absorbs work"
    )
    power: float | None = result("W", "indicated, at the speed of the harmonics; or null")
    angle: FloatArray = result("rad", "crank angle", "from the dead centre of the head end")
    pressure: FloatArray = result("Pa", "crank angle", "absolute")

    @derived("Pa", "lowest pressure of the cycle")
    def lowest(self) -> float:
        """Lowest pressure of the cycle."""
        return float(self.pressure.min())

    @derived("Pa", "highest pressure of the cycle")
    def highest(self) -> float:
        """Highest pressure of the cycle."""
        return float(self.pressure.max())


@reported
class ThrowHarmonic:
    """One order of the torque of a throw; phases of a cosine from its dead centre of the head end."""

    order: int = result("per revolution of the crankshaft")
    gas: complex = result("N*m", "of both ends")
    masses: complex = result("N*m", "of the moving masses")

    @derived("N*m", "of gas and masses together")
    def total(self) -> complex:
        """Phasor of the whole torque of the order."""
        return self.gas + self.masses


@reported
class ThrowFound:
    """One throw."""

    number: int = result("from the first end of the crankshaft")
    station: str = result("in the train")
    angle: float = result("rad", "crank angle of its dead centre of the head end")
    mean_torque: float = result("N*m", "that its gas absorbs")
    inertia: float = result("kg*m**2", "mean of its moving masses")
    ends: tuple[EndFound, ...] = result("orders that have their own pressure")
    harmonics: tuple[ThrowHarmonic, ...] = result("ascending")


@reported
class CompressorFound:
    """One compressor."""

    name: str = result("the compressor")
    speed: float | None = result(
        "rad/s", "own speed of the harmonics: rated, else the highest; or null"
    )
    indicated: float = result("N*m", "mean torque that the gas absorbs", key="indicated_torque_Nm")
    efficiency: float = result("1", "mechanical: that / torque at the shaft")
    mean_torque: float | None = result(
        "N*m", "power absorbed at that speed according to `operation`; or null"
    )
    throws: tuple[ThrowFound, ...] = result("from the first end of the crankshaft")
    rigid: tuple[complex, ...] = result(
        "N*m",
        "sum of all throws by order, as phasors, reference angle zero",
        key="sum_of_throws_Nm",
    )
    turned: FloatArray = result(
        "rad", "crank angle", "of the effort, from reference angle zero", key="effort_angle_rad"
    )
    effort: FloatArray = result(
        "N*m",
        ("throw", "crank angle"),
        "torque that each throw takes from the crankshaft, of all orders listed and the mean",
    )
    varying: tuple[VaryingInertia, ...] = result("by mode; empty without masses or modes")
    words: tuple[tuple[str, str], ...] = result(
        "figures of its data sheet: what, and value with unit"
    )

    @derived("N*m", "torque at the shaft that the pressures need: indicated / efficiency")
    def needed(self) -> float:
        """Torque at the shaft that the pressures need."""
        return self.indicated / self.efficiency


@reported
class Compressors:
    """The reciprocating compressors of the train."""

    each: tuple[CompressorFound, ...] = result("in the order of the train", key="")


def run(work: Work) -> None:
    """Put the results of every compressor."""
    with work.log.step("compressors", "the train has one") as step:
        compressors = tuple(
            _compressor(work, part, part.compressor)
            for part in work.study.train.parts
            if part.compressor
        )
        step.method = "harmonics by quadrature over the pieces of the pressures"
        count = sum(len(compressor.throws) for compressor in compressors)
        step.size = f"{len(compressors)} with {count} throws"
        work.put(compressors=Compressors(compressors))


def _compressor(work: Work, part: Part, record: CompressorRecord) -> CompressorFound:
    speed, torque = running_point(work, part, {throw.station for throw in record.throws})
    turned: FloatArray = np.linspace(0.0, 2.0 * math.pi, DRAWN)
    order = np.arange(len(record.throws[0].gas))
    phasors = np.array([[throw.phasor(k) for k in order.tolist()] for throw in record.throws])
    harmonics = np.array(
        [throw.gas + throw.inertia * (speed or 0.0) ** 2 for throw in record.throws]
    )
    harmonics = harmonics * phasors  # (throws, orders) N m
    inertias = [
        (throw.station, throw.inertia_over_angle[1 : VARYING + 1] * phase[1 : VARYING + 1])
        for throw, phase in zip(record.throws, phasors, strict=True)
    ]
    return CompressorFound(
        name=part.name,
        speed=speed,
        indicated=-float(sum(throw.gas[0].real for throw in record.throws)),
        efficiency=record.efficiency,
        mean_torque=None if torque is None else -torque,
        throws=tuple(_throw(work, throw, speed) for throw in record.throws),
        rigid=tuple(harmonics.sum(axis=0)[1:].tolist()),
        turned=turned,
        effort=-(harmonics @ np.exp(1j * np.outer(order, turned))).real,
        varying=tuple(varying_inertia(work, inertias)),
        words=part.data_sheet,
    )


def _throw(work: Work, throw: ThrowRecord, speed: float | None) -> ThrowFound:
    masses = throw.inertia * (speed or 0.0) ** 2
    return ThrowFound(
        number=throw.number,
        station=work.system.stations[throw.station].name,
        angle=throw.angle,
        mean_torque=-float(throw.gas[0].real),
        inertia=float(throw.inertia_over_angle[0].real),
        ends=tuple(
            EndFound(
                end.end,
                end.given,
                end.cylinder.area,
                end.clearance,
                end.cylinder.imep(torque),
                None if speed is None else torque * speed,
                end.diagram.angle,
                end.diagram.pressure,
            )
            for end in throw.ends
            for torque in [-float(end.torque[0].real)]
        ),
        harmonics=tuple(
            ThrowHarmonic(order, complex(throw.gas[order]), complex(masses[order]))
            for order in range(1, len(throw.gas))
        ),
    )
