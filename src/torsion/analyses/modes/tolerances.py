"""Natural frequencies over the tolerances of the file: proven bands, which figure matters, and exact inverses.

Every natural frequency rises with every stiffness and falls with every inertia (Courant and Fischer), so that the band
of a mode over independent tolerances is what all stiffnesses low with all inertias high, and the reverse, give: two
solutions, no sampling. The same says how far one coupling alone can move a mode, and at which stiffness, if any, the
mode has a frequency.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache, partial
from typing import Annotated

import numpy as np
from pydantic import Field

from torsion import fields
from torsion.analyses.critical import CriticalSpeeds
from torsion.analyses.undamped_modes import MOST_MODES, Modes, modes_as_discretised, without_mode
from torsion.arrays import FloatArray
from torsion.assembly import of_train
from torsion.assembly.system import System
from torsion.assembly.tabled_spans import with_springs
from torsion.errors import InputError
from torsion.fields import Declared, given, required
from torsion.findings import Work
from torsion.kernels.bracketed_search import find_root
from torsion.results import derived, reported, result
from torsion.sources import source
from torsion.study import Study

FARTHEST = 46.0  # ln of the factor to which a stiffness is sought: 1e20
WHAT = "tolerances"
Factors = tuple[tuple[int, float], ...]  # span, its stiffness over that of the file
Solution = tuple[FloatArray, FloatArray, FloatArray]  # (modes,) Hz: frequency and its bounds


class Aim(Declared):
    """A mode where it should be."""

    mode: Annotated[int, Field(ge=1, le=MOST_MODES)] = required(
        "which elastic mode, counted from 1"
    )
    frequency: fields.Frequency = required("where it should be")


class TolerancesSettings(Declared):
    """What the file states of `tolerances`: modes with target frequencies."""

    aim: tuple[Aim, ...] = given(
        "modes with target frequencies; the report states the stiffness of each coupling that gives the target",
        (),
    )


@reported
class CouplingReach:
    """What one coupling alone does, all others as the file has them."""

    coupling: str = result("its name")
    tolerance: float = result("1", "of its stiffness; 0 if the file has none")
    lower: FloatArray = result("Hz", "mode", "natural frequencies at the soft end of its tolerance")
    upper: FloatArray = result("Hz", "mode", "natural frequencies at the stiff end")
    softest: FloatArray = result("Hz", "mode", "natural frequencies without it")
    stiffest: FloatArray = result(
        "Hz", "mode", "natural frequencies with it rigid; null if the mode disappears"
    )
    change: FloatArray = result(
        "1", "mode", "(stiff - soft) / natural frequency with the nominal parameters"
    )


@reported
class AimedStiffness:
    """The stiffness of one coupling with which a mode is where it should be."""

    mode: int = result("counted from 1")
    frequency: float = result("Hz", "where it should be")
    coupling: str = result("whose stiffness alone is changed")
    stiffness: float | None = result(
        "N*m/rad", "stiffness that gives the target; null if no stiffness does"
    )
    factor: float | None = result("1", "that stiffness over the one of the file")
    softest: float = result("Hz", "the mode without the coupling")
    stiffest: float = result("Hz", "the mode with the coupling rigid")


@reported
class RankedFigure:
    """A figure of the file with a tolerance, and how far it moves every mode."""

    figure: str = result("the component and its key")
    tolerance: float = result("1", "relative, either way")
    sensitivity: FloatArray = result(
        "1",
        "mode",
        "relative change of each natural frequency / relative change of the parameter",
    )
    change: FloatArray = result(
        "1", "mode", "by how much the tolerance moves each either way, to first order"
    )


@reported
class Tolerances:
    """Bands of the natural frequencies over the tolerances of the file, each independent of the others."""

    frequency: FloatArray = result(
        "Hz", "mode", "undamped natural frequencies with the nominal parameters"
    )
    lower: FloatArray = result(
        "Hz", "mode", "minimum natural frequency within all tolerances, a guaranteed bound"
    )
    upper: FloatArray = result(
        "Hz", "mode", "maximum natural frequency within all tolerances, a guaranteed bound"
    )
    critical_lower: FloatArray = result(
        "rad/s", "critical speed", "least critical speed, as `critical_speeds`"
    )
    critical_upper: FloatArray = result("rad/s", "critical speed", "greatest critical speed")
    figures: tuple[RankedFigure, ...] = result(
        "every parameter with a tolerance, the dominant one first; none if a stiffness follows the "
        "frequency",
    )
    couplings: tuple[CouplingReach, ...] = result("what each coupling alone does")
    aims: tuple[AimedStiffness, ...] = result("stiffnesses that give the target frequencies")

    @derived("1", "mode", "lower bound / natural frequency - 1")
    def down(self) -> FloatArray:
        return self.lower / self.frequency - 1.0

    @derived("1", "mode", "upper bound / natural frequency - 1")
    def up(self) -> FloatArray:
        return self.upper / self.frequency - 1.0


def _solved(modes: Modes, factors: Factors, end: int = 0) -> Solution:
    """Return frequency (modes,) Hz and its proven bounds, with the stiffness of some spans scaled, the shafts divided alike.

    0 of what no longer vibrates, infinite where no mode is left. end: 1 with all inertias at the high end of their
    tolerance, -1 at the low one.
    """
    system = modes.system
    train = system.train
    count = modes.frequency.size
    tolerances = [part.inertia_tolerance or 0.0 for part in train.parts]
    if end and any(tolerances):
        inertias = tuple(
            replace(lump, inertia=lump.inertia * (1.0 + end * tolerances[lump.part]))
            for lump in train.inertias
        )
        system = of_train(system, replace(train, inertias=inertias))
    varied = modes_as_discretised(scaled(system, dict(factors)), count)
    loose = max(varied.rigid - modes.rigid, 0)
    rows = np.array([varied.frequency, varied.lower, varied.upper])
    padded = np.pad(rows, ((0, 0), (loose, 0)))
    missing = np.full((3, count), np.inf)
    frequency, lower, upper = np.hstack([padded, missing])[:, :count]
    return frequency, lower, upper


def _aimed(
    solved: Callable[..., Solution], span: int, mode: int, frequency: float
) -> tuple[float | None, float, float]:
    """Return the factor of a span's stiffness at which the mode has a frequency (Hz), and that mode at 0 and infinity."""
    softest, stiffest = (float(solved(((span, factor),))[0][mode]) for factor in (0.0, math.inf))
    if not softest < frequency < stiffest:
        return None, softest, stiffest

    def mismatch(log_factor: float) -> float:
        return math.log(float(solved(((span, math.exp(log_factor)),))[0][mode]) / frequency)

    # Each step doubles, away from the stiffness of the file and toward the side on which the root lies.
    begin = end = 0.0
    step = -1.0 if mismatch(0.0) > 0.0 else 1.0
    while mismatch(end) * step < 0.0 and abs(end) < FARTHEST:
        begin, end, step = end, end + step, 2.0 * step
    if mismatch(begin) * mismatch(end) > 0.0:
        return None, softest, stiffest
    root = find_root(mismatch, *sorted((begin, end)), tolerance=1e-16, relative=1e-15)
    return math.exp(float(root)), softest, stiffest


