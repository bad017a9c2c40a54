"""What a sweep finds."""

from torsion.arrays import BoolArray, FloatArray
from torsion.results import reported, result


@reported
class VariedFigure:
    """A figure of the file that varies."""

    name: str = result("", (), "component and key")
    law: str = result("", (), "how it varies about the figure of the file")
    together: int = result("", (), "figures with the same number vary as one")


@reported
class SweptCheck:
    """A check over all variants."""

    rule: str = result("", (), "name of the rule")
    clause: str = result("", (), "its clause")
    where: str = result("", (), "component")
    what: str = result("", (), "what was compared")
    failing: int = result("", (), "variants that do not keep the limit, or have no answer")
    probability: float = result("1", (), "share of the variants that fail")
    lower: float = result("1", (), "lower end of its 95 % interval")
    upper: float = result("1", (), "upper end")
    median: float | None = result("1", (), "median share of the limit that is used; null where none is known")
    worst: float | None = result("1", (), "greatest share of the limit that is used")
    decides: str = result("", (), "figure with which the share goes most (by rank); empty where none does")
    correlation: float | None = result("1", (), "rank correlation with that figure, -1 to 1; null where none is known")
    utilisation: FloatArray  # (variants,), NaN where unknown
    fails: BoolArray  # (variants,)


@reported
class Sweep:
    """Frequencies and verdicts where figures of the file vary."""

    figures: tuple[VariedFigure, ...] = result("", (), "figures that vary")
    samples: int = result("", (), "number of variants")
    method: str = result("", (), "how they are drawn: sobol, latin or random")
    seed: int = result("", (), "of the samples")
    unsolved: int = result("", (), "variants without an answer; each counts as failing")
    faults: tuple[str, ...] = result("", (), "why, each cause once")
    nominal: FloatArray = result("Hz", ("mode",), "natural frequencies of the file as it stands")
    mean: FloatArray = result("Hz", ("mode",), "mean natural frequency")
    deviation: FloatArray = result("Hz", ("mode",), "standard deviation")
    low: FloatArray = result("Hz", ("mode",), "2.5 % of the variants lie below")
    high: FloatArray = result("Hz", ("mode",), "2.5 % of the variants lie above")
    least: FloatArray = result("Hz", ("mode",), "least frequency of any variant")
    greatest: FloatArray = result("Hz", ("mode",), "greatest frequency of any variant")
    checks: tuple[SweptCheck, ...] = result("", (), "every check, the likeliest to fail first")
    any_fails: SweptCheck | None = result("", (), "at least one check fails; null where none is judged")
    factor: FloatArray  # (variants, figures) over the figure of the file
    frequency: FloatArray  # (modes, variants) Hz, NaN where unknown
