"""Forced response: complex amplitudes of every order and fixed frequency over the speed range, and their synthesis."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import partial
from itertools import islice
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BeforeValidator

from torsion import fields
from torsion.analyses.damped_modes import DampedModes
from torsion.analyses.response import grid
from torsion.analyses.response.amplitudes import (
    Balanced,
    Components,
    Following,
    Response,
    blocks,
    joined,
    merged,
    refuse_too_large,
)
from torsion.analyses.response.harmonic_components import (
    Excitation,
    excitations,
    excited_orders,
    lines,
    sources,
)
from torsion.analyses.response.solver import NOTHING, Answer, answers, by_magnitude, ground_damping
from torsion.analyses.response.synthesis import synthesis
from torsion.analyses.steady import steady_if_known
from torsion.analyses.undamped_modes import Modes
from torsion.arrays import FloatArray
from torsion.assembly import resolving
from torsion.assembly.system import System
from torsion.errors import Fault, InputError, SolveError
from torsion.fields import Declared, given, refuse
from torsion.findings import Progress, Work, silent
from torsion.kernels.trees.tree_response import Status
from torsion.study import FrequencyRange, Study

MOST_ROUNDS = 4  # of looking for higher utilisations between the speeds


def _read_orders(value: Any) -> Any:
    if value == "all":
        return value
    if isinstance(value, str) or not isinstance(value, list | tuple) or not value:
        hint = "for example [1, 5/2, 4], per turn of the reference station"
        raise refuse("orders are `all` or a list", hint)
    return tuple(fields.read_exact(order) for order in value)


class ResponseSettings(Declared):
    """Settings of `response`."""

    orders: Annotated[Any, BeforeValidator(_read_orders)] = given(
        "`all`, or a list of orders of the reference station; rules about vibration judge all of them together",
        "all",
    )
    frequencies: FrequencyRange | None = given(
        "also the response to the torques that act at every frequency"
    )
    method: Literal["first-order", "harmonic-balance"] | None = given(
        "how joints are treated. Default: first order; in addition `harmonic-balance`, if a joint angle exceeds 10 "
        "degrees or the first order estimates its error as more than 1 %"
    )


def response(
    study: Study,
    system: System,
    *,
    damped: DampedModes | None = None,
    modes: Modes | None = None,
    speeds: FloatArray | None = None,
    also: FloatArray | None = None,
    all_orders: bool = False,
    refine: bool = True,
    progress: Progress | None = None,
) -> Response:
    """Return the response over `speeds` (rad/s of the reference station), else over the operation's speed range.

    `modes` and `damped` spare work and sharpen the grid where they were computed already. Speeds are added around
    every resonance, wherever a peak shows between two of them, and those of `also` (rad/s) that lie in the range.
    `all_orders`: of every order, whatever the settings name. Where the shafts of `system` do not resolve the highest
    frequency they are refined (`Response.system` is what was solved). Raises SolveError where they cannot be, or where
    that is needed and `refine` is False; InputError where speeds, or a mean torque that an excitation or a damping
    follows, are not given, or an order is named that nothing excites.
    """
    if speeds is not None:
        requested = np.unique(np.asarray(speeds, dtype=np.float64))
        if not (requested.size and (requested > 0.0).all() and np.isfinite(requested).all()):
            message = "these are not speeds of a response"
            raise InputError([Fault(("speeds",), message, "one or more, above 0 rad/s")])
    elif study.operation.speeds is None:
        message = "a response over speed needs the speeds"
        hint = "for example `speeds: {from: 300 rpm, to: 1800 rpm}`"
        raise InputError([Fault(("operation", "speeds"), message, hint)])
    else:
        requested = study.operation.speeds.values()
    orders = requested_orders(study)
    excited = excitations(system, None if all_orders else orders)
    highest = max(
        (float(excitation.line.circular_frequency(requested[-1:])[0]) for excitation in excited),
        default=0.0,
    )
    # Shafts resolve the fastest component at the last speed, and so all others.
    highest /= 2.0 * math.pi
    system = resolving(system, highest, excited=highest, refine=refine)
    points = requested
    if also is not None:
        inside = also[(also > requested[0]) & (also < requested[-1])]
        points = np.union1d(requested, grid.apart(requested, inside))
    solved_orders = {excitation.line.order for excitation in excited}
    by_order = np.array([float(order) for order in solved_orders if order is not None])

    def ground(speed: FloatArray) -> FloatArray:
        return ground_damping(system, speed, steady_if_known(study, system, speed))

    remark = ""
    if by_order.size:
        ends = requested[0], requested[-1]
        places = grid.resonances(system, np.sort(by_order), *ends, ground, modes, damped)
        values = len(excited) * (len(system.stations) + len(system.spans))
        points, remark = grid.refined(points, *places, values)
    path = ("operation", "speeds")
    refuse = partial(refuse_too_large, system, len(excited), study.memory, path, "speeds")
    solve = partial(_solve, study, system, excited, progress or silent)
    unit = 30.0 / math.pi, "rpm"
    result = grid.with_peaks(solve, requested, points, remark, refuse, unit)
    left_out = tuple(line for line in lines(system) if line.order not in solved_orders)
    return replace(result, left_out=left_out)


def response_of_orders(
    study: Study, system: System, orders: Sequence[Fraction], speeds: FloatArray
) -> Response:
    """Return the response of some orders of the reference at `speeds` (speeds,) rad/s alone, ascending."""
    return _solve(study, system, excitations(system, orders), silent, speeds)


def requested_orders(study: Study) -> tuple[Fraction, ...] | None:
    """Return the orders that the settings of `response` name, None for all.

    Raises InputError where nothing excites one.
    """
    if faults := order_faults(study):
        raise InputError(faults)
    orders: Any = getattr(study.analyses.get("response"), "orders", "all")
    return None if orders == "all" else tuple(orders)


def order_faults(study: Study) -> list[Fault]:
    """Return the faults of orders that the settings of `response` name and nothing excites."""
    orders: Any = getattr(study.analyses.get("response"), "orders", "all")
    if orders == "all":
        return []
    excited = excited_orders(study.train)
    hint = f"there are {', '.join(map(str, excited))}, per turn of the reference"
    hint = hint if excited else "nothing excites by order"
    return [
        Fault(
            ("analyses", "response", "orders", position), f"no excitation has order {order}", hint
        )
        for position, order in enumerate(orders)
        if order not in excited
    ]


def _solve(
    study: Study,
    system: System,
    excited: tuple[Excitation, ...],
    progress: Progress,
    speed: FloatArray,
    rank: int = 0,
) -> Response:
    """Return every harmonic component at every speed (rad/s), ascending.

    rank: of the solutions of couplings by table over vibratory torque, the largest first; those of a rank above 0 come
    with that of rank 0.

    The model evaluates a joint's error e at the mean angle of its yokes. Terms of second order are left out: a joint
    changes the stiffness seen through it by 4 q at twice its speed, and a yoke that oscillates by x changes e by its
    slope times x. Acting twice, they come back at the same order with the square of both together, (2 q + 2 |x|)^2, of
    the largest joint: the `joint_error`. It is an estimate and no bound; in 40 cases of a train of two joints (3 to 30
    degrees, off and at resonance, cancelling and adding) it was 1.3 to 32 times the error against the full non-linear
    solution.
    """
    shape = len(speed), len(excited)
    arrays: dict[str, Any] = {
        "frequency": np.empty(shape),
        "angle": np.empty((*shape, len(system.stations)), dtype=np.complex128),
        "torque": np.empty((*shape, len(system.spans)), dtype=np.complex128),
        "mean": np.zeros((len(speed), len(system.spans))),
        "residual": np.empty(shape),
        "status": np.empty(shape, dtype=np.uint8),
        "joint_error": np.zeros(shape),
    }
    blocks_of_couplings = list[tuple[Balanced | None, Following | None]]()
    for block in blocks(len(speed), len(system.stations)):
        speeds = speed[block]
        steady = steady_if_known(study, system, speeds)
        if steady is not None:
            arrays["mean"][block] = steady.torque.T
        components = Components(
            [excitation.line.order for excitation in excited],
            [excitation.line.circular_frequency(speeds) for excitation in excited],
            [
                [sources(system, source, speeds, steady) for source in excitation.apart.values()]
                for excitation in excited
            ],
            ground_damping(system, speeds, steady),
            arrays["mean"][block].T,
            speeds,
        )
        answers, balance, following = solve_components(system, components, rank)
        blocks_of_couplings.append((balance, following))
        for k, (excitation, answer) in enumerate(zip(excited, answers, strict=True)):
            done = block.start + k * len(speeds) / len(excited)
            progress("response", done / max(len(speed), 1))
            arrays["frequency"][block, k] = components.w[k] / (2.0 * math.pi)
            for key, values in vars(answer).items():
                arrays[key][block, k] = values
            joint_error = arrays["joint_error"][block, k]
            for error in excitation.errors:
                angle = np.abs(answer.angle[:, system.spans[error.span].driving])
                second_order = (2.0 * abs(error.amplitude) + error.order * angle) ** 2
                np.maximum(joint_error, second_order, out=joint_error)

    # Each solution of couplings by table is a response; where a speed has fewer solutions, its last one stands.
    following = joined([following for _, following in blocks_of_couplings])
    several = 0 if following is None or rank else int(following.number.max(initial=0))
    phases = (excitation.apart.keys() for excitation in excited if excitation.line.order)
    return Response(
        speed=speed,
        requested=np.zeros(len(speed), dtype=bool),
        lines=tuple(excitation.line for excitation in excited),
        **arrays,
        system=system,
        balanced=joined([balance for balance, _ in blocks_of_couplings]),
        by_magnitude=len(frozenset().union(*phases)) > 1,
        following=following,
        others=tuple(
            _solve(study, system, excited, progress, speed, rank_of_solution)
            for rank_of_solution in range(1, several)
        ),
    )


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
    vibratory = dict[int, FloatArray]()
    # First what all components decide together: the amplitude of a coupling; then each component by itself.
    settled = np.ones(ground.shape[1], dtype=bool)
    if system.train.has_nonlinear_couplings:
        from torsion.analyses.response.balanced_couplings import balanced

        forces = [apart[0] for apart in components.apart]
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
        vibratory = dict(zip(following.spans, following.torque.T, strict=True))
        settled &= following.settled

    separate = solve(
        [w for _, w, _ in components.separate],
        [source for _, _, source in components.separate],
        added=NOTHING if balance is None else balance.added,
        vibratory=vibratory,
    )

    # Sources whose phases to each other are any were solved apart: their magnitudes add up.
    totals = (by_magnitude(list(islice(separate, len(apart)))) for apart in components.apart)
    combined = (
        replace(total, status=np.where(settled, total.status, Status.SINGULAR)) for total in totals
    )
    return combined, balance, following


def run(work: Work) -> None:
    """Put response and synthesis of a train that something excites, at speeds that are given."""
    result = _logged_response(work)
    orders = "the orders requested" if result.left_out else "all orders"
    with work.log.step("synthesis", f"rules and readers judge {orders} together") as step:
        total = synthesis(result)
        step.method = "sum over the common cycle, true to phase"
        step.size = "no common cycle: bound by magnitudes"
        if total.turns:
            step.size = f"cycle of {total.turns} turns"
    if "response" in work.ruled:
        # Speeds are added until no rule finds its worst value between two computed speeds.
        count = result.speed.size
        solved_orders = [line.order for line in result.lines if line.order is not None]
        why = "no worst value of a rule lies between two speeds"
        with work.log.step("speeds between", why) as step:
            for _ in range(MOST_ROUNDS):
                speeds = work.rules.speeds_between(work.having(response=result, synthesis=total))
                # A coupling over vibratory torque can have several solutions: the rules judge each of them.
                for solution in result.others:
                    results = work.having(response=solution, synthesis=synthesis(solution))
                    speeds = np.union1d(speeds, work.rules.speeds_between(results))
                if not speeds.size:
                    break
                addition = response_of_orders(work.study, work.system, solved_orders, speeds)
                total = merged(total, synthesis(addition), result.speed, speeds)
                result = merged(result, addition, result.speed, speeds)
            step.method = "parabolas through the utilisations; ends of barred ranges"
            step.size = f"{result.speed.size - count} speeds"
    work.put(response=result, synthesis=total)


def _logged_response(work: Work) -> Response:
    """Return the response at the speeds requested, around resonances and, for rules, at the bounds of their limits."""
    study = work.study
    is_ruled = "response" in work.ruled
    reason = "requested" if "response" in study.analyses else "something excites"
    with work.log.step("response over speed", reason) as step:
        added = work.rules.judged_speeds(study) if is_ruled else np.empty(0)
        orders = [line.order for line in lines(work.system) if line.order]
        if study.train.follows_speed and orders and study.operation.speeds is not None:
            from torsion.analyses.modes.frequencies_by_torque import FrequenciesOverSpeed, reaching

            highest = float(max(orders)) * study.operation.speeds.last
            try:
                modes = reaching(study, work.system, work.get(FrequenciesOverSpeed), highest)
            except SolveError as error:
                work.log.without("points of the response at every resonance", str(error))
            else:
                met = [speed for order in orders for _, speed, _ in modes.crossings(order)]
                added = np.union1d(added, met)
        result = response(
            study,
            work.system,
            modes=work.get(Modes),
            damped=work.get(DampedModes),
            also=added,
            all_orders=is_ruled,
            progress=work.progress,
        )
        step.method = "two-sided elimination, every order apart"
        step.size = f"{len(result.lines)} lines at {result.speed.size} speeds ({int(result.requested.sum())} requested)"
        if is_ruled and requested_orders(study) is not None:
            step.size += "; all orders, not only `orders`: the rules judge them together"
        if result.remark:
            step.size += f"; {result.remark}"
    for line in result.left_out:
        omitted = f"order {line.order} of the response ({', '.join(line.sources)})"
        work.log.without(omitted, "`orders` does not name it")
    return result
