"""Inertia, stiffness and damping of a train in full, as a view for export; no analysis computes with them."""

from dataclasses import dataclass

import numpy as np

from torsion.arrays import FloatArray
from torsion.assembly.distributed_spans import BarSpans
from torsion.assembly.system import System
from torsion.assembly.tabled_spans import table_path
from torsion.errors import Fault, InputError
from torsion.kernels.trees.tree import connected


@dataclass(frozen=True)
class Matrices:
    """J q'' + C q' + (K + i H) q = basis' T over the free angles q, each referred to the reference speed.

    Rigid spans and gears are condensed: stations that turn together share one free angle. Fixed stations have none.
    The unknowns inside finite elements (coefficients of their inner functions) stand behind the free angles.
    """

    inertia: FloatArray  # (free, free) kg m2
    stiffness: FloatArray  # (free, free) N m/rad
    damping: FloatArray  # (free, free) N m s/rad
    loss: FloatArray  # (free, free) N m/rad: stiffness times loss factor of every span
    basis: FloatArray  # (stations, free): angle of each station at own speed = basis @ q
    names: tuple[str, ...]  # (free,) the first station of each free angle
    stations: tuple[str, ...]  # (stations,)


def matrices(system: System, *, ground_damping: FloatArray | None = None) -> Matrices:
    """The matrices of a system; `ground_damping` (stations,) N m s/rad, default the part that does not depend on speed.

    Their stiffness is a sum of stiffnesses, and so loses the soft springs beside a stiff one; that is why this is a
    view and not what the analyses use. Raises InputError for the exact model, which has none.
    """
    if system.bars is not None and system.bars.degree == 0:
        message = "the exact model has no constant matrices: its inertia and stiffness depend on the frequency"
        raise InputError([Fault(("analyses", "model"), message, "model: lumped, or model: fem")])
    if tables := system.tables_over("frequency") | system.tables_over("vibratory torque"):
        message = (
            f"a stiffness that follows the {tables[min(tables)].over} has no constant matrices"
        )
        hint = "give a `stiffness` in its place for the matrices"
        raise InputError([Fault(table_path(system, min(tables)), message, hint)])
    if system.train.modal_damping:
        message = "damping by mode has no matrix next to the matrices of the components"
        raise InputError(
            [
                Fault(
                    ("damping",),
                    message,
                    "leave it out for the matrices, or give the components theirs",
                )
            ]
        )
    rigid = system.flexibility == 0
    group = connected(
        len(system.stations), system.driving[rigid], system.driven[rigid]
    )  # turn together
    fixed = np.isin(group, group[system.held])
    free = np.unique(group[~fixed])
    basis = np.where((group[:, None] == free) & ~fixed[:, None], system.speed_ratio[:, None], 0.0)
    inertia = np.where(system.held, 0.0, system.lumped_inertia)
    ground = ground_damping
    if ground is None:
        ground = np.zeros(len(system.stations))
        for damper in system.dampers:
            ground[damper.station] += damper.constant
    across = system.twist(basis / system.speed_ratio[:, None])
    springs = (system.flexibility > 0) & np.isfinite(system.flexibility)
    if system.bars is not None:
        springs[system.bars.span] = False
    stiffness = np.divide(1.0, system.flexibility, out=np.zeros(len(system.spans)), where=springs)
    view = Matrices(
        inertia=(basis.T * inertia) @ basis,
        stiffness=(across.T * stiffness) @ across,
        damping=(across.T * system.viscous) @ across + (basis.T * ground) @ basis,
        loss=(across.T * (stiffness * system.loss_factor)) @ across,
        basis=basis,
        names=tuple(system.stations[first].name for first in free.tolist()),
        stations=tuple(station.name for station in system.stations),
    )
    return view if system.bars is None else _with_elements(system, system.bars, view)


def _with_elements(system: System, bars: BarSpans, view: Matrices) -> Matrices:
    """The matrices with the finite elements put in; the unknowns inside of them come behind the free angles."""
    from torsion.assembly.element_matrices import element_matrices

    inner, elements = bars.degree - 1, element_matrices(bars.pieces, bars.degree)
    free = len(view.names)
    size = free + len(bars.span) * inner
    given = view.inertia, view.stiffness, view.damping, view.loss
    inertia, stiffness, damping, loss = (np.pad(matrix, (0, size - free)) for matrix in given)
    basis = np.pad(view.basis, ((0, 0), (0, size - free)))
    names = list(view.names)
    for number, span in enumerate(bars.span.tolist()):
        inside = free + number * inner + np.arange(inner)
        angles = np.zeros((bars.degree + 1, size))
        angles[:2] = basis[[system.driving[span], system.driven[span]]]
        angles[np.arange(2, bars.degree + 1), inside] = system.span_ratio[span]
        stiff, heavy = (angles.T @ matrices[number] @ angles for matrices in elements)
        stiffness += stiff
        loss += system.loss_factor[span] * stiff
        inertia += heavy
        names += [f"{system.spans[span].name} inner {k + 1}" for k in range(inner)]
    return Matrices(inertia, stiffness, damping, loss, basis, tuple(names), view.stations)
