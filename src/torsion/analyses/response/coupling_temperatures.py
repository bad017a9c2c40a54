"""Temperatures at which couplings give off the heat that their vibration makes, and where there is none."""

import math

import numpy as np

from torsion.analyses.response.amplitudes import Response, blocks
from torsion.analyses.response.harmonic_components import excitations, sources
from torsion.analyses.response.solver import answer, ground_damping
from torsion.analyses.steady import steady_if_known
from torsion.arrays import FloatArray, IntArray
from torsion.assembly.system import System
from torsion.assembly.tabled_spans import complex_stiffness
from torsion.errors import SolveError
from torsion.findings import Work
from torsion.kernels.stiffness_laws import Warming, equilibria
from torsion.model.parts import Part
from torsion.results import reported, result
from torsion.study import Study


@reported
class Equilibrium:
    """A temperature at which a coupling gives off what it makes."""

    speed: float = result("rad/s", "reference speed")
    temperature: float = result("degC", "of the coupling", key="temperature_degC")
    heat: float = result("W", "made and given off there")
    stiffness: float = result("N*m/rad", "dynamic stiffness there, in the first harmonic component")
    loss_factor: float = result("1", "loss factor there, in the first harmonic component")
    is_stable: bool = result("a small change of the temperature dies out")


@reported
class CouplingTemperature:
    """One coupling over the speed, the others as cold as their surroundings."""

    coupling: str = result("its name")
    surroundings: float = result("degC", "temperature of the surroundings", key="surroundings_degC")
    permissible: float = result("degC", "highest permissible temperature", key="permissible_degC")
    speed: FloatArray = result("rad/s", "speed", "reference speeds")
    number: IntArray = result(
        "", "speed", "temperatures of equilibrium up to the permissible one; 0: it runs away"
    )
    lowest: FloatArray = result(
        "degC", "speed", "lowest one, that of a run-up; null if there is none", key="lowest_degC"
    )
    highest: FloatArray = result(
        "degC",
        "speed",
        "highest stable equilibrium, reached in a run-down; null if a warm coupling overheats",
        key="highest_degC",
    )
    equilibria: tuple[Equilibrium, ...] = result(
        "all of them at the worst speed and at those with several"
    )


@reported
class CouplingTemperatures:
    """Couplings whose file says how they warm."""

    each: tuple[CouplingTemperature, ...] = result("couplings with `temperature`", key="")


def coupling_temperature(
    study: Study, response: Response, part: Part, warming: Warming
) -> CouplingTemperature:
    """Return the equilibria of one coupling at the speeds of the response, under all harmonic components that it has.

    Raises SolveError where the train has what a warming coupling does not go with.
    """
    system = response.system
    speed = response.speed
    number = study.train.positions[part.name]
    span = next(k for k, link in enumerate(system.own_spans) if link.part == number)
    _refuse(study, system, span, part)
    steady = steady_if_known(study, system, speed)
    ground = ground_damping(system, speed, steady)
    orders = [line.order for line in response.lines if line.order is not None]
    cold = 1.0 / system.flexibility[span] * (1.0 + 1j * system.loss_factor[span])

    # Of each component: frequencies, sources whose magnitudes are added, and stiffness of spans with a table.
    components = []
    for excitation in excitations(system, orders):
        w = excitation.line.circular_frequency(speed)
        forces = [sources(system, source, speed, steady) for source in excitation.apart.values()]
        mean = None if steady is None else steady.torque
        tabled = complex_stiffness(system, w, mean, speed)
        components.append((w, forces, {span: cold + 1j * w * system.viscous[span], **tabled}))

    def power(case: IntArray, temperature: FloatArray) -> FloatArray:
        """Return the heat (pairs,) W at pairs of a speed (its number) and a temperature (degC)."""
        total = np.zeros(len(case))
        for block in blocks(len(case), len(system.stations)):
            speeds = case[block]
            for w, forces, stiffness in components:
                at_speeds = {tabled: values[speeds] for tabled, values in stiffness.items()}
                at_speeds[span] = warming.complex_stiffness(at_speeds[span], temperature[block])
                torque = np.zeros(len(speeds))
                for force in forces:
                    driven = w[speeds], force.at(speeds), ground[:, speeds]
                    solved = answer(system, *driven, stiffness=at_speeds)
                    torque += np.abs(solved.torque[:, span])
                twist = torque / np.abs(at_speeds[span])
                total[block] += 0.5 * w[speeds] * at_speeds[span].imag * twist**2
        return total

    case, temperature = equilibria(warming, power, len(speed))
    count = np.bincount(case, minlength=len(speed))
    first = np.searchsorted(case, np.arange(len(speed)))
    lowest, highest = np.full((2, len(speed)), np.nan)
    lowest[count > 0] = temperature[first[count > 0]]
    odd = count % 2 == 1  # the last is stable: beyond it the coupling cools
    highest[odd] = temperature[first[odd] + count[odd] - 1]

    # All equilibria at the worst speed, and at the first and the last speed with several.
    several = np.flatnonzero(count > 1)
    worst = int(np.argmax(np.where(np.isnan(highest), np.inf, highest)))
    chosen = np.flatnonzero(np.isin(case, [worst, *several[:1], *several[-1:]]))
    states = []
    for k, heat in zip(chosen.tolist(), power(case[chosen], temperature[chosen]), strict=True):
        stiffness = components[0][2][span][[case[k]]] if components else np.array([cold])
        warm = complex(warming.complex_stiffness(stiffness, temperature[[k]])[0])
        is_stable = (k - int(first[case[k]])) % 2 == 0
        point = float(speed[case[k]]), float(temperature[k]), float(heat)
        states.append(Equilibrium(*point, warm.real, warm.imag / warm.real, is_stable))
    curves = speed, count, lowest, highest
    return CouplingTemperature(part.name, warming.now, warming.highest, *curves, tuple(states))


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


def run(work: Work) -> None:
    """Put the temperatures where there is a response over speed."""
    response = work.get(Response)
    if response is None:
        work.log.without("temperatures of couplings", "no response over speed")
        return
    with work.log.step("temperatures of couplings", "a coupling has `temperature`") as step:
        couplings = [
            coupling_temperature(work.study, response, part, part.warming)
            for part in work.study.train.parts
            if part.warming is not None
        ]
        step.method = "all equilibria of heat made and given off, by scanning and halving"
        highest = math.ceil(max(coupling.permissible for coupling in couplings))
        step.size = f"{len(response.speed)} speeds, up to {highest} degC"
    work.put(coupling_temperatures=CouplingTemperatures(tuple(couplings)))
