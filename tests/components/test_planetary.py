"""Planetary stages against the equations of motion of sun, ring, carrier and every planet by itself."""

from fractions import Fraction
from typing import Any

import numpy as np
import pytest
import scipy.linalg
import yaml

import torsion
from torsion.components.planetary import Planetary
from torsion.errors import InputError

SHAFTS = {"J1": 3.0, "J2": 40.0, "k1": 2e5, "k2": 5e6}
MEMBERS = ("sun", "ring", "carrier")


def stage(**changes: Any) -> dict[str, Any]:
    return {
        "sun": 24, "ring": 96, "planets": 4, "sun_inertia": 0.02, "ring_inertia": 1.3, "carrier_inertia": 0.9,
        "planet_inertia": 0.03, "planet_mass": 6.0, "radius": 0.12, **changes,
    }  # fmt: skip


def dense(given: dict[str, Any]) -> tuple[np.ndarray, float]:
    """Natural frequencies (rad/s) by unknowns disc, sun, ring, carrier, planets, disc with rigid meshes; speed ratio.

    Rolling: z_s (s - c) = -z_a (p - c) and z_r (r - c) = z_b (p - c), every planet alike.
    """
    driving, fixed = given.get("driving", "sun"), given.get("fixed", "ring")
    driven = next(one for one in MEMBERS if one not in (driving, fixed))
    with_sun, with_ring = given.get("planet", [(given["ring"] - given["sun"]) / 2] * 2)
    # all angles of (sun, ring, carrier, planet) from those of carrier and of the planet against it
    rolling = np.array([[1, -with_sun / given["sun"]], [1, with_ring / given["ring"]], [1, 0], [1, 1]], dtype=float)
    at = {name: rolling[k] for k, name in enumerate((*MEMBERS, "planet"))}
    free = scipy.linalg.null_space(at[fixed][None, :])[:, 0]  # the one motion that holds the fixed member
    own = {name: float(row @ free) for name, row in at.items()}
    ratio = own[driven] / own[driving]
    inertia = sum(given[f"{name}_inertia"] * own[name] ** 2 for name in MEMBERS if name != fixed)
    inertia += given["planets"] * given["planet_inertia"] * own["planet"] ** 2
    inertia += given["planets"] * given["planet_mass"] * given["radius"] ** 2 * own["carrier"] ** 2
    a, b = own[driving], own[driven]
    k1, k2 = SHAFTS["k1"], SHAFTS["k2"]
    stiffness = np.array([[k1, -k1 * a, 0], [-k1 * a, k1 * a**2 + k2 * b**2, -k2 * b], [0, -k2 * b, k2]])
    roots = scipy.linalg.eigh(stiffness, np.diag([SHAFTS["J1"], inertia, SHAFTS["J2"]]), eigvals_only=True)
    return np.sqrt(roots[1:]), ratio


def findings(tmp_path: Any, given: dict[str, Any], **gear: Any) -> Any:
    scene = {
        "name": "planetary",
        "train": [
            {"disc": {"name": "a", "inertia": SHAFTS["J1"]}}, {"coupling": {"stiffness": SHAFTS["k1"]}},
            {"gear": {"planetary": given, **gear}},
            {"coupling": {"stiffness": SHAFTS["k2"]}}, {"disc": {"name": "b", "inertia": SHAFTS["J2"]}},
        ],
        "analyses": {"modes": {}},
    }  # fmt: skip
    file = tmp_path / "scene.yaml"
    file.write_text(yaml.safe_dump(scene))
    return torsion.run(torsion.read(file))


CASES = [
    {}, {"fixed": "carrier"}, {"fixed": "sun", "driving": "ring"}, {"driving": "carrier"},
    {"fixed": "carrier", "driving": "ring"}, {"fixed": "sun", "driving": "carrier"},
    {"planet": [40, 20]}, {"planet": [30, 12], "fixed": "sun", "driving": "ring"},
]  # fmt: skip


@pytest.mark.parametrize("changes", CASES)
def test_stage_moves_as_sun_ring_carrier_and_planets_roll(tmp_path: Any, changes: dict[str, Any]) -> None:
    given = stage(**changes)
    found = findings(tmp_path, given)
    omega, ratio = dense(given)
    assert 2 * np.pi * found.results["modes"].frequency == pytest.approx(omega, rel=1e-12)
    last = next(one for one in found.system.stations if one.name == "b")
    assert float(last.ratio) * last.sense == pytest.approx(ratio, rel=1e-14)


@pytest.mark.parametrize(
    ("fixed", "driving", "speed"),
    [("ring", "sun", "24/120"), ("carrier", "sun", "-24/96"), ("sun", "ring", "96/120"), ("ring", "carrier", "120/24")],
)
def test_speeds_are_those_of_willis(fixed: str, driving: str, speed: str) -> None:
    assert Planetary(sun=24, ring=96, fixed=fixed, driving=driving).speed == Fraction(speed)


@pytest.mark.parametrize(
    ("fixed", "driving"), [("ring", "sun"), ("carrier", "sun"), ("sun", "ring"), ("ring", "carrier")]
)
def test_meshes_yield_by_the_energy_of_their_torques(fixed: str, driving: str) -> None:
    """1 N m at the driving member: half T^2/k of sun and ring, torques from equilibrium and no power lost."""
    found = Planetary(sun=24, ring=96, fixed=fixed, driving=driving, sun_mesh=3e6, ring_mesh=7e6)
    speeds = {fixed: 0.0, driving: 1.0}
    # T_s + T_r + T_c = 0 and T_s/z_s = T_r/z_r
    torques = {"sun": 24.0, "ring": 96.0, "carrier": -120.0}
    scaled = {name: one / torques[driving] for name, one in torques.items()}
    driven = next(one for one in MEMBERS if one not in speeds)
    assert 1.0 + scaled[driven] * float(found.speed) == pytest.approx(0.0, abs=1e-14)
    assert found.flexibility == pytest.approx(scaled["sun"] ** 2 / 3e6 + scaled["ring"] ** 2 / 7e6, rel=1e-14)


@pytest.mark.parametrize(
    ("given", "gear", "words"),
    [
        ({"fixed": "sun"}, {}, "the sun is fixed and cannot drive"),
        ({"ring": 20}, {}, "has no room for a sun"),
        ({"ring": 97}, {}, "the teeth of the planets do not follow"),
        ({"planet": [1, 2, 3]}, {}, "with the sun, with the ring"),
        ({"radius": None}, {}, "`radius` is missing"),
        ({}, {"teeth": [20, 40]}, "exclude each other"),
        ({}, {"inertia": [1, 2]}, "exclude each other"),
        ({"sun": 0}, {}, "sun"),
        ({"planet": 12}, {}, "a planet of 12 teeth does not fit"),
    ],
)
def test_what_cannot_be_is_refused(tmp_path: Any, given: dict[str, Any], gear: dict[str, Any], words: str) -> None:
    made = {key: value for key, value in stage(**given).items() if value is not None}
    with pytest.raises(InputError, match=words):
        findings(tmp_path, made, **gear)
