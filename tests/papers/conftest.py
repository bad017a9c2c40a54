"""The papers' equations, as printed and as they must be, and the joints in space, from the benchmarks."""

import importlib
import json
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="session")
def paper() -> dict[str, ModuleType]:
    """Modules of benchmarks/papers by name; importing them leaves path and environment as they were."""
    files = (ROOT / "benchmarks" / "papers").glob("[a-z]*.py")
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(ROOT))
        for variable in (
            "OPENBLAS_NUM_THREADS",
            "OMP_NUM_THREADS",
            "MKL_NUM_THREADS",
            "NUMBA_NUM_THREADS",
        ):
            patch.setenv(variable, "1")
        return {
            file.stem: importlib.import_module(f"benchmarks.papers.{file.stem}") for file in files
        }


@pytest.fixture(scope="session")
def oracles() -> dict[str, dict[str, str]]:
    """Reference values of 18 digits."""
    return json.loads(
        (ROOT / "tests" / "kernels" / "joints" / "oracles.json").read_text(encoding="utf-8")
    )
