"""Intervals of a fit over many synthetic measurements: `python -m benchmarks.fits` writes reports/fits.md."""

import re
import time
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

import torsion
from benchmarks.page_file import Report, verdict
from torsion.analyses.response.over_speed import response_of_orders
from torsion.study import Study
from torsion.what_if.fit.fit_results import Fit

SCENE = """\
name: Drive with a gear
operation: {at: motor, speeds: {from: 300 rpm, to: 1800 rpm}}
train:
  - motor: {name: motor, inertia: 1.2, ripple: [{order: 2, torque: 40 N*m}, {order: 4, torque: 20 N*m}]}
  - coupling: {name: soft, stiffness: 20 kN*m/rad, psi: 0.8}
  - gear: {name: gear, ratio: 2, inertia: [0.1, 0.05]}
  - coupling: {name: stiff, stiffness: 60 kN*m/rad, viscous: 12}
  - disc: {name: pump, inertia: 0.3}
"""
PRIOR = {"soft.stiffness": 15, "soft.psi": 25, "stiff.stiffness": 10, "pump.inertia": 5}  # %
SPEEDS = np.linspace(320.0, 1780.0, 30)  # rpm
WITHIN = 0.05  # of an amplitude
FREQUENCY = 0.005
TARGET = 0.93, 0.97
STIFFNESSES = "soft.stiffness", "stiff.stiffness"
MEASURED = {  # figures that vary, whether both frequencies, and which torsiograms
    "two frequencies": (STIFFNESSES, True, ()),
    "torsiogram of the motor": (tuple(PRIOR), False, (("motor", 2, "angle"),)),
    "frequencies, torsiograms of motor and pump": (
        tuple(PRIOR),
        True,
        (("motor", 2, "angle"), ("pump", 4, "angle")),
    ),
    "frequencies, torque of the soft coupling": (tuple(PRIOR), True, (("soft", 2, "torque"),)),
}
UNITS = {"angle": "rad", "torque": "N*m"}
WORDS = """A geared drive of three inertias and two couplings. Of every fit the true values are drawn from what the
file states of them (log-normal: 15 % of the soft coupling's stiffness, 25 % of its psi, 10 % of the stiff one, 5 % of
the pump's inertia), the true drive is solved the ordinary way, what is measured is scattered by its stated deviation
(0.5 % of a frequency, 5 % of each of 30 amplitudes), and the fit starts from the file. Counted are the 95 % intervals
that hold the true value, with the 95 % error of that share; where there are other minima they reach over all. Time is
that of the process, the fitted file and its curves included."""


@dataclass
class Counted:
    """What the fits of one kind of measurement found."""

    fits: int = 0
    intervals: int = 0
    inside: int = 0  # of these hold the truth
    several: int = 0  # fits with other minima
    chi2: float = 0.0
    freedom: float = 0.0
    seconds: float = 0.0


def scene(factors: dict[str, float], settings: str = "") -> Study:
    """The drive with figures at factors."""
    text = SCENE
    for name, factor in factors.items():
        component, key = name.split(".")
        pattern = rf"(name: {component},.*?{key}: )([0-9.]+)"
        text = re.sub(pattern, lambda found, by=factor: f"{found[1]}{float(found[2]) * by!r}", text)
    return torsion.parse(f"{text}analyses: {{modes: {{count: 2}}{settings}}}\n")


def amplitude(true: Study, at: str, order: int, quantity: str) -> np.ndarray:
    """(speeds,) of the true drive, solved the ordinary way."""
    system, speed = torsion.assemble(true.train, frequency=150.0), SPEEDS * np.pi / 30.0
    found = response_of_orders(true, system, [Fraction(order)], speed)
    if quantity == "torque":
        return np.abs(
            found.torque[:, 0, next(k for k, one in enumerate(system.spans) if one.name == at)]
        )
    return np.abs(
        found.angle[:, 0, next(k for k, one in enumerate(system.stations) if one.name == at)]
    )


def settings(true: Study, rng: np.random.Generator, kind: str) -> str:
    """A fit to what is measured of the true drive, scattered."""
    names, with_frequencies, each = MEASURED[kind]
    rows = []
    if with_frequencies:
        hertz = torsion.modes(torsion.assemble(true.train), 2).frequency * np.exp(
            FREQUENCY * rng.standard_normal(2)
        )
        rows += [
            f"{{mode: {k}, frequency: {one!r} Hz, within: {FREQUENCY!r}}}"
            for k, one in enumerate(hertz.tolist(), start=1)
        ]
    for at, order, quantity in each:
        values = amplitude(true, at, order, quantity) * np.exp(
            WITHIN * rng.standard_normal(len(SPEEDS))
        )
        points = ", ".join(
            f"{{speed: {n!r} rpm, amplitude: {v!r} {UNITS[quantity]}}}"
            for n, v in zip(SPEEDS.tolist(), values.tolist(), strict=True)
        )
        rows.append(
            f"{{torsiogram: [{points}], at: {at}, order: {order}, quantity: {quantity}, within: {WITHIN!r}}}"
        )
    vary = ", ".join(f"{name}: {PRIOR[name]} %" for name in names)
    return f", fit: {{vary: {{{vary}}}, measured: [{', '.join(rows)}]}}"


def counted(kind: str, seeds: int) -> Counted:
    """Fits of drives drawn from what is known of them beforehand."""
    whole = Counted()
    for seed in range(seeds):
        rng = np.random.default_rng([seed, list(MEASURED).index(kind)])
        factors = {
            name: float(np.exp(0.01 * PRIOR[name] * rng.standard_normal()))
            for name in MEASURED[kind][0]
        }
        words = settings(scene(factors), rng, kind)
        begin = time.process_time()
        found = torsion.run(scene({}, words)).need(Fit)
        whole.seconds += time.process_time() - begin
        whole.fits += 1
        whole.several += bool(found.others)
        whole.chi2, whole.freedom = whole.chi2 + found.chi2, whole.freedom + found.freedom
        for figure in found.figures:
            whole.intervals += 1
            whole.inside += figure.lower <= factors[figure.name] <= figure.upper
    return whole


def rows(seeds: int) -> Iterator[str]:
    """A line of the table for each kind."""
    for kind in MEASURED:
        one = counted(kind, seeds)
        share = one.inside / one.intervals
        half = 1.96 * np.sqrt(share * (1.0 - share) / one.intervals)
        chi2 = f"{one.chi2 / one.freedom:.2f}" if one.freedom > one.fits else "none left over"
        yield (
            f"| {kind} | {one.fits} | {one.intervals} | {100 * share:.1f} ± {100 * half:.1f} % | "
            f"{verdict(TARGET[0] <= share <= TARGET[1])} | {one.several} | {chi2} | "
            f"{1e3 * one.seconds / one.fits:.0f} |"
        )


def main() -> None:
    """The page."""
    report = Report(__doc__, "fits", seeds=250)
    head = "| measured | fits | intervals | hold the truth | 93 to 97 % | other minima | chi2 / freedom | ms a fit |"
    report.publish(
        "Intervals of fits",
        [WORDS, "\n".join([head, "|---|---|---|---|---|---|---|---|", *rows(report.chosen.seeds)])],
    )


if __name__ == "__main__":
    main()
