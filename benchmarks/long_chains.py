"""Lowest 20 modes of chains of 1e5 to 1e6 stations next to `eigsh`: `python -m benchmarks.long_chains [--quick]`.

Every run is a fresh process, so that its peak of memory is its own; the programs take turns. Writes
reports/long_chains.md; `--quick` takes two minutes, smaller chains, and prints without writing.
"""

import json
import resource
import statistics
import subprocess
import sys
from collections.abc import Callable
from time import perf_counter, process_time
from typing import Any

import numpy as np

from benchmarks.page_file import Report, verdict
from benchmarks.papers.writing import table

MODES = 20
CASES = (
    "free",
    "fixed at one end",
    "fixed at both ends",
    "stiff",
    "stiff, fixed at both ends",
    "stiff, rigid, massless",
)
SHIFTS = {
    "-first": -1.0,
    "0.9 first": 0.9,
    "between 10 and 11": 0.0,
}  # of eigsh, given the frequencies beforehand
HEAD = (
    "stations",
    "chain",
    "torsion s",
    "error",
    "width of enclosures",
    "enclosed",
    "memory GB",
    "eigsh s",
    "its shift",
    "its error",
    "its memory GB",
    "torsion / eigsh",
)
PATIENCE = 600  # s a run
TARGETS = {"error": 1e-12, "seconds": 0.5, "processor": 0.5, "memory": 1.5}

HOW = """\
`torsion` is `tree_modes(tree, 20)`: frequencies, enclosures, angles and torques. `eigsh` is
`scipy.sparse.linalg.eigsh(K, M=J, sigma=shift)`: frequencies and angles, with the fastest of three shifts that need the
answer beforehand: minus the square of the first frequency, 0.9 of it, and half-way between the squares of the 10th and
the 11th. Imports, the tree of the one and the matrices of the other are made outside the time. Both use one thread.
Uniform chains: J = 1 kg m2, k = 1 N m/rad, the reference is 2 sin in closed form. Stiff: J 1e-6 to 1e4, k 1 to 1e12,
even in the logarithm, seed 1; the reference is the middle of torsion's own enclosure (marked *), which is proven. The
last case has 5 % rigid spans and 5 % stations without inertia; shift-invert does not take these. Time: wall, and in
brackets processor, each the median of the runs, in which the programs take turns. Memory: peak resident set of the
whole process, interpreter, libraries and the chain itself included."""


def main() -> None:
    """Runs all cases and writes the page, or runs one and prints it as JSON."""
    if sys.argv[1:2] == ["--one"]:
        program, case, size, reference = sys.argv[2:]
        print(json.dumps(_one(program, case, int(size), json.loads(reference))))
        return
    report = Report(__doc__, "long_chains", "1e4 and 1e5 stations, one run each", runs=3)
    sizes, runs = (
        ((10_000, 100_000), 1)
        if report.chosen.quick
        else ((100_000, 1_000_000), report.chosen.runs)
    )
    rows = [_case(case, size, runs) for size in sizes for case in CASES]
    lines = (f"- Runs of each program in a case: {runs}", table(HEAD, [_row(row) for row in rows]))
    report.publish("Long chains: the lowest 20 modes", [HOW, *lines, "\n".join(_verdicts(rows))])


def _case(case: str, size: int, runs: int) -> dict[str, Any]:
    """What all programs answered, the programs taking turns."""
    first = _fresh("torsion", case, size, [])
    answers: dict[str, list[dict[str, Any]]] = {"torsion": [first]}
    reference = first.get("reference", [])
    peers = [] if "massless" in case or not reference else list(SHIFTS)
    for turn in range(runs):
        for shift in peers:
            done = answers.setdefault(shift, [])
            if not (done and "fault" in done[-1]):
                done.append(_fresh(shift, case, size, reference))
        if turn > 0:
            answers["torsion"].append(_fresh("torsion", case, size, []))
    print(f"{size} {case}: {first.get('seconds', first.get('fault'))}", file=sys.stderr, flush=True)
    return {"case": case, "size": size, "answers": answers}


