"""Sliders of figures as files give them: tolerances of any width, lists, whole numbers, ends, names and line ends."""

import pytest

from torsion.errors import InputError
from torsion.live.session import moved_study, shown
from torsion.schema.scene_reader import parse, reread
from torsion.schema.variants.variation import Variation, movable
from torsion.study import Study

SCENE = """name: Antrieb Nº 1
operation: {speeds: {from: 100 rpm, to: 200 rpm, steps: 3}}
train:
  - disc: {name: ü.ä, inertia: 2, tolerance: 5 %}
  - coupling: {name: link, stiffness: 12 kN*m/rad, tolerance: TOLERANCE}
  - gear: {name: g, teeth: [20, 41], inertia: [1, 2]}
  - coupling: {name: back, flexibility: 1e-10}
  - disc: {name: end, inertia: 3}
"""


def opened(vary: str = "", tolerance: str = "10 %") -> tuple[Study, Variation]:
    text = SCENE.replace("TOLERANCE", tolerance) + (
        f"analyses: {{sweep: {{vary: {{{vary}}}}}}}\n" if vary else ""
    )
    study = parse(text.replace("\n", "\r\n"))
    return study, movable(study, *reread(study))


def test_a_scene_without_tolerances_has_no_sliders() -> None:
    study = parse(
        "name: pair\ntrain: [disc: {inertia: 2}, coupling: {stiffness: 120}, disc: {inertia: 3}]\n"
    )
    variation = movable(study, *reread(study))
    assert shown(variation, {}) == []
    assert moved_study(study, variation, {}) is study


@pytest.mark.parametrize(
    ("tolerance", "ends"),
    [
        ("70 %", (0.3, 1.7)),
        ("100 %", (0.0, 2.0)),
        ("1e-13", (1 - 1e-13, 1 + 1e-13)),
    ],
)
def test_a_tolerance_of_any_width_has_a_slider(tolerance: str, ends: tuple[float, float]) -> None:
    _, variation = opened(tolerance=tolerance)
    inertia, link = shown(variation, {})
    assert (inertia["name"], inertia["low"], inertia["high"]) == ("ü.ä.inertia", 0.95, 1.05)
    assert (link["low"], link["high"]) == pytest.approx(ends, rel=1e-15)


def test_a_position_beyond_an_end_is_refused_however_small_its_figures_are() -> None:
    study, variation = opened("back.flexibility: {from: 1e-11, to: 2e-10}")
    moved_study(study, variation, {"back.flexibility": 2e-10})
    for position in (0.0, 2.1e-10):
        with pytest.raises(InputError, match="goes from 1e-11 to 2e-10"):
            moved_study(study, variation, {"back.flexibility": position})


@pytest.mark.parametrize(
    ("vary", "position", "words"),
    [
        ("g.teeth.1: {from: 20, to: 30, step: 1}", 5.0, "25"),
        ("g.teeth.1: {from: 20, to: 30}", 25.0, "25"),
        ("g.teeth: {values: [[20, 41], [21, 40]]}", 1.0, "[21, 40]"),
    ],
)
def test_whole_numbers_and_lists_are_those_of_the_file(
    vary: str, position: float, words: str
) -> None:
    study, variation = opened(vary)
    name = vary.partition(":")[0]
    first = next(one for one in shown(variation, {}) if one["name"] == name)
    assert first["nominal"] == first["low"]  # what the file gives
    moved = next(one for one in shown(variation, {name: position}) if one["name"] == name)
    assert (moved["text"], moved["moved"]) == (words, True)
    moved_study(study, variation, {name: position})
