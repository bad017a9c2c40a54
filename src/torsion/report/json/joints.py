"""The universal joints as plain data."""

from typing import TYPE_CHECKING, Any

from torsion.report.json.numbers import exact, finite, numbers

if TYPE_CHECKING:
    from torsion.analyses.joints.joints import CoupleFound, JointFound, Joints, LineFound, OptimumFound


def joints(found: "Joints | None") -> dict[str, Any] | None:
    """Everything that was found of the joints; null where the train has none."""
    if found is None:
        return None
    return {
        "angle_rad": numbers(found.angle),
        "joints": [_joint(joint) for joint in found.joints],
        "lines": [_line(line) for line in found.lines],
        "remarks": list(found.remarks),
    }


def _joint(joint: "JointFound") -> dict[str, Any]:
    return {
        "name": joint.name,
        "kind": joint.kind,
        "angle_rad": joint.angle,
        "plane_rad": joint.plane,
        "phase_rad": joint.phase,
        "yoke_rad": joint.yoke,
        "ratio": exact(joint.ratio),
        "order": joint.order,
        "amplitude_rad": [joint.amplitude.real, joint.amplitude.imag],
        "unevenness": finite(joint.unevenness),
        "speed_rad_per_s": finite(joint.speed),
        "torque_Nm": finite(joint.torque),
        "error_rad": numbers(joint.error),
        "speed_ratio": numbers(joint.speed_ratio),
        "acceleration_per_rad": numbers(joint.acceleration),
        "torque_ratio": numbers(joint.torque_ratio),
        "steepest_per_rad": finite(joint.steepest),
        "force_N": finite(joint.force),
        "couples": [_couple(couple) for couple in joint.couples],
    }


def _couple(couple: "CoupleFound") -> dict[str, Any]:
    return {
        "shaft": couple.shaft,
        "normal_Nm": numbers(couple.normal),
        "inplane_Nm": numbers(couple.inplane),
        "yoke_Nm": None if couple.yoke is None else numbers(couple.yoke),
        "mean_Nm": list(couple.mean),
        "order": couple.order,
        "amplitude_Nm": [[one.real, one.imag] for one in couple.amplitude],
        "largest_Nm": finite(couple.largest),
        "bearing_N": finite(couple.bearing),
    }


def _line(line: "LineFound") -> dict[str, Any]:
    return {
        "joints": list(line.joints),
        "resultant_rad": finite(line.resultant),
        "phase_rad": finite(line.phase),
        "classical_rad": finite(line.classical),
        "index": finite(line.index),
        "greatest": {"speed_ratio": finite(line.greatest[0]), "at_rad": finite(line.greatest[1])},
        "least": {"speed_ratio": finite(line.least[0]), "at_rad": finite(line.least[1])},
        "optimum": None if line.optimum is None else _optimum(line.optimum),
    }


def _optimum(found: "OptimumFound") -> dict[str, Any]:
    return {
        "variable": found.variable,
        "names": list(found.names),
        "before_rad": list(found.before),
        "best_rad": list(found.best),
        "index_before": finite(found.index_before),
        "index_best": finite(found.index_best),
        "index_1_deg_off": list(found.sensitivity),
        "over_rad": numbers(found.over),
        "index_over": numbers(found.index_over),
    }
