"""What all tests of a run share."""

import gc
import os
import shutil
import tempfile

import pytest
from hypothesis import find, strategies
from tests.shared import SHARED

# Before numpy is imported: threads of two workers that spin take up to ten times the time.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
gc.disable()  # until all tests are collected: modules and tests stay, and each search of them is in vain
LONGEST = {"test_site.py", "test_slow_scenes.py"}


def pytest_configure(config: pytest.Config) -> None:
    """Give the workers of pytest-xdist a folder for copies."""
    if config.getoption("numprocesses", None) and not hasattr(config, "workerinput"):
        os.environ[SHARED] = tempfile.mkdtemp(prefix="torsion-tests-")


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Begin with what takes longest: at the end one worker would wait for the other."""
    items.sort(key=lambda item: item.path.name not in LONGEST)


def pytest_collection_finish() -> None:
    """Search for garbage again, but never in what was collected.

    Before that Hypothesis draws once: its sources of random numbers, if frozen, would count as ones that nothing holds.
    """
    find(strategies.none(), lambda drawn: True)
    gc.freeze()
    gc.set_threshold(50_000, 20, 20)  # most of what a test makes is in no cycle
    gc.enable()


def pytest_unconfigure(config: pytest.Config) -> None:
    """Remove the folder when all workers have ended."""
    if not hasattr(config, "workerinput") and (folder := os.environ.pop(SHARED, "")):
        shutil.rmtree(folder, ignore_errors=True)
