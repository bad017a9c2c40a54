"""The bending of the shafts as plain data."""

from typing import TYPE_CHECKING, Any

from torsion.report.json.numbers import exact, finite, numbers, pairs, statuses

if TYPE_CHECKING:
    from torsion.analyses.lateral.bending import Answer, Critical, Lateral, ShaftFound, Tilting


def lateral(found: "Lateral | None") -> dict[str, Any] | None:
    """Every shaft that bends; null where it was not asked. Speeds are those of the reference."""
    if found is None:
        return None
    return {
        "has_shear": found.shear,
        "shafts": [_shaft(shaft) for shaft in found.shafts],
        "remarks": list(found.remarks),
    }


def _shaft(shaft: "ShaftFound") -> dict[str, Any]:
    ratio = float(shaft.ratio)
    return {
        "name": shaft.name,
        "ratio": exact(shaft.ratio),
        "length_m": finite(shaft.length),
        "elements": shaft.elements,
        "position_m": numbers(shaft.position),
        "points": [{"name": name, "at_m": at} for name, at in shaft.point],
        "at_rest_Hz": {"y": numbers(shaft.at_rest[0]), "z": numbers(shaft.at_rest[1])},
        "critical_speeds": [_critical(one, ratio) for one in shaft.critical],
        "whirl": _whirl(shaft, ratio),
        "answers": [_answer(one, ratio) for one in shaft.answers],
        "tilting": _tilting(shaft.tilting),
    }


def _critical(one: "Critical", ratio: float) -> dict[str, Any]:
    return {
        "order": one.order,
        "mode": one.mode,
        "speed_rad_per_s": finite(one.speed / ratio),
        "frequency_Hz": finite(one.frequency),
        "direction": finite(one.direction),
        "damping_ratio": finite(one.damping_ratio),
    }


def _whirl(shaft: "ShaftFound", ratio: float) -> dict[str, Any] | None:
    over = shaft.whirl
    if over is None:
        return None
    return {
        "speed_rad_per_s": numbers(over.speed / ratio),
        "frequency_Hz": numbers(over.frequency),
        "log_decrement": numbers(over.log_decrement),
        "direction": numbers(over.direction),
    }


def _answer(one: "Answer", ratio: float) -> dict[str, Any]:
    from torsion.analyses.lateral.response import extent

    return {
        "order": one.order,
        "speed_rad_per_s": numbers(one.speed / ratio),
        "displacement_m": pairs(one.displacement),
        "moment_Nm": numbers(extent(one.moment)),
        "force_N": pairs(one.force),
        "amplification": numbers(one.amplification),
        "status": statuses(one.status),
    }


def _tilting(one: "Tilting | None") -> dict[str, Any] | None:
    if one is None:
        return None
    return {
        "joint": one.joint,
        "transverse_inertia_kgm2": finite(one.shaft.inertia),
        "polar_inertia_kgm2": finite(one.shaft.polar * one.shaft.inertia),
        "frequency_Hz": {"y": finite(one.frequency[0]), "z": finite(one.frequency[1])},
        "speed_rad_per_s": numbers(one.speed / one.ratio),
        "growth_per_s": numbers(one.growth),
        "unstable": [
            {
                "from_rad_per_s": finite(zone.lower / one.ratio),
                "to_rad_per_s": finite(zone.upper / one.ratio),
                "is_open": list(zone.is_open),
                "type": zone.kind,
                "growth_per_s": finite(zone.rate),
                "at_rad_per_s": finite(zone.worst / one.ratio),
            }
            for zone in one.zones
        ],
    }
