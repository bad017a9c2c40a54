"""A train in rigid motions and modes: their shapes, what damps them, where they begin, and what spans carry at once.

Modes say everything of an elastic span between inertias. A rigid span, or a point without inertia, carries its share of
a torque that acts there without any motion: the same at every frequency, and so the exact response at one frequency
less that of all modes.
"""

import math
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from torsion.analyses.modes.mode_nodes import beside_modes, massless, rigid_shapes
from torsion.analyses.motion.events.transient_settings import PATH
from torsion.analyses.motion.train.state_before import State
from torsion.analyses.undamped_modes import Modes, modes_as_discretised
from torsion.arrays import FloatArray, IntArray
from torsion.assembly.system import System
from torsion.errors import Path, SolveError
from torsion.kernels.motion.loaded_modes import ModalTrain

MOST_MODES = 3000
MOST_OF_ELEMENTS = 200  # modes of a train with finite elements and nonlinear couplings
ROUNDING = 1e-13  # of the largest damping: less is none
BAND = 50  # modes kept of a train of finite elements, where the file names no number


@dataclass(frozen=True)
class TrainInModes:
    """A linear train in rigid motions and modes of generalised inertia 1, and the state about which it moves."""

    system: System
    modes: Modes
    before: State
    is_driven: bool  # its speed changes by itself: dampers to ground then damp the deviation from the motion as one
    shape: FloatArray  # (stations, rigid motions + modes) rad at own speed

    @property
    def rigid(self) -> int:
        """How many rigid motions stand before the modes."""
        return int(self.shape.shape[1]) - len(self.modes.frequency)

    @property
    def w(self) -> FloatArray:
        """Natural circular frequencies, (modes,) rad/s."""
        return 2.0 * math.pi * self.modes.frequency

    @property
    def deviation(self) -> FloatArray:
        """(stations, rigid motions + modes) the shapes from which dampers to ground count."""
        if not self.is_driven or self.system.held.any():
            return self.shape
        return np.column_stack([np.zeros(len(self.shape)), self.shape[:, 1:]])

    @property
    def ground(self) -> FloatArray:
        """(stations,) N m s/rad of the dampers to ground at the speed before the events."""
        from torsion.analyses.response.solver import ground_damping

        return ground_damping(self.system, np.array([self.before.speed]), self.before.mean)[:, 0]

    def twists(self, spans: IntArray) -> FloatArray:
        """(spans, rigid motions + modes) rad at the driving station's speed: from torques, as angles would cancel."""
        flexibility = self.system.flexibility[spans]
        slips = np.isinf(flexibility)
        twist = np.zeros((len(spans), self.shape.shape[1]))
        twist[:, self.rigid :] = (
            np.where(slips, 0.0, flexibility)[:, None] * self.modes.torque[spans]
        )
        relative = self.system.twist(self.shape / self.system.speed_ratio[:, None])[spans]
        if not self.system.held.any():
            relative[:, 0] = 0.0  # the motion of the whole train as one twists nothing
        return np.where(slips[:, None], relative, twist)

    def positions(self, twist: FloatArray) -> FloatArray:
        """(rigid motions + modes,) in which the spans are twisted by angles (spans,) rad."""
        return np.concatenate([np.zeros(self.rigid), self.modes.torque.T @ twist / self.w**2])

    def damped(self) -> ModalTrain:
        """The modes with what damps them: loss factors by their shares of the energy, viscous damping as it is."""
        system = self.system
        ratio = 0.5 * system.loss_factor @ self.modes.elastic
        damped = np.flatnonzero(system.viscous > 0)
        twist = self.twists(damped)
        damping = (system.viscous[damped, None] * twist).T @ twist
        if system.dampers:
            damping += (self.ground[:, None] * self.deviation).T @ self.deviation
        size = np.abs(damping).max(axis=1, initial=0.0)
        undamped = np.flatnonzero(size[: self.rigid] <= ROUNDING * size.max(initial=0.0))
        damping[undamped], damping[:, undamped] = 0.0, 0.0
        return ModalTrain(self.w, ratio + system.modal_ratios(len(self.w)), damping)

    def slowed_torques(self) -> FloatArray:
        """(spans, rigid motions + modes) N m s/rad: viscous torques in their spans, and what others carry of them.

        The loss factor of a span adds its share of the torque of every mode, as of a vibration at the mode's frequency.
        Raises SolveError for viscous damping at a point without inertia.
        """
        system, ratio, without = self.system, self.system.speed_ratio, massless(self.system)
        damped = np.flatnonzero(system.viscous > 0)
        driving, driven, column = (
            system.driving[damped],
            system.driven[damped],
            np.arange(len(damped)),
        )
        grounded = np.array([damper.station for damper in system.dampers], dtype=np.int64)
        stations = np.concatenate([driving, driven, grounded])
        if without[stations].any():
            name = system.train.parts[system.station_part[stations[without[stations]][0]]].name
            message = f"viscous damping acts at '{name}', a point without inertia"
            raise SolveError(message, "give the point an inertia, or use `loss_factor`", PATH)

        slowed = np.zeros((len(system.spans), self.shape.shape[1]))
        slowed[damped] = system.viscous[damped, None] * self.twists(damped)
        acting = np.zeros((len(system.stations), len(damped)))
        acting[driving, column] -= 1.0
        acting[driven, column] += ratio[driving] / ratio[driven]
        slowed += direct_torques(system, self.modes, acting) @ slowed[damped]
        if grounded.size:
            stations = np.unique(grounded)
            torque = self.ground[stations, None] * self.deviation[stations]
            slowed -= direct_torques(system, self.modes, np.eye(len(without))[:, stations]) @ torque
        slowed[:, self.rigid :] += system.loss_factor[:, None] * self.modes.torque / self.w
        return slowed


