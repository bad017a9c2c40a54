"""How far every hub on the end of a shaft moves the natural frequencies, beside a shaft that twists in all its seat."""

from dataclasses import replace

import numpy as np

from torsion.analyses.modes.sharp_steps import frequencies_of
from torsion.analyses.undamped_modes import Modes
from torsion.arrays import FloatArray
from torsion.findings import Work
from torsion.primitives import Bar
from torsion.results import reported, result


@reported
class HubMove:
    """A hub on the end of a shaft."""

    shaft: str = result("", (), "shaft on whose end it sits")
    end: str = result("", (), "first or last")
    seat: float = result("m", (), "length of its seat")
    twisting: float = result(
        "m", (), "length of the shaft that twists as much as the seat and the hub"
    )
    error: float | None = result("m", (), "its error by finite elements; null by formula")
    frequency: FloatArray = result(
        "Hz", ("mode",), "natural frequencies if the shaft twisted in all of this seat"
    )
    change: FloatArray = result("1", ("mode",), "of the train as computed, relative to those")


@reported
class HubMoves:
    """Every hub of the train."""

    each: tuple[HubMove, ...] = result("", (), "hubs", key="")


def hub_moves(found: Modes) -> HubMoves:
    """Of a train whose modes are known: the modes again without each of its hubs, the shafts divided alike."""
    from torsion.assembly.junction.hubs import seat_length

    train, system, moves = found.system.train, found.system, list[HubMove]()
    for place, bar in enumerate(train.bars):
        record = train.parts[bar.part].shaft
        for hub in record.hubs if record is not None else ():
            left, error = seat_length(train, bar, hub)
            own = train.materials[train.shaft(bar).material].shear_modulus
            flexible: Bar = replace(
                bar,
                shear_modulus=1.0
                / (1.0 / bar.shear_modulus + (hub.length - left) / bar.length / own),
                segments=system.segments.get(bar.name, bar.segments),
            )
            bars = (*train.bars[:place], flexible, *train.bars[place + 1 :])
            hertz = frequencies_of(replace(train, bars=bars), found)
            change = np.asarray(found.frequency[: hertz.size] / hertz - 1.0)
            moves.append(HubMove(bar.name, hub.end, hub.length, left, error, hertz, change))
    return HubMoves(tuple(moves))


def run(work: Work) -> None:
    """Where modes were found."""
    modes = work.get(Modes)
    if modes is None or not modes.frequency.size:
        return
    with work.log.step("hubs on shafts", "a shaft has a `hub`") as step:
        found = hub_moves(modes)
        step.method = "the modes again without each of them"
        step.size = f"{len(found.each)} hubs"
    work.put(hubs=found)
