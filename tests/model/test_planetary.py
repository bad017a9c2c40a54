"""Planetary stages against the equations of motion of sun, ring, carrier and every planet by itself."""

from fractions import Fraction
from typing import Any

import mpmath as mp
import numpy as np
import pytest
import scipy.linalg
import yaml
from tests.for_all import for_all

import torsion
from torsion.errors import InputError
from torsion.model.gears.planetary import Planetary

SHAFTS = {"J1": 3.0, "J2": 40.0, "k1": 2e5, "k2": 5e6}
MEMBERS = ("sun", "ring", "carrier")


def stage(**changes: Any) -> dict[str, Any]:
    return {
        "sun": 24,
        "ring": 96,
        "planets": 4,
        "sun_inertia": 0.02,
        "ring_inertia": 1.3,
        "carrier_inertia": 0.9,
        "planet_inertia": 0.03,
        "planet_mass": 6.0,
        "radius": 0.12,
        **changes,
    }


def dense(given: dict[str, Any]) -> tuple[np.ndarray, float]:
    """Natural frequencies (rad/s) by unknowns disc, sun, ring, carrier, planets, disc with rigid meshes; speed ratio.

    Rolling: z_s (s - c) = -z_a (p - c) and z_r (r - c) = z_b (p - c), every planet alike.
    """
    driving, fixed = given.get("driving", "sun"), given.get("fixed", "ring")
    driven = next(one for one in MEMBERS if one not in (driving, fixed))
    with_sun, with_ring = given.get("planet", [(given["ring"] - given["sun"]) / 2] * 2)
    # all angles of (sun, ring, carrier, planet) from those of carrier and of the planet against it
    rolling = np.array(
        [[1, -with_sun / given["sun"]], [1, with_ring / given["ring"]], [1, 0], [1, 1]], dtype=float
    )
    at = {name: rolling[k] for k, name in enumerate((*MEMBERS, "planet"))}
    free = scipy.linalg.null_space(at[fixed][None, :])[
        :, 0
    ]  # the one motion that holds the fixed member
    own = {name: float(row @ free) for name, row in at.items()}
    ratio = own[driven] / own[driving]
    inertia = sum(given[f"{name}_inertia"] * own[name] ** 2 for name in MEMBERS if name != fixed)
    inertia += given["planets"] * given["planet_inertia"] * own["planet"] ** 2
    inertia += given["planets"] * given["planet_mass"] * given["radius"] ** 2 * own["carrier"] ** 2
    a, b = own[driving], own[driven]
    k1, k2 = SHAFTS["k1"], SHAFTS["k2"]
    stiffness = np.array(
        [[k1, -k1 * a, 0], [-k1 * a, k1 * a**2 + k2 * b**2, -k2 * b], [0, -k2 * b, k2]]
    )
    roots = scipy.linalg.eigh(
        stiffness, np.diag([SHAFTS["J1"], inertia, SHAFTS["J2"]]), eigvals_only=True
    )
    return np.sqrt(roots[1:]), ratio


def findings(tmp_path: Any, given: dict[str, Any], **gear: Any) -> Any:
    scene = {
        "name": "planetary",
        "train": [
            {"disc": {"name": "a", "inertia": SHAFTS["J1"]}},
            {"coupling": {"stiffness": SHAFTS["k1"]}},
            {"gear": {"planetary": given, **gear}},
            {"coupling": {"stiffness": SHAFTS["k2"]}},
            {"disc": {"name": "b", "inertia": SHAFTS["J2"]}},
        ],
        "analyses": {"modes": {}},
    }
    file = tmp_path / "scene.yaml"
    file.write_text(yaml.safe_dump(scene))
    return torsion.run(torsion.read(file))


CASES = [
    {},
    {"fixed": "carrier"},
    {"fixed": "sun", "driving": "ring"},
    {"driving": "carrier"},
    {"fixed": "carrier", "driving": "ring"},
    {"fixed": "sun", "driving": "carrier"},
    {"planet": [40, 20]},
    {"planet": [30, 12], "fixed": "sun", "driving": "ring"},
]


