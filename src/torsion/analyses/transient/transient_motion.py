"""Motion over time of a train, exactly from its modes: torques, their peaks and reversals, and speeds."""

from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from torsion.analyses.transient.direct_torques import direct_torques
from torsion.analyses.transient.energy_balance import residual
from torsion.analyses.transient.following_torques import (
    Following,
    carrier_of,
    dampers_beside_loads,
    following,
    refuse_beyond_tables,
)
from torsion.analyses.transient.joint_cuts import joint_cuts, parts_of
from torsion.analyses.transient.known_loads import known_loads, vibration_before
from torsion.analyses.transient.modal_train import all_modes, modal_train, shapes, slowed_torques, start
from torsion.analyses.transient.resonances_passed import Passage, passages
from torsion.analyses.transient.state_before import State, points_of_events, state_before
from torsion.analyses.transient.torque_curves import Curves, missed, sampled
from torsion.analyses.transient.transient_settings import DEFAULT_MOST, PER_PERIOD, TransientSettings
from torsion.analyses.undamped_modes import Modes
from torsion.arrays import FloatArray, IntArray
from torsion.assembly.system import System
from torsion.findings import Progress, Work, silent
from torsion.kernels.transient.collocation import Collocated
from torsion.kernels.transient.damped_motion import ModalTrain, motion
from torsion.results import reported, result
from torsion.study import Study


@reported
class Change:
    """A change of the law of a torque."""

    time: float = result("s", (), "when")
    what: str = result("", (), "the torque")


@reported
class TransientMotion:
    """The motion of the train from its events."""

    time: FloatArray = result("s", ("time",), "samples")
    torque: FloatArray = result(
        "N*m", ("span", "time"), "torque, positive when the driving side pushes", printed=("time", "end span")
    )
    speed: FloatArray = result(
        "rad/s", ("station", "time"), "speed of its own shaft", printed=("time", "named station")
    )
    greatest: FloatArray = result("N*m", ("span",), "greatest torque, also between samples")
    greatest_at: FloatArray = result("s", ("span",), "when")
    least: FloatArray = result("N*m", ("span",), "least torque")
    least_at: FloatArray = result("s", ("span",), "when")
    before: FloatArray = result("N*m", ("span",), "mean torque before the events")
    reversals: IntArray = result("", ("span",), "how often the torque changes its sign")
    unresolved: FloatArray = result(
        "N*m", ("span",), "at most so much do modes add that have fewer than 4 samples in a period: not in the peaks"
    )
    residual: float = result("1", (), "largest error of the balance of energy, of the largest energy of the motion")
    speed_before: float = result("rad/s", (), "reference speed before the events")
    modes: int = result("", (), "elastic modes that were kept: all")
    steps: int = result("", (), "steps for the torques that follow the motion; 0: there are none", default=0)
    following: tuple[str, ...] = result("", (), "torques that follow the motion", default=())
    left_in_series: float = result(
        "1", (), "largest last term of their series over a step, of the largest of them", default=0.0
    )
    passages: tuple[Passage, ...] = result("", (), "resonances that the changing speed passes", default=())
    changes: tuple[Change, ...] = result("", (), "when a torque that follows the motion changes its law", default=())
    system: System | None = None

    @property
    def peak(self) -> FloatArray:
        """(spans,) N m, the greatest magnitude, with what modes without samples may add."""
        return np.maximum(np.abs(self.greatest), np.abs(self.least)) + self.unresolved


