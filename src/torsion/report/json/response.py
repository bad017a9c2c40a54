"""The responses and their synthesis as plain data.

Inner stations of a shaft are left out, and of its spans all but the first and the last, which hold its end torques.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from torsion.assembly.system import System
from torsion.findings import Findings
from torsion.kernels.tree import FloatArray
from torsion.kernels.tree_response import Status
from torsion.report.elements import elements
from torsion.report.json.numbers import exact, finite, numbers, pairs, statuses
from torsion.report.told import told

MOST_SEGMENTS = 2000  # of a shaft that are told each by itself; of more, stretches of them


def told_stations(system: System) -> list[int]:
    """Positions of the stations whose angles are told: those that the train names."""
    return list(range(len(system.train.stations)))


def told_spans(system: System) -> list[int]:
    """Positions of the spans whose torques are told: of a shaft the first and the last."""
    return sorted({span for element in elements(system) for span in (element.spans[0], element.spans[-1])})


def _known(values: NDArray[Any], status: NDArray[Any]) -> NDArray[Any]:
    """Values (speeds, ...) with NaN where the status (speeds,) says that not a digit is known."""
    nothing = complex(np.nan, np.nan) if np.iscomplexobj(values) else np.nan
    return np.where(np.expand_dims(status == Status.SINGULAR, tuple(range(1, values.ndim))), nothing, values)


def response(findings: Findings) -> dict[str, Any] | None:
    """The response over speed, line by line."""
    found, system = findings.response, findings.system
    if found is None:
        return None
    stations, spans = told_stations(system), told_spans(system)
    return {
        "speed_rad_per_s": numbers(found.speed),
        "is_asked": numbers(found.asked),
        "station": stations,
        "span": told(system, MOST_SEGMENTS).place(spans),
        "mean_torque_Nm": numbers(found.mean[:, spans]),
        "lines": [
            {
                "order": exact(line.order),
                "fixed_frequency_Hz": finite(line.frequency),
                "sources": list(line.sources),
                "frequency_Hz": numbers(found.frequency[:, k]),
                "angle_rad": pairs(_known(found.angle[:, k, stations], found.status[:, k])),
                "torque_Nm": pairs(_known(found.torque[:, k, spans], found.status[:, k])),
                "residual": numbers(found.residual[:, k]),
                "status": statuses(found.status[:, k]),
                "joint_error": numbers(found.joint_error[:, k]),
            }
            for k, line in enumerate(found.lines)
        ],
        "remark": found.remark,
        "orders_left_out": [exact(line.order) for line in found.left_out],
    }


def synthesis(findings: Findings) -> dict[str, Any] | None:
    """All lines together, over the speeds of `response`, of the largest span of every element."""
    found = findings.synthesis
    if found is None:
        return None
    made = elements(findings.system)
    worst = found.half_range[:, :0].sum(axis=1) if findings.response is None else findings.response.status.max(axis=1)

    def told(values: FloatArray) -> Any:
        return numbers(np.array([_known(element.largest(values), worst) for element in made]))

    return {
        "common_cycle_turns": exact(found.turns) if found.turns else None,
        "element": [element.name for element in made],
        "half_range_Nm": told(found.half_range),
        "peak_Nm": told(found.peak),
        "rms_Nm": told(found.rms),
        "bound_Nm": told(found.bound),
    }


def frequency_response(findings: Findings) -> dict[str, Any] | None:
    """The response over frequency."""
    found, system = findings.sweep, findings.system
    if found is None:
        return None
    stations, spans = told_stations(system), told_spans(system)
    return {
        "speed_rad_per_s": finite(found.speed),
        "frequency_Hz": numbers(found.frequency),
        "is_asked": numbers(found.asked),
        "sources": list(found.sources),
        "station": stations,
        "span": told(system, MOST_SEGMENTS).place(spans),
        "angle_rad": pairs(_known(found.angle[:, stations], found.status)),
        "torque_Nm": pairs(_known(found.torque[:, spans], found.status)),
        "residual": numbers(found.residual),
        "status": statuses(found.status),
        "remark": found.remark,
    }