def scaled(system: System, factors: Mapping[int, float]) -> System:
    """The system with the stiffness of some spans (and of their tables) times a factor; 0 takes a span out."""
    values = {}
    tables = dict(system.tables)
    for span, factor in factors.items():
        flexibility = float(system.flexibility[span])
        taken = math.inf if factor == 0.0 else 0.0 if math.isinf(factor) else flexibility / factor
        values[span] = taken, float(system.viscous[span]), float(system.loss_factor[span])
        table = tables.pop(span, None)
        if table is not None and 0.0 < factor < math.inf:
            tables[span] = table.times(factor)
    return with_springs(system, values, tables)


@source("Rayleigh1877")
def ranked(modes: Modes, spans: Mapping[str, int]) -> tuple[RankedFigure, ...]:
    """Every figure with a tolerance: half its shares of elastic or kinetic energy are its sensitivities (T132)."""
    system = modes.system
    rows = list[tuple[str, float, FloatArray]]()
    if system.tables_over("frequency"):
        return ()
    parts = system.train.parts
    moved = np.zeros((len(parts), modes.frequency.size))
    for lump in system.train.inertias:
        # But for the ground of a disc on a spring.
        if parts[lump.part].inertia_tolerance and math.isfinite(lump.inertia):
            moved[lump.part] -= 0.5 * lump.inertia * np.square(modes.shape[lump.station])

    for part, sensitivity in zip(parts, moved, strict=True):
        if part.inertia_tolerance:
            rows.append((f"{part.name}.inertia", part.inertia_tolerance, sensitivity))
        if part.stiffness_tolerance and part.name in spans:
            share = 0.5 * modes.elastic[spans[part.name]]
            rows.append((f"{part.name}.stiffness", part.stiffness_tolerance, share))
    figures = [RankedFigure(*row, np.abs(row[2]) * row[1]) for row in rows]
    return tuple(sorted(figures, key=lambda figure: -float(figure.change.max(initial=0.0))))


