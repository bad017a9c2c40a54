"""What is found of a reciprocating compressor: balance of mean torque, its ends, harmonics of its throws."""

from torsion.analyses.engine.engine_results import VaryingInertia
from torsion.arrays import FloatArray
from torsion.results import derived, reported, result


@reported
class EndFound:
    """One working side of a piston."""

    end: str = result("", (), "head end or crank end")
    given: str = result("", (), "its file, or its constant pressure", key="pressures")
    area: float = result("m**2", (), "of the piston on this side")
    clearance: float | None = result(
        "1", (), "volume at its dead centre / swept volume; null without volumes"
    )
    imep: float = result(
        "Pa", (), "indicated mean effective pressure, positive if the cylinder absorbs work"
    )
    power: float | None = result("W", (), "indicated, at the speed of the harmonics; or null")
    angle: FloatArray = result("rad", ("crank angle",), "from the dead centre of the head end")
    pressure: FloatArray = result("Pa", ("crank angle",), "absolute")


@reported
class ThrowHarmonic:
    """One order of the torque of a throw; phases of a cosine from its dead centre of the head end."""

    order: int = result("", (), "per revolution of the crankshaft")
    gas: complex = result("N*m", (), "of both ends")
    masses: complex = result("N*m", (), "of the moving masses")

    @derived("N*m", (), "of gas and masses together")
    def total(self) -> complex:
        """Their sum."""
        return self.gas + self.masses


@reported
class ThrowFound:
    """One throw."""

    number: int = result("", (), "from the first end of the crankshaft")
    station: str = result("", (), "in the train")
    angle: float = result("rad", (), "crank angle of its dead centre of the head end")
    mean_torque: float = result("N*m", (), "that its gas absorbs")
    inertia: float = result("kg*m**2", (), "mean of its moving masses")
    ends: tuple[EndFound, ...] = result("", (), "orders that have their own pressure")
    harmonics: tuple[ThrowHarmonic, ...] = result("", (), "ascending")


@reported
class CompressorFound:
    """One compressor."""

    name: str = result("", (), "the compressor")
    speed: float | None = result(
        "rad/s", (), "own speed of the harmonics: rated, else the highest; or null"
    )
    indicated: float = result(
        "N*m", (), "mean torque that the gas absorbs", key="indicated_torque_Nm"
    )
    efficiency: float = result("1", (), "mechanical: that / torque at the shaft")
    mean_torque: float | None = result(
        "N*m", (), "power absorbed at that speed according to `operation`; or null"
    )
    throws: tuple[ThrowFound, ...] = result("", (), "from the first end of the crankshaft")
    rigid: tuple[complex, ...] = result(
        "N*m",
        (),
        "sum of all throws by order, as phasors, reference angle zero",
        key="sum_of_throws_Nm",
    )
    turned: FloatArray = result(
        "rad", ("crank angle",), "of the effort, from reference angle zero", key="effort_angle_rad"
    )
    effort: FloatArray = result(
        "N*m",
        ("throw", "crank angle"),
        "torque that each throw takes from the crankshaft, of all orders listed and the mean",
    )
    varying: tuple[VaryingInertia, ...] = result("", (), "by mode; empty without masses or modes")
    words: tuple[tuple[str, str], ...] = result(
        "", (), "figures of its data sheet: what, and value with unit"
    )

    @derived("N*m", (), "torque at the shaft that the pressures need: indicated / efficiency")
    def needed(self) -> float:
        """That of the pressures."""
        return self.indicated / self.efficiency


@reported
class Compressors:
    """The reciprocating compressors of the train."""

    each: tuple[CompressorFound, ...] = result("", (), "in the order of the train", key="")
