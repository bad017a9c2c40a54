"""Data of the outputs are frozen: what a chapter has made no renderer can change."""

import dataclasses
import importlib
import inspect
import pkgutil

import pytest

import torsion.output

FILLED = "torsion.output.surface.axes"  # axes are filled while a figure is drawn
NAMES = [one.name for one in pkgutil.walk_packages(torsion.output.__path__, "torsion.output.") if one.name != FILLED]


@pytest.mark.parametrize("name", NAMES)
def test_dataclasses_are_frozen(name: str) -> None:
    kinds = inspect.getmembers(importlib.import_module(name), inspect.isclass)
    mine = [kind for _, kind in kinds if kind.__module__ == name and dataclasses.is_dataclass(kind)]
    assert [kind.__name__ for kind in mine if not kind.__dataclass_params__.frozen] == []
