"""Shafts whose cross-section is a mesh, as shafts that every model takes; without one nothing more is imported."""

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from torsion.arrays import FloatArray
from torsion.errors import Fault, InputError
from torsion.kernels.round_sections import section_modulus
from torsion.primitives import Bar, Section, SectionMesh
from torsion.train import Train

if TYPE_CHECKING:
    from torsion.assembly.section.section_result import SectionResult


def resolved(train: Train) -> Train:
    """The train with every section solved, and itself where none is to be solved.

    It becomes the solid round one of the same polar moment I_p, its shear modulus lowered by I_t/I_p: stiffness
    G I_t, inertia rho I_p and speed of waves are then those of the section. Raises InputError with every faulty mesh.
    """
    if not _meshes(train):
        return train
    faults = mesh_faults(train)
    if faults:
        raise InputError(faults)
    bars = {bar.name: bar for bar in train.bars}
    for name, result in section_results(train).items():
        bar, polar = bars[name], result.moments.polar
        section = Section(result.torsion_constant, polar, result.stress_modulus)
        across = (32.0 / math.pi * section.polar_moment) ** 0.25
        modulus = bar.shear_modulus * (section.torsion_constant / section.polar_moment)
        bars[name] = replace(
            bar, section=section, outer=(across, across), bore=(0.0, 0.0), shear_modulus=modulus
        )
    return replace(train, bars=tuple(bars.values()))


def _meshes(train: Train) -> list[tuple[Bar, SectionMesh]]:
    """Every shaft whose section is yet to be solved, and that section."""
    return [(bar, bar.section) for bar in train.bars if isinstance(bar.section, SectionMesh)]


def mesh_faults(train: Train) -> list[Fault]:
    """What is wrong with the meshes of a train, each stated where its shaft names it."""
    faults = []
    for bar, section in _meshes(train):
        from torsion.assembly.section.section_mesh import SectionFault
        from torsion.assembly.section.section_result import section_mesh

        try:
            section_mesh(section)
        except SectionFault as fault:
            faults.append(
                Fault((*train.parts[bar.part].path, "section", "mesh"), fault.message, fault.hint)
            )
    return faults


def section_results(train: Train) -> "dict[str, SectionResult]":
    """By name of the shaft: its section with bounds and convergence, for the plan and the report."""
    from torsion.assembly.section.section_result import section_result

    return {bar.name: section_result(section) for bar, section in _meshes(train)}


def stress_modulus(bar: Bar) -> float:
    """Torque / largest nominal shear stress where a shaft is thinnest, m3; of a section its own, NaN if it has none."""
    if isinstance(bar.section, Section):
        return bar.section.stress_modulus
    return float(min(section_modulus(bar.outer, bar.bore)))


def span_moduli(ends: tuple[tuple[float, float], tuple[float, float]], count: int) -> FloatArray:
    """W_p (count,) m3 of equal pieces from the driving to the driven end: the smaller end's of a conical one.

    ends: outer diameter and bore (m) at the driving and at the driven end.
    """
    # Between two ends of a piece the modulus is never below the smaller one.
    at_edge = section_modulus(*np.linspace(*ends, count + 1).T)
    return np.minimum(at_edge[:-1], at_edge[1:])
