"""The same trains with shafts as lumped segments, as finite elements and as continua."""

import math
from functools import cache
from itertools import pairwise
from pathlib import Path

import mpmath
import numpy as np
import pytest

import torsion
from torsion.analyses.critical import CriticalSpeeds
from torsion.analyses.modes.holzer import holzer
from torsion.analyses.response.amplitudes import Response, Synthesis
from torsion.analyses.steady import Steady
from torsion.analyses.undamped_modes import Modes
from torsion.kernels.trees.tree_response import Status
from torsion.rules.rule_over_speed import spans_of
from torsion.rules.verdict_line import Checks

SCENES = Path(__file__).parents[2] / "shafting_specs"
SHAFT = math.pi / 20.0  # kg m2, inertia of the shaft of both closed forms
CLOSED = {  # b of the benchmark list, phase along the shaft
    "fixed_shaft_disc": [0.860333589019380, 3.42561845948173, 6.43729817917195, 9.52933440536196],
    "free_shaft_discs": [1.33850528549289, 3.76231286633799, 6.65035956592251, 9.68012641025234],
}
BOOK = {  # Hz, the drill string by linear elements
    5: ["1.9417", "4.0719", "6.5437", "9.1547"],
    50: ["1.9106", "3.8232", "5.7394", "7.6613"],
}
TRAIN = """
name: a geared, branched train with two shafts
materials: {steel-3: {shear_modulus: 80 GPa, density: 7850, loss_factor: 0.01, tensile_strength: 600 MPa}}
operation: {speeds: {from: 300 rpm, to: 1200 rpm, steps: 7}, rated: {speed: 1000 rpm, power: 100 kW}}
train:
- motor: {name: drive, inertia: 3}
- shaft: {name: first, length: 3, diameter: 90 mm, bore: 20 mm, role: intermediate, material: steel-3}
- gear: {name: stage, ratio: 5/2, inertia: [0.1, 0.4]}
- branch: {train: [coupling: {stiffness: 3e4, psi: 0.5}, disc: {name: pump, inertia: 0.7, damping: 3}]}
- coupling: {name: soft, stiffness: 8e4, viscous: 20}
- disc: {name: flange, inertia: 0.2}
- shaft: {name: second, length: 2, diameter: [120 mm, 80 mm], role: propeller, material: steel-3, loss_factor: 0.02}
- propeller: {name: screw, inertia: 4, blades: 4, excitation: [{blade_order: 1, torque: 100}]}
excitations: [{at: drive, order: 2, torque: 50, phase: 20 deg}]
"""


@cache
def study(scene: str):
    return torsion.read(SCENES / f"{scene}.yaml")


def drill(fem: str, count: int = 4) -> np.ndarray:
    text = (SCENES / "drill_string.yaml").read_text(encoding="utf-8")
    text = text.replace("model: exact", f"model: fem\n  fem: {fem}").replace(
        "count: 6", f"count: {count}"
    )
    return torsion.run(torsion.parse(text)).need(Modes)


def drill_exact(count: int) -> np.ndarray:
    """(count,) Hz at 30 digits: (b^2 a1 a2 - 1) sin b = b (a1 + a2) cos b of the drill string."""
    with mpmath.workdps(30):
        area = mpmath.pi / 32 * (mpmath.mpf("0.78") ** 4 - mpmath.mpf("0.65") ** 4)
        shaft, wave = 8000 * area * 800, mpmath.sqrt(mpmath.mpf(75) * 10**9 / 8000)
        one, two = 200 / shaft, 10 / shaft
        roots = [
            mpmath.findroot(
                lambda b: (b * b * one * two - 1) * mpmath.sin(b) - b * (one + two) * mpmath.cos(b),
                n * 3.1361,
            )
            for n in range(1, count + 1)
        ]
        return np.array([float(b * wave / 800 / (2 * mpmath.pi)) for b in roots])


