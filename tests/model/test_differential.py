"""A differential against the equations of both halves with the constraint of the case, complex with complex."""

from collections.abc import Iterator
from typing import Any

import mpmath as mp
import numpy as np
import pytest
import yaml
from tests.for_all import for_all

import torsion
from torsion.errors import InputError
from torsion.model.machine import SEA_WATER
from torsion.output.blocks import Paragraph
from torsion.output.chapters.modes import mass_elastic
from torsion.output.station_layout import layout
from torsion.schema.scene_reader import parse

with mp.workdps(40):
    RATIO, SPIN = mp.mpf(41) / 11, mp.mpf(16) / 10
J = {"motor": 0.2, "pinion": 0.004, "case": 0.09, "side": 0.003, "hub": 0.02, "wheel": 1.4}
K0, K1, K2, C1 = 9e4, 2.2e4, 8e3, 4.0
PLANET, N = 0.0004, 4
HALF = [
    {"coupling": {"name": "half shaft", "stiffness": K1, "viscous": C1}},
    {"disc": {"name": "hub", "inertia": J["hub"]}},
    {"coupling": {"name": "tyre", "stiffness": K2, "loss_factor": 0.1}},
    {"propeller": {"name": "wheel", "inertia": J["wheel"], "damping": 1.5}},
]


@pytest.fixture(autouse=True)
def _digits() -> Iterator[None]:
    with mp.workdps(40):
        yield


def scene(**differential: Any) -> dict[str, Any]:
    halves = {
        "side_gear": J["side"],
        "planets": N,
        "planet_inertia": PLANET,
        "teeth": [16, 10],
        "train": HALF,
        **differential,
    }
    return {
        "name": "axle",
        "train": [
            {"motor": {"name": "motor", "inertia": J["motor"]}},
            {"coupling": {"name": "propshaft", "stiffness": K0}},
            {
                "gear": {
                    "name": "axle",
                    "teeth": [11, 41],
                    "inertia": [J["pinion"], J["case"]],
                    "differential": halves,
                }
            },
        ],
        "operation": {
            "speeds": {"from": "300 rpm", "to": "3000 rpm", "steps": 5},
            "rated": {"speed": "3000 rpm", "power": "90 kW"},
        },
        "excitations": [{"at": "motor", "order": 2, "torque": "40 N*m", "phase": "0.3 rad"}],
        "analyses": {"modes": {}, "response": {}},
    }


def solved(given: dict[str, Any]) -> Any:
    return torsion.run(parse(yaml.safe_dump(given), "axle.yaml"))


# motor, pinion, side gear and hub and wheel of each half; the case turns as the mean of the side gears, the planets as
# their half difference times the teeth, the pinion as RATIO times the case
NAMES = ("motor", "side 1", "hub 1", "wheel 1", "side 2", "hub 2", "wheel 2")
CASE = {"side 1": mp.mpf("0.5"), "side 2": mp.mpf("0.5")}


def equations(iw: Any, damped: bool) -> tuple[Any, Any]:
    """J and K (with the damping at i omega, where it is wanted) of all unknowns, the constraints put in."""
    inertia, stiffness = mp.matrix(7, 7), mp.matrix(7, 7)

    def add(matrix: Any, value: Any, shape: dict[str, Any]) -> None:
        for a, x in shape.items():
            for b, y in shape.items():
                matrix[NAMES.index(a), NAMES.index(b)] += value * x * y

    pinion = {name: x * RATIO for name, x in CASE.items()}
    add(inertia, mp.mpf(J["motor"]), {"motor": 1})
    add(inertia, mp.mpf(J["pinion"]), pinion)
    add(inertia, mp.mpf(J["case"]), CASE)
    add(inertia, N * mp.mpf(PLANET), {"side 1": SPIN / 2, "side 2": -SPIN / 2})
    add(stiffness, mp.mpf(K0), {"motor": 1, **{name: -x for name, x in pinion.items()}})
    for k in ("1", "2"):
        add(inertia, mp.mpf(J["side"]), {f"side {k}": 1})
        add(inertia, mp.mpf(J["hub"]), {f"hub {k}": 1})
        add(inertia, mp.mpf(J["wheel"]), {f"wheel {k}": 1})
        lost = (
            (iw * mp.mpf(C1), mp.mpc(0, mp.mpf(K2) * mp.mpf(0.1)), iw * mp.mpf(1.5))
            if damped
            else (0, 0, 0)
        )
        add(stiffness, mp.mpf(K1) + lost[0], {f"side {k}": 1, f"hub {k}": -1})
        add(stiffness, mp.mpf(K2) + lost[1], {f"hub {k}": 1, f"wheel {k}": -1})
        add(stiffness, lost[2], {f"wheel {k}": 1})
    return inertia, stiffness


