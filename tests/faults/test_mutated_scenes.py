"""Whatever value of a shipped scene is changed, its reading ends in a plan or in faults with line and column.

The mutations of `mutations.py` are the same in every run. A much larger number of them was solved too when this was
written; here those of scenes that take a fraction of a second are.
"""

import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.faults.mutations import KINDS, SCENES, mutation

from torsion.analyses.undamped_modes import Modes
from torsion.commands import plan
from torsion.errors import InputError, SolveError
from torsion.runner import solved

MUTATIONS, BATCHES = 240, 8
LONGEST = 30  # s of a mutation
QUICK = (
    "three_discs",
    "two_discs",
    "free_shaft_discs",
    "fixed_shaft_disc",
    "friswell_9_7_1",
    "friswell_geared_t",
    "opposed_torques",
    "coupling_curve",
    "drill_string",
    "liu_2023",
    "ma_2011",
    "pump_lumped",
    "rubber_damper",
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the scenes and their tables, beside which mutations are written."""
    copied = tmp_path_factory.mktemp("mutated") / "scenes"
    shutil.copytree(SCENES, copied)
    return copied


def written(folder: Path, number: int) -> tuple[Path, str]:
    scene, words, text = mutation(number)
    path = (folder / scene.relative_to(SCENES)).with_name(f"{scene.stem}-{number}.yaml")
    path.write_text(text, encoding="utf-8")
    return path, words


@contextmanager
def limited(words: str) -> Iterator[None]:
    """Fail, with the mutation, what takes too long or ends in anything but what is raised on purpose."""

    def stop(*_: Any) -> None:
        raise TimeoutError(f"{words} takes more than {LONGEST} s")

    before = signal.signal(signal.SIGALRM, stop)
    signal.alarm(LONGEST)
    try:
        yield
    except (InputError, SolveError, TimeoutError, AssertionError):
        raise
    except Exception as error:
        raise AssertionError(f"{words} ends in {type(error).__name__}: {error}") from error
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)


def is_planned(path: Path, words: str) -> bool:
    """A plan is made; False where the file is refused, each fault with its place."""
    try:
        with limited(words):
            plan(path)
    except InputError as error:
        refusal = error
    else:
        return True
    check_places(refusal, words)
    return False


def check_places(refusal: InputError, words: str) -> None:
    """Every fault of a refusal has its place, which its text states."""
    assert refusal.faults, words
    for fault in refusal.faults:
        assert None not in (fault.line, fault.column), f"{words}: {fault.message} has no place"
        assert f":{fault.line}:{fault.column}: {fault.message}" in str(refusal), words


@pytest.mark.parametrize("batch", range(BATCHES))
def test_a_scene_with_one_value_changed_is_planned_or_refused_with_line_and_column(
    folder: Path, batch: int
) -> None:
    results = [is_planned(*written(folder, number)) for number in range(batch, MUTATIONS, BATCHES)]
    assert True in results
    assert False in results


def test_the_mutations_are_of_every_kind_and_of_every_scene() -> None:
    made = [mutation(number) for number in range(MUTATIONS)]
    assert {words.split()[0] for _, words, _ in made} == set(KINDS)
    assert {scene for scene, _, _ in made} == set(SCENES.rglob("*.yaml"))
    assert made == [mutation(number) for number in range(MUTATIONS)]


def test_a_quick_scene_with_one_value_changed_is_solved_or_refused_with_its_place(
    folder: Path,
) -> None:
    numbers = [number for number in range(MUTATIONS) if mutation(number)[0].stem in QUICK]
    for number in numbers:
        path, words = written(folder, number)
        if is_planned(path, words):
            with limited(words), suppress(InputError, SolveError):
                modes = solved(path).get(Modes)
                assert modes is None or np.isfinite(modes.frequency).all(), words


@pytest.mark.parametrize("number", range(3))
def test_the_command_ends_with_status_2_and_no_traceback_where_a_mutation_is_refused(
    folder: Path, number: int
) -> None:
    refused = (written(folder, place) for place in range(MUTATIONS))
    for _ in range(number + 1):
        path = next(path for path, words in refused if not is_planned(path, words))
    command = [sys.executable, "-m", "torsion", "solve", str(path), "-o", str(folder / "out")]
    ended = subprocess.run(
        command, capture_output=True, text=True, timeout=120, env=os.environ, check=False
    )
    assert ended.returncode == 2
    assert ended.stderr.startswith(f"{path}:")
    assert "Traceback" not in ended.stderr
    assert not (folder / "out").exists()
