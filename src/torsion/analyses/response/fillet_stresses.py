"""Shear stress in stated fillets and notches of shafts: K_t by finite elements, and the stress under the response."""

import math
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

import numpy as np

from torsion.analyses.response.amplitudes import Response, Synthesis
from torsion.arrays import FloatArray
from torsion.assembly.system import System
from torsion.errors import Path, SolveError
from torsion.findings import Work
from torsion.kernels.round_sections import section_modulus
from torsion.kernels.tree_response import Status
from torsion.model.shaft_details import Keyway, Notch
from torsion.primitives import Bar
from torsion.results import derived, reported, result
from torsion.sources import source
from torsion.train import Train

HOLDS = 0.25, 4.0  # height / radius between which the fit of Peterson's chart holds
KEYWAYS = 0.005, 0.07  # radius / diameter, of that of keyways


@reported
class Fillet:
    """A fillet between two shafts, or a notch in one."""

    shaft: str = result("", (), "shaft that ends at the detail, or carries it")
    following: str | None = result("", (), "shaft that begins at it; null for a notch")
    radius: float = result("m", (), "its radius; of a hole half its diameter")
    diameter: float = result("m", (), "smaller diameter")
    larger: float | None = result(
        "m", (), "larger diameter; null for a notch", key="larger_diameter_m"
    )
    modulus: float = result(
        "m**3", (), "W_p of the smaller end, without notches", key="section_modulus_m3"
    )
    factor: float = result("1", (), "K_t: largest shear stress in it / nominal stress, T/W_p")
    error: float | None = result(
        "1", (), "relative error of K_t, from two fields and the last change; null by formula"
    )
    peterson: float | None = result(
        "1",
        (),
        "K_t of a fit of Peterson's charts, to be verified; null for hollow shafts and outside its range",
    )
    endurance: float | None = result(
        "Pa", (), "amplitude of shear that the shafts endure there, as stated"
    )
    speed: float | None = result(
        "rad/s", (), "reference speed of the largest stress; null without a response"
    )
    nominal: float | None = result(
        "Pa", (), "nominal vibratory stress there, amplitude (zero to peak) of all orders"
    )
    peak: float | None = result("Pa", (), "K_t times that")
    utilisation: float | None = result("1", (), "that / endurance; null without both")
    form: str = result("", (), "fillet, keyway, splines or hole")
    spans: tuple[int, ...] = ()

    @derived("", (), "the form, and the shaft that follows a fillet")
    def label(self) -> str:
        """Label for tables and messages."""
        return self.form if self.following is None else f"fillet to {self.following}"

    def torque(self, half_range: FloatArray) -> FloatArray:
        """(speeds,) N m, the largest of its spans; half_range (speeds, spans)."""
        return np.asarray(half_range[:, list(self.spans)].max(axis=1))


@reported
class Fillets:
    """Every stated fillet and notch of the train."""

    each: tuple[Fillet, ...] = result("", (), "fillets and notches", key="")


@source("Pilkey1997", "chart 3.12")
def peterson(height: float, radius: float) -> float | None:
    """K_t in torsion, both in smaller diameters: Pilkey (1997), Peterson's Stress Concentration Factors, chart 3.12.

    >>> round(peterson(0.5, 0.2), 3), peterson(0.5, 0.02)
    (1.252, None)
    """
    ratio, share = height / radius, 2.0 * height / (1.0 + 2.0 * height)
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
    """K_t of a keyway d/4 wide with flanks of d/8, radius / d: Peterson's chart 5.2 after Leven, from memory.

    >>> round(keyway_fit(1 / 48), 2)
    2.59
    """
    share = 0.1 / radius
    return 1.953 + 0.1434 * share - 0.0021 * share**2


def hole_factor(hole: float) -> float:
    """K_t of a radial oil hole, its diameter / that of the shaft, up to 0.2.

    IACS UR M53: largest normal stress over nominal shear, 4 - 6 x + 30 x^2. At the edge of a hole that stress stands
    alone, and the shear of the same distortion energy is it over sqrt(3); half of it would be the shear itself.

    >>> round(hole_factor(0.0), 3)
    2.309
    """
    return (4.0 - 6.0 * hole + 30.0 * hole**2) / math.sqrt(3.0)


def endurance(train: Train, *bars: Bar) -> float | None:
    """Pa, the smallest that these shafts state."""
    return min((e for bar in bars if (e := train.shaft(bar).endurance) is not None), default=None)


def has_judged(train: Train) -> bool:
    """Whether a stated fillet or notch has an endurance."""
    from torsion.assembly.junction.stepped_shafts import corners

    records = [part.shaft for part in train.parts if part.shaft is not None]
    if any(one.notches and one.endurance is not None for one in records):
        return True
    return any(
        step is not None and step.round > 0.0 and endurance(train, one, two) is not None
        for step, one, two, _, _ in corners(train)
    )


def unknown_fillets(train: Train) -> Iterator[tuple[Bar, str]]:
    """The shaft that ends at a corner of no known K_t, one of whose shafts states an endurance; what it is."""
    from torsion.assembly.junction.stepped_shafts import unrounded

    for one, two, words in unrounded(train):
        if endurance(train, one, two) is not None:
            yield one, f"{words} to {two.name}"


def stated_fillets(system: System) -> Iterator[Fillet]:
    """Every stated fillet and notch, without its stress; raises SolveError where the elements have no answer."""
    if any(
        step.round
        for step in (p.shaft.step for p in system.train.parts if p.shaft is not None)
        if step is not None
    ):
        yield from _fillets(system)
    for bar in system.train.bars:
        part = system.train.parts[bar.part]
        for number, notch in enumerate(() if part.shaft is None else part.shaft.notches):
            with _located((*part.path, "notches", number)):
                found = _notch(system, bar, notch)
            yield found


