"""The source distribution holds all that a scene needs to be solved, far from the checkout."""

import json
import os
import re
import shutil
import subprocess
import sys
import tarfile
from pathlib import Path

from typer.testing import CliRunner

import torsion
from torsion.cli import app

ROOT = Path(__file__).parent.parent
BUILD = "import setuptools.build_meta as backend; print(backend.build_sdist('.'))"
NEW = """import torsion
from torsion.cli import app
print(torsion.__file__)
app(["new", "scene.yaml"])
"""


def run(*words: str, folder: Path, path: Path | None = None) -> str:
    around = {**os.environ, **({} if path is None else {"PYTHONPATH": str(path)})}
    command = [sys.executable, *words]
    return subprocess.run(
        command, cwd=folder, env=around, capture_output=True, text=True, check=True
    ).stdout


def test_a_scene_is_solved_by_the_unpacked_distribution(tmp_path: Path) -> None:
    """In a copy without scenes and tests, as the distribution is."""
    source, away = tmp_path / "source", tmp_path / "away"
    away.mkdir()
    shutil.copytree(
        ROOT / "src", source / "src", ignore=shutil.ignore_patterns("__pycache__", "*.egg-info")
    )
    for name in ("pyproject.toml", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, source)
    run("-c", BUILD, folder=source)
    (packed,) = source.glob("*.tar.gz")
    with tarfile.open(packed) as archive:
        safely = {"filter": "data"} if hasattr(tarfile, "data_filter") else {}  # from 3.11.4 on
        archive.extractall(away, **safely)
    (unpacked,) = away.glob("torsion-*")
    assert (unpacked / "LICENSE").is_file()
    assert run("-c", NEW, folder=away, path=unpacked / "src").startswith(str(away))
    run("-m", "torsion", "solve", "scene.yaml", "-o", "out", folder=away, path=unpacked / "src")
    assert json.loads((away / "out" / "results.json").read_text(encoding="utf-8"))["modes"][
        "frequency_Hz"
    ]
    assert "Holzer" in (away / "out" / "report.html").read_text(encoding="utf-8")


def test_the_version_is_said_once_in_every_file_of_the_project() -> None:
    project = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    assert re.search(r'^version = "(.+)"$', project, re.M)[1] == torsion.__version__
    assert re.search(r"^version: (.+)$", citation, re.M)[1] == torsion.__version__
    assert CliRunner().invoke(app, ["--version"]).output == f"torsion {torsion.__version__}\n"
    assert (ROOT / "CHANGELOG.md").read_text(encoding="utf-8").startswith("# Changelog")
