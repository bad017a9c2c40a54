"""The page of the peer benchmark: tables in Markdown, every ratio next to what it was meant to be."""

import math
from collections.abc import Sequence

from benchmarks import references
from benchmarks.frequency_rows import (
    CHAIN,
    DAMPED,
    KERNEL,
    LOWEST,
    MODAL,
    PLAIN,
    PUBLIC,
    PUBLIC_LOWEST,
    UNDAMPED,
)
from benchmarks.papers.writing import table
from benchmarks.programs import Row
from benchmarks.response_rows import ANGLE, RECEPTANCE, TORQUE, UNCHECKED
from benchmarks.response_rows import KERNEL as RESPONSE

# How many times as fast as the peer each is meant to be, by size.
CHAIN_TARGET = {10: 30, 100: 100, 1000: 1000}
TREE_TARGET = {10: 5, 100: 5, 1000: 50}
WHOLE_TARGET = {10: 1, 100: 5, 1000: 50}
RESPONSE_TARGET = {10: 80, 100: 150, 1000: 3000}
TREE_QUESTIONS = {
    "all, no certificate": PLAIN,
    "all, certified": KERNEL,
    "lowest 20, certified": LOWEST,
}
FREQUENCY_PEERS = (
    "undamped_modal_analysis",
    "Assembly + undamped_modal_analysis",
    "Assembly + modal_analysis",
)
Times = tuple[float, float]  # s, least and median
NO_ASSEMBLY = 5e-6  # s: nothing is assembled in less
RESPONSE_PEERS = ("vibratory_torque", "vibratory_torque + ss_response")

