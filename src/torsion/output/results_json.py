"""The results as JSON: declared, stable, every number finite or null.

Format 1 may gain keys; a key that is there keeps its meaning. Complex amplitudes are pairs [real, imaginary]; orders
and ratios are texts "a/b".
"""

import json
from typing import Any

import torsion
from torsion.analyses import ANALYSES
from torsion.findings import Findings
from torsion.output.document import Document
from torsion.output.keys import Key, keys
from torsion.output.plain import plain
from torsion.output.scene import Scene, SpanRow, StationRow, scene, span_rows, station_rows
from torsion.output.selection import MOST_SEGMENTS, Selection
from torsion.plan import Plan
from torsion.rules.check import Checks

FORMAT = 1
HEAD = ("scene", "plan")  # keys that every file of results has
MODELS = ("check",)  # keys of the file of the models alone
LEGEND = {
    "time_factor": "exp(+i omega t); complex amplitudes are [real, imaginary], half ranges; phase at angle zero",
    "stations_and_spans": "arrays over stations or spans follow the order of the lists `stations` and `spans`",
    "own_speed": "angles, torques and inertias are those at the station's own speed, a span's at its driving station",
    "torque_sign": "a span's torque is positive when its driving side pushes its driven side",
    "reference": "orders and speeds count from the component `scene.reference`",
    "status": "ok, near-singular or singular: how far a line can be trusted; where not ok, amplitudes are null",
    "long_shafts": f"of a shaft of more than {MOST_SEGMENTS} segments groups are reported, as `name [first..last]`: "
    "inertia, flexibility and shares of energy are sums, angles those at the outer end, torques of the first segment",
    "null": "no value, not a number, or infinite (a held station's inertia)",
}


FIXED = (
    Key("format", "", (), "number of this format; a later one may change the meaning of keys"),
    Key("program.name", "", (), "torsion"),
    Key("program.version", "", (), "version of the program"),
    Key("legend", "", (), "conventions in words"),
)


def results(findings: Findings, only: tuple[str, ...] = ()) -> dict[str, Any]:
    """Everything that was found; what was not requested is null or an empty list. `only`: those keys, and the head."""
    chosen = Selection(findings.system)
    head = {"scene": scene(findings.study), "stations": station_rows(chosen), "spans": span_rows(chosen)}
    names = [name for analysis in ANALYSES.values() for name in analysis.results]
    found = head | {name: findings.results.get(name) for name in (*names, "checks")} | {"plan": findings.plan}
    kept = {name: plain(value, chosen) for name, value in found.items() if not only or name in (*HEAD, *only)}
    program = {"name": "torsion", "version": torsion.__version__}
    return {"format": FORMAT, "program": program, "legend": LEGEND} | kept


def text(findings: Findings, only: tuple[str, ...] = ()) -> str:
    """The results as JSON text, one line for each top-level key."""
    rows = [f"{json.dumps(k)}: {json.dumps(v, allow_nan=False)}" for k, v in results(findings, only).items()]
    return "{\n" + ",\n".join(rows) + "\n}\n"


def rendered(document: Document) -> str:
    """The results that a report is of."""
    return text(document.source, document.report.keys)


def documented() -> tuple[Key, ...]:
    """Every key of the results, as the manual of results lists them."""
    found = {name: kind for analysis in ANALYSES.values() for name, kind in analysis.result_classes().items()}
    head = {"scene": Scene, "stations[]": StationRow, "spans[]": SpanRow}
    return (*FIXED, *keys(head | found | {"checks": Checks, "plan": Plan}))
