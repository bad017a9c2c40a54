"""What the best ring of a damper would be for each mode of the train: a first choice, which the response confirms."""

import math
from collections.abc import Iterator
from dataclasses import replace

from torsion.analyses.undamped_modes import Modes, modes
from torsion.assembly import of_train
from torsion.assembly.system import System
from torsion.findings import Work
from torsion.kernels.damping.ring_damper import magnification, tuned, viscous
from torsion.primitives import Spring, tabled_spring
from torsion.results import reported, result
from torsion.train import Train

LEAST = (
    1e-2  # ring over inertia of the mode: below it no setting of the ring changes the mode by much
)


@reported
class DamperOptimum:
    """A damper at one mode of the train without its ring, all at the damper's own speed."""

    damper: str = result("", (), "its name")
    mode: int = result("", (), "elastic mode of the train without the ring, counted from 1")
    frequency: float = result("Hz", (), "of that mode")
    inertia: float = result("kg*m**2", (), "of that mode, seen at the housing")
    ratio: float = result("1", (), "inertia of the ring / modal inertia", key="mass_ratio")
    viscous: float = result("N*m*s/rad", (), "best damping of a ring without stiffness")
    viscous_peak: float = result("1", (), "peak magnification of the mode with it")
    stiffness: float = result("N*m/rad", (), "best stiffness of a ring on a spring")
    damping: float = result("N*m*s/rad", (), "optimum viscous damping with that stiffness")
    tuned_peak: float = result("1", (), "peak magnification of the mode with both")
    given_peak: float | None = result(
        "1",
        (),
        "peak magnification of the mode with the ring of the file; a frequency law is evaluated at that mode",
    )


@reported
class Dampers:
    """The optimum of every damper at every mode that it reaches."""

    each: tuple[DamperOptimum, ...] = result("", (), "dampers by the modes that they reach", key="")


def run(work: Work) -> None:
    """Where modes were found; the ring of each damper is left out alone, those of others stay."""
    found, train = work.get(Modes), work.study.train
    if found is None:
        work.log.without("optimum of the dampers", "no modes")
        return
    with work.log.step("optimum of the dampers", "the train has dampers") as step:
        step.method = "closed forms of one mode, with the inertia that it has at the housing"
        rings = [
            one
            for one in train.springs
            if train.parts[one.part].kind == "damper" and one.flexibility
        ]
        best = [
            one for ring in rings for one in _at_modes(found.system, ring, len(found.frequency))
        ]
    work.put(dampers=Dampers(tuple(best)))


def _at_modes(system: System, ring: Spring, count: int) -> Iterator[DamperOptimum]:
    """The optimum for each of the lowest modes of the train without that ring."""
    train = system.train
    inertia = sum(one.inertia for one in train.inertias if one.station == ring.driven)
    if not inertia or not count:
        return
    bare = of_train(system, without(train, ring))
    found = modes(bare, count)
    for mode, (frequency, angle) in enumerate(
        zip(found.frequency, found.shape[ring.driving], strict=True), start=1
    ):
        ratio = float(inertia * angle**2)
        if ratio < LEAST:
            continue
        omega, plain, best = 2.0 * math.pi * float(frequency), viscous(ratio), tuned(ratio)
        given = (
            ring if ring.table is None else tabled_spring(ring.name, 0, (0, 0), ring.table, omega)
        )
        yield DamperOptimum(
            train.parts[ring.part].name,
            mode,
            float(frequency),
            float(1.0 / angle**2),
            ratio,
            2.0 * inertia * omega * plain.damping,
            plain.magnification,
            inertia * (omega * best.tuning) ** 2,
            2.0 * inertia * omega * best.damping,
            best.magnification,
            magnification(
                ratio,
                math.sqrt(1.0 / (given.flexibility * inertia)) / omega,
                given.viscous / (2.0 * inertia * omega),
                given.loss_factor,
            ),
        )


def without(train: Train, ring: Spring) -> Train:
    """The train with a ring of no inertia, which then does nothing: its angle is that of the housing."""
    held = replace(
        ring, table=None, flexibility=ring.flexibility if math.isfinite(ring.flexibility) else 1.0
    )
    return replace(
        train,
        inertias=tuple(one for one in train.inertias if one.station != ring.driven),
        springs=tuple(held if one is ring else one for one in train.springs),
    )
