"""The Python front: its public names, and that it has no meaning of its own."""

import subprocess
import sys

import pytest

import torsion


def test_every_public_name_is_listed_and_documented() -> None:
    assert set(torsion.__all__) <= set(dir(torsion))
    assert set(dir(torsion)) - set(torsion.__all__) == {"__version__"}
    assert not [name for name in torsion.__all__ if not getattr(torsion, name).__doc__]


def test_an_unknown_name_of_the_package_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="no attribute 'mode'"):
        _ = torsion.mode


def test_the_import_of_the_package_loads_no_library() -> None:
    code = "import sys, torsion; print({'numpy', 'pydantic', 'yaml', 'scipy'} & set(sys.modules))"
    printed = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert printed == "set()\n"


def test_two_results_are_compared_in_python() -> None:
    text = "name: pair\ntrain: [disc: {inertia: 2}, coupling: {stiffness: 120}, disc: {inertia: 3}]"
    before, after = (torsion.run(torsion.parse(text.replace("120", k))) for k in ("120", "480"))
    assert not torsion.compare(before, before).is_changed
    (case,) = torsion.compare(before, after).cases
    assert case.modes[0].change == pytest.approx(1.0, rel=1e-9)  # sqrt(480/120) - 1
