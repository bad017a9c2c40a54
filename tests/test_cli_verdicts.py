"""Exit status and words of the verdicts: a limit that is not kept is never a pass, whatever its standing."""

import json
import math
from pathlib import Path

import pytest
from typer.testing import CliRunner

from torsion import commands
from torsion.cli import app
from torsion.rules.verdict_line import Checks

SCENES = Path(__file__).parents[1] / "shafting_specs"
HELD = """
name: tube on a bearing between its joints
operation: {speeds: {from: 300 rpm, to: 12000 rpm, steps: 11}}
train:
  - motor: {inertia: 1}
  - joint: {angle: 1 deg}
  - shaft: {name: tube, length: 1.5 m, diameter: 120 mm, bore: 108 mm, support: {at: 0.75 m, stiffness: 10 GN/m}}
  - joint: {angle: 1 deg}
  - disc: {inertia: 1}
rules: [{universal-joints: {torsional: 1e6 rad/s**2, inertial: 1e6 rad/s**2}}]
"""


def solve(*arguments: str):
    return CliRunner().invoke(
        app, ["solve", *arguments], env={"COLUMNS": "160", "NO_COLOR": "1", "TERM": "dumb"}
    )


def test_a_limit_to_be_verified_that_is_not_kept_ends_with_status_1(tmp_path: Path) -> None:
    """Propeller shaft of 90 mm, at least 100 x 1.26 (0.58333 x 560/680)^(1/3) = 98.68 mm."""
    done = solve(str(SCENES / "haixun_06402.yaml"), "-o", str(tmp_path))
    assert done.exit_code == 1
    stated = " ".join(done.output.split())
    assert "✗ FAIL: Outer diameter, propeller shaft 110 % of its limit" in stated
    checks = json.loads((tmp_path / "results.json").read_text(encoding="utf-8"))["checks"]
    assert {(one["where"], one["verdict"]) for one in checks if one["verdict"] == "not kept"} == {
        ("propeller shaft", "not kept")
    }
    standing = {one["clause"]: one["standing"] for one in checks}
    assert standing == {
        "tau_C": "rule text",
        "minimum diameter": "to be verified",
        "T_KN": "maker",
        "T_KW": "maker",
        "(K_A - 1) T_rated": "to be verified",
        "torque reversal": "to be verified",
        "zero pitch": "rule text",
    }


def test_limits_to_be_verified_that_are_kept_end_with_status_0(tmp_path: Path) -> None:
    done = solve(str(SCENES / "usv.yaml"), "-o", str(tmp_path))
    assert done.exit_code == 0
    stated = " ".join(done.output.split())
    assert "! PASS with restrictions: no continuous operation above 1575 rpm" in stated


@pytest.mark.parametrize(("share", "status"), [("0.65", 0), ("0.3", 1)])
def test_tube_on_a_bearing_is_judged_by_the_speeds_of_the_bending_analysis(
    tmp_path, share, status
) -> None:
    """12000 rpm: 1.37 of the critical speed without the bearing, 0.36 of that with it."""
    scene = tmp_path / "held.yaml"
    scene.write_text(
        HELD.replace("inertial:", f"critical_share: {share}, inertial:"), encoding="utf-8"
    )
    done = solve(str(scene), "--json")
    assert done.exit_code == status, done.output
    found = json.loads(done.output)
    (check,) = (one for one in found["checks"] if one["clause"] == "n_crit")
    first = min(
        one["speed_rad_per_s"]
        for one in found["lateral"]["shafts"][0]["critical_speeds"]
        if one["order"] == 1
    )
    assert check["limit"] == pytest.approx(float(share) * first * 30 / math.pi, rel=1e-12)
    assert check["standing"] == ("to be verified" if share == "0.65" else "setting")


def test_joints_alone_leave_out_the_tube_on_a_bearing_and_say_so(tmp_path: Path) -> None:
    scene = tmp_path / "held.yaml"
    scene.write_text(HELD, encoding="utf-8")
    found = commands.joint(scene)
    assert [check.verdict for check in found.need(Checks).lines if check.clause == "n_crit"] == [
        "not judged"
    ]
    assert "supports" in dict(found.plan.left_out)["universal-joints: bending of tube"]
