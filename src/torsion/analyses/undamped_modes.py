"""Natural frequencies and mode shapes of the undamped train, and where the energy of a mode sits."""

import math
from dataclasses import field, replace
from typing import TYPE_CHECKING, Annotated

import numpy as np
from pydantic import Field

from torsion.analyses.modes.mode_nodes import nodes
from torsion.arrays import FloatArray, IntArray
from torsion.assembly import demand_resolution, is_as_fine, rediscretised, resolving
from torsion.assembly.shafts import phase
from torsion.assembly.system import System
from torsion.errors import Fault, InputError, Path, SolveError
from torsion.fields import Declared, given
from torsion.kernels.tree import Tree
from torsion.results import Displayed, Keyed, by_name, derived, reported, result
from torsion.study import Study

if TYPE_CHECKING:
    from torsion.kernels.mode_shapes import ShaftModes

MOST_MODES = 100_000
MOST_JUDGED = 200  # modes that are computed beyond those requested, for a rule
ROUNDS = 6  # of refining the shafts until the highest frequency of the modes stays put
REACHING = 40  # times that shafts are refined until the modes lie in reach of their counts
NONE = np.empty(0, dtype=np.int64)  # no spans
Ruled = frozenset[str]  # analyses that the rules of a study read


def shares(energy: FloatArray) -> FloatArray:
    """What each one has of the sum over all, (all, modes), in the place of `energy`."""
    energy /= energy.sum(axis=0)
    return energy


class ModesSettings(Declared):
    """Settings of `modes`."""

    count: Annotated[int, Field(ge=1, le=MOST_MODES)] = given("how many elastic modes", 6)
    damped: bool | None = given(
        "damped frequencies and damping ratios too (default: when something damps)"
    )


def modes_settings(study: Study, ruled: Ruled) -> ModesSettings | None:
    """Settings of the modes that are computed; None where none are."""
    settings = study.analyses.get("modes")
    if isinstance(settings, ModesSettings):
        return settings
    reads = (
        "modes" in ruled or "transient" in study.analyses
    )  # a motion over time is a sum of modes
    return None if study.analyses and not reads else ModesSettings()


def without_mode(study: Study, mode: int, there: int, path: Path) -> Fault:
    """The fault of a setting about a mode that is not computed, or that the train does not have."""
    settings = study.analyses.get("modes")
    if there < (settings if isinstance(settings, ModesSettings) else ModesSettings()).count:
        message = f"mode {mode} is none of the {there} elastic modes of the train"
        return Fault(
            path, message, f"one of 1 to {there}" if there else "a train with an elastic mode"
        )
    return Fault(
        path, f"mode {mode} is none of the {there} that are computed", f"`modes: {{count: {mode}}}`"
    )


@reported
class Modes(Displayed, Keyed):
    """Natural frequencies with their certificate; shapes scaled to a generalised inertia of 1 kg m2."""

    frequency: FloatArray = result(
        "Hz", ("mode",), "undamped natural frequencies of the elastic modes, ascending"
    )
    shape: FloatArray = result(
        "rad",
        ("station", "mode"),
        "at own speed, generalised inertia 1 kg m2",
        printed=("mode", "station"),
    )
    torque: FloatArray = result(
        "N*m",
        ("span", "mode"),
        "at the driving station's speed, positive when the driving side pushes",
        printed=("mode", "span"),
    )
    lower: FloatArray = result(
        "Hz", ("mode",), "lower bound of each: counts prove that the mode lies between both"
    )
    upper: FloatArray = result("Hz", ("mode",), "upper bound of each")
    rigid: int = result("", (), "number of motions of exactly 0 Hz", key="rigid_motions")
    certified: bool = result("", (), "counts prove the bounds", key="is_certified")
    system: System = field(repr=False)
    distributed: "ShaftModes | None" = field(
        default=None, repr=False
    )  # of a train with distributed inertia

    def __getitem__(self, name: str) -> FloatArray:
        """(modes,) rad: every mode at a component, or at one of its stations; raises KeyError with the nearest name."""
        stations = {
            station.name: k for k, station in reversed(list(enumerate(self.system.stations)))
        }
        points = {
            part.name: part.stations[0]
            for part in self.system.train.parts
            if part.is_point and part.stations
        }
        return np.asarray(self.shape[by_name(name, {**stations, **points}, "station")])

    @derived(
        "1",
        ("station", "mode"),
        "share of the kinetic energy (half of a distributed shaft at either end)",
        key="kinetic_share",
        printed=("mode", "station"),
        is_total=True,
    )
    def kinetic(self) -> FloatArray:
        """(stations, modes)."""
        energy = np.square(self.shape)
        energy *= np.where(self.system.held, 0.0, self.system.lumped_inertia)[:, None]
        if self.distributed is not None and self.system.bars is not None:
            for end in (0, 1):
                np.add.at(
                    energy, self.system.bars.ends[:, end], self.distributed.shaft_kinetic / 2.0
                )
        return shares(energy)

    @derived(
        "1",
        ("span", "mode"),
        "share of the elastic energy",
        key="elastic_share",
        printed=("mode", "span"),
        is_total=True,
    )
    def elastic(self) -> FloatArray:
        """(spans, modes)."""
        if self.distributed is not None:
            return shares(self.distributed.elastic[self.system.condensed.span])
        flexibility, energy = self.system.flexibility, np.square(self.torque)
        energy *= np.where(np.isfinite(flexibility), flexibility, 0.0)[:, None]
        return shares(energy)

    @derived("", ("mode",), "sign changes of the shape over elastic spans")
    def nodes(self) -> IntArray:
        """(modes,)."""
        square = np.square(2.0 * math.pi * self.frequency)
        return nodes(
            self.system, undamped_tree(self.system), chord_spans(self.system), self.shape, square
        )

    @property
    def enclosure(self) -> FloatArray:
        """(modes, 2) Hz: lower and upper bound of each frequency."""
        return np.stack([self.lower, self.upper], axis=1)


