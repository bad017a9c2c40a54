"""Fits of trains whose figures are known: frequencies in closed form, torsiograms of the true train, and refusals."""

import re
from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from tests.for_all import for_all

import torsion
from torsion.analyses.response.over_speed import response_of_orders
from torsion.errors import InputError
from torsion.findings import Findings
from torsion.output.headline import headline
from torsion.what_if.fit.fit_results import Fit
from torsion.what_if.fit.measurements import curves
from torsion.what_if.fit.predictions import Train, resolved_for

MEASURED = (
    22.977711237348152,
    54.9944875814668042,
    192.812725684694512,
)  # Hz, of 17600, 310000, 51700 N m/rad
NOMINAL = (
    24.0742737742577806,
    53.3289702398578454,
    192.889039168961031,
)  # of the stiffnesses below
TRAIN = """\
name: Four discs
train:
  - disc: {name: d1, inertia: 1.2}
  - coupling: {name: c1, stiffness: 20000}
  - disc: {name: d2, inertia: 0.35}
  - coupling: {name: c2, stiffness: 310 kN*m/rad}  # by the maker
  - disc: {name: d3, inertia: 0.6}
  - coupling: {name: c3, stiffness: 47000, psi: 0.5}
  - disc: {name: d4, inertia: 0.95}
analyses:
  modes: {count: 3}
  fit:
"""
DRIVEN = """\
name: Geared drive
operation: {at: m, speeds: {from: 300 rpm, to: 1800 rpm}}
train:
  - motor: {name: m, inertia: 1.2, ripple: [{order: 2, torque: 40 N*m}]}
  - coupling: {name: soft, stiffness: 20 kN*m/rad, psi: 0.8}
  - gear: {name: g, ratio: 2, inertia: [0.1, 0.05]}
  - shaft: {name: s, length: 0.6 m, diameter: 50 mm}
  - disc: {name: p, inertia: 0.3}
analyses: {modes: {count: 2}, fit: FIT}
"""


def chain(vary: str, *measured: str, text: str = TRAIN) -> str:
    rows = "".join(f"      - {one}\n" for one in measured)
    return f"{text}    vary: {vary}\n    measured:\n{rows}"


@cache
def found(text: str) -> Findings:
    return torsion.run(torsion.parse(text))


def fit(text: str) -> Fit:
    return found(text).need(Fit)


def by_frequency(hertz: float, within: str = "1e-7", mode: int | None = None) -> str:
    number = "" if mode is None else f"mode: {mode}, "
    return f"{{{number}frequency: {hertz!r} Hz, within: {within}}}"


def test_three_frequencies_give_the_three_stiffnesses_of_the_oracle() -> None:
    text = chain(
        "{c1.stiffness: 20 %, c2.stiffness: 20 %, c3.stiffness: 20 %}", *map(by_frequency, MEASURED)
    )
    one = fit(text)
    assert [figure.factor for figure in one.figures] == pytest.approx([0.88, 1.0, 1.1], rel=1e-11)
    assert [figure.fitted for figure in one.figures] == ["17600", "310 kN*m/rad", "51700"]
    assert one.frequency == pytest.approx(MEASURED, rel=1e-12)
    assert [mode.before for mode in one.modes] == pytest.approx(NOMINAL, rel=1e-14)
    assert not one.fails
    assert one.reduced is None


def test_the_fitted_file_keeps_words_and_comments_and_has_the_fitted_frequencies() -> None:
    text = chain(
        "{c1.stiffness: 20 %, c3.stiffness: 20 %}",
        by_frequency(MEASURED[0]),
        by_frequency(MEASURED[1]),
    )
    scene = fit(text).scene
    assert "310 kN*m/rad}  # by the maker" in scene
    assert "fit" not in scene.replace("fitted", "")
    again = torsion.run(torsion.parse(scene))
    assert np.array_equal(again.results["modes"].frequency, fit(text).frequency)