def _fresh(program: str, case: str, size: int, reference: list[float]) -> dict[str, Any]:
    """One run in its own process."""
    command = [
        sys.executable,
        "-m",
        "benchmarks.long_chains",
        "--one",
        program,
        case,
        str(size),
        json.dumps(reference),
    ]
    try:
        done = subprocess.run(
            command, capture_output=True, text=True, check=False, timeout=PATIENCE
        )
    except subprocess.TimeoutExpired:
        return {"fault": f"more than {PATIENCE} s"}
    if done.returncode != 0:
        return {
            "fault": (done.stderr.strip().splitlines() or [f"status {done.returncode}"])[-1][:100]
        }
    answer: dict[str, Any] = json.loads(done.stdout)
    return answer


def _one(program: str, case: str, size: int, reference: list[float]) -> dict[str, Any]:
    solve = (
        _torsion(case, size)
        if program == "torsion"
        else _eigsh(case, size, program, np.array(reference))
    )
    wall, processor = perf_counter(), process_time()
    answer = solve()
    times = {"seconds": perf_counter() - wall, "processor": process_time() - processor}
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
    return {**times, "memory": peak, **answer()}


def _data(case: str, size: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Inertia, flexibility (of the span before each station) and what is fixed; all (stations,)."""
    rng, fixed = np.random.default_rng(1), np.zeros(size, dtype=bool)
    inertia, flexibility = np.ones(size), np.ones(size)
    if case.startswith("stiff"):
        inertia, flexibility = 10 ** rng.uniform(-6, 4, size), 10 ** -rng.uniform(0, 12, size)
    if "massless" in case:
        inertia[rng.random(size) < 0.05] = 0.0
        flexibility[rng.random(size) < 0.05] = 0.0
    fixed[-1] = "fixed" in case
    fixed[0] = "both" in case
    return inertia, flexibility, fixed


def _closed_form(case: str, size: int) -> np.ndarray | None:
    j = np.arange(1, MODES + 1)
    phase = {
        "free": j / (2 * size),
        "fixed at one end": (2 * j - 1) / (4 * size - 2),
        "fixed at both ends": j / (2 * (size - 1)),
    }
    return 2.0 * np.sin(np.pi * phase[case]) if case in phase else None


def _torsion(case: str, size: int) -> Callable[[], Callable[[], dict[str, Any]]]:
    from torsion.kernels.long_chain.lowest_modes import are_available
    from torsion.kernels.natural_modes import tree_modes
    from torsion.kernels.tree import Tree

    inertia, flexibility, fixed = _data(case, size)
    are_available()  # imports scipy.linalg
    tree, reported = Tree(np.arange(size) - 1, flexibility, inertia, fixed), list[int]()

    def solve() -> Callable[[], dict[str, Any]]:
        modes = tree_modes(tree, MODES, progress=lambda done, _: reported.append(done))

        def answer() -> dict[str, Any]:
            exact = _closed_form(case, size)
            middle = 0.5 * (modes.lower + modes.upper)
            reference = middle if exact is None else exact
            slack = 4e-16 * reference  # of the closed form's own rounding
            return {
                "reference": reference.tolist(),
                "error": float(np.abs(modes.frequency / reference - 1.0).max()),
                "width": float((modes.upper / modes.lower - 1.0).max()),
                "enclosed": int(
                    np.sum((modes.lower <= reference + slack) & (reference - slack <= modes.upper))
                ),
                "certified": bool(modes.certified),
                "reported": reported == list(range(1, MODES + 1)),
            }

        return answer

    return solve


def _eigsh(
    case: str, size: int, shift: str, reference: np.ndarray
) -> Callable[[], Callable[[], dict[str, Any]]]:
    from scipy.sparse import diags_array
    from scipy.sparse.linalg import eigsh

    inertia, flexibility, fixed = _data(case, size)
    stiffness = 1.0 / flexibility[1:]
    diagonal = np.concatenate((stiffness, [0.0])) + np.concatenate(([0.0], stiffness))
    free = ~fixed
    matrix = diags_array([diagonal, -stiffness, -stiffness], offsets=[0, 1, -1], format="csc")[
        free
    ][:, free].tocsc()
    mass = diags_array(inertia[free], format="csc")
    rigid = 0 if fixed.any() else 1
    square = reference**2
    sigma = SHIFTS[shift] * square[0] if SHIFTS[shift] else 0.5 * (square[9] + square[10])

    def solve() -> Callable[[], dict[str, Any]]:
        values = eigsh(matrix, MODES + rigid, mass, sigma=float(sigma))[0]

        def answer() -> dict[str, Any]:
            found = np.sqrt(np.abs(np.sort(values)[rigid:]))
            return {"error": float(np.abs(found / reference - 1.0).max())}

        return answer

    return solve


def _row(row: dict[str, Any]) -> list[str]:
    own, peer = _summary(row["answers"]["torsion"]), _best_peer(row)
    cells = [str(row["size"]), row["case"]]
    if "fault" in own:
        return [*cells, own["fault"], *[""] * 9]
    mark = "*" if row["case"].startswith("stiff") else ""
    cells += [
        _clocks(own),
        f"{own['error']:.0e}{mark}",
        f"{own['width']:.0e}",
        f"{own['enclosed']} of {MODES}",
    ]
    cells.append(f"{own['memory']:.2f}")
    if peer is None:
        faults = {
            answer[-1]["fault"] for name, answer in row["answers"].items() if name != "torsion"
        }
        return [*cells, "; ".join(sorted(faults)) or "not possible", *[""] * 4]
    name, its = peer
    ratio = {clock: own[clock] / its[clock] for clock in ("seconds", "processor")}
    return [
        *cells,
        _clocks(its),
        name,
        f"{its['error']:.0e}",
        f"{its['memory']:.2f}",
        _clocks(ratio),
    ]


def _clocks(values: dict[str, Any]) -> str:
    return f"{values['seconds']:.2f} ({values['processor']:.2f})"


def _summary(answers: list[dict[str, Any]]) -> dict[str, Any]:
    """The last answer with the medians of the times and the largest memory."""
    good = [answer for answer in answers if "fault" not in answer]
    if not good:
        return answers[-1]
    medians = {
        key: statistics.median(answer[key] for answer in good) for key in ("seconds", "processor")
    }
    return {**good[-1], **medians, "memory": max(answer["memory"] for answer in good)}


def _best_peer(row: dict[str, Any]) -> tuple[str, dict[str, Any]] | None:
    """The shift with the smallest time, and its summary."""
    found = {
        name: _summary(answers) for name, answers in row["answers"].items() if name != "torsion"
    }
    good = {name: its for name, its in found.items() if "fault" not in its}
    return min(good.items(), key=lambda item: float(item[1]["seconds"])) if good else None


def _verdicts(rows: list[dict[str, Any]]) -> list[str]:
    """One sentence for each target, from the largest size alone."""
    largest = [row for row in rows if row["size"] == rows[-1]["size"]]
    own = [_summary(row["answers"]["torsion"]) for row in largest]
    peers = [_best_peer(row) for row in largest]
    if any("fault" in one for one in own):
        return ["MISSED: not every case was solved."]
    pairs = [(one, peer[1]) for one, peer in zip(own, peers, strict=True) if peer is not None]
    proven = all(one["certified"] and one["enclosed"] == MODES and one["reported"] for one in own)
    found = {name: max(one[name] for one in own) for name in ("error", "memory")}
    for clock in ("seconds", "processor"):
        found[clock] = max((one[clock] / peer[clock] for one, peer in pairs), default=float("nan"))
    said = {
        "error": "largest error",
        "memory": "largest memory, GB",
        "seconds": "largest share of eigsh's time, wall",
        "processor": "largest share of eigsh's time, processor",
    }
    lines = [
        f"- {said[name]}, at {largest[0]['size']} stations: {found[name]:.2g}, meant <= {target:g}: "
        f"{verdict(found[name] <= target)}"
        for name, target in TARGETS.items()
    ]
    return [
        *lines,
        f"- every mode enclosed, every step of the progress reported: {verdict(proven)}",
    ]


if __name__ == "__main__":
    main()
