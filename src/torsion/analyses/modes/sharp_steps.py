"""How far the natural frequencies would move with a sharp corner at every step between shafts that says nothing."""

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

    shaft: str = result("", (), "shaft that ends at it")
    following: str = result("", (), "shaft that begins at it")
    flexibility: float | None = result(
        "rad/(N*m)",
        (),
        "additional twist of a sharp corner between both shafts; null outside the table",
    )
    remark: str = result(
        "", (), "equivalent length of the named shaft, and its error; or why there is none"
    )


@reported
class SharpSteps:
    """The steps between shafts that the file says nothing about, and what sharp corners there would do."""

    steps: tuple[SharpStep, ...] = result("", (), "the steps")
    frequency: FloatArray = result(
        "Hz", ("mode",), "natural frequencies with sharp corners at all of them"
    )
    change: FloatArray = result(
        "1", ("mode",), "relative to those without, as the train is computed"
    )


def sharp_steps(found: Modes) -> SharpSteps | None:
    """Of a train whose modes are known; None where its shafts have no steps.

    Only the table of junctions is read; a step that it does not have is said to be left out. The shafts are divided as
    those of the modes, so that the errors of both discretisations go out of the change.
    """
    from torsion.assembly.junction.stepped_shafts import stepped

    before = found.system.train
    train = stepped(before, "sharp", [], by_table=True)
    added = {spring.part: spring.flexibility for spring in train.springs[len(before.springs) :]}
    names = {bar.driving: bar.name for bar in before.bars}
    ends = {bar.part: bar for bar in before.bars}
    steps = tuple(
        SharpStep(bar.name, names[bar.driven], added.get(number), part.remark)
        for number, (part, old) in enumerate(zip(train.parts, before.parts, strict=True))
        if part.remark != old.remark and (bar := ends.get(number)) is not None
    )
    if not steps:
        return None
    hertz = found.frequency
    if added:
        hertz = frequencies_of(train, found)
    return SharpSteps(steps, hertz, np.asarray(hertz / found.frequency[: hertz.size] - 1.0))


def frequencies_of(train: Train, found: Modes) -> FloatArray:
    """Hz, as many as were found, of a train that differs in flexibilities alone, assembled as that of the modes."""
    other = assemble(train, found.system.model, **vars(found.system.requested))
    return modes_as_discretised(other, found.frequency.size).frequency


def run(work: Work) -> None:
    """Where modes were found, and shafts have steps."""
    modes = work.get(Modes)
    if modes is None or not modes.frequency.size:
        return
    from torsion.assembly.junction.stepped_shafts import has_unstated

    if not has_unstated(work.study.train):
        return
    with work.log.step(
        "steps between shafts", "shafts of unlike diameter meet, and no `step` is stated"
    ) as step:
        found = sharp_steps(modes)
        step.method = "each as a spring from the table of finite elements; the modes again"
        step.size = f"{0 if found is None else len(found.steps)} steps"
    if found is not None:
        work.put(sharp_steps=found)
