"""The plots that a figure can name, drawn when a renderer asks for the first of them."""

from importlib import import_module

from torsion.report.blocks import Figure

PLOTS = {
    "sketch": "torsion.plots.sketch:sketch",
    "mode": "torsion.plots.mode:mode",
    "campbell": "torsion.plots.campbell:campbell",
    "steady": "torsion.plots.steady:steady",
    "torque": "torsion.plots.torque:torque",
    "periodic": "torsion.plots.periodic:periodic",
    "stability": "torsion.plots.stability:stability",
    "stability map": "torsion.plots.stability:stability_map",
    "stress": "torsion.plots.stress:stress",
    "gear": "torsion.plots.gear:gear",
    "frequency": "torsion.plots.frequency:frequency",
    "joint turn": "torsion.plots.joint_turn:joint_turn",
    "joint index": "torsion.plots.joint_index:joint_index",
    "whirl": "torsion.plots.lateral:whirl",
    "bending": "torsion.plots.lateral:bending",
    "check modes": "torsion.plots.error_curves:modes",
    "check torques": "torsion.plots.error_curves:torques",
    "study": "torsion.plots.error_curves:run_times",
    "twisted shaft": "torsion.plots.twisted_shaft:twisted_shaft",
}


def svg(figure: Figure) -> str:
    """The figure as an SVG element; the same figure gives the same text. Raises KeyError for an unknown plot."""
    module, name = PLOTS[figure.plot].split(":")
    drawn: str = getattr(import_module(module), name)(figure.name, **figure.values)
    return drawn