@pytest.mark.parametrize("changes", CASES)
def test_stage_moves_as_sun_ring_carrier_and_planets_roll(
    tmp_path: Any, changes: dict[str, Any]
) -> None:
    given = stage(**changes)
    found = findings(tmp_path, given)
    omega, ratio = dense(given)
    assert 2 * np.pi * found.results["modes"].frequency == pytest.approx(omega, rel=1e-12)
    last = next(one for one in found.system.stations if one.name == "b")
    assert float(last.ratio) * last.sense == pytest.approx(ratio, rel=1e-14)


@pytest.mark.parametrize(
    ("fixed", "driving", "speed"),
    [
        ("ring", "sun", "24/120"),
        ("carrier", "sun", "-24/96"),
        ("sun", "ring", "96/120"),
        ("ring", "carrier", "120/24"),
    ],
)
def test_speeds_are_those_of_willis(fixed: str, driving: str, speed: str) -> None:
    assert Planetary(sun=24, ring=96, fixed=fixed, driving=driving).speed == Fraction(speed)


@pytest.mark.parametrize(
    ("fixed", "driving"),
    [("ring", "sun"), ("carrier", "sun"), ("sun", "ring"), ("ring", "carrier")],
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
    assert found.flexibility == pytest.approx(
        scaled["sun"] ** 2 / 3e6 + scaled["ring"] ** 2 / 7e6, rel=1e-14
    )


@mp.workdps(40)
def planet_by_planet(given: dict[str, Any]) -> tuple[list[float], float]:
    """Natural frequencies (rad/s) by unknowns disc, sun, ring, carrier, every planet, disc, in 40 digits.

    A planet between elastic meshes: sun_mesh/n and ring_mesh/n of each, by the radii of rolling circles, which are as
    the teeth: deflections z_s s + z_a p - (z_s + z_a) c and z_r r - z_b p - (z_r - z_b) c. Also that of planets which
    move against each other while all else rests.
    """
    n = given["planets"]
    driving, fixed = given.get("driving", "sun"), given.get("fixed", "ring")
    driven = next(one for one in MEMBERS if one not in (driving, fixed))
    with_sun, with_ring = given.get("planet", [(given["ring"] - given["sun"]) / 2] * 2)
    names = [
        "a",
        *(one for one in MEMBERS if one != fixed),
        *(f"planet {k}" for k in range(n)),
        "b",
    ]
    inertia = {
        "a": SHAFTS["J1"],
        "b": SHAFTS["J2"],
        **{name: given[f"{name}_inertia"] for name in MEMBERS},
        **{f"planet {k}": given["planet_inertia"] for k in range(n)},
    }
    inertia["carrier"] = (
        mp.mpf(inertia["carrier"]) + n * mp.mpf(given["planet_mass"]) * mp.mpf(given["radius"]) ** 2
    )
    springs = [({"a": 1, driving: -1}, SHAFTS["k1"]), ({driven: 1, "b": -1}, SHAFTS["k2"])]
    zs, zr, za, zb = (mp.mpf(one) for one in (given["sun"], given["ring"], with_sun, with_ring))
    for k in range(n):
        sun = {"sun": mp.mpf(1), f"planet {k}": za / zs, "carrier": -1 - za / zs}
        ring = {"ring": mp.mpf(1), f"planet {k}": -zb / zr, "carrier": zb / zr - 1}
        springs += [(sun, mp.mpf(given["sun_mesh"]) / n), (ring, mp.mpf(given["ring_mesh"]) / n)]
    size = len(names)
    matrix = mp.matrix(size, size)
    for shape, stiffness in springs:
        free = [(names.index(name), value) for name, value in shape.items() if name != fixed]
        for i, x in free:
            for j, y in free:
                root = mp.sqrt(mp.mpf(inertia[names[i]]) * mp.mpf(inertia[names[j]]))
                matrix[i, j] += mp.mpf(stiffness) * x * y / root
    roots = sorted(mp.eigsy(matrix, eigvals_only=True))[1:]
    against = (
        mp.mpf(given["sun_mesh"]) * (za / zs) ** 2 + mp.mpf(given["ring_mesh"]) * (zb / zr) ** 2
    ) / n
    return [float(mp.sqrt(one)) for one in roots], float(
        mp.sqrt(against / mp.mpf(given["planet_inertia"]))
    )


ELASTIC = [
    {"sun_mesh": 3e6, "ring_mesh": 9e7},
    {"sun_mesh": 3e6, "ring_mesh": 9e7, "driving": "carrier"},
    {
        "sun_mesh": 2e6,
        "ring_mesh": 1.6e7 * 2,
        "driving": "carrier",
    },  # of one stiffness at the teeth
    {"sun_mesh": 3e6, "ring_mesh": 2e7, "fixed": "sun", "driving": "ring"},
    {"sun_mesh": 3e6, "ring_mesh": 2e7, "fixed": "sun", "driving": "carrier"},
    {"sun_mesh": 3e6, "ring_mesh": 2e7, "fixed": "carrier"},
    {"sun_mesh": 3e6, "ring_mesh": 9e8, "fixed": "carrier", "driving": "ring"},
    {"sun_mesh": 3e6, "ring_mesh": 9e8, "planet": [40, 20]},
    {"sun_mesh": 3e7, "ring_mesh": 2e7, "planet": [30, 12], "fixed": "sun", "driving": "ring"},
]


@pytest.mark.parametrize("changes", ELASTIC)
def test_stage_of_elastic_meshes_moves_as_its_planets_one_by_one(
    tmp_path: Any, changes: dict[str, Any]
) -> None:
    given = stage(**changes)
    every, against = planet_by_planet(given)
    alike = [one for one in every if abs(one / against - 1.0) > 1e-9]
    assert len(every) - len(alike) == given["planets"] - 1
    found = findings(tmp_path, given)
    assert [part.name for part in found.study.train.parts if part.kind == "planets"] == [
        "gear-1 planets"
    ]
    assert 2 * np.pi * found.results["modes"].frequency == pytest.approx(alike, rel=1e-12)


def train_of(given: dict[str, Any]) -> Any:
    scene = {
        "name": "planetary",
        "train": [
            {"disc": {"inertia": SHAFTS["J1"]}},
            {"coupling": {"stiffness": SHAFTS["k1"]}},
            {"gear": {"planetary": given}},
            {"coupling": {"stiffness": SHAFTS["k2"]}},
            {"disc": {"inertia": SHAFTS["J2"]}},
        ],
    }
    return torsion.parse(yaml.safe_dump(scene)).train


@pytest.mark.parametrize("driving", MEMBERS)
@pytest.mark.parametrize("fixed", MEMBERS)
def test_stage_has_all_its_modes_or_is_refused_for_meshes_of_any_stiffness(
    fixed: str, driving: str
) -> None:
    """Each mesh from 1e-3 to 1e3 times the other at the teeth: all frequencies to 1e-11, or refused at the mesh.

    A fixed member whose mesh is the softer one couples carrier and ring (or sun) by a negative inertia, which no
    network of positive springs and inertias has.
    """
    if fixed == driving:
        return
    refusals = []
    for ratio in (1e-3, 0.03, 0.5, 0.9, 1.1, 2.0, 30.0, 1e3):
        given = stage(fixed=fixed, driving=driving, sun_mesh=3e6, ring_mesh=3e6 * 16 * ratio)
        try:
            train = train_of(given)
        except InputError as error:
            (fault,) = error.faults
            assert fault.path[-1] == f"{fixed}_mesh"
            assert "softer at the teeth" in fault.message
            refusals.append(ratio)
            continue
        every, against = planet_by_planet(given)
        alike = [frequency for frequency in every if abs(frequency / against - 1.0) > 1e-9]
        modes = torsion.modes(torsion.assemble(train), count=len(alike))
        assert modes.certified
        assert 2 * np.pi * modes.frequency == pytest.approx(alike, rel=1e-11)
    softer = {"carrier": [], "ring": [1e-3, 0.03, 0.5, 0.9], "sun": [1.1, 2.0, 30.0, 1e3]}
    assert refusals == softer[fixed]


@pytest.mark.parametrize("sun_mesh", [3e6, 260e6 / 0.7, 1.23456789e5])
def test_stiffness_that_the_refusal_names_is_accepted(sun_mesh: float) -> None:
    """At the teeth a sun and a ring mesh are equal where they are as the squares of the teeth, here 1 to 16."""
    with pytest.raises(InputError, match=r"with this `sun_mesh`") as refused:
        train_of(stage(sun_mesh=sun_mesh, ring_mesh=15.9 * sun_mesh))
    named = float(str(refused.value).split("at least ")[1].split()[0])
    assert named == pytest.approx(16.0 * sun_mesh, rel=1e-4)
    train_of(stage(sun_mesh=sun_mesh, ring_mesh=named))


def test_soft_ring_beside_a_rigid_sun_is_refused_only_for_planets_with_inertia() -> None:
    with pytest.raises(InputError, match="give `sun_mesh` too"):
        train_of(stage(ring_mesh=4.8e7))
    train_of(stage(ring_mesh=4.8e7, planet_inertia=0))


@for_all(
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
        ({"planet": [40, 96]}, {}, "a planet of 96 teeth does not turn in a ring of 96"),
    ],
)
def test_what_cannot_be_is_refused(
    tmp_path: Any, given: dict[str, Any], gear: dict[str, Any], words: str
) -> None:
    made = {key: value for key, value in stage(**given).items() if value is not None}
    with pytest.raises(InputError, match=words):
        findings(tmp_path, made, **gear)


