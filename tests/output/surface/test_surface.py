"""The train as a surface: true dimensions, wheels that touch, bodies that do not overlap, angles between stations."""

import itertools
from dataclasses import replace

import numpy as np
import pytest

import torsion
from torsion.analyses.undamped_modes import Modes
from torsion.assembly.system import System
from torsion.findings import Findings
from torsion.output.surface.axes import axes
from torsion.output.surface.surface import Rings, Surface, angles, surface, torques, turned
from torsion.output.surface.surface import rings as rings_of
from torsion.primitives import Section

AROUND = 48
SHAFT = """
name: shaft
materials: {{light: {{shear_modulus: 80 GPa, density: 0}}}}
train:
  - disc: {{inertia: 2}}
  - shaft: {{length: 1.5 m, material: light, {}}}
  - disc: {{inertia: 3}}
"""
TRAINS = {
    "gear with two branches": "{gear: {teeth: [20, 41], branches: ["
    "{teeth: 30, inertia: 0.1, train: [{shaft: {length: 0.5 m, diameter: 50 mm}}, {disc: {inertia: 0.3}}]}, "
    "{teeth: 10, inertia: 0.1, train: [{coupling: {stiffness: 1e4}}, {disc: {inertia: 9}}]}]}}",
    "branch on a branch": "{disc: {inertia: 1}}, {branch: {train: [{coupling: {stiffness: 1e5}}, {disc: {inertia: 5}}, "
    "{branch: {train: [{shaft: {length: 1 m, diameter: 30 mm}}, {disc: {inertia: 0.02}}]}}]}}",
    "many wheels": "{gear: {teeth: [20, 60], branches: ["
    + ", ".join(
        "{teeth: 70, inertia: 1, train: [{coupling: {stiffness: 1e4}}, {disc: {inertia: 9}}]}" for _ in range(9)
    )
    + "]}}",
    "step up": "{gear: {ratio: 1/12}}, {coupling: {stiffness: 1e4}}, {disc: {inertia: 1}}, {gear: {ratio: 5}}",
}


def all_rings(system: System) -> Rings:
    return rings_of(system, axes(system))


def solved(text: str) -> Findings:
    return torsion.run(torsion.parse(text))


def around(middle: str) -> Findings:
    """A train with `middle` between two shafts."""
    shaft = "{{shaft: {{length: {} m, diameter: 80 mm}}}}"
    return solved(
        f"name: x\ntrain: [{{motor: {{name: first, inertia: 2}}}}, {shaft.format(0.6)}, {middle}, "
        f"{shaft.format(2)}, {{propeller: {{name: last, inertia: 4, diameter: 1 m}}}}]\n"
        + ("links: [{between: [near, last], coupling: {stiffness: 1e4}}]\n" if "near" in middle else "")
    )


def volume(made: Surface, cells: np.ndarray) -> float:
    """Of a closed surface, by the divergence theorem."""
    total = 0.0
    for k in range(1, cells.shape[1] - 1):
        a, b, c = (made.points[cells[:, j]] for j in (0, k, k + 1))
        total += float(np.einsum("ij,ij->", a, np.cross(b, c))) / 6.0
    return total


@pytest.mark.parametrize("diameters", [(60, 60), (90, 60)])
def test_a_shaft_has_its_true_volume_with_its_normals_outward(diameters: tuple[int, int]) -> None:
    found = solved(SHAFT.format(f"diameter: [{diameters[0]} mm, {diameters[1]} mm]"))
    rings = all_rings(found.system)
    made = surface(rings, AROUND)
    mine = np.flatnonzero(rings.part == 1)
    quads, triangles = (made.strip[part] for part in (slice(None, len(made.quads)), slice(len(made.quads), None)))
    inside = volume(made, made.quads[np.isin(quads, mine)]) + volume(made, made.triangles[np.isin(triangles, mine)])
    r, s = diameters[0] / 2e3, diameters[1] / 2e3
    polygon = AROUND / 2 * np.sin(2 * np.pi / AROUND)  # area of the polygon in a circle of radius 1
    assert inside == pytest.approx(polygon * 1.5 * (r * r + r * s + s * s) / 3, rel=1e-12)


