"""Excitation at a gear mesh against the equations of motion written out, in 40 digits, complex with complex."""

import math
from collections.abc import Iterator
from fractions import Fraction
from typing import Any

import mpmath as mp
import numpy as np
import pytest
import yaml
from tests.for_all import for_all

import torsion
from torsion.errors import InputError
from torsion.schema.scene_reader import parse

J = {"motor": 3.0, "pinion": 0.05, "wheel": 0.6, "aux": 0.2, "load": 8.0}  # kg m2
K1, C1, K2 = 2.0e5, 12.0, 9.0e5  # N m/rad, N m s/rad
R1, R2 = Fraction(23, 57), Fraction(23, 41)  # speed of the wheels over that of the pinion
SPEEDS = {"from": "300 rpm", "to": "1500 rpm", "steps": 7}


@pytest.fixture(autouse=True)
def _digits() -> Iterator[None]:
    with mp.workdps(40):
        yield


def scene(mesh: float | None, second: float | None, **excitation: Any) -> dict[str, Any]:
    gear: dict[str, Any] = {
        "name": "box",
        "teeth": [23, 57],
        "inertia": [J["pinion"], J["wheel"]],
        "module": "5 mm",
        "helix_angle": "12 deg",
        "branches": [{"teeth": 41, "train": [{"disc": {"name": "aux", "inertia": J["aux"]}}]}],
    }
    if mesh is not None:
        gear["mesh_stiffness"] = mesh
    if second is not None:
        gear["branches"][0]["mesh_stiffness"] = second
    return {
        "name": "mesh",
        "train": [
            {"motor": {"name": "motor", "inertia": J["motor"]}},
            {"coupling": {"stiffness": K1, "viscous": C1}},
            {"gear": gear},
            {"coupling": {"stiffness": K2, "loss_factor": 0.02}},
            {"disc": {"name": "load", "inertia": J["load"]}},
        ],
        "operation": {"speeds": SPEEDS},
        "excitations": [{"at": "box", **excitation}],
        "analyses": {"response": {}},
    }


def solved(given: dict[str, Any]) -> Any:
    return torsion.run(parse(yaml.safe_dump(given), "mesh.yaml"))


def dense(w: float, mesh: float | None, second: float | None, error: complex) -> dict[str, complex]:
    """Torques of both meshes and couplings (at the driving side), unknowns angles and the torques of the meshes.

    Each mesh: torque/k = driving - driven/ratio - error, with 1/k = 0 of a rigid one.
    """
    names = ("motor", "pinion", "wheel", "aux", "load")
    a, b = mp.matrix(7, 7), mp.matrix(7, 1)
    iw = mp.mpc(0, w)
    for k, name in enumerate(names):
        a[k, k] += iw * iw * mp.mpf(J[name])
    k1, k2 = mp.mpf(K1) + iw * mp.mpf(C1), mp.mpf(K2) * mp.mpc(1, mp.mpf(0.02))
    for i, j, k in ((0, 1, k1), (2, 4, k2)):
        a[i, i] += k
        a[j, j] += k
        a[i, j] -= k
        a[j, i] -= k
    for row, driven, ratio, stiffness, own in ((5, 2, R1, mesh, error), (6, 3, R2, second, 0)):
        inverse = mp.mpf(ratio.denominator) / ratio.numerator
        a[1, row] += 1  # the mesh takes its torque from the pinion
        a[driven, row] -= inverse
        a[row, 1], a[row, driven] = 1, -inverse
        a[row, row] = 0 if stiffness is None else -1 / mp.mpf(stiffness)
        b[row] = mp.mpc(own)
    x = mp.lu_solve(a, b)
    return {
        "first": complex(k1 * (x[0] - x[1])),
        "box": complex(x[5]),
        "box wheel 2": complex(x[6]),
        "last": complex(k2 * (x[2] - x[4])),
    } | {name: complex(x[k]) for k, name in enumerate(names)}