@pytest.mark.parametrize("scene", CLOSED)
def test_a_continuum_has_the_frequencies_of_its_closed_form(scene):
    found = torsion.run(study(scene)).need(Modes)
    phase = 2.0 * math.pi * found.frequency * 2.0 / math.sqrt(80e9 / 8000.0)
    np.testing.assert_allclose(phase, CLOSED[scene], rtol=6e-15)  # the list has 15 digits
    assert found.certified
    with mpmath.workdps(30):
        for b, value in zip(CLOSED[scene], phase, strict=True):
            if scene == "fixed_shaft_disc":
                exact = mpmath.findroot(lambda x: x * mpmath.sin(x) - mpmath.cos(x), b)
            else:
                exact = mpmath.findroot(
                    lambda x: (x * x - 1) * mpmath.sin(x) - 2.5 * x * mpmath.cos(x), b
                )
            assert abs(value / exact - 1) < 2e-15


def test_the_drill_string_as_a_continuum():
    found = torsion.run(study("drill_string")).need(Modes)
    np.testing.assert_allclose(found.frequency, drill_exact(6), rtol=2e-15)
    assert found.enclosure.shape == (6, 2)
    assert np.all(
        (found.enclosure[:, 0] <= found.frequency) & (found.frequency <= found.enclosure[:, 1])
    )


@pytest.mark.parametrize("elements", BOOK)
def test_linear_elements_give_the_drill_string_of_the_book(elements):
    found = drill(f"{{degree: 1, elements: {elements}}}").frequency
    for value, text in zip(found, BOOK[elements], strict=True):
        assert abs(value - float(text)) <= 0.50001e-4


def test_elements_of_degree_ten_are_right_to_a_billionth_of_a_millionth_of_a_part():
    found = drill("{degree: 10, elements: 8}", 6)
    np.testing.assert_allclose(found.frequency, drill_exact(6), rtol=1e-12)
    assert found.certified


@pytest.mark.parametrize("degree", [2, 4, 7])
def test_default_elements_are_right_to_a_millionth(degree):
    found = drill(f"{{degree: {degree}}}", 6).frequency
    np.testing.assert_allclose(found, drill_exact(6), rtol=1.02e-6)
    assert np.all(found >= drill_exact(6) * (1 - 1e-14)), "elements are too stiff"


def test_elements_fewer_than_the_modes_need_are_told_without_a_certificate():
    found = drill("{degree: 3, elements: 2}", 6)
    assert len(found.frequency) == 6
    assert not found.certified
    np.testing.assert_allclose(found.frequency[:2], drill_exact(2), rtol=1e-2)


def ends(
    model: str, frequency: float = 900.0, segments: int | None = None, **settings
) -> np.ndarray:
    """(speeds, lines, 4) complex N m at both ends of both shafts, (speeds, lines, 2) rad at pump and screw."""
    text = TRAIN if segments is None else TRAIN.replace("length:", f"segments: {segments}, length:")
    scene = torsion.parse(text)
    system = torsion.assemble(scene.train, model, frequency=frequency, **settings)
    found = torsion.response(scene, system, speeds=np.linspace(300.0, 1200.0, 7) * math.pi / 30.0)
    kept, system = found.torque[found.requested], found.system
    assert np.all(found.status[found.requested] == Status.OK)
    stated = []
    for name in ("first", "second"):
        own = [
            k for k, span in enumerate(system.spans) if system.train.parts[span.part].name == name
        ]
        if model == "lumped":  # half a segment's inertia is beyond its last span
            first, last = system.spans[own[0]], system.spans[own[-1]]
            lump = {
                station: _lump(system, name, station) for station in (first.driving, last.driven)
            }
            w2 = (2.0 * math.pi * found.frequency[found.requested]) ** 2
            angle = found.angle[found.requested]
            stated += [
                kept[..., own[0]] - w2 * lump[first.driving] * angle[..., first.driving],
                kept[..., own[-1]] + w2 * lump[last.driven] * angle[..., last.driven],
            ]
        else:
            stated += [kept[..., own[0]], kept[..., own[-1]]]
    points = [system.train[name].stations[0] for name in ("pump", "screw")]
    return np.concatenate(
        [np.stack(stated, axis=-1), found.angle[found.requested][..., points]], axis=-1
    )