def test_a_file_on_one_line_is_written_anew() -> None:
    one = "{frequency: 20 Hz, within: 1 %}"
    disc = "{disc: {inertia: 1}}"
    text = f"""{{name: a, train: [{disc}, {{coupling: {{stiffness: 9000}}}}, {disc}],
analyses: {{modes: {{count: 1}}, fit: {{vary: {{coupling-1.stiffness: 10 %}}, measured: [{one}]}}}}}}"""
    scene = fit(text).scene
    assert "fit" not in scene
    assert torsion.run(torsion.parse(scene)).results["modes"].frequency == pytest.approx(
        fit(text).frequency, rel=1e-15
    )


def test_what_no_measurement_sees_is_said_and_keeps_its_deviation() -> None:
    text = chain(
        "{c1.stiffness: 20 %, c3.psi: 25 %}", by_frequency(MEASURED[0]), by_frequency(MEASURED[1])
    )
    one = fit(text)
    assert one.rank == 1
    assert one.directions[1].is_unidentified
    assert one.directions[1].words == "c3.psi alone"
    assert any("No measurement identifies c3.psi alone" in words for words in one.warnings)
    assert one.figures[1].deviation == pytest.approx(0.25, rel=1e-12)
    assert one.figures[1].factor == 1.0


def test_frequencies_never_identify_the_common_scale_of_stiffness_and_inertia() -> None:
    two = """\
name: Fixed shaft and disc
train:
  - disc: {name: wall, held: true}
  - coupling: {name: k, stiffness: 20 kN*m/rad}
  - disc: {name: j, inertia: 1}
  - coupling: {name: loose, stiffness: 1 N*m/rad}
  - disc: {name: far, inertia: 1e-4}
analyses:
  modes: {count: 2}
  fit:
"""
    hertz = np.sqrt(20000.0 * 1.1) / (2.0 * np.pi)
    each = by_frequency(float(hertz), "1 %"), by_frequency(15.9, "1 %")
    one = fit(chain("{k.stiffness: 10 %, j.inertia: 10 %}", *each, text=two))
    assert one.directions[1].words == "k.stiffness, j.inertia by a common factor"
    assert one.directions[1].information < 1e-2 * one.directions[0].information


def test_a_frequency_outside_its_band_fails_loudly() -> None:
    findings = found(chain("{c1.stiffness: 5 %}", by_frequency(35.0, "0.5 %", 1)))
    one = findings.need(Fit)
    assert one.modes[0].is_outside
    assert one.fails
    assert findings.failed
    assert findings.exit_status == 1
    assert "lies above the band of that mode" in one.warnings[0]
    assert headline(findings)[1] == "fail"


def test_values_that_contradict_each_other_say_that_none_explain_them() -> None:
    shifted = [
        by_frequency(value * factor, "0.5 %")
        for value, factor in zip(NOMINAL, (1.03, 0.97, 1.0), strict=True)
    ]
    one = fit(chain("{c2.stiffness: 20 %}", *shifted))
    assert one.reduced is not None
    assert one.reduced > 2.0
    assert "The model lacks something" in " ".join(one.warnings)


def test_frequencies_without_numbers_go_to_the_modes_in_whose_bands_they_lie() -> None:
    one = fit(chain("{c1.stiffness: 20 %}", by_frequency(193.0, "1 %"), by_frequency(23.0, "1 %")))
    assert [mode.mode for mode in one.modes] == [3, 1]


def test_no_two_frequencies_go_to_one_mode_and_what_is_left_over_is_outside_its_band() -> None:
    one = fit(chain("{c1.stiffness: 20 %}", by_frequency(25.0, "1 %"), by_frequency(23.0, "1 %")))
    assert sorted(mode.mode for mode in one.modes) == [1, 2]
    assert one.fails


def test_more_frequencies_than_modes_have_no_answer() -> None:
    each = [by_frequency(value, "1 %") for value in (*MEASURED, 400.0)]
    refused = found(chain("{c1.stiffness: 20 %}", *each)).plan.unanswered[0]
    assert refused.why == "of 4 measured natural frequencies the train has 3"


def test_modes_rise_with_the_frequencies_though_others_would_lie_in_more_bands() -> None:
    low = found(
        chain("{c1.stiffness: 20 %}", *(by_frequency(hertz, "1 %") for hertz in (8.0, 23.0, 53.0)))
    ).need(Fit)
    assert [mode.mode for mode in low.modes] == [1, 2, 3]
    assert low.fails