def modes(system: System, count: int | None = 6, *, refine: bool = True) -> Modes:
    """The lowest `count` elastic modes (None: as many as the system has), of a system that resolves them.

    Where the shafts of `system` do not resolve the last mode they are refined, and `Modes.system` is the system of
    the results. Raises InputError for a count below 1 or above 100 000; SolveError where shafts cannot be refined,
    where that is needed and `refine` is False, and for a frequency that cannot be proven.
    """
    if count is not None and not 1 <= count <= MOST_MODES:
        raise InputError(
            [Fault(("count",), f"{count} modes cannot be computed", f"give 1 to {MOST_MODES}")]
        )
    ends = any(not table.holds for table in system.tables_over("frequency").values())
    if ends:  # no mode above the end of a table is sought
        system = resolving(system, _table_end(system), refine=refine)
    if ends or not refine or (system.bars is None and math.isinf(system.resolved_to)):
        found = modes_as_discretised(system, count)
    else:
        if count is None:
            count = modes_as_discretised(system, None).frequency.size
        found = _refined(system, count)
    if count is not None and found.frequency.size < count and not ends:
        demand_resolution(found.system, math.inf)
    demand_resolution(found.system, float(found.frequency.max(initial=0.0)))
    return found


def modes_up_to(found: Modes, requested: int, reach: float) -> tuple[FloatArray, float]:
    """Natural frequencies (modes,) in Hz up to `reach` (Hz), and the frequency below which none is missing.

    found: the modes of which `requested` were sought; where they end below `reach`, more are computed. The second
    number is infinite where the train has no further mode, and stays below `reach` where no more can be computed.
    """
    frequency, sought = found.frequency, requested
    ends = any(not table.holds for table in found.system.tables_over("frequency").values())
    while (last := float(frequency.max(initial=0.0))) < reach:
        if frequency.size < sought:
            return frequency, _table_end(found.system) if ends else math.inf
        sought = 2 * frequency.size + 2
        if sought > MOST_JUDGED:
            return frequency, last
        try:
            frequency = modes(found.system, sought).frequency
        except SolveError:
            return frequency, last
    return frequency, last


def _table_end(system: System) -> float:
    """Frequency (Hz) at which the first table of a coupling ends."""
    from torsion.assembly.tabled_spans import reach

    return reach(system)[1] / (2.0 * math.pi)


def _refined(system: System, count: int) -> Modes:
    """The lowest `count` modes of the train, discretised for the last of them and for what `system` was."""
    highest = system.requested.frequency
    system = _in_reach(system, highest, count)
    found = _with_all(modes_as_discretised(system, count), count)
    for _ in range(ROUNDS):
        system = found.system
        top = max(highest, float(found.frequency[-1]) if found.frequency.size else 0.0)
        finer = rediscretised(system, top)
        if _discretisation(finer) == _discretisation(system):
            return found if system.bars is None else replace(found, system=finer)
        if system.bars is not None and is_as_fine(system, finer):
            break
        found = modes_as_discretised(finer, count)
    return found


def _with_all(found: Modes, count: int) -> Modes:
    """Lumped shafts in more segments until the train has `count` modes, as far as the settings allow."""
    frequency, system = 0.0, found.system
    half_waves = [
        math.pi / phase(bar, 1.0)
        for bar in system.train.bars
        if bar.density > 0 and bar.segments is None
    ]
    while system.bars is None and found.frequency.size < count and half_waves:
        frequency = max(2.0 * frequency, min(half_waves))
        finer = rediscretised(system, frequency)
        if _discretisation(finer) != _discretisation(system):
            system, found = finer, modes_as_discretised(finer, count)
        elif finer.resolved_to < frequency:
            break
    return found