def compared(
    found: Any, mesh: float | None, second: float | None, error: complex, order: Fraction
) -> float:
    """Worst relative difference of any torque at any speed."""
    response, system = found.results["response"], found.system
    assert [line.order for line in response.lines] == [order]
    names = {span.name: k for k, span in enumerate(system.spans)}
    at = {
        "first": names["coupling-1"],
        "last": names["coupling-2"],
        **{n: names[n] for n in ("box", "box wheel 2")},
    }
    worst = 0.0
    for k in np.linspace(0, response.speed.size - 1, 9).astype(int):
        known = dense(float(order) * response.speed[k], mesh, second, error)
        for name, span in at.items():
            worst = max(worst, abs(response.torque[k, 0, span] - known[name]) / abs(known[name]))
        for station in ("motor", "load", "aux"):
            place = next(i for i, one in enumerate(system.stations) if one.name == station)
            worst = max(
                worst, abs(response.angle[k, 0, place] - known[station]) / abs(known[station])
            )
    return worst


@pytest.mark.parametrize("mesh", [4e6, 1e16, None])
@pytest.mark.parametrize("second", [3e6, None])
def test_transmission_error_moves_the_train_as_its_equations_say(
    mesh: float | None, second: float | None
) -> None:
    found = solved(scene(mesh, second, transmission_error="30 urad", phase="0.4 rad"))
    assert compared(found, mesh, second, 30e-6 * np.exp(0.4j), Fraction(23)) < 1e-12


def test_error_along_the_line_of_action_is_an_angle_at_the_base_circle() -> None:
    found = solved(scene(4e6, None, transmission_error="3 um", harmonic=2))
    transverse = math.atan(math.tan(math.radians(20)) / math.cos(math.radians(12)))
    radius = 0.5 * 0.005 * 23 / math.cos(math.radians(12)) * math.cos(transverse)
    assert compared(found, 4e6, None, 3e-6 / radius, Fraction(46)) < 1e-12
    given = solved(scene(4e6, None, transmission_error="3 um", base_radius="60 mm", order=1))
    assert compared(given, 4e6, None, 3e-6 / 0.06, Fraction(1)) < 1e-12


def test_torque_of_a_blocked_mesh_is_its_error_times_its_stiffness() -> None:
    assert (
        compared(solved(scene(4e6, None, torque=120.0)), 4e6, None, 120.0 / 4e6, Fraction(23))
        < 1e-12
    )


def test_error_of_a_further_wheel_excites_at_its_own_mesh() -> None:
    given = scene(4e6, 3e6, transmission_error="30 urad")
    given["excitations"][0]["at"] = "box wheel 2"
    swapped = solved(given).results["response"]
    first = solved(scene(4e6, 3e6, transmission_error="30 urad")).results["response"]
    # what the error of one mesh makes in the other is what the other's makes in the one (Maxwell, Betti)
    names = {span.name: k for k, span in enumerate(first.system.spans)}
    shared = np.intersect1d(first.speed, swapped.speed)
    one = first.torque[np.isin(first.speed, shared), 0, names["box wheel 2"]]
    other = swapped.torque[np.isin(swapped.speed, shared), 0, names["box"]]
    assert shared.size >= 7
    np.testing.assert_allclose(one, other, rtol=1e-12)


