"""The declared result of motion over time: torques, their peaks, speeds, and whether they can be trusted."""

import numpy as np

from torsion.analyses.motion.curves.event_driven_curves import Switching
from torsion.analyses.motion.derived.order_tracking import OrderTracking
from torsion.analyses.motion.derived.resonances_passed import Passage
from torsion.analyses.motion.element_peaks import ElementPeak, element_peaks
from torsion.analyses.motion.events.milling_ice import IceTorque
from torsion.analyses.motion.events.transient_settings import DEFAULT_MOST
from torsion.analyses.response.amplitudes import spans_by_name
from torsion.arrays import FloatArray, IntArray
from torsion.assembly.system import System
from torsion.results import by_name, derived, reported, result

BALANCED = 1e-8  # of the largest energy: what the balance of it may lack
RESOLVED = 0.05  # of a peak: what modes too fast for the samples may add, and verdicts add
SETTLED = 0.01  # of a peak: by how much twice as many modes may change it
SPEED_KEPT = (
    0.1  # of the speed before: by which torques that do not follow the speed may let it change
)
SCATTER = 0.1  # of a peak: by which two motions that impacts set apart may differ in it
BETWEEN_PHASES = 0.005  # of a peak: what a phase between those that were computed may add
TINY = np.finfo(float).tiny


@reported
class Change:
    """A change of the law of a torque."""

    time: float = result("s", (), "when")
    what: str = result("", (), "the torque")


