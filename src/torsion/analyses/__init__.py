"""The analyses that a file can ask for: one module each, imported when a scene first names it."""

ANALYSES = {  # name: class of its settings
    "modes": "torsion.analyses.modes:Asked",
    "response": "torsion.analyses.response.over_speed:Asked",
    "joints": "torsion.analyses.joints.joints:Asked",
    "stability": "torsion.analyses.motion.asked:Asked",
    "lateral": "torsion.analyses.lateral.bending:Asked",
    "check": "torsion.analyses.compare.side_by_side:Asked",
}
UNBUILT = ("transient", "sweep")  # of the format, but not built yet
MODELS = ("lumped", "fem", "exact")
