"""The papers' equations, as printed and as they must be, and the joints in space, from the benchmarks."""

import importlib
import json
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from types import ModuleType

import pytest
from tests.shared import shared

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="session")
def paper() -> Iterator[dict[str, ModuleType]]:
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
        modules = {
            file.stem: importlib.import_module(f"benchmarks.papers.{file.stem}") for file in files
        }

    # A motion of a truck takes a second and is read by tests that two workers share.
    solve = modules["shafting"].driveline

    @cache
    def solve_once(gear: int, friction: str) -> object:
        return shared(f"driveline-{gear}-{friction}", lambda: solve(gear, friction))

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(modules["shafting"], "driveline", solve_once)
        yield modules


@pytest.fixture(scope="session")
def oracles() -> dict[str, dict[str, str]]:
    """Reference values of 18 digits."""
    return json.loads(
        (ROOT / "tests" / "kernels" / "joints" / "oracles.json").read_text(encoding="utf-8")
    )