def test_stage_is_a_plain_gear_with_the_planets_at_the_carrier(tmp_path: Any) -> None:
    """Fixed ring: w_c = w_s 24/120; a planet of 36 teeth turns by 1 - 96/36 of the carrier."""
    given = stage()
    found = findings(tmp_path, given).results["modes"]
    behind = 0.9 + 4 * 6.0 * 0.12**2 + 4 * 0.03 * (1 - 96 / 36) ** 2
    scene = yaml.safe_load((tmp_path / "scene.yaml").read_text())
    scene["train"][2] = {"gear": {"ratio": 5, "inertia": [0.02, behind], "sense": 1}}
    (tmp_path / "plain.yaml").write_text(yaml.safe_dump(scene))
    plain = torsion.run(torsion.read(tmp_path / "plain.yaml")).results["modes"]
    np.testing.assert_allclose(found.frequency, plain.frequency, rtol=1e-13)
    np.testing.assert_allclose(found.torque, plain.torque, rtol=1e-11)


@for_all("changes", [*ELASTIC, {"sun_mesh": 3e6, "ring_mesh": 9e7, "planet_inertia": 0.0}])
def test_error_of_the_teeth_moves_a_stage_as_its_planets_one_by_one(
    tmp_path: Any, changes: dict[str, Any]
) -> None:
    given = stage(**changes)
    driving, fixed = given.get("driving", "sun"), given.get("fixed", "ring")
    member = "ring" if fixed == "sun" or (fixed == "carrier" and driving == "ring") else "sun"
    findings(tmp_path, given)
    scene = yaml.safe_load((tmp_path / "scene.yaml").read_text())
    scene |= {
        "excitations": [
            {
                "at": "gear-1",
                "transmission_error": "4 um",
                "base_radius": "50 mm",
                "phase": "0.7 rad",
            }
        ],
        "operation": {"speeds": {"from": "500 rpm", "to": "2000 rpm", "steps": 3}},
        "analyses": {"response": {}},
    }
    (tmp_path / "excited.yaml").write_text(yaml.safe_dump(scene))
    found = torsion.run(torsion.read(tmp_path / "excited.yaml"))
    response, names = found.results["response"], [one.name for one in found.system.spans]
    speeds = dict(zip(("sun", "ring", "carrier"), _own_speeds(given), strict=True))
    order = given[member] * abs(speeds[member] - speeds["carrier"])
    assert float(response.lines[0].order) == pytest.approx(order, rel=1e-14)
    for k in np.flatnonzero(
        response.requested
    ):  # those between lie at resonances, where digits are lost
        error = 4e-6 / 0.05 * np.exp(0.7j)
        known = mesh_torque(
            given, float(response.lines[0].order) * response.speed[k], member, error
        )
        at_driving = response.torque[k, 0, names.index("gear-1")]  # at the driving member's speed
        assert abs(at_driving - known * speeds[member]) < 1e-12 * abs(at_driving)


