"""The exact motion at the peaks of a response whose couplings have play, friction or stages."""

import math
from dataclasses import dataclass, replace

import numpy as np

from torsion.analyses.motion.compared_band import Band, WorkEnds
from torsion.analyses.motion.event_driven_curves import EventDrivenCurves
from torsion.analyses.motion.event_driven_train import Built, build
from torsion.analyses.motion.nonlinear_couplings import Standing
from torsion.analyses.motion.transient_settings import TransientSettings
from torsion.analyses.response.amplitudes import Balanced, Response, Synthesis
from torsion.analyses.response.balanced_couplings import balanced_spans
from torsion.analyses.undamped_modes import modes_as_discretised
from torsion.arrays import ComplexArray, FloatArray
from torsion.errors import InputError, SolveError
from torsion.findings import Work
from torsion.kernels.motion.piecewise_elements import Clearance, DelayedFriction
from torsion.kernels.tree_response import Status
from torsion.results import reported, result
from torsion.study import Study

SETTLED = 1e-4  # of the amplitude: change from one window to the next
PARTS = (
    4  # of the range in which a coupling is not linear: the largest amplitude of each is compared
)
CYCLES = 16  # of the component, in a window
WINDOWS = (8, 16, 32, 64)  # after which the last two are compared
SMALL = 1e-6  # of the largest torque: less is not compared
WIDE = 3e-3  # change of an amplitude on doubling the band of modes, up to which it is wide enough
SAMPLES = 4096  # of a window
LARGEST_COMMON = 64  # revolutions of a window that orders have in common


@reported
class NonlinearPeak:
    """A large torque amplitude of a nonlinear coupling, twice; the largest stands first."""

    coupling: str = result("", (), "which")
    component: str = result("", (), "harmonic component of the largest amplitude")
    speed: float = result("rad/s", (), "reference speed of it")
    response: float = result("N*m", (), "amplitude in the response, by harmonic balance")
    exact: float | None = result(
        "N*m",
        (),
        "settled amplitude of the exact motion that starts from the response; null if it does not settle",
    )
    difference: float | None = result(
        "1", (), "of the response from the exact motion, of the latter"
    )
    half_range: float = result(
        "N*m", (), "(max - min)/2 of the exact motion in its last window, all components"
    )
    greatest: float = result("N*m", (), "largest magnitude of its torque in that window")
    from_rest: float | None = result(
        "N*m",
        (),
        "amplitude of the exact motion that starts without vibration, if the response has several "
        "solutions; null otherwise, or if it does not settle",
    )
    solutions: int = result(
        "", (), "of harmonic balance at that speed; the response has the largest"
    )
    several_from: float | None = result(
        "rad/s", (), "lowest reference speed of several solutions; null for none"
    )
    several_to: float | None = result("rad/s", (), "highest of them")
    opens_from: float | None = result(
        "rad/s", (), "lowest reference speed at which its backlash opens; null for none"
    )
    opens_to: float | None = result("rad/s", (), "highest of them")
    mode: int = result(
        "",
        (),
        "mode of the linear train with the largest share of its energy in the coupling, from 1",
    )
    natural_frequency: float = result(
        "Hz", (), "of that mode with all such couplings as stiff as at these amplitudes"
    )
    ended: bool  # the motion was followed as long as it may be; else the work of the comparisons had its end before
    span: int  # of the coupling
    half_ranges: FloatArray  # (spans,) N m, as `half_range`
    greatests: FloatArray  # (spans,) N m


@reported
class NonlinearPeaks:
    """Every coupling with play, friction or stages."""

    each: tuple[NonlinearPeak, ...] = result(
        "", (), "every coupling with backlash, friction or stages", key=""
    )
    computed: Synthesis | None = (
        None  # of the response alone, with which the exact motions are compared
    )


def exact_peaks(work: Work, found: Response, balanced: Balanced) -> tuple[NonlinearPeak, ...]:
    """The peaks of every nonlinear coupling; none where the train has no such motion, and the plan then says why."""
    title = "exact motion at the peaks of nonlinear couplings"
    try:
        with work.log.step(title, "the response has one harmonic of their torques") as step:
            band = Band(found, balanced, work.progress)
            peaks = _peaks(work.study, found, balanced, band)
            step.method = "from event to event, until it repeats itself"
            step.size = f"{len(balanced.spans)} couplings, {len(peaks)} motions{band.words}"
    except (InputError, SolveError) as error:
        work.log.without(title, str(error))
        return ()
    return peaks


def _peaks(
    study: Study, found: Response, balanced: Balanced, band: Band
) -> tuple[NonlinearPeak, ...]:
    """Coupling by coupling, but the first speed of each is computed before the second of any."""
    each = [
        (span, rank, at)
        for span in balanced.spans
        for rank, at in enumerate(_compared(found, balanced, span))
    ]
    there = dict[tuple[int, int, int], NonlinearPeak]()
    for number, one in enumerate(sorted(each, key=lambda one: one[1])):
        band.begin(number / len(each), len(each))
        there[one] = _peak(study, found, balanced, one[0], one[2], band)
    return tuple(there[one] for one in each)


