"""The declared result of motion over time: torques, their peaks, speeds, and whether they can be trusted."""

import numpy as np

from torsion.analyses.motion.events.milling_ice import IceTorque
from torsion.analyses.motion.events.transient_settings import DEFAULT_MOST
from torsion.arrays import ComplexArray, FloatArray, IntArray
from torsion.assembly.elements import elements, spans_by_name
from torsion.assembly.system import NOTHING, System
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

    time: float = result("s", "when")
    what: str = result("the torque")


@reported
class CouplingEvent:
    """A coupling passed from one regime to another."""

    time: float = result("s", "when")
    coupling: str = result("which")
    what: str = result("contact, separation, slip, stuck or open")


@reported
class CouplingWork:
    """What a nonlinear coupling did in the whole motion."""

    coupling: str = result("which")
    contacts: int = result("how often its faces met")
    separations: int = result("how often they parted")
    slips: int = result("how often it began to slip")
    heat: float = result("J", "heat of its friction and of the damping of its contact")


@reported
class Switching:
    """The events of a motion between the regimes of nonlinear couplings."""

    events: tuple[CouplingEvent, ...] = result("every change of a regime, in the order of time")
    couplings: tuple[CouplingWork, ...] = result("what every nonlinear coupling did")
    work: float = result("J", "work of all torques on the motion")
    damped: float = result("J", "energy that the damping of the linear train took")
    sensitive_after: float | None = result(
        "s",
        "time from which halved steps change a torque by more than 1e-6 of its peak: read statistics "
        "there, not single values; null if this never happens",
    )
    band_change: float = result(
        "1",
        "change of the torques, relative to their peak, with twice the band of modes; 0: all modes are included",
    )
    scatter: FloatArray | None = result(
        "N*m",
        "span",
        "difference of the maximum torque with halved steps, if the motion is sensitive. Maximum "
        "and minimum torques are over both step sizes, and verdicts add the difference",
        default=None,
    )


@reported
class Passage:
    """A mode that an order, or a pulsation, meets while the speed changes."""

    mode: int = result("the elastic mode, from 1")
    what: str = result("what excites it")
    time: float = result("s", "when")
    speed: float = result("rad/s", "reference speed there")
    frequency: float = result("Hz", "of the mode")
    seconds: float = result("s", "how long within the range of half the power")
    share: float = result(
        "1", "maximum amplitude / steady amplitude at that speed; by a closed form"
    )


@reported
class TrackedTorque:
    """A torque by orders."""

    element: str = result("whose torque")
    torque: ComplexArray = result(
        "N*m",
        ("window", "order"),
        "its phasor of every order that is tracked: amplitude, and phase over the angle",
    )
    waterfall: FloatArray = result(
        "N*m", ("window", "multiple"), "amplitude of the multiples of the resolution, from 0"
    )

    @derived("N*m", "order", "largest amplitude of every order that is tracked")
    def largest(self) -> FloatArray:
        """The largest amplitude of each order over all windows, (orders,) N m."""
        return np.asarray(np.abs(self.torque).max(axis=0, initial=0.0))

    @property
    def window(self) -> IntArray:
        """(orders,) the window of the largest amplitude; there is one."""
        return np.asarray(np.abs(self.torque).argmax(axis=0))


@reported
class OrderTracking:
    """Torques by orders of the reference."""

    reference: str = result("the point over whose angle")
    turns: float = result("revolutions that it makes in one sense; orders need 8")
    order: FloatArray = result("1", "order", "orders of the reference that are tracked")
    resolution: float = result("1", "step between the orders of a waterfall")
    time: FloatArray = result("s", "window", "middle of each window")
    speed: FloatArray = result("rad/s", "window", "of the reference, mean of each window")
    aliased: float = result(
        "1", "largest change of an amplitude with half of the samples, of the largest"
    )
    left_out: int = result("windows omitted, because the torque changes too fast for their samples")
    each: tuple[TrackedTorque, ...] = result("every torque that is tracked")


