"""Events of an event-driven motion that follow each other without end."""

from torsion.errors import SolveError


class Chatter(SolveError):
    """An element switches without end."""

    def __init__(self, time: float, element: int) -> None:
        super().__init__(f"from {time:.6g} s on, a coupling changes between its regimes without end")
        self.time, self.element = time, element


class TooManyEvents(SolveError):
    """More events than are kept."""

    def __init__(self, time: float, number: int) -> None:
        super().__init__(f"the motion has its {number} events at {time:.6g} s, and no more are followed")
        self.time = time