def test_a_frequency_beside_a_named_mode_keeps_its_side() -> None:
    one = fit(
        chain("{c1.stiffness: 20 %}", by_frequency(24.0, "1 %", 2), by_frequency(23.0, "1 %"))
    )
    assert [mode.mode for mode in one.modes] == [2, 1]
    refused = found(
        chain("{c1.stiffness: 20 %}", by_frequency(24.0, "1 %", 1), by_frequency(23.0, "1 %"))
    )
    assert "no mode is left between those that are named" in refused.plan.unanswered[0].why


def test_a_named_mode_is_that_of_no_other_frequency() -> None:
    """Nearest to both is mode 1, which is taken: the higher one goes to mode 2, the lower one of 53 Hz to mode 1."""
    above = fit(
        chain("{c1.stiffness: 20 %}", by_frequency(24.0, "1 %", 1), by_frequency(25.0, "1 %"))
    )
    assert [mode.mode for mode in above.modes] == [1, 2]
    below = fit(
        chain("{c1.stiffness: 20 %}", by_frequency(53.0, "1 %", 2), by_frequency(52.0, "1 %"))
    )
    assert [mode.mode for mode in below.modes] == [2, 1]


def between(first: str, second: str, *measured: float) -> Fit:
    """A heavy disc between two light ones, on couplings of 10 and 11 kN m/rad."""
    discs = [
        f"  - disc: {{name: d{k}, inertia: {inertia}}}\n"
        for k, inertia in enumerate((1, 100, 1), start=1)
    ]
    couplings = [
        f"  - coupling: {{name: c{k}, stiffness: {value}}}\n"
        for k, value in ((1, 10000), (2, 11000))
    ]
    head = f"name: Light, heavy, light\ntrain:\n{discs[0]}{couplings[0]}{discs[1]}{couplings[1]}{discs[2]}"
    text = f"{head}analyses:\n  modes: {{count: 2}}\n  fit:\n"
    each = [
        f"{{mode: {mode}, frequency: {hertz} Hz, within: 0.3 %}}"
        for mode, hertz in enumerate(measured, start=1)
    ]
    return fit(chain(f"{{c1.stiffness: {first}, c2.stiffness: {second}}}", *each, text=text))


def two_modes(first: float, second: float) -> tuple[float, float]:
    """Of that train, Hz: w^4 - w^2 (k1 + k2) 1.01 + k1 k2 1.02 = 0."""
    half, product = 1.01 * (first + second) / 2.0, 1.02 * first * second
    root = np.sqrt(half**2 - product)
    return tuple(
        float(np.sqrt(square) / (2.0 * np.pi)) for square in (product / (half + root), half + root)
    )


@pytest.mark.parametrize("truth", [13000.0, 14500.0])
def test_figures_behind_a_crossing_of_modes_are_found(truth: float) -> None:
    one = between("20 %", "2 %", *two_modes(truth, 11000.0))
    assert one.figures[0].factor == pytest.approx(truth / 10000.0, rel=2e-3)
    assert one.figures[1].factor == pytest.approx(1.0, rel=1e-3)
    assert (one.chi2 < 0.1, one.others, one.warnings) == (True, (), ())


def test_other_figures_that_agree_as_well_are_reported() -> None:
    one = between("20 %", "20 %", *two_modes(12500.0, 9500.0))
    (other,) = one.others
    factors = np.array([one_figure.factor for one_figure in one.figures])
    assert sorted(np.array([10000.0, 11000.0]) * factors) == pytest.approx(
        [9500.0, 12500.0], rel=2e-3
    )
    assert np.array([10000.0, 11000.0]) * other.factor == pytest.approx(
        (np.array([10000.0, 11000.0]) * factors)[::-1], rel=2e-3
    )
    for place, figure in enumerate(one.figures):
        assert figure.lower < min(figure.factor, other.factor[place])
        assert figure.upper > max(figure.factor, other.factor[place])
    assert any(
        words.startswith("Other values agree nearly as well: c1.stiffness")
        for words in one.warnings
    )


