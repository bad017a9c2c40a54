"""Steady response: every program's span torques against the references, and its time a frequency, on one case."""

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from benchmarks import ours, peers_opentorsion, references
from benchmarks.cases import Case, condensed
from benchmarks.programs import Effort, Row, measure, program

KERNEL = "torsion tree_response"
UNCHECKED = "torsion tree_response, no residual"
ANGLE = "openTorsion ss_response"
TORQUE = "openTorsion vibratory_torque"
RECEPTANCE = "ROSS run_freq_response"
SMALLEST = 1e-290  # N m; a torque below it has left the range of double precision


def compare(case: Case, effort: Effort, requested: int, requested_of_peers: int) -> Row:
    """Three sources of different phase; torsion answers `requested` frequencies, the peers the first of them."""
    w = _frequencies(case, requested)
    force = np.zeros(case.size, dtype=complex)
    force[[0, case.size // 2, -1]] = 1.0, 0.5j, -0.7
    peer_w, count = w[:requested_of_peers], min(effort.response_references, requested_of_peers)
    exact = [references.response(case, float(value), force.tolist())[1] for value in w[:count]]

    def errors(torque: np.ndarray) -> tuple[float, ...]:
        pairs = [
            references.torque_errors(torque[1:, j], row[1:], SMALLEST)
            for j, row in enumerate(exact)
        ]
        return max(norm for norm, _ in pairs), max(each for _, each in pairs)

    def of(
        name: str, solve: Callable[[], Any], frequencies: int, torque: Callable[[Any], Any] | None
    ) -> Any:
        return program(
            name,
            lambda _: solve(),
            lambda found: errors(torque(found)) if torque else (),
            lambda: None,
            frequencies,
        )

    response = ours.Response(case, force, w)
    assembly = peers_opentorsion.assembled(peers_opentorsion.elements(case))
    periodic = peers_opentorsion.excitation(case, assembly, force, peer_w)
    programs = [
        of(KERNEL, response, requested, response.span_torque),
        of(UNCHECKED, lambda: response(check=False), requested, None),
        of(ANGLE, lambda: peers_opentorsion.angles(assembly, periodic), requested_of_peers, None),
        of(
            TORQUE,
            lambda: peers_opentorsion.span_torque(case, assembly, periodic),
            requested_of_peers,
            np.asarray,
        ),
    ]
    if effort.ross and case.is_chain and case.size <= 10 and any(case.viscous):
        from benchmarks import peers_ross

        rotor = peers_ross.rotor(case)
        torque = partial(peers_ross.span_torque, case, rotor, force, peer_w)
        programs.append(of(RECEPTANCE, torque, requested_of_peers, np.asarray))
    return measure(
        Row(case.name, case.size, referenced=count, requested=requested), programs, effort.seconds
    )


def _frequencies(case: Case, count: int) -> np.ndarray:
    """Random rad/s, even in the logarithm, from half the lowest frequency to that of three quarters of the modes."""
    values = references.starting_values(condensed(case))
    random = np.random.default_rng([case.size, count])
    return np.exp(random.uniform(np.log(values[1] / 2), np.log(values[3 * case.size // 4]), count))
