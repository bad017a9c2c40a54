"""The analyses that a file can ask for: one module each, imported when a scene first names it."""

ANALYSES = {  # name: class of its settings
    "modes": "torsion.analyses.modes:Asked",
    "response": "torsion.analyses.response:Asked",
    "joints": "torsion.analyses.joints:Asked",
    "stability": "torsion.analyses.motion_asked:Asked",
    "lateral": "torsion.analyses.lateral:Asked",
    "check": "torsion.analyses.check:Asked",
}
UNBUILT = ("transient", "sweep")  # of the format, but not built yet
MODELS = ("lumped", "fem", "exact")