def test_what_is_known_is_what_all_minima_agree_on() -> None:
    """Which of two branches is the stiffer stays open, and the product of both is known: half of ln(12500/9500)."""
    one = between("20 %", "20 %", *two_modes(12500.0, 9500.0))
    half = 0.5 * np.log(12500.0 / 9500.0)
    assert [figure.deviation for figure in one.figures] == pytest.approx([half, half], rel=3e-3)
    known = [figure.from_data for figure in one.figures]
    assert known == pytest.approx(2 * [1.0 - (half / 0.2) ** 2], rel=5e-3)
    assert one.correlation[0, 1] == pytest.approx(-1.0, abs=3e-3)
    both, apart = one.directions
    assert both.words == "c1.stiffness, c2.stiffness by a common factor"
    assert both.information == pytest.approx(0.2 / (0.003 * 2.0), rel=1e-3)
    assert apart.information == pytest.approx(np.sqrt(0.2**2 / (2.0 * half**2) - 1.0), rel=0.02)
    assert not apart.is_unidentified


def test_one_frequency_and_one_stiffness_have_the_least_squares_of_a_straight_line() -> None:
    """ln f = ln(k)/2: s = 5 %/(2 * 5 %), shift s r/(1 + s2), residual r/(1 + s2), freedom 1/(1 + s2)."""
    discs = "train: [disc: {inertia: 2}, coupling: {name: c, stiffness: 8e3}, disc: {inertia: 2}]"
    text = f"name: two\n{discs}\nanalyses:\n  modes: {{count: 1}}\n  fit:\n"
    hertz = float(np.sqrt(8e3) * np.exp(-0.3125) / (2.0 * np.pi))
    one = fit(chain("{c.stiffness: 5 %}", by_frequency(hertz, "5 %", 1), text=text))
    s2, r = 0.25, -6.25
    (figure,) = one.figures
    assert figure.shift == pytest.approx(0.5 * r / (1.0 + s2), rel=1e-8)
    assert figure.deviation == pytest.approx(0.05 / np.sqrt(1.0 + s2), rel=1e-8)
    assert one.chi2 == pytest.approx((r / (1.0 + s2)) ** 2, rel=1e-8)
    assert one.freedom == pytest.approx(1.0 / (1.0 + s2), rel=1e-8)
    assert one.reduced == pytest.approx(r**2 / (1.0 + s2), rel=1e-8)
    assert any("c.stiffness moved by -2.5 of its deviations" in words for words in one.warnings)


def test_what_was_measured_is_of_the_file_and_of_none_of_its_cases() -> None:
    settings = of_curve(f"[{GOOD}]", "at: p, quantity: angle")
    whole = found(DRIVEN.replace("FIT", settings) + "cases:\n  short: {remove: [s, p]}\n")
    assert whole.need(Fit).curves[0].at == "p"
    assert "fit" not in whole.cases["short"].results


def test_the_band_of_a_mode_has_every_figure_at_two_deviations() -> None:
    one = fit(
        chain(
            "{c1.stiffness: 20 %, d4.inertia: 10 %}",
            by_frequency(23.0, "1 %"),
            by_frequency(53.0, "1 %"),
        )
    )
    for side, name in ((-1.0, "lower"), (1.0, "upper")):
        stiff, heavy = float(20000.0 * np.exp(0.4 * side)), float(0.95 * np.exp(-0.2 * side))
        plain = TRAIN.removesuffix("  fit:\n")
        text = plain.replace("20000", repr(stiff)).replace("inertia: 0.95", f"inertia: {heavy!r}")
        ends = torsion.run(torsion.parse(text)).results["modes"].frequency
        assert [getattr(mode, name) for mode in one.modes] == pytest.approx(ends[:2], rel=1e-12)


def torsiogram(true: str, at: str, quantity: str, order: int, *, phase: bool = False) -> list[str]:
    """Rows of a torsiogram of the true train, exact."""
    study = torsion.parse(true)
    system = torsion.assemble(study.train, frequency=120.0)
    speed = np.linspace(400.0, 1700.0, 27) * np.pi / 30.0
    one = response_of_orders(study, system, [order], speed)
    if quantity == "torque":
        part = study.train.positions[at]
        values = one.torque[
            :, 0, next(k for k, span in enumerate(system.spans) if span.part == part)
        ]
    else:
        station = next(k for k, each in enumerate(system.stations) if each.name == at)
        values = one.angle[:, 0, station] * (1j * order * speed if quantity == "speed" else 1.0)
    unit = {"angle": "rad", "speed": "rad/s", "torque": "N*m"}[quantity]
    rows = []
    for n, value in zip(speed.tolist(), values.tolist(), strict=True):
        angle = f", phase: {float(np.angle(value))!r} rad" if phase else ""
        rows.append(f"{{speed: {n!r} rad/s, amplitude: {abs(value)!r} {unit}{angle}}}")
    return rows