def tolerances(
    study: Study, modes: Modes, critical: CriticalSpeeds | None, aims: Sequence[Aim] = ()
) -> Tolerances:
    """Return the bands of a study with its modes; raises InputError for an aim at a mode that was not computed."""
    train = study.train
    system = modes.system
    solved = lru_cache(maxsize=256)(partial(_solved, modes))
    spans = {
        train.parts[span.part].name: number
        for number, span in enumerate(system.own_spans)
        if train.parts[span.part].kind == "coupling" and 0.0 < system.flexibility[number] < math.inf
    }
    width = {name: train[name].stiffness_tolerance for name in spans}
    computed = modes.frequency.size
    if faults := [
        without_mode(study, aim.mode, computed, ("analyses", WHAT, "aim", k, "mode"))
        for k, aim in enumerate(aims)
        if aim.mode > computed
    ]:
        raise InputError(faults)

    def band_end(sign: float, *names: str, end: int = 0) -> tuple[FloatArray, ...]:
        changed = ((spans[name], 1.0 + sign * width[name]) for name in names if width[name])
        return solved(tuple(changed), end)

    lower = band_end(-1.0, *spans, end=1)[1]
    upper = band_end(1.0, *spans, end=-1)[2]
    reaches = []
    for name, span in spans.items():
        soft, stiff = (band_end(sign, name)[0] for sign in (-1.0, 1.0))
        without, rigid = (solved(((span, factor),))[0] for factor in (0.0, math.inf))
        change = (stiff - soft) / modes.frequency
        reaches.append(CouplingReach(name, width[name], soft, stiff, without, rigid, change))
    aimed = []
    for aim in aims:
        for name, span in spans.items():
            factor, *ends = _aimed(solved, span, aim.mode - 1, aim.frequency)
            stiffness = None if factor is None else factor / float(system.flexibility[span])
            aimed.append(AimedStiffness(aim.mode, aim.frequency, name, stiffness, factor, *ends))
    crossings = () if critical is None else critical.crossings
    moved = np.array([[lower[c.mode - 1], upper[c.mode - 1]] for c in crossings]).reshape(-1, 2)
    speed = np.array([c.speed / c.frequency for c in crossings])
    return Tolerances(
        modes.frequency,
        lower,
        upper,
        moved[:, 0] * speed,
        moved[:, 1] * speed,
        ranked(modes, spans),
        tuple(reaches),
        tuple(aimed),
    )


def run(work: Work) -> None:
    """Where modes were found; critical speeds have bands where frequencies do not follow the mean torque."""
    modes = work.get(Modes)
    settings = work.study.analyses.get(WHAT)
    if modes is None or not modes.frequency.size:
        work.log.without("bands of the natural frequencies", "no modes")
        return
    aims = settings.aim if isinstance(settings, TolerancesSettings) else ()
    follows = work.study.train.has_tables_over("mean torque")
    if follows:
        why = "the stiffness of a coupling follows the mean torque"
        work.log.without("bands of the critical speeds", why)
    if modes.system.tables_over("frequency"):
        why = "the stiffness of a coupling follows the frequency"
        work.log.without("which figure matters", why)
    with work.log.step("bands of the natural frequencies", "figures have tolerances") as step:
        made = tolerances(work.study, modes, None if follows else work.get(CriticalSpeeds), aims)
        bounds = "certified by counts" if modes.certified else "with the error bound of the method"
        step.method = f"every frequency rises with every stiffness and falls with every inertia: two corners, {bounds}"
        step.size = f"{len(made.couplings)} couplings"
    work.put(tolerances=made)