def _lump(system, name: str, station: int) -> float:
    from torsion.assembly.segments import bar_segments

    bar = next(bar for bar in system.train.bars if bar.name == name)
    return float(bar_segments(bar, system.segments[name])[1][0 if station == bar.driving else -1])


def error(one: np.ndarray, other: np.ndarray) -> float:
    """Largest difference of complex amplitudes, relative to the amplitude."""
    return float(np.max(np.abs(one - other) / np.abs(other)))


def test_the_three_models_agree_on_the_response_of_a_geared_branched_train():
    """To 1e-9, complex; the lumped one by Richardson's extrapolation of 32, 64, ... 512 segments a shaft."""
    exact = ends("exact")
    assert error(ends("fem", degree=8), exact) < 1e-9
    table = [ends("lumped", segments=32 * 2**k) for k in range(5)]
    assert 3.5 < error(table[2], exact) / error(table[3], exact) < 4.5, "second order"
    for power in range(1, 5):
        table = [(4**power * fine - coarse) / (4**power - 1) for coarse, fine in pairwise(table)]
    assert error(table[0], exact) < 1e-9


def test_finite_elements_and_the_continuum_have_as_many_modes_below_a_frequency():
    train = torsion.parse(TRAIN).train
    exact = torsion.modes(torsion.assemble(train, "exact", frequency=4000.0), 14).frequency
    fem = torsion.modes(torsion.assemble(train, "fem", frequency=4000.0, degree=6), 14).frequency
    assert exact[-1] > 2500.0
    np.testing.assert_allclose(fem, exact, rtol=1e-6)
    for highest in np.linspace(100.0, 2500.0, 9):
        assert np.count_nonzero(fem < highest) == np.count_nonzero(exact < highest)


@pytest.mark.parametrize("model", ["fem", "exact"])
def test_shares_of_energy_and_rigid_motion_of_a_distributed_train(model):
    train = torsion.parse(TRAIN).train
    found = torsion.modes(torsion.assemble(train, model, frequency=1500.0), 8)
    assert found.rigid == 1
    np.testing.assert_allclose(found.kinetic.sum(axis=0), 1.0, rtol=1e-13)
    np.testing.assert_allclose(found.elastic.sum(axis=0), 1.0, rtol=1e-13)
    lumped = torsion.assemble(train, "lumped", frequency=40000.0)
    other = torsion.modes(lumped, 8)
    own = len(train.stations)
    shaped = found.system
    sign = np.sign((found.shape[:own] * other.shape[:own]).sum(axis=0))
    np.testing.assert_allclose(found.shape[:own] * sign, other.shape[:own], atol=2e-4)
    for part in range(len(train.parts)):
        one, two = (
            share[[k for k, span in enumerate(system.spans) if span.part == part]].sum(axis=0)
            for share, system in ((found.elastic, shaped), (other.elastic, lumped))
        )
        np.testing.assert_allclose(one, two, atol=2e-4)
    np.testing.assert_array_equal(found.nodes, other.nodes)


