"""Slopes of what a fit compares with measurements, against differences in 60 digits of a dense system of equations."""

import mpmath as mp
import numpy as np
import pytest

import torsion
from torsion.what_if.fit.measurements import curves
from torsion.what_if.fit.predictions import Train, resolved_for

FIGURES = {  # of the train below, in the order of their deviations
    "soft.stiffness": 20e3,
    "soft.psi": 0.8,
    "hard.stiffness": 9e4,
    "hard.viscous": 15.0,
    "p.inertia": 0.3,
    "p.damping": 2.5,
    "m.inertia": 1.2,
    "m.ripple.1.torque": 40.0,
    "m.ripple.1.phase": 0.3,
    "d.damping": 30.0,
    "d.ring": 0.4,
}
BY_DIFFERENCES = (
    "p.damping",
    "m.ripple.1.torque",
    "m.ripple.1.phase",
)  # what acts or damps to ground
SCENE = """\
name: Geared drive
operation: {at: m, speeds: {from: 300 rpm, to: 1800 rpm}}
train:
  - damper: {name: d, housing: 0.05, ring: 0.4, damping: 30 N*m*s/rad}
  - motor: {name: m, inertia: 1.2, ripple: [{order: 2, torque: 40 N*m, phase: 0.3 rad}]}
  - coupling: {name: soft, stiffness: 20 kN*m/rad, psi: 0.8}
  - disc: {name: q, inertia: 0.08}
  - gear: {name: g, ratio: 2, inertia: [0.02, 0.05]}
  - coupling: {name: hard, stiffness: 90 kN*m/rad, viscous: 15}
  - disc: {name: p, inertia: 0.3, damping: 2.5}
LINKSanalyses: {modes: {count: 2}, fit: FIT}
"""
LINK = "links: [{between: [m, q], coupling: {name: beside, stiffness: 7 kN*m/rad, psi: 0.4}}]\n"
RPM = (500.0, 731.0, 900.0, 1120.0, 1333.0, 1500.0, 1790.0)


def study(at: str, quantity: str, vary: list[str], links: str = ""):
    unit = {"angle": "rad", "speed": "rad/s", "torque": "N*m"}[quantity]
    rows = ", ".join(f"{{speed: {n!r} rpm, amplitude: 1 {unit}, phase: 0 rad}}" for n in RPM)
    settings = f"""{{vary: {{{", ".join(f"{name}: 9 %" for name in vary)}}}, measured: [
      {{torsiogram: [{rows}], at: {at}, order: 2, quantity: {quantity}, within: 1 %}},
      {{mode: 1, frequency: 40 Hz, within: 1 %}}, {{mode: 2, frequency: 90 Hz, within: 1 %}}]}}"""
    return torsion.parse(SCENE.replace("FIT", settings).replace("LINKS", links))


def trained(one) -> Train:
    made = curves(one, one.analyses["fit"].measured)
    return Train(one.variations["fit"], resolved_for(torsion.assemble(one.train), made), made, 2)


def stiffnesses(figures, s, link):
    """Complex stiffness of the line from the motor to the gear, and of the coupling behind it, of the reference."""
    between = figures["soft.stiffness"] * (1 + 1j * figures["soft.psi"] / (2 * mp.pi) * (s != 0))
    if link:
        between += 7000 * (1 + 1j * mp.mpf(0.4) / (2 * mp.pi) * (s != 0))
    return between, (figures["hard.stiffness"] + s * figures["hard.viscous"]) / 4


def matrix(figures, s, square, link):
    """Dynamic stiffness of motor, gear and pump, all at the speed of the motor; `s` 0 leaves out what damps."""
    first, second = stiffnesses(figures, s, link)
    gear = mp.mpf(0.1) + mp.mpf(0.05) / 4
    a = square * (figures["m.inertia"] + mp.mpf(0.05)) + first
    if s:  # the ring of the damper behind its oil
        ring, oil = square * figures["d.ring"], s * figures["d.damping"]
        a += ring * oil / (ring + oil)
    b = square * gear + first + second
    c = square * figures["p.inertia"] / 4 + s * figures["p.damping"] / 4 + second
    return mp.matrix([[a, -first, 0], [-first, b, -second], [0, -second, c]]), first, second


