"""What needs more memory than it may, or than there is, is refused with a message, and what blocks do not change."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from tests.for_all import for_all

import torsion
from torsion.analyses.response.amplitudes import BLOCK_VALUES, SMALL_BLOCK, blocks
from torsion.analyses.response.over_speed import response, response_of_orders
from torsion.analyses.response.synthesis import synthesis
from torsion.assembly import assemble
from torsion.study import bytes_of

SCENE = """
name: two
operation: {{speeds: {{from: 10 rpm, to: 3000 rpm, steps: {steps}}}, rated: {{speed: 3000 rpm, power: 10 kW}}}}
train:
  - motor: {{name: a, inertia: 1.0}}
  - coupling: {{name: c, stiffness: 1.0e4, psi: 0.5}}
  - propeller: {{name: b, inertia: 2.0, blades: 4, damping: {{model: archer, factor: 30}}}}
excitations: [{orders}]
"""
ORDERS = ", ".join(f"{{at: a, torque: 10, order: {order}}}" for order in (1, 2, 3, 4))


def _scene(steps: int) -> str:
    return SCENE.format(steps=steps, orders=ORDERS)


def test_a_response_above_the_limit_is_refused_with_its_count_and_what_to_change():
    study = torsion.parse(_scene(1_000_000))
    (refused,) = torsion.run(study, memory="300 MB").plan.unanswered
    assert (refused.analysis, refused.is_named, refused.is_input) == ("response", True, True)
    text = refused.text
    for part in (
        "speeds",
        "x 4 orders x 2 stations",
        "0.3 GB are allowed",
        "fewer steps",
        "--memory 0.",
    ):
        assert part in text
    number = int(text.split("up to ")[1].split(" speeds", maxsplit=1)[0])
    assert 1_000_000 <= number < 1_010_000


def test_a_response_over_frequency_above_the_limit_is_refused():
    scene = """
name: one
train: [disc: {name: wheel, inertia: 2}]
analyses: {response: {frequencies: {from: 1, to: 20, steps: 1000000}}}
excitations: [{at: wheel, torque: 10}]
"""
    with pytest.raises(torsion.InputError, match=r"frequencies .* x 1 orders x 1 stations"):
        torsion.run(torsion.parse(scene), memory=10e6)


@pytest.mark.parametrize(
    ("text", "number"), [("4GB", 4e9), ("500 MB", 5e8), ("1.5 kB", 1500.0), (2e9, 2e9)]
)
def test_an_amount_of_memory_is_a_number_with_its_unit(text, number):
    assert bytes_of(text) == number


@for_all("text", ["4", "GB", "4 Gb", "-1GB", "0GB", 0.0, float("nan")])
def test_what_is_no_amount_of_memory_is_refused(text):
    with pytest.raises(torsion.InputError, match="not an amount of memory"):
        bytes_of(text)


def test_a_speed_has_the_same_answer_alone_and_among_so_many_that_they_are_solved_in_blocks(
    monkeypatch,
):
    """Blocks of a tenth of their size, so that a tenth of the stations is enough."""
    monkeypatch.setattr(blocks, "__defaults__", (BLOCK_VALUES // 10,))
    monkeypatch.setattr("torsion.analyses.response.synthesis.SMALL_BLOCK", SMALL_BLOCK // 10)
    discs = "- disc: {inertia: 1}\n- coupling: {stiffness: 1e6, psi: 0.3}\n" * 200
    study = torsion.parse(
        "name: chain\noperation: {speeds: {from: 1 rad/s, to: 2 rad/s, steps: 2}}\n"
        "excitations: [{at: last, torque: 10, order: 1}, {at: last, torque: 4, order: 2, phase: 1 rad}]\n"
        f"train:\n{discs}- disc: {{name: last, inertia: 2}}\n"
    )
    system = assemble(study.train)
    orders = [line.order for line in response(study, system).lines if line.order is not None]
    found = response_of_orders(study, system, orders, np.linspace(1.0, 30.0, 2200))
    assert len(list(blocks(len(found.speed), len(system.stations)))) == 2
    rows = np.arange(0, 540, 9)
    assert len(list(blocks(540, len(system.spans), SMALL_BLOCK // 10))) == 2
    total = synthesis(response_of_orders(study, system, orders, found.speed[:540]))
    alone = response_of_orders(study, system, orders, found.speed[rows])
    late = slice(2190, None)
    for there, here in (
        (rows, alone),
        (late, response_of_orders(study, system, orders, found.speed[late])),
    ):
        for key in ("frequency", "angle", "torque", "mean", "residual", "status"):
            np.testing.assert_array_equal(getattr(found, key)[there], getattr(here, key))
    summed = synthesis(alone)
    assert summed.turns == total.turns == 1
    for key in ("half_range", "peak", "rms", "bound"):
        np.testing.assert_allclose(getattr(total, key)[rows], getattr(summed, key), rtol=1e-13)


@pytest.mark.skipif(
    sys.platform != "linux", reason="the limit of the address space is that of Linux"
)
def test_too_little_memory_is_status_3_with_a_message(tmp_path: Path):
    file = tmp_path / "two.yaml"
    orders = ", ".join(f"{{at: a, torque: 10, order: {order}}}" for order in range(1, 31))
    file.write_text(SCENE.format(steps=1_000_000, orders=orders))
    limited = (
        "import resource, sys, torsion.cli, torsion.findings, torsion.schema.scene_reader;"
        "import torsion.analyses.response.over_speed;"
        "size = int(open('/proc/self/statm').read().split()[0]) * resource.getpagesize() + 500_000_000;"
        "resource.setrlimit(resource.RLIMIT_AS, (size, size));"
        "sys.argv[1:] = ['solve', sys.argv[1], '--json', '--memory', '90GB']; torsion.cli.main()"
    )
    env = {**os.environ, "OPENBLAS_NUM_THREADS": "1"}
    done = subprocess.run(
        [sys.executable, "-c", limited, str(file)],
        check=False,
        capture_output=True,
        text=True,
        env=env,
        timeout=100,
    )
    assert (done.returncode, done.stdout) == (3, "")
    assert "too little memory" in done.stderr
    assert "Traceback" not in done.stderr
