"""The references of the study of accuracy against closed forms and laws of their own."""

import numpy as np
import pytest

mpmath = pytest.importorskip("mpmath")


@pytest.fixture(scope="module")
def references(benchmark):
    return benchmark("accuracy_references")


@pytest.fixture(scope="module")
def scenes(benchmark):
    return benchmark("accuracy_scenes")


def turned(scenes, line):
    """The line from its other end; without gears."""
    items = [
        scenes.Shaft(item.length, item.diameter[::-1], item.bore, item.shear_modulus, item.density)
        if isinstance(item, scenes.Shaft)
        else item
        for item in reversed(line.items)
    ]
    return scenes.Line(line.name, tuple(items), line.highest)


def test_drill_string_has_the_published_frequencies(references, scenes):
    found = [float(f) for f in references.frequencies(scenes.DRILL_STRING, 6)]
    assert found == pytest.approx(
        [1.91033229, 3.82066476, 5.73099757, 7.64133089, 9.5516649, 11.46199977], abs=5e-9
    )


def test_two_discs_on_a_coupling_are_the_closed_form(references, scenes):
    line = scenes.Line("two", (scenes.Disc(2.0), scenes.Coupling(120.0), scenes.Disc(3.0)), 40.0)
    (found,) = references.frequencies(line, 1)
    assert (
        abs(found * 2 * mpmath.pi - 10) < 1e-13
    )  # sqrt(120 (1/2 + 1/3)), at the precision of this comparison


@pytest.mark.parametrize("name", ["CONE", "STEPPED"])
def test_line_from_its_other_end_has_the_same_frequencies(references, scenes, name):
    line = getattr(scenes, name)
    with mpmath.workdps(60):
        pairs = zip(
            references.frequencies(line, 4),
            references.frequencies(turned(scenes, line), 4),
            strict=True,
        )
        assert max(abs(a / b - 1) for a, b in pairs) < mpmath.mpf(10) ** -38


def test_cone_tends_to_the_uniform_shaft_with_the_square_of_its_taper(references, scenes):
    def first(taper: float):
        shaft = scenes.Shaft(2.0, (0.1 * (1 + taper), 0.1 * (1 - taper)))
        return references.frequencies(
            scenes.Line("", (scenes.Disc(3.0), shaft, scenes.Disc(3.0)), 3000.0), 1
        )[0]

    with mpmath.workdps(60):
        uniform = first(0.0)
        coarse, fine = (abs(first(taper) / uniform - 1) for taper in (2e-3, 1e-3))
    assert float(coarse / fine) == pytest.approx(4.0, rel=1e-4)


def test_gear_line_of_equal_teeth_is_the_line_without_a_gear(references, scenes):
    shaft, end = scenes.Shaft(1.0, (0.1, 0.1)), scenes.Disc(1.0, 5.0)
    geared = (scenes.Disc(2.0), shaft, scenes.Gear((20, 20), (0.25, 0.5)), shaft, end)
    plain = (scenes.Disc(2.0), shaft, scenes.Disc(0.75), shaft, end)
    found, expected = (
        references.middle_torques(scenes.Line("", items, 1e4), [100.0, 2000.0])
        for items in (geared, plain)
    )
    np.testing.assert_allclose(found, expected, rtol=1e-14)


def test_torque_at_mid_shaft_is_the_share_of_the_inertia_beyond_it_when_slow(references, scenes):
    shaft = scenes.Shaft(2.0, (0.1, 0.1))
    line = scenes.Line("", (scenes.Disc(2.0), shaft, scenes.Disc(3.0)), 1e4)
    own = np.pi / 32 * 0.1**4 * shaft.density * shaft.length
    (torque,) = references.middle_torques(line, [1e-4])[0]
    assert torque == pytest.approx((3.0 + own / 2) / (5.0 + own), rel=1e-12)


def test_too_few_modes_below_the_highest_frequency_are_told(references, scenes):
    line = scenes.Line("", (scenes.Disc(2.0), scenes.Coupling(120.0), scenes.Disc(3.0)), 40.0)
    with pytest.raises(ArithmeticError, match="1 modes below 40"):
        references.frequencies(line, 2)
