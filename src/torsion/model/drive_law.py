"""Laws of drive: how the mean torque of a machine that drives answers a change of its speed."""

from typing import Annotated, Literal

from pydantic import BeforeValidator

from torsion.arrays import FloatArray
from torsion.fields import Declared, Quantity, Rows, WrittenRows, given, refuse
from torsion.model.harmonic_torques import read_table
from torsion.model.load_law import segment_slopes
from torsion.sources import source

LAWS = ("slip", "droop", "law", "torque")
EXAMPLES = "for example `drive: {slip: 1 %}`, `{droop: 4 %}`, `{law: speed}` or `{torque: [[0, 0], [1500 rpm, 1200]]}`"
Time = Annotated[float, Quantity("s", above=0)]
Share = Annotated[float, Quantity("1", above=0, below=1)]


class DriveLaw(Declared):
    """The mean torque of a machine that drives over its own speed, by one of four laws.

    With a pull-out torque T_k at the slip s_k that of a slip s is Kloss's, 2 T_k/(s/s_k + s_k/s).

    >>> round(DriveLaw(slip="1 %").slope_at_rated(1273.2395447351628, 157.07963267948966), 9)
    802.463774447
    """

    slip: Share | None = given("rated slip of an asynchronous machine, of its synchronous speed")
    pull_out: Annotated[float | None, Quantity("N*m", above=0)] = given(
        "pull-out torque, with which the slope at `slip` is that of Kloss in place of a straight line"
    )
    at_slip: Share | None = given("slip at the pull-out torque")
    droop: Share | None = given(
        "fall of the speed from no load to the rated torque, of the rated speed"
    )
    law: Literal["speed", "torque"] | None = given(
        "speed: a controller holds the mean speed; torque: it is constant"
    )
    torque: Annotated[Rows, BeforeValidator(read_table, WrittenRows)] | None = given(
        "the torque itself over own speed, [[speed, torque], ...]"
    )
    lag: Time | None = given(
        "time constant with which the slope acts in vibration too (default: it does not)"
    )

    def refuse_clashes(self) -> None:
        laws = self.keys_given(*LAWS)
        if len(laws) > 1:
            raise refuse(
                f"`{laws[0]}` and `{laws[1]}` are two laws of one drive",
                "keep one of them",
                laws[1],
            )
        if not laws and self.lag is not None:
            raise refuse("`lag` without a slope", "give `slip` or `droop` too", "lag")
        if not laws:
            raise refuse("a drive needs its law", EXAMPLES)
        self._refuse_kloss()
        if self.lag is not None and laws[0] not in ("slip", "droop"):
            raise refuse(
                f"`lag` without a slope that is constant: `{laws[0]}` has none",
                "give `slip` or `droop`",
                "lag",
            )

    def _refuse_kloss(self) -> None:
        if self.pull_out is None and self.at_slip is None:
            return
        for key, needed in (("pull_out", "at_slip"), ("at_slip", "pull_out"), ("pull_out", "slip")):
            if getattr(self, needed) is None:
                raise refuse(
                    f"`{key}` without `{needed}`",
                    "`{slip: 1 %, pull_out: 3200 N*m, at_slip: 8 %}`",
                    key,
                )
        if self.lag is not None and (self.slip or 0.0) >= (self.at_slip or 0.0):
            raise refuse(
                "`lag` beyond the pull-out torque, where the slope damps no more",
                "leave `lag` out",
                "lag",
            )

    @property
    def is_controlled(self) -> bool:
        """A controller holds the mean speed."""
        return self.law == "speed"

    @source("Kloss1916")
    def rated_torque(self) -> float | None:
        """Return the torque (N m) that Kloss's law has at the rated slip; None of any other law."""
        if self.slip is None or self.pull_out is None or self.at_slip is None:
            return None
        return 2.0 * self.pull_out / (self.slip / self.at_slip + self.at_slip / self.slip)

    def slope_at_rated(self, torque: float, speed: float) -> float:
        """Return -dT/dω (N m s/rad) of `slip` or `droop`, from rated torque (N m) and speed (rad/s); else 0."""
        if self.slip is not None and self.pull_out is not None and self.at_slip is not None:
            slip, at_slip = self.slip, self.at_slip
            over_slip = (
                2.0 * self.pull_out * at_slip * (at_slip**2 - slip**2) / (at_slip**2 + slip**2) ** 2
            )
            return over_slip * (1.0 - slip) / speed
        if self.slip is not None:
            return torque * (1.0 - self.slip) / (self.slip * speed)
        return 0.0 if self.droop is None else torque / (self.droop * speed)

    def slopes(self, speed: FloatArray, rated_torque: float, rated_speed: float) -> FloatArray:
        """Return -dT/dω (speeds,) N m s/rad at own speeds (rad/s); of a table the smaller one at its knots."""
        if self.torque is not None:
            # The smaller slope at a knot is that of the negative torque.
            return segment_slopes(tuple((row, -torque) for row, torque in self.torque), speed)
        return 0.0 * speed + self.slope_at_rated(rated_torque, rated_speed)

    @property
    def words(self) -> str:
        """The law in words, for tables."""
        if self.slip is not None or self.droop is not None:
            name, share = ("slip", self.slip) if self.slip is not None else ("droop", self.droop)
            lag = "" if self.lag is None else f", lag {self.lag:g} s"
            pull_out = "" if self.pull_out is None else f", pull-out torque {self.pull_out:g} N m"
            return f"{name} {100.0 * (share or 0.0):g} %{pull_out}{lag}"
        if self.torque is not None:
            return "torque by a table over speed"
        return "speed kept by a controller" if self.is_controlled else "constant torque"