def _in_reach(system: System, highest: float, count: int) -> System:
    """The train discretised for the last of `count` modes, which counts find beforehand, as far as settings allow."""
    for _ in range(REACHING):
        bars = system.condensed_shafts
        if bars is None or not math.isfinite(bars.limit):
            break
        from torsion.analyses.modes.bars import above_mode, reach

        tree = undamped_tree(system)
        known = reach(tree)
        if known.count >= count:
            return rediscretised(system, max(highest, above_mode(tree, count) / (2.0 * math.pi)))
        finer = rediscretised(system, known.frequency / (2.0 * math.pi))
        if _discretisation(finer) == _discretisation(system):
            break
        system = finer
    return system


def _discretisation(system: System) -> tuple[dict[str, int], int]:
    return system.segments, 0 if system.bars is None else system.bars.degree


def modes_as_discretised(system: System, count: int | None = 6) -> Modes:
    """The lowest `count` elastic modes (None: all) of the system itself, whether it resolves them or not."""
    if system.tables_over("frequency"):
        from torsion.analyses.modes.tabled_modes import tabled_modes

        return tabled_modes(system, count, modes_as_discretised)
    if system.groups is not None:
        return condensed_modes(modes_as_discretised(system.whole, count), system)
    tree, node, chords = undamped_tree(system), system.condensed.node, chord_spans(system)
    if system.bars is not None and system.condensed_shafts is not None:
        from torsion.analyses.modes.bars import referred_modes

        found = referred_modes(tree, count)
        outer = found.torque if found.shafts is None else found.shafts.torque_outer
        torque = bar_torques(system, found.torque, outer)
    else:
        if chords.size:
            from torsion.kernels.variant_networks import counted_modes

            flexibility = (system.flexibility / system.span_ratio**2)[chords]
            found = counted_modes(
                tree, node[system.driving[chords]], node[system.driven[chords]], flexibility, count
            )
        else:
            from torsion.kernels.natural_modes import tree_modes

            found = tree_modes(tree, count)
        torque = span_torques(system, found.torque, chords, found.loop_torque)
    angle, hertz, ratio = _rows(found.angle, node), 1.0 / (2.0 * math.pi), system.speed_ratio
    shape = angle if (ratio == 1.0).all() else np.asarray(angle * ratio[:, None])
    return Modes(
        found.frequency * hertz,
        shape,
        torque,
        found.lower * hertz,
        found.upper * hertz,
        found.rigid,
        found.certified,
        system,
        found.shafts,
    )


def condensed_modes(whole: Modes, system: System) -> Modes:
    """The modes of a whole system at the stations and spans of it condensed; shares of energy are sums over groups."""
    groups = system.groups
    if groups is None:
        return whole
    found = replace(
        whole, shape=whole.shape[groups.stations], torque=whole.torque[groups.spans], system=system
    )
    shared = {
        "kinetic": groups.over_stations(whole.kinetic),
        "elastic": groups.over_spans(whole.elastic),
        "nodes": whole.nodes,
    }
    vars(found).update(shared)
    return found


def undamped_tree(system: System) -> Tree:
    """The tree with the laws of its distributed shafts, without spans that have damping but no stiffness.

    These hold nothing without damping.
    """
    tree = system.condensed.tree
    if system.condensed_shafts is not None:
        tree = replace(tree, shafts=system.condensed_shafts)
    return tree.cut(np.isinf(tree.flexibility))


def chord_spans(system: System) -> IntArray:
    """(chords,) spans with a stiffness that close loops or lie beside another span."""
    extra = system.condensed.extra
    return extra[np.isfinite(system.flexibility[extra])]


def span_torques(
    system: System,
    torque: np.ndarray,
    chords: IntArray = NONE,
    chord_torque: np.ndarray | float = 0.0,
) -> np.ndarray:
    """(spans, columns) N m at each driving station's speed, from torques (tree stations, columns) on the tree.

    chord_torque: (chords, columns) N m at one speed, positive when the driving side pushes.
    """
    condensed = system.condensed
    stated = _rows(torque, condensed.span)
    scale = condensed.sign * system.span_ratio
    if condensed.extra.size:
        stated = stated.copy()
        stated[condensed.extra] = 0.0
    if chords.size:
        stated[chords] = chord_torque * condensed.sign[chords, None]
    return stated if (scale == 1.0).all() else np.asarray(stated / scale[:, None])


def bar_torques(system: System, torque: np.ndarray, torque_outer: np.ndarray) -> np.ndarray:
    """(spans, columns) N m at each driving station, from torques (tree stations, columns) at both ends of spans."""
    from_parent = system.condensed.span[system.condensed.sign > 0]
    at_driving = torque_outer.copy()
    at_driving[from_parent] = torque[from_parent]
    return span_torques(system, at_driving)


def _rows(values: np.ndarray, at: IntArray) -> np.ndarray:
    """values[at], with the memory laid out as that of `values`; they themselves where `at` counts up by one."""
    if at.size and at[0] >= 0 and np.array_equal(at, np.arange(at[0], at[0] + at.size)):
        return values[int(at[0]) : int(at[0]) + at.size]
    return values[at] if values.flags.c_contiguous else np.take(values.T, at, axis=1).T
