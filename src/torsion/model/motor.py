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
    """An electric motor, or another machine that drives."""


class Turbine(RippleMachine, keyword="turbine", drives_train=True):
    """A turbine; it drives."""


class Generator(RippleMachine, keyword="generator", usual_load="constant"):
    """A generator, alternator or exciter; it absorbs power, by default at a constant torque."""
