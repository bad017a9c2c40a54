"""Steps of a train from Python, what sharp corners would do, what is left out, and the stress in fillets."""

import math

import numpy as np
import pytest
from tests.assembly.junction.test_stepped_shafts import frequencies, scene
from tests.contracts.frozen import solved

import torsion
from torsion.analyses.modes.steps_and_hubs import SharpSteps
from torsion.analyses.response.amplitudes import Synthesis
from torsion.analyses.response.fillet_stresses import Fillets
from torsion.analyses.undamped_modes import modes
from torsion.assembly import assemble
from torsion.assembly.junction.stepped_shafts import with_steps
from torsion.errors import InputError
from torsion.kernels.round_sections import polar_area_moment
from torsion.model.disc import Disc
from torsion.model.shafts.shaft import Shaft
from torsion.model.shafts.shaft_details import Flange, Step, Undercut
from torsion.rules.verdict_line import Checks
from torsion.schema.scene_reader import parse
from torsion.train import Train, train


def line(step: Step | None) -> list[Disc | Shaft]:
    return [
        Disc(inertia=20.0),
        Shaft(name="a", length=0.6, diameter=(0.1,), step=step),
        Shaft(name="b", length=0.5, diameter=(0.2,)),
        Disc(inertia=30.0),
    ]


def test_steps_from_python_are_those_of_the_file() -> None:
    stated = modes(
        assemble(train(line(Step(fillet=0.004))), "exact", frequency=3000.0), 3
    ).frequency
    np.testing.assert_allclose(
        stated, frequencies(scene(step=", step: {fillet: 4 mm}")), rtol=1e-12
    )
    sharp = modes(
        assemble(train(line(None), steps="sharp"), "exact", frequency=3000.0), 3
    ).frequency
    np.testing.assert_allclose(sharp, frequencies(scene("steps: sharp")), rtol=1e-12)
    with pytest.raises(InputError, match="no shaft follows"):
        assemble(train(line(Step(fillet=0.004))[:2]))


def test_the_change_by_sharp_steps_is_that_of_the_file_with_them() -> None:
    for model in ("lumped", "exact"):
        text = f"analyses: {{model: {model}, modes: {{count: 3}}}}"
        found = torsion.run(parse(scene(text))).need(SharpSteps)
        sharp, without = frequencies(scene("steps: sharp"), model), frequencies(scene(), model)
        np.testing.assert_allclose(found.frequency, sharp, rtol=1e-9 if model == "exact" else 1e-3)
        np.testing.assert_allclose(found.change, sharp / without - 1.0, rtol=1e-2)
    for text in (
        scene("steps: sharp"),
        scene(step=", step: none"),
        scene().replace("200 mm", "100 mm"),
    ):
        assert torsion.run(parse(text), only=("sharp steps",)).get(SharpSteps) is None


def test_a_step_in_the_bore_alone_is_named_where_steps_are_sharp() -> None:
    text = scene("steps: sharp", bore=", bore: 50 mm").replace("200 mm", "100 mm")
    assert "omitted" in parse(text).train["a"].remark
    found = torsion.run(parse(text.replace("steps: sharp", ""))).need(SharpSteps)
    assert [one.flexibility for one in found.steps] == [None]
    assert not np.any(found.change)


def test_peak_stress_is_the_factor_times_the_nominal_one_at_the_worst_speed() -> None:
    found = solved("stepped_line")
    for one in found.need(Fillets).each:
        torque = found.need(Synthesis).half_range[
            :, found.system.span_part == found.study.train.positions[one.shaft]
        ]
        at = (
            torque if one.following is None else torque[:, -1]
        )  # a notch anywhere in its shaft, a fillet at its end
        nominal = at.max() / (math.pi / 16.0 * one.diameter**3)
        assert one.nominal == pytest.approx(nominal, rel=1e-12 if one.following is None else 1e-3)
        assert one.nominal is not None
        assert one.peak == pytest.approx(one.factor * one.nominal, rel=1e-12)
        assert one.peterson is None or one.factor == pytest.approx(one.peterson, rel=0.03)
        assert (one.utilisation is None) == (
            one.shaft not in ("line [1]", "line [2]", "line [4]", "line [5]")
        )
    assert [line.where for line in found.need(Checks).lines if line.rule == "fillets"] == [
        "line [1]",
        "line [2]",
        "line [4]",
        "line [5]",
        "line [5]",
    ]


@pytest.mark.parametrize(
    ("step", "same"),
    [
        (
            Step(undercut=Undercut(depth=0.01, width=0.15)),
            [
                Shaft(length=0.45, diameter=(0.1,)),
                Shaft(length=0.15, diameter=(0.08,)),
                Shaft(length=0.5, diameter=(0.2,)),
            ],
        ),
        (
            Step(flange=Flange(diameter=0.3, thickness=0.4)),
            [
                Shaft(length=0.6, diameter=(0.1,)),
                Shaft(length=0.4, diameter=(0.3,)),
                Shaft(length=0.5, diameter=(0.2,)),
            ],
        ),
    ],
    ids=["undercut", "flange"],
)
def test_a_long_undercut_or_flange_is_a_shaft_of_its_own_between_sharp_steps(
    step: Step, same: list[Shaft]
) -> None:
    def twist_of(found: Train) -> float:
        twist = sum(
            bar.length / bar.shear_modulus / polar_area_moment(bar.outer[0], 0.0)
            for bar in found.bars
        )
        return float(twist) + sum(spring.flexibility for spring in found.springs)

    unit = 0.1 / 79.3e9 / polar_area_moment(0.1, 0.0)
    ends = Disc(inertia=20.0), Disc(inertia=30.0)
    whole = twist_of(with_steps(train([ends[0], *same, ends[1]], steps="sharp")))
    assert twist_of(with_steps(train(line(step)))) == pytest.approx(whole, abs=1e-4 * unit)
