"""Natural frequencies and mode shapes of the undamped train, and where the energy of a mode sits."""

import math
from dataclasses import field, replace
from pkgutil import resolve_name
from typing import TYPE_CHECKING, Annotated

import numpy as np
from pydantic import Field

from torsion.analyses.modes.mode_nodes import nodes
from torsion.arrays import FloatArray, IntArray
from torsion.assembly import demand_resolution, is_as_fine, rediscretised, resolving
from torsion.assembly.elements import by_part, elements
from torsion.assembly.segments import phase
from torsion.assembly.system import System
from torsion.errors import Fault, InputError, Path, SolveError
from torsion.fields import Declared, given
from torsion.kernels.trees.tree import Tree
from torsion.results import Displayed, Keyed, by_name, derived, reported, result
from torsion.study import Study

if TYPE_CHECKING:
    from torsion.kernels.modes.mode_shapes import ShaftModes

MOST_MODES = 100_000
HOLZER = "torsion.analyses.modes.holzer:holzer_modes"  # a name, since it stands on this module
MOST_JUDGED = 200  # modes that are computed beyond those requested, for a rule
ROUNDS = 6  # of refining the shafts until the highest frequency of the modes stays put
JUST_ABOVE = 1e-3  # relative, of the last mode: the frequency for which shafts are refined
REACHING = 40  # times that shafts are refined until the modes lie in reach of their counts
NONE = np.empty(0, dtype=np.int64)  # no spans
Ruled = frozenset[str]  # analyses that the rules of a study read


class ModesSettings(Declared):
    """Settings of `modes`."""

    count: Annotated[int, Field(ge=1, le=MOST_MODES)] = given("how many elastic modes", 6)
    damped: bool | None = given(
        "damped frequencies and damping ratios too (default: when something damps)"
    )


def modes_settings(study: Study, ruled: Ruled) -> ModesSettings | None:
    """Return the settings of the modes that are computed; None where none are."""
    settings = study.analyses.get("modes")
    if isinstance(settings, ModesSettings):
        return settings
    # A motion over time is a sum of modes.
    is_read = "modes" in ruled or "transient" in study.analyses
    return ModesSettings() if is_read or not study.analyses else None


def without_mode(study: Study, mode: int, count: int, path: Path) -> Fault:
    """Return the fault of a setting about a mode that is not one of the `count` computed, or not one of the train."""
    settings = study.analyses.get("modes")
    requested = settings if isinstance(settings, ModesSettings) else ModesSettings()
    if count < requested.count:
        message = f"mode {mode} is none of the {count} elastic modes of the train"
        hint = f"one of 1 to {count}" if count else "a train with an elastic mode"
    else:
        message = f"mode {mode} is none of the {count} that are computed"
        hint = f"`modes: {{count: {mode}}}`"
    return Fault(path, message, hint)


@reported
class EnergyShare:
    """Share of the energy of every mode in a station, in the inner segments of a shaft, or in an elastic element."""

    component: str = result("station, shaft or element, and the kind of energy")
    share: FloatArray = result("1", "mode", "share of the kinetic or elastic energy")


@reported
class HolzerRow:
    """A station of a Holzer table and the link that leads to it, referred to the reference speed."""

    number: int = result("number of the row, from 1")
    station: str = result("name of the station")
    inertia: float | None = result("kg*m**2", "infinite where fixed, null where a loop is closed")
    angle: float = result("rad", "angle of the station")
    inertia_torque: float | None = result("N*m", "omega^2 J angle; null where fixed")
    before: int | None = result("row from which the link leads here; null at a start")
    through: str | None = result("name of the link")
    torque_in: float | None = result("N*m", "at the end of the link toward the row before")
    flexibility: float | None = result("rad/(N*m)", "null where the link has inertia inside")
    twist: float | None = result("rad", "angle of the row before - angle of this row")
    torque_out: float | None = result("N*m", "at the other end of the link")
    a: float | None = result("1", "A of a link with inertia inside")
    h: float | None = result("rad/(N*m)", "H of a link with inertia inside")
    b: float | None = result("N*m/rad", "B of a link with inertia inside")
    d: float | None = result("1", "D of a link with inertia inside")


