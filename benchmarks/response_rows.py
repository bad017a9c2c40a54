"""Steady response: every program's span torques against the references, and its time a frequency, on one case."""

from collections.abc import Callable
from typing import Any

import numpy as np

from benchmarks import ours, peers_opentorsion, references
from benchmarks.cases import Case, folded
from benchmarks.comparison import Effort, Error, Kept, Row
from benchmarks.timing import Timing, interleaved

KERNEL = "torsion tree_response"
UNCHECKED = "torsion tree_response, no residual"
ANGLE = "openTorsion ss_response"
TORQUE = "openTorsion vibratory_torque"
RECEPTANCE = "ROSS run_freq_response"
SMALLEST = 1e-290  # N m; a torque below it has left the range of double precision


def compare(case: Case, effort: Effort, asked: int, asked_of_peers: int) -> Row:
    """Three sources of different phase; torsion answers `asked` frequencies, the peers the first of the same ones."""
    w = _frequencies(case, asked)
    force = np.zeros(case.size, dtype=complex)
    force[[0, case.size // 2, -1]] = 1.0, 0.5j, -0.7
    peer_w = w[:asked_of_peers]
    response = ours.Response(case, force, w)
    programs = {KERNEL: Kept(response), UNCHECKED: Kept(lambda: response(check=False))}
    torque: dict[str, Callable[[Any], np.ndarray]] = {KERNEL: response.span_torque}
    assembly = peers_opentorsion.assembled(peers_opentorsion.elements(case))
    periodic = peers_opentorsion.excitation(case, assembly, force, peer_w)
    programs[ANGLE] = Kept(lambda: peers_opentorsion.angles(assembly, periodic))
    programs[TORQUE] = Kept(lambda: peers_opentorsion.span_torque(case, assembly, periodic))
    if effort.ross and case.is_chain and case.size <= 10 and any(case.viscous):
        from benchmarks import peers_ross

        rotor = peers_ross.rotor(case)
        programs[RECEPTANCE] = Kept(lambda: peers_ross.span_torque(case, rotor, force, peer_w))
    times = interleaved(programs, effort.seconds)
    count = min(effort.response_references, asked_of_peers)
    exact = [references.response(case, float(value), force.tolist())[1] for value in w[:count]]
    row = Row(case.name, case.size, referenced=count, asked=asked)
    for name, program in programs.items():
        if name not in (UNCHECKED, ANGLE):
            row.errors[name] = _error(program, torque.get(name, np.asarray), exact)
        if not program.fault:
            share = 1 / (asked if name in (KERNEL, UNCHECKED) else asked_of_peers)
            timing = times[name]
            row.times[name] = Timing(timing.best * share, timing.median * share, timing.calls)
    return row


def _frequencies(case: Case, count: int) -> np.ndarray:
    """Random rad/s, even in the logarithm, from half the lowest frequency to that of three quarters of the modes."""
    values = references.starting_values(folded(case))
    random = np.random.default_rng([case.size, count])
    return np.exp(random.uniform(np.log(values[1] / 2), np.log(values[3 * case.size // 4]), count))


def _error(program: Kept, torque: Callable[[Any], np.ndarray], exact: list[list[Any]]) -> Error:
    if program.fault:
        return Error(fault=program.fault)
    answer = torque(program.answer)
    errors = [references.torque_errors(answer[1:, j], row[1:], SMALLEST) for j, row in enumerate(exact)]
    return Error(worst=max(norm for norm, _ in errors), each=max(each for _, each in errors))