def _own_speeds(given: dict[str, Any]) -> list[float]:
    """Of sun, ring and carrier over that of the driving member."""
    with_sun, with_ring = given.get("planet", [(given["ring"] - given["sun"]) / 2] * 2)
    i = with_sun * given["ring"] / (with_ring * given["sun"])
    rows = np.array(
        [
            [1.0, i, -1.0 - i],
            *(
                np.eye(3)[MEMBERS.index(given.get(key, default))]
                for key, default in (("fixed", "ring"), ("driving", "sun"))
            ),
        ]
    )
    return list(np.linalg.solve(rows, [0.0, 0.0, 1.0]))


def mesh_torque(given: dict[str, Any], w: float, member: str, error: complex) -> complex:
    """N m at the member: the sum over its meshes, of planets one by one, with the error in each; no damping."""
    n = given["planets"]
    driving, fixed = given.get("driving", "sun"), given.get("fixed", "ring")
    driven = next(one for one in MEMBERS if one not in (driving, fixed))
    with_sun, with_ring = (
        mp.mpf(x) for x in given.get("planet", [(given["ring"] - given["sun"]) / 2] * 2)
    )
    steps = {"sun": with_sun / given["sun"], "ring": -with_ring / given["ring"]}
    names = [
        "a",
        *(one for one in MEMBERS if one != fixed),
        *(f"planet {k}" for k in range(n)),
        "b",
    ]
    inertia = {
        "a": SHAFTS["J1"],
        "b": SHAFTS["J2"],
        **{name: given[f"{name}_inertia"] for name in MEMBERS},
    }
    inertia["carrier"] = (
        mp.mpf(inertia["carrier"]) + n * mp.mpf(given["planet_mass"]) * mp.mpf(given["radius"]) ** 2
    )
    springs: list[tuple[dict[str, Any], Any, Any]] = [
        ({"a": 1, driving: -1}, mp.mpf(SHAFTS["k1"]), 0),
        ({driven: 1, "b": -1}, mp.mpf(SHAFTS["k2"]), 0),
    ]
    for k in range(n):
        for one, step in steps.items():
            shape = {one: mp.mpf(1), f"planet {k}": step, "carrier": -1 - step}
            springs.append(
                (shape, mp.mpf(given[f"{one}_mesh"]) / n, mp.mpc(error) if one == member else 0)
            )
    left, right = mp.matrix(len(names)), mp.matrix(len(names), 1)
    for name in names:
        own = inertia.get(name, given["planet_inertia"])
        left[names.index(name), names.index(name)] -= mp.mpf(w) ** 2 * mp.mpf(own)
    for shape, stiffness, own_error in springs:
        free = [(names.index(name), value) for name, value in shape.items() if name in names]
        for i, x in free:
            right[i] += stiffness * x * own_error
            for j, y in free:
                left[i, j] += stiffness * x * y
    angle = mp.lu_solve(left, right)
    total = mp.mpc(0)
    for shape, stiffness, own_error in springs[2:]:
        if member in shape:
            twist = sum(
                value * angle[names.index(name)] for name, value in shape.items() if name in names
            )
            total += stiffness * (twist - own_error)
    return complex(total)
