"""The examples that take longest hold every law of scenes."""

from collections.abc import Callable

import pytest
from tests.contracts.test_every_scene import LAWS, SLOW
from tests.for_all import for_all


@pytest.mark.parametrize("scene", SLOW)
@for_all("law", LAWS)
def test_a_slow_scene_holds_every_law(law: Callable[[str], None], scene: str) -> None:
    law(scene)
