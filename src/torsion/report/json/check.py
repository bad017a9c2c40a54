"""The comparison of the models as plain data."""

from typing import TYPE_CHECKING, Any

from torsion.report.json.numbers import exact, finite, numbers

if TYPE_CHECKING:
    from torsion.analyses.compare.side_by_side import Compared, ModelCompared


def check(found: "Compared | None") -> dict[str, Any] | None:
    """Every model with its errors, the exact one first; null where it was not asked."""
    if found is None:
        return None
    models = [] if found.exact is None else [found.exact, *found.models]
    return {
        "tolerance": found.tolerance,
        "same": found.same,
        "failed": list(found.failed),
        "highest_Hz": finite(found.highest),
        "speed_rad_per_s": None if found.speed is None else numbers(found.speed),
        "no_torques": found.no_torques,
        "models": [_model(model, found.tolerance) for model in models],
    }


def _model(model: "ModelCompared", tolerance: float) -> dict[str, Any]:
    frequency, shape, torque = model.largest
    return {
        "model": model.model,
        "passes": model.passes(tolerance),
        "division": model.division,
        "is_certified": model.certified,
        "frequency_Hz": numbers(model.frequency),
        "frequency_error": numbers(model.frequency_error),
        "shape_error": numbers(model.shape_error),
        "modes_below": model.below,
        "largest_frequency_error": finite(frequency),
        "largest_shape_error": finite(shape),
        "largest_torque_error": finite(torque),
        "torques": _torques(model),
        "modes_seconds": model.modes_seconds,
        "torques_seconds": model.torques_seconds,
    }


def _torques(model: "ModelCompared") -> dict[str, Any] | None:
    found = model.torques
    if found is None:
        return None
    return {
        "error": numbers(found.error),
        "worst_speed": found.speed if found.line is not None else None,
        "worst_order": None if found.line is None else exact(found.line.order),
        "worst_frequency_Hz": None if found.line is None else finite(found.line.frequency),
        "worst_component": found.component,
        "left_out": found.left_out,
    }