@pytest.mark.parametrize(
    ("at", "quantity", "phase"),
    [("p", "angle", False), ("m", "speed", True), ("soft", "torque", False)],
)
def test_an_exact_torsiogram_gives_the_true_figures_through_a_gear(
    at: str, quantity: str, phase: bool
) -> None:
    plain = re.sub(", fit: FIT", "", DRIVEN)
    true = (
        plain.replace("20 kN*m/rad", "18 kN*m/rad")
        .replace("psi: 0.8", "psi: 1")
        .replace("a: 0.3", "a: 0.32")
    )
    rows = torsiogram(true, at, quantity, 2, phase=phase)
    settings = f"""{{vary: {{soft.stiffness: 20 %, soft.psi: 30 %, p.inertia: 10 %}}, measured: [
  {{torsiogram: [{", ".join(rows)}], at: {at}, order: 2, quantity: {quantity}, within: 1e-5}}]}}"""
    one = fit(DRIVEN.replace("FIT", settings))
    assert [figure.factor for figure in one.figures] == pytest.approx(
        [0.9, 1.25, 0.32 / 0.3], rel=1e-7
    )
    assert one.curves[0].after == pytest.approx(one.curves[0].measured, rel=1e-5)
    assert not one.fails


def test_slopes_are_the_closed_forms_of_both_energies() -> None:
    text = chain(
        "{c1.stiffness: 20 %, d4.inertia: 10 %}",
        by_frequency(23.0, "1 %"),
        by_frequency(53.0, "1 %"),
    )
    study = torsion.parse(text)
    train = Train(study.variations["fit"], resolved_for(torsion.assemble(study.train), ()), (), 3)
    exact = [
        [0.403343153160794559, -0.164302497776000125],
        [0.0842550621870688425, -0.182110224743479586],
        [0.0124017846521365989, -0.000361471028907385519],
    ]
    assert train.slopes(np.zeros(2), range(3), ()) == pytest.approx(np.array(exact), abs=1e-15)


def two_discs() -> Train:
    """With a torsiogram of three speeds."""
    scene = """\
name: a
operation: {speeds: {from: 300 rpm, to: 1800 rpm}}
train:
  - motor: {name: m, inertia: 1.2, ripple: [{order: 2, torque: 40 N*m}]}
  - coupling: {name: soft, stiffness: 20 kN*m/rad, psi: 0.8}
  - disc: {name: p, inertia: 0.3}
analyses: {modes: {count: 1}, fit: FIT}
"""
    rows = ", ".join(GOOD.replace("600", str(speed)) for speed in (600, 1100, 1400))
    settings = f"{{vary: {{soft.stiffness: 9 %, p.inertia: 9 %}}, measured: [{{torsiogram: [{rows}], at: p, order: 2,"
    study = torsion.parse(scene.replace("FIT", f"{settings} quantity: angle, within: 1 %}}]}}"))
    made = curves(study, study.analyses["fit"].measured)
    return Train(
        study.variations["fit"], resolved_for(torsion.assemble(study.train), made), made, 1
    )


def test_slopes_of_an_amplitude_are_those_of_its_closed_form() -> None:
    """Two discs: |angle| = T |K|/|w^4 J1 J2 - w^2 K (J1 + J2)|, K = k (1 + i psi/2 pi)."""
    train = two_discs()
    w, first, second = 2.0 * train.curves[0].speed, 1.2, 0.3
    stiffness = 20e3 * (1.0 + 1j * 0.8 / (2.0 * np.pi))
    below = w**4 * first * second - w**2 * stiffness * (first + second)
    by_stiffness = (w**4 * first * second / below).real
    by_inertia = -((w**4 * first - w**2 * stiffness) * second / below).real
    exact = np.stack([by_stiffness, by_inertia], axis=1)
    assert train.slopes(np.zeros(2), (), train.curves) == pytest.approx(exact, rel=1e-13)