@pytest.mark.parametrize("model", ["fem", "exact"])
def test_a_train_that_turns_as_a_whole_has_the_torque_of_its_inertia_alone(model):
    """At 1e-7 of the first frequency a torque at one end is shared by inertia; angles are equal to 14 digits."""
    scene = torsion.parse("""
name: slow
train:
- disc: {name: a, inertia: 2}
- shaft: {name: line, length: 2, diameter: [60 mm, 90 mm]}
- disc: {name: b, inertia: 3}
excitations: [{at: a, torque: 1}]
analyses: {response: {frequencies: {from: 1.0e-6, to: 2.0e-6, steps: 2}}}
""")
    system = torsion.assemble(scene.train, model, frequency=100.0)
    from torsion.analyses.response.over_frequency import frequency_response

    found = frequency_response(scene, system)
    inertia = system.inertia.sum()
    spans = {span.name: k for k, span in enumerate(system.spans)}
    np.testing.assert_allclose(
        found.torque[0, spans["line, driven end"]], 3.0 / inertia, rtol=1e-12
    )
    np.testing.assert_allclose(found.torque[0, spans["line [1]"]], 1.0 - 2.0 / inertia, rtol=1e-12)


def test_a_study_without_enough_pieces_is_divided_until_its_modes_are_in_reach():
    text = (
        (SCENES / "free_shaft_discs.yaml")
        .read_text(encoding="utf-8")
        .replace("count: 4", "count: 60")
    )
    found = torsion.run(torsion.parse(text))
    assert len(found.need(Modes).frequency) == 60
    assert found.need(Modes).certified
    with mpmath.workdps(30):
        b = 2.0 * math.pi * found.need(Modes).frequency[-1] * 2.0 / math.sqrt(1e7)
        exact = mpmath.findroot(lambda x: (x * x - 1) * mpmath.sin(x) - 2.5 * x * mpmath.cos(x), b)
    assert abs(b / exact - 1) < 4e-15
    assert float(exact) == pytest.approx(59 * math.pi + 2.5 / (59 * math.pi), rel=1e-4)


@pytest.mark.parametrize("model", ["fem", "exact"])
def test_everything_that_a_study_can_ask_works_in_the_model(model):
    requested = f"analyses: {{model: {model}, modes: , response: }}\nrules: [iacs-m68]\n"
    findings = torsion.run(torsion.parse(TRAIN + requested))
    assert findings.get(Response) is not None
    assert findings.get(Synthesis) is not None
    assert findings.need(CriticalSpeeds).crossings
    assert findings.get(Steady) is not None
    assert any(check.rule == "iacs-m68" for check in findings.need(Checks).lines)
    assert any(line.what == "assembly" and model in line.method for line in findings.plan.done)
    assert any(what == "damped modes" for what, _ in findings.plan.left_out)


@pytest.mark.parametrize("model", ["fem", "exact"])
def test_a_holzer_table_of_distributed_shafts_is_in_equilibrium(model):
    system = torsion.assemble(torsion.parse(TRAIN).train, model, frequency=800.0)
    modes = torsion.modes(system, 4)
    for mode in range(4):
        table = holzer(system, modes, mode)
        after = table.angle[table.before] - table.twist
        inner = table.before >= 0
        assert np.all(np.abs(after - table.angle)[inner] < 1e-12 * np.abs(table.angle).max())
        assert table.residual < 1e-11 * np.abs(table.torque_in).max()
        for row in np.flatnonzero(np.isfinite(table.transfer[:, 0, 0])).tolist():
            ends = table.transfer[row] @ (table.angle[table.before[row]], table.torque_in[row])
            assert ends[0] == pytest.approx(table.angle[row], abs=1e-12 * np.abs(table.angle).max())
            assert ends[1] == pytest.approx(
                table.torque_out[row], abs=1e-11 * np.abs(table.torque_in).max()
            )
            assert np.linalg.det(table.transfer[row]) == pytest.approx(1.0, rel=1e-12)


