"""A crankshaft as points and links in a row: throws with their damping, and the spans between them."""

from collections.abc import Callable
from dataclasses import dataclass

from torsion.model.lowering import Lowering, ShaftRecord
from torsion.primitives import Damper, Spring


@dataclass(frozen=True)
class Crankshaft:
    """What throws and spans have, from the first end of the crankshaft; one value stands for all."""

    names: tuple[str, ...]  # of the throws
    stiffness: tuple[float, ...]  # N m/rad between them
    damping: tuple[float, ...]  # N m s/rad to ground, by throw
    loss_factor: float
    shaft: ShaftRecord | None = None  # for the rules that judge the stress of its spans
    reverse: bool = False  # the train meets its last throw first

    def lower(
        self, build: Lowering, masses: Callable[[int, int], None]
    ) -> tuple[tuple[int, ...], tuple[int, ...]]:
        """Stations of the throws and parts of the spans, both from its first end; masses(station, throw) adds those."""
        number, owner = len(self.names), build.parts[-1]
        stations, cranks = dict[int, int](), dict[int, int]()
        way = range(number - 1, -1, -1) if self.reverse else range(number)
        for place, throw in enumerate(way):
            if place:
                span = min(throw, throw + 1 if self.reverse else throw - 1)
                build.member(owner, f"crank {span + 1}-{span + 2}", "crank", is_point=False)
                cranks[span] = build.part
                driving, driven = build.link()
                flexibility = 1.0 / build.own(of(self.stiffness, span))
                build.add(
                    Spring(
                        build.name, build.part, driving, driven, flexibility, 0.0, self.loss_factor
                    )
                )
                if self.shaft is not None:
                    build.record(shaft=self.shaft)
                if self.loss_factor:
                    build.record(damping=("loss_factor", self.loss_factor))
            build.member(owner, self.names[throw], "throw", is_point=True)
            stations[throw] = here = build.point()
            masses(here, throw)
            if damping := of(self.damping or (0.0,), throw):
                build.add(Damper(here, constant=build.own(damping)))
        return tuple(stations[k] for k in range(number)), tuple(
            cranks[k] for k in range(number - 1)
        )


def of(values: tuple[float, ...], place: int) -> float:
    """The value of a place; one value stands for all."""
    return values[place] if len(values) > 1 else values[0]