def test_a_phase_on_the_other_side_of_half_a_revolution_is_near() -> None:
    train = two_discs()
    train.curves = (replace(train.curves[0], has_phase=True),)
    found = train.wrapped(
        np.array([5.0, 4.0, 4.1, 4.2, 6.2, -6.2, 0.1]), 1, train.curves
    )  # a mode, three amplitudes, their phases
    assert found == pytest.approx([5.0, 4.0, 4.1, 4.2, 6.2 - 2.0 * np.pi, 2.0 * np.pi - 6.2, 0.1])


def read_scene(folder: Path, files: Mapping[str, str], settings: str) -> Findings:
    for name, text in files.items():
        (folder / name).write_text(text, encoding="utf-8")
    (folder / "scene.yaml").write_text(DRIVEN.replace("FIT", settings), encoding="utf-8")
    return torsion.run(torsion.read(folder / "scene.yaml"))


def test_a_signal_of_the_slow_shaft_counts_orders_of_the_reference(tmp_path: Path) -> None:
    """Order 2 of the motor is order 4 of the shaft that turns half as fast."""
    plain = torsion.parse(re.sub(", fit: FIT", "", DRIVEN).replace("20 kN*m/rad", "18 kN*m/rad"))
    system = torsion.assemble(plain.train, frequency=120.0)
    speeds = np.linspace(38.0, 185.0, 800)
    station = next(k for k, each in enumerate(system.stations) if each.name == "p")
    sizes = response_of_orders(plain, system, [2], speeds).angle[:, 0, station]
    time = np.arange(0.0, 30.0, 2e-3)
    own = 0.5 * (45.0 + 4.0 * time)  # of the slow shaft
    mean = np.cumsum(own) * 2e-3
    size = np.interp(2.0 * own, speeds, sizes.real) + 1j * np.interp(2.0 * own, speeds, sizes.imag)
    values = own * (1.0 + (4j * size * np.exp(4j * mean)).real)
    rows = "".join(f"{a:.4f},{b:.9f}\n" for a, b in zip(time, values, strict=True))
    settings = """{vary: {soft.stiffness: 20 %}, measured: [
      {signal: run.csv, at: p, orders: [2], within: 3 %, revolutions: 12}]}"""
    one = read_scene(tmp_path, {"run.csv": f"time [s],speed [rad/s]\n{rows}"}, settings).need(Fit)
    assert one.figures[0].factor == pytest.approx(0.9, rel=2e-3)
    assert one.curves[0].speed[0] == pytest.approx(50.92, abs=0.02)


def message(text: str) -> str:
    with pytest.raises(InputError) as caught:
        torsion.run(torsion.parse(text))
    return str(caught.value)


GOOD = "{speed: 600 rpm, amplitude: 0.1 deg}"


def of_curve(rows: str, more: str) -> str:
    return f"{{vary: {{soft.stiffness: 20 %}}, measured: [{{torsiogram: {rows}, order: 2, {more}, within: 1 %}}]}}"


def of_frequencies(vary: str, *more: str) -> str:
    return f"{{vary: {{{vary}}}, measured: [{', '.join(f'{{{one}}}' for one in more)}]}}"


FREQUENCY, SOFT = "frequency: 20 Hz, within: 1 %", "soft.stiffness: 20 %"


