"""Shear stress in the stated fillets between shafts: K_t by finite elements, and the stress under the response."""

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from torsion.analyses.response.amplitudes import Response, Synthesis
from torsion.assembly.system import System
from torsion.findings import Work
from torsion.kernels.round_sections import section_modulus
from torsion.kernels.tree_response import Status
from torsion.results import reported, result

HOLDS = 0.25, 4.0  # height / radius between which the fit of Peterson's chart holds


@reported
class Fillet:
    """A fillet between two shafts."""

    shaft: str = result("", (), "shaft that ends at it")
    following: str = result("", (), "shaft that begins at it")
    radius: float = result("m", (), "its radius")
    diameter: float = result("m", (), "smaller diameter")
    larger: float = result("m", (), "larger diameter", key="larger_diameter_m")
    modulus: float = result("m**3", (), "section modulus W_p of the smaller end", key="section_modulus_m3")
    factor: float = result("1", (), "K_t: largest shear stress in the fillet / nominal stress of the smaller end")
    error: float = result("1", (), "relative error of K_t, from two fields and the last change")
    peterson: float | None = result(
        "1", (), "K_t of the fit of Peterson's chart, to be verified; null for hollow shafts and where it does not hold"
    )
    endurance: float | None = result("Pa", (), "amplitude of shear that the shafts endure there, as stated")
    speed: float | None = result("rad/s", (), "reference speed of the largest stress; null without a response")
    nominal: float | None = result("Pa", (), "nominal vibratory stress there, half range of all orders")
    peak: float | None = result("Pa", (), "K_t times that")
    utilisation: float | None = result("1", (), "that / endurance; null without both")
    spans: tuple[int, ...] = ()


@reported
class Fillets:
    """Every stated fillet of the train."""

    each: tuple[Fillet, ...] = result("", (), "fillets", key="")


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
        0.905 + 0.783 * root - 0.075 * ratio, -0.437 - 1.969 * root + 0.553 * ratio,
        1.557 + 1.073 * root - 0.578 * ratio, -1.061 + 0.171 * root + 0.086 * ratio,
    )  # fmt: skip
    return sum(term * share**power for power, term in enumerate(terms))


def stated_fillets(system: System) -> Iterator[Fillet]:
    """Every shaft whose `step` is a fillet, without its stress; raises SolveError where the elements have no answer."""
    from torsion.assembly.junction.fillet_stress import fillet_stress
    from torsion.assembly.junction.stepped_shafts import filleted, profile_of

    for step, one, two, smaller, larger in filleted(system.train):
        unit, radius = smaller.outer, step.size
        stress = fillet_stress(profile_of(step, smaller, larger))
        modulus = float(section_modulus(smaller.outer, smaller.bore))
        spans = np.flatnonzero(system.span_part == one.part)[-1:]
        limits = [e for bar in (one, two) if (e := system.train.shaft(bar).endurance) is not None]
        fit = None if smaller.bore or larger.bore else peterson((larger.outer - unit) / 2.0 / unit, radius / unit)
        yield Fillet(
            one.name, two.name, radius, unit, larger.outer, modulus, stress.factor, stress.error, fit,
            min(limits, default=None), None, None, None, None, (int(spans[0]),),
        )  # fmt: skip


def run(work: Work) -> None:
    """Of every shaft whose `step` is a fillet."""
    found = []
    with work.log.step("stress in fillets", "a `step` is a fillet") as log:
        for one in stated_fillets(work.system):
            speed, nominal = _worst(work, one.spans[0], one.modulus)
            peak = None if nominal is None else one.factor * nominal
            used = None if peak is None or one.endurance is None else peak / one.endurance
            found.append(replace(one, speed=speed, nominal=nominal, peak=peak, utilisation=used))
        log.method = "axisymmetric torsion by finite elements, refined in the fillet (scikit-fem)"
        log.size = f"{len(found)} fillets"
    work.log.libraries["scikit-fem"] = None
    work.put(fillets=Fillets(tuple(found)))


def _worst(work: Work, span: int, modulus: float) -> tuple[float | None, float | None]:
    """Speed and nominal stress (Pa) at the largest half range; None without a response that is known everywhere."""
    response, synthesis = work.get(Response), work.get(Synthesis)
    if response is None or synthesis is None or np.any(response.status != Status.OK):
        return None, None
    at = int(np.argmax(synthesis.half_range[:, span]))
    return float(response.speed[at]), float(synthesis.half_range[at, span]) / modulus
