"""What the command loads and sets before it computes."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

SCENES = Path(__file__).parents[1] / "shafting_specs"
CODE = """
import os, sys
import torsion.cli
assert "numpy" not in sys.modules
sys.argv = ["torsion", "solve", sys.argv[1], "--json"]
try:
    torsion.cli.main()
except SystemExit:
    pass
heavy = [name for name in ("scipy.optimize", "scipy.stats") if name in sys.modules]
print(os.environ["OPENBLAS_NUM_THREADS"], *heavy, file=sys.stderr)
"""


def _last_line(scene, **environment):
    bare = {name: value for name, value in os.environ.items() if "NUM_THREADS" not in name}
    command = [sys.executable, "-c", CODE, str(SCENES / f"{scene}.yaml")]
    done = subprocess.run(
        command, env=bare | environment, capture_output=True, text=True, check=True
    )
    return done.stderr.splitlines()[-1]


@pytest.mark.parametrize("scene", ["two_stroke_ship", "wind_gearbox"])
def test_solving_loads_no_search_of_scipy_and_one_thread_of_blas(scene):
    assert _last_line(scene) == "1"


def test_a_number_of_threads_that_the_user_sets_stays():
    assert _last_line("two_discs", OPENBLAS_NUM_THREADS="2") == "2"
