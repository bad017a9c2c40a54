"""Shear stress in stated fillets and notches of shafts: K_t by finite elements, and the stress under the response."""

import math
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

import numpy as np

from torsion.analyses.response.amplitudes import Response, Synthesis
from torsion.assembly.system import System
from torsion.errors import Path, SolveError
from torsion.findings import Work
from torsion.kernels.round_sections import section_modulus
from torsion.model.shafts.shaft_details import Notch
from torsion.primitives import Bar
from torsion.results import derived, reported, result
from torsion.sources import source
from torsion.train import Train

HOLDS = 0.25, 4.0  # height / radius between which the fit of Peterson's chart holds
KEYWAYS = 0.005, 0.07  # radius / diameter, of that of keyways


@reported
class Fillet:
    """A fillet between two shafts, or a notch in one."""

    shaft: str = result("shaft that ends at the detail, or carries it")
    following: str | None = result("shaft that begins at it; null for a notch")
    radius: float = result("m", "its radius; of a hole half its diameter")
    diameter: float = result("m", "smaller diameter")
    larger: float | None = result("m", "larger diameter; null for a notch", key="larger_diameter_m")
    modulus: float = result(
        "m**3", "W_p of the smaller end, without notches", key="section_modulus_m3"
    )
    factor: float = result("1", "K_t: largest shear stress in it / nominal stress, T/W_p")
    error: float | None = result(
        "1", "relative error of K_t, from two fields and the last change; null by formula"
    )
    peterson: float | None = result(
        "1",
        "K_t of a fit of Peterson's charts, to be verified; null for hollow shafts and outside its range",
    )
    endurance: float | None = result(
        "Pa", "amplitude of shear that the shafts endure there, as stated"
    )
    form: str = result("fillet, keyway, splines or hole")
    spans: tuple[int, ...]
    speed: float | None = result(
        "rad/s",
        "reference speed of the largest stress; null without a response",
        default=None,
    )
    nominal: float | None = result(
        "Pa",
        "nominal vibratory stress there, amplitude (zero to peak) of all orders",
        default=None,
    )

    @derived("Pa", "K_t times that")
    def peak(self) -> float | None:
        """Largest vibratory stress in the detail, Pa; None without a response."""
        return None if self.nominal is None else self.factor * self.nominal

    @derived("1", "that / endurance; null without both")
    def utilisation(self) -> float | None:
        """Peak stress / endurance; None without both."""
        if self.peak is None or self.endurance is None:
            return None
        return self.peak / self.endurance

    @derived("the form, and the shaft that follows a fillet")
    def label(self) -> str:
        """Label for tables and messages."""
        return self.form if self.following is None else f"fillet to {self.following}"


@reported
class Fillets:
    """The stated fillets and notches of the train."""

    each: tuple[Fillet, ...] = result("fillets and notches", key="")


@source("Pilkey1997", "chart 3.12")
def peterson(height: float, radius: float) -> float | None:
    """Return K_t in torsion, of height and radius in smaller diameters; None outside the chart.

    Pilkey (1997), Peterson's Stress Concentration Factors, chart 3.12.

    >>> round(peterson(0.5, 0.2), 3), peterson(0.5, 0.02)
    (1.252, None)
    """
    ratio = height / radius
    share = 2.0 * height / (1.0 + 2.0 * height)
    if not HOLDS[0] <= ratio <= HOLDS[1]:
        return None
    root = math.sqrt(ratio)
    terms = (
        0.905 + 0.783 * root - 0.075 * ratio,
        -0.437 - 1.969 * root + 0.553 * ratio,
        1.557 + 1.073 * root - 0.578 * ratio,
        -1.061 + 0.171 * root + 0.086 * ratio,
    )
    return sum(term * share**power for power, term in enumerate(terms))


@source("Pilkey1997", "chart 5.2")
def keyway_fit(radius: float) -> float:
    """Return K_t of a keyway d/4 wide with flanks of d/8, radius / d: Peterson's chart 5.2 after Leven, from memory.

    >>> round(keyway_fit(1 / 48), 2)
    2.59
    """
    share = 0.1 / radius
    return 1.953 + 0.1434 * share - 0.0021 * share**2


def hole_factor(hole: float) -> float:
    """Return K_t of a radial oil hole, its diameter / that of the shaft, up to 0.2.

    IACS UR M53: largest normal stress over nominal shear, 4 - 6 x + 30 x^2. At the edge of a hole that stress stands
    alone, and the shear of the same distortion energy is it over sqrt(3); half of it would be the shear itself.

    >>> round(hole_factor(0.0), 3)
    2.309
    """
    return (4.0 - 6.0 * hole + 30.0 * hole**2) / math.sqrt(3.0)


def endurance(train: Train, *bars: Bar) -> float | None:
    """Return the smallest endurance (Pa) that these shafts state; None where none does."""
    stated = [train.shaft(bar).endurance for bar in bars]
    return min((value for value in stated if value is not None), default=None)


