"""Forced response: complex amplitudes of every order and fixed frequency over the speed range, and their synthesis."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import partial
from itertools import islice
from typing import TYPE_CHECKING, Annotated, Any, Literal

import numpy as np
from pydantic import BeforeValidator

from torsion import fields
from torsion.analyses.damped_modes import DampedModes
from torsion.analyses.discretisation import no_response
from torsion.analyses.response import grid
from torsion.analyses.response.amplitudes import (
    Balanced,
    Components,
    Following,
    Response,
    Synthesis,
    blocks,
    joined,
    merged,
    refuse_too_large,
    with_balance,
)
from torsion.analyses.response.harmonic_components import (
    Excitation,
    excitations,
    excited_orders,
    lines,
    sources,
)
from torsion.analyses.response.solver import Answer, answers, by_magnitude, ground_damping
from torsion.analyses.response.synthesis import synthesis
from torsion.analyses.steady import steady_if_known
from torsion.analyses.undamped_modes import Modes
from torsion.arrays import ComplexArray, FloatArray
from torsion.assembly import resolving
from torsion.assembly.system import System
from torsion.errors import Fault, InputError, SolveError
from torsion.fields import Declared, given, refuse
from torsion.findings import Progress, Work, silent
from torsion.kernels.tree_response import Status
from torsion.study import FrequencyRange, Study

if TYPE_CHECKING:
    from torsion.kernels.describing_functions import Secant

MOST_ROUNDS = 4  # of looking for higher shares of the limits between the speeds


def _read_orders(value: Any) -> Any:
    if value == "all":
        return value
    if isinstance(value, str) or not isinstance(value, list | tuple) or not value:
        raise refuse(
            "orders are `all` or a list",
            "for example [1, 5/2, 4], per turn of the reference station",
        )
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
    """The response over `speeds` (rad/s of the reference station), else over the operation's speed range.

    `modes` and `damped` spare work and sharpen the grid where they were computed already. Speeds are added around
    every resonance, wherever a peak shows between two of them, and those of `also` (rad/s) that lie in the range.
    `all_orders`: of every order, whatever the settings name. Where the shafts of `system` do not resolve the highest
    frequency they are refined (`Response.system` is what was solved). Raises SolveError where they cannot be, or where
    that is needed and `refine` is False; InputError where speeds, or a mean torque that an excitation or a damping
    follows, are not given, or an order is named that nothing excites.
    """
    requested = _requested_speeds(study, speeds)
    orders = requested_orders(study)
    found = excitations(system, None if all_orders else orders)
    highest = max(
        (float(one.line.circular_frequency(requested[-1:])[0]) for one in found), default=0.0
    )
    system = resolving(system, highest / (2.0 * math.pi), refine=refine)
    further = np.empty(0) if also is None else also[(also > requested[0]) & (also < requested[-1])]
    points = np.union1d(requested, grid.apart(requested, further))
    by_order = np.array([float(one.line.order) for one in found if one.line.order is not None])

    def ground(speed: FloatArray) -> FloatArray:
        return ground_damping(system, speed, steady_if_known(study, system, speed))

    remark = ""
    if by_order.size:
        known = grid.resonances(system, float(by_order.max() * points[-1]), modes, damped)
        resonant = grid.places(known, system, by_order, points[0], points[-1], ground)
        values = len(found) * (len(system.stations) + len(system.spans))
        points, remark = grid.refined(points, *resonant, values)
    refuse = partial(
        refuse_too_large, system, len(found), study.memory, ("operation", "speeds"), "speeds"
    )
    solved = partial(_solved, study, system, found, progress or silent)
    result = grid.with_peaks(solved, requested, points, remark, refuse)
    kept = {one.line.order for one in found}
    if result.balanced is not None or result.following is not None:
        result = replace(result, remark=with_balance(result, 30.0 / math.pi, "rpm"))
    return replace(result, left_out=tuple(line for line in lines(system) if line.order not in kept))


def response_at(study: Study, system: System, found: Response, speeds: FloatArray) -> Response:
    """The response at `speeds` (speeds,) rad/s alone, ascending, of the lines that are found."""
    return response_of_orders(
        study, system, [line.order for line in found.lines if line.order is not None], speeds
    )


def response_of_orders(
    study: Study, system: System, orders: Sequence[Fraction], speeds: FloatArray
) -> Response:
    """The response of some orders of the reference at `speeds` (speeds,) rad/s alone, ascending."""
    return _solved(study, system, excitations(system, orders), silent, speeds)


def requested_orders(study: Study) -> tuple[Fraction, ...] | None:
    """The orders that the settings of `response` name, None for all; raises InputError where nothing excites one."""
    if faults := order_faults(study):
        raise InputError(faults)
    orders: Any = getattr(study.analyses.get("response"), "orders", "all")
    return None if orders == "all" else tuple(orders)


def order_faults(study: Study) -> list[Fault]:
    """Orders that the settings of `response` name and nothing excites."""
    orders: Any = getattr(study.analyses.get("response"), "orders", "all")
    if orders == "all":
        return []
    there = excited_orders(study.train)
    hint = f"there are {', '.join(str(order) for order in there)}, per turn of the reference"
    hint = hint if there else "nothing excites by order"
    return [
        Fault(("analyses", "response", "orders", place), f"no excitation has order {order}", hint)
        for place, order in enumerate(orders)
        if order not in there
    ]


def _requested_speeds(study: Study, speeds: FloatArray | None) -> FloatArray:
    """(speeds,) rad/s, ascending."""
    if speeds is not None:
        found = np.unique(np.asarray(speeds, dtype=np.float64))
        if not (found.size and (found > 0.0).all() and np.isfinite(found).all()):
            raise InputError(
                [
                    Fault(
                        ("speeds",),
                        "these are not speeds of a response",
                        "one or more, above 0 rad/s",
                    )
                ]
            )
        return found
    if study.operation.speeds is None:
        hint = "for example `speeds: {from: 300 rpm, to: 1800 rpm}`"
        raise InputError(
            [Fault(("operation", "speeds"), "a response over speed needs the speeds", hint)]
        )
    return study.operation.speeds.values()


def _solved(
    study: Study,
    system: System,
    found: tuple[Excitation, ...],
    progress: Progress,
    speed: FloatArray,
    rank: int = 0,
) -> Response:
    """Every harmonic component at every speed (rad/s), ascending.

    rank: of the solutions of couplings by table over vibratory torque, the largest first; those of a rank above 0 come
    with that of rank 0.
    """
    shape = (len(speed), len(found))
    angle, torque = (
        np.empty((*shape, len(each)), dtype=np.complex128)
        for each in (system.stations, system.spans)
    )
    mean, status = np.zeros((len(speed), len(system.spans))), np.empty(shape, dtype=np.uint8)
    frequency, residual, joint_error = (np.empty(shape) for _ in range(3))
    balance, follow = list[Balanced](), list[Following]()
    for part in blocks(len(speed), len(system.stations)):
        here = speed[part]
        known = steady_if_known(study, system, here)
        ground = ground_damping(system, here, known)
        if known is not None:
            mean[part] = known.torque.T
        each_w = [one.line.circular_frequency(here) for one in found]
        apart = [[sources(system, each, here, known) for each in one.apart] for one in found]
        forces = [each[0] for each in apart]
        if system.train.has_nonlinear_couplings:
            from torsion.analyses.response.balanced_couplings import balanced

            def solve(tried: "Mapping[int, Secant]") -> list[Answer]:
                return list(
                    answers(system, each_w, forces, ground, tried, mean=mean[part].T, speed=here)  # noqa: B023
                )

            if one_block := balanced(system, each_w, mean[part].T, solve):
                balance.append(one_block)
        added = balance[-1].added if balance else {}
        if study.train.has_tables_over("vibratory torque"):
            from torsion.analyses.response.vibratory_couplings import settled

            components = Components(
                [one.line.order for one in found], each_w, apart, ground, mean[part].T, here
            )
            follow.append(settled(system, components, rank))
        every = answers(
            system,
            [w for w, each in zip(each_w, apart, strict=True) for _ in each],
            [one for each in apart for one in each],
            ground,
            added,
            mean=mean[part].T,
            speed=here,
            vibratory=follow[-1].by_span if follow else None,
        )
        for k, one in enumerate(found):
            progress("response", (part.start + k * len(here) / len(found)) / max(len(speed), 1))
            answered = by_magnitude(list(islice(every, len(apart[k]))))
            frequency[part, k] = each_w[k] / (2.0 * math.pi)
            angle[part, k], torque[part, k] = answered.angle, answered.torque
            residual[part, k], status[part, k] = answered.residual, answered.status
            joint_error[part, k] = joint_errors(system, one, answered.angle)
    whole = joined(balance)
    if whole is not None:
        status[~whole.settled] = Status.SINGULAR
    following = joined(follow)
    if following is not None:
        status[~following.settled] = Status.SINGULAR
    each, requested = tuple(one.line for one in found), np.zeros(len(speed), dtype=bool)
    several = 0 if following is None or rank else int(following.number.max(initial=0))
    others = tuple(
        _solved(study, system, found, progress, speed, more) for more in range(1, several)
    )
    return Response(
        speed,
        requested,
        each,
        frequency,
        angle,
        torque,
        mean,
        residual,
        status,
        joint_error,
        system,
        balanced=whole,
        by_magnitude=len(frozenset().union(*(one.by_chance for one in found if one.line.order)))
        > 1,
        following=following,
        others=others,
    )


def joint_errors(system: System, excitation: Excitation, angle: ComplexArray) -> FloatArray:
    """(frequencies,) estimated relative error of a line that joints excite, from its angles (frequencies, stations).

    The model evaluates a joint's error e at the mean angle of its yokes. Terms of second order are left out: a joint
    changes the stiffness seen through it by 4 q at twice its speed, and a yoke that oscillates by x changes e by its
    slope times x. Acting twice, they come back at the same order with the square of both together, (2 q + 2 |x|)^2, of
    the largest joint. It is an estimate and no bound; in 40 cases of a train of two joints (3 to 30 degrees, off and at
    resonance, cancelling and adding) it was 1.3 to 32 times the error against the full non-linear solution.
    """
    worst = np.zeros(len(angle))
    for error in excitation.errors:
        amplitude = np.abs(angle[:, system.spans[error.span].driving])
        worst = np.maximum(worst, (2.0 * abs(error.amplitude) + error.order * amplitude) ** 2)
    return worst


def run(work: Work) -> None:
    """Response and synthesis of a train that something excites, at speeds that are given."""
    if why := no_response(work.study, work.system, work.ruled):
        work.log.without("response over speed", why)
        return
    found = _found(work)
    lines = "the orders requested" if found.left_out else "all orders"
    with work.log.step("synthesis", f"rules and readers judge {lines} together") as step:
        total = synthesis(found)
        step.method = "sum over the common cycle, true to phase"
        step.size = (
            f"cycle of {total.turns} turns"
            if total.turns
            else "no common cycle: bound by magnitudes"
        )
    if "response" in work.ruled:
        found, total = _judged(work, found, total)
    work.put(response=found, synthesis=total)


def _met_over_speed(work: Work) -> list[float]:
    """rad/s at which an order meets a mode whose frequency follows the speed."""
    from torsion.analyses.modes.frequencies_by_torque import FrequenciesOverSpeed, reaching

    orders = [line.order for line in lines(work.system) if line.order]
    if not orders or work.study.operation.speeds is None:
        return []
    highest = float(max(orders)) * work.study.operation.speeds.last
    try:
        known = reaching(work.study, work.system, work.get(FrequenciesOverSpeed), highest)
    except SolveError as error:
        work.log.without("points of the response at every resonance", str(error))
        return []
    return [speed for order in orders for _, speed, _ in known.crossings(order)]


def _found(work: Work) -> Response:
    """The response at the speeds requested, around resonances and, for rules, at the bounds of their limits."""
    study, log, ruled = work.study, work.log, "response" in work.ruled
    with log.step(
        "response over speed", "requested" if "response" in study.analyses else "something excites"
    ) as step:
        also = work.rules.judged_speeds(study) if ruled else np.empty(0)
        if study.train.follows_speed:
            also = np.union1d(also, _met_over_speed(work))
        found = response(
            study,
            work.system,
            modes=work.get(Modes),
            damped=work.get(DampedModes),
            also=also,
            all_orders=ruled,
            progress=work.progress,
        )
        step.method = "two-sided elimination, every order apart"
        step.size = f"{len(found.lines)} lines at {found.speed.size} speeds ({int(found.requested.sum())} requested)"
        if ruled and requested_orders(study) is not None:
            step.size += "; all orders, not only `orders`: the rules judge them together"
        if found.remark:
            step.size += f"; {found.remark}"
    for line in found.left_out:
        log.without(
            f"order {line.order} of the response ({', '.join(line.sources)})",
            "`orders` does not name it",
        )
    return found


def _judged(work: Work, found: Response, total: Synthesis) -> tuple[Response, Synthesis]:
    """With the speeds between at which a rule finds more than at the ones beside them."""
    before = found.speed.size
    with work.log.step(
        "speeds between", "no worst value of a rule lies between two speeds"
    ) as step:
        for _ in range(MOST_ROUNDS):
            more = work.rules.speeds_between(work.having(response=found, synthesis=total))
            for one in found.others:
                beside = work.having(response=one, synthesis=synthesis(one))
                more = np.union1d(more, work.rules.speeds_between(beside))
            if not more.size:
                break
            there = response_at(work.study, work.system, found, more)
            total = merged(total, synthesis(there), found.speed, more)
            found = merged(found, there, found.speed, more)
        step.method = "parabolas through the utilisations; ends of barred ranges"
        step.size = f"{found.speed.size - before} speeds"
    return found, total
