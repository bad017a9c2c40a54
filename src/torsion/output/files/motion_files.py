"""All samples of motions over time as files: arrays in motion.npz, or a table motion.csv of each motion."""

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from torsion.arrays import FloatArray
from torsion.findings import Findings
from torsion.output.document import Document
from torsion.output.stored.scene import elements
from torsion.output.table_text import inert, one_line


def motion(document: Document, findings: Findings) -> Callable[[Path], list[Path]] | None:
    """What writes the motions that the file exports; None where it exports none."""
    transients = findings.results.get("transient")
    if transients is None:
        return None
    from torsion.analyses.motion.events.transient_settings import cases

    forms = {settings.name: settings.export for settings, _ in cases(findings.study)}
    exported = [motion for motion in transients.each if forms[motion.name]]

    def write(target: Path) -> list[Path]:
        """Write the files and return their paths; arrays of all motions stand in one."""
        files, arrays = list[Path](), dict[str, Any]()
        for motion in exported:
            # The time, speeds of the points, torques of the elements, each where it is largest.
            columns: dict[str, FloatArray] = {"time [s]": motion.time}
            for k, station in enumerate(findings.study.train.stations):
                if not station.is_ground:
                    columns[f"speed of {station.name} [rad/s]"] = motion.speed[k]
            for element in elements(findings.system):
                span = max(element.spans, key=motion.peak.__getitem__)
                columns[f"torque in {element.name} [N*m]"] = motion.torque[span]
            if forms[motion.name] == "npz":
                mark = f"{motion.name}: " if motion.name else ""
                arrays |= {mark + title: values for title, values in columns.items()}
                continue
            word = re.sub(r"[^\w.-]+", "-", motion.name)
            files.append(target.with_name(f"motion-{word}.csv" if word else "motion.csv"))
            titles = (inert(one_line(title)).replace('"', "'") for title in columns)
            head = ",".join(f'"{title}"' for title in titles)
            rows = np.column_stack(list(columns.values()))
            form = {"delimiter": ",", "comments": "", "fmt": "%.17g", "encoding": "utf-8"}
            np.savetxt(files[-1], rows, header=head, **form)
        if arrays:
            with target.open("wb") as file:
                np.savez(file, **arrays)
            files.append(target)
        return files

    return write if exported and document.name == "solve" else None