def train_in_modes(
    system: System, modes: Modes, before: State, *, is_driven: bool = False
) -> TrainInModes:
    """Return the train with the shapes of its rigid motions before those of its modes."""
    shape = np.concatenate([rigid_shapes(system), modes.shape], axis=1)
    train = TrainInModes(system, modes, before, is_driven, shape)
    # A damper that holds a combination of rigid motions leaves others free, with a double root 0 each: these motions are
    # to be motions of their own, as a double root has no two shapes.
    parts = slice(0 if system.held.any() else 1, train.rigid)
    damping = train.damped().viscous[parts, parts]
    if len(damping) > 1 and damping.any():
        values, turned = np.linalg.eigh(damping)
        shape[:, parts] = shape[:, parts] @ turned[:, np.argsort(np.abs(values))]
    return train


def kept_modes(
    system: System, count: int | Literal["all"], path: Path = PATH
) -> tuple[Modes, Modes]:
    """The certified elastic modes that are kept, and twice as many; both are the same where all are kept.

    A train with finite elements has no last mode: where all are requested, BAND of them are kept. Raises SolveError for
    a train too large for all.
    """
    size = system.condensed.tree.size
    if count == "all" and system.bars is None:
        if size > MOST_MODES:
            message = f"the transient response needs all modes, and the train has {size} stations, more than {MOST_MODES}"
            raise SolveError(message, "keep the lowest, for example `modes: 100`", path)
        modes = modes_as_discretised(system, None)
        return modes, modes
    number = BAND if count == "all" else count
    modes = modes_as_discretised(system, 2 * number)
    return lowest_modes(modes, number), modes


def all_modes(system: System, before: State, path: Path) -> Modes:
    """All modes of the linear parts of a train with nonlinear couplings."""
    if system.bars is None:
        return kept_modes(system, "all", path)[0]
    if before.torque.any() or before.twist.any():
        message = "backlash and friction together with finite elements start without torque"
        hint = "begin with `initial: rest` or `{speed: ...}`, or take `model: lumped`"
        raise SolveError(message, hint, path)
    modes = modes_as_discretised(system, MOST_OF_ELEMENTS + 1)
    if len(modes.frequency) > MOST_OF_ELEMENTS:
        message = f"backlash and friction need all modes, and the finite elements have more than {MOST_OF_ELEMENTS}"
        raise SolveError(message, "take `model: lumped`, or a lower highest frequency", path)
    return modes


def lowest_modes(modes: Modes, number: int) -> Modes:
    """Return the lowest modes, without those above them."""
    rows = {name: getattr(modes, name)[:number] for name in ("frequency", "lower", "upper")}
    columns = {name: getattr(modes, name)[:, :number] for name in ("shape", "torque")}
    shafts = modes.distributed
    if shafts is not None:
        changes = {name: values[:, :number] for name, values in vars(shafts).items()}
        shafts = replace(shafts, **changes)
    return replace(modes, **rows, **columns, distributed=shafts)


def direct_torques(
    system: System, modes: Modes, acting: np.ndarray, *, is_band: bool = False
) -> np.ndarray:
    """(spans, loads) N m at once under torques `acting` (stations, loads) N m at own speeds, real or complex as these.

    is_band: higher modes are left out, and stand at once for what they carry, as far as they do so slowly.
    """
    direct = np.zeros((len(system.spans), acting.shape[1]), dtype=acting.dtype)
    rows = np.flatnonzero(is_band | beside_modes(system)[1])
    loads = np.flatnonzero(acting.any(axis=0))
    if not (rows.size and loads.size):
        return direct
    from torsion.analyses.response.harmonic_components import Sources
    from torsion.analyses.response.solver import swept, undamped

    w = 2.0 * math.pi * modes.frequency
    slow = 0.5 * float(w.min(initial=2.0))  # rad/s, far from every mode
    condensed, ratio = system.condensed, system.speed_ratio[:, None]
    force = np.zeros((condensed.tree.size, len(loads)), dtype=complex)
    np.add.at(force, condensed.node, ratio * acting[:, loads])
    sources, none = Sources(force, None), np.zeros((len(system.stations), len(loads)))
    torque = swept(undamped(system), np.full(len(loads), slow), sources, none).torque.T
    moved = (modes.shape.T @ acting[:, loads]) / (w**2 - slow**2)[:, None]
    carried = (torque if np.iscomplexobj(acting) else torque.real)[rows] - modes.torque[
        rows
    ] @ moved
    direct[np.ix_(rows, loads)] = carried
    return direct