def test_mesh_that_closes_a_loop_takes_its_error_too() -> None:
    """A locked train, the loop's softest span being the mesh: against the same with its halves the other way round."""
    each = []
    for soft in (1e5, 4e7):  # the mesh is what closes the loop, or part of the tree
        side = [{"disc": {"name": "idler", "inertia": 0.1}}]
        gear = {
            "name": "box",
            "teeth": [23, 57],
            "mesh_stiffness": soft,
            "branches": [{"teeth": 57, "mesh_stiffness": 3e6, "train": side}],
        }
        given = {
            "name": "locked",
            "train": [
                {"disc": {"name": "a", "inertia": 2.0}},
                {"coupling": {"stiffness": 2e5, "viscous": 9.0}},
                {"gear": gear},
                {"disc": {"name": "bull", "inertia": 5.0}},
            ],
            "links": [{"between": ["idler", "bull"], "coupling": {"stiffness": 4e6}}],
            "operation": {"speeds": SPEEDS},
            "excitations": [{"at": "box", "transmission_error": "30 urad"}],
            "analyses": {"response": {}},
        }
        found = solved(given)
        response = found.results["response"]
        chords = {found.system.spans[k].name for k in found.system.condensed.extra}
        each.append(chords)
        span = {one.name: k for k, one in enumerate(found.system.spans)}
        r = mp.mpf(23) / 57
        for k in (0, response.speed.size // 2, response.speed.size - 1):
            iw = mp.mpc(0, 23 * response.speed[k])
            a, b = mp.matrix(4, 4), mp.matrix(4, 1)
            for i, inertia in enumerate((2.0, 0.0, 0.1, 5.0)):
                a[i, i] += iw * iw * mp.mpf(inertia)
            spans = [
                ({0: 1, 1: -1}, 2e5 + 9 * iw, 0),
                ({1: 1, 3: -1 / r}, mp.mpf(soft), mp.mpf(30e-6)),
                ({1: 1, 2: -1 / r}, mp.mpf(3e6), 0),
                ({2: 1, 3: -1}, mp.mpf(4e6), 0),
            ]
            for shape, stiffness, error in spans:
                for i, x in shape.items():
                    b[i] += x * stiffness * error
                    for j, y in shape.items():
                        a[i, j] += x * stiffness * y
            angle = mp.lu_solve(a, b)
            torque = complex(mp.mpf(soft) * (angle[1] - angle[3] / r - mp.mpf(30e-6)))
            assert response.torque[k, 0, span["box"]] == pytest.approx(torque, rel=1e-11)
    assert each[0] != each[1]


def test_harmonic_component_is_named_by_its_mesh() -> None:
    found = solved(
        scene(4e6, None, transmission_error="30 urad") | {"analyses": {"response": {}, "modes": {}}}
    )
    assert found.results["response"].lines[0].named("motor") == "23 × mesh of box"
    crossings = found.results["critical_speeds"].crossings
    assert {one.order for one in crossings} == {Fraction(23)}


@for_all(
    ("changes", "words"),
    [
        ({"torque": 5.0, "transmission_error": "3 um"}, "exclude each other"),
        ({}, "`torque` or `transmission_error` is missing"),
        ({"transmission_error": "3 um", "frequency": 5}, "excites by its teeth"),
        ({"transmission_error": "3 um", "order": 2, "harmonic": 2}, "exclude each other"),
        ({"transmission_error": "3 mm"}, "usual"),
        ({"transmission_error": "3 urad", "base_radius": 0.1}, "needs no `base_radius`"),
        ({"torque": {"of_mean": "3 %"}}, "one amplitude"),
        ({"torque": 5.0, "at": "motor", "harmonic": 2}, "no teeth"),
        ({"transmission_error": "3 um", "at": "aux"}, "no teeth"),
    ],
)
def test_what_says_no_excitation_of_a_mesh_is_refused(changes: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError, match=words):
        solved(scene(4e6, None, **changes))


def test_rigid_mesh_takes_an_error_and_no_torque() -> None:
    with pytest.raises(InputError, match="rigid, moves nothing"):
        solved(scene(None, None, torque=5.0))


def test_gear_without_teeth_needs_an_order() -> None:
    given = scene(4e6, None, transmission_error="3 urad")
    gear = given["train"][2]["gear"]
    for key in ("teeth", "module", "branches", "helix_angle"):
        del gear[key]
    gear["ratio"] = 2
    with pytest.raises(InputError, match="give `order`"):
        solved(given)
    given["excitations"][0] |= {"transmission_error": "3 um", "order": 20}
    with pytest.raises(InputError, match="size of 'box' is not known"):
        solved(given)


@pytest.mark.parametrize(
    ("analyses", "damping"),
    [
        ({"transient": {"duration": "1 s", "initial": "steady"}}, None),
        ({"modes": {}}, {"modal": "1 %"}),
    ],
)
def test_analyses_that_take_no_mesh_excitation_refuse_it(
    analyses: dict[str, Any], damping: Any
) -> None:
    given = scene(4e6, None, transmission_error="3 urad") | {"analyses": analyses}
    if damping is not None:
        given["damping"] = damping
        for part in given["train"]:
            part.get("coupling", {}).pop("viscous", None)
            part.get("coupling", {}).pop("loss_factor", None)
    with pytest.raises(InputError, match=r"at a mesh|a mesh that excites"):
        solved(given)
