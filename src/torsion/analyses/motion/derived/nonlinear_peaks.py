"""The exact motion at the peaks of a response whose couplings have play, friction or stages.

A band holds all modes up to some multiple of what is excited and of the couplings' own frequencies, and as many more as
cost little; the others are a compliance (T114). Work is counted and not timed, so that a result is the same on
every machine.
"""

import math
from dataclasses import dataclass, field, replace

import numpy as np

from torsion.analyses.motion.curves.torque_curves import Curves
from torsion.analyses.motion.events.transient_settings import TransientSettings
from torsion.analyses.motion.train.loaded_train import Built, Standing
from torsion.analyses.motion.train.nonlinear_couplings import build
from torsion.analyses.response.amplitudes import Balanced, Response, Synthesis
from torsion.analyses.response.balanced_couplings import balanced_spans
from torsion.analyses.undamped_modes import modes_as_discretised
from torsion.arrays import FloatArray
from torsion.errors import InputError, SolveError
from torsion.findings import Progress, Work
from torsion.kernels.motion.march import NEWS
from torsion.kernels.motion.piecewise_elements import Clearance, DelayedFriction
from torsion.kernels.trees.tree_response import Status
from torsion.results import reported, result
from torsion.study import Study

SETTLED = 1e-4  # of the amplitude: change from one window to the next
# of the range in which a coupling is not linear: the largest amplitude of each is compared
PARTS = 4
CYCLES = 16  # of the component, in a window
WINDOWS = (8, 16, 32, 64)  # after which the last two are compared
SMALL = 1e-6  # of the largest torque: less is not compared
WIDE = 3e-3  # change of an amplitude on doubling the band of modes, up to which it is wide enough
SAMPLES = 4096  # of a window
LARGEST_COMMON = 64  # revolutions of a window that orders have in common
# of the highest frequency of excitation, and of the modes of which the couplings have most
MULTIPLE = 8.0
CHEAP = 2e5  # rad of the fastest mode in the first windows, up to which modes are kept anyway
MOST_WORK = 2.5e5  # blocks of a small train in all comparisons: about 25 s
ALONE = 3.0  # one motion has this share of what is left: 1/ALONE
LARGE = 60.0  # states of a train, whose blocks are twice the work


@reported
class NonlinearPeak:
    """A large torque amplitude of a nonlinear coupling, twice; the largest stands first."""

    coupling: str = result("which")
    component: str = result("harmonic component of the largest amplitude")
    speed: float = result("rad/s", "reference speed of it")
    response: float = result("N*m", "amplitude in the response, by harmonic balance")
    exact: float | None = result(
        "N*m",
        "settled amplitude of the exact motion that starts from the response; null if it does not settle",
    )
    difference: float | None = result("1", "of the response from the exact motion, of the latter")
    half_range: float = result(
        "N*m", "(max - min)/2 of the exact motion in its last window, all components"
    )
    greatest: float = result("N*m", "largest magnitude of its torque in that window")
    from_rest: float | None = result(
        "N*m",
        "amplitude of the exact motion that starts without vibration, if the response has several "
        "solutions; null otherwise, or if it does not settle",
    )
    solutions: int = result("of harmonic balance at that speed; the response has the largest")
    several_from: float | None = result(
        "rad/s", "lowest reference speed of several solutions; null for none"
    )
    several_to: float | None = result("rad/s", "highest of them")
    opens_from: float | None = result(
        "rad/s", "lowest reference speed at which its backlash opens; null for none"
    )
    opens_to: float | None = result("rad/s", "highest of them")
    mode: int = result(
        "mode of the linear train with the largest share of its energy in the coupling, from 1"
    )
    natural_frequency: float = result(
        "Hz", "of that mode with all such couplings as stiff as at these amplitudes"
    )
    ended: bool  # the motion was followed as long as it may be; else the work of the comparisons had its end before
    span: int  # of the coupling
    half_ranges: FloatArray  # (spans,) N m, as `half_range`
    greatests: FloatArray  # (spans,) N m


@reported
class NonlinearPeaks:
    """Every coupling with play, friction or stages."""

    each: tuple[NonlinearPeak, ...] = result(
        "every coupling with backlash, friction or stages", key=""
    )
    computed: Synthesis | None = (
        None  # of the response alone, with which the exact motions are compared
    )


