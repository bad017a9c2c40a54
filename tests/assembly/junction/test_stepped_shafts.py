"""Steps in the file: the same as couplings of their flexibility, in every model; faults; what is imported."""

import math
import subprocess
import sys

import numpy as np
import pytest
from scipy.integrate import quad
from tests.for_all import for_all

from torsion.analyses.undamped_modes import modes
from torsion.assembly import assemble
from torsion.assembly.junction.axisymmetric import solved
from torsion.assembly.junction.profile import Corner, Length, Profile, junction
from torsion.errors import InputError
from torsion.kernels.junction_table import junction_table
from torsion.schema.scene_reader import parse

SCENE = """\
name: stepped
{top}
train:
  - disc: {{inertia: 20}}
  - shaft: {{name: a, length: 0.6 m, diameter: 100 mm{step}}}
{between}
  - shaft: {{name: b, length: 0.5 m, diameter: 200 mm{bore}}}
  - disc: {{inertia: 30}}
"""


def scene(top: str = "", step: str = "", between: str = "", bore: str = "") -> str:
    return SCENE.format(top=top, step=step, between=between, bore=bore)


def flexibility(excess: float) -> float:
    """Of so many diameters of shaft `a`."""
    return excess * 0.1 / 79.3e9 / (math.pi / 32.0 * 0.1**4)


def frequencies(text: str, model: str = "exact") -> np.ndarray:
    return np.asarray(modes(assemble(parse(text).train, model, frequency=3000.0), 3).frequency)


@pytest.mark.parametrize("model", ["lumped", "fem", "exact"])
def test_a_fillet_is_a_ring_and_a_coupling_of_its_flexibility(model: str) -> None:
    known = junction_table().excess_length(0.0, 0.5, 0.04)
    assert known is not None
    moment = (
        math.pi
        / 2.0
        * quad(
            lambda x: (0.054 - math.sqrt(0.004**2 - x * x)) ** 4 - 0.05**4, 0.0, 0.004, epsabs=0
        )[0]
    )
    ring = f"  - disc: {{inertia: {parse(scene()).train.bars[0].density * moment!r}}}"
    coupling = f"{ring}\n  - coupling: {{flexibility: {flexibility(known)!r}}}"
    found = frequencies(scene(step=", step: {fillet: 4 mm}"), model)
    assert found == pytest.approx(frequencies(scene(between=coupling), model), rel=1e-11)
    assert np.all(found < frequencies(scene(), model) * (1.0 - 1e-4))


@pytest.mark.parametrize(
    ("text", "profile"),
    [
        (
            scene(step=", step: {chamfer: 4 mm}"),
            junction((1.0, 0.0), (2.0, 0.0), Corner("chamfer", 0.04)),
        ),
        (scene("steps: sharp", bore=", bore: 80 mm"), junction((1.0, 0.0), (2.0, 0.8))),
    ],
    ids=["chamfer", "bore on one side"],
)
def test_outside_of_the_table_the_elements_run(text: str, profile: object) -> None:
    spring = parse(text).train.springs[-1]
    assert spring.flexibility == pytest.approx(
        flexibility(solved(profile).excess_length), rel=1e-12
    )  # type: ignore[arg-type]


def test_handbook_and_words_of_one_shaft() -> None:
    """Of diameters 1:2 the handbook has 0.100 of the smaller diameter."""
    spring = parse(scene("steps: handbook")).train.springs[-1]
    assert spring.flexibility == pytest.approx(flexibility(0.1), rel=1e-12)
    assert spring.name == "a, step"
    none = parse(scene("steps: sharp", ", step: none")).train
    assert none.springs == parse(scene()).train.springs