def transient(
    study: Study, system: System, settings: TransientSettings, *, modes: Modes | None = None,
    damping_ratio: float | None = None, progress: Progress = silent,
) -> TransientMotion:  # fmt: skip
    """The motion from the events of `settings`, exact at every sample, and its peaks between them.

    modes: all of the system, where they are known. damping_ratio: of every mode, in place of the damping of the train.
    Raises InputError for an event that the train cannot have, and SolveError where a mode is not certified or the train
    is of a kind that is not built.
    """
    before = state_before(study, system, settings)
    cuts = joint_cuts(system, before.mean)
    parts = replace(parts_of(system, cuts), dampers=dampers_beside_loads(study, system, settings.events))
    found = all_modes(parts) if modes is None or cuts else modes
    shape = shapes(parts, found)
    points = points_of_events(study, system, settings, before)
    follows = following(study, system, settings.events, before, cuts, points, shape)
    turns = follows is not None
    train = modal_train(study, parts, found, shape, before, turns=turns)
    if damping_ratio is not None:
        train = ModalTrain(train.w, np.full(len(train.w), damping_ratio), np.zeros_like(train.viscous))
    loads, acting = known_loads(study, parts, settings.events, points, follows)
    place, speed = start(parts, found, before, shape)
    direct, added = direct_torques(parts, found, acting), dict[str, Any]()
    if follows is None:
        moved = motion(train, shape.T @ acting, loads, place, speed)
    else:
        if not cuts:
            shaken = vibration_before(parts, found, before, shape)
            place, speed = place + shaken[0], speed + shaken[1]
        before = replace(before, frequency=before.frequency[:0], amplitude=before.amplitude[:0])
        given = motion(train, shape.T @ acting, loads, place, speed)
        moved, solved = follows.solve(system, given, shape, settings.duration, settings.tolerance)
        follows.carried(system, direct)
        added = _of_steps(follows, solved)
    time = np.linspace(0.0, settings.duration, _samples(settings, found) + 1)
    slowed = slowed_torques(study, parts, found, shape, before, turns=turns)
    carrier = carrier_of(study, system, settings.events, before, cuts)
    patches = [partial(cut.patched, system) for cut in cuts if cut.massless]
    curves = Curves(system, found, before, shape, moved, slowed, direct, carrier, patches)
    torque, turning, (top, bottom) = sampled(curves, time, progress)
    refuse_beyond_tables(study, settings.events, turning)
    if follows is not None:
        straight = _straight(study, system, before) if cuts else train
        added["passages"] = passages(system, follows, straight, time, turning)
    reversals = np.count_nonzero(np.diff(np.signbit(torque), axis=1), axis=1)
    lacking = missed(found, moved, time)
    checked = residual(moved, time)
    return TransientMotion(
        time, torque, turning, *top, -bottom[0], bottom[1], before.torque, reversals, lacking, checked, before.speed,
        len(found.frequency), **added, system=system,
    )  # fmt: skip


def _straight(study: Study, system: System, before: State) -> ModalTrain:
    """The modes of a train with its joints straight, whose resonances are passed."""
    found = all_modes(system)
    return modal_train(study, system, found, shapes(system, found), before, turns=True)


def _of_steps(follows: Following, solved: Collocated) -> dict[str, Any]:
    """What the result says of torques that follow the motion."""
    changed = dict.fromkeys((time, follows.words[law]) for time, law, _ in solved.changes)
    return {
        "steps": len(solved.steps.begin), "following": tuple(dict.fromkeys(follows.words)),
        "left_in_series": solved.lack, "changes": tuple(Change(*one) for one in changed),
    }  # fmt: skip


def _samples(settings: TransientSettings, found: Modes) -> int:
    if settings.samples is not None:
        return settings.samples
    highest = float(found.frequency.max(initial=1.0 / settings.duration))
    return int(min(max(PER_PERIOD * highest * settings.duration, 1000.0), DEFAULT_MOST))


def run(work: Work) -> None:
    """The motion over time that the file names."""
    settings = work.settings("transient", TransientSettings)
    with work.log.step("motion over time", "requested") as step:
        found = transient(work.study, work.system, settings, progress=work.progress)
        step.method = "exact propagation of all modes"
        step.size = f"{found.modes} modes, {len(settings.events)} events, {len(found.time)} samples"
    work.put(transient=found)