@for_all(
    ("settings", "place", "expected"),
    [
        ("{vary: {soft.stiffness: 20 %}}", "9", "`measured` is missing"),
        (of_frequencies("", FREQUENCY), "9:", "the mapping is too short: 0"),
        (
            of_frequencies("soft.stiffness: 20 %, soft.psi: 20 %", FREQUENCY),
            "9:37",
            "2 parameters vary, and 1 value was measured",
        ),
        (of_frequencies("soft.stifness: 20 %", FREQUENCY), "9:44", "soft.stifness"),
        (of_frequencies("soft.loss_factor: 20 %", FREQUENCY), "9:44", "does not give"),
        (of_frequencies("sift.stiffness: 20 %", FREQUENCY), "9:44", "did you mean `soft`"),
        (of_frequencies("m.name: 20 %", FREQUENCY), "9:44", "name"),
        (of_frequencies(SOFT, "frequency: 20 Hz, within: 0"), "9:105", "out of range"),
        (
            of_frequencies(SOFT, "within: 1 %"),
            "9:",
            "`frequency` or `torsiogram` or `signal` is missing",
        ),
        (
            of_frequencies(SOFT, "at: m, " + FREQUENCY),
            "9:",
            "`frequency` and `at` exclude each other",
        ),
        (
            of_frequencies(SOFT, "mode: 1, " + FREQUENCY, "mode: 1, " + FREQUENCY),
            "9:",
            "mode 1 is measured twice",
        ),
        (
            of_frequencies(
                SOFT,
                "mode: 3, frequency: 30 Hz, within: 1 %",
                "mode: 1, " + FREQUENCY,
                "mode: 2, frequency: 19 Hz, within: 1 %",
            ),
            "9:169",
            "mode 2 is measured at 19 Hz, below mode 1 at 20 Hz",
        ),
        (
            of_frequencies(SOFT, "signal: none.csv, at: m, orders: [2], within: 1 %"),
            "9:",
            "cannot be read",
        ),
        (
            of_frequencies(SOFT, "signal: none.csv, at: m, orders: [2, 2], within: 1 %"),
            "9:",
            "an order is named twice",
        ),
        (of_curve(f"[{GOOD}]", "at: m"), "9:", "`torsiogram` needs `quantity`"),
        (
            of_curve(f"[{GOOD}]", "at: m, quantity: angle").replace("order: 2", "order: 3"),
            "9:",
            "no excitation has order 3",
        ),
        (of_curve(f"[{GOOD}]", "at: x, quantity: angle"), "9:", "no component is called 'x'"),
        (of_curve(f"[{GOOD}]", "at: m, quantity: torque"), "9:", "0.1 deg"),
        (of_curve(f"[{GOOD}, {GOOD}]", "at: m, quantity: angle"), "9:", "the speed does not rise"),
        (
            of_curve(f"[{GOOD}]", "at: m, quantity: angle").replace("600", "2600"),
            "9:100",
            "2600 rpm lies outside the speeds 300 to 1800 rpm",
        ),
        (
            of_curve(f"[{GOOD}]", "at: m, quantity: torque").replace("0.1 deg", "5 N*m"),
            "9:",
            "'m' is neither a coupling nor a shaft",
        ),
    ],
)
def test_what_does_not_go_is_refused_where_it_stands(
    settings: str, place: str, expected: str
) -> None:
    words = message(DRIVEN.replace("FIT", settings))
    assert f"train.yaml:{place}" in words
    assert expected in words


def test_a_mode_that_the_train_does_not_have_has_no_answer() -> None:
    findings = found(chain("{c1.stiffness: 20 %}", by_frequency(23.0, "1 %", 9)))
    assert [one.why for one in findings.plan.unanswered] == [
        "mode 9 is not among the 3 of the train"
    ]
    assert findings.exit_status == 2


TABLES = [
    ("speed [rpm],amplitude [deg]\n400,0.1\n300,0.2\n", "run.csv:3:1: the speed does not rise"),
    (
        "speed [rpm],amplitude [deg]\n400,0.1\n2300,0.2\n",
        "run.csv:3:1: 2300 rpm lies outside the speeds",
    ),
    ("speed [rpm],amplitude [N*m]\n400,0.1\n", "run.csv:2:5: angle: "),
    ("speed [rpm],amplitude [kg]\n400,0.1\n", "run.csv:1:13: the unit of the column `amplitude`"),
    ("speed [rpm]\n400\n", "run.csv:1:1: the column `amplitude` is missing"),
    ("speed [rpm],amplitude [deg]\n", "run.csv:1:1: the table has no rows below"),
    ("", "run.csv:1:1: the table has nothing"),
    (
        "speed [rpm],amplitude [deg],phase [deg]\n400,0.1,5\n500,0.1,\n",
        "run.csv:3:1: some rows have a phase",
    ),
    ("speed [rpm],amplitude [deg]\n400,0\n", "run.csv:2:5: angle: 0 deg is out of range"),
    ("speed [rpm],amplitude [deg]\n400,x\n", "run.csv:2:5"),
    ("speed [rpm],amplitud [deg]\n400,1\n", "did you mean `amplitude`?"),
]


