"""Chapters: dampers beside their optimum rings, and centrifugal pendulums by order."""

import math
from collections.abc import Iterator

from torsion.analyses.modes.damper_optimum import Dampers
from torsion.analyses.response.pendulums import Pendulums
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, table
from torsion.output.numbers import rpm

DAMPERS = (
    "Each mode of the train without the ring is one undamped mass, with the modal inertia at the housing. The"
    " optimum ring minimises the peak magnification (amplitude / static twist): viscous (Den Hartog), or "
    "tuned with a spring and viscous damping (Nishihara and Asami). Use this as a first estimate. Check it in"
    " the forced response, which includes all modes, the damping and the excitation."
)
FAR = math.radians(30.0)  # deflection from which a linear pendulum misses its order by 2 % and more
PENDULUMS = (
    "A pendulum of order q = sqrt(R/l) adds the inertia m (R + l)²/(1 − n²/q²) to its carrier at order n. The"
    " inertia is larger than the mass inertia below q and negative above; at n = q the carrier is fixed for "
    "this order. The restoring force is the centrifugal force, so that natural frequencies depend on the "
    "speed. Modes are for {} rpm. At rest the bobs add nothing."
)
LINEAR = (
    "Deflections are linear. On a circular path a deflection φ lowers the order by about φ²/16 (1.7 % at 30 "
    "degrees). Larger deflections: {}."
)


def dampers(findings: Findings) -> Iterator[Block]:
    """Yield the rings beside what would be best for each mode that they reach; nothing where none reaches one."""
    optima = findings.need(Dampers).each
    if optima:
        yield Heading("Dampers")
        yield Paragraph(DAMPERS)
        yield table(
            "damper: < Damper -> | mode: Mode without the ring -> mode | frequency: Frequency [Hz] -> Hz | "
            "inertia: Modal inertia [kg m²] | ratio: Ring / modal inertia:4 | "
            "viscous: Optimum viscous c [N m s/rad] -> viscous c | viscous_peak: Magnification, viscous:4 | "
            "stiffness: Optimum k, tuned [N m/rad] -> tuned k | damping: Optimum c, tuned [N m s/rad] -> tuned c | "
            "tuned_peak: Magnification, tuned:4 | given_peak: Magnification as given:4g -> as given",
            optima,
            "Optimum damper rings, at the speed of the damper",
            short="Optimum damper rings",
        )


def pendulums(findings: Findings) -> Iterator[Block]:
    """Yield the inertia that each order meets at every pendulum, and the deflection of its bobs."""
    result = findings.need(Pendulums)
    yield Heading("Pendulums")
    yield Paragraph(PENDULUMS.format(rpm(result.speed)))
    far = [pendulum.pendulum for pendulum in result.each if (pendulum.deflection or 0.0) > FAR]
    if far:
        yield Paragraph(LINEAR.format(", ".join(far)), "note")
    yield table(
        "pendulum: < Pendulum -> | tuned: Tuned to order:8g -> order | inertia: Inertia of the bobs [kg m²]:7 | "
        "deflection: Maximum deflection [deg] -> deg | speed: Speed [rpm] -> rpm",
        result.each,
        "Pendulums, at the speed of their shaft",
    )
    rows = [(pendulum, order) for pendulum in result.each for order in pendulum.at_orders]
    if rows:
        yield table(
            "pendulum: < Pendulum -> | order: Order of the shaft:o -> order | inertia: Inertia [kg m²]:7 | "
            "deflection: Deflection [deg] -> deg | speed: Speed [rpm] -> rpm",
            rows,
            "Inertia and deflection of pendulums by order",
        )
