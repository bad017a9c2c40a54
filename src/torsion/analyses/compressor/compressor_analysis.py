"""Reciprocating compressors of the train: what their pressures absorb, and what their throws excite."""

import math
from collections.abc import Iterator

import numpy as np

from torsion.analyses.compressor.compressor_results import (
    CompressorFound,
    Compressors,
    EndFound,
    ThrowFound,
    ThrowHarmonic,
)
from torsion.analyses.engine.engine_analysis import VARYING, varying_inertia
from torsion.analyses.steady import steady_if_known
from torsion.arrays import FloatArray
from torsion.findings import Work
from torsion.model.compressor.record import CompressorRecord, ThrowRecord
from torsion.model.lowering import Part

DRAWN = 361  # points of the effort over a revolution


def run(work: Work) -> None:
    """Every compressor."""
    with work.log.step("compressors", "the train has one") as step:
        found = tuple(
            _one(work, part, part.compressor) for part in work.study.train.parts if part.compressor
        )
        step.method = "harmonics by quadrature over the pieces of the pressures"
        step.size = f"{len(found)} with {sum(len(one.throws) for one in found)} throws"
        work.put(compressors=Compressors(found))


def _one(work: Work, part: Part, record: CompressorRecord) -> CompressorFound:
    reference, ratio = work.study.operation.speed, abs(float(part.ratio))
    own = None if reference is None else reference * ratio
    speed, mean = 0.0 if own is None else own, None
    if reference is not None:
        steady = steady_if_known(work.study, work.system, np.array([reference]))
        stations = {one.station for one in record.throws}
        mean = (
            None
            if steady is None
            else -float(sum(steady.applied[station, 0] for station in stations))
        )
    each = [one.gas + one.inertia * speed**2 for one in record.throws]
    order = np.arange(len(each[0]))
    turned: FloatArray = np.linspace(0.0, 2.0 * math.pi, DRAWN)
    phasors = [np.array([one.phasor(int(k)) for k in order]) for one in record.throws]
    torque = np.array(each) * np.array(phasors)  # (throws, orders) N m
    effort = -(torque @ np.exp(1j * np.outer(order, turned))).real
    over = [
        (one.station, one.inertia_over_angle[1 : VARYING + 1] * phase)
        for one in record.throws
        for phase in (np.array([one.phasor(k) for k in range(1, VARYING + 1)]),)
    ]
    return CompressorFound(
        name=part.name,
        speed=own,
        indicated=-float(sum(one.gas[0].real for one in record.throws)),
        efficiency=record.efficiency,
        mean_torque=mean,
        throws=tuple(_throw(work, one, own) for one in record.throws),
        rigid=tuple(torque.sum(axis=0)[1:].tolist()),
        turned=turned,
        effort=effort,
        varying=tuple(varying_inertia(work, over)),
        words=record.words,
    )


def _throw(work: Work, one: ThrowRecord, speed: float | None) -> ThrowFound:
    square = 0.0 if speed is None else speed**2
    return ThrowFound(
        number=one.number,
        station=work.system.stations[one.station].name,
        angle=one.angle,
        mean_torque=-float(one.gas[0].real),
        inertia=float(one.inertia_over_angle[0].real),
        ends=tuple(_ends(one, speed)),
        harmonics=tuple(
            ThrowHarmonic(order, complex(one.gas[order]), complex(one.inertia[order]) * square)
            for order in range(1, len(one.gas))
        ),
    )


def _ends(one: ThrowRecord, speed: float | None) -> Iterator[EndFound]:
    for end in one.ends:
        torque = -float(end.torque[0].real)
        yield EndFound(
            end=end.end,
            given=end.given,
            area=end.cylinder.area,
            clearance=end.clearance,
            imep=end.cylinder.imep(torque),
            power=None if speed is None else torque * speed,
            angle=end.diagram.angle,
            pressure=end.diagram.pressure,
        )