@reported
class HolzerMode:
    """The Holzer table of one mode: each row follows from the row that it names."""

    mode: int = result("counted from 1")
    residual: float = result("1", "largest torque that nothing balances / largest torque")
    rows: tuple[HolzerRow, ...] = result("stations and the links that lead to them")


@reported
class Modes(Displayed, Keyed):
    """Natural frequencies with their certificate; shapes scaled to a generalised inertia of 1 kg m2."""

    frequency: FloatArray = result(
        "Hz", "mode", "undamped natural frequencies of the elastic modes, ascending"
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
        "Hz", "mode", "lower bound of each: counts prove that the mode lies between both"
    )
    upper: FloatArray = result("Hz", "mode", "upper bound of each")
    rigid: int = result("number of motions of exactly 0 Hz", key="rigid_motions")
    certified: bool = result("counts prove the bounds", key="is_certified")
    system: System = field(repr=False)
    distributed: "ShaftModes | None" = field(
        default=None, repr=False
    )  # of a train with distributed inertia

    def __getitem__(self, name: str) -> FloatArray:
        """Return every mode (modes,) rad at a component or station; raises KeyError with the nearest name."""
        stations = dict[str, int]()
        for position, station in enumerate(self.system.stations):
            stations.setdefault(station.name, position)
        for part in self.system.train.parts:
            if part.is_point and part.stations:
                stations[part.name] = part.stations[0]
        return np.asarray(self.shape[by_name(name, stations, "station")])

    @derived(
        "1",
        ("station", "mode"),
        "share of the kinetic energy (half of a distributed shaft at either end)",
        key="kinetic_share",
        printed=("mode", "station"),
    )
    def kinetic(self) -> FloatArray:
        """Share of the kinetic energy (stations, modes)."""
        energy = np.square(self.shape)
        energy *= np.where(self.system.held, 0.0, self.system.lumped_inertia)[:, None]
        if self.distributed is not None and self.system.bars is not None:
            half = self.distributed.shaft_kinetic / 2.0
            for ends in self.system.bars.ends.T:
                np.add.at(energy, ends, half)
        energy /= energy.sum(axis=0)
        return energy

    @derived(
        "1",
        ("span", "mode"),
        "share of the elastic energy",
        key="elastic_share",
        printed=("mode", "span"),
    )
    def elastic(self) -> FloatArray:
        """Share of the elastic energy (spans, modes)."""
        if self.distributed is not None:
            energy = self.distributed.elastic[self.system.condensed.span]
        else:
            flexibility = self.system.flexibility
            energy = np.square(self.torque)
            energy *= np.where(np.isfinite(flexibility), flexibility, 0.0)[:, None]
        energy /= energy.sum(axis=0)
        return energy

    @derived(
        "Holzer tables of the lowest modes: at most 12, and 600 rows of all (the first in any case)",
    )
    def holzer(self) -> tuple[HolzerMode, ...]:
        """Return the tables with rows as people read them."""
        tables: tuple[HolzerMode, ...] = resolve_name(HOLZER)(self)
        return tables

    @derived("energy of named stations, inner segments of shafts, and elastic elements")
    def energy_shares(self) -> tuple[EnergyShare, ...]:
        """Kinetic energy by station, all inner stations of a shaft together; elastic energy by element."""
        system = self.system
        stations = self.system.train.stations
        inner = by_part(system.station_part[len(stations) :])
        groups = {
            f"kinetic: {station.name}": self.kinetic[[k]] for k, station in enumerate(stations)
        }
        for bar in system.train.bars:
            if bar.part in inner:
                name = f"kinetic: {bar.name} (inner segments)"
                groups[name] = self.kinetic[len(stations) + inner[bar.part]]
        for element in elements(system):
            groups[f"elastic: {element.name}"] = self.elastic[list(element.spans)]
        return tuple(EnergyShare(name, energy.sum(axis=0)) for name, energy in groups.items())

    @derived("", "mode", "sign changes of the shape over elastic spans")
    def nodes(self) -> IntArray:
        """Number of nodes (modes,) of each shape."""
        square = np.square(2.0 * math.pi * self.frequency)
        tree = undamped_tree(self.system)
        return nodes(self.system, tree, chord_spans(self.system), self.shape, square)

    @property
    def enclosure(self) -> FloatArray:
        """Lower and upper bound (modes, 2) Hz of each frequency."""
        return np.stack([self.lower, self.upper], axis=1)


