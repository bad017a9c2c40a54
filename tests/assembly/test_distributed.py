"""Shafts as finite elements and as continua: matrices, division, what is imported."""

import subprocess
import sys

import numpy as np
import pytest

import torsion
from torsion.assembly.element_matrices import element_law, element_matrices
from torsion.assembly.fem import element_error, phase_error, section_error
from torsion.assembly.matrices import matrices
from torsion.errors import InputError, SolveError
from torsion.kernels.distributed.finite_elements import condensed_elements
from torsion.kernels.round_sections import polar_area_moment

G, RHO = 80e9, 8000.0
TRAIN = """
name: geared
materials: {{round: {{shear_modulus: 80 GPa, density: 8000, loss_factor: 0.03}}}}
train:
- disc: {{name: a, inertia: 1}}
- shaft: {{name: first, length: 2, diameter: {first}, bore: 10 mm, material: round}}
- gear: {{ratio: 2, inertia: [0.02, 0.3]}}
- shaft: {{name: second, length: 1, diameter: 60 mm, material: round}}
- disc: {{name: b, inertia: 2}}
"""
UNIFORM, CONE = TRAIN.format(first="60 mm"), TRAIN.format(first="[60 mm, 90 mm]")


def system(text: str, model: str, **settings):
    return torsion.assemble(torsion.parse(text).train, model, **settings)


def test_linear_elements_of_a_uniform_shaft_are_those_of_every_book():
    bars = system(UNIFORM, "fem", degree=1, elements=4).bars
    area = float(polar_area_moment(0.06, 0.01))
    k, m = G * area / 0.5, RHO * area * 0.5 / 6.0
    stiffness, inertia = element_matrices(bars.pieces, bars.degree)
    np.testing.assert_allclose(stiffness[0], k * np.array([[1, -1], [-1, 1]]), rtol=1e-15)
    np.testing.assert_allclose(inertia[0], m * np.array([[2, 1], [1, 2]]), rtol=1e-15)


@pytest.mark.parametrize("degree", range(1, 11))
@pytest.mark.parametrize("text", [UNIFORM, CONE], ids=["uniform", "cone"])
def test_an_element_turned_as_a_whole_has_the_inertia_of_its_piece_and_no_torque(text, degree):
    bars = system(text, "fem", degree=degree, elements=3).bars
    turned = np.zeros(degree + 1)
    turned[: 3 if degree == 2 else 2] = 1.0  # the middle node of degree 2 turns too, bubbles do not
    stiffness, inertia = element_matrices(bars.pieces, bars.degree)
    torque = stiffness @ turned
    np.testing.assert_allclose(
        torque / np.abs(stiffness).max(axis=(1, 2))[:, None], 0.0, atol=2e-14
    )
    x, weight = np.polynomial.legendre.leggauss(20)
    whole = [
        RHO * piece.length / 2.0 * piece.polar_area_moment((x + 1) / 2) @ weight
        for piece in bars.pieces
    ]
    np.testing.assert_allclose(turned @ inertia @ turned, whole, rtol=3e-15)


@pytest.mark.parametrize("model", ["fem", "exact"])
def test_every_model_has_the_same_inertia_and_the_same_static_flexibility(model):
    lumped, other = system(CONE, "lumped", frequency=500.0), system(CONE, model, frequency=500.0)
    ratio2 = other.speed_ratio**2
    assert other.inertia @ ratio2 == pytest.approx(
        lumped.inertia @ lumped.speed_ratio**2, rel=1e-14
    )
    for name in ("first", "second"):
        part = other.train[name]
        whole = [
            sum(
                h
                for h, span in zip(one.flexibility, one.spans, strict=True)
                if one.train.parts[span.part].name == name
            )
            for one in (lumped, other)
        ]
        assert whole[1] == pytest.approx(whole[0], rel=1e-14)
        end = next(span for span in other.spans if span.name == f"{name}, driven end")
        assert other.train.parts[end.part] is part
        assert end.driven == part.stations[1]


def test_a_massless_shaft_is_a_spring_in_every_model():
    text = UNIFORM.replace("density: 8000", "density: 0")
    lumped = system(text, "lumped")
    for model in ("fem", "exact"):
        found = system(text, model)
        assert found.condensed_shafts is None
        np.testing.assert_array_equal(found.flexibility, lumped.flexibility)


def test_the_least_number_of_pieces_is_that_of_the_shaft_itself():
    text = UNIFORM.replace("length: 1,", "length: 1, segments: 7,")
    assert system(text, "exact").segments == {"first": 4, "second": 7}
    assert system(text, "fem").segments == {"first": 4, "second": 7}
    assert system(text, "fem", elements=2).segments == {"first": 2, "second": 7}


def test_pieces_of_a_continuum_are_a_radian_long_at_the_highest_frequency():
    wave = np.sqrt(G / RHO)
    frequency = 25.2 * wave / 2.0 / (2.0 * np.pi)  # 25.2 rad along the first shaft
    assert system(UNIFORM, "exact", frequency=frequency).segments == {"first": 26, "second": 13}


