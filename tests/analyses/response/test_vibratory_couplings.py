"""Couplings by table over vibratory torque against closed forms, a dense scan and couplings of their stiffness."""

import math
from dataclasses import replace
from functools import cache

import mpmath as mp
import numpy as np
import pytest

import torsion
from torsion.analyses.response.amplitudes import Response, Synthesis
from torsion.analyses.response.component_loads import harmonic_heat
from torsion.analyses.response.over_frequency import frequency_response
from torsion.analyses.response.synthesis import half_range, synthesis
from torsion.analyses.response.vibratory_couplings import VibratoryTorques
from torsion.assembly import assemble
from torsion.assembly.matrices import matrices
from torsion.errors import InputError
from torsion.kernels.trees.tree_response import Status
from torsion.rules.verdict_line import Checks
from torsion.runner import run
from torsion.study import Study

AT, K, ETA = (0.0, 500.0, 1000.0, 2000.0), (30e3, 26e3, 22e3, 20e3), (0.04, 0.05, 0.05, 0.06)
TABLE = (
    "{over: vibratory torque, at: [0 N*m, 500, 1 kN*m, 2000], stiffness: [30e3, 26e3, 22e3, 20e3], "
    "loss_factor: [0.04, 0.05, 0.05, 0.06], beyond: hold}"
)
SCENE = """name: test
train:
  - disc: {{name: a, inertia: 10}}
  - coupling: {{name: c, vibratory_torque: 900 N*m, {coupling}}}
  - disc: {{name: b, inertia: 40}}
{more}operation: {{speeds: {{from: 300 rpm, to: 700 rpm, steps: {steps}}}}}
excitations: [{{at: a, order: 1, torque: 100 N*m}}{orders}]
rules: [coupling-maker]
analyses: {{response: }}
"""
TWO_ORDERS = ", {at: a, order: 3/2, torque: 50 N*m, phase: 30 deg}"
SECOND = """  - coupling:
      name: d
      table: {over: vibratory torque, at: [10, 300], stiffness: [90e3, 60e3], psi: [0.5, 0.6], beyond: hold}
  - disc: {inertia: 30}
"""


def study(
    coupling: str = f"table: {TABLE}", more: str = "", orders: str = "", steps: int = 21
) -> Study:
    return torsion.parse(SCENE.format(coupling=coupling, more=more, orders=orders, steps=steps))


def response(scene: Study, speeds: np.ndarray | None = None) -> Response:
    return torsion.response(scene, assemble(scene.train), speeds=speeds)


@cache
def two_orders() -> Response:
    return response(study(orders=TWO_ORDERS))


def two_masses(w: float, k: float, eta: float, torque: complex = 100.0) -> complex:
    stiffness = k * (1 + 1j * eta)
    return torque * stiffness * 40.0 / (stiffness * 50.0 - w * w * 400.0)


def roots(w: float) -> list[float]:
    """All T = |torque at the stiffness of T| of one order, in 30 digits between the changes of sign of a dense scan."""
    size = np.linspace(1e-3, 4000.0, 40_001)
    excess = np.abs(two_masses(w, np.interp(size, AT, K), np.interp(size, AT, ETA))) - size
    found = []
    for place in np.flatnonzero(np.diff(np.sign(excess))):
        piece = min(int(np.searchsorted(AT, size[place], side="right")), len(AT) - 1) - 1
        low, step, share = (
            AT[piece],
            AT[piece + 1] - AT[piece],
            1.0 if size[place] < AT[-1] else 0.0,
        )

        def height(x, a=piece, low=low, step=step, share=share):
            part = (x - low) / step if share else mp.mpf(1)
            k, eta = (one[a] + (mp.mpf(one[a + 1]) - one[a]) * part for one in (K, ETA))
            own = k * mp.mpc(1, eta)
            return abs(100 * own * 40 / (own * 50 - mp.mpf(w) ** 2 * 400)) - x

        with mp.workdps(30):
            found.append(
                float(mp.findroot(height, (size[place], size[place + 1]), solver="anderson"))
            )
    return sorted(found, reverse=True)


