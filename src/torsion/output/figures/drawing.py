"""The plots that a figure can name, drawn when a renderer requests the first of them."""

from pkgutil import resolve_name

from torsion.output.blocks import Figure

PLOTS = {
    "sketch": "torsion.output.figures.sketch:sketch",
    "mode": "torsion.output.figures.mode_shape:mode",
    "campbell": "torsion.output.figures.frequencies_over_speed:campbell",
    "steady": "torsion.output.figures.curves_over_speed:steady",
    "torque": "torsion.output.figures.curves_over_speed:torque",
    "periodic": "torsion.output.figures.curves_over_speed:periodic",
    "stability": "torsion.output.figures.curves_over_speed:stability",
    "stability map": "torsion.output.figures.curves_over_speed:stability_map",
    "over time": "torsion.output.figures.curves_over_time:over_time",
    "orders": "torsion.output.figures.orders_over_speed:orders",
    "waterfall": "torsion.output.figures.orders_over_speed:waterfall",
    "stress": "torsion.output.figures.curves_over_speed:stress",
    "gear": "torsion.output.figures.curves_over_speed:gear",
    "frequency": "torsion.output.figures.curves_over_speed:frequency",
    "joint turn": "torsion.output.figures.joint_curves:joint_turn",
    "joint index": "torsion.output.figures.joint_curves:joint_index",
    "whirl": "torsion.output.figures.frequencies_over_speed:whirl",
    "bending": "torsion.output.figures.curves_over_speed:bending",
    "check modes": "torsion.output.figures.error_curves:modes",
    "check torques": "torsion.output.figures.error_curves:torques",
    "study": "torsion.output.figures.error_curves:run_times",
    "twisted shaft": "torsion.output.figures.twisted_surface:twisted_shaft",
}


def svg(figure: Figure) -> str:
    """The figure as an SVG element; the same figure gives the same text. Raises KeyError for an unknown plot."""
    from torsion.output.figures.style import page

    return page(figure.name, resolve_name(PLOTS[figure.plot]), **figure.values)
