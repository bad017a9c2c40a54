"""The kinds of component: one file each; a kind is imported when a scene first names it."""

from pkgutil import resolve_name

from torsion.components.component import Component

KINDS = {
    "disc": "torsion.components.disc:Disc",
    "motor": "torsion.components.motor:Motor",
    "turbine": "torsion.components.motor:Turbine",
    "generator": "torsion.components.motor:Generator",
    "pump": "torsion.components.propeller:Pump",
    "fan": "torsion.components.propeller:Fan",
    "machine": "torsion.components.machine:GeneralMachine",
    "propeller": "torsion.components.propeller:Propeller",
    "damper": "torsion.components.damper:RingDamper",
    "pendulum": "torsion.components.pendulum:Pendulum",
    "shaft": "torsion.components.shaft:Shaft",
    "coupling": "torsion.components.coupling:Coupling",
    "gear": "torsion.components.gear:Gear",
    "branch": "torsion.components.branch:Branch",
    "joint": "torsion.components.joint:Joint",
    "engine": "torsion.components.engine.engine:Engine",
    "compressor": "torsion.components.compressor.compressor:Compressor",
}


def component(kind: str) -> type[Component]:
    """The class of a kind; raises KeyError for a word that is no kind."""
    found: type[Component] = resolve_name(KINDS[kind])
    return found
