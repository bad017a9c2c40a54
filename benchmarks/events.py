"""A train with a clearance and friction from event to event, next to integrators: `python -m benchmarks.events`.

It writes reports/events.md in three minutes. The reference is a Taylor series of extended precision in the angles of
the stations, with a march of its own from event to event.
"""

import math
import statistics
from collections.abc import Callable, Iterator
from time import process_time

import numpy as np
from scipy.integrate import solve_ivp
from tests.kernels.motion.extended_precision import ten_stations

from benchmarks.page_file import Report, verdict
from torsion.arrays import FloatArray
from torsion.kernels.motion.event_driven_motion import energy_balance
from torsion.kernels.motion.loaded_modes import LoadedModes
from torsion.kernels.motion.march import March

DURATION, SAMPLES = 2.0, 200
WITHIN = (0.25, 0.5, 1.0, 2.0)  # s
TIMES = np.arange(1, SAMPLES + 1) * (DURATION / SAMPLES)
MORE_ACCURATE, FASTER = 1e6, 20.0  # than Newmark at the same time, than DOP853 at USEFUL
USEFUL = 1e-4  # tolerance, or error
WHAT = """\
Ten stations, a clearance of 0.01 rad (1e5 N m/rad, 20 N m s/rad) in the middle, friction of 5 N m (5e4 N m/rad) next to
a span, a torque that oscillates and decays against a steady load of 30 N m, from rest. Error: of the torques of both
at 200 times, of their peak, up to 0.25, 0.5, 1 and 2 s. Time: processor time, median of runs of all methods in turn.
Newmark: average acceleration with Newton on both torques, in modal coordinates; DOP853: the same coordinates, its own
steps, without events."""
TRAINS = {  # damping ratio, N m, 1/s
    "60 N m at 17 Hz, damping ratio 2 %": (0.02, 60.0, complex(-0.5, 34.0 * math.pi)),
    "120 N m at 4.8 Hz, damping of 10 us times the stiffness": (0.0, 120.0, complex(-0.05, 30.0)),
}
OWN, HALVED, CLASSICAL = (
    "from event to event",
    "from event to event, steps halved",
    "Newmark, h = 0.001 s",
)
Solved = tuple[FloatArray, float, str]  # torques (2, times), s, what more there is to say


def main() -> None:
    """Measures, prints the page and writes it."""
    report = Report(__doc__, "events", calls=5)
    parts = [WHAT]
    for name, chosen in TRAINS.items():
        parts += [f"## {name}", *measured(*chosen, report.chosen.calls)]
    report.publish("Backlash and friction from event to event", parts)


def measured(ratio: float, load: float, rate: complex, calls: int) -> tuple[str, str]:
    """The table of a train, and what it was to show."""
    reference, train = ten_stations(ratio, load, rate)
    known = reference.torques(TIMES)
    methods: dict[str, Callable[[], Solved]] = {
        OWN: lambda: exact(train, 1.0),
        HALVED: lambda: exact(train, 0.5),
        **{f"Newmark, h = {h:g} s": lambda h=h: newmark(train, h) for h in (1e-3, 1e-4)},
        **{
            f"DOP853, {tol:g}": lambda tol=tol: dop853(train, tol)
            for tol in (1e-4, 1e-6, 1e-7, 1e-8)
        },
    }
    tries: dict[str, list[Solved]] = {name: [] for name in methods}
    for _ in range(calls):
        for name, run in methods.items():
            tries[name].append(run())
    errors, seconds = dict[str, list[float]](), dict[str, float]()
    rows = [
        "| method | " + " | ".join(f"error to {t:g} s" for t in WITHIN) + " | time, s | |",
        "|---" * 7 + "|",
    ]
    for name, runs in tries.items():
        torque, _, words = runs[0]
        seconds[name] = statistics.median(one[1] for one in runs)
        errors[name] = [
            float(np.abs((torque - known)[:, t >= TIMES]).max() / np.abs(known).max())
            for t in WITHIN
        ]
        cells = " | ".join(f"{error:.1e}" for error in errors[name])
        rows.append(f"| {name} | {cells} | {seconds[name]:.3f} | {words} |")
    return "\n".join(rows), "\n".join(
        _verdicts({name: errors[name][-1] for name in errors}, seconds)
    )


def _verdicts(error: dict[str, float], seconds: dict[str, float]) -> Iterator[str]:
    own = seconds[OWN]
    accurate, longer = error[CLASSICAL] / error[OWN], seconds[CLASSICAL] / own
    met = verdict(accurate >= MORE_ACCURATE and longer >= 1.0)
    yield (
        f"- more accurate than Newmark with h = 1 ms, which takes {longer:.1f} times as long: {accurate:.1e}, "
        f"meant >= {MORE_ACCURATE:g}: {met}"
    )
    loose = f"DOP853, {USEFUL:g}"
    useful = min(
        (name for name in error if name.startswith("DOP853") and error[name] <= USEFUL),
        key=seconds.__getitem__,
    )
    for name, words in (
        (loose, f"at the tolerance {USEFUL:g}, where it errs by {error[loose]:.1g}"),
        (useful, f"at an error of at most {USEFUL:g} ({useful.split()[1]})"),
    ):
        faster = seconds[name] / own
        yield f"- faster than DOP853 {words}: {faster:.0f} times, meant >= {FASTER:g}: {verdict(faster >= FASTER)}"


