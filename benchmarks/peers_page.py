"""The page of the peer benchmark: tables in Markdown, every ratio beside what it was meant to be."""

import math
from collections.abc import Sequence

from benchmarks import references
from benchmarks.comparison import Error, Row
from benchmarks.frequency_rows import (
    ASSEMBLY,
    CHAIN,
    DAMPED,
    KERNEL,
    LOWEST,
    MODAL,
    PLAIN,
    PUBLIC,
    PUBLIC_LOWEST,
    ROTOR,
    UNDAMPED,
)  # fmt: skip
from benchmarks.response_rows import ANGLE, RECEPTANCE, TORQUE, UNCHECKED
from benchmarks.response_rows import KERNEL as RESPONSE
from benchmarks.timing import Timing

# How many times as fast as the peer each is meant to be, by size.
CHAIN_TARGET = {10: 30, 100: 100, 1000: 1000}
TREE_TARGET = {10: 5, 100: 5, 1000: 50}
WHOLE_TARGET = {10: 1, 100: 5, 1000: 50}
RESPONSE_TARGET = {10: 80, 100: 150, 1000: 3000}
TREE_QUESTIONS = {"all, no certificate": PLAIN, "all, certified": KERNEL, "lowest 20, certified": LOWEST}
FREQUENCY_PEERS = ("undamped_modal_analysis", "Assembly + undamped_modal_analysis", "Assembly + modal_analysis")
RESPONSE_PEERS = ("vibratory_torque", "vibratory_torque + ss_response")

HOW = """\
The trains are random from a fixed seed and the same for all: free chains of discs and couplings, and free trees with
branches and gear pairs (2, 5 and 10 of them for 10, 100 and 1000 stations). Benign: inertias 0.5 to 2 kg m2,
stiffnesses 1e4 to 5e4 N m/rad. Stiff: inertias 1e-6 to 1e4, stiffnesses 1 to 1e12, even in the logarithm.
References: {arithmetic}, {digits} digits, each frequency proven to {proven} digits by counts; the column "modes" says
how many of a train's modes have a reference, "enclosed" how many of these lie inside torsion's own enclosure.

Times are of one process and one thread, the programs taken in turn (A B A B ...); the best call is given, and the
number of calls in brackets. A ratio is peer over torsion, of the best calls and, after the stroke, of the median calls.
A call that takes more than a fifth of the time allowed is made once. Nothing is left out because it was wrong.
"""
MODES_NOTE = """\
The frequencies of a program are sorted and compared by rank, a peer's lowest being taken for the rigid motion; where
some are missing, each reference is compared with the nearest that was found.
"""
RATIOS_NOTE = """\
Chain frequencies and trees with vectors: kernel, from the lists of inertias and stiffnesses, against
`undamped_modal_analysis` of matrices assembled beforehand; then with `Assembly`, which openTorsion needs to begin from
the same lists; then against `Assembly` and `modal_analysis`, the analysis that its manual begins with. Whole call:
`torsion.assemble` and `torsion.modes` with shapes and certificate, against the last two. The peers always find all
modes; where torsion finds the lowest 20 alone, the line says so. `plain_modes` is one decomposition without
certificate. A verdict that does not hold for all columns names those it holds for.
"""
RESPONSE_NOTE = """\
Errors: over the largest torque of the same frequency / each torque over its own. Times in ns per station and frequency.
The peers answer fewer frequencies than torsion; theirs is a loop over them. openTorsion's torque is that of the springs
alone, which shows where the dampers are in the spans; ROSS gives angles, from which the torque is taken here.
"""
ANSWERS_NOTE = """\
torsion gives angles, torques and a check of every line in one call; openTorsion gives torques by `vibratory_torque` and
angles by `ss_response`, which the former repeats. The peers check nothing; "no residual" is torsion without that check.
"""


def page(frequencies: Sequence[Row], responses: Sequence[Row], about: list[str], seconds: float, *, quick: bool) -> str:
    """The whole page."""
    command = "python -m benchmarks.peers" + (" --quick" if quick else "")
    parts = [
        "# torsion beside openTorsion and ROSS",
        f"Written by `{command}` in {seconds:.0f} s.",
        "\n".join(f"- {line}" for line in about),
        HOW.format(arithmetic=references.ARITHMETIC, digits=references.DIGITS, proven=references.PROVEN),
        *_frequency_parts(frequencies),
        *_response_parts(responses),
        "## Misses",
        _misses(frequencies, responses),
    ]
    return "\n\n".join(part.strip() for part in parts) + "\n"


def _frequency_parts(rows: Sequence[Row]) -> list[str]:
    own = (CHAIN, PLAIN, KERNEL, LOWEST, PUBLIC, PUBLIC_LOWEST)
    names = (*own, UNDAMPED, DAMPED, MODAL)
    timed = (*own, ASSEMBLY, UNDAMPED, DAMPED, ROTOR, MODAL)
    errors = [
        [row.case, str(row.size), str(row.referenced), str(row.enclosed)] + [_worst(row, name) for name in names]
        for row in rows
    ]
    times = [[row.case, str(row.size)] + [_time(row.times.get(name)) for name in timed] for row in rows]
    return [
        "## Natural frequencies: largest relative error",
        _table(["case", "n", "modes", "enclosed", *names], errors),
        MODES_NOTE,
        "## Natural frequencies: time",
        _table(["case", "n", *timed], times),
        "## Natural frequencies: times faster than openTorsion",
        _table(_ratio_head(FREQUENCY_PEERS), _frequency_ratios(rows)),
        RATIOS_NOTE,
    ]


