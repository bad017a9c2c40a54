"""What a fit finds."""

from fractions import Fraction

from torsion.arrays import FloatArray
from torsion.results import derived, reported, result

OUTSIDE = 2.0  # deviations of the measurement, and of every figure beforehand, within which a frequency is expected
MOST_CHI2 = 2.0  # chi2 over the degrees of freedom above which the model is wrong


@reported
class FittedFigure:
    """A figure of the file and what measurements say of it."""

    name: str = result("component and key")
    given: str = result("its value in the file, as written there")
    fitted: str = result("the fitted value")
    factor: float = result("1", "updated value / value of the file")
    prior: float = result(
        "1", "standard deviation of its logarithm before the fit, as the file states it"
    )
    deviation: float = result(
        "1", "standard deviation of its logarithm after the fit, over `others` too"
    )
    lower: float = result(
        "1", "lower end of the 95 % interval, of `others` too, over the value of the file"
    )
    upper: float = result("1", "upper end of the 95 % interval")
    shift: float = result("1", "ln of the factor over the deviation before the fit")
    from_data: float = result(
        "1", "share of the variance before the fit that the measurements took away, 0 to 1"
    )


@reported
class FittedMode:
    """A measured natural frequency with the mode that it is paired with."""

    mode: int = result("with which it is paired, from 1")
    is_given: bool = result(
        "the number is from the file; else modes rise with the frequencies, in their bands"
    )
    measured: float = result("Hz", "as measured")
    within: float = result("1", "its standard deviation")
    lower: float = result(
        "Hz",
        "minimum frequency with every parameter within two of its deviations before the fit",
    )
    upper: float = result("Hz", "greatest such frequency")
    before: float = result("Hz", "of the nominal case")
    after: float = result("Hz", "with the updated parameters, solved as a separate file")
    residual: float = result("1", "ln of fitted over measured, in deviations of the measurement")
    is_outside: bool = result("the measured frequency lies outside its band")

    @derived("how its mode was found, or that it is outside its band")
    def remark(self) -> str:
        if self.is_outside:
            return "OUTSIDE its band"
        return "" if self.is_given else "paired by its band"


@reported
class FittedCurve:
    """Measured amplitudes of one order over speed, in SI."""

    at: str = result("component")
    order: Fraction = result("per revolution of the reference")
    quantity: str = result("angle, speed or torque")
    unit: str = result("of the amplitudes")
    origin: str = result("torsiogram, or signal whose orders were tracked")
    within: float = result(
        "1", "standard deviation of an amplitude, and in rad of a phase, as stated"
    )
    deviation: FloatArray = result(
        "1", "point", "the same with the remainder of a signal at the neighbouring orders"
    )
    speed: FloatArray = result("rad/s", "point", "of the reference")
    measured: FloatArray = result("", "point", "amplitude as measured")
    before: FloatArray = result("", "point", "of the nominal case")
    after: FloatArray = result("", "point", "with the fitted figures")
    residual: FloatArray = result(
        "1", "point", "ln of fitted over measured, in deviations of the measurement"
    )
    phase_residual: FloatArray | None = result(
        "1", "point", "fitted less measured phase in such deviations; null without phases"
    )
    curve_speed: FloatArray = result("rad/s", "speed", "speeds of the curves")
    curve_before: FloatArray = result("", "speed", "amplitude of the nominal case")
    curve_after: FloatArray = result("", "speed", "amplitude with the fitted figures")
    unused: int = result(
        "windows of a signal outside the speed range, or in whose noise the order is lost",
        default=0,
    )


@reported
class Direction:
    """A combination of figures, and how much the measurements say of it."""

    information: float = result(
        "1", "deviation before the fit / deviation from only the measurements"
    )
    is_unidentified: bool = result("no measurement says anything of it")
    words: str = result("the combination in words")


@reported
class OtherFit:
    """Another set of figures that agrees nearly as well."""

    factor: FloatArray = result("1", "figure", "values / values of the file")
    chi2: float = result("1", "sum of the squared residuals of the measurements")
    prior_chi2: float = result("1", "sum of the squared shifts of the figures")
    words: str = result("the values in words")


@reported
class Fit:
    """Figures of the file fitted to measurements."""

    figures: tuple[FittedFigure, ...] = result("figures that were fitted")
    modes: tuple[FittedMode, ...] = result("measured natural frequencies")
    curves: tuple[FittedCurve, ...] = result("measured amplitudes over speed")
    directions: tuple[Direction, ...] = result(
        "combinations of figures in all minima, the best known first"
    )
    correlation: FloatArray = result(
        "1", ("figure", "other figure"), "correlation of the logarithms, over `others` too"
    )
    measurements: int = result("values that were measured")
    chi2: float = result("1", "sum of the squared residuals of the measurements")
    freedom: float = result(
        "1", "degrees of freedom: measurements less the figures that they determine"
    )
    prior_chi2: float = result("1", "sum of the squared shifts of the figures")
    rank: int = result("combinations of parameters that the measurements identify")
    steps: int = result("steps of Gauss and Newton, of all searches")
    searches: int = result("searches, each from another start; this is the best")
    others: tuple[OtherFit, ...] = result(
        "other minima by at most 6 greater in the sum of squares of measurements and figures, the best first",
    )
    warnings: tuple[str, ...] = result("what does not go together, in words")
    frequency: FloatArray = result(
        "Hz", "mode", "natural frequencies of the fitted file, solved the ordinary way"
    )
    scene: str  # text of the file with the fitted values

    @derived("1", "chi2 over the degrees of freedom; null without any", key="chi2_over_freedom")
    def reduced(self) -> float | None:
        """Near 1 where model and stated deviations agree with the measurements."""
        return self.chi2 / self.freedom if self.freedom >= 0.5 else None

    @property
    def is_wrong(self) -> bool:
        """No values of the figures explain the measurements."""
        return self.chi2 > MOST_CHI2 * (self.measurements if self.reduced is None else self.freedom)

    @property
    def fails(self) -> bool:
        """Measurement and model contradict each other."""
        return self.is_wrong or any(mode.is_outside for mode in self.modes)
