"""The results as JSON: documented, stable, every number finite or null.

`results` builds plain lists and dicts; `KEYS` in keys.py says what stands where. Format 1 may gain keys; a key
that is there keeps its meaning. Complex amplitudes are pairs [real, imaginary]; orders and ratios are texts "a/b".
"""

import hashlib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import torsion
from torsion.assembly.segment_groups import MOST_GROUPS, segment_groups
from torsion.findings import Findings
from torsion.report.json.check import check as model_check
from torsion.report.json.joints import joints
from torsion.report.json.lateral import lateral
from torsion.report.json.motion import periodic, stability, stability_map
from torsion.report.json.numbers import exact, finite, numbers
from torsion.report.json.response import frequency_response, response, synthesis
from torsion.report.json.writing import MOST_NUMBERS, SERIES, lines, plain, write_json

FORMAT = 1
LEGEND = {
    "time_factor": "exp(+i omega t); complex amplitudes are [real, imaginary], half ranges; phase at angle zero",
    "stations_and_spans": "arrays over stations or spans follow the order of the lists `stations` and `spans`",
    "own_speed": "angles, torques and inertias are told at the station's own speed, a span's at its driving station",
    "torque_sign": "a span's torque is positive when its driving side pushes its driven side",
    "reference": "orders and speeds count from the component `scene.reference`",
    "status": "ok, near-singular or singular: how far a line can be trusted; where singular, amplitudes are null",
    "long_shafts": f"of a shaft of more than {MOST_GROUPS} segments stretches are told, as `name [first..last]`: "
    "inertia, flexibility and shares of energy are sums, angles those at the outer end, torques of the first segment",
    "series": f"an array of more than {MOST_NUMBERS} numbers stands in {SERIES} beside this file, and here instead "
    "{file, array, shape}: the file, the name of the array in it and its shape; null is NaN there, words are texts",
    "null": "no value, not a number, or infinite (a held station's inertia)",
}


def results(findings: Findings) -> dict[str, Any]:
    """Everything that was found, in nested lists; what was not asked is null or an empty list."""
    return {key: plain(make()) for key, make in _parts(findings).items()}


def text(findings: Findings) -> str:
    """The results as JSON text, one line for each top-level key."""
    return "".join(text_pieces(findings))


def text_pieces(findings: Findings) -> Iterator[str]:
    """The same text, piece by piece, as it is made."""
    return lines(_parts(findings))


def write_results(findings: Findings, file: Path) -> list[Path]:
    """Write the text into a file, and very long arrays into another beside it; the paths of all."""
    return write_json(_parts(findings), file)


def joint_text(findings: Findings) -> str:
    """The joints alone as JSON text, under the keys that they have among the results."""
    return _text_of(findings, ("format", "program", "legend", "scene", "joints", "checks", "plan"))


def check_text(findings: Findings) -> str:
    """The comparison of the models alone as JSON text, under the keys that it has among the results."""
    return _text_of(findings, ("format", "program", "legend", "scene", "check", "plan"))


def _text_of(findings: Findings, keys: tuple[str, ...]) -> str:
    return "".join(lines({key: make for key, make in _parts(findings).items() if key in keys}))


def _parts(findings: Findings) -> dict[str, Callable[[], Any]]:
    """What makes the value of every top-level key, with arrays in it."""
    return {
        "format": lambda: FORMAT,
        "program": lambda: {"name": "torsion", "version": torsion.__version__},
        "legend": lambda: LEGEND,
        "scene": lambda: _scene(findings),
        "stations": lambda: _stations(findings),
        "spans": lambda: _spans(findings),
        "modes": lambda: _modes(findings),
        "damped_modes": lambda: _damped(findings),
        "critical_speeds": lambda: [_critical(c) for c in findings.critical],
        "mean": lambda: _steady(findings),
        "response": lambda: response(findings),
        "synthesis": lambda: synthesis(findings),
        "periodic": lambda: periodic(findings),
        "stability": lambda: stability(findings),
        "stability_map": lambda: stability_map(findings),
        "frequency_response": lambda: frequency_response(findings),
        "joints": lambda: joints(findings.joints),
        "lateral": lambda: lateral(findings.lateral),
        "check": lambda: model_check(findings.check),
        "checks": lambda: [_check(check) for check in findings.checks],
        "plan": lambda: _plan(findings),
    }


def _scene(findings: Findings) -> dict[str, Any]:
    study, speeds, rated = findings.study, findings.study.operation.speeds, findings.study.operation.rated
    return {
        "name": study.name,
        "description": study.description,
        "file": study.file,
        "sha256": hashlib.sha256(study.text.encode("utf-8")).hexdigest() if study.text else None,
        "model": study.model,
        "reference": study.operation.at or study.train.parts[0].name,
        "speed_range_rad_per_s": None if speeds is None else [speeds.first, speeds.last],
        "rated_speed_rad_per_s": None if rated is None else rated.speed,
        "rated_power_W": None if rated is None else rated.power,
        "rules": [name for name, _ in study.rules],
    }


