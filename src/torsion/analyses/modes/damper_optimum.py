"""What the best ring of a damper would be for each mode of the train: a first choice, which the response confirms."""

import math
from collections.abc import Iterator
from dataclasses import replace

from torsion.analyses.undamped_modes import Modes, modes
from torsion.assembly import of_train
from torsion.assembly.system import System
from torsion.findings import Work
from torsion.kernels.ring_damper import magnification, tuned, viscous
from torsion.primitives import Spring, tabled_spring
from torsion.results import reported, result

SMALLEST_RATIO = 1e-2  # ring over modal inertia: below it no ring changes the mode by much


@reported
class DamperOptimum:
    """A damper at one mode of the train without its ring, all at the damper's own speed."""

    damper: str = result("its name")
    mode: int = result("elastic mode of the train without the ring, counted from 1")
    frequency: float = result("Hz", "of that mode")
    inertia: float = result("kg*m**2", "of that mode, seen at the housing")
    ratio: float = result("1", "inertia of the ring / modal inertia", key="mass_ratio")
    viscous: float = result("N*m*s/rad", "best damping of a ring without stiffness")
    viscous_peak: float = result("1", "peak magnification of the mode with it")
    stiffness: float = result("N*m/rad", "best stiffness of a ring on a spring")
    damping: float = result("N*m*s/rad", "optimum viscous damping with that stiffness")
    tuned_peak: float = result("1", "peak magnification of the mode with both")
    given_peak: float | None = result(
        "1",
        "peak magnification of the mode with the ring of the file; a frequency law is evaluated at that mode",
    )


@reported
class Dampers:
    """The optimum of every damper at every mode that it reaches."""

    each: tuple[DamperOptimum, ...] = result("dampers by the modes that they reach", key="")


def run(work: Work) -> None:
    """Put the optima where modes were computed; each ring is left out alone, those of others stay."""
    train_modes = work.get(Modes)
    train = work.study.train
    if train_modes is None:
        work.log.without("optimum of the dampers", "no modes")
        return
    system = train_modes.system
    count = len(train_modes.frequency)
    optima = list[DamperOptimum]()
    with work.log.step("optimum of the dampers", "the train has dampers") as step:
        step.method = "closed forms of one mode, with the inertia that it has at the housing"
        for ring in train.springs:
            if train.parts[ring.part].kind == "damper" and ring.flexibility:
                optima += _optima(system, ring, count)
    work.put(dampers=Dampers(tuple(optima)))


def _optima(system: System, ring: Spring, count: int) -> Iterator[DamperOptimum]:
    """Yield the optimum for each of the lowest modes of the train without that ring."""
    train = system.train
    inertia = sum(lump.inertia for lump in train.inertias if lump.station == ring.driven)
    if not inertia or not count:
        return
    # A ring of no inertia does nothing: its angle is that of the housing.
    flexibility = ring.flexibility if math.isfinite(ring.flexibility) else 1.0
    idle = replace(ring, table=None, flexibility=flexibility)
    without = replace(
        train,
        inertias=tuple(lump for lump in train.inertias if lump.station != ring.driven),
        springs=tuple(idle if spring is ring else spring for spring in train.springs),
    )
    bare = modes(of_train(system, without), count)
    angles = bare.shape[ring.driving].tolist()
    for mode, (hertz, angle) in enumerate(zip(bare.frequency.tolist(), angles, strict=True), 1):
        ratio = inertia * angle**2
        if ratio < SMALLEST_RATIO:
            continue
        omega = 2.0 * math.pi * hertz
        plain = viscous(ratio)
        best = tuned(ratio)
        given = ring
        if ring.table is not None:
            given = tabled_spring(ring.name, 0, (0, 0), ring.table, omega)
        critical = 2.0 * inertia * omega
        tuning = math.sqrt(1.0 / (given.flexibility * inertia)) / omega
        yield DamperOptimum(
            train.parts[ring.part].name,
            mode,
            hertz,
            1.0 / angle**2,
            ratio,
            critical * plain.damping,
            plain.magnification,
            inertia * (omega * best.tuning) ** 2,
            critical * best.damping,
            best.magnification,
            magnification(ratio, tuning, given.viscous / critical, given.loss_factor),
        )
