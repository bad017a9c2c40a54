"""The exact periodic response, the stability and its map as plain data."""

from typing import TYPE_CHECKING, Any

import numpy as np

from torsion.findings import Findings
from torsion.kernels.tree import ComplexArray
from torsion.report.json.numbers import exact, finite, numbers, pairs
from torsion.report.json.response import told_spans, told_stations

if TYPE_CHECKING:
    from torsion.analyses.motion.periodic import PeriodicResponse


def _pairs(values: ComplexArray) -> Any:
    """Complex amplitudes as pairs, both parts null where there is none."""
    return pairs(np.where(np.isnan(values), complex(np.nan, np.nan), values))


def periodic(findings: Findings) -> dict[str, Any] | None:
    """The exact response over speed, order by order."""
    found = findings.periodic
    if found is None:
        return None
    from torsion.report.motion import WORDS

    stations, spans = told_stations(findings.system), told_spans(findings.system)
    return {
        "speed_rad_per_s": numbers(found.speed),
        "station": stations,
        "span": spans,
        "status": [WORDS[status].replace(" found", "") for status in found.status],
        "why": list(found.why),
        "harmonics": numbers(found.harmonics),
        "left_out": numbers(found.truncation),
        "growth_per_s": None if found.growth is None else numbers(found.growth),
        "is_unstable": numbers(found.is_unstable),
        "drive_Nm": numbers(found.drive),
        "mean_torque_Nm": numbers(found.mean[:, spans]),
        "orders": _orders(found, stations, spans),
        "others": None if found.others is None else {
            "speed_rad_per_s": numbers(found.others.speed),
            "growth_per_s": None if found.others.growth is None else numbers(found.others.growth),
            "orders": _orders(found.others, stations, spans),
        },
    }  # fmt: skip


def _orders(found: "PeriodicResponse", stations: list[int], spans: list[int]) -> list[dict[str, Any]]:
    return [
        {
            "order": exact(order),
            "angle_rad": _pairs(found.angle[:, k, stations]),
            "torque_Nm": _pairs(found.torque[:, k, spans]),
        }
        for k, order in enumerate(found.orders)
    ]


def stability(findings: Findings) -> dict[str, Any] | None:
    """Growth rates over speed and the unstable ranges."""
    found = findings.stability
    if found is None:
        return None
    return {
        "method": found.method,
        "speed_rad_per_s": numbers(found.speed),
        "is_asked": numbers(found.asked),
        "growth_per_s": numbers(found.growth),
        "frequency_rad_per_s": numbers(found.frequency),
        "factor_per_turn": numbers(found.amplitude_growth),
        "unsolved_rad_per_s": numbers(found.unsolved),
        "modes_rad_per_s": numbers(found.modes),
        "check_per_s": finite(found.check),
        "something_damps": found.loses,
        "modes_kept": found.kept,
        "reduction_error_per_s": finite(found.left_out),
        "ranges": [
            {
                "from_rad_per_s": one.first,
                "to_rad_per_s": one.last,
                "goes_on": list(one.is_open),
                "unknown_to_rad_per_s": list(one.unknown),
                "growth_per_s": finite(one.growth),
                "at_rad_per_s": one.at,
                "name": one.zone.name,
                "kind": one.zone.kind,
                "modes": list(one.zone.modes),
                "rank": one.zone.rank,
            }
            for one in found.ranges
        ],
    }


def stability_map(findings: Findings) -> dict[str, Any] | None:
    """Growth rates over speed and one more quantity."""
    found = findings.stability_map
    if found is None:
        return None
    return {
        "over": found.over,
        "speed_rad_per_s": numbers(found.speed),
        "value": numbers(found.value),
        "growth_per_s": numbers(found.growth),
        "modes": found.modes,
        "of_modes": found.of_modes,
        "error_per_s": finite(found.error),
        "checked": found.checked,
        "elsewhere": found.elsewhere,
    }