@pytest.mark.parametrize("turned", [False, True])
def test_constants_of_a_uniform_shaft_are_the_closed_form(turned):
    """A = D = cos mu, H = sin mu/(omega I sqrt(rho G)), B = omega I sqrt(rho G) sin mu, mu = omega L sqrt(rho/G)."""
    ends = ["disc: {name: a, inertia: 0.2}", "disc: {name: b, inertia: 3}"]
    shaft = "shaft: {name: s, length: 3 m, diameter: [60 mm], bore: 20 mm, material: m}"
    text = "materials: {m: {shear_modulus: 80 GPa, density: 7800}}\ntrain:\n- "
    train = torsion.parse(
        "name: x\n" + text + "\n- ".join([ends[turned], shaft, ends[not turned]])
    ).train
    impedance = math.pi / 32.0 * (0.06**4 - 0.02**4) * math.sqrt(7800 * 80e9)
    system = torsion.assemble(train, "exact", frequency=2000.0)
    for mode in range(3):
        table = holzer(system, torsion.modes(system, 3), mode)
        omega = math.sqrt(table.square)
        mu = omega * 3.0 * math.sqrt(7800 / 80e9)
        closed = [
            [math.cos(mu), -math.sin(mu) / omega / impedance],
            [omega * impedance * math.sin(mu), math.cos(mu)],
        ]
        np.testing.assert_allclose(table.transfer[1], closed, rtol=1e-12)


@pytest.mark.parametrize("held", ["driving", "driven"])
def test_the_torques_told_are_those_at_the_driving_and_the_driven_end(held):
    """A cone on a held disc: the free disc takes w^2 J angle at its end, the held one what the others leave over."""
    discs = {True: "- disc: {held: true}", False: "- disc: {name: free, inertia: 1.5}"}
    text = f"name: cone\ntrain:\n{discs[held == 'driving']}\n- shaft: {{length: 2, diameter: [60 mm, 90 mm]}}\n"
    study = torsion.parse(text + discs[held == "driven"])
    fine = torsion.assemble(study.train, "lumped", frequency=1e5)
    other = torsion.modes(fine, 3)
    at_held = next(
        k for k, span in enumerate(fine.spans) if fine.held[[span.driving, span.driven]].any()
    )
    free = study.train["free"].stations[0]
    for model in ("fem", "exact"):
        system = torsion.assemble(study.train, model, frequency=2000.0)
        found = torsion.modes(system, 3)
        assert np.all(system.condensed.sign == (1.0 if held == "driving" else -1.0))
        square = (2.0 * math.pi * found.frequency) ** 2
        near = system.spans.index(
            next(span for span in system.spans if free in (span.driving, span.driven))
        )
        pushed = 1.5 * square * found.shape[free] * (-1.0 if held == "driving" else 1.0)
        np.testing.assert_allclose(found.torque[near], pushed, rtol=1e-12)
        far = next(
            k
            for k, span in enumerate(system.spans)
            if system.held[[span.driving, span.driven]].any()
        )
        sign = np.sign(found.shape[free] * other.shape[free])
        np.testing.assert_allclose(found.torque[far], other.torque[at_held] * sign, rtol=1e-4)


@pytest.mark.parametrize(("model", "share"), [("lumped", 1e-3), ("fem", 1e-6), ("exact", 1e-14)])
def test_a_shaft_held_at_both_ends_sounds_in_half_waves(model, share, tmp_path):
    file = tmp_path / "held.yaml"
    file.write_text(f"""
name: held at both ends
train:
  - disc: {{held: true}}
  - shaft: {{length: 1 m, diameter: 50 mm}}
  - disc: {{held: true}}
analyses: {{model: {model}, modes: {{count: 4}}}}
""")
    found = torsion.run(torsion.read(str(file))).need(Modes).frequency
    half_waves = np.arange(1, 5) * math.sqrt(79.3e9 / 7850.0) / 2.0
    np.testing.assert_allclose(found, half_waves, rtol=share)


def test_lumped_shafts_have_as_many_modes_as_are_asked(tmp_path):
    branch = (
        "  - branch: {train: [{shaft: {length: 1 m, diameter: 50 mm}}, {disc: {inertia: 0.1}}]}\n"
    )
    file = tmp_path / "three.yaml"
    text = "name: three equal branches\ntrain:\n  - disc: {inertia: 1}\n" + 3 * branch
    found = {}
    for model in ("lumped", "exact"):
        file.write_text(text + f"analyses: {{model: {model}, modes: {{count: 6}}}}\n")
        found[model] = torsion.run(torsion.read(str(file))).need(Modes).frequency
    np.testing.assert_allclose(found["lumped"], found["exact"], rtol=1e-3)


