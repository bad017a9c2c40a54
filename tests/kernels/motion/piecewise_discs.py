"""A reference for play and friction beside torques that follow the motion: plain angles, Runge-Kutta steps."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.integrate import solve_ivp

Law = Callable[
    [float, np.ndarray, np.ndarray], float
]  # torque on a disc by time, and all angles and speeds
STEP = 5e-4  # s at most: what is read between steps is of lower order


@dataclass
class Discs:
    """Free discs on springs, with play or friction between, in plain angles: Runge-Kutta steps from event to event."""

    inertia: Sequence[float]
    springs: Sequence[tuple[int, int, float, float]]  # ends, N m/rad, N m s/rad
    elements: Sequence[
        tuple
    ]  # ("play", a, b, k, half, c) or ("friction", a, b, k, capacity over time, its rate)
    acting: Sequence[tuple[int, Law]]
    kinks: Sequence[float] = ()  # s, of the capacities
    state: list[int] = field(default_factory=list)

    def twist(self, x: np.ndarray, number: int) -> tuple[float, float]:
        """Of an element and its rate."""
        size, (_, a, b, *_) = len(self.inertia), self.elements[number]
        return x[a] - x[b], x[size + a] - x[size + b]

    def torque(self, t: float, x: np.ndarray, number: int) -> float:
        """Of an element in its state; friction counts from its slider, behind the speeds."""
        kind, _, _, k, level, *viscous = self.elements[number]
        twist, rate = self.twist(x, number)
        own = self.state[number]
        if kind == "play":
            return (
                k * (twist - own * level) + (viscous[0] if viscous else 0.0) * rate
                if abs(own) == 1
                else 0.0
            )
        return own * level(t) if own else k * (twist - x[2 * len(self.inertia) + number])

    def rates(self, t: float, x: np.ndarray) -> np.ndarray:
        size = len(self.inertia)
        angle, speed, found = x[:size], x[size : 2 * size], np.zeros_like(x)
        found[:size] = speed
        for a, b, k, c in self.springs:
            torque = k * (angle[a] - angle[b]) + c * (speed[a] - speed[b])
            found[size + a] -= torque
            found[size + b] += torque
        for number, (kind, a, b, *_) in enumerate(self.elements):
            torque = self.torque(t, x, number)
            found[size + a] -= torque
            found[size + b] += torque
            if kind == "friction" and self.state[number]:
                found[2 * size + number] = speed[a] - speed[b]
        for disc, law in self.acting:
            found[size + disc] += law(t, angle, speed)
        found[size : 2 * size] /= self.inertia
        return found

    def switches(self) -> list[tuple[int, int, Callable[[float, np.ndarray], float]]]:
        """Element, next state, and a function that falls through zero there."""
        found = []
        for number, ((kind, _, _, k, level, *viscous), own) in enumerate(
            zip(self.elements, self.state, strict=True)
        ):

            def over(x: np.ndarray, side: int, number: int = number, level: float = level) -> float:
                return level - side * self.twist(x, number)[0]

            if kind == "play" and own == 0:
                found += [
                    (number, side, lambda t, x, s=side, over=over: over(x, s)) for side in (1, -1)
                ]
            elif kind == "play" and abs(own) == 1:
                then = 2 * own if viscous else 0
                found.append((number, then, lambda t, x, n=number, s=own: s * self.torque(t, x, n)))
            elif kind == "play":
                found.append((number, 0, lambda t, x, s=own // 2, over=over: -over(x, s)))
            elif own:  # the slider: what a changing capacity takes up in the spring is no slipping
                loose = lambda t, x, n=number, s=own, k=k, rate=viscous[0]: (  # noqa: E731
                    s * self.twist(x, n)[1] - rate(t) / k
                )
                found.append((number, 0, loose))
            else:
                for side in (1, -1):
                    full = lambda t, x, n=number, s=side, level=level: (  # noqa: E731
                        level(t) - s * self.torque(t, x, n)
                    )
                    found.append((number, side, full))
        return found

    def run(
        self, x: np.ndarray, times: np.ndarray, state: Sequence[int] = ()
    ) -> tuple[np.ndarray, list[float]]:
        """Torques of springs and elements (both, times), and the times of all events."""
        t, events, found = (
            0.0,
            list[float](),
            np.empty((len(self.springs) + len(self.elements), len(times))),
        )
        x, self.state = (
            np.concatenate([x, np.zeros(len(self.elements))]),
            list(state or [0] * len(self.elements)),
        )
        while t < times[-1]:
            every, end = (
                self.switches(),
                min([kink for kink in self.kinks if kink > t], default=times[-1]),
            )
            watched = [one for _, _, one in every]
            for one in watched:
                one.terminal, one.direction = True, -1.0
            own = solve_ivp(
                self.rates,
                (t, end),
                x,
                "DOP853",
                rtol=2.3e-14,
                atol=1e-14,
                events=watched,
                dense_output=True,
                max_step=STEP,
            )
            within = np.flatnonzero((times >= t) & (times <= own.t[-1]))
            if within.size:
                states = own.sol(times[within])
                for column, at in enumerate(within):
                    found[:, at] = self.torques(times[at], states[:, column])
            t, x = own.t[-1], own.y[:, -1].copy()
            if own.status == 1:
                which = next(number for number, one in enumerate(own.t_events) if one.size)
                x = self.enter(t, x, *every[which][:2])
                events.append(t)
        return found, events

    def torques(self, t: float, x: np.ndarray) -> list[float]:
        """Of springs and elements, N m."""
        size, bent = len(self.inertia), []
        for a, b, k, c in self.springs:
            bent.append(k * (x[a] - x[b]) + c * (x[size + a] - x[size + b]))
        return [*bent, *(self.torque(t, x, number) for number in range(len(self.elements)))]

    def enter(self, t: float, x: np.ndarray, number: int, then: int) -> np.ndarray:
        """An element in another state; a spring begins with the torque of slipping."""
        kind, _, _, k, level, *_ = self.elements[number]
        if kind == "friction" and then == 0:
            x[2 * len(self.inertia) + number] = (
                self.twist(x, number)[0] - self.state[number] * level(t) / k
            )
        self.state[number] = then
        return x