def stated_fillets(system: System) -> Iterator[Fillet]:
    """Yield every stated fillet and notch, without its stress; raises SolveError where the elements have no answer."""
    train = system.train
    steps = [part.shaft.step for part in train.parts if part.shaft is not None]
    if any(step.round for step in steps if step is not None):
        yield from _fillets(system)
    for bar in train.bars:
        part = train.parts[bar.part]
        for number, notch in enumerate(() if part.shaft is None else part.shaft.notches):
            with _located((*part.path, "notches", number)):
                ends = [
                    (outer, float(section_modulus(outer, bore)), _concentration(notch, outer, bore))
                    for outer, bore in sorted(set(zip(bar.outer, bar.bore, strict=True)))
                ]
            # At the end of the shaft where it stresses most, under the largest torque in it.
            outer, modulus, concentration = max(ends, key=lambda end: end[2][1] / end[1])
            radius, factor, error, fit = concentration
            sizes = radius, outer, None, modulus, factor, error, fit
            strength = train.shaft(bar).endurance
            spans = tuple(np.flatnonzero(system.span_part == bar.part).tolist())
            yield Fillet(bar.name, None, *sizes, strength, notch.form, spans)


@contextmanager
def _located(path: Path) -> Iterator[None]:
    """Give a SolveError within it this place of the file."""
    try:
        yield
    except SolveError as error:
        raise SolveError(error.message, error.hint, path) from error


def _concentration(
    notch: Notch, outer: float, bore: float
) -> tuple[float, float, float | None, float | None]:
    """Return radius (m), K_t, its relative error and the K_t of a fit, in a shaft of these diameters (m)."""
    if notch.hole is not None:
        return notch.hole / 2.0, hole_factor(notch.hole / outer), None, None
    from torsion.assembly.section.grooved_sections import groove_stress, keyway, splines

    unit = outer / 2.0
    ratio = bore / outer
    fit = None
    if (key := notch.keyway) is not None:
        radius = key.fillet
        section = keyway(key.width / unit, key.depth / unit, radius / unit, key.number, ratio)
        # Peterson's chart holds within a tenth of its proportions and within its radii.
        flank = key.depth - unit + math.sqrt(outer**2 - key.width**2) / 2.0
        proportions = np.array([key.width / (outer / 4.0), flank / (outer / 8.0)])
        is_near = bool((np.abs(proportions - 1.0) <= 0.1).all())
        is_of_chart = is_near and KEYWAYS[0] <= radius / outer <= KEYWAYS[1]
        if bore == 0.0 and key.number == 1 and is_of_chart:
            fit = keyway_fit(radius / outer)
    elif (teeth := notch.splines) is not None:
        radius = teeth.fillet
        sizes = teeth.root / outer, teeth.width / unit, radius / unit
        section = splines(*sizes, teeth.teeth, ratio)
    stress = groove_stress(section)
    return radius, stress.factor, stress.error, fit


def _fillets(system: System) -> Iterator[Fillet]:
    from torsion.assembly.junction.axisymmetric import fillet_stress
    from torsion.assembly.junction.stepped_shafts import corners, stressed_profile

    for step, first, second, smaller, larger in corners(system.train):
        if step is None or not step.round:
            continue
        unit = smaller.outer
        modulus, larger_modulus = (
            float(section_modulus(end.outer, end.bore)) for end in (smaller, larger)
        )
        with _located((*system.train.parts[first.part].path, "step")):
            profile, beyond = stressed_profile(system.train, step, smaller, larger)
            stress = fillet_stress(profile, beyond=beyond)
        end = profile.smaller
        profile_modulus = section_modulus(end.outer[0], end.bore[0])
        scale = float(section_modulus(1.0, smaller.bore / unit) / profile_modulus)
        fit = None
        if step.fillet and not smaller.bore and not larger.bore:
            fit = peterson((larger.outer - unit) / 2.0 / unit, step.round / unit)

        # A flange's inertia is not in the torque of the span of the smaller shaft that meets the step.
        is_near = (system.span_part == second.part) & (system.driving == second.driving)
        if smaller.bar.name == first.name:
            is_near = (system.span_part == first.part) & (system.driven == first.driven)
        yield Fillet(
            shaft=first.name,
            following=second.name,
            radius=step.round,
            diameter=unit,
            larger=larger.outer,
            modulus=modulus,
            # A larger shaft of thin wall endures less than the fillet.
            factor=max(stress.factor * scale, modulus / larger_modulus),
            error=stress.error,
            peterson=fit,
            endurance=endurance(system.train, first, second),
            form="fillet",
            spans=tuple(np.flatnonzero(is_near).tolist()),
        )


def run(work: Work) -> None:
    """Put the stress of every shaft whose `step` is a fillet, or which has `notches`."""
    response = work.get(Response)
    total = work.get(Synthesis)
    is_known = response is not None and not response.unreliable.any()
    with work.log.step(
        "stress in fillets", "a `step` is a fillet, or a shaft has `notches`"
    ) as log:
        details = list(stated_fillets(work.system))
        if response is not None and total is not None and is_known:
            for k, detail in enumerate(details):
                torque = total.half_range[:, list(detail.spans)].max(axis=1)
                speed = int(np.argmax(torque))
                nominal = float(torque[speed]) / detail.modulus
                details[k] = replace(detail, speed=float(response.speed[speed]), nominal=nominal)
        log.size = f"{len(details)} fillets and notches"
        log.method = "by formula"
        if any(detail.error is not None for detail in details):
            log.method = "torsion by finite elements, refined in the fillet (scikit-fem)"
            work.log.libraries["scikit-fem"] = None
    work.put(fillets=Fillets(tuple(details)))
