"""The answers to all harmonic components at some points, with couplings whose stiffness depends on the answer."""

from collections.abc import Iterator
from dataclasses import replace
from itertools import islice
from typing import TYPE_CHECKING

import numpy as np

from torsion.analyses.response.amplitudes import Balanced, Components, Following
from torsion.analyses.response.solver import NOTHING, Answer, answers, by_magnitude
from torsion.assembly.system import System
from torsion.kernels.tree_response import Status

if TYPE_CHECKING:
    from collections.abc import Mapping

    from torsion.kernels.describing_functions import Secant


def solve_components(
    system: System, components: Components, rank: int = 0
) -> tuple[Iterator[Answer], Balanced | None, Following | None]:
    """Return the answer to each component, with couplings in balance and couplings that follow their own torque.

    rank: of the solutions of couplings by table over vibratory torque, the largest first. Answers come one by one, and
    are singular where no balance was found. Raises what `answer` does.
    """
    w = components.w
    ground = components.ground
    mean = components.mean
    speed = components.speed
    balance: Balanced | None = None
    following: Following | None = None
    settled = np.ones(ground.shape[1], dtype=bool)
    if system.train.has_nonlinear_couplings:
        from torsion.analyses.response.balanced_couplings import balanced

        forces = [sources[0] for sources in components.apart]

        def solve(tried: "Mapping[int, Secant]") -> list[Answer]:
            return list(answers(system, w, forces, ground, tried, mean=mean, speed=speed))

        if (balance := balanced(system, w, mean, solve)) is not None:
            settled &= balance.settled
    if system.train.has_tables_over("vibratory torque"):
        from torsion.analyses.response.vibratory_couplings import settled as settled_couplings

        following = settled_couplings(system, components, rank)
        settled &= following.settled

    separate = answers(
        system,
        [
            frequencies
            for frequencies, sources in zip(w, components.apart, strict=True)
            for _ in sources
        ],
        [source for sources in components.apart for source in sources],
        ground,
        NOTHING if balance is None else balance.added,
        vibratory=None if following is None else following.by_span,
        mean=mean,
        speed=speed,
    )

    def combined() -> Iterator[Answer]:
        for sources in components.apart:
            total = by_magnitude(list(islice(separate, len(sources))))
            yield replace(total, status=np.where(settled, total.status, Status.SINGULAR))

    return combined(), balance, following
