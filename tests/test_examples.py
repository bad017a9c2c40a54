"""The examples in docstrings give what they say."""

import doctest
from importlib import import_module
from pathlib import Path

from tests.for_all import for_all

import torsion

SOURCE = Path(torsion.__file__).parent
MODULES = [
    ".".join(("torsion", *path.relative_to(SOURCE).with_suffix("").parts)).removesuffix(".__init__")
    for path in sorted(SOURCE.rglob("*.py"))
    if ">>>" in path.read_text(encoding="utf-8")
]


@for_all("name", MODULES)
def test_examples_of_a_module_hold(name: str) -> None:
    module = import_module(name)
    names = {one: getattr(torsion, one) for one in torsion.__all__} if module is torsion else {}
    found = doctest.testmod(module, extraglobs=names)
    assert found.attempted
    assert not found.failed


def test_modules_with_examples_are_found() -> None:
    assert {"torsion", "torsion.results", "torsion.output.report_figures"} <= set(MODULES)
