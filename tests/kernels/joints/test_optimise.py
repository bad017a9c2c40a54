"""Best phases, planes and angles: closed form of two joints, bounds of many, and what a degree of assembly costs."""

import numpy as np
import pytest

from torsion.kernels.joints import cross, line
from torsion.kernels.joints.line import index_over, optimise

MA = line.line_of(np.radians([15.0, 20.0]), np.radians([0.0, 10.0]), np.radians([0.0, 55.0]))


def close(found: object, expected: object, relative: float = 1e-13) -> None:
    np.testing.assert_allclose(
        np.asarray(found, dtype=float), np.asarray(expected, dtype=float), rtol=relative, atol=0.0
    )


def test_ma_2011_best_phase_is_ten_degrees() -> None:
    found = optimise(MA)
    close(np.degrees(found.line.phase[1]), 10.0)
    close(found.after.index, 0.0550754069904797)
    close(found.before.index, 0.142564571917204)
    close(
        1.0 - float(found.after.index / found.before.index),
        1.0 - 0.0550754069904797 / 0.142564571917204,
    )
    cosine = np.cos(MA.angle)
    close(found.after.index, abs(cosine[0] / cosine[1] - cosine[1] / cosine[0]))


def test_best_plane_is_the_phase() -> None:
    found = optimise(MA, "plane")
    close(np.degrees(found.line.plane[1]), 55.0)
    close(found.after.index, 0.0550754069904797)


@pytest.mark.parametrize("given", [-200.0, 11.0, 99.0, 101.0, 300.0])
def test_the_best_phase_nearest_to_the_given_one_is_chosen(given: float) -> None:
    case = line.line_of(MA.angle, MA.plane, np.radians([0.0, given]))
    best = np.degrees(optimise(case).line.phase[1])
    assert abs(best - given) <= 90.0
    assert abs((best - 10.0) / 180.0 - round((best - 10.0) / 180.0)) < 1e-13


def test_no_phase_of_a_fine_grid_is_better_than_the_closed_form() -> None:
    curve = index_over(MA, "phase", 1, np.radians(np.linspace(0.0, 180.0, 721)))
    close(curve.min(), optimise(MA).after.index)
    close(curve[220], 0.142564571917204)
    close(curve[400], 0.194044528375804)


@pytest.mark.parametrize("joint", [0, 1])
def test_best_angle_of_a_joint_beats_its_neighbours(joint: int) -> None:
    found = optimise(MA, "angle", [joint])
    around = found.line.angle[joint] + np.linspace(-0.1, 0.1, 2001)
    assert found.after.index <= index_over(found.line, "angle", joint, around).min() * (1.0 + 1e-13)


def test_best_angle_of_joints_in_line_is_the_other_s() -> None:
    case = line.line_of(np.radians([15.0, 20.0]))
    close(np.degrees(optimise(case, "angle", [1]).line.angle[1]), 15.0)
    crossed = line.line_of(np.radians([15.0, 20.0]), 0.0, np.radians([0.0, 90.0]))
    assert optimise(crossed, "angle", [1]).line.angle[1] < 1e-7


@pytest.mark.parametrize("joints", [3, 4, 5])
@pytest.mark.parametrize("variable", ["phase", "plane"])
def test_phases_or_planes_of_many_joints_close_the_polygon_of_rapidities(
    variable: str, joints: int
) -> None:
    rng = np.random.default_rng(joints)
    for _ in range(3):
        case = line.line_of(rng.uniform(0.2, 0.3, joints), 0.0, rng.uniform(-2.0, 2.0, joints))
        found = optimise(case, variable)
        assert found.after.rapidity < 1e-12
        assert 1.0 - float(found.after.index / found.before.index) > 1.0 - 1e-10


@pytest.mark.parametrize("joints", [3, 4])
def test_a_polygon_that_cannot_close_leaves_the_greatest_less_the_others(joints: int) -> None:
    rng = np.random.default_rng(7)
    case = line.line_of([0.2, 0.7, *(0.25,) * (joints - 2)], 0.0, rng.uniform(-2.0, 2.0, joints))
    found = optimise(case)
    rapidity = cross.rapidity(case.angle)
    close(found.after.rapidity, 2.0 * rapidity.max() - rapidity.sum(), 1e-9)


def test_one_phase_of_three_joints_beats_a_fine_grid() -> None:
    case = line.line_of([0.3, 0.5, 0.4], [0.0, 0.4, 1.1], [0.0, 0.2, 0.9])
    found = optimise(case, "phase", [2])
    assert found.after.index <= index_over(
        case, "phase", 2, np.linspace(0.0, np.pi, 3601)
    ).min() * (1.0 + 1e-12)


def test_best_angle_of_a_third_joint_beats_a_fine_grid() -> None:
    case = line.line_of([0.3, 0.5, 0.4], [0.0, 0.4, 1.1], [0.0, 0.2, 2.9])
    found = optimise(case, "angle", [2])
    grid = index_over(case, "angle", 2, np.linspace(0.0, 1.0, 20_001))
    assert found.after.index <= grid.min() * (1.0 + 1e-12)


def test_a_degree_of_assembly_error_costs_what_the_law_of_cosines_says() -> None:
    case, degree = line.line_of([0.3, 0.3], [0.0, 0.2], [0.0, 1.0]), np.pi / 180.0
    (cost,) = optimise(case).sensitivity
    close(
        cost,
        2.0 * np.sinh(2.0 * np.arcsinh(np.sin(0.3) ** 2 * np.sin(degree) / (2.0 * np.cos(0.3)))),
        1e-12,
    )
    (angle,) = optimise(line.line_of([0.3, 0.4]), "angle", [1]).sensitivity
    close(angle, 2.0 * np.sinh(cross.rapidity(0.3 + degree) - cross.rapidity(0.3)), 1e-12)


@pytest.mark.parametrize(("case", "joints"), [(MA, [0]), (line.line_of([0.3]), None), (MA, [])])
def test_a_line_with_nothing_to_choose_is_refused(
    case: line.Line, joints: list[int] | None
) -> None:
    with pytest.raises(ValueError, match="to choose"):
        optimise(case, "phase", joints)
