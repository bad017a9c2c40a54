"""Which torques act in a motion over time: every periodic torque of the file, but for those that it leaves out."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import groupby

from torsion.analyses.motion.events.events import Stop
from torsion.analyses.motion.events.transient_settings import TransientSettings
from torsion.assembly.system import System
from torsion.primitives import Torque
from torsion.study import Study

# orders of one component that are named with their amplitudes; of more their number is
MOST_AMOUNTS = 4
STEPS_PER_PERIOD = 8.0  # of the highest order, at most about, at a tolerance of 1e-6
SECONDS_PER_STEP = 3e-4  # of one station at which orders act
# end of the words of a periodic torque that the file leaves out
LEFT_OUT = "(left out by `torques`)"


@dataclass(frozen=True)
class ActingTorques:
    """The torques of a motion in words."""

    acting: tuple[str, ...]
    not_acting: tuple[str, ...]

    @property
    def words(self) -> str:
        """Both lists in one line for a reader."""
        without = f" Not acting: {'; '.join(self.not_acting)}." if self.not_acting else ""
        return f"Acting: {'; '.join(self.acting) or 'no torque'}.{without}"


def without_excluded_torques(
    study: Study, system: System, settings: TransientSettings
) -> tuple[Study, System]:
    """The study and the system without the periodic torques that do not act in the motion."""
    names = settings.torques
    if names is None:
        return study, system
    trains = []
    for train in (study.train, system.train):
        torques = tuple(torque for name in names for torque in train.periodic_torques[name])
        trains.append(replace(train, torques=torques))
    return replace(study, train=trains[0]), replace(system, train=trains[1])


def acting_torques(study: Study, settings: TransientSettings) -> ActingTorques:
    """All torques of a motion, and all that are not part of it with the reason."""
    acting, not_acting = list[str](), list[str]()
    for name, torques in study.train.periodic_torques.items():
        if settings.torques is None or name in settings.torques:
            acting += _in_words(name, torques, has_amounts=True)
        else:
            words = _in_words(name, torques, has_amounts=False)
            not_acting += (f"{text} {LEFT_OUT}" for text in words)

    reason = _reason_without_mean(study, settings)
    if reason:
        not_acting.append(f"mean torques ({reason})")
    else:
        bodies = [(event.at, event.body) for event in settings.events]
        ended = dict.fromkeys(at for at, body in bodies if body.drives or isinstance(body, Stop))
        but = f", but for those at {', '.join(ended)} that events end or replace" if ended else ""
        acting.append(
            f"mean torques (they stay at their initial values{but}; the law of a load acts by an event `load`)"
        )

    torques = study.train.torques
    swept = [torque.name for torque in torques if torque.order is None and torque.frequency is None]
    for name in dict.fromkeys(swept):
        not_acting.append(f"excitation at {name} (of the response over frequency only)")
    for event in settings.events:
        torque = getattr(event.body, "torque", None)
        amount = f" {torque:g} N m" if isinstance(torque, float) else ""
        acting.append(f"{event.body.key}{amount} at {event.at} from {event.time:g} s")
    return ActingTorques(tuple(acting), tuple(not_acting))


def expected_steps(study: Study, system: System, settings: TransientSettings) -> str:
    """How many steps orders take and how long that lasts, by the speed that is known; empty where it is short."""
    given = settings.initial.get("speed") if isinstance(settings.initial, dict) else None
    speed = given if isinstance(given, float) else study.operation.speed or 0.0
    _, acting = without_excluded_torques(study, system, settings)
    orders = {
        torque.station: float(torque.order) * abs(float(system.speed_ratio[torque.station]))
        for torque in sorted(acting.train.torques, key=lambda torque: torque.order or 0)
        if torque.order is not None
    }
    per_period = STEPS_PER_PERIOD * (1e-6 / settings.tolerance) ** (1.0 / 6.0)
    fastest = speed * max(orders.values(), default=0.0)
    steps = settings.duration * fastest / (2.0 * math.pi) * per_period
    lasts = SECONDS_PER_STEP * steps * len(orders)
    return f" At most about {steps:.1g} steps, {lasts:.1g} s of computing." if lasts >= 1.0 else ""


def _reason_without_mean(study: Study, settings: TransientSettings) -> str:
    """Why no mean torque acts; empty where it does."""
    if isinstance(settings.initial, dict):
        is_speed = "speed" in settings.initial
        return "the initial speed is given" if is_speed else "a twist is released"
    if settings.initial == "rest" or not study.operation.speed:
        return "the motion begins at rest"
    return "" if study.has_mean_torque else "no power is stated"


def _in_words(name: str, torques: Sequence[Torque], *, has_amounts: bool) -> Iterator[str]:
    """The periodic torques of one component: by order one after the other, or their number where there are many."""
    for is_order, group in groupby(torques, key=lambda torque: torque.order is not None):
        alike = list(group)
        if len(alike) > MOST_AMOUNTS or any(torque.cylinder for torque in alike):
            number = len({torque.order if is_order else torque.frequency for torque in alike})
            words = f"{number} {'orders' if is_order else 'frequencies'} at {name}"
            yield f"{words} (by its angle)" if is_order and has_amounts else words
            continue
        for torque in alike:
            what = f"order {torque.order}" if is_order else f"{torque.frequency:g} Hz"
            law = ", by its angle" if is_order else ""
            share = f"{100.0 * torque.of_mean:g} % of its mean torque" if torque.of_mean else ""
            amount = "a table over its speed" if torque.table else share
            amount = amount or f"{torque.torque:g} N m"
            yield f"{what} at {name}" + (f" ({amount}{law})" if has_amounts else "")