def _compared(found: Response, balanced: Balanced, span: int) -> list[int]:
    """Speeds, by number: of the largest torque amplitude, then of that in each part of the range that is not linear."""
    number, size = balanced.spans.index(span), _amplitude(found, span).max(axis=1)
    beyond = np.flatnonzero(balanced.amplitude[:, number] > balanced.first[:, number])
    parts = (part for part in np.array_split(beyond, PARTS) if part.size)
    return list(
        dict.fromkeys([int(size.argmax()), *(int(part[size[part].argmax()]) for part in parts)])
    )


def _amplitude(found: Response, span: int) -> FloatArray:
    """(speeds, components) N m, 0 where it is not known."""
    return np.where(found.status == Status.OK, np.abs(found.torque[:, :, span]), 0.0)


def _peak(
    study: Study, found: Response, balanced: Balanced, span: int, at: int, band: Band
) -> NonlinearPeak:
    amplitude, number = _amplitude(found, span), balanced.spans.index(span)
    line, part = int(amplitude[at].argmax()), int(found.system.span_part[span])
    speed, w = float(found.speed[at]), 2.0 * math.pi * float(found.frequency[at, line])
    window, record = _window(found, speed, w), study.train.parts[part].nonlinear
    motion = in_band(study, found, span, at, w, window, band)
    linear, exact, solutions = (
        float(amplitude[at, line]),
        motion.amplitude,
        int(balanced.number[at, number]),
    )
    rest = (
        settled(study, found, span, at, w, window, band, vibrates=False).amplitude
        if solutions > 1
        else None
    )
    several = _ends(found.speed[balanced.number[:, number] > 1])
    opens = _ends(
        found.speed[balanced.share[:, number] < 1.0]
        if record is not None and record.play
        else np.empty(0)
    )
    mode, frequency = _natural_frequency(found, balanced, span, at)
    return NonlinearPeak(
        coupling=study.train.parts[part].name,
        component=found.lines[line].words,
        speed=speed,
        response=linear,
        exact=exact,
        difference=linear / exact - 1.0 if exact else None,
        half_range=float(motion.half_range[span]),
        greatest=float(motion.greatest[span]),
        from_rest=rest,
        solutions=solutions,
        several_from=several[0],
        several_to=several[1],
        opens_from=opens[0],
        opens_to=opens[1],
        mode=mode,
        natural_frequency=frequency,
        ended=motion.ended,
        span=span,
        half_ranges=band.raised(motion.half_range),
        greatests=band.raised(motion.greatest),
    )


def _ends(speed: FloatArray) -> tuple[float | None, float | None]:
    """The lowest and highest of some."""
    return (float(speed[0]), float(speed[-1])) if speed.size else (None, None)


def _natural_frequency(
    found: Response, balanced: Balanced, span: int, at: int
) -> tuple[int, float]:
    """The mode that a span has most of, from 1, and its frequency (Hz) at the amplitudes of the speed number `at`."""
    system, flexibility = found.system, found.system.flexibility.copy()
    mode = int(modes_as_discretised(system, None).elastic[span].argmax())
    own, spans = balanced.share[at] / flexibility[list(balanced.spans)], list(balanced.spans)
    flexibility[spans] = 1.0 / (own + balanced.extra[at].real)
    there = modes_as_discretised(replace(system, flexibility=flexibility), None)
    return mode + 1, float(there.frequency[mode])


def _window(found: Response, speed: float, w: float) -> float:
    """s in which all orders repeat, CYCLES of the component at least."""
    orders = [one.order for one in found.lines if one.order is not None]
    turns = math.lcm(*(order.denominator for order in orders)) if orders else 1
    window = (
        2.0 * math.pi / speed * turns if orders and turns <= LARGEST_COMMON else 2.0 * math.pi / w
    )
    return window * max(1, math.ceil(CYCLES * 2.0 * math.pi / (w * window)))


@dataclass(frozen=True)
class Settled:
    """What a motion is in its last window."""

    amplitude: float | None  # N m of the component; None where the window before differs
    half_range: FloatArray  # (spans,) N m
    greatest: FloatArray  # (spans,) N m
    ended: bool = True


def in_band(
    study: Study, found: Response, span: int, at: int, w: float, window: float, band: Band
) -> Settled:
    """The settled motion that begins as the response is; the first that settles also says how wide a band has to be."""
    motion = settled(study, found, span, at, w, window, band, vibrates=True)
    while band.change is None and motion.amplitude:
        coarse, band.modes = motion, 2 * band.modes
        motion = settled(study, found, span, at, w, window, band, vibrates=True)
        change = (
            abs(coarse.amplitude / motion.amplitude - 1.0)
            if coarse.amplitude and motion.amplitude
            else math.inf
        )
        if change <= WIDE or band.is_whole:
            ends = np.array([[one.half_range, one.greatest] for one in (coarse, motion)])
            of_peaks = float(
                (np.abs(ends[0] - ends[1]) / np.maximum(ends[1], SMALL * ends[1].max())).max()
            )
            band.change = 0.0 if band.is_whole else max(change, of_peaks)
    return motion


