"""All samples of motions over time as files: arrays in motion.npz, or a table motion.csv of each motion."""

import re
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from torsion.arrays import FloatArray
from torsion.findings import Findings
from torsion.output.document import Document
from torsion.output.selection import elements
from torsion.output.table_text import inert, one_line

if TYPE_CHECKING:
    from torsion.analyses.motion.transient_motion import TransientMotion


def motion(document: Document, findings: Findings) -> Callable[[Path], list[Path]] | None:
    """What writes the motions that the file exports; None where it exports none."""
    found = findings.results.get("transient")
    if found is None:
        return None
    from torsion.analyses.motion.transient_settings import cases

    forms = {one.name: one.export for one, _ in cases(findings.study)}
    each = [one for one in found.each if forms[one.name]]
    if not each or document.report.keys:
        return None
    return partial(_written, findings, each, forms)


def _written(
    findings: Findings, each: "list[TransientMotion]", forms: Mapping[str, str | None], target: Path
) -> list[Path]:
    """The paths of the files; arrays of all motions stand in one."""
    made, arrays = list[Path](), dict[str, Any]()
    for one in each:
        columns = _columns(findings, one)
        if forms[one.name] == "npz":
            mark = f"{one.name}: " if one.name else ""
            arrays |= {mark + title: values for title, values in columns}
        else:
            word = re.sub(r"[^\w.-]+", "-", one.name)
            made.append(target.with_name(f"motion-{word}.csv" if word else "motion.csv"))
            title = ",".join(
                '"' + inert(one_line(name)).replace('"', "'") + '"' for name, _ in columns
            )
            rows = np.column_stack([values for _, values in columns])
            np.savetxt(
                made[-1],
                rows,
                delimiter=",",
                header=title,
                comments="",
                fmt="%.17g",
                encoding="utf-8",
            )
    if arrays:
        with target.open("wb") as file:
            np.savez(file, **arrays)
        made.append(target)
    return made


def _columns(findings: Findings, found: "TransientMotion") -> list[tuple[str, FloatArray]]:
    """Title and samples: the time, speeds of the points, torques of the elements, each where it is largest."""
    stations = findings.study.train.stations
    columns = [("time [s]", found.time)]
    columns += [
        (f"speed of {s.name} [rad/s]", found.speed[k])
        for k, s in enumerate(stations)
        if not s.is_ground
    ]
    for one in elements(findings.system):
        span = max(one.spans, key=lambda span: found.peak[span])
        columns.append((f"torque in {one.name} [N*m]", found.torque[span]))
    return columns