@pytest.mark.parametrize("model", ["fem", "exact"])
def test_no_torque_within_a_shaft_is_above_those_at_ends_of_pieces_by_more_than_promised(model):
    """T = G I k (B cos kx - A sin kx) of a line between two inertias, its largest |T| over x at every speed."""
    study = torsion.parse(f"""
name: line
operation: {{speeds: {{from: 20 rpm, to: 126 rpm}}}}
materials: {{steel: {{density: 7850, shear_modulus: 79.3 GPa}}}}
train:
- motor: {{inertia: 140, ripple: [{{order: 12, torque: 5760}}]}}
- shaft: {{name: line, length: 80 m, diameter: 300 mm, material: steel, loss_factor: 1 %}}
- propeller: {{inertia: 1}}
analyses: {{model: {model}, response: }}
""")
    findings = torsion.run(study)
    response = findings["response"]
    w = 2.0 * math.pi * response.frequency[:, 0]
    modulus, x = 79.3e9 * (1.0 + 0.01j), np.linspace(0.0, 80.0, 2001)
    k = w * np.sqrt(7850.0 / modulus)
    stiff = modulus * math.pi * 0.3**4 / 32.0 * k
    sine, cosine = np.sin(80.0 * k), np.cos(80.0 * k)
    rows = [[w**2 * 140.0, stiff], [-stiff * sine - w**2 * cosine, stiff * cosine - w**2 * sine]]
    force = np.tile([[-5760.0], [0.0]], (w.size, 1, 1))
    a, b = np.moveaxis(np.linalg.solve(np.moveaxis(rows, 2, 0), force)[..., 0], 1, 0)[..., None]
    waves = b * np.cos(np.outer(k, x)) - a * np.sin(np.outer(k, x))
    largest = np.abs(stiff[:, None] * waves).max(axis=1)
    shaft = spans_of(response.system, 1)
    ratio = np.abs(response.torque[:, 0, shaft]).max(axis=1) / largest
    assert 1.0 / math.cos(0.05 / 2.0) - 1.0 < 3.2e-4
    assert np.all((ratio > math.cos(0.05 / 2.0)) & (ratio < 1.0 + 1e-5))
    assert findings.system.segments == response.system.segments


@pytest.mark.parametrize(("elements", "is_short"), [(80, True), (16, False)])
def test_a_stress_at_the_ends_of_stated_elements_is_restricted_if_they_are_long(elements, is_short):
    study = torsion.parse(f"""
name: line
operation: {{speeds: {{from: 20 rpm, to: 126 rpm}}, rated: {{speed: 120 rpm, power: 1000 kW}}}}
materials: {{steel: {{density: 7850, shear_modulus: 79.3 GPa, tensile_strength: 600 MPa}}}}
train:
- motor: {{inertia: 140, ripple: [{{order: 12, torque: 500}}]}}
- shaft: {{name: line, length: 80 m, diameter: 300 mm, material: steel, role: intermediate,
    features: flange, loss_factor: 5 %}}
- propeller: {{inertia: 1, blades: 4, pitch: fixed}}
analyses: {{model: fem, fem: {{elements: {elements}}}, response: }}
rules: [iacs-m68: {{drive: electric}}]
""")
    rows = {row.what: row.restrictions for row in torsion.run(study).checks}
    (size,) = (rows.pop(what) for what in list(rows) if what == "Outer diameter")
    assert (rows.keys(), size) == ({"Torsional stress amplitude, continuous operation"}, ())
    for restrictions in rows.values():
        assert any("% more between them" in words for words in restrictions) != is_short
