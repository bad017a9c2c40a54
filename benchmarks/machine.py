"""What the figures were measured on and with."""

import os
import platform
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import numpy as np

from benchmarks import THREAD_VARIABLES

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
    """Processor, interpreter, versions, linear algebra and thread counts, one a line."""
    blas = np.show_config(mode="dicts")["Build Dependencies"]["blas"]  # type: ignore[call-overload]
    installed = (f"{name} {_version(name)}" for name in PACKAGES)
    return [
        f"Processor: {_processor()}, {os.cpu_count()} cores seen, {platform.system()} {platform.machine()}",
        f"Python {platform.python_version()}; " + ", ".join(installed),
        f"BLAS of numpy: {blas['name']} {blas['version']}",
        "Threads: " + ", ".join(f"{name}={os.environ.get(name, 'unset')}" for name in THREAD_VARIABLES),
        f"Load average before the run: {', '.join(f'{load:.2f}' for load in os.getloadavg())}",
    ]


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "absent"


def _processor() -> str:
    information = Path("/proc/cpuinfo")
    if information.exists():
        for line in information.read_text().splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    return platform.processor() or "unknown"
