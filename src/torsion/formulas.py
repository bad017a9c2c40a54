"""Formulas that the program uses, as functions: keywords only, SI units in and out, each with its source.

An angle is in rad, a speed in rad/s, a stress in Pa. Arguments that take an array give an array.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from torsion.arrays import FloatArray
from torsion.kernels import ring_damper
from torsion.kernels.engine import crank_slider
from torsion.kernels.engine.crank_slider import CrankSlider
from torsion.kernels.joints import cross
from torsion.kernels.round_sections import polar_area_moment, section_modulus
from torsion.rules.class_rules import m68_shafts
from torsion.rules.strength import shrink_fits

__all__ = [
    "cross_joint_fluctuation",
    "cross_joint_ratio",
    "m68_continuous_stress",
    "m68_minimum_diameter",
    "m68_transient_stress",
    "reciprocating_inertia",
    "round_shaft_stiffness",
    "round_shaft_stress",
    "shaft_inertia",
    "shrink_fit_torque",
    "throw_stiffness_carter",
    "throw_stiffness_ker_wilson",
    "tuned_damper_optimum",
    "viscous_damper_optimum",
]
MPA = 1e6  # Pa
MM = 1e-3  # m
Cylinder = tuple[float, float, float]  # m: diameter, bore, length


class DamperOptimum(NamedTuple):
    """The ring that minimises the peak magnification of a mode."""

    stiffness: float  # N m/rad between ring and housing; 0 for a viscous damper
    damping: float  # N m s/rad
    magnification: float  # amplitude of the mode / its static twist


def round_shaft_stiffness(
    *, length: ArrayLike, diameter: ArrayLike, bore: ArrayLike = 0.0, shear_modulus: float
) -> FloatArray:
    """Return k = π G (D⁴ - d⁴)/(32 L) of a cylindrical shaft, N m/rad. Source: Coulomb 1784, strength of materials.

    With a length of π/32 m and a diameter of 1 m it is G · 1 m³:

    >>> round(float(round_shaft_stiffness(length=np.pi / 32, diameter=1, shear_modulus=80e9)))
    80000000000
    """
    return np.asarray(
        shear_modulus * polar_area_moment(diameter, bore) / np.asarray(length, dtype=float)
    )


def round_shaft_stress(
    *, torque: ArrayLike, diameter: ArrayLike, bore: ArrayLike = 0.0
) -> FloatArray:
    """Return τ = 16 T D/(π (D⁴ - d⁴)), the nominal shear stress at the surface, Pa. Source: strength of materials.

    >>> round(float(round_shaft_stress(torque=np.pi / 16 * 50e6 * 0.1**3, diameter=0.1)) / 1e6, 9)  # T = W · 50 MPa
    50.0
    """
    return np.asarray(np.asarray(torque, dtype=float) / section_modulus(diameter, bore))


def shaft_inertia(
    *, length: ArrayLike, diameter: ArrayLike, bore: ArrayLike = 0.0, density: float
) -> FloatArray:
    """Return J = π ρ L (D⁴ - d⁴)/32 of a cylinder, kg m². Source: mechanics of rigid bodies.

    A disc of 100 kg and 0.4 m radius has J = m r²/2 = 8 kg m²:

    >>> round(float(shaft_inertia(length=100 / (8000 * np.pi * 0.4**2), diameter=0.8, density=8000)), 9)
    8.0
    """
    return np.asarray(density * np.asarray(length, dtype=float) * polar_area_moment(diameter, bore))


def throw_stiffness_carter(
    *,
    journal: Cylinder,
    pin: Cylinder,
    web: tuple[float, float],
    radius: float,
    shear_modulus: float,
) -> float:
    """Return the stiffness of a crank throw, N m/rad. Source: Carter, in Nestorides 1958 (edition not confirmed).

    journal, pin: (diameter, bore, length); web: (thickness, width), m. With all diameters and the web 1 m, journal and
    pin 1 m long and a radius of 1 m, the equivalent length is 1 + 0.8 + 0.75 + 1.5 = 4.05 m of a shaft of 1 m diameter:

    >>> k = throw_stiffness_carter(journal=(1, 0, 1), pin=(1, 0, 1), web=(1, 1), radius=1, shear_modulus=80e9)
    >>> round(k / (80e9 * np.pi / 32 / 4.05), 12)
    1.0
    """
    return crank_slider.carter(crank_slider.Throw(journal, pin, web, radius), shear_modulus)


def throw_stiffness_ker_wilson(
    *,
    journal: Cylinder,
    pin: Cylinder,
    web: tuple[float, float],
    radius: float,
    shear_modulus: float,
) -> float:
    """Return the stiffness of a crank throw, N m/rad. Source: Ker Wilson, in Nestorides 1958 (edition not confirmed).

    As in `throw_stiffness_carter`; the equivalent length is 1.4 + 1.4 + (1 - 0.4) = 3.4 m:

    >>> k = throw_stiffness_ker_wilson(journal=(1, 0, 1), pin=(1, 0, 1), web=(1, 1), radius=1, shear_modulus=80e9)
    >>> round(k / (80e9 * np.pi / 32 / 3.4), 12)
    1.0
    """
    return crank_slider.ker_wilson(crank_slider.Throw(journal, pin, web, radius), shear_modulus)


def reciprocating_inertia(*, mass: float, stroke: float, rod_length: float) -> float:
    """Return the mean inertia of a reciprocating mass over a revolution, kg m². Source: exact crank and rod motion.

    With a very long rod it is m r²/2:

    >>> round(reciprocating_inertia(mass=2, stroke=0.2, rod_length=1000), 9)
    0.01
    """
    crank = CrankSlider.of_stroke(stroke, rod_length)
    return float(crank.inertia_harmonics(0, mass)[0].real)


def viscous_damper_optimum(*, ring: float, inertia: float, frequency: float) -> DamperOptimum:
    """Return the best viscous damper of a mode. Source: Den Hartog, Mechanical Vibrations, 1956, eq. 3.21.

    ring: kg m²; inertia: of the mode at the housing, kg m²; frequency: of the mode, Hz. Where both inertias are equal
    the peak magnification is 1 + 2/1 and the damping 2 J ω/√12:

    >>> optimum = viscous_damper_optimum(ring=1, inertia=1, frequency=1 / (2 * np.pi))
    >>> round(optimum.magnification, 9), round(optimum.damping * math.sqrt(12), 9)
    (3.0, 2.0)
    """
    return _optimum(ring_damper.viscous(ring / inertia), ring, frequency)


def tuned_damper_optimum(*, ring: float, inertia: float, frequency: float) -> DamperOptimum:
    """Return the best damper on a spring. Source: Nishihara and Asami, J. Vib. Acoust. 124, 2002, p. 576.

    For a light ring it approaches Den Hartog's magnification √(1 + 2/μ) and stiffness J ω²/(1 + μ)², here μ = 0.02:

    >>> optimum = tuned_damper_optimum(ring=0.02, inertia=1, frequency=1 / (2 * np.pi))
    >>> round(optimum.magnification / math.sqrt(101), 3), round(optimum.stiffness / (0.02 / 1.02**2), 3)
    (1.0, 1.0)
    """
    return _optimum(ring_damper.tuned(ring / inertia), ring, frequency)


def _optimum(optimum: ring_damper.Optimum, ring: float, frequency: float) -> DamperOptimum:
    speed = 2.0 * math.pi * frequency
    return DamperOptimum(
        ring * (speed * optimum.tuning) ** 2,
        2.0 * ring * speed * optimum.damping,
        optimum.magnification,
    )


def cross_joint_ratio(*, driving_angle: ArrayLike, joint_angle: ArrayLike) -> FloatArray:
    """Return driven speed / driving speed of a universal joint. Source: tan(out) = tan(in)/cos(joint angle).

    The driving angle counts from where the driving yoke lies in the plane of both shafts. There the ratio is
    1/cos 60° = 2, and a quarter of a revolution later cos 60°:

    >>> cross_joint_ratio(driving_angle=[0, np.pi / 2], joint_angle=np.pi / 3).round(9).tolist()
    [2.0, 0.5]
    """
    return cross.transfer(driving_angle, joint_angle).ratio


def cross_joint_fluctuation(*, joint_angle: ArrayLike) -> FloatArray:
    """Return (maximum - minimum)/mean driven speed of a universal joint. Source: 1/cos - cos of the joint angle.

    >>> round(float(cross_joint_fluctuation(joint_angle=np.pi / 3)), 9)  # 2 - 1/2
    1.5
    """
    return cross.fluctuation(joint_angle)


def m68_continuous_stress(
    *, strength: float, diameter: float, c_k: float, speed_ratio: ArrayLike, alloy: bool = False
) -> FloatArray:
    """Return the stress amplitude permissible in continuous operation, Pa. Source: IACS UR M68 Rev. 3 (2021), M68.5.

    speed_ratio: speed / rated speed; NaN above 1.05. A strength counts up to 600 MPa, of alloy steel for intermediate
    and thrust shafts up to 800 MPa. With 600 MPa, 243 mm (C_D = 0.35 + 0.93/3 = 0.66) and C_K = 1 at the rated speed:
    (600 + 160)/18 · 0.66 · 1.38 = 38.456 MPa.

    >>> (m68_continuous_stress(strength=600e6, diameter=0.243, c_k=1, speed_ratio=[1, 1.1]) / 1e6).round(9).tolist()
    [38.456, nan]
    """
    used = m68_shafts.used_strength(strength / MPA, "intermediate", alloy=alloy)
    return MPA * m68_shafts.tau_c(used, diameter / MM, c_k, speed_ratio)


def m68_transient_stress(
    *, strength: float, diameter: float, c_k: float, speed_ratio: ArrayLike, alloy: bool = False
) -> FloatArray:
    """Return the stress amplitude permissible while a barred range is passed, Pa. Source: UR M68 Rev. 3 (2021), M68.5.

    1.7 τ_C/√C_K; NaN above a speed ratio of 0.8. At standstill τ_C = (600 + 160)/18 · 0.66 · 3 = 83.6 MPa:

    >>> round(float(m68_transient_stress(strength=600e6, diameter=0.243, c_k=1, speed_ratio=0)) / 1e6, 9)  # 1.7 · 83.6
    142.12
    """
    used = m68_shafts.used_strength(strength / MPA, "intermediate", alloy=alloy)
    return MPA * m68_shafts.tau_t(used, diameter / MM, c_k, speed_ratio)


def m68_minimum_diameter(
    *,
    power: float,
    speed: float,
    strength: float,
    k: float = 1.0,
    factor: float = 100.0,
    bore_share: float = 0.0,
) -> float:
    """Return the minimum shaft diameter, m. Source: IACS UR M68, M68.4 (edition not confirmed).

    factor: F, 95 or 100; k: of the design of the shaft; bore_share: bore / diameter. A strength counts up to 600 MPa.
    With 1 kW per rpm and 400 MPa the cube root is 1 and the diameter F k = 100 mm:

    >>> round(m68_minimum_diameter(power=500e3, speed=500 * np.pi / 30, strength=400e6), 9)
    0.1
    """
    used = m68_shafts.used_strength(strength / MPA, "propeller", alloy=False)
    per_speed = power / 1e3 / (speed * 30.0 / math.pi)  # kW per rpm
    return MM * m68_shafts.least_diameter(per_speed, used, factor, k, bore_share)


def shrink_fit_torque(*, pressure: float, friction: float, diameter: float, length: float) -> float:
    """Return the torque at which a shrink fit slips, N m. Source: Coulomb friction, μ p π D L · D/2.

    >>> round(shrink_fit_torque(pressure=100e6 / np.pi, friction=0.1, diameter=0.2, length=0.1), 6)  # 10e6 · 0.002
    20000.0
    """
    return shrink_fits.slip_torque(diameter, length, pressure, friction)
