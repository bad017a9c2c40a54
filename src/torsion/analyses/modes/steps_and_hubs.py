"""How far sharp corners at unstated steps, and hubs on the ends of shafts, move the natural frequencies."""

from dataclasses import replace

import numpy as np

from torsion.analyses.undamped_modes import Modes, modes_as_discretised
from torsion.arrays import FloatArray
from torsion.assembly import assemble
from torsion.findings import Work
from torsion.results import reported, result
from torsion.train import Train


@reported
class SharpStep:
    """A step that the train takes without a twist of its own."""

    shaft: str = result("shaft that ends at it")
    following: str = result("shaft that begins at it")
    flexibility: float | None = result(
        "rad/(N*m)",
        "additional twist of a sharp corner between both shafts; null outside the table",
    )
    remark: str = result(
        "equivalent length of the named shaft, and its error; or why there is none"
    )


@reported
class SharpSteps:
    """The steps between shafts that the file says nothing about, and what sharp corners there would do."""

    steps: tuple[SharpStep, ...] = result("the steps")
    frequency: FloatArray = result(
        "Hz", "mode", "natural frequencies with sharp corners at all of them"
    )
    change: FloatArray = result("1", "mode", "relative to those without, as the train is computed")


@reported
class HubMove:
    """A hub on the end of a shaft, compared with a shaft that twists in all its seat."""

    shaft: str = result("shaft on whose end it sits")
    end: str = result("first or last")
    seat: float = result("m", "length of its seat")
    twisting: float = result("m", "length of the shaft that twists as much as the seat and the hub")
    error: float | None = result("m", "its error by finite elements; null by formula")
    frequency: FloatArray = result(
        "Hz", "mode", "natural frequencies if the shaft twisted in all of this seat"
    )
    change: FloatArray = result("1", "mode", "of the train as computed, relative to those")


@reported
class HubMoves:
    """The hubs of the train."""

    each: tuple[HubMove, ...] = result("hubs", key="")


def run_steps(work: Work) -> None:
    """Put the steps where modes were computed, and shafts have steps.

    Only the table of junctions is read; a step that it does not have is reported as left out. The shafts are divided as
    those of the modes, so that the errors of both discretisations go out of the change.
    """
    from torsion.assembly.junction.stepped_shafts import has_unstated, stepped

    modes = work.get(Modes)
    if modes is None or not modes.frequency.size or not has_unstated(work.study.train):
        return
    reason = "shafts of unlike diameter meet, and no `step` is stated"
    with work.log.step("steps between shafts", reason) as step:
        plain = modes.system.train
        train = stepped(plain, "sharp", [], by_table=True)
        added = {spring.part: spring.flexibility for spring in train.springs[len(plain.springs) :]}
        beginning = {bar.driving: bar.name for bar in plain.bars}
        steps = []
        for bar in sorted(plain.bars, key=lambda bar: bar.part):
            remark = train.parts[bar.part].remark
            if remark != plain.parts[bar.part].remark:
                flexibility = added.get(bar.part)
                steps.append(SharpStep(bar.name, beginning[bar.driven], flexibility, remark))
        step.method = "each as a spring from the table of finite elements; the modes again"
        step.size = f"{len(steps)} steps"
        hertz = _frequencies_of(train, modes) if added else modes.frequency
    if steps:
        change = np.asarray(hertz / modes.frequency[: hertz.size] - 1.0)
        work.put(sharp_steps=SharpSteps(tuple(steps), hertz, change))


def run_hubs(work: Work) -> None:
    """Put the modes again without each hub where modes were computed, the shafts divided alike."""
    modes = work.get(Modes)
    if modes is None or not modes.frequency.size:
        return
    from torsion.assembly.junction.hubs import seat_length

    with work.log.step("hubs on shafts", "a shaft has a `hub`") as step:
        train = modes.system.train
        moves = []
        for position, bar in enumerate(train.bars):
            record = train.parts[bar.part].shaft
            for hub in record.hubs if record is not None else ():
                twisting, error = seat_length(train, bar, hub)
                modulus = train.materials[train.shaft(bar).material].shear_modulus
                added = (hub.length - twisting) / bar.length / modulus
                flexible = replace(
                    bar,
                    shear_modulus=1.0 / (1.0 / bar.shear_modulus + added),
                    segments=modes.system.segments.get(bar.name, bar.segments),
                )
                bars = (*train.bars[:position], flexible, *train.bars[position + 1 :])
                hertz = _frequencies_of(replace(train, bars=bars), modes)
                change = np.asarray(modes.frequency[: hertz.size] / hertz - 1.0)
                moves.append(HubMove(bar.name, hub.end, hub.length, twisting, error, hertz, change))
        step.method = "the modes again without each of them"
        step.size = f"{len(moves)} hubs"
    work.put(hubs=HubMoves(tuple(moves)))


def _frequencies_of(train: Train, modes: Modes) -> FloatArray:
    """Return as many frequencies (Hz) of a train that differs in flexibilities alone, assembled as that of the modes."""
    system = assemble(train, modes.system.model, **vars(modes.system.requested))
    return modes_as_discretised(system, modes.frequency.size).frequency