@reported
class ElementPeak:
    """Torques of one element, including the mean; 0 for what is rounding beside the largest torque of the train."""

    component: str = result("name of the element")
    maximum: float = result("N*m", "maximum torque")
    maximum_at: float = result("s", "when")
    minimum: float = result("N*m", "minimum torque")
    minimum_at: float = result("s", "when")
    before: float = result("N*m", "mean torque before the events")
    rated: float = result("N*m", "mean torque at the rated point; 0 if it is not known")
    reversals: int = result("sign changes of the torque")
    unresolved: float = result("N*m", "what the samples do not resolve may add so much")
    stress: float | None = result("Pa", "largest shear stress; null except for a shaft")
    damage: float | None = result("1", "Miner's sum; null if not requested")

    @derived("1", "largest magnitude / mean torque before the events; null without such a torque")
    def of_before(self) -> float | None:
        return self._share(self.before)

    @derived("1", "largest magnitude / mean torque at the rated point; null without such a torque")
    def of_rated(self) -> float | None:
        return self._share(self.rated)

    def _share(self, mean: float) -> float | None:
        return max(abs(self.maximum), abs(self.minimum)) / abs(mean) if mean else None


@reported
class TransientMotion:
    """The motion of the train from its events."""

    time: FloatArray = result("s", "time", "samples")
    torque: FloatArray = result(
        "N*m",
        ("span", "time"),
        "torque, positive when the driving side pushes",
        printed=("time", "end span"),
    )
    speed: FloatArray = result(
        "rad/s", ("station", "time"), "speed of its own shaft", printed=("time", "named station")
    )
    greatest: FloatArray = result("N*m", "span", "greatest torque, also between samples")
    greatest_at: FloatArray = result("s", "span", "when")
    least: FloatArray = result("N*m", "span", "least torque")
    least_at: FloatArray = result("s", "span", "when")
    before: FloatArray = result("N*m", "span", "mean torque before the events")
    reversals: IntArray = result(
        "", "span", "sign changes of the torque (at a gear: separations of the teeth)"
    )
    unresolved: FloatArray = result(
        "N*m",
        "span",
        "at most so much do modes and torques too fast for the times looked at add, and where a phase is open motions "
        "between those computed: not in the peaks",
    )
    residual: float = result(
        "1", "largest error of the balance of energy, of the largest energy of the motion"
    )
    speed_before: float = result("rad/s", "reference speed before the events")
    modes: int = result("elastic modes that were kept")
    system: System | None = None
    name: str = result("name of the motion", default="")
    change: float | None = result(
        "1",
        "largest relative change of a peak with twice as many modes; null with all modes",
        default=None,
    )
    rated: FloatArray | None = result(
        "N*m", "span", "mean torque at the rated point, or null", default=None
    )
    stress: FloatArray | None = result(
        "Pa", "span", "shear stress at the peak; null except for a shaft", default=None
    )
    damage: FloatArray | None = result(
        "1", "span", "Miner's sum; null if not requested", default=None
    )
    switching: Switching | None = result(
        "events of couplings with backlash, friction, stages or a capacity; null without them",
        default=None,
    )
    steps: int = result(
        "steps for the torques that follow the motion; 0: there are none", default=0
    )
    following: tuple[str, ...] = result("torques that follow the motion", default=())
    undamped: tuple[str, ...] = result(
        "points whose `damping` is omitted, because the law of a load damps there", default=()
    )
    left_in_series: float = result(
        "1", "largest last term of their series over a step, of the largest of them", default=0.0
    )
    passages: tuple[Passage, ...] = result("resonances that the changing speed passes", default=())
    changes: tuple[Change, ...] = result(
        "when a torque that follows the motion changes its law", default=()
    )
    orders: OrderTracking | None = result(
        "torques by orders of a shaft; null without orders", default=None
    )
    is_rare: bool = result(
        "no motion of normal operation: T_Kmax2 limits its couplings", key="rare", default=False
    )
    ice: tuple[IceTorque, ...] = result("maximum ice torques of a class", default=())
    slowed: float | None = result(
        "1",
        "largest change of a propeller's mean speed over a revolution in ice, of that before; null "
        "without ice, and where torques follow the speed",
        default=None,
    )
    slip_phase: tuple[float, ...] = result(
        "rad",
        "phases of slip pulsations that the file leaves open. The curves are of the worst phases; "
        "maximum and minimum torques are over all computed phases",
        default=(),
    )
    phases_computed: int = result("how many sets of these phases were computed", default=0)
    worst_fault: str = result(
        "sense and time of reclosing of the worst short circuit. The curves are of this short circuit; "
        "maximum and minimum torques are over all computed ones; empty for a single one",
        default="",
    )
    faults_computed: int = result(
        "how many short circuits were computed; 0: one, or none", default=0
    )
    acting: tuple[str, ...] = result(
        "torques that act: periodic ones, mean ones, events", default=()
    )
    not_acting: tuple[str, ...] = result(
        "torques of the file that do not act in the transient response, with the reason", default=()
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
        largest = np.maximum(np.abs(self.greatest), np.abs(self.least))
        between = BETWEEN_PHASES * largest if self.phases_computed else 0.0
        return np.asarray(self.unresolved + between + self.scatter)

    @property
    def scatter(self) -> FloatArray | float:
        """(spans,) N m, by which peaks of a sensitive motion differ with halved steps; else 0."""
        scatter = None if self.switching is None else self.switching.scatter
        return 0.0 if scatter is None else scatter

    @derived("peaks of every elastic element")
    def elements(self) -> tuple[ElementPeak, ...]:
        peaks = list[ElementPeak]()
        nothing = NOTHING * self.peak.max(initial=0.0)  # N m: torques below it are rounding
        for element in () if self.system is None else elements(self.system):
            spans, first = list(element.spans), element.spans[0]
            high, low = spans[self.greatest[spans].argmax()], spans[self.least[spans].argmin()]
            torques = self.greatest[high], self.least[low], self.before[first]
            greatest, least, before = (
                float(torque) if abs(torque) >= nothing else 0.0 for torque in torques
            )
            largest = [
                None if values is None else float(element.largest(values))
                for values in (self.stress, self.damage)
            ]
            stress, damage = (
                None if value is None or np.isnan(value) else value for value in largest
            )
            peak = ElementPeak(
                element.name,
                greatest,
                float(self.greatest_at[high]),
                least,
                float(self.least_at[low]),
                before,
                0.0 if self.rated is None else float(self.rated[first]),
                int(self.reversals[spans].max()),
                float(element.largest(self.unresolved)),
                stress,
                damage,
            )
            peaks.append(peak)
        return tuple(peaks)

    @derived("ok, or what makes the peaks doubtful and what to do")
    def status(self) -> str:
        """Return ok, or each doubt with its remedy in words."""
        doubts, size = list[str](), self.peak + TINY
        band = 0.0 if self.switching is None else self.switching.band_change
        if self.residual > BALANCED:
            doubts.append(
                f"the balance of energy holds to {self.residual:.1g} only: report this train"
            )
        if (self.unresolved > RESOLVED * size).any():
            has_shafts = self.system is not None and self.system.train.has_shafts
            # The default gives no more samples.
            is_coarse = has_shafts and len(self.time) > DEFAULT_MOST
            shafts = "fewer `segments`, `model: fem`, " if is_coarse else ""
            # A bound does not say which of the two it is of.
            has_phases = self.phases_computed > 0
            between = ", or between the phases computed," if has_phases else ""
            stated = "name the `phase` in several motions, " if has_phases else ""
            message = (
                f"what is too fast for the times looked at{between} may add more than 5 % to a peak"
            )
            doubts.append(
                f"{message}: {stated}give more `samples`, {shafts}or a shorter `duration`"
            )
        if (self.change or 0.0) > SETTLED:
            change = 100.0 * (self.change or 0.0)
            doubts.append(f"twice as many modes change a peak by {change:.2g} %: give more `modes`")
        if band > SETTLED:
            doubts.append(
                f"twice the band of modes changes a torque by {100.0 * band:.2g} %: compute a shorter time"
            )
        if (scatter := float(np.max(self.scatter / size, initial=0.0))) > SCATTER:
            doubts.append(
                "impacts make the motion sensitive, and halved steps change a peak by "
                f"{100.0 * scatter:.2g} %: compute a longer time, whose peaks differ less"
            )
        if self.phases_computed and self.switching is not None:
            doubts.append(
                "with backlash, friction, stages or clutches, a few phases may miss the worst one of a pulsation: "
                "name its `phase`, in several motions"
            )
        if len(self.slip_phase) > 1:  # one after another: the worst pair may differ in both
            doubts.append(
                f"{len(self.slip_phase)} phases are open, of which the worst together may be missed: "
                "name all but one `phase`, in several motions"
            )
        if abs(self.slowed or 0.0) > SPEED_KEPT:
            slows = (self.slowed or 0.0) < 0.0
            what = "the ice slows the train"
            what = what if slows else "the ice torque changes the speed of the train"
            doubts.append(
                f"{what} by {100.0 * abs(self.slowed or 0.0):.3g} %, and torques have the values of the speed "
                "before: let them follow it (`start` or `load`)"
            )
        return "; ".join(doubts) or "ok"


@reported
class Transients:
    """Every motion over time that the file names."""

    each: tuple[TransientMotion, ...] = result("every motion over time", key="")
