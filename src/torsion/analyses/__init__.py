"""The analyses that a file can ask for: one module each, imported when a scene first names it."""

ANALYSES = {  # name: class of its settings
    "modes": "torsion.analyses.modes:Asked",
    "response": "torsion.analyses.response:Asked",
    "joints": "torsion.analyses.joints:Asked",
}
UNBUILT = ("stability", "transient", "check", "sweep")  # of the format, but not built yet
MODELS = ("lumped", "fem", "exact")
