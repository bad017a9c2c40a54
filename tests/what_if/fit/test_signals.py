"""Fits to raw signals over time: what noise and faults of a recording do to the figures, and where they are refused."""

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from tests.for_all import for_all

import torsion
from torsion.analyses.response.over_speed import response_of_orders
from torsion.errors import InputError
from torsion.findings import Findings
from torsion.what_if.fit.fit_results import Fit

TRUE = 0.9  # of the stiffness in the file
TRAIN = """\
name: Drive
operation: {at: m, speeds: {from: 300 rpm, to: 1800 rpm}}
train:
  - motor: {name: m, inertia: 1.2, ripple: [{order: 0.1, torque: 1}, {order: 2, torque: 40}, {order: 2.02, torque: 1}]}
  - coupling: {name: soft, stiffness: 20000, psi: 0.8}
  - disc: {name: p, inertia: 0.3}
analyses: {modes: {count: 1}, fit: FIT}
"""
MARKS, STEP = 60, 5e-4


@cache
def recorded() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Time, angle and speed of the motor over a run-up of 10 s, of order 2 alone."""
    study = torsion.parse(TRAIN.replace(", fit: FIT", "").replace("20000", str(20000 * TRUE)))
    speeds = np.linspace(50.0, 160.0, 2000)
    found = response_of_orders(study, torsion.assemble(study.train), [2], speeds).angle[:, 0, 0]
    time = np.arange(0.0, 10.0, STEP)
    mean, own = 60.0 * time + 4.0 * time**2, 60.0 + 8.0 * time
    size = np.interp(own, speeds, found.real) + 1j * np.interp(own, speeds, found.imag)
    wave = size * np.exp(2j * mean)
    return time, mean + wave.real, own * (1.0 + (2j * wave).real)


@cache
def marks() -> np.ndarray:
    """Times at which they pass."""
    time, angle, _ = recorded()
    step = 2.0 * np.pi / MARKS
    return np.interp(np.arange(np.ceil(angle[0] / step), angle[-1] / step) * step, angle, time)


def of_speed(time: np.ndarray, speed: np.ndarray) -> str:
    return "time [s],speed [rad/s]\n" + "".join(
        f"{a:.6f},{b:.9f}\n" for a, b in zip(time, speed, strict=True)
    )


def of_marks(time: np.ndarray) -> str:
    return "time [s]\n" + "".join(f"{one:.9f}\n" for one in time)


def solved(folder: Path, signal: str | bytes, more: str) -> Findings:
    (folder / "run.csv").write_bytes(signal if isinstance(signal, bytes) else signal.encode())
    settings = f"{{vary: {{soft.stiffness: 20 %}}, measured: [{{signal: run.csv, at: m, {more}, within: 3 %}}]}}"
    (folder / "scene.yaml").write_text(TRAIN.replace("FIT", settings), encoding="utf-8")
    return torsion.run(torsion.read(folder / "scene.yaml"))


PULSES = f"orders: [2], pulses: {MARKS}"


def test_pulses_give_the_true_stiffness(tmp_path: Path) -> None:
    one = solved(tmp_path, of_marks(marks()), PULSES).need(Fit)
    assert one.figures[0].factor == pytest.approx(TRUE, rel=1e-3)
    assert not one.fails


def test_jitter_widens_the_deviations_of_a_signal_and_leaves_the_figures_true(
    tmp_path: Path,
) -> None:
    """Seeded, 0.3 % of the distance of the marks: weak amplitudes drown and are not used."""
    rng, time = np.random.default_rng(2), marks()
    jitter = 0.003 * np.gradient(time) * rng.standard_normal(time.size)
    (curve,), figure = (
        (one := solved(tmp_path, of_marks(time + jitter), PULSES).need(Fit)).curves,
        one.figures[0],
    )
    assert figure.lower < TRUE < figure.upper
    assert one.chi2 < 2.0 * one.freedom
    assert not one.fails
    assert curve.unused == 1
    assert (curve.deviation >= curve.within).all()
    assert (curve.deviation < np.hypot(0.03, 0.1)).all()


def test_a_signal_that_rises_and_falls_again_is_one_curve(tmp_path: Path) -> None:
    time, _, speed = recorded()
    both = np.concatenate([time, time + time[-1] + STEP]), np.concatenate([speed, speed[::-1]])
    one = solved(tmp_path, of_speed(*(each[::4] for each in both)), "orders: [2]").need(Fit)
    assert one.figures[0].factor == pytest.approx(TRUE, rel=2e-3)
    assert (np.diff(one.curves[0].speed) >= 0.0).all()


def test_decimal_commas_between_semicolons_are_read(tmp_path: Path) -> None:
    time, _, speed = recorded()
    text = of_speed(time[::4], speed[::4])
    found = [
        solved(tmp_path, one, "orders: [2]").need(Fit).figures[0].factor
        for one in (
            text,
            text.replace(",", ";").replace(".", ","),
            "\ufeff" + text.replace("\n", "\r\n"),
        )
    ]
    assert found[0] == found[1] == found[2]


def without(places: slice) -> str:
    time, _, speed = recorded()
    kept = np.ones(time.size, dtype=bool)
    kept[places] = False
    return of_speed(time[kept][::4], speed[kept][::4])


LOST = "pulses are missing, or there is one too many"
REFUSED = {
    "pulse lost": (lambda: of_marks(np.delete(marks(), 500)), PULSES, LOST),
    "second pulse lost": (lambda: of_marks(np.delete(marks(), 1)), PULSES, LOST),
    "last but one lost": (lambda: of_marks(np.delete(marks(), -2)), PULSES, LOST),
    "marks with a gap": (lambda: of_marks(marks()[np.arange(marks().size) % 60 > 1]), PULSES, LOST),
    "pulse too many": (
        lambda: of_marks(np.sort(np.append(marks(), marks()[:2].mean()))),
        PULSES,
        LOST,
    ),
    "jitter": (
        lambda: of_marks(marks() + 2e-3 * np.sin(np.arange(marks().size) ** 2)),
        PULSES,
        "line",
    ),
    "reversed": (lambda: of_marks(marks()[::-1]), PULSES, "line 3: the time does not rise"),
    "twice": (lambda: of_marks(np.repeat(marks(), 2)), PULSES, "line 3: the time does not rise"),
    "half the marks": (
        lambda: of_marks(marks()),
        "orders: [2], pulses: 30",
        "does not exceed the noise",
    ),
    "other marks": (
        lambda: of_marks(marks()),
        "orders: [2], pulses: 8",
        "outside the speeds of `operation`",
    ),
    "gap": (
        lambda: without(slice(9000, 9200)),
        "orders: [2]",
        "after 4.498 s samples are missing, for 0.102 s",
    ),
    "gap at once": (lambda: without(slice(1, 200)), "orders: [2]", "after 0 s samples are missing"),
    "coarse": (
        lambda: of_speed(*(one[::40] for one in recorded()[::2])),
        "orders: [2]",
        "order 2 needs more than 4",
    ),
    "close": (
        lambda: of_marks(marks()),
        f"orders: [2.02, 2], pulses: {MARKS}",
        "orders 2 and 101/50 differ by 0.32 cycles in a window of 16 revolutions (1 are",
    ),
    "slow": (
        lambda: of_marks(marks()),
        f"orders: [2, 0.1], pulses: {MARKS}",
        "order 1/10 has 1.6 cycles in a window of 16 revolutions (3 are needed: `revolutions: 30`)",
    ),
    "latin": (
        lambda: "Zeit [s];Drehzahl [°/s]\n0;1\n1;2\n".encode("latin-1"),
        "orders: [2]",
        "cannot be read",
    ),
    "other code": (lambda: of_marks(marks()).encode("utf-16"), PULSES, "cannot be read"),
    "decimal commas": (
        lambda: of_marks(marks()).replace(".", ","),
        PULSES,
        "decimal commas and semicolons",
    ),
    "no number": (
        lambda: "time [s],speed [rpm]\n0,600\n1,nan\n2,600\n",
        "orders: [2]",
        "line 3: a finite speed",
    ),
}


@for_all("name", REFUSED)
def test_a_faulty_signal_is_refused_where_it_is_named(name: str, tmp_path: Path) -> None:
    made, more, expected = REFUSED[name]
    with pytest.raises(InputError) as caught:
        solved(tmp_path, made(), more)
    assert "scene.yaml:7:" in str(caught.value)
    assert expected in str(caught.value)
