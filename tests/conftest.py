"""What all tests of a run share."""

import os
import shutil
import tempfile

import pytest
from tests.shared import SHARED


def pytest_configure(config: pytest.Config) -> None:
    """Give the workers of pytest-xdist a folder for copies."""
    if config.getoption("numprocesses", None) and not hasattr(config, "workerinput"):
        os.environ[SHARED] = tempfile.mkdtemp(prefix="torsion-tests-")


def pytest_unconfigure(config: pytest.Config) -> None:
    """Remove the folder when all workers have ended."""
    if not hasattr(config, "workerinput") and (folder := os.environ.pop(SHARED, "")):
        shutil.rmtree(folder, ignore_errors=True)