class WorkEnds(Exception):
    """The work that a comparison may be is done."""


@dataclass
class Band:
    """A response that is compared, the modes that exact motions keep, and the work that is left for them."""

    study: Study
    response: Response
    balanced: Balanced
    progress: Progress
    modes: int = 0  # 0: not known yet
    # largest of an amplitude or a peak on doubling the band; None: not known yet
    change: float | None = None
    is_complete: bool = False
    left: float = field(default_factory=lambda: MOST_WORK)
    left_of_motion: float = math.inf
    cost: float = 1.0  # of a block
    done: float = 0.0  # share of the comparisons
    number: int = 1  # of comparisons

    def limit(self, duration: float) -> int:
        """Number of modes, of motions whose first windows last so long (s)."""
        if not self.modes:
            modes = modes_as_discretised(self.response.system, None)
            w = 2.0 * math.pi * np.sort(modes.frequency)
            mainly = modes.frequency[modes.elastic[list(self.balanced.spans)].argmax(axis=1)]
            highest = max(float(mainly.max()), float(self.response.frequency.max()))
            kept = max(MULTIPLE * 2.0 * math.pi * highest, CHEAP / duration)
            self.modes = max(int(np.searchsorted(w, kept)), 1)
        return self.modes

    def begin_motion(self, built: Built) -> None:
        """Allot work to the motion of a train."""
        self.is_complete = not built.is_band
        if self.is_complete:
            self.change = 0.0
        self.cost = 1.0 + ((2 * built.train.motions + built.train.inputs) / LARGE) ** 2
        self.left_of_motion = self.left / ALONE

    def spend(self, what: str, share: float) -> None:
        """The work of some blocks; raises WorkEnds."""
        self.left -= NEWS * self.cost
        self.left_of_motion -= NEWS * self.cost
        self.progress(f"exact motion at peaks, {what}", self.done + share / self.number)
        if self.left_of_motion < 0.0:
            raise WorkEnds


def exact_peaks(work: Work, response: Response, balanced: Balanced) -> tuple[NonlinearPeak, ...]:
    """The peaks of every nonlinear coupling; none where the train has no such motion, and the plan then says why.

    The first speed of each coupling is computed before the second of any.
    """
    title = "exact motion at the peaks of nonlinear couplings"
    try:
        with work.log.step(title, "the response has one harmonic of their torques") as step:
            band = Band(work.study, response, balanced, work.progress)
            compared = [
                (span, rank, speed)
                for span in balanced.spans
                for rank, speed in enumerate(_compared_speeds(response, balanced, span))
            ]
            peaks, band.number = dict[tuple[int, int, int], NonlinearPeak](), len(compared)
            for key in sorted(compared, key=lambda key: key[1]):
                band.done = len(peaks) / band.number
                peaks[key] = _peak(band, key[0], key[2])
            step.method = "from event to event, until it repeats itself"
            step.size = f"{len(balanced.spans)} couplings, {len(peaks)} motions"
            if band.change:
                step.size += (
                    f"; {band.modes} modes of the parts, half as many change torques by "
                    f"{100.0 * band.change:.2g} %"
                )
    except (InputError, SolveError) as error:
        work.log.without(title, str(error))
        return ()
    return tuple(peaks[key] for key in compared)


def _compared_speeds(response: Response, balanced: Balanced, span: int) -> list[int]:
    """Speeds, by number: of the largest torque amplitude, then of that in each part of the range that is not linear."""
    number, size = balanced.spans.index(span), _amplitude(response, span).max(axis=1)
    beyond = np.flatnonzero(balanced.amplitude[:, number] > balanced.first[:, number])
    parts = (part for part in np.array_split(beyond, PARTS) if part.size)
    largest = [int(part[size[part].argmax()]) for part in parts]
    return list(dict.fromkeys([int(size.argmax()), *largest]))


def _amplitude(response: Response, span: int) -> FloatArray:
    """(speeds, components) N m, 0 where it is not known."""
    return np.where(response.status == Status.OK, np.abs(response.torque[:, :, span]), 0.0)