@contextmanager
def _located(path: Path) -> Iterator[None]:
    """Within it, a SolveError is about this place of the file."""
    try:
        yield
    except SolveError as error:
        raise SolveError(error.message, error.hint, path) from error


def _notch(system: System, bar: Bar, notch: Notch) -> Fillet:
    """At the end of the shaft where it stresses most, under the largest torque in it."""
    ends = [
        (outer, float(section_modulus(outer, bore)), _concentration(notch, outer, bore))
        for outer, bore in sorted(set(zip(bar.outer, bar.bore, strict=True)))
    ]
    outer, modulus, (radius, factor, error, fit) = max(ends, key=lambda end: end[2][1] / end[1])
    return Fillet(
        bar.name,
        None,
        radius,
        outer,
        None,
        modulus,
        factor,
        error,
        fit,
        system.train.shaft(bar).endurance,
        None,
        None,
        None,
        None,
        notch.form,
        tuple(np.flatnonzero(system.span_part == bar.part).tolist()),
    )


def _concentration(
    notch: Notch, outer: float, bore: float
) -> tuple[float, float, float | None, float | None]:
    """Radius (m), K_t, its relative error and that of a fit, in a shaft of these diameters (m)."""
    if notch.hole is not None:
        return notch.hole / 2.0, hole_factor(notch.hole / outer), None, None
    from torsion.assembly.section.grooved_sections import groove_stress, keyway, splines

    unit, fit = outer / 2.0, None
    if (one := notch.keyway) is not None:
        section = keyway(
            one.width / unit, one.depth / unit, one.fillet / unit, one.number, bore / outer
        )
        if bore == 0.0 and one.number == 1 and _is_of_chart(one, outer):
            fit = keyway_fit(one.fillet / outer)
        radius = one.fillet
    elif (teeth := notch.splines) is not None:
        section = splines(
            teeth.root / outer, teeth.width / unit, teeth.fillet / unit, teeth.teeth, bore / outer
        )
        radius = teeth.fillet
    found = groove_stress(section)
    return radius, found.factor, found.error, fit


def _is_of_chart(one: Keyway, outer: float) -> bool:
    """Within a tenth of the proportions and within the radii of Peterson's chart of keyways."""
    flank = one.depth - outer / 2.0 + math.sqrt(outer**2 - one.width**2) / 2.0
    near = all(
        abs(size / part - 1.0) <= 0.1
        for size, part in ((one.width, outer / 4.0), (flank, outer / 8.0))
    )
    return near and KEYWAYS[0] <= one.fillet / outer <= KEYWAYS[1]


def _fillets(system: System) -> Iterator[Fillet]:
    from torsion.assembly.junction.fillet_stress import fillet_stress
    from torsion.assembly.junction.stepped_shafts import corners, stressed_profile

    for step, one, two, smaller, larger in corners(system.train):
        if step is None or not step.round:
            continue
        unit, radius = smaller.outer, step.round
        modulus, other = (float(section_modulus(end.outer, end.bore)) for end in (smaller, larger))
        with _located((*system.train.parts[one.part].path, "step")):
            profile, beyond = stressed_profile(system.train, step, smaller, larger)
            stress = fillet_stress(profile, beyond=beyond)
        end = profile.smaller
        scale = float(
            section_modulus(1.0, smaller.bore / unit) / section_modulus(end.outer[0], end.bore[0])
        )
        factor = max(
            stress.factor * scale, modulus / other
        )  # a larger shaft of thin wall endures less beside it
        fit = None
        if step.fillet and not smaller.bore and not larger.bore:
            fit = peterson((larger.outer - unit) / 2.0 / unit, radius / unit)
        yield Fillet(
            one.name,
            two.name,
            radius,
            unit,
            larger.outer,
            modulus,
            factor,
            stress.error,
            fit,
            endurance(system.train, one, two),
            None,
            None,
            None,
            None,
            "fillet",
            _beside(system, one, two, smaller.bar),
        )


def _beside(system: System, one: Bar, two: Bar, smaller: Bar) -> tuple[int, ...]:
    """The span of the smaller shaft that ends or begins at the step: a flange's inertia is not in its torque."""
    at_end = smaller.name == one.name
    part, there = (
        (one.part, system.driven == one.driven)
        if at_end
        else (two.part, system.driving == two.driving)
    )
    return tuple(np.flatnonzero((system.span_part == part) & there).tolist())


def run(work: Work) -> None:
    """Of every shaft whose `step` is a fillet, or which has `notches`."""
    found = []
    with work.log.step(
        "stress in fillets", "a `step` is a fillet, or a shaft has `notches`"
    ) as log:
        for one in stated_fillets(work.system):
            speed, nominal = _worst(work, one)
            peak = None if nominal is None else one.factor * nominal
            used = None if peak is None or one.endurance is None else peak / one.endurance
            found.append(replace(one, speed=speed, nominal=nominal, peak=peak, utilisation=used))
        log.method = "torsion by finite elements, refined in the fillet (scikit-fem)"
        log.size = f"{len(found)} fillets and notches"
        if all(one.error is None for one in found):
            log.method = "by formula"
        else:
            work.log.libraries["scikit-fem"] = None
    work.put(fillets=Fillets(tuple(found)))


def _worst(work: Work, one: Fillet) -> tuple[float | None, float | None]:
    """Speed and nominal stress (Pa) at the largest half range; None without a response that is known everywhere."""
    response, synthesis = work.get(Response), work.get(Synthesis)
    if response is None or synthesis is None or np.any(response.status != Status.OK):
        return None, None
    torque = one.torque(synthesis.half_range)
    at = int(np.argmax(torque))
    return float(response.speed[at]), float(torque[at]) / one.modulus