def _stations(findings: Findings) -> list[dict[str, Any]]:
    system, parts = findings.system, findings.system.train.parts
    every = segment_groups(system, MOST_GROUPS)
    inertia = every.over_stations(system.inertia)
    return [
        {
            "name": station.name,
            "component": parts[station.part].name,
            "kind": parts[station.part].component.keyword,
            "speed_ratio": exact(station.ratio),
            "sense": station.sense,
            "is_ground": station.is_ground,
            "is_held": bool(system.held[index]),
            "inertia_kg_m2": finite(float(inertia[place])),
        }
        for place, index in enumerate(every.stations.tolist())
        for station in (system.stations[index],)
    ]


def _spans(findings: Findings) -> list[dict[str, Any]]:
    system, parts = findings.system, findings.system.train.parts
    every = segment_groups(system, MOST_GROUPS)
    names, ends, flexibility = every.names(), every.ends.tolist(), every.over_spans(system.flexibility)
    return [
        {
            "name": names[place],
            "component": parts[span.part].name,
            "kind": parts[span.part].component.keyword,
            "driving_station": ends[place][0],
            "driven_station": ends[place][1],
            "ratio": exact(span.ratio),
            "flexibility_rad_per_Nm": finite(float(flexibility[place])),
            "loss_factor": float(system.loss_factor[index]),
            "viscous_Nms_per_rad": float(system.viscous[index]),
            "error": [{"order": order, "amplitude_rad": [value.real, value.imag]} for order, value in span.error],
        }
        for place, index in enumerate(every.spans.tolist())
        for span in (system.spans[index],)
    ]


def _modes(findings: Findings) -> dict[str, Any] | None:
    modes = findings.modes
    if modes is None:
        return None
    every = segment_groups(findings.system, MOST_GROUPS)
    return {
        "rigid_motions": modes.rigid,
        "is_certified": modes.certified,
        "frequency_Hz": numbers(modes.frequency),
        "lower_Hz": numbers(modes.lower),
        "upper_Hz": numbers(modes.upper),
        "nodes": numbers(modes.nodes),
        "shape_rad": numbers(modes.shape[every.stations].T),
        "torque_Nm": numbers(modes.torque[every.spans].T),
        "kinetic_share": numbers(every.over_stations(modes.kinetic).T),
        "elastic_share": numbers(every.over_spans(modes.elastic).T),
    }


def _damped(findings: Findings) -> dict[str, Any] | None:
    damped = findings.damped
    if damped is None:
        return None
    return {
        "speed_rad_per_s": finite(damped.speed),
        "frequency_Hz": numbers(damped.frequency),
        "damping_ratio": numbers(damped.damping_ratio),
        "eigenvalue_per_s": [[float(v.real), float(v.imag)] for v in damped.eigenvalue],
        "overdamped_per_s": numbers(damped.overdamped),
    }


def _critical(critical: Any) -> dict[str, Any]:
    return {
        "mode": critical.mode,
        "order": exact(critical.order),
        "frequency_Hz": finite(critical.frequency),
        "speed_rad_per_s": finite(critical.speed),
        "is_in_range": bool(critical.is_inside),
        "margin": finite(critical.margin),
        "sources": list(critical.sources),
    }


def _steady(findings: Findings) -> dict[str, Any] | None:
    steady = findings.steady
    if steady is None:
        return None
    every = segment_groups(findings.system, MOST_GROUPS)
    return {
        "speed_rad_per_s": numbers(steady.speed),
        "torque_Nm": numbers(steady.torque[every.spans]),
        "applied_Nm": numbers(steady.applied[every.stations]),
        "sharing": steady.sharing,
    }


def _check(check: Any) -> dict[str, Any]:
    return {
        "rule": check.rule,
        "clause": check.clause,
        "where": check.where,
        "what": check.what,
        "value": finite(check.value),
        "limit": finite(check.limit),
        "limit_is_a_least_value": check.at_least,
        "unit": check.unit,
        "verdict": check.verdict,
        "speed_rad_per_s": finite(check.speed),
        "order": exact(check.order),
        "note": check.note,
        "barred": [
            {"shaft": b.shaft, "lower_rad_per_s": b.lower, "upper_rad_per_s": b.upper, "critical_rad_per_s": b.critical}
            for b in check.barred
        ],
    }


def _plan(findings: Findings) -> dict[str, Any]:
    plan = findings.plan
    return {
        "done": [
            {"what": s.what, "method": s.method, "size": s.size, "seconds": s.seconds, "why": s.why} for s in plan.done
        ],
        "left_out": [{"what": what, "why": why} for what, why in plan.left_out],
        "versions": dict(plan.versions),
    }
