"""A train as x' = A x + B u, y = C x + D u, for control design in Python or MATLAB.

States are sqrt(k) times the twist of every elastic span, then the speeds scaled to unit kinetic energy. Twists in place
of angles leave out the rigid angle, and no stiffness is added to another. The sum of squares of the states is twice the
energy, and a train without fixed station has one zero eigenvalue, its mean speed.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from torsion.analyses.response.solver import ground_damping
from torsion.analyses.steady import steady_if_known
from torsion.arrays import FloatArray
from torsion.assembly.matrices import matrices
from torsion.assembly.system import System
from torsion.errors import Fault, InputError, nearest, refusal
from torsion.study import Study
from torsion.user_files import printable


@dataclass(frozen=True)
class StateSpace:
    """The matrices with the names of their rows and columns; units stand in the names."""

    A: FloatArray  # (states, states) 1/s
    B: FloatArray  # (states, inputs)
    C: FloatArray  # (outputs, states)
    D: FloatArray  # (outputs, inputs)
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]


def state_space(
    study: Study,
    system: System,
    *,
    speed: float,
    inputs: Sequence[str] = (),
    outputs: Sequence[str] = (),
    loss_at: float | None = None,
) -> StateSpace:
    """Return the state space of a lumped train at a reference speed (rad/s).

    Inputs are torques (N m) at the stations `inputs`, outputs the torques of all elastic spans (N m) and the speeds
    (rad/s) of the stations `outputs`; none named: all free stations. A loss factor acts as viscous damping that is
    exact at `loss_at` (rad/s). Raises InputError for what has no state space.
    """
    _check(system, loss_at)
    grid = np.array([speed])
    steady = steady_if_known(study, system, grid) if speed else None
    view = matrices(system, ground_damping=ground_damping(system, grid, steady)[:, 0])
    massless = [
        name
        for name, inertia in zip(view.names, np.diag(view.inertia), strict=True)
        if not inertia > 0
    ]
    if massless:
        hint = "give it an inertia, or join the shafts on both sides into one"
        raise refusal(f"'{massless[0]}' has no inertia, and its angle is no state", hint)

    spans = np.flatnonzero((system.flexibility > 0) & np.isfinite(system.flexibility))
    twist = system.twist(view.basis / system.speed_ratio[:, None])[spans]
    if np.linalg.matrix_rank(twist) < len(spans):
        message = "the twists around a closed loop depend on each other"
        raise refusal(message, "`torsion solve --matrices` writes J, C and K of such a train")

    stiffness = 1.0 / system.flexibility[spans]
    viscous, damping = system.viscous[spans], view.damping
    if loss_at is not None:
        from_loss = stiffness * system.loss_factor[spans] / loss_at
        viscous, damping = viscous + from_loss, damping + (twist.T * from_loss) @ twist

    # v = L^-T w with J = L L': speeds w of unit energy. J is diagonal in a lumped train.
    root = np.linalg.cholesky(view.inertia)
    lift = np.linalg.solve(root, np.eye(len(root))).T
    coupling = np.sqrt(stiffness)[:, None] * (twist @ lift)
    free = [
        station.name
        for station, is_held in zip(system.stations, system.held, strict=True)
        if not (is_held or station.is_ground)
    ]
    places, seen = (
        [_station(view.stations, view.basis, name) for name in names or free]
        for names in (inputs, outputs)
    )
    count = len(spans)
    names = [system.spans[span].name for span in spans.tolist()]
    return StateSpace(
        A=np.block([[np.zeros((count, count)), coupling], [-coupling.T, -lift.T @ damping @ lift]]),
        B=np.vstack([np.zeros((count, len(places))), lift.T @ view.basis[places].T]),
        C=np.block(
            [
                [np.diag(np.sqrt(stiffness)), viscous[:, None] * (twist @ lift)],
                [np.zeros((len(seen), count)), view.basis[seen] @ lift],
            ]
        ),
        D=np.zeros((count + len(seen), len(places))),
        states=(
            *(f"sqrt(stiffness) x twist of {name}" for name in names),
            *(f"sqrt(inertia) x speed of {name}" for name in view.names),
        ),
        inputs=tuple(f"torque at {view.stations[station]} [N m]" for station in places),
        outputs=(
            *(f"torque of {name} [N m]" for name in names),
            *(f"speed of {view.stations[station]} [rad/s]" for station in seen),
        ),
    )


def write_state_space(model: StateSpace, file: Path) -> None:
    """Write the matrices and names to .npz, or to .mat for MATLAB; raises OSError."""
    arrays = {key: np.array(value) for key, value in vars(model).items()}
    if file.suffix.lower() == ".mat":
        from scipy.io import savemat

        savemat(
            file,
            {
                key: array if array.dtype.kind == "f" else array.astype(object)
                for key, array in arrays.items()
            },
        )
        return
    with file.open("wb") as target:
        np.savez(target, allow_pickle=True, **arrays)


def _check(system: System, loss_at: float | None) -> None:
    """Refuse what has no constant matrices over twists and speeds."""
    if system.bars is not None:
        message = f"the model {system.model} has no state space over twists and speeds"
        raise InputError([Fault(("analyses", "model"), message, "model: lumped")])
    if system.train.has_nonlinear_couplings:
        raise refusal("a coupling with backlash, friction or stages has no linear state space")
    if any(system.own_spans[span].error for span in range(len(system.own_spans))):
        raise refusal("the angle error of a universal joint has no linear state space")
    if loss_at is None and np.any(system.loss_factor > 0):
        name = system.spans[int(np.argmax(system.loss_factor > 0))].name
        message = f"the loss factor of '{name}' has no state space"
        raise refusal(message, "name the frequency at which it is exact: --at 12 (Hz)")


def _station(stations: tuple[str, ...], basis: FloatArray, name: str) -> int:
    """Return the position of a free station."""
    if name not in stations:
        near = nearest(name, stations)
        hint = f"did you mean '{near}'?" if near else f"stations: {', '.join(stations[:12])}"
        raise refusal(f"no station is called '{printable(name)}'", hint)
    position = stations.index(name)
    if not basis[position].any():
        raise refusal(f"'{name}' is fixed, so no torque acts on it and it has no speed")
    return position
