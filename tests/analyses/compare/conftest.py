"""Studies of run times, which look for cycles of objects before every run."""

import gc
from collections.abc import Iterator

import pytest


@pytest.fixture(scope="module", autouse=True)
def _few_objects_to_search() -> Iterator[None]:
    """Leave modules and tests out of the searches; not for all tests, as Hypothesis looks for what refers to an object."""
    gc.freeze()
    yield
    gc.unfreeze()