@reported
class TransientMotion:
    """The motion of the train from its events."""

    time: FloatArray = result("s", ("time",), "samples")
    torque: FloatArray = result(
        "N*m",
        ("span", "time"),
        "torque, positive when the driving side pushes",
        printed=("time", "end span"),
    )
    speed: FloatArray = result(
        "rad/s", ("station", "time"), "speed of its own shaft", printed=("time", "named station")
    )
    greatest: FloatArray = result("N*m", ("span",), "greatest torque, also between samples")
    greatest_at: FloatArray = result("s", ("span",), "when")
    least: FloatArray = result("N*m", ("span",), "least torque")
    least_at: FloatArray = result("s", ("span",), "when")
    before: FloatArray = result("N*m", ("span",), "mean torque before the events")
    reversals: IntArray = result(
        "", ("span",), "sign changes of the torque (at a gear: separations of the teeth)"
    )
    unresolved: FloatArray = result(
        "N*m",
        ("span",),
        "at most so much do modes and torques too fast for the times looked at add: not in the peaks",
    )
    residual: float = result(
        "1", (), "largest error of the balance of energy, of the largest energy of the motion"
    )
    speed_before: float = result("rad/s", (), "reference speed before the events")
    modes: int = result("", (), "elastic modes that were kept")
    system: System | None = None
    name: str = result("", (), "name of the motion", default="")
    change: float | None = result(
        "1",
        (),
        "largest relative change of a peak with twice as many modes; null with all modes",
        default=None,
    )
    rated: FloatArray | None = result(
        "N*m", ("span",), "mean torque at the rated point, or null", default=None
    )
    stress: FloatArray | None = result(
        "Pa", ("span",), "shear stress at the peak; null except for a shaft", default=None
    )
    damage: FloatArray | None = result(
        "1", ("span",), "Miner's sum; null if not requested", default=None
    )
    switching: Switching | None = result(
        "",
        (),
        "events of couplings with backlash, friction, stages or a capacity; null without them",
        default=None,
    )
    steps: int = result(
        "", (), "steps for the torques that follow the motion; 0: there are none", default=0
    )
    following: tuple[str, ...] = result("", (), "torques that follow the motion", default=())
    undamped: tuple[str, ...] = result(
        "",
        (),
        "points whose `damping` is omitted, because the law of a load damps there",
        default=(),
    )
    left_in_series: float = result(
        "1",
        (),
        "largest last term of their series over a step, of the largest of them",
        default=0.0,
    )
    passages: tuple[Passage, ...] = result(
        "", (), "resonances that the changing speed passes", default=()
    )
    changes: tuple[Change, ...] = result(
        "", (), "when a torque that follows the motion changes its law", default=()
    )
    orders: OrderTracking | None = result(
        "", (), "torques by orders of a shaft; null without orders", default=None
    )
    is_rare: bool = result(
        "",
        (),
        "no motion of normal operation: T_Kmax2 limits its couplings",
        key="rare",
        default=False,
    )
    ice: tuple[IceTorque, ...] = result("", (), "maximum ice torques of a class", default=())
    slowed: float | None = result(
        "1",
        (),
        "largest change of a propeller's mean speed over a revolution in ice, of that before; null "
        "without ice, and where torques follow the speed",
        default=None,
    )
    slip_phase: tuple[float, ...] = result(
        "rad",
        (),
        "phases of slip pulsations that the file leaves open. The curves are of the worst phases; "
        "maximum and minimum torques are over all computed phases",
        default=(),
    )
    phases_computed: int = result("", (), "how many sets of these phases were computed", default=0)
    worst_fault: str = result(
        "",
        (),
        "sense and time of reclosing of the worst short circuit. The curves are of this short circuit; "
        "maximum and minimum torques are over all computed ones; empty for a single one",
        default="",
    )
    faults_computed: int = result(
        "", (), "how many short circuits were computed; 0: one, or none", default=0
    )
    acting: tuple[str, ...] = result(
        "", (), "torques that act: periodic ones, mean ones, events", default=()
    )
    not_acting: tuple[str, ...] = result(
        "",
        (),
        "torques of the file that do not act in the transient response, with the reason",
        default=(),
    )
    fastest: float = 0.0  # rad/s of modes and torques
    turns: tuple[
        FloatArray, ...
    ] = ()  # of every span, values at which its torque turns, while damage is counted

    def __getitem__(self, name: str) -> FloatArray:
        """(samples,) N m: the torque in a component, of a shaft in segments where the peak is largest.

        Raises KeyError with the nearest name.
        """
        spans = by_name(name, {} if self.system is None else spans_by_name(self.system))
        return np.asarray(self.torque[max(spans, key=lambda span: float(self.peak[span]))])

    @property
    def peak(self) -> FloatArray:
        """(spans,) N m, the greatest magnitude, with what is not known of it."""
        return np.maximum(np.abs(self.greatest), np.abs(self.least)) + self.uncertain

    @property
    def range(self) -> FloatArray:
        """(spans,) N m, from the least to the greatest, with what is not known of them."""
        return self.greatest - self.least + 2.0 * self.uncertain

    @property
    def uncertain(self) -> FloatArray:
        """(spans,) N m: what modes without samples and phases between those computed may add to a peak, its scatter."""
        scatter = None if self.switching is None else self.switching.scatter
        between = (
            BETWEEN_PHASES * np.maximum(np.abs(self.greatest), np.abs(self.least))
            if self.phases_computed
            else 0.0
        )
        return np.asarray(self.unresolved + between + (0.0 if scatter is None else scatter))

    @derived("", (), "peaks of every elastic element")
    def elements(self) -> tuple[ElementPeak, ...]:
        return () if self.system is None else element_peaks(self, self.system)

    @derived("", (), "ok, or what makes the peaks doubtful and what to do")
    def status(self) -> str:
        """Return ok, or each doubt with its remedy in words."""
        found = []
        if self.residual > BALANCED:
            found.append(
                f"the balance of energy holds to {self.residual:.1g} only: report this train"
            )
        if (self.unresolved > RESOLVED * (self.peak + TINY)).any():
            message = "what is too fast for the times looked at may add more than 5 % to a peak"
            coarser = (
                self.system is not None
                and self.system.train.has_shafts
                and len(self.time) > DEFAULT_MOST
            )
            shafts = (
                "fewer `segments`, `model: fem`, " if coarser else ""
            )  # the default gives no more samples
            found.append(f"{message}: give more `samples`, {shafts}or a shorter `duration`")
        if self.change is not None and self.change > SETTLED:
            found.append(
                f"twice as many modes change a peak by {100.0 * self.change:.2g} %: give more `modes`"
            )
        if self.switching is not None and self.switching.band_change > SETTLED:
            change = 100.0 * self.switching.band_change
            found.append(
                f"twice the band of modes changes a torque by {change:.2g} %: compute a shorter time"
            )
        scatter = None if self.switching is None else self.switching.scatter
        if scatter is not None and (scatter > SCATTER * (self.peak + TINY)).any():
            change = 100.0 * float((scatter / (self.peak + TINY)).max())
            message = "impacts make the motion sensitive, and halved steps change a peak"
            found.append(
                f"{message} by {change:.2g} %: compute a longer time, whose peaks differ less"
            )
        if self.phases_computed and self.switching is not None:
            message = "with backlash, friction, stages or clutches, a few phases may miss the worst one of a pulsation"
            found.append(f"{message}: name its `phase`, in several motions")
        if self.slowed is not None and abs(self.slowed) > SPEED_KEPT:
            what = (
                "the ice slows the train"
                if self.slowed < 0.0
                else "the ice torque changes the speed of the train"
            )
            message = f"{what} by {100.0 * abs(self.slowed):.3g} %, and torques have the values of the speed before"
            found.append(f"{message}: let them follow it (`start` or `load`)")
        return "; ".join(found) or "ok"


@reported
class Transients:
    """Every motion over time that the file names."""

    each: tuple[TransientMotion, ...] = result("", (), "every motion over time", key="")