def modes(system: System, count: int | None = 6, *, refine: bool = True) -> Modes:
    """Return the lowest `count` elastic modes (None: as many as the system has), of a system that resolves them.

    Where the shafts of `system` do not resolve the last mode they are refined, and `Modes.system` is the system of
    the results. Raises InputError for a count below 1 or above 100 000; SolveError where shafts cannot be refined,
    where that is needed and `refine` is False, and for a frequency that cannot be proven.
    """
    if count is not None and not 1 <= count <= MOST_MODES:
        message = f"{count} modes cannot be computed"
        hint = f"give 1 to {MOST_MODES}"
        raise InputError([Fault(("count",), message, hint)])
    has_end = any(not table.holds for table in system.tables_over("frequency").values())
    if has_end:  # no mode above the end of a table is sought
        system = resolving(system, _table_end(system), refine=refine)
    if has_end or not refine or (system.bars is None and math.isinf(system.resolved_to)):
        result = modes_as_discretised(system, count)
    else:
        if count is None:
            count = modes_as_discretised(system, None).frequency.size
        result = _refined(system, count)
    if count is not None and result.frequency.size < count and not has_end:
        demand_resolution(result.system, math.inf)
    demand_resolution(result.system, float(result.frequency.max(initial=0.0)))
    return result


def modes_up_to(known: Modes, requested: int, reach: float) -> tuple[FloatArray, float]:
    """Return natural frequencies (modes,) in Hz up to `reach` (Hz), and the frequency below which none is missing.

    known: the modes of which `requested` were sought; where they end below `reach`, more are computed. The second
    number is infinite where the train has no further mode, and stays below `reach` where no more can be computed.
    """
    frequency = known.frequency
    sought = requested
    tables = known.system.tables_over("frequency")
    while (last := float(frequency.max(initial=0.0))) < reach:
        if frequency.size < sought:
            has_end = any(not table.holds for table in tables.values())
            return frequency, _table_end(known.system) if has_end else math.inf
        sought = 2 * frequency.size + 2
        if sought > MOST_JUDGED:
            break
        try:
            frequency = modes(known.system, sought).frequency
        except SolveError:
            break
    return frequency, last


def _table_end(system: System) -> float:
    """Return the frequency (Hz) at which the first table of a coupling ends."""
    from torsion.assembly.tabled_spans import reach

    return reach(system)[1] / (2.0 * math.pi)


def _refined(system: System, count: int) -> Modes:
    """Return the lowest `count` modes of the train, discretised for the last of them and for what `system` was."""
    from torsion.analyses.modes.mode_nodes import reach
    from torsion.kernels.modes.natural_modes import brackets
    from torsion.kernels.trees.tree import rigidity

    # So that the last of them, which counts find, lies in reach, as far as settings allow.
    highest = system.requested.frequency
    for _ in range(REACHING):
        bars = system.condensed_shafts
        if bars is None or not math.isfinite(bars.limit):
            break
        tree = undamped_tree(system)
        resolved = reach(tree)
        if resolved.count >= count:
            rank = np.array([len(rigidity(tree.static).free_roots) + count - 1])
            just_above = float(brackets(tree, rank, tolerance=JUST_ABOVE)[1][0])
            system = rediscretised(system, max(highest, just_above / (2.0 * math.pi)))
            break
        finer = rediscretised(system, resolved.frequency / (2.0 * math.pi))
        if _discretisation(finer) == _discretisation(system):
            break
        system = finer

    result = _in_more_segments(modes_as_discretised(system, count), count)
    for _ in range(ROUNDS):
        system = result.system
        finer = rediscretised(system, max(highest, float(result.frequency.max(initial=0.0))))
        if _discretisation(finer) == _discretisation(system):
            return result if system.bars is None else replace(result, system=finer)
        if system.bars is not None and is_as_fine(system, finer):
            break
        result = modes_as_discretised(finer, count)
    return result


