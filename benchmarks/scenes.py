"""Scenes of the cases: the file that a user would write."""

import json
from pathlib import Path
from typing import Any

from benchmarks.cases import Case


def scene(case: Case, folder: Path) -> Path:
    """The case as a scene file in `folder` that requests its modes."""
    path = folder / f"{case.name.replace(' ', '-')}-{case.size}.yaml"
    path.write_text(
        json.dumps({"name": case.name, "train": train(case), "analyses": {"modes": {}}})
    )
    return path


def train(case: Case) -> list[dict[str, Any]]:
    """The components of a scene, the branch with the most stations going on in the line it is found in."""
    children: list[list[int]] = [[] for _ in range(case.size)]
    weight = [1] * case.size
    for i in range(case.size - 1, 0, -1):
        children[case.parent[i]].append(i)
        weight[case.parent[i]] += weight[i]

    def link(i: int) -> list[dict[str, Any]]:
        coupling = {"coupling": {"stiffness": case.stiffness[i]}}
        gear = case.gear[i]
        if gear is None:
            return [coupling]
        wheels = {"teeth": [gear.driving_teeth, gear.driven_teeth]}
        return [
            coupling,
            {"gear": {**wheels, "inertia": [gear.driving_inertia, gear.driven_inertia]}},
        ]

    def line(i: int) -> list[dict[str, Any]]:
        components: list[dict[str, Any]] = []
        while True:
            components.append({"disc": {"inertia": case.inertia[i]}})
            if not children[i]:
                return components
            *side, onward = sorted(children[i], key=lambda child: weight[child])
            components += [{"branch": {"train": link(child) + line(child)}} for child in side]
            components += link(onward)
            i = onward

    return line(0)