def test_modes_are_those_of_both_halves_with_the_constraint_of_the_case() -> None:
    inertia, stiffness = equations(0, damped=False)
    root = mp.cholesky(inertia)
    inverse = root**-1
    roots = sorted(mp.eigsy(inverse * stiffness * inverse.T, eigvals_only=True))
    found = solved(scene()).results["modes"]
    assert 2 * np.pi * found.frequency == pytest.approx(
        [float(mp.sqrt(one)) for one in roots[2:]], rel=1e-12
    )


@pytest.mark.parametrize("one_wheel", [False, True])
def test_response_of_each_half_is_that_with_the_constraint_of_the_case(one_wheel: bool) -> None:
    given = scene()
    if (
        one_wheel
    ):  # the torque acts on the first wheel alone: once on both together, once against each other
        acting = {"order": "82/11", "torque": "25 N*m"}
        given["excitations"] = [{"at": "wheel", **acting}, {"at": "wheel opposed", **acting}]
    found = solved(given)
    response, system = found.results["response"], found.system
    names = {span.name: k for k, span in enumerate(system.spans)}
    for k in (0, response.speed.size // 3, response.speed.size - 1):
        iw = mp.mpc(0, 2 * response.speed[k])
        inertia, stiffness = equations(iw, damped=True)
        force = mp.matrix(7, 1)
        force[3 if one_wheel else 0] = mp.mpf(25) if one_wheel else 40 * mp.expj(mp.mpf(0.3))
        x = mp.lu_solve(iw * iw * inertia + stiffness, force)
        turned = dict(zip(NAMES, x, strict=True))
        for half, sign in (("1", 1), ("2", -1)):
            shaft = complex(
                (mp.mpf(K1) + iw * mp.mpf(C1)) * (turned[f"side {half}"] - turned[f"hub {half}"])
            )
            both, against = (
                response.torque[k, 0, names[one]] for one in ("half shaft", "half shaft opposed")
            )
            assert (both + sign * against) / 2 == pytest.approx(shaft, rel=1e-11)
        before = complex(
            mp.mpf(K0) * (turned["motor"] - RATIO * (turned["side 1"] + turned["side 2"]) / 2)
        )
        assert response.torque[k, 0, names["propshaft"]] == pytest.approx(before, rel=1e-11)


def test_mean_torque_goes_through_both_halves_and_limits_are_those_of_both() -> None:
    given = scene()
    given["train"][2]["gear"]["differential"]["train"] = [
        {
            "coupling": {
                "name": "half shaft",
                "stiffness": K1,
                "rated_torque": 800,
                "heat_limit": 50,
            }
        },
        *HALF[1:],
    ]
    found = solved(given)
    mean, span = found.results["mean"], [one.name for one in found.system.spans]
    motor = 90e3 / (3000 * np.pi / 30)
    assert mean.torque[span.index("half shaft"), -1] == pytest.approx(
        motor * float(RATIO), rel=1e-12
    )
    assert mean.torque[span.index("half shaft opposed"), -1] == 0.0
    ratings = found.study.train["half shaft"].ratings
    assert (ratings.rated_torque, ratings.heat_limit) == (1600, 100)
    assert found.study.train["half shaft opposed"].ratings is None


def test_damping_that_grows_with_the_speed_is_that_of_both_halves() -> None:
    """Schwanecke: 0.0231 rho D^5 (P/D)^2 EAR/pi w of one wheel, at 11/41 of the speed of the motor."""
    sizes = {"diameter": "0.8 m", "pitch_ratio": 1.1, "area_ratio": 0.6}
    wheel = {
        "propeller": {
            "name": "wheel",
            "inertia": J["wheel"],
            "damping": {"model": "schwanecke"},
            **sizes,
        }
    }
    system = solved(scene(train=[*HALF[:-1], wheel])).system
    speed = np.array([40.0, 250.0])
    damping = system.ground_damping(speed, np.zeros((len(system.stations), 2)), None)
    one = 0.0231 * SEA_WATER * 0.8**5 * 1.1**2 * 0.6 / np.pi * speed * 11 / 41
    for k, station in enumerate(system.stations):
        both = 2 * one if station.name in ("wheel", "wheel opposed") else 0 * one
        assert damping[k] == pytest.approx(both, rel=1e-12)


def test_half_shafts_by_their_size_are_two_shafts_of_twice_the_stress_modulus() -> None:
    shaft = {
        "shaft": {
            "name": "half shaft",
            "length": "0.8 m",
            "diameter": "36 mm",
            "bore": "12 mm",
            "segments": 3,
        }
    }
    found = solved(scene(train=[shaft, *HALF[1:]]))
    bar = next(one for one in found.study.train.bars if one.name == "half shaft")
    polar = np.pi * (0.036**4 - 0.012**4) / 32
    assert (bar.section.torsion_constant, bar.section.polar_moment) == pytest.approx(
        (2 * polar, 2 * polar), rel=1e-14
    )
    assert bar.section.stress_modulus == pytest.approx(2 * polar / 0.018, rel=1e-14)
    flexibility = [
        found.system.flexibility[k]
        for k, one in enumerate(found.system.spans)
        if one.part == bar.part
    ]
    assert 1 / sum(flexibility) == pytest.approx(2 * bar.shear_modulus * polar / 0.8, rel=1e-13)


@for_all(
    ("train", "words"),
    [
        ([{"motor": {"inertia": 1}}], "does not support: motor"),
        ([{"coupling": {"stiffness": 5e3, "clearance": "1 deg"}}, HALF[-1]], "nonlinear"),
        ([{"joint": {"angle": "5 deg"}}, HALF[-1]], "does not support: joint"),
        ([{"shaft": {"length": 1, "diameter": ["40 mm", "50 mm"]}}, HALF[-1]], "conical"),
        (
            [{"shaft": {"length": 1, "diameter": "40 mm", "role": "intermediate"}}, HALF[-1]],
            "`role`",
        ),
    ],
)
def test_half_that_two_equal_ones_cannot_stand_for_is_refused(train: list[Any], words: str) -> None:
    with pytest.raises(InputError, match=words) as raised:
        solved(scene(train=train))
    assert (
        len([fault for fault in raised.value.faults if "half of a differential" in fault.message])
        == 1
    )


def test_planets_need_their_teeth() -> None:
    given = scene()
    del given["train"][2]["gear"]["differential"]["teeth"]
    with pytest.raises(InputError, match="side gear, planet"):
        solved(given)


def test_report_says_what_the_halves_stand_for_and_draws_each_motion_on_a_row_of_its_own() -> None:
    found = solved(scene())
    said = [block.text for block in mass_elastic.chapter(found) if isinstance(block, Paragraph)]
    assert any(
        text.startswith("half shaft, hub, tyre, wheel: both halves downstream of axle together")
        for text in said
    )
    assert any(
        "axle side gears opposed, half shaft opposed" in text and "against each other" in text
        for text in said
    )
    placed, name = layout(found.system), [one.name for one in found.system.stations]
    assert np.isfinite(placed.x).all()
    assert placed.row[name.index("wheel")] != placed.row[name.index("wheel opposed")]


def test_half_takes_no_link() -> None:
    given = scene()
    given["links"] = [{"between": ["hub", "wheel"], "coupling": {"stiffness": 1e3}}]
    with pytest.raises(InputError, match="half of a differential takes no link"):
        solved(given)


def test_halves_are_exact_in_every_model_of_the_shafts() -> None:
    """A half shaft by its size: finite elements against the closed form of the model exact."""
    shaft = {
        "shaft": {"name": "half shaft", "length": "0.8 m", "diameter": "36 mm", "bore": "12 mm"}
    }
    each = []
    for model in ("fem", "exact"):
        given = scene(train=[shaft, *HALF[1:]])
        given["analyses"] = {"model": model, "modes": {"count": 4}}
        each.append(solved(given).results["modes"].frequency)
    np.testing.assert_allclose(each[0], each[1], rtol=1e-8)


def test_no_rule_passes_a_half_by_the_mean_of_both() -> None:
    """Against each other the halves carry no torque of both, whatever one of them carries."""
    given = scene()
    half = {"coupling": {"name": "half shaft", "stiffness": K1, "vibratory_torque": 300}}
    given["train"][2]["gear"]["differential"]["train"] = [half, *HALF[1:]]
    given["excitations"].append({"at": "wheel opposed", "order": 2, "torque": "50 kN*m"})
    given["rules"] = ["coupling-maker"]
    with pytest.raises(
        InputError, match="'wheel opposed' moves the halves unlike, and coupling-maker judges both"
    ):
        solved(given)
    given["excitations"][-1]["torque"] = "0 N*m"
    assert solved(given).results["checks"] is not None
