"""Exit status and words of the verdicts: a limit that is not kept is never a pass, whatever its standing."""

import json
from pathlib import Path

from typer.testing import CliRunner

from torsion.cli import app

SCENES = Path(__file__).parents[1] / "shafting_specs"


def solve(*arguments: str):
    return CliRunner().invoke(app, ["solve", *arguments], env={"COLUMNS": "160", "NO_COLOR": "1", "TERM": "dumb"})


def test_a_limit_to_be_verified_that_is_not_kept_ends_with_status_1(tmp_path: Path) -> None:
    """Propeller shaft of 90 mm, at least 100 x 1.26 (0.58333 x 560/680)^(1/3) = 98.68 mm."""
    done = solve(str(SCENES / "haixun_06402.yaml"), "-o", str(tmp_path))
    assert done.exit_code == 1
    told = " ".join(done.output.split())
    assert "1 of 8 checks failed (propeller shaft)" in told
    assert "4 limits are to be verified against the edition in force; of these not kept: propeller shaft" in told
    checks = json.loads((tmp_path / "results.json").read_text(encoding="utf-8"))["checks"]
    assert {(one["where"], one["verdict"]) for one in checks if one["verdict"] != "pass"} == {
        ("propeller shaft", "not kept")
    }
    standing = {one["clause"]: one["standing"] for one in checks}
    assert standing == {
        "tau_C": "rule text", "minimum diameter": "to be verified", "T_KN": "maker", "T_KW": "maker",
        "(K_A - 1) T_rated": "to be verified", "torque reversal": "to be verified",
    }  # fmt: skip


def test_limits_to_be_verified_that_are_kept_end_with_status_0(tmp_path: Path) -> None:
    done = solve(str(SCENES / "usv.yaml"), "-o", str(tmp_path))
    assert done.exit_code == 0
    told = " ".join(done.output.split())
    assert "No check failed: 8 passed, 3 outside the range" in told
    assert "3 limits are to be verified against the edition in force." in told
    assert "NOT KEPT" not in told
