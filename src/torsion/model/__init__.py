"""The kinds of component: one file each; a kind is imported when a scene first names it."""

KINDS = {
    "disc": "torsion.model.disc:Disc",
    "motor": "torsion.model.machine:Motor",
    "turbine": "torsion.model.machine:Turbine",
    "generator": "torsion.model.machine:Generator",
    "pump": "torsion.model.machine:Pump",
    "fan": "torsion.model.machine:Fan",
    "machine": "torsion.model.machine:GeneralMachine",
    "propeller": "torsion.model.machine:Propeller",
    "damper": "torsion.model.damper:RingDamper",
    "pendulum": "torsion.model.pendulum:Pendulum",
    "shaft": "torsion.model.shafts.shaft:Shaft",
    "coupling": "torsion.model.coupling:Coupling",
    "gear": "torsion.model.gears.gear:Gear",
    "branch": "torsion.model.branch:Branch",
    "joint": "torsion.model.joint:Joint",
    "engine": "torsion.model.engine.engine:Engine",
    "compressor": "torsion.model.compressor.compressor:Compressor",
}


# Other words for kinds, which a file may use.
KINDS_BY_ALIAS = {
    "flywheel": "disc",
    "spring": "coupling",
    "clutch": "coupling",
    "gearbox": "gear",
    "cardan": "joint",
    "universal_joint": "joint",
    "impeller": "pump",
    "roll": "machine",
    "load": "machine",
}
