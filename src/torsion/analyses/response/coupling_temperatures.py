"""Temperatures at which couplings give off the heat that their vibration makes, and where there is none."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from torsion.analyses.response.amplitudes import BLOCK_VALUES, Response
from torsion.analyses.response.harmonic_components import Excitation, Sources, excitations, sources
from torsion.analyses.response.solver import answer, ground_damping
from torsion.analyses.steady import steady_if_known
from torsion.arrays import ComplexArray, FloatArray, IntArray
from torsion.assembly.system import System
from torsion.assembly.tabled_spans import complex_stiffness
from torsion.errors import SolveError
from torsion.findings import Work
from torsion.kernels.warming import Warming, equilibria
from torsion.model.lowering import Part
from torsion.results import reported, result
from torsion.study import Study


@reported
class Equilibrium:
    """A temperature at which a coupling gives off what it makes."""

    speed: float = result("rad/s", (), "reference speed")
    temperature: float = result("degC", (), "of the coupling", key="temperature_degC")
    heat: float = result("W", (), "made and given off there")
    stiffness: float = result(
        "N*m/rad", (), "dynamic stiffness there, in the first harmonic component"
    )
    loss_factor: float = result("1", (), "loss factor there, in the first harmonic component")
    is_stable: bool = result("", (), "a small change of the temperature dies out")


@reported
class CouplingTemperature:
    """One coupling over the speed, the others as cold as their surroundings."""

    coupling: str = result("", (), "its name")
    surroundings: float = result(
        "degC", (), "temperature of the surroundings", key="surroundings_degC"
    )
    permissible: float = result(
        "degC", (), "highest permissible temperature", key="permissible_degC"
    )
    speed: FloatArray = result("rad/s", ("speed",), "reference speeds")
    number: IntArray = result(
        "", ("speed",), "temperatures of equilibrium up to the permissible one; 0: it runs away"
    )
    lowest: FloatArray = result(
        "degC", ("speed",), "lowest one, that of a run-up; null if there is none", key="lowest_degC"
    )
    highest: FloatArray = result(
        "degC",
        ("speed",),
        "highest stable equilibrium, reached in a run-down; null if a warm coupling overheats",
        key="highest_degC",
    )
    equilibria: tuple[Equilibrium, ...] = result(
        "", (), "all of them at the worst speed and at those with several"
    )

    @property
    def rise(self) -> FloatArray:
        """(speeds,) K up to the highest one; infinite where it runs away."""
        return np.where(np.isnan(self.highest), np.inf, self.highest - self.surroundings)


@reported
class CouplingTemperatures:
    """Couplings whose file says how they warm."""

    each: tuple[CouplingTemperature, ...] = result("", (), "couplings with `temperature`", key="")


@dataclass(frozen=True)
class _Heat:
    """What makes the heat of one coupling, at all speeds."""

    system: System
    warming: Warming
    span: int
    found: Sequence[Excitation]
    w: Sequence[FloatArray]  # of each harmonic component: (speeds,) rad/s
    forces: Sequence[Sequence[Sources]]  # of each: those whose magnitudes are added
    ground: FloatArray  # (stations, speeds)
    stiffness: Sequence[
        dict[int, ComplexArray]
    ]  # of each: of spans with a table, and of the coupling, as cold

    def power(self, case: IntArray, temperature: FloatArray) -> FloatArray:
        """(pairs,) W at pairs of a speed (its number) and a temperature (degC), all harmonic components together."""
        total = np.zeros(len(case))
        step = max(BLOCK_VALUES // len(self.system.stations), 1)
        for first in range(0, len(case), step):
            part = slice(first, first + step)
            for k in range(len(self.found)):
                total[part] += self._component(k, case[part], temperature[part])
        return total

    def _component(self, k: int, case: IntArray, temperature: FloatArray) -> FloatArray:
        w, ground = self.w[k][case], self.ground[:, case]
        stiffness = {span: values[case] for span, values in self.stiffness[k].items()}
        own = stiffness[self.span] = self.warming.complex_stiffness(
            stiffness[self.span], temperature
        )
        torque = np.zeros(len(case))
        for each in self.forces[k]:
            torque += np.abs(
                answer(self.system, w, each.at(case), ground, stiffness=stiffness).torque[
                    :, self.span
                ]
            )
        return np.asarray(0.5 * w * own.imag * (torque / np.abs(own)) ** 2)


def coupling_temperature(
    study: Study, response: Response, part: Part, warming: Warming
) -> CouplingTemperature:
    """Of one coupling at the speeds of the response, under all harmonic components that it has.

    Raises SolveError where the train has what a warming coupling does not go with.
    """
    system, speed = response.system, response.speed
    number = next(
        k for k, one in enumerate(study.train.parts) if one is part or one.name == part.name
    )
    span = next(k for k, one in enumerate(system.own_spans) if one.part == number)
    _refuse(study, system, span, part)
    known = steady_if_known(study, system, speed)
    kept = [line.order for line in response.lines if line.order is not None]
    found = excitations(system, kept)
    mean = None if known is None else known.torque
    each_w = [one.line.circular_frequency(speed) for one in found]
    cold = 1.0 / system.flexibility[span] * (1.0 + 1j * system.loss_factor[span])
    stiffness = [
        {span: cold + 1j * w * system.viscous[span], **complex_stiffness(system, w, mean, speed)}
        for w in each_w
    ]
    forces = [[sources(system, each, speed, known) for each in one.apart] for one in found]
    heat = _Heat(
        system,
        warming,
        span,
        found,
        each_w,
        forces,
        ground_damping(system, speed, known),
        stiffness,
    )
    case, temperature = equilibria(warming, heat.power, len(speed))
    count = np.bincount(case, minlength=len(speed))
    lowest, highest = np.full((2, len(speed)), np.nan)
    first = np.searchsorted(case, np.arange(len(speed)))
    some = np.flatnonzero(count > 0)
    lowest[some] = temperature[first[some]]
    odd = np.flatnonzero(count % 2 == 1)  # the last is stable: beyond it the coupling cools
    highest[odd] = temperature[first[odd] + count[odd] - 1]
    order = np.arange(len(case)) - first[case]
    rising = np.where(np.isnan(highest), np.inf, highest)
    chosen = np.flatnonzero(np.isin(case, [int(np.argmax(rising)), *_several(count)]))
    power = heat.power(case[chosen], temperature[chosen])
    rows = []
    for place, made in zip(chosen.tolist(), power.tolist(), strict=True):
        at = stiffness[0][span][[case[place]]] if stiffness else np.array([cold])
        warm = complex(warming.complex_stiffness(at, temperature[[place]])[0])
        values = (
            float(speed[case[place]]),
            float(temperature[place]),
            made,
            warm.real,
            warm.imag / warm.real,
        )
        rows.append(Equilibrium(*values, bool(order[place] % 2 == 0)))
    return CouplingTemperature(
        part.name, warming.now, warming.highest, speed, count, lowest, highest, tuple(rows)
    )


def _refuse(study: Study, system: System, span: int, part: Part) -> None:
    """Raise SolveError where the response to a coupling of another stiffness is not that of `answer`."""
    why = ""
    if study.train.modal_damping:
        why = "damping by mode does not follow the stiffness of a coupling that warms"
    elif study.train.has_nonlinear_couplings:
        why = "backlash, friction or stages of another coupling are not balanced again as it warms"
    elif study.train.has_tables_over("vibratory torque"):
        why = "a stiffness over vibratory torque is not settled anew as it warms"
    elif system.condensed.span[span] < 0:
        why = "it closes a loop"
    if why:
        hint = "leave `temperature` out, and compute a cold and a warm coupling as two `cases`"
        raise SolveError(f"temperatures of '{part.name}': {why}", hint, (*part.path, "temperature"))


def _several(count: IntArray) -> IntArray:
    """The first and the last speed of those with several equilibria."""
    found = np.flatnonzero(count > 1)
    return found[[0, -1]] if found.size else found


def run(work: Work) -> None:
    """Where there is a response over speed."""
    response = work.get(Response)
    if response is None:
        work.log.without("temperatures of couplings", "no response over speed")
        return
    with work.log.step("temperatures of couplings", "a coupling has `temperature`") as step:
        each = [
            coupling_temperature(work.study, response, part, part.warming)
            for part in work.study.train.parts
            if part.warming is not None
        ]
        step.method = "all equilibria of heat made and given off, by scanning and halving"
        step.size = f"{len(response.speed)} speeds, up to {math.ceil(max(one.permissible for one in each))} degC"
    work.put(coupling_temperatures=CouplingTemperatures(tuple(each)))
