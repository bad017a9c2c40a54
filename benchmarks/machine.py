"""What the figures were measured on and with."""

import os
import platform
from pathlib import Path

import numpy as np

from torsion.analyses.compare.run_times import machine

PACKAGES = (
    "torsion",
    "numpy",
    "scipy",
    "opentorsion",
    "ross-rotordynamics",
    "pydantic",
    "PyYAML",
    "pint",
    "gmpy2",
    "mpmath",
)


def lines() -> list[str]:
    """System, threads, interpreter, versions, processor, linear algebra and load, one a line."""
    blas = np.show_config(mode="dicts")["Build Dependencies"]["blas"]  # type: ignore[call-overload]
    system, threads, *versions = (f"{name}: {value}" for name, value in machine(PACKAGES))
    load = ", ".join(f"{load:.2f}" for load in os.getloadavg())
    about = [f"Processor: {_processor()}", f"BLAS of numpy: {blas['name']} {blas['version']}"]
    return [system, *about, threads, ", ".join(versions), f"Load average before the run: {load}"]


def _processor() -> str:
    information = Path("/proc/cpuinfo")
    if information.exists():
        for line in information.read_text().splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    return platform.processor() or "unknown"