def _in_more_segments(modes: Modes, count: int) -> Modes:
    """Return modes of lumped shafts in more segments until the train has `count` modes, as far as settings allow."""
    frequency = 0.0
    system = modes.system
    half_waves = [
        math.pi / phase(bar, 1.0)
        for bar in system.train.bars
        if bar.density > 0 and bar.segments is None
    ]
    while system.bars is None and modes.frequency.size < count and half_waves:
        frequency = max(2.0 * frequency, min(half_waves))
        finer = rediscretised(system, frequency)
        if _discretisation(finer) != _discretisation(system):
            system = finer
            modes = modes_as_discretised(finer, count)
        elif finer.resolved_to < frequency:
            break
    return modes


def _discretisation(system: System) -> tuple[dict[str, int], int]:
    return system.segments, 0 if system.bars is None else system.bars.degree


def modes_as_discretised(system: System, count: int | None = 6) -> Modes:
    """Return the lowest `count` elastic modes (None: all) of the system itself, whether it resolves them or not."""
    if system.tables_over("frequency"):
        from torsion.analyses.modes.tabled_modes import tabled_modes

        result: Modes = tabled_modes(system, count, modes_as_discretised)
        return result
    tree = undamped_tree(system)
    node = system.condensed.node
    chords = chord_spans(system)
    if system.bars is not None and system.condensed_shafts is not None:
        from torsion.analyses.modes.mode_nodes import referred_modes

        referred = referred_modes(tree, count)
    elif chords.size:
        from torsion.kernels.modes.variant_networks import counted_modes

        ends = node[system.driving[chords]], node[system.driven[chords]]
        flexibility = (system.flexibility / system.span_ratio**2)[chords]
        referred = counted_modes(tree, *ends, flexibility, count)
    else:
        from torsion.kernels.modes.natural_modes import tree_modes

        referred = tree_modes(tree, count)
    outer = referred.torque if referred.shafts is None else referred.shafts.torque_outer
    hertz = 1.0 / (2.0 * math.pi)
    return Modes(
        referred.frequency * hertz,
        referred.angle[node] * system.speed_ratio[:, None],
        span_torques(system, referred.torque, outer, chords, referred.loop_torque),
        referred.lower * hertz,
        referred.upper * hertz,
        referred.rigid,
        referred.certified,
        system,
        referred.shafts,
    )


def undamped_tree(system: System) -> Tree:
    """Return the tree with the laws of its distributed shafts, without spans that have damping but no stiffness.

    These hold nothing without damping.
    """
    tree = system.condensed.tree
    if system.condensed_shafts is not None:
        tree = replace(tree, shafts=system.condensed_shafts)
    return tree.cut(np.isinf(tree.flexibility))


def chord_spans(system: System) -> IntArray:
    """Return the spans (chords,) with a stiffness that close loops or lie parallel to another span."""
    extra = system.condensed.extra
    return extra[np.isfinite(system.flexibility[extra])]


def span_torques(
    system: System,
    torque: np.ndarray,
    outer: np.ndarray,
    chords: IntArray = NONE,
    chord_torque: np.ndarray | float = 0.0,
) -> np.ndarray:
    """Return torques (spans, columns) N m at each driving station, from those (tree stations, columns) at both ends.

    outer: `torque` itself without distributed shafts; chord_torque: (chords, columns) N m at one speed, positive when
    the driving side pushes.
    """
    condensed = system.condensed
    if outer is not torque:
        from_parent = condensed.span[condensed.sign > 0]
        at_driving = outer.copy()
        at_driving[from_parent] = torque[from_parent]
        torque = at_driving
    stated = torque[condensed.span]
    stated[condensed.extra] = 0.0
    if chords.size:
        stated[chords] = chord_torque * condensed.sign[chords, None]
    return np.asarray(stated / (condensed.sign * system.span_ratio)[:, None])