def exact(train: LoadedModes, fineness: float) -> Solved:
    """Ours, with the balance of energy outside of the time."""
    none = np.zeros(len(train.elements)), np.zeros(train.motions), np.zeros(train.motions)
    start = process_time()
    (motion,) = March(train, DURATION, *none, (0, 0), fineness).until([DURATION])
    found = motion.at(TIMES).torque
    seconds = process_time() - start
    changes = len(motion.steps) - 1
    return (
        found,
        seconds,
        f"{changes} changes of a regime, energy to {energy_balance(motion).residual:.0e}",
    )


def _load(train: LoadedModes, time: float) -> FloatArray:
    """(modes,) of the oscillating and the steady torque."""
    rate = train.loads[0][0].rate
    return np.asarray((train.force @ np.array([np.exp(rate * time), 1.0])).real)


def _laws(
    train: LoadedModes, twist: FloatArray, speed: FloatArray, slip: float
) -> tuple[FloatArray, FloatArray]:
    """Torques of both elements, and their derivatives by twist and speed (2, 2)."""
    play, dry = train.elements
    beyond, slope = abs(twist[0]) - play.half, np.zeros((2, 2))
    torque = np.zeros(2)
    if beyond > 0.0:
        side = math.copysign(1.0, twist[0])
        push = play.stiffness * side * beyond + play.viscous * speed[0]
        if push * side > 0.0:
            torque[0], slope[0] = push, (play.stiffness, play.viscous)
    pull = dry.stiffness * (twist[1] - slip)
    torque[1] = min(max(pull, -dry.capacity), dry.capacity)
    slope[1, 0] = dry.stiffness if abs(pull) < dry.capacity else 0.0
    return torque, slope


def newmark(train: LoadedModes, h: float) -> Solved:
    """Average acceleration; Newton on the torques of both elements."""
    start = process_time()
    play, dry = train.elements
    ends, size = np.stack([play.ends, dry.ends]), len(train.modes.damping)
    rigid = train.modes.rigid
    w = np.concatenate([np.zeros(rigid), train.modes.w])
    left = np.linalg.inv(np.eye(size) + h / 2.0 * train.modes.damping + h * h / 4.0 * np.diag(w**2))
    yielding = ends @ left @ ends.T
    q, v, a, slip, torque = np.zeros(size), np.zeros(size), _load(train, 0.0), 0.0, np.zeros(2)
    every, found = round(TIMES[0] / h), np.empty((2, SAMPLES))
    for step in range(1, round(DURATION / h) + 1):
        place, fast = q + h * v + h * h / 4.0 * a, v + h / 2.0 * a
        free = left @ (_load(train, step * h) - train.modes.damping @ fast - w**2 * place)
        for _ in range(30):
            gained = free - left @ (ends.T @ torque)
            twist, speed = ends @ (place + h * h / 4.0 * gained), ends @ (fast + h / 2.0 * gained)
            given, slope = _laws(train, twist, speed, slip)
            lack = torque - given
            if np.abs(lack).max() < 1e-10:
                break
            rise = np.eye(2) + (slope[:, :1] * h * h / 4.0 + slope[:, 1:] * h / 2.0) * yielding
            torque = torque - np.linalg.solve(rise, lack)
        a = free - left @ (ends.T @ torque)
        q, v = place + h * h / 4.0 * a, fast + h / 2.0 * a
        slip = float(ends[1] @ q - torque[1] / dry.stiffness)
        if step % every == 0:
            found[:, step // every - 1] = torque
    return found, process_time() - start, ""


def dop853(train: LoadedModes, tolerance: float) -> Solved:
    """The library's integrator, which knows of no event."""
    start = process_time()
    play, dry = train.elements
    ends, size, rigid = np.stack([play.ends, dry.ends]), len(train.modes.damping), train.modes.rigid
    w2 = np.concatenate([np.zeros(rigid), train.modes.w]) ** 2

    def rate(time: float, state: FloatArray) -> FloatArray:
        q, v, slip = state[:size], state[size:-1], float(state[-1])
        speed = ends @ v
        torque, _ = _laws(train, ends @ q, speed, slip)
        slips = abs(torque[1]) >= dry.capacity and speed[1] * torque[1] > 0.0
        gained = _load(train, time) - train.modes.damping @ v - w2 * q - ends.T @ torque
        return np.concatenate([v, gained, [speed[1] if slips else 0.0]])

    done = solve_ivp(
        rate,
        (0.0, DURATION),
        np.zeros(2 * size + 1),
        "DOP853",
        t_eval=TIMES,
        rtol=tolerance,
        atol=1e-5 * tolerance,
    )
    found = np.stack(
        [_laws(train, ends @ z[:size], ends @ z[size:-1], float(z[-1]))[0] for z in done.y.T],
        axis=1,
    )
    return found, process_time() - start, f"{done.nfev} calls"


if __name__ == "__main__":
    main()
