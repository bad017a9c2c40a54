"""Events and steps of a motion that follow each other without end."""

import math

import numpy as np

from torsion.errors import SolveError

GAIN = 1.2  # of the pace: such a motion may come to its end yet


class Chatter(SolveError):
    """An element switches without end."""

    def __init__(self, time: float, element: int) -> None:
        super().__init__(
            f"from {time:.6g} s on, a coupling changes between its regimes without end"
        )
        self.time, self.element = time, element


class TooManyEvents(SolveError):
    """More events than are kept."""

    def __init__(self, number: int, most: int, time: float, end: float) -> None:
        super().__init__(
            f"the motion has its {number} events at {time:.6g} s, and no more than {most} are followed"
        )
        self.time = end


def refuse_too_many(
    number: int, most: int, times: list[float], watched: int, duration: float
) -> None:
    """Raises TooManyEvents, as soon as their pace lets no end be reached.

    times: s, of the events twice and once as many as are watched before, and now.
    """
    time, end = times[-1], math.inf
    if number >= 2 * watched:
        pace = np.diff(times) / (watched, watched - 1)  # s an event
        if pace[1] <= GAIN * pace[0]:
            end = time + (most - number) * float(pace[1])
    if number > most or end < duration:
        raise TooManyEvents(min(number, most), most, time, time if number > most else end)


def refuse_too_many_steps(
    reached: list[float], number: int, most: int, watched: int, duration: float
) -> None:
    """Raises SolveError for steps that do not reach the end, as soon as that is seen.

    reached: s, after every so many steps as are watched, and now.
    """
    if number < most and (number % watched or number < 3 * watched):
        return
    time, pace = reached[-1], np.diff(reached[-4:])
    needed = number + watched * (duration - time) / float(pace[-1])
    if number < most and (needed <= most or pace[-1] > GAIN * pace[0]):
        return
    message = (
        f"{number} steps reach only {time:.4g} s of {duration:.4g} s; {most} steps (about ten minutes) are the "
        "limit. The torques that follow the motion, or modes that they excite, are too fast"
    )
    hint = (
        "shorten `duration`, leave torques out with `torques`, or damp fast modes (also fewer `segments` of shafts, "
        "`model: lumped`, fewer `modes`)"
    )
    raise SolveError(message, hint)