def _peak(band: Band, span: int, index: int) -> NonlinearPeak:
    """The comparison of a coupling at the speed number `index`."""
    response, balanced = band.response, band.balanced
    amplitude, number = _amplitude(response, span)[index], balanced.spans.index(span)
    component, part = (
        int(amplitude.argmax()),
        band.study.train.parts[int(response.system.span_part[span])],
    )
    speed, w = float(response.speed[index]), 2.0 * math.pi * response.frequency[index, component]
    window = _window(response, speed, w)
    motion = _in_band(band, span, index, w, window)
    balance, exact = float(amplitude[component]), motion.amplitude
    solutions, from_rest = int(balanced.number[index, number]), None
    if solutions > 1:
        from_rest = _settle(band, span, index, w, window, vibrates=False).amplitude
    several = _ends(response.speed[balanced.number[:, number] > 1])
    has_play = part.nonlinear is not None and bool(part.nonlinear.play)
    opens = _ends(response.speed[has_play & (balanced.share[:, number] < 1.0)])
    mode, frequency = _natural_frequency(band, span, index)
    wider = 1.0 + 2.0 * (band.change or 0.0)  # what a wider band may add, for verdicts
    return NonlinearPeak(
        coupling=part.name,
        component=response.lines[component].words,
        speed=speed,
        response=balance,
        exact=exact,
        difference=balance / exact - 1.0 if exact else None,
        half_range=float(motion.half_range[span]),
        greatest=float(motion.greatest[span]),
        from_rest=from_rest,
        solutions=solutions,
        several_from=several[0],
        several_to=several[1],
        opens_from=opens[0],
        opens_to=opens[1],
        mode=mode,
        natural_frequency=frequency,
        ended=motion.ended,
        span=span,
        half_ranges=motion.half_range * wider,
        greatests=motion.greatest * wider,
    )


def _ends(speed: FloatArray) -> tuple[float | None, float | None]:
    """The lowest and highest of some speeds."""
    return (float(speed[0]), float(speed[-1])) if speed.size else (None, None)


def _natural_frequency(band: Band, span: int, index: int) -> tuple[int, float]:
    """The mode that a span has most of, from 1, and its frequency (Hz) at the amplitudes of a speed."""
    balanced, system = band.balanced, band.response.system
    flexibility, spans = system.flexibility.copy(), list(balanced.spans)
    mode = int(modes_as_discretised(system, None).elastic[span].argmax())
    stiffness = balanced.share[index] / flexibility[spans] + balanced.extra[index].real
    flexibility[spans] = 1.0 / stiffness
    modes = modes_as_discretised(replace(system, flexibility=flexibility), None)
    return mode + 1, float(modes.frequency[mode])


def _window(response: Response, speed: float, w: float) -> float:
    """s in which all orders repeat, CYCLES of the component at least."""
    orders = [line.order for line in response.lines if line.order is not None]
    turns = math.lcm(*(order.denominator for order in orders)) if orders else 1
    period = 2.0 * math.pi / w
    window = period
    if orders and turns <= LARGEST_COMMON:
        window = 2.0 * math.pi / speed * turns
    return float(window * max(1, math.ceil(CYCLES * period / window)))


@dataclass(frozen=True)
class Settled:
    """What a motion is in its last window."""

    amplitude: float | None  # N m of the component; None where the window before differs
    half_range: FloatArray  # (spans,) N m
    greatest: FloatArray  # (spans,) N m
    ended: bool = True


def _in_band(band: Band, span: int, index: int, w: float, window: float) -> Settled:
    """The settled motion that begins as the response is; the first that settles also says how wide a band has to be."""
    motion = _settle(band, span, index, w, window, vibrates=True)
    while band.change is None and motion.amplitude:
        coarse, band.modes = motion, 2 * band.modes
        motion = _settle(band, span, index, w, window, vibrates=True)
        change = math.inf
        if coarse.amplitude and motion.amplitude:
            change = abs(coarse.amplitude / motion.amplitude - 1.0)
        if change <= WIDE or band.is_complete:
            narrow, wide = (np.array([m.half_range, m.greatest]) for m in (coarse, motion))
            of_peaks = float((np.abs(narrow - wide) / np.maximum(wide, SMALL * wide.max())).max())
            band.change = 0.0 if band.is_complete else max(change, of_peaks)
    return motion


