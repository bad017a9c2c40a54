"""`misfire: worst`: the train once for every cylinder, that one motored."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

from torsion.model.engine.record import EngineRecord
from torsion.model.parts import Part
from torsion.primitives import Torque

Case = tuple[str, tuple[Part, ...], tuple[Torque, ...]]


def misfire_cases(parts: Sequence[Part], torques: Sequence[Torque]) -> Iterator[Case]:
    """What misfires, with parts and torques then; nothing where no engine tries every cylinder in turn."""
    for position, part in enumerate(parts):
        engine = part.engine
        if engine is None or not engine.tries_all:
            continue
        firing = [cylinder for cylinder in engine.cylinders if cylinder.state == "firing"]
        share = sum(cylinder.share for cylinder in firing)
        for motored in firing:
            remaining = sum(cylinder.share for cylinder in firing if cylinder is not motored)
            # Where the engine keeps its power, the others make up for it.
            raised = share / remaining if engine.keeps_power else 1.0
            cylinders = tuple(
                replace(cylinder, state="motored")
                if cylinder is motored
                else replace(cylinder, share=cylinder.share * raised)
                for cylinder in engine.cylinders
            )
            changed = replace(engine, cylinders=cylinders)
            words = f"cylinder {motored.number} of {part.name} motored"
            others = (*parts[:position], part.with_records(changed), *parts[position + 1 :])
            yield words, others, tuple(_torques(torques, changed))


def _torques(torques: Sequence[Torque], engine: EngineRecord) -> Iterator[Torque]:
    """Yield the torques of a train with the states of the cylinders of one engine."""
    station, load = engine.load_says
    count = sum(
        torque.cylinder is not None and torque.cylinder.engine == engine.part for torque in torques
    )
    # The torques of an engine stand cylinder by cylinder, each with the same number of orders.
    cylinders = (
        cylinder for cylinder in engine.cylinders for _ in range(count // len(engine.cylinders))
    )
    for torque in torques:
        law = torque.cylinder
        if law is not None and law.engine == engine.part:
            cylinder = next(cylinders)
            law = replace(
                law, state=cylinder.state, share=cylinder.share, station=station, load=load
            )
            yield replace(torque, cylinder=law)
        else:
            yield torque
