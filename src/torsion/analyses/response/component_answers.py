"""The answers to all harmonic components at some points, with couplings whose stiffness depends on the answer."""

from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from itertools import islice

import numpy as np

from torsion.analyses.response.amplitudes import Balanced, Components, Following
from torsion.analyses.response.solver import NOTHING, Answer, answers, by_magnitude
from torsion.assembly.system import System
from torsion.kernels.tree_response import Status


def solve_components(
    system: System, components: Components, rank: int = 0
) -> tuple[Iterator[Answer], Balanced | None, Following | None]:
    """Return the answer to each component, with couplings in balance and couplings that follow their own torque.

    rank: of the solutions of couplings by table over vibratory torque, the largest first. Answers come one by one, and
    are singular where no balance was found. Raises what `answer` does.
    """
    ground = components.ground
    solve = partial(answers, system, damping=ground, mean=components.mean, speed=components.speed)
    balance: Balanced | None = None
    following: Following | None = None
    settled = np.ones(ground.shape[1], dtype=bool)
    if system.train.has_nonlinear_couplings:
        from torsion.analyses.response.balanced_couplings import balanced

        forces = [sources[0] for sources in components.apart]
        balance = balanced(
            system,
            components.w,
            components.mean,
            lambda tried: list(solve(components.w, forces, added=tried)),
        )
        if balance is not None:
            settled &= balance.settled
    if system.train.has_tables_over("vibratory torque"):
        from torsion.analyses.response.vibratory_couplings import settled as settled_couplings

        following = settled_couplings(system, components, rank)
        settled &= following.settled

    separate = solve(
        [w for _, w, _ in components.separate],
        [source for _, _, source in components.separate],
        added=NOTHING if balance is None else balance.added,
        vibratory=None if following is None else following.by_span,
    )

    def combined() -> Iterator[Answer]:
        for sources in components.apart:
            total = by_magnitude(list(islice(separate, len(sources))))
            yield replace(total, status=np.where(settled, total.status, Status.SINGULAR))

    return combined(), balance, following
