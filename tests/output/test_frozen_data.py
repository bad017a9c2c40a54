"""Data of the outputs are frozen: a block or a choice of values that two renderers share is the same for both."""

import dataclasses
import importlib
import pkgutil

from tests.for_all import for_all

import torsion.output
import torsion.rules

PACKAGES = torsion.output, torsion.rules
NAMES = [
    one.name
    for pack in PACKAGES
    for one in pkgutil.walk_packages(pack.__path__, f"{pack.__name__}.")
]


@for_all("name", NAMES)
def test_data_are_frozen(name: str) -> None:
    module = importlib.import_module(name)
    own = [
        one
        for one in vars(module).values()
        if dataclasses.is_dataclass(one) and one.__module__ == name
    ]
    assert [one.__name__ for one in own if not one.__dataclass_params__.frozen] == []
