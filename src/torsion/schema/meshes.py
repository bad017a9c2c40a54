"""Meshes that a file names: found beside it, and read before anything is computed."""

from dataclasses import replace
from pathlib import Path

from torsion.errors import Fault
from torsion.primitives import Bar, SectionMesh
from torsion.study import Study


def with_meshes(study: Study, faults: list[Fault]) -> Study:
    """The study with every mesh found from the folder of its file; faulty meshes are noted."""
    if all(bar.section is None for bar in study.train.bars):
        return study
    from torsion.assembly.section.solved_sections import mesh_faults

    folder = Path(study.file).parent
    train = replace(study.train, bars=tuple(_placed(bar, folder) for bar in study.train.bars))
    faults += mesh_faults(train)
    return replace(study, train=train)


def _placed(bar: Bar, folder: Path) -> Bar:
    if not isinstance(bar.section, SectionMesh):
        return bar
    return replace(bar, section=replace(bar.section, file=str(folder / bar.section.file)))
