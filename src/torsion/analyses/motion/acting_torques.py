"""Which torques act in a motion over time: every periodic torque of the file, but for those that it leaves out."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import groupby

from torsion.analyses.motion.events import Stop
from torsion.analyses.motion.transient_settings import TransientSettings
from torsion.assembly.system import System
from torsion.primitives import Torque
from torsion.study import Study
from torsion.train import Train

MOST_AMOUNTS = (
    4  # orders of one component that are named with their amplitudes; of more their number is
)
STEPS_PER_PERIOD = 8.0  # of the highest order, at most about, at a tolerance of 1e-6
SECONDS_PER_STEP = 3e-4  # of one station at which orders act

LEFT_OUT = (
    "(left out by `torques`)"  # end of the words of a periodic torque that the file leaves out
)


@dataclass(frozen=True)
class ActingTorques:
    """The torques of a motion in words."""

    acting: tuple[str, ...]
    not_acting: tuple[str, ...]

    @property
    def words(self) -> str:
        """Both lists in one line."""
        without = f" Not acting: {'; '.join(self.not_acting)}." if self.not_acting else ""
        return f"Acting: {'; '.join(self.acting) or 'no torque'}.{without}"


def without_excluded_torques(
    study: Study, system: System, settings: TransientSettings
) -> tuple[Study, System]:
    """The study and the system with the periodic torques alone that act in the motion."""
    if settings.torques is None:
        return study, system
    trains = (_train_of_acting(one.train, settings.torques) for one in (study, system))
    return replace(study, train=next(trains)), replace(system, train=next(trains))


def _train_of_acting(train: Train, names: Sequence[str]) -> Train:
    return replace(
        train, torques=tuple(torque for name in names for torque in train.periodic_torques[name])
    )


def acting_torques(study: Study, settings: TransientSettings) -> ActingTorques:
    """All torques of a motion, and all that are not part of it with the reason."""
    acting, not_acting = list[str](), list[str]()
    for name, torques in study.train.periodic_torques.items():
        if settings.torques is None or name in settings.torques:
            acting += _in_words(name, torques, has_amounts=True)
        else:
            not_acting += (
                f"{words} {LEFT_OUT}" for words in _in_words(name, torques, has_amounts=False)
            )

    reason = _reason_without_mean(study, settings)
    if reason:
        not_acting.append(f"mean torques ({reason})")
    else:
        replaced = dict.fromkeys(
            event.at
            for event in settings.events
            if event.body.drives or isinstance(event.body, Stop)
        )
        but = (
            f", but for those at {', '.join(replaced)} that events end or replace"
            if replaced
            else ""
        )
        acting.append(
            f"mean torques (they stay at their initial values{but}; the law of a load acts by an event `load`)"
        )

    swept = dict.fromkeys(
        one.name for one in study.train.torques if one.order is None and one.frequency is None
    )
    not_acting += (f"excitation at {name} (of the response over frequency only)" for name in swept)
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
        (torque.station, float(torque.order) * abs(float(system.speed_ratio[torque.station])))
        for torque in acting.train.torques
        if torque.order is not None
    }
    fastest = speed * max((order for _, order in orders), default=0.0)
    per_period = STEPS_PER_PERIOD * (1e-6 / settings.tolerance) ** (1.0 / 6.0)
    steps = settings.duration * fastest / (2.0 * math.pi) * per_period
    lasts = SECONDS_PER_STEP * steps * len({station for station, _ in orders})
    return f" At most about {steps:.1g} steps, {lasts:.1g} s of computing." if lasts >= 1.0 else ""


def _reason_without_mean(study: Study, settings: TransientSettings) -> str:
    """Why no mean torque acts; empty where it does."""
    if isinstance(settings.initial, dict):
        return (
            "the initial speed is given" if "speed" in settings.initial else "a twist is released"
        )
    if settings.initial == "rest" or not study.operation.speed:
        return "the motion begins at rest"
    return "" if study.has_mean_torque else "no power is stated"


def _in_words(name: str, torques: Sequence[Torque], *, has_amounts: bool) -> Iterator[str]:
    """The periodic torques of one component: by order one after the other, or their number where there are many."""
    for by_angle, group in groupby(torques, key=lambda torque: torque.order is not None):
        alike = list(group)
        if len(alike) > MOST_AMOUNTS or any(torque.cylinder for torque in alike):
            number = len({torque.order if by_angle else torque.frequency for torque in alike})
            what = f"{number} {'orders' if by_angle else 'frequencies'} at {name}"
            yield f"{what} (by its angle)" if by_angle and has_amounts else what
            continue
        for torque in alike:
            what = f"order {torque.order}" if by_angle else f"{torque.frequency:g} Hz"
            law = ", by its angle" if by_angle else ""
            yield (
                f"{what} at {name} ({_amount(torque)}{law})" if has_amounts else f"{what} at {name}"
            )


def _amount(torque: Torque) -> str:
    if torque.table:
        return "a table over its speed"
    return (
        f"{100.0 * torque.of_mean:g} % of its mean torque"
        if torque.of_mean
        else f"{torque.torque:g} N m"
    )
