"""`misfire: worst`: the train once for every cylinder, that one motored."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

from torsion.model.engine.record import EngineRecord
from torsion.model.lowering import Part
from torsion.primitives import Torque

Case = tuple[str, tuple[Part, ...], tuple[Torque, ...]]


def misfire_cases(parts: Sequence[Part], torques: Sequence[Torque]) -> Iterator[Case]:
    """What misfires, with parts and torques then; nothing where no engine tries every cylinder in turn."""
    for place, part in enumerate(parts):
        if part.engine is not None and part.engine.tries_all:
            for one in part.engine.cylinders:
                if one.state == "firing":
                    engine = _without(part.engine, one.number)
                    changed = (*parts[:place], replace(part, engine=engine), *parts[place + 1 :])
                    words = f"cylinder {one.number} of {part.name} motored"
                    yield words, changed, tuple(_torques(torques, engine))


def _without(engine: EngineRecord, number: int) -> EngineRecord:
    """The engine with one cylinder more that does not fire; where it keeps its power, the others make up for it."""
    fires = [one for one in engine.cylinders if one.state == "firing" and one.number != number]
    before = sum(one.share for one in engine.cylinders if one.state == "firing")
    raised = before / sum(one.share for one in fires) if engine.keeps_power else 1.0
    cylinders = tuple(
        replace(one, state="motored")
        if one.number == number
        else replace(one, share=one.share * raised)
        for one in engine.cylinders
    )
    return replace(engine, cylinders=cylinders)


def _torques(torques: Sequence[Torque], engine: EngineRecord) -> Iterator[Torque]:
    """The torques of a train with the states of the cylinders of one engine."""
    station, load = engine.load_says
    mine = [
        one for one in torques if one.cylinder is not None and one.cylinder.engine == engine.part
    ]
    each = len(mine) // len(engine.cylinders)
    state = {id(one): engine.cylinders[place // each] for place, one in enumerate(mine)}
    for one in torques:
        if one.cylinder is None or id(one) not in state:
            yield one
        else:
            own = state[id(one)]
            law = replace(
                one.cylinder, state=own.state, share=own.share, station=station, load=load
            )
            yield replace(one, cylinder=law)