@pytest.mark.parametrize(
    ("step", "behind", "between", "corners"),
    [
        (
            "{undercut: {depth: 3 mm, width: 8 mm, fillet: 2 mm}}",
            0.2,
            (0.008, 0.094),
            (None, Corner("fillet", 0.002)),
        ),
        (
            "{flange: {diameter: 220 mm, thickness: 30 mm, fillet: 8 mm}}",
            0.1,
            (0.03, 0.22),
            (Corner("fillet", 0.008), None),
        ),
    ],
    ids=["undercut", "flange"],
)
def test_an_undercut_and_a_flange_twist_as_the_whole_line_does(
    step: str, behind: float, between: tuple[float, float], corners: tuple[Corner | None, ...]
) -> None:
    """The elements of the line as it is drawn, its shaft shorter by the undercut, longer by the flange."""
    found = parse(scene(step=f", step: {step}").replace("200 mm", f"{1e3 * behind:g} mm")).train
    length, diameter = between
    first = 0.6 - (length if diameter < 0.1 else 0.0)
    whole = Profile(
        tuple(Length(one, (d, d)) for one, d in ((first, 0.1), (length, diameter), (0.5, behind))),
        corners,
    )
    bounds, modulus = solved(whole, 1e-6).levels[-1], found.bars[0].shear_modulus
    own = sum(bar.length / modulus / (math.pi / 32.0 * bar.outer[0] ** 4) for bar in found.bars)
    total = own + found.springs[-1].flexibility
    assert modulus * total == pytest.approx((bounds.lower + bounds.upper) / 2.0, rel=1e-6)
    flanges = [one.inertia for one in found.inertias if one.what == "flange"]
    density = found.bars[0].density
    assert (
        flanges
        == [pytest.approx(density * length * math.pi / 32.0 * diameter**4)][: diameter > 0.1]
    )
    # The ring in the corner of a flange of 8 mm; the fillet of an undercut is in the larger shaft, not beside it.
    rings = [one.inertia for one in found.inertias if one.what == "fillet"]
    ring, _ = quad(
        lambda r: r**3 * (0.008 - math.sqrt(0.008**2 - (0.058 - r) ** 2)), 0.05, 0.058, epsabs=0
    )
    assert rings == [pytest.approx(density * 2.0 * math.pi * ring, rel=1e-9)][: diameter > 0.1]


def test_a_large_fillet_stiffens_the_shaft_that_it_fills() -> None:
    """Its excess length is negative: the whole twist is that of both shafts less it."""
    known = junction_table().excess_length(0.0, 0.5, 0.4)
    assert known is not None
    assert known < 0.0
    bar = parse(scene(step=", step: {fillet: 40 mm}")).train.bars[0]
    assert 79.3e9 / bar.shear_modulus == pytest.approx(1.0 + known * 0.1 / 0.6, rel=1e-12)


@for_all(
    ("text", "words"),
    [
        (scene(step=", step: {}"), "one form"),
        (scene(step=", step: {fillet: 4 mm, chamfer: 4 mm}"), "one form"),
        (scene(step=", step: round"), "sharp"),
        (scene("steps: round"), "sharp"),
        (scene("steps: [sharp]", step=", step: {fillet: 4 mm}"), "steps"),
        (scene(step=", step: sharp").replace("200 mm", "100 mm"), "the same diameter"),
        (scene(step=", step: sharp", bore=", bore: 120 mm"), "do not touch"),
        (scene("steps: sharp", bore=", bore: 120 mm"), "do not touch"),
        (scene(step=", step: {undercut: {depth: 50 mm, width: 8 mm}}"), "deeper than the wall"),
        (
            scene(step=", step: {undercut: {depth: 3 mm, width: 8 mm, fillet: 9 mm}}"),
            "does not fit into the undercut",
        ),
        (scene(step=", step: {undercut: {depth: 3 mm, width: 600 mm}}"), "reaches beyond 'a'"),
        (scene(step=", step: {flange: {diameter: 200 mm, thickness: 30 mm}}"), "not larger than"),
        (
            scene(step=", step: sharp", between="  - disc: {inertia: 1}"),
            "no shaft follows 'a' directly",
        ),
        (
            scene(step=", step: {fillet: 0.5 m}").replace("200 mm", "1.2 m"),
            "more than half of its twist",
        ),
        (scene(step=", step: {fillet: 0.8 m}").replace("200 mm", "2 m"), "reaches beyond 'a'"),
    ],
)
def test_a_step_that_cannot_be_is_refused_at_its_line(text: str, words: str) -> None:
    with pytest.raises(InputError) as error:
        parse(text)
    assert words in str(error.value)
    assert all(fault.line for fault in error.value.faults)


def test_without_steps_nothing_more_is_imported_and_with_the_table_no_elements() -> None:
    for text, expected in (
        (scene(), []),
        (scene("steps: sharp"), ["torsion.kernels.junction_table"]),
    ):
        code = f"""
import sys
from torsion.schema.scene_reader import parse
from torsion.assembly import assemble
assemble(parse({text!r}).train)
print([name for name in ("skfem", "torsion.kernels.junction_table") if name in sys.modules])
"""
        found = subprocess.run(
            [sys.executable, "-c", code], capture_output=True, text=True, check=True
        ).stdout
        assert found.strip() == repr(expected)