def test_a_tube_is_closed_by_an_annulus_at_either_end() -> None:
    rings = all_rings(solved(SHAFT.format("diameter: 60 mm, bore: [40 mm, 20 mm]")).system)
    mine = rings.strip[rings.part == 1]
    np.testing.assert_allclose(rings.radius[[mine[0], mine[1], mine[-1], mine[-1] + 1]], [0.02, 0.03, 0.03, 0.01])
    assert rings.x[mine[0]] == rings.x[mine[1]]


def test_every_solid_body_is_closed() -> None:
    rings = all_rings(around(TRAINS["gear with two branches"]).system)
    made = surface(rings, AROUND)
    edges = {
        tuple(sorted((int(cell[k]), int(cell[k - 1]))))
        for cells in (made.quads, made.triangles)
        for cell in cells
        for k in range(cells.shape[1])
    }
    bodies = int(rings.body[-1]) + 1
    assert len(made.points) - len(edges) + len(made.quads) + len(made.triangles) == 2 * bodies  # Euler


@pytest.mark.parametrize("name", TRAINS)
def test_no_two_bodies_overlap(name: str) -> None:
    placed = axes(around(TRAINS[name]).system)
    assert len(placed) > 1
    for one, other in itertools.combinations(placed, 2):
        distance = np.hypot(*np.subtract(one.place, other.place))
        for a, b in itertools.product(one.boxes, other.boxes):
            if a[0] < b[1] - 1e-9 and b[0] < a[1] - 1e-9:
                assert distance >= (a[2] + b[2]) * (1 - 1e-12), f"{a} and {b}"


def test_bodies_of_an_axis_follow_one_another() -> None:
    for axis in axes(around(TRAINS["branch on a branch"]).system):
        ends = [(body.x[0], body.x[-1]) for body in axis.bodies]
        assert all(first[1] == second[0] for first, second in itertools.pairwise(ends))


def test_wheels_touch_and_roll_on_each_other_without_slip() -> None:
    found = around("{gear: {teeth: [20, 41], branches: [{teeth: 30, inertia: 0.1}]}}")
    wheels = [(axis, body) for axis in axes(found.system) for body in axis.bodies if body.part == 2]
    (first, driving), *others = wheels
    rings = all_rings(found.system)
    drawn = turned(rings, angles(rings, found.need(Modes), 1))
    for other, driven in others:
        assert np.hypot(*np.subtract(first.place, other.place)) == pytest.approx(
            driving.widest + driven.widest, rel=1e-12
        )
        spin = [float(drawn[(rings.x == body.x[3]) & (rings.radius == body.widest)][0]) for body in (driving, driven)]
        assert driving.widest * spin[0] == pytest.approx(-driven.widest * spin[1], rel=1e-12)


def test_a_massless_uniform_shaft_twists_linearly_and_is_stressed_by_its_torque() -> None:
    found = solved(SHAFT.format("diameter: 60 mm"))
    rings = all_rings(found.system)
    mine = rings.strip[rings.part == 1][1:-1]
    angle, (first, last) = angles(rings, found.need(Modes), 0), found.need(Modes).shape[:2, 0]
    place = (rings.x[mine] - rings.x[mine[0]]) / 1.5
    np.testing.assert_allclose(angle[mine], first + (last - first) * place, rtol=0, atol=1e-14 * abs(first))
    stress = (torques(rings, found.need(Modes), 0) / rings.modulus)[rings.part == 1]
    expected = 80e9 * (first - last) / 1.5 * 0.03  # G times twist a metre times radius
    np.testing.assert_allclose(stress, expected, rtol=1e-13)


def test_a_massless_cone_twists_by_the_integral_of_its_flexibility() -> None:
    found = solved(SHAFT.format("diameter: [90 mm, 45 mm]"))
    rings = all_rings(found.system)
    mine = rings.strip[rings.part == 1][1:]
    angle, (first, last) = angles(rings, found.need(Modes), 0)[mine], found.need(Modes).shape[:2, 0]
    cube = rings.radius[mine] ** -3.0  # the integral of d^-4 along a cone goes with d^-3
    np.testing.assert_allclose((angle - first) / (last - first), (cube - cube[0]) / (cube[-1] - cube[0]), atol=1e-6)