def _settle(
    band: Band, span: int, index: int, w: float, window: float, *, vibrates: bool
) -> Settled:
    """The component of circular frequency w (rad/s) in a span over a window (s), at the speed number `index`.

    The motion begins with the mean torques, and as the response is where it `vibrates`; its windows are compared until
    one repeats the one before.
    """
    response, ends = band.response, [windows * window for windows in WINDOWS]
    settings = TransientSettings.model_construct(
        duration=ends[0], initial="steady", events=(), samples=None, modes=band.limit(ends[0])
    )
    study, path = replace(band.study, analyses={}), ("analyses", "response")
    built = build(study, response.system, settings, path, speed=float(response.speed[index]))
    band.begin_motion(built)
    if vibrates:
        built = _vibrating(built, response, index)
    last, none = None, np.zeros(len(response.system.spans))
    try:
        motions = built.run(ends, progress=band.spend)
        for end, (motion, _) in zip(ends, motions, strict=True):
            curves, amplitudes = Curves(built, motion), list[float]()
            # In the last two windows the component is the same once nothing of the start is left.
            for begin in (end - 2.0 * window, end - window):
                time = begin + np.linspace(0.5, SAMPLES - 0.5, SAMPLES) * (window / SAMPLES)
                torque = curves.torque(time)[0]
                amplitudes.append(2.0 * abs(np.mean(torque[span] * np.exp(-1j * w * time))))
            before, amplitude = amplitudes
            repeats = abs(amplitude - before) <= SETTLED * amplitude
            half_range = (torque.max(axis=1) - torque.min(axis=1)) / 2.0
            greatest = np.abs(torque).max(axis=1)
            last = Settled(amplitude if repeats else None, half_range, greatest)
            if repeats:
                return last
    except WorkEnds:
        return replace(last or Settled(None, none, none), amplitude=None, ended=False)
    assert last is not None
    return last


def _vibrating(built: Built, response: Response, index: int) -> Built:
    """The same train, begun as a response is at the speed number `index`."""
    balanced, loaded, system = response.balanced, built.loaded, built.loaded.system
    if balanced is None:
        return built
    rate, angle = 2j * math.pi * response.frequency[index][:, None], response.angle[index]
    inertia = np.where(system.held, 0.0, system.lumped_inertia)
    position, speed = (
        loaded.shape.T @ (inertia * part.sum(axis=0).real) for part in (angle, rate * angle)
    )
    position = position + built.position
    stands = list(built.standing)
    for number, span in enumerate(balanced.spans):
        coupling = balanced_spans(response.system)[span]
        mean = response.mean[index, span]
        size, torque = balanced.amplitude[index, [number]], np.abs(mean)[None]
        bias = float(np.sign(mean) * coupling.bias(size, torque)[0])
        if not coupling.half:  # its own spring is one of the linear train
            moved = coupling.stiffness * (bias - float(np.sign(mean) * coupling.static(torque)[0]))
            bent = np.zeros(len(response.system.spans))
            bent[span] = moved / coupling.stiffness
            position = position + loaded.positions(bent)
        # The coupling's own twist in every component.
        whole = response.system
        stiffness = (1.0 + 1j * whole.loss_factor[span]) / whole.flexibility[span]
        stiffness = stiffness + rate[:, 0] * whole.viscous[span]
        stiffness = balanced.share[index, number] * stiffness + balanced.extra[index, number]
        twists = response.torque[index, :, span] / stiffness
        twist, twisting = float(twists.sum().real), float((rate[:, 0] * twists).sum().real)
        for k, stand in enumerate(stands):
            if built.couplings[stand.coupling].span == span:
                stands[k] = _stand(stand, bias, twist, twisting)
    return replace(built, position=position, speed=built.speed + speed, standing=tuple(stands))


def _stand(stand: Standing, bias: float, twist: float, twisting: float) -> Standing:
    """How an element stands at a deviation (rad) from its mean twist and a rate of it (rad/s)."""
    element = stand.element
    if isinstance(element, Clearance):
        total = bias + twist
        side = int(np.sign(total)) if abs(total) > element.half else 0
        spring = element.stiffness * (total - side * element.half)
        torque = side * (spring + element.viscous * twisting)
        return replace(stand, twist=total, regime=side if torque >= 0.0 else 2 * side)
    half = element.half if isinstance(element, DelayedFriction) else 0.0
    limit = half + element.capacity / element.stiffness
    x = min(max(twist, -limit), limit)
    return replace(stand, twist=x, regime=int(np.sign(x)) if half and abs(x) > half else 0)
