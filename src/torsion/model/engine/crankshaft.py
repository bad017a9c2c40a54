"""A crankshaft as points and links in a row: the keys of its throws and spans, and how they lower."""

from collections.abc import Sequence
from typing import Annotated

from torsion import fields
from torsion.fields import OneOrMany, Quantity, exclusive, given, refuse
from torsion.model.component import Component, Lowering
from torsion.model.parts import ShaftRecord, Symbol
from torsion.primitives import Damper, Spring

ONE_INERTIA = exclusive(
    "inertia",
    "crank_inertia",
    hint="inertia: 0.047 kg*m**2, or crank_inertia, to which the mean of the moving masses is added",
    needed=True,
)
VARYING = 8  # harmonics of the inertia over a revolution that are kept


class Crankshaft(Component, sort="line"):
    """Throws with their inertia and damping, and the spans between them; one value stands for all."""

    mechanical_efficiency: Annotated[
        float, Quantity("1", above=0, at_most=1, usual="efficiency")
    ] = given("of an engine mean torque / mean gas torque, of a compressor the inverse", 1.0)
    reverse: bool = given("true: the train meets its last throw first", False)
    inertia: Annotated[tuple[fields.Inertia, ...], OneOrMany] = given(
        "of every throw with the mean of its moving masses, from the first end; one value for all",
        (),
    )
    crank_inertia: Annotated[tuple[fields.Inertia, ...], OneOrMany] = given(
        "of every throw without moving masses, in place of `inertia`; the mean of those is added",
        (),
    )
    stiffness: Annotated[tuple[fields.Stiffness, ...], OneOrMany] = given(
        "between throws, from the first end; one value for all", ()
    )
    damping: Annotated[tuple[fields.Damping, ...], OneOrMany] = given(
        "to ground, by throw; one value for all", ()
    )
    loss_factor: fields.LossFactor = given("of the crank spans", 0.0)

    def refuse_throws(self, throws: int) -> None:
        """Refuse lists that do not have one value for each of the throws, or of the spans between them."""
        for key in ("inertia", "crank_inertia", "damping", "stiffness"):
            allowed = throws - 1 if key == "stiffness" else throws
            count = len(getattr(self, key))
            if count not in (0, 1, allowed) or count > allowed:
                words = "throws" if allowed == throws else "spans between them"
                message = f"`{key}` has {count} values, and there are {allowed} {words}"
                raise refuse(message, "one value, or each", key)
        if throws > 1 and not self.stiffness:
            message = "`stiffness` of the crank spans is missing"
            raise refuse(message, "between throws; one value for all")
        ONE_INERTIA.check(self)

    def lower_throws(
        self,
        build: Lowering,
        throws: Sequence[tuple[str, float]],
        shaft: ShaftRecord | None = None,
    ) -> tuple[tuple[int, ...], tuple[int, ...]]:
        """Add throws and spans; return the stations of the throws and the parts of the spans, from the first end.

        throws: name and mean inertia (kg m2) of the moving masses of each, from the first end. shaft: for the rules
        that judge the stress of the spans.
        """
        owner = build.parts[-1]
        stations, spans = dict[int, int](), dict[int, int]()
        numbers = range(len(throws))
        for throw in reversed(numbers) if self.reverse else numbers:
            name, moving_inertia = throws[throw]
            if stations:
                span = throw if self.reverse else throw - 1
                build.member(owner, f"crank {span + 1}-{span + 2}", "crank", is_point=False)
                spans[span] = build.part
                ends, stiffness = build.link(), build.to_own_speed(_value(self.stiffness, span))
                build.add(
                    Spring(build.name, build.part, *ends, 1.0 / stiffness, 0.0, self.loss_factor)
                )
                if self.loss_factor:
                    build.place(damping=("loss_factor", self.loss_factor))
                build.record(shaft)
            build.member(owner, name, "throw", is_point=True, symbol=Symbol("throw"))
            stations[throw] = station = build.point()
            if self.inertia:
                build.inertia(station, _value(self.inertia, throw))
            else:
                build.inertia(station, _value(self.crank_inertia, throw), "crank")
                build.inertia(station, moving_inertia, "moving masses, mean")
            if damping := _value(self.damping or (0.0,), throw):
                build.add(Damper(station, constant=build.to_own_speed(damping)))
        return tuple(stations[throw] for throw in numbers), tuple(
            spans[span] for span in sorted(spans)
        )


def check_rod(rod_length: float, stroke: float, offset: float = 0.0) -> None:
    """Refuse a connecting rod with which the piston cannot pass its dead centres; lengths in m."""
    if rod_length <= stroke / 2.0 + abs(offset):
        message = "the rod is not longer than half the stroke and the offset together"
        raise refuse(message, "the piston could not pass its dead centres", "rod_length")


def _value(values: tuple[float, ...], position: int) -> float:
    """The value at a position; one value stands for all."""
    return values[position] if len(values) > 1 else values[0]