def test_the_error_of_linear_elements_is_a_24th_of_the_square_of_the_phase():
    assert phase_error(1, 0.1) == pytest.approx(0.01 / 24.0, rel=1e-15)


@pytest.mark.parametrize("degree", range(1, 11))
def test_division_keeps_the_estimate_below_a_millionth(degree):
    bars = torsion.parse(CONE).train.bars
    found = system(CONE, "fem", frequency=400.0, degree=degree)
    errors = [element_error(bar, found.segments[bar.name], degree, 400.0) for bar in bars]
    assert found.bars.error == max(errors) <= 1e-6
    if degree < 3:  # one element less would not do, in one of the shafts
        assert (
            max(element_error(bar, found.segments[bar.name] - 1, degree, 400.0) for bar in bars)
            > 0.9e-6
        )


def test_the_estimate_for_a_varying_section_falls_with_the_power_2p():
    cone = torsion.parse(CONE).train.bars[0]
    for degree in (1, 2, 3):
        rate = np.log2(section_error(cone, 16, degree) / section_error(cone, 32, degree))
        assert rate == pytest.approx(2 * degree, abs=0.05)


def test_the_degree_follows_from_a_given_number_of_elements():
    assert system(UNIFORM, "fem", frequency=400.0, elements=40).bars.degree == 4
    few = system(UNIFORM, "fem", frequency=1500.0, elements=2)
    assert few.bars.degree > 4
    assert few.bars.error <= 1e-6


@pytest.mark.parametrize("degree", [1, 2, 5])
def test_the_matrices_in_full_have_the_inertia_of_the_train_and_no_stiffness_against_turning(
    degree,
):
    found = system(CONE, "fem", degree=degree, elements=3)
    view = matrices(found)
    free = 8 - 1  # four stations of the train with the gear as one, two inside of each shaft
    assert view.inertia.shape == view.stiffness.shape == (free + 6 * (degree - 1),) * 2
    assert len(view.names) == len(view.stiffness)
    turned = np.full(len(view.names), 1.0 if degree == 2 else 0.0)
    turned[:free] = 1.0
    np.testing.assert_allclose(
        view.stiffness @ turned, 0.0, atol=1e-14 * np.abs(view.stiffness).max()
    )
    assert turned @ view.inertia @ turned == pytest.approx(
        found.inertia @ found.speed_ratio**2, rel=1e-14
    )
    np.testing.assert_allclose(
        view.loss, 0.03 * view.stiffness, rtol=1e-13, atol=1e-15 * np.abs(view.stiffness).max()
    )


def test_the_exact_model_refuses_to_write_matrices():
    with pytest.raises(InputError, match="no constant matrices"):
        matrices(system(UNIFORM, "exact"))


@pytest.mark.parametrize("model", ["fem", "exact"])
def test_closed_loops_are_refused_in_words(model):
    text = UNIFORM + "- coupling: {stiffness: 1}\n- disc: {name: c, inertia: 1}\n"
    text += "links: [{between: [b, c], coupling: {stiffness: 2}}]\n"
    with pytest.raises(SolveError, match="closed loops"):
        system(text, model)


def modules(code: str) -> str:
    """Which of the heavy libraries are imported after running the code."""
    tell = "; print([name for name in ('skfem', 'meshio') if name in sys.modules])"
    program = f"import sys, torsion; {code}{tell}"
    found = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    return found.stdout.strip()


@pytest.mark.parametrize(
    ("model", "expected"), [("lumped", False), ("exact", False), ("fem", True)]
)
def test_scikit_fem_is_imported_for_finite_elements_alone(model, expected):
    scene = UNIFORM + f"analyses: {{model: {model}, modes: {{count: 2}}}}\n"
    assert ("skfem" in modules(f"torsion.run(torsion.parse({scene!r}))")) == expected


def test_a_scene_without_shafts_never_imports_scikit_fem_or_meshio():
    scene = "name: a\ntrain: [disc: {inertia: 1}, coupling: {stiffness: 1}, disc: {inertia: 1}]\n"
    requested = "analyses: {model: fem}\n"
    assert modules(f"torsion.run(torsion.parse({scene + requested!r}))") == "[]"


@pytest.mark.parametrize("degree", [1, 2, 5])
def test_the_law_of_elements_is_that_of_their_matrices_at_the_speed_of_each_shaft(degree):
    """A conical shaft and, behind a gear, a uniform one, whose elements are one of unit length, scaled."""
    whole = system(CONE, "fem", degree=degree, elements=3)
    bars, ratio2 = whole.bars, whole.span_ratio[whole.bars.span] ** 2
    assert len({piece.bar.name for piece in bars.pieces}) == len(set(ratio2.tolist())) == 2
    law = element_law(bars.pieces, bars.degree, ratio2)
    plain = condensed_elements(
        *(part * ratio2[:, None, None] for part in element_matrices(bars.pieces, bars.degree))
    )
    s = np.array([0.0, 0.2, 0.6]) * (plain.limit if degree > 1 else 1e4) ** 2
    for one, other in zip(law.at(s), plain.at(s), strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-13)
