"""What all tests of a run share."""

import shutil
from collections.abc import Iterator

import pytest
from tests.shared import sharing


@pytest.fixture(scope="session", autouse=True)
def shared_folder(
    tmp_path_factory: pytest.TempPathFactory, request: pytest.FixtureRequest
) -> Iterator[None]:
    """Where the workers of pytest-xdist leave copies for each other."""
    if not hasattr(request.config, "workerinput"):
        yield
        return
    folder = tmp_path_factory.getbasetemp().parent / "shared"
    with sharing(folder):
        yield
    shutil.rmtree(folder, ignore_errors=True)