def settled(
    study: Study,
    found: Response,
    span: int,
    at: int,
    w: float,
    window: float,
    band: Band,
    *,
    vibrates: bool,
) -> Settled:
    """The component of circular frequency w (rad/s) in a span over a window (s), at the speed number `at`.

    The motion begins with the mean torques, and as the response is where it `vibrates`; its windows are compared until
    one repeats the one before.
    """
    speed, ends = float(found.speed[at]), [windows * window for windows in WINDOWS]
    settings = TransientSettings.model_construct(
        duration=ends[0], initial="steady", events=(), samples=None, modes=band.limit(ends[0])
    )
    built = build(
        replace(study, analyses={}), found.system, settings, ("analyses", "response"), speed=speed
    )
    band.known(built)
    if vibrates:
        built = vibrating(built, found, at)
    last, none = None, np.zeros(len(found.system.spans))
    try:
        for end, motion in zip(ends, built.until(ends, progress=band.spend), strict=True):
            curves = EventDrivenCurves(built, motion, None)
            each = [_torques(curves, end - back * window, window) for back in (2, 1)]
            before, own = (
                2.0 * abs(complex(np.mean(torque[span] * np.exp(-1j * w * time))))
                for time, torque in each
            )
            torque, repeats = each[1][1], abs(own - before) <= SETTLED * own
            half_range = (torque.max(axis=1) - torque.min(axis=1)) / 2.0
            last = Settled(own if repeats else None, half_range, np.abs(torque).max(axis=1))
            if repeats:
                return last
    except WorkEnds:
        return replace(last or Settled(None, none, none), amplitude=None, ended=False)
    assert last is not None
    return last


def _torques(
    curves: EventDrivenCurves, begin: float, window: float
) -> tuple[FloatArray, FloatArray]:
    """Times (samples,) s of a window and the torques (spans, samples) N m."""
    time: FloatArray = begin + (np.arange(SAMPLES, dtype=np.float64) + 0.5) * (window / SAMPLES)
    return time, curves.torque(time)[0]


def vibrating(built: Built, found: Response, at: int) -> Built:
    """The same, begun as a response is at the speed number `at`."""
    balanced, system = found.balanced, built.system
    if balanced is None:
        return built
    rate = 2.0j * math.pi * found.frequency[at][:, None]
    shape, inertia = built.shape, np.where(system.held, 0.0, system.lumped_inertia)
    motion = [
        shape.T @ (inertia * part.sum(axis=0).real)
        for part in (found.angle[at], rate * found.angle[at])
    ]
    place, speed = (
        built.place + motion[0][len(built.speed) - len(built.place) :],
        built.speed + motion[1],
    )
    standing = list(built.standing)
    for number, span in enumerate(balanced.spans):
        coupling = balanced_spans(found.system)[span]
        mean = found.mean[at, span]
        size, torque = balanced.amplitude[at, [number]], np.abs(found.mean[at, [span]])
        bias = float(np.sign(mean) * coupling.bias(size, torque)[0])
        if not coupling.half:  # its own spring is one of the linear train
            moved = coupling.stiffness * (bias - float(np.sign(mean) * coupling.static(torque)[0]))
            w = 2.0 * math.pi * built.modes.frequency
            place += built.modes.torque[span] * (moved / coupling.stiffness) / w**2
        own = coupling_twists(found, balanced, number, at)
        twist, twisting = float(own.sum().real), float((rate[:, 0] * own).sum().real)
        for k, one in enumerate(standing):
            if built.couplings[one.coupling].span == span:
                standing[k] = _standing(one, bias, twist, twisting)
    return replace(built, place=place, speed=speed, standing=tuple(standing))


def coupling_twists(found: Response, balanced: Balanced, number: int, at: int) -> ComplexArray:
    """(components,) rad of a coupling."""
    span, system, w = balanced.spans[number], found.system, 2.0 * math.pi * found.frequency[at]
    stiffness = (1.0 + 1j * system.loss_factor[span]) / system.flexibility[
        span
    ] + 1j * w * system.viscous[span]
    return np.asarray(
        found.torque[at, :, span]
        / (balanced.share[at, number] * stiffness + balanced.extra[at, number])
    )


def _standing(one: Standing, bias: float, twist: float, twisting: float) -> Standing:
    """How an element stands at a deviation (rad) from its mean twist and a rate of it (rad/s)."""
    element = one.element
    if isinstance(element, Clearance):
        whole = bias + twist
        side = int(np.sign(whole)) if abs(whole) > element.half else 0
        torque = side * (
            element.stiffness * (whole - side * element.half) + element.viscous * twisting
        )
        return replace(one, twist=whole, regime=side if torque >= 0.0 else 2 * side)
    half = element.half if isinstance(element, DelayedFriction) else 0.0
    most = half + element.capacity / element.stiffness
    x = min(max(twist, -most), most)
    return replace(one, twist=x, regime=int(np.sign(x)) if half and abs(x) > half else 0)
