"""The papers' examples, solved by the program, as they stand or with a few words changed."""

from pathlib import Path

import torsion
from torsion.analyses.joints.joint_lines import Joints
from torsion.findings import Findings

SCENES = Path(__file__).parents[2] / "shafting_specs" / "papers"


def solved(name: str, *changes: tuple[str, str], only: tuple[str, ...] = ()) -> Findings:
    """What the program finds of a scene, or `only` these analyses; each change replaces words that stand in the file."""
    text = (SCENES / f"{name}.yaml").read_text(encoding="utf-8")
    for old, new in changes:
        if old not in text:
            raise ValueError(f"{name}.yaml says no '{old}'")
        text = text.replace(old, new)
    return torsion.run(torsion.parse(text), only=only)


def joints(name: str, *changes: tuple[str, str]) -> Joints:
    """The joints of a scene."""
    found = solved(name, *changes).need(Joints)
    if found is None:
        raise ValueError(f"{name}.yaml has no joint")
    return found