@for_all(("table", "expected"), TABLES)
def test_faults_of_a_torsiogram_stand_in_its_file(
    tmp_path: Path, table: str, expected: str
) -> None:
    settings = """{vary: {soft.stiffness: 20 %}, measured: [
      {torsiogram: run.csv, at: m, order: 2, quantity: angle, within: 1 %}]}"""
    with pytest.raises(InputError) as caught:
        read_scene(tmp_path, {"run.csv": table}, settings)
    assert expected in str(caught.value)


def marks(places: list[float]) -> str:
    """A file of pulses, 10 ms apart."""
    return "time [s]\n" + "".join(f"{0.01 * one:.4f}\n" for one in places)


@for_all(
    ("text", "more", "expected"),
    [
        ("time [s]\n0\n0.1\n", ", pulses: 8", "shorter than a window"),
        ("time [s]\n0\n0.2\n0.1\n", ", pulses: 8", "the time does not rise"),
        ("time [s],speed [rpm]\n0,600\n0.1,600\n", "", "samples a revolution"),
        ("time [s],speed [rpm]\n0,600\n0.001,0\n", "", "the speed is not above 0 throughout"),
        (
            marks([0, 1, 2, 3, 5, 6, 7, 8]),
            ", pulses: 8",
            "at 0.05 s pulses are missing, or there is one too many",
        ),
        (marks([0, 1, 2, 3, 3.5, 4, 5, 6, 7]), ", pulses: 8", "at 0.035 s pulses are missing"),
        (marks([0, 1, 2, 3, 4, 5, 7, 8, 9, 10]), ", pulses: 8", "at 0.07 s pulses are missing"),
        ("time [s],speed [rpm]\n0,600\n0.1,600\n", ", pulses: 8", "has 2 columns in line 1, not 1"),
        ("time [s]\n0\n0.1\n", ", pulses: 4", "order 2 needs more than 4 samples"),
    ],
)
def test_faults_of_a_signal(tmp_path: Path, text: str, more: str, expected: str) -> None:
    settings = f"""{{vary: {{soft.stiffness: 20 %}}, measured: [
      {{signal: run.csv, at: m, orders: [2], within: 1 %{more}}}, {{frequency: 20 Hz, within: 1 %}}]}}"""
    with pytest.raises(InputError) as caught:
        read_scene(tmp_path, {"run.csv": text}, settings)
    assert expected in str(caught.value)


def test_a_signal_outside_the_speeds_is_refused(tmp_path: Path) -> None:
    rows = "".join(f"{k * 0.001:.3f}\n" for k in range(2000))
    settings = """{vary: {soft.stiffness: 20 %}, measured: [
      {signal: run.csv, at: m, orders: [2], within: 1 %, pulses: 8, revolutions: 4}]}"""
    with pytest.raises(InputError, match=r"the signal runs from 7500 to 7500 rpm"):
        read_scene(tmp_path, {"run.csv": f"time [s]\n{rows}"}, settings)


def test_a_fit_that_misses_what_was_measured_fails_though_no_measurement_is_left_over(
    tmp_path: Path,
) -> None:
    file = tmp_path / "crossing.yaml"
    file.write_text(
        "name: two branches whose modes cross on the way\n"
        "train:\n"
        "  - disc: {name: a, inertia: 1 kg*m**2}\n"
        "  - coupling: {name: first, stiffness: 10 kN*m/rad}\n"
        "  - disc: {name: hub, inertia: 100 kg*m**2}\n"
        "  - coupling: {name: second, stiffness: 11 kN*m/rad}\n"
        "  - disc: {name: b, inertia: 1 kg*m**2}\n"
        "analyses:\n  modes:\n  fit:\n"
        "    vary: {first.stiffness: 2 %, second.stiffness: 2 %}\n"
        "    measured:\n"
        "      - {mode: 1, frequency: 16.77 Hz, within: 0.1 %}\n"
        "      - {mode: 2, frequency: 25 Hz, within: 0.1 %}\n"
    )
    found = torsion.solve(file, tmp_path / "report").need(Fit)
    assert found.reduced is None
    assert found.chi2 > 100.0
    assert found.fails
    assert any("for each measured value" in words for words in found.warnings)