def test_every_solution_of_one_order_is_found_to_rounding() -> None:
    found = response(study())
    assert found.following is not None
    assert found.following.settled.all()
    assert set(found.following.number[:, 0]) == {1, 3}
    for place in range(0, len(found.speed), 7):
        expected = roots(float(found.speed[place]))
        assert found.following.number[place, 0] == len(expected)
        ranks = [found.following, *(one.following for one in found.others)]
        for rank, size in enumerate(expected):
            assert ranks[rank].torque[place, 0] == pytest.approx(size, rel=1e-12)
        assert abs(found.torque[place, 0, 0]) == pytest.approx(expected[0], rel=1e-12)


def test_half_range_of_two_orders_is_that_of_the_synthesis_at_its_stiffness() -> None:
    found = run(study(orders=TWO_ORDERS, steps=9))
    total, one = found.need(Synthesis), found.need(VibratoryTorques).each[0]
    assert total.half_range[:, 0] == pytest.approx(one.torque, rel=1e-12)
    assert one.residual.max() < 1e-12
    for place in (0, 40, len(one.speed) - 1):
        eta, k, speed = (
            float(one.loss_factor[place]),
            float(one.stiffness[place]),
            one.speed[[place]],
        )
        assert (k, eta) == (
            np.interp(one.torque[place], AT, K),
            np.interp(one.torque[place], AT, ETA),
        )
        plain = study(f"stiffness: {k!r}, loss_factor: {eta!r}", orders=TWO_ORDERS)
        assert response(plain, speed).torque[0] == pytest.approx(
            found.need(Response).torque[place], rel=1e-12
        )


def test_solutions_of_two_orders_are_those_of_a_dense_scan() -> None:
    found = two_orders()
    angle, size = np.linspace(0.0, 4.0 * math.pi, 2001), np.linspace(0.5, 3000.0, 3000)
    k, eta = np.interp(size, AT, K), np.interp(size, AT, ETA)
    torques = {1.0: 100.0, 1.5: 50.0 * np.exp(1j * math.pi / 6.0)}
    turning = np.array([np.exp(1j * order * angle) for order in torques])
    for place in range(0, len(found.speed), 9):
        made = np.transpose(
            [
                two_masses(order * found.speed[place], k, eta, torque)
                for order, torque in torques.items()
            ]
        )
        wave = made.real @ turning.real - made.imag @ turning.imag
        excess = (wave.max(axis=1) - wave.min(axis=1)) / 2.0 - size
        changes = size[np.flatnonzero(np.diff(np.sign(excess)))]
        assert found.following.number[place, 0] == len(changes)
        assert found.following.torque[place, 0] == pytest.approx(changes.max(), abs=1.0)


def test_a_table_of_one_stiffness_gives_the_response_of_a_plain_coupling() -> None:
    flat = study(
        "table: {over: vibratory torque, at: [0, 900], stiffness: [24e3, 24e3], psi: [1, 1], beyond: hold}"
    )
    plain = study("stiffness: 24e3, psi: 1")
    speeds = np.linspace(40.0, 70.0, 9)
    one, other = response(flat, speeds), response(plain, speeds)
    mine, its = np.isin(one.speed, speeds), np.isin(other.speed, speeds)
    assert one.torque[mine] == pytest.approx(other.torque[its], rel=1e-13)
    both = [harmonic_heat(found, found.system, np.array([0])).sum(axis=1) for found in (one, other)]
    assert both[0][mine] == pytest.approx(both[1][its], rel=1e-13)


def test_two_couplings_settle_at_torques_that_their_stiffnesses_lead_to() -> None:
    found = response(study(more=SECOND, orders=TWO_ORDERS, steps=5))
    follow = found.following
    assert follow.settled.all()
    assert follow.rounds.max() > 2
    place = int(np.argmax(follow.torque[:, 0]))
    first, second = (
        found.system.tables[span].values(follow.torque[place, number])
        for number, span in enumerate(follow.spans)
    )
    plain = "stiffness: {!r}, loss_factor: {!r}"
    own, beside = (plain.format(float(one[0]), float(one[1])) for one in (first, second))
    scene = study(
        own, f"  - coupling: {{name: d, {beside}}}\n  - disc: {{inertia: 30}}\n", TWO_ORDERS
    )
    assert response(scene, found.speed[[place]]).torque[0] == pytest.approx(
        found.torque[place], rel=1e-10
    )


