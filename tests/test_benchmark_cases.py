"""The reference arithmetic of the benchmarks against closed forms; no peer is needed."""

import importlib
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest


@pytest.fixture(scope="module")
def benchmarks() -> Iterator[SimpleNamespace]:
    pytest.importorskip("mpmath")
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(Path(__file__).parents[1]))
        for variable in (
            "OPENBLAS_NUM_THREADS",
            "OMP_NUM_THREADS",
            "MKL_NUM_THREADS",
            "NUMBA_NUM_THREADS",
        ):
            patch.setenv(variable, "1")
        cases, references = (
            importlib.import_module(f"benchmarks.{name}") for name in ("cases", "references")
        )
        yield SimpleNamespace(cases=cases, references=references)


def uniform_chain(benchmarks: SimpleNamespace, size: int, inertia: float, stiffness: float):
    zero = (0.0,) * size
    parent = tuple(range(-1, size - 1))
    return benchmarks.cases.Case(
        "uniform", parent, (inertia,) * size, (stiffness,) * size, (None,) * size, zero, zero
    )


@pytest.mark.parametrize("size", [2, 7, 24])
def test_reference_frequencies_of_a_uniform_chain_are_sines(benchmarks, size):
    mpmath = pytest.importorskip("mpmath")
    case = uniform_chain(benchmarks, size, 0.5, 18.0)
    found = benchmarks.references.frequencies(case, range(1, size))
    with mpmath.workdps(80):
        for mode, frequency in enumerate(found, start=1):
            exact = 12 * mpmath.sin(mode * mpmath.pi / (2 * size))
            assert abs(mpmath.mpf(str(frequency)) / exact - 1) < mpmath.mpf(10) ** -60


def test_gear_reflects_inertia_with_the_square_of_the_ratio_in_the_references(benchmarks):
    cases = benchmarks.cases
    gear = cases.Gear(driving_teeth=20, driven_teeth=60, driving_inertia=1.0, driven_inertia=3.0)
    case = cases.Case(
        "geared", (-1, 0), (2.0, 6.0), (1.0, 8.0), (None, gear), (0.0, 0.0), (0.0, 0.0)
    )
    far = 1.0 + (3.0 + 6.0) / 9  # the far side turns at a third of the speed
    (frequency,) = benchmarks.references.frequencies(case, [1])
    assert float(frequency) == pytest.approx(np.sqrt(8.0 * (1 / 2.0 + 1 / far)), rel=1e-15)


def test_two_discs_answer_opposed_torques_as_in_the_closed_form(benchmarks):
    zero = (0.0, 0.0)
    case = benchmarks.cases.Case("two", (-1, 0), (2.0, 3.0), (0.0, 120.0), (None, None), zero, zero)
    angle, torque = benchmarks.references.response(case, 5.0, [1.0, -1.0])
    assert complex(angle[0]) == pytest.approx(1 / 150, rel=1e-15)
    assert complex(angle[1]) == pytest.approx(-1 / 225, rel=1e-15)
    assert complex(torque[1]) == pytest.approx(4 / 3, rel=1e-15)


def test_case_is_the_same_for_the_same_seed_and_is_geared(benchmarks):
    first, second = (benchmarks.cases.geared_tree(10, stiff=True, seed=3) for _ in range(2))
    assert first == second
    assert sum(gear is not None for gear in first.gear) == 2
    assert all(parent < station for station, parent in enumerate(first.parent))