def answer(figures, at, quantity, rpm, link):
    w = 2 * mp.mpf(rpm) * mp.mpf(float(np.pi / 30.0))
    system, first, second = matrix(figures, mp.mpc(0, w), -w * w, link)
    force = figures["m.ripple.1.torque"] * mp.expj(figures["m.ripple.1.phase"])
    angle = mp.lu_solve(system, mp.matrix([force, 0, 0]))
    if quantity == "torque":
        own = first - 7000 * (1 + 1j * mp.mpf(0.4) / (2 * mp.pi)) if link else first
        return own * (angle[0] - angle[1]) if at == "soft" else 2 * second * (angle[1] - angle[2])
    value = angle[0] if at == "m" else angle[2] / 2
    return value * mp.mpc(0, w) if quantity == "speed" else value


def log_frequency(figures, start, link):
    def determinant(square):
        return mp.det(matrix(figures, mp.mpf(0), -square, link)[0])

    near = (2 * mp.pi * mp.mpf(start)) ** 2
    root = mp.findroot(determinant, (near, near * (1 + mp.mpf(10) ** -9)), tol=1e-80, verify=False)
    return mp.re(mp.log(root)) / 2


def exact_slopes(vary, at, quantity, frequencies, link):
    """(measurements, figures) in the order of `Train.slopes`: modes, logarithms of amplitudes, phases."""
    step, columns = mp.mpf(10) ** -20, []
    for name in vary:
        ends = []
        for sign in (1, -1):
            figures = {key: mp.mpf(value) for key, value in FIGURES.items()}
            figures[name] *= mp.exp(sign * step)
            ends.append(
                [
                    *(log_frequency(figures, one, link) for one in frequencies),
                    *(mp.log(answer(figures, at, quantity, rpm, link)) for rpm in RPM),
                ]
            )
        each = [(high - low) / (2 * step) for high, low in zip(*ends, strict=True)]
        modes, values = each[:2], each[2:]
        columns.append(
            [*map(float, modes), *(float(v.real) for v in values), *(float(v.imag) for v in values)]
        )
    return np.array(columns).T


@pytest.mark.parametrize("links", ["", LINK], ids=["tree", "loop"])
@pytest.mark.parametrize(
    ("at", "quantity"), [("p", "angle"), ("m", "speed"), ("soft", "torque"), ("hard", "torque")]
)
def test_slopes_of_frequencies_amplitudes_and_phases_are_right_to_rounding(
    at, quantity, links
) -> None:
    vary = list(FIGURES)
    train = trained(study(at, quantity, vary, links))
    with mp.workdps(60):
        exact = exact_slopes(
            vary, at, quantity, train.modes([1.0] * len(vary)).frequency, bool(links)
        )
    found = train.slopes(np.zeros(len(vary)), (0, 1), train.curves)
    acts = np.array([name in BY_DIFFERENCES for name in vary])
    assert np.abs(found - exact)[:, ~acts].max() < 1e-14 * np.abs(exact).max()
    assert (np.abs(found - exact)[:, ~acts] < 1e-10 * np.abs(exact)[:, ~acts] + 1e-15).all()
    assert np.abs(found - exact)[:, acts].max() < 1e-10 * np.abs(exact).max()


def differences(train: Train, step: float = 1e-5) -> np.ndarray:
    low, high = (np.log(train.modes([np.exp(end)]).frequency[:2]) for end in (-step, step))
    return (high - low)[:, None] / (2.0 * step)


def test_slopes_of_a_cone_are_those_of_its_file_read_again() -> None:
    shaft = SCENE.replace(
        "coupling: {name: hard, stiffness: 90 kN*m/rad, viscous: 15}",
        "shaft: {name: hard, length: 0.6 m, diameter: [50 mm, 60 mm]}",
    )
    settings = "{vary: {hard.diameter.1: 3 %}, measured: [{frequency: 40 Hz, within: 1 %}]}"
    train = trained(torsion.parse(shaft.replace("FIT", settings).replace("LINKS", "")))
    slopes = train.slopes(np.zeros(1), (0, 1), ())
    assert slopes == pytest.approx(differences(train), rel=1e-8)
    assert slopes != pytest.approx(differences(train), rel=1e-14)


def test_slopes_beside_a_table_are_differences_of_files_read_again() -> None:
    table = SCENE.replace(
        "stiffness: 90 kN*m/rad, viscous: 15",
        "table: {over: frequency, at: [5 Hz, 900 Hz], stiffness: [9e4, 9.5e4], loss_factor: [0.1, 0.1], beyond: hold}",
    )
    settings = "{vary: {p.inertia: 3 %}, measured: [{frequency: 40 Hz, within: 1 %}]}"
    train = trained(torsion.parse(table.replace("FIT", settings).replace("LINKS", "")))
    slopes = train.slopes(np.zeros(1), (0, 1), ())
    assert slopes == pytest.approx(differences(train), rel=1e-10)
    assert (slopes < 0.0).all()