def test_every_check_is_the_worst_of_all_solutions() -> None:
    """A stiff shaft beside it turns with what the coupling does not isolate: its worst is of another solution."""
    more = "  - coupling: {name: stiff, stiffness: 3e5, vibratory_torque: 100 N*m, psi: 0.3}\n  - disc: {inertia: 5}\n"
    found = run(study(more=more))
    checks = {check.where: check for check in found.need(Checks).lines if check.clause == "T_KW"}
    main = found.need(Response)
    assert main.others
    every = [np.abs(one.torque[:, 0, :]) for one in (main, *main.others)]
    for span, where in enumerate(("c", "stiff")):
        assert checks[where].value == pytest.approx(
            max(one[:, span].max() for one in every), rel=1e-12
        )


def test_half_range_of_any_quantity_adds_magnitudes_where_phases_are_any() -> None:
    """Engines in any phase to each other: no cycle has a half range above the sum of its magnitudes."""
    found = replace(two_orders(), by_magnitude=True)
    size = np.abs(found.torque[:, :, 0]).sum(axis=1)
    assert half_range(found, found.torque[:, :, 0]) == pytest.approx(size, rel=1e-15)
    assert half_range(found, found.torque[:, :, 0]) == pytest.approx(
        synthesis(found).half_range[:, 0], rel=1e-15
    )


def test_what_does_not_settle_has_no_answer_and_fails_its_check(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    from torsion.analyses.response import vibratory_couplings

    monkeypatch.setattr(vibratory_couplings, "ROUNDS", 2)
    found = run(study(more=SECOND, steps=5))
    response_ = found.need(Response)
    lost = ~response_.following.settled
    assert lost.any()
    assert (response_.status[lost] == Status.SINGULAR).all()
    assert "does not converge" in response_.remark
    assert {check.verdict for check in found.need(Checks).lines if check.clause == "T_KW"} == {
        "fail"
    }


def test_response_over_frequency_has_the_stiffness_of_its_own_torque() -> None:
    scene = torsion.parse(
        SCENE.format(coupling=f"table: {TABLE}", more="", orders="", steps=3)
        .replace("order: 1, ", "")
        .replace("{response: }", "{response: {frequencies: {from: 6, to: 12, steps: 5}}}")
        .replace("rules: [coupling-maker]\n", "")
    )
    found = frequency_response(scene, assemble(scene.train))
    for place, hertz in enumerate(found.frequency):
        assert abs(found.torque[place, 0]) == pytest.approx(
            roots(2.0 * math.pi * float(hertz))[0], rel=1e-12
        )


def test_a_torque_beyond_the_table_is_refused_at_the_table() -> None:
    with pytest.raises(InputError, match=r"covers 0 to 2000 N m; \d{4}\S* N m is needed") as error:
        response(
            study(
                f"table: {TABLE}".replace("hold", "refuse")
                .replace("0.05", "0.01")
                .replace("0.06", "0.01")
            )
        )
    assert error.value.faults[0].path == ("train", 1, "coupling", "table")


@pytest.mark.parametrize(
    ("rest", "words"),
    [
        ("analyses: {transient: {duration: 1 s, events: []}}", "motion over time"),
        ("damping: {modal: 2 %}", "damping by mode"),
        ("analyses: {check: }", "comparison"),
        ("rules: [api-617]", "one natural frequency a mode"),
    ],
)
def test_what_takes_no_such_table_is_refused_at_the_table(rest: str, words: str) -> None:
    text = SCENE.format(coupling=f"table: {TABLE}", more="", orders="", steps=3)
    first = rest.partition(":")[0]
    text = "\n".join(line for line in text.split("\n") if not line.startswith(first)) + rest
    with pytest.raises(InputError, match=words) as error:
        torsion.parse(text)
    assert (4, 59) in {(fault.line, fault.column) for fault in error.value.faults}


def test_matrices_and_critical_speeds_of_large_vibration_are_not_given() -> None:
    scene = study()
    with pytest.raises(InputError, match="follows the vibratory torque has no constant matrices"):
        matrices(assemble(scene.train))
    found = run(replace(scene, analyses={}))
    assert "critical speeds of large vibration" in dict(found.plan.left_out)
