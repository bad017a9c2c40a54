"""ROSS on the cases it can hold: chains of discs and couplings. Its rotors bend as well; nothing here bends."""

from collections.abc import Sequence
from importlib.metadata import version
from typing import Any

import numpy as np
import ross

from benchmarks.cases import Case

NAME = f"ROSS {version('ross-rotordynamics')}"
ANGLE = 5  # of the six freedoms of a node, the rotation about the shaft


def rotor(case: Case) -> Any:
    """The assembled rotor; every disc also has a mass, free to move, that takes no part in torsion."""
    if not case.is_chain:
        raise ValueError("ROSS holds a chain only")
    couplings = []
    for i in range(1, case.size):
        damper = case.viscous[i]
        link = ross.CouplingElement(
            m_l=0, m_r=0, Ip_l=0, Ip_r=0, kr_z=case.stiffness[i], cr_z=damper, n=i - 1
        )
        link.i_d = 0.0  # a rotor of couplings alone needs a bore of each, which ROSS 2.3.0 forgot to give it
        couplings.append(link)
    discs = [ross.DiskElement(n=i, m=1.0, Id=1.0, Ip=case.inertia[i]) for i in range(case.size)]
    return ross.Rotor(couplings, discs)


def modal(assembled: Any) -> Any:
    """What is timed as the modal analysis: all modes with vectors, not taken from its cache."""
    assembled.run_modal.cache_clear()
    return assembled.run_modal(speed=0, num_modes=2 * assembled.ndof, sparse=False)


def frequencies(assembled: Any) -> np.ndarray:
    """Torsional frequencies (rad/s, ascending); ROSS leaves out all below 0.1 rad/s by itself."""
    result = modal(assembled)
    vectors = np.abs(result.evectors[: assembled.ndof]) ** 2
    torsional = vectors[ANGLE::6].sum(axis=0) > 0.5 * vectors.sum(axis=0)
    return np.sort(np.abs(result.evalues[torsional & (result.evalues.imag > 0)]))


def frequency_response(assembled: Any, w: np.ndarray) -> Any:
    """What is timed as the response: every freedom answered to every freedom, not taken from its cache."""
    assembled._run_freq_response.cache_clear()
    return assembled.run_freq_response(speed_range=w, free_free=True)


def span_torque(case: Case, assembled: Any, force: Sequence[complex], w: np.ndarray) -> np.ndarray:
    """Torque in span i on station i, (stations, frequencies), by the difference of its angles: ROSS gives no torque."""
    receptance = frequency_response(assembled, w).freq_resp[ANGLE::6, ANGLE::6]
    angle = np.einsum("ijf,j->if", receptance, np.asarray(force))
    torque = np.zeros((case.size, len(w)), dtype=complex)
    for i in range(1, case.size):
        torque[i] = (case.stiffness[i] + 1j * w * case.viscous[i]) * (angle[i - 1] - angle[i])
    return torque
