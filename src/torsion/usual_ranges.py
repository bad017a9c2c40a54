"""The usual range of every quantity of an input file, in one table: a value outside is a slip, or said to be meant.

A range is wider than all that is built. A quantity names its row; one that names none has that of its unit.
"""

import math
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class UsualRange:
    """From `low` to `high` in SI; of the size alone, whatever the sign, where `low` is above 0; 0 is never unusual.

    The units of `slip` are those that a writer may have had in mind; `below` and `above` name another quantity that a
    value beyond that end may have been meant for.
    """

    low: float = -math.inf
    high: float = math.inf
    slip: tuple[str, ...] = ()
    below: str = ""
    above: str = ""

    def holds(self, number: float) -> bool:
        """Return whether a number (SI) is usual."""
        size = abs(number) if self.low > 0.0 else number
        return number == 0 or self.low <= size <= self.high

    @property
    def ends(self) -> list[float | None]:
        """Both ends; None where the range is open."""
        return [end if math.isfinite(end) else None for end in (self.low, self.high)]

    def words(self, size: float = 1.0) -> str:
        """The range in words, in a unit of that size."""
        low, high = self.low / size, self.high / size
        if math.isinf(low):
            return f"at most {high:.5g}"
        return f"at least {low:.5g}" if math.isinf(high) else f"{low:.5g} to {high:.5g}"


def _read_table() -> dict[str, UsualRange]:
    """Read usual_ranges.txt: a row by the SI unit that it holds for, or by the name that a quantity gives."""
    ranges, file = {}, Path(__file__).with_name("usual_ranges.txt")
    for line in file.read_text(encoding="utf-8").splitlines():
        if not line.startswith("#"):
            name, low, high, *words = (cell.strip() for cell in line.split("|"))
            slip, below, above = (*words, "", "", "")[:3]
            ends = float(low or -math.inf), float(high or math.inf)
            ranges[name] = UsualRange(*ends, tuple(slip.split()), below, above)
    return ranges


USUAL = _read_table()
WIDEST = USUAL["diameter of a shaft"].high  # m; the shafts of the largest water turbines
