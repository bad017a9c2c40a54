"""Integration over time compared, error against run time: `python -m benchmarks.integrators`.

Writes reports/integrators.md and its figures; it takes some minutes of one core. `--quick` takes fewer steps.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from time import perf_counter, process_time

import mpmath as mp
import numpy as np
from scipy.integrate import solve_ivp

from benchmarks.error_curves import SYMBOLS
from benchmarks.integrator_methods import METHODS, marching, quality, stable_to
from benchmarks.page_file import Report, verdict
from benchmarks.papers.writing import table
from torsion.analyses.modes.mode_nodes import rigid_shapes
from torsion.analyses.motion.events.events import ramps
from torsion.analyses.motion.events.transient_settings import TransientSettings
from torsion.analyses.motion.motion_from_events import transient
from torsion.analyses.undamped_modes import Modes, modes_as_discretised
from torsion.assembly import assemble
from torsion.assembly.matrices import matrices
from torsion.assembly.system import System
from torsion.kernels.motion.loaded_modes import LoadedModes, ModalTrain
from torsion.kernels.motion.march import March
from torsion.model.coupling import Coupling
from torsion.model.disc import Disc
from torsion.model.shafts.shaft import Shaft
from torsion.output.drawing.svg import svg
from torsion.output.figures.figure import Axis, Figure, Line, Panel
from torsion.study import Study
from torsion.train import train

DURATION, RATIO, DIGITS = 2.0, 0.01, 60
TABLES = (
    ((0.0, 0.0), (0.02, 100.0), (9.0, 100.0)),
    ((1.0, 0.0), (1.02, -100.0), (9.0, -100.0)),
)  # s, N m
STEPS, QUICK = (
    (1e-2, 2.5e-3, 1e-3, 2.5e-4, 1e-4, 2e-5),
    (1e-2, 1e-3),
)  # s; the kinks of the torques lie on them
TOLERANCES = (1e-4, 1e-7, 1e-10)
RATIOS = (0.05, 0.1, 0.2)
STIFF = 1e5  # rad/s: DOP853, whose steps follow the fastest mode, is left out beyond
EXACT = "modes, exact (torsion)"
GOAL = 100.0
HOW = f"""\
A train from rest for {DURATION:g} s: 100 N m on its first disc, rising in 20 ms, and -100 N m on its last from 1 s on,
likewise. Every mode has a damping ratio of {RATIO:g}. Error: the largest over the spans and 200 times, of the span's
own largest torque; the reference is the closed form of every mode in mpmath with {DIGITS} digits. Time, of one
processor: the matrices or modes, the march and the torques, once. The step-by-step methods march as one matrix of
numbers a step, which is the smallest that they can cost; their torques are stiffness times twist. DOP853 and Radau
(scipy) run on the certified modes, anew at every kink of the torques; DOP853, whose steps follow the fastest mode, not
beyond {STIFF:g} rad/s. *Modes, exact* is what `transient` does: its samples are no steps, and its torques are sums of
modal torques."""
WHAT = """\
Consistency: the order is the exponent with which the period elongation (or, of methods that keep the period, the decay)
falls with the step. Stability: the largest h/T at which no oscillation grows, and the spectral radius at h/T of 1000,
which says what becomes of modes that the step does not resolve: at 1 they ring on, at 0 they are gone at once. A method
that is consistent and stable converges (Lax); but at a tenth of the period Houbolt takes 29 % of the amplitude away in
every period, and Newmark is 3 % late. Closed forms: central differences, period x/(2 arcsin(x/2)) with x = wh; Newmark
x/(2 arctan(x/2))."""


@dataclass(frozen=True, eq=False)
class Case:
    """A train with its matrices, and the torques that are known of it."""

    name: str
    system: System
    M: np.ndarray
    K: np.ndarray
    rows: np.ndarray  # (spans, unknowns) torque = rows @ displacement
    spans: list[int]
    modes: int


@dataclass(frozen=True)
class Row:
    """One run."""

    method: str
    setting: str
    seconds: float
    error: float


def main() -> None:
    """Measures and prints; writes the page and its figures."""
    report = Report(__doc__, "integrators", quick="two steps of every method")
    steps = QUICK if report.chosen.quick else STEPS
    found = {case: rows(case, steps) for case in cases()}
    parts = [HOW, "## Consistency and stability", WHAT, properties()]
    for case, measured in found.items():
        w = 2.0 * math.pi * _modes(case).frequency
        about = f"{len(case.M)} unknowns, elastic modes from {w[0]:.3g} to {w[-1]:.3g} rad/s."
        cells = [
            (row.method, row.setting, f"{row.seconds:.3g}", shown_error(row.error))
            for row in measured
        ]
        head = ("method", "step or tolerance", "time, s", "error")
        parts += [f"## {case.name}", about, f"![{case.name}]({_file(case)})", table(head, cells)]
    parts += ["## Size", _sizes(), "## Targets", _verdicts(found)]
    figures = {_file(case): _drawn(case.name, measured) for case, measured in found.items()}
    report.publish("Integration over time: error against run time", parts, figures)


def cases() -> list[Case]:
    """A benign and a stiff chain of ten discs, and a train of finite elements."""
    benign, stiff = np.random.default_rng(7), np.random.default_rng(7)
    chains = (
        ("Benign chain of ten", benign.uniform(0.5, 2.0, 10), benign.uniform(0.5e5, 2e5, 9)),
        ("Stiff chain of ten", 10.0 ** stiff.uniform(-6, 4, 10), 10.0 ** stiff.uniform(0, 12, 9)),
    )
    made = [_case(name, _chain(J, k), "lumped", list(range(9))) for name, J, k in chains]
    parts: list = [
        Disc(name="a", inertia=2.0),
        Coupling(name="s1", stiffness=4e4),
        Disc(inertia=0.5),
    ]
    parts += [
        Shaft(length="2 m", diameter="60 mm"),
        Disc(inertia=0.3),
        Shaft(length="1 m", diameter="50 mm"),
    ]
    parts += [Disc(inertia=0.4), Coupling(name="s2", stiffness=2e4), Disc(inertia=3.0)]
    return [*made, _case("Shafts of finite elements", parts, "fem", [])]


def _chain(inertia: np.ndarray, stiffness: np.ndarray) -> list:
    parts: list = []
    for J, k in zip(inertia, [*stiffness, 0.0], strict=True):
        parts += [
            Disc(inertia=float(J), unusual=True),
            *([Coupling(stiffness=float(k), unusual=True)] if k else []),
        ]
    return parts


def _case(name: str, parts: list, model: str, spans: list[int]) -> Case:
    system = assemble(train(parts), model=model)
    view = matrices(system)
    if not spans:
        spans = [k for k, span in enumerate(system.spans) if span.name in ("s1", "s2")]
    ends = view.basis[system.driving[spans]] - view.basis[system.driven[spans]]
    rows = np.zeros((len(spans), len(view.inertia)))
    rows[:, : ends.shape[1]] = ends / system.flexibility[spans, None]
    return Case(name, system, view.inertia, view.stiffness, rows, spans, len(view.inertia) - 1)


def _modes(case: Case) -> Modes:
    return modes_as_discretised(case.system, None if case.system.bars is None else case.modes)


def rows(case: Case, steps: Sequence[float]) -> list[Row]:
    """Every method at every step or tolerance."""
    times = np.linspace(0.0, DURATION, 201)[1:]
    known = reference(case, times)
    found = [
        _timed(EXACT, f"{h:g} s", lambda h=h: propagated(case, h, times), known) for h in steps
    ]
    for name in METHODS:
        found += [
            _timed(name, f"{h:g} s", lambda name=name, h=h: marched(case, name, h, times), known)
            for h in steps
        ]
    fast = 2.0 * math.pi * float(_modes(case).frequency[-1]) > STIFF
    for name in ("Radau",) if fast else ("DOP853", "Radau"):
        for tolerance in TOLERANCES[: len(steps)]:
            run = _timed(
                name,
                f"{tolerance:g}",
                lambda n=name, t=tolerance: _solved(case, n, t, times),
                known,
            )
            found.append(run)
    return found


def _timed(method: str, setting: str, run: Callable[[], np.ndarray], known: np.ndarray) -> Row:
    start = process_time()
    with np.errstate(all="ignore"):
        torque = run()
        seconds = process_time() - start
        error = np.abs(torque - known).max(axis=1) / np.abs(known).max(axis=1)
    return Row(
        method, setting, seconds, float(error.max()) if np.isfinite(error).all() else math.inf
    )


@mp.workdps(DIGITS)
def reference(case: Case, times: np.ndarray) -> np.ndarray:
    """(spans, times) torques to DIGITS digits, from the matrices: eigenvectors, and ramps in closed form."""
    n = len(case.M)
    lower = mp.cholesky(mp.matrix(case.M.tolist()))
    inverse = lower**-1
    values, vectors = mp.eigsy(inverse * mp.matrix(_symmetric(case)) * inverse.T)
    shapes = inverse.T * vectors
    last, torque = _last(case), mp.matrix(case.rows.tolist())
    found = np.zeros((len(case.rows), len(times)))
    for mode in sorted(range(n), key=lambda k: values[k])[1:]:
        w, carried = mp.sqrt(values[mode]), torque * shapes[:, mode]
        pushes = [(shapes[0, mode], 0.0), (-shapes[last, mode], 1.0)]
        for place, time in enumerate(times.tolist()):
            q = mp.fsum(
                push
                * 100
                / mp.mpf("0.02")
                * (_ramp(w, time - at) - _ramp(w, mp.mpf(time) - at - mp.mpf("0.02")))
                for push, at in pushes
            )
            found[:, place] += [float(one * q) for one in carried]
    return found


def _symmetric(case: Case) -> list[list[mp.mpf]]:
    """The stiffness with nothing lost: of a chain from its springs, else that of the elements."""
    if case.system.bars is not None:
        return case.K.tolist()
    n, sums = len(case.K), [[mp.mpf(0)] * len(case.K) for _ in case.K]
    for k in range(n - 1):
        spring = 1 / mp.mpf(float(case.system.flexibility[k]))
        for a, b, sign in ((k, k, 1), (k + 1, k + 1, 1), (k, k + 1, -1), (k + 1, k, -1)):
            sums[a][b] += sign * spring
    return sums


def _last(case: Case) -> int:
    """The unknown of the last disc."""
    return int(np.flatnonzero(matrices(case.system).basis[len(case.system.train.stations) - 1])[0])


def _ramp(w: mp.mpf, t: mp.mpf) -> mp.mpf:
    """A mode under a torque that grows by 1 in a second from t = 0."""
    if t <= 0:
        return mp.mpf(0)
    zeta, t = mp.mpf(RATIO), mp.mpf(t)
    own = w * mp.sqrt(1 - zeta**2)
    swing = 2 * zeta / w * mp.cos(own * t) + (2 * zeta**2 - 1) / own * mp.sin(own * t)
    return (t - 2 * zeta / w + mp.e ** (-zeta * w * t) * swing) / w**2


def _modal(case: Case) -> tuple[Modes, np.ndarray, np.ndarray]:
    """Modes, circular frequencies, and (rigid motion + modes, 2) forces of the two torques."""
    found = _modes(case)
    shape = np.concatenate([rigid_shapes(case.system), found.shape], axis=1)
    stations = [0, len(case.system.train.stations) - 1]
    return found, 2.0 * math.pi * found.frequency, shape[stations].T


def propagated(case: Case, h: float, times: np.ndarray) -> np.ndarray:
    """Sampled at every h, as the others are; read at the times."""
    found, w, force = _modal(case)
    size = len(w) + 1
    modal = ModalTrain(w, np.full(len(w), RATIO), np.zeros((size, size)))
    loads = [tuple(ramps(rows)) for rows in TABLES]
    train = LoadedModes(modal, loads, force, np.zeros((0, size)))
    march = March(train, DURATION, np.empty(0), np.zeros(size), np.zeros(size))
    (moved,) = march.until([DURATION])
    samples = np.arange(1, round(DURATION / h) + 1) * h
    kept = found.torque[case.spans] @ moved.at(samples).position[1:]
    every = np.searchsorted(samples, times - 1e-9)
    at = (
        found.torque[case.spans] @ moved.at(times).position[1:]
        if (len(samples) % len(times))
        else kept[:, every]
    )
    return np.asarray(at)


def marched(case: Case, name: str, h: float, times: np.ndarray) -> np.ndarray:
    """By a step-by-step method, on the assembled matrices; between its steps on a line."""
    found = _modes(case)
    shape = _shapes_of_unknowns(case)
    w = 2.0 * math.pi * found.frequency
    damping = (case.M @ shape * (2.0 * RATIO * w)) @ (shape.T @ case.M)
    grid = np.arange(round(DURATION / h) + 1) * h
    torques = np.zeros((len(grid), len(case.M)))
    torques[:, 0], torques[:, _last(case)] = (
        np.interp(grid, *np.array(rows).T, left=0.0) for rows in TABLES
    )
    march = marching(METHODS[name], case.M, damping, case.K, h)
    moved = march.histories(torques[:-1], torques[1:])[:, : len(case.M)]
    return np.array([np.interp(times, grid, one) for one in (case.rows @ moved.T)])


def _shapes_of_unknowns(case: Case) -> np.ndarray:
    """(unknowns, elastic modes) of generalised inertia 1."""
    from scipy.linalg import eigh

    if case.system.bars is None:
        return np.asarray(_modes(case).shape)
    return np.asarray(eigh(case.K, case.M)[1][:, 1:])


def _solved(case: Case, method: str, tolerance: float, times: np.ndarray) -> np.ndarray:
    """By scipy on the modes, between the kinks of the torques."""
    found, w, force = _modal(case)
    n = len(w)
    A = np.block([[np.zeros((n, n)), np.eye(n)], [-np.diag(w**2), -np.diag(2.0 * RATIO * w)]])
    push = np.concatenate([np.zeros((n, 2)), force[1:]])

    def rate(t: float, x: np.ndarray) -> np.ndarray:
        return A @ x + push @ [np.interp(t, *np.array(rows).T, left=0.0) for rows in TABLES]

    more = {"jac": A} if method == "Radau" else {}
    state, kept = np.zeros(2 * n), np.zeros((n, len(times)))
    scale = np.abs(push[n:]).max(axis=1) * 100.0
    floor = tolerance * np.concatenate([scale / w**2, scale / w])
    for begin, end in ((0.0, 0.02), (0.02, 1.0), (1.0, 1.02), (1.02, DURATION)):
        here = (times > begin) & (times <= end)
        at = np.unique([*times[here], end])
        run = solve_ivp(
            rate, (begin, end), state, method=method, t_eval=at, rtol=tolerance, atol=floor, **more
        )
        if not run.success:
            return np.full((len(case.spans), len(times)), np.nan)
        kept[:, here] = run.y[:n, : int(here.sum())]
        state = run.y[:, -1]
    return np.asarray(found.torque[case.spans] @ kept)


def properties() -> str:
    head = (
        "method",
        *(f"h/T {ratio:g}: longer, lost in a period, %" for ratio in RATIOS),
        "order",
        "stable to h/T",
        "radius",
    )
    lines = []
    for name, method in METHODS.items():
        cells = [
            f"{100 * round(q.elongation, 9):.3g} / {abs(100 * round(q.decay, 9)):.3g}"
            for q in (quality(method, ratio) for ratio in RATIOS)
        ]
        errors = [
            abs(quality(method, ratio).elongation) + abs(quality(method, ratio).decay)
            for ratio in (0.005, 0.0025)
        ]
        order = "exact" if errors[0] < 1e-11 else f"{math.log2(errors[0] / errors[1]):.2f}"
        limit, radius = stable_to(method), quality(method, 1e3).radius
        last = (
            "any" if math.isinf(limit) else f"{limit:.4f}",
            f"{radius:.3f}" if radius < 1.01 else "grows",
        )
        lines.append((name, *cells, order, *last))
    return table(head, lines)


def _sizes() -> str:
    """Time of `transient` for long and for finely sampled trains."""
    lines = []
    for stations, samples, goal in ((1000, 10_000, 8.0), (10, 1_000_000, 5.0)):
        rng = np.random.default_rng(stations)
        parts = _chain(rng.uniform(0.5, 2.0, stations), rng.uniform(0.5e5, 2e5, stations - 1))
        parts[0] = Disc(name="first", inertia=1.0)
        study = Study("size", train(parts))
        event = {"at": "first", "table": {"rows": [["0 s", 0.0], ["0.02 s", 100.0], ["1 s", 50.0]]}}
        body = {"duration": 2.0, "initial": "rest", "samples": samples, "events": [event]}
        system, settings = assemble(study.train), TransientSettings.model_validate(body)
        start, clock = process_time(), perf_counter()
        found = transient(study, system, settings)
        seconds, clock = process_time() - start, perf_counter() - clock
        lines.append(
            f"- {stations} stations, all {found.modes} modes, {samples} samples of all spans with peaks between them: "
            f"{seconds:.2f} s of one processor ({clock:.2f} s by the clock), meant <= {goal:g} s: "
            f"{verdict(seconds <= goal)}; energy residual {found.residual:.1e}"
        )
    return "\n".join(lines)


def _verdicts(found: dict) -> str:
    """How much more accurate than any compared method the exact motion is at the same time."""
    lines = []
    for case, measured in found.items():
        own = [row for row in measured if row.method == EXACT]
        longest = max(one.seconds for one in own)
        best = min(own, key=lambda row: row.seconds)
        rivals = [row for row in measured if row.method != EXACT and math.isfinite(row.error)]
        within = [row for row in rivals if row.seconds <= longest] or rivals
        rival = min(within, key=lambda row: row.error)
        gain = rival.error / max(best.error, 2.0**-53)
        lines.append(
            f"- {case.name}: exact {shown_error(best.error)} in {best.seconds:.3g} s; the best of the others in at "
            f"most {longest:.3g} s: {rival.method} {rival.setting}, {shown_error(rival.error)}; "
            f"{gain:.1e} times, meant >= {GOAL:g} on the stiff train: {verdict(gain >= GOAL)}"
        )
    return "\n".join(lines)


def shown_error(error: float) -> str:
    return "no answer" if not error < 1e6 else f"{error:.1e}"


def _file(case: Case) -> str:
    return f"integrators_{case.name.lower().replace(' ', '_')}.svg"


def _drawn(name: str, measured: Sequence[Row]) -> str:
    """SVG: error over run time, one curve a method."""
    lines = []
    for pen, method in enumerate(dict.fromkeys(row.method for row in measured)):
        own = [row for row in measured if row.method == method and row.error < 10.0]
        time, error = (
            np.array([(row.seconds, max(row.error, 1e-16)) for row in own]).reshape(-1, 2).T
        )
        lines.append(Line(method, time, error, pen, symbol=SYMBOLS[pen % len(SYMBOLS)]))
    x = Axis("run time", "s of one processor", is_log=True)
    y = Axis("largest error of a torque, of its peak", "", 1e-16, 10.0, is_log=True, is_error=True)
    return svg(Figure(name, name, (Panel(x, y, tuple(lines), height=340.0),)))


if __name__ == "__main__":
    main()