@pytest.mark.parametrize("phase", [1e-6, 1.0, 2.5])
def test_between_stations_of_a_distributed_shaft_stands_the_wave(phase: float) -> None:
    found = solved(SHAFT.format("diameter: 60 mm"))
    omega = 2 * np.pi * found.need(Modes).frequency[0]
    rings = all_rings(found.system)
    mine = rings.strip[rings.part == 1][1:]
    wave = replace(rings, delay=np.full(rings.x.size, phase / omega))
    shape = np.array([[np.cos(0.3)], [np.cos(0.3 + phase)]])
    place = (rings.x[mine] - rings.x[mine[0]]) / 1.5
    got = angles(wave, replace(found.need(Modes), shape=shape), 0)[mine]
    np.testing.assert_allclose(got, np.cos(0.3 + phase * place), rtol=0, atol=1e-14)


def test_a_point_turns_as_one_and_what_is_held_stands_still() -> None:
    found = solved(
        "name: x\ntrain: [{disc: {held: true}}, {coupling: {stiffness: 5}}, {disc: {inertia: 1}}, {disc: {inertia: 2}},"
        " {coupling: {stiffness: 5}}, {damper: {housing: 1, ring: 2, damping: 3, stiffness: 4}}]"
    )
    rings = all_rings(found.system)
    angle = angles(rings, found.need(Modes), 1)
    for body in np.unique(rings.body):
        mine = rings.strip[rings.body == body]
        part = found.system.train.parts[int(rings.part[rings.body == body][0])]
        if part.is_point:
            assert np.ptp(angle[np.append(mine, mine[-1] + 1)]) == 0.0
    assert angle[0] == 0.0
    assert {"disc-2", "disc-3"} == {found.system.train.parts[p].name for p in (2, 3)}
    assert angle[rings.strip[rings.part == 2][0]] == pytest.approx(angle[rings.strip[rings.part == 3][0]], rel=1e-14)


def test_many_segments_are_drawn_with_few_rings() -> None:
    found = solved(SHAFT.format("diameter: [60 mm, 50 mm], segments: 5000").replace("density: 0", "density: 7850"))
    rings = all_rings(found.system)
    assert np.count_nonzero(rings.part == 1) < 250
    mine = rings.strip[rings.part == 1][1:-1]
    stations = found.need(Modes).shape[:, 0]
    assert {float(a) for a in angles(rings, found.need(Modes), 0)[mine]} <= {float(a) for a in stations}


def test_a_shaft_of_the_exact_model_shows_the_closed_form_between_its_stations() -> None:
    text = SHAFT.format("diameter: 60 mm").replace("density: 0", "density: 7850")
    found = solved(text + "analyses: {model: exact, modes: {count: 4}}\n")
    rings = all_rings(found.system)
    mine = rings.strip[rings.part == 1][1:]
    for mode, frequency in enumerate(found.need(Modes).frequency.tolist()):
        omega = 2 * np.pi * frequency
        number, place = omega * np.sqrt(7850 / 80e9), rings.x[mine] - rings.x[mine[0]]
        rigidity = 80e9 * np.pi / 32 * 0.06**4
        angle = angles(rings, found.need(Modes), mode)[mine]
        # a disc of 2 kg m2 turns the end of the shaft: G I angle' = -omega^2 J angle
        wave = np.cos(number * place) - 2 * omega**2 / (rigidity * number) * np.sin(number * place)
        np.testing.assert_allclose(angle, angle[0] * wave, rtol=0, atol=1e-12 * np.abs(angle).max())


def test_a_section_of_any_outline_is_not_to_scale_and_has_its_own_stress() -> None:
    system = solved(SHAFT.format("diameter: 60 mm")).system
    bar = replace(system.train.bars[0], section=Section(1e-6, 2e-6, 3e-5))
    rings = all_rings(replace(system, train=replace(system.train, bars=(bar,))))
    assert set(rings.modulus[rings.part == 1]) == {3e-5}
    assert not rings.to_scale.any()