HOW = """\
The trains are random from a fixed seed and the same for all: free chains of discs and couplings, and free trees with
branches and gear pairs (2, 5 and 10 of them for 10, 100 and 1000 stations). Benign: inertias 0.5 to 2 kg m2,
stiffnesses 1e4 to 5e4 N m/rad. Stiff: inertias 1e-6 to 1e4, stiffnesses 1 to 1e12, even in the logarithm.
References: {arithmetic}, {digits} digits, each frequency proven to {proven} digits by counts; the column "modes" says
how many of a train's modes have a reference, "enclosed" how many of these lie inside torsion's own enclosure.

Times are of one process and one thread, the programs taken in turn (A B A B ...); the best call is given, and the
number of calls in brackets; an assembly and its analysis are a sum. A ratio is peer over torsion, of the best calls
and, after the stroke, of the median calls. A call that takes more than a fifth of the
time allowed is made once. Nothing is omitted because it was wrong.
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
modes; where torsion finds only the lowest 20, the line says so. `plain_modes` is one decomposition without
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


def parts(frequencies: Sequence[Row], responses: Sequence[Row]) -> list[str]:
    """Of the page."""
    return [
        HOW.format(
            arithmetic=references.ARITHMETIC, digits=references.DIGITS, proven=references.PROVEN
        ),
        *_frequency_parts(frequencies),
        *_response_parts(responses),
        "## Misses",
        _misses(frequencies, responses),
    ]


def _frequency_parts(rows: Sequence[Row]) -> list[str]:
    names = (CHAIN, PLAIN, KERNEL, LOWEST, PUBLIC, PUBLIC_LOWEST, UNDAMPED, DAMPED, MODAL)
    errors = [
        [row.case, str(row.size), str(row.referenced), str(row.enclosed)]
        + [_worst(row, name) for name in names]
        for row in rows
    ]
    times = [[row.case, str(row.size)] + [_time(row, name) for name in names] for row in rows]
    return [
        "## Natural frequencies: largest relative error",
        table(["case", "n", "modes", "enclosed", *names], errors),
        MODES_NOTE,
        "## Natural frequencies: time",
        table(["case", "n", *names], times),
        "## Natural frequencies: times faster than openTorsion",
        table(_ratio_head(FREQUENCY_PEERS), _frequency_ratios(rows)),
        RATIOS_NOTE,
    ]


def _response_parts(rows: Sequence[Row]) -> list[str]:
    names, timed = (RESPONSE, TORQUE, RECEPTANCE), (RESPONSE, UNCHECKED, TORQUE, ANGLE, RECEPTANCE)
    head = ["case", "n", "frequencies", "referenced", *names, *(f"{name}, ns" for name in timed)]
    lines = []
    for row in rows:
        errors = [
            " / ".join(f"{one:.1e}" for one in row.timed[name].errors) if name in row.timed else "-"
            for name in names
        ]
        times = [
            _figures(one[0] * 1e9 / row.size) if (one := row.least(name)) else "-" for name in timed
        ]
        lines.append(
            [row.case, str(row.size), str(row.requested), str(row.referenced), *errors, *times]
        )
    return [
        "## Steady response: span torques",
        table(head, lines),
        RESPONSE_NOTE,
        "## Steady response: times faster than openTorsion",
        table(_ratio_head(RESPONSE_PEERS), _response_ratios(rows)),
        ANSWERS_NOTE,
    ]


def _ratio_head(peers: Sequence[str]) -> list[str]:
    return [
        "question",
        "case",
        "n",
        *(f"({place}) {name}" for place, name in enumerate(peers, 1)),
        "meant",
        "verdict",
    ]


def _frequency_ratios(rows: Sequence[Row]) -> list[list[str]]:
    kernels, wholes = [], []
    for row in rows:
        totals = (row.whole(UNDAMPED), row.whole(DAMPED))
        peers = (row.least(UNDAMPED), *totals)
        wholes += [
            _ratio(f"whole call, {what}", row, row.whole(name), (None, *totals), WHOLE_TARGET)
            for what, name in {"all modes": PUBLIC, "lowest 20": PUBLIC_LOWEST}.items()
            if name == PUBLIC or name in row.timed
        ]
        if CHAIN in row.timed:
            kernels.append(_ratio("chain frequencies", row, row.least(CHAIN), peers, CHAIN_TARGET))
        else:
            kernels += [
                _ratio(f"tree with vectors, {what}", row, row.least(name), peers, TREE_TARGET)
                for what, name in TREE_QUESTIONS.items()
                if name in row.timed
            ]
    return kernels + wholes


def _response_ratios(rows: Sequence[Row]) -> list[list[str]]:
    lines = []
    for row in rows:
        torque, angle = row.least(TORQUE), row.least(ANGLE)
        both = (torque[0] + angle[0], torque[1] + angle[1]) if torque and angle else None
        for question, name in (("response", RESPONSE), ("response, no residual", UNCHECKED)):
            lines.append(_ratio(question, row, row.least(name), (torque, both), RESPONSE_TARGET))
    return lines


def _ratio(
    question: str,
    row: Row,
    own: Times | None,
    peers: Sequence[Times | None],
    targets: dict[int, int],
) -> list[str]:
    """One line: how many times as fast as each of the peer's calls, and whether that is what was meant."""
    target = targets[row.size]
    case = row.case + (f", {row.requested} frequencies" if row.requested else "")
    head = [question, case, str(row.size)]
    if own is None:
        return [*head, *("-" for _ in peers), f">= {target}", "not measured"]
    ratios = [f"{_figures(t[0] / own[0])} / {_figures(t[1] / own[1])}" if t else "-" for t in peers]
    holds = {place: t[0] / own[0] >= target for place, t in enumerate(peers, 1) if t}
    met = [str(place) for place, good in holds.items() if good]
    verdict = f"met only against ({') and ('.join(met)})" if met else "MISSED"
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
        f"- {row.case}, n = {row.size}: {fault}"
        for row in (*frequencies, *responses)
        for fault in row.faults
    ]
    return "\n".join(lines + faults) or "None."


def _worst(row: Row, name: str) -> str:
    if name not in row.timed:
        return "failed" if any(fault.startswith(f"{name},") for fault in row.faults) else "-"
    (error,), lost = row.timed[name].errors, row.lost[name]
    value = "" if math.isnan(error) else f"{error:.1e}"
    return value + (f" ({abs(lost)} {'lost' if lost > 0 else 'too many'})" if lost else "")


def _time(row: Row, name: str) -> str:
    """The best call, with the assembly before it where there is one, and the number of calls."""
    if name not in row.timed:
        return "-"
    found = row.timed[name]
    assembly, solve = min(found.assembly), min(found.solve)
    unit, factor = ("s", 1.0) if solve >= 1 else ("ms", 1e3)
    before = f"{_figures(assembly * factor)} + " if assembly > NO_ASSEMBLY else ""
    return f"{before}{_figures(solve * factor)} {unit} ({found.total.runs})"


def _figures(value: float) -> str:
    """Three figures, no exponent."""
    return f"{value:.{max(0, 2 - math.floor(math.log10(value)))}f}"