def _response_parts(rows: Sequence[Row]) -> list[str]:
    names, timed = (RESPONSE, TORQUE, RECEPTANCE), (RESPONSE, UNCHECKED, TORQUE, ANGLE, RECEPTANCE)
    head = ["case", "n", "frequencies", "referenced", *names, *(f"{name}, ns" for name in timed)]
    table = []
    for row in rows:
        errors = [f"{_worst(row, name)} / {_each(row, name)}" if name in row.errors else "-" for name in names]
        times = [_figures(row.times[name].best * 1e9 / row.size) if name in row.times else "-" for name in timed]
        table.append([row.case, str(row.size), str(row.asked), str(row.referenced), *errors, *times])
    return [
        "## Steady response: span torques",
        _table(head, table),
        RESPONSE_NOTE,
        "## Steady response: times faster than openTorsion",
        _table(_ratio_head(RESPONSE_PEERS), _response_ratios(rows)),
        ANSWERS_NOTE,
    ]


def _ratio_head(peers: Sequence[str]) -> list[str]:
    return ["question", "case", "n", *(f"({place}) {name}" for place, name in enumerate(peers, 1)), "meant", "verdict"]


def _frequency_ratios(rows: Sequence[Row]) -> list[list[str]]:
    kernels, wholes = [], []
    for row in rows:
        analysis, assembly = row.times.get(UNDAMPED), row.times.get(ASSEMBLY)
        totals = (_together(analysis, assembly), _together(row.times.get(DAMPED), assembly))
        peers = (analysis, *totals)
        wholes.append(_ratio("whole call, all modes", row, row.times.get(PUBLIC), (None, *totals), WHOLE_TARGET))
        if PUBLIC_LOWEST in row.times:
            own = row.times[PUBLIC_LOWEST]
            wholes.append(_ratio("whole call, lowest 20", row, own, (None, *totals), WHOLE_TARGET))
        if CHAIN in row.errors:
            kernels.append(_ratio("chain frequencies", row, row.times.get(CHAIN), peers, CHAIN_TARGET))
        else:
            kernels += [
                _ratio(f"tree with vectors, {what}", row, row.times[name], peers, TREE_TARGET)
                for what, name in TREE_QUESTIONS.items()
                if name in row.times
            ]
    return kernels + wholes


def _response_ratios(rows: Sequence[Row]) -> list[list[str]]:
    table = []
    for row in rows:
        torque = row.times.get(TORQUE)
        peers = (torque, _together(torque, row.times.get(ANGLE)))
        for question, name in (("response", RESPONSE), ("response, no residual", UNCHECKED)):
            table.append(_ratio(question, row, row.times.get(name), peers, RESPONSE_TARGET))
    return table


def _together(first: Timing | None, second: Timing | None) -> Timing | None:
    return first + second if first and second else None


def _ratio(
    question: str, row: Row, own: Timing | None, peers: Sequence[Timing | None], targets: dict[int, int]
) -> list[str]:
    """One line: how many times as fast as each of the peer's calls, and whether that is what was meant."""
    target = targets[row.size]
    case = row.case + (f", {row.asked} frequencies" if row.asked else "")
    head = [question, case, str(row.size)]
    if own is None:
        return [*head, *("-" for _ in peers), f">= {target}", "not measured"]
    ratios = [f"{_figures(t.best / own.best)} / {_figures(t.median / own.median)}" if t else "-" for t in peers]
    holds = {place: t.best / own.best >= target for place, t in enumerate(peers, 1) if t}
    met = [str(place) for place, good in holds.items() if good]
    verdict = f"met against ({') and ('.join(met)}) alone" if met else "MISSED"
    if len(met) == len(holds):
        verdict = "met"
    return [*head, *ratios, f">= {target}", verdict]


def _misses(frequencies: Sequence[Row], responses: Sequence[Row]) -> str:
    lines = [
        f"- {question}, {case}, n = {size}: {'; '.join(ratios)}; meant {meant}: {verdict}"
        for question, case, size, *ratios, meant, verdict in (
            *_frequency_ratios(frequencies),
            *_response_ratios(responses),
        )
        if verdict != "met"
    ]
    faults = [
        f"- {name} failed on {row.case}, n = {row.size}: {error.fault}"
        for row in (*frequencies, *responses)
        for name, error in row.errors.items()
        if error.fault
    ]
    return "\n".join(lines + faults) or "None."


def _worst(row: Row, name: str) -> str:
    error = row.errors.get(name)
    if error is None:
        return "-"
    if error.fault:
        return "failed"
    value = "" if math.isnan(error.worst) else f"{error.worst:.1e}"
    return value + (f" ({abs(error.lost)} {'lost' if error.lost > 0 else 'too many'})" if error.lost else "")


def _each(row: Row, name: str) -> str:
    error: Error = row.errors[name]
    return "failed" if error.fault else f"{error.each:.1e}"


def _time(timing: Timing | None) -> str:
    if timing is None:
        return "-"
    unit, factor = ("s", 1.0) if timing.best >= 1 else ("ms", 1e3)
    return f"{_figures(timing.best * factor)} {unit} ({timing.calls})"


def _figures(value: float) -> str:
    """Three figures, no exponent."""
    return f"{value:.{max(0, 2 - math.floor(math.log10(value)))}f}"


def _table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)
