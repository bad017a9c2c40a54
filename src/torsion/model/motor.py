"""Electrical machines and turbines: what drives or absorbs with a torque ripple."""

from torsion.fields import given
from torsion.model.harmonic_torques import Ripple
from torsion.model.machine import Machine


class RippleMachine(Machine):
    """A machine whose torque has a ripple by order or frequency."""

    ripple: tuple[Ripple, ...] = given(
        "torque ripple: list of {order or frequency, torque, phase}", ()
    )

    harmonics_key = "ripple"


class Motor(RippleMachine, keyword="motor", drives_train=True):
    """A motor drives the train, with ripple torques at orders of its shaft."""

    title = "electric motor or other driver"
    example = """\
- motor: {inertia: 8.5}
- motor: {inertia: 8.5, power: 400 kW, ripple: [{order: 6, torque: 1 %, phase: 30 deg}]}"""


class Turbine(RippleMachine, keyword="turbine", drives_train=True):
    """A turbine drives the train."""

    title = "turbine"
    example = "- turbine: {inertia: 1800 kg*m**2, source: drawing}"


class Generator(RippleMachine, keyword="generator", usual_load="constant"):
    """A generator absorbs power. By default its torque is constant over the speed."""

    title = "generator, alternator or exciter"
    example = """\
- generator: {inertia: 95, power: 1200 kW}
- generator: {inertia: 95, power: 1200 kW, load: constant-power, ripple: [{order: 2, torque: 1 %}]}"""
