"""Chapter: transient responses."""

import math
from collections.abc import Iterator

import numpy as np

from torsion.analyses.motion.derived.order_tracking import TURNS
from torsion.analyses.motion.events.event_kind import settings_in_words
from torsion.analyses.motion.events.machine_events import ShortCircuit
from torsion.analyses.motion.events.milling_ice import Ice
from torsion.analyses.motion.events.transient_settings import TransientSettings, cases
from torsion.analyses.motion.train.state_before import ActingTorques
from torsion.analyses.motion.transient_motion import (
    OrderTracking,
    Switching,
    TransientMotion,
    Transients,
)
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, table
from torsion.output.figures.curves import amplitudes, over_time, span
from torsion.output.figures.curves import orders as ordered_lines
from torsion.output.figures.figure import Axis, Cells, Figure, Panel
from torsion.output.numbers import RPM, counted, given, number, rpm, scale, symbols
from torsion.output.records import Place, along
from torsion.output.stored.scene import Element, elements, highest
from torsion.results import listed
from torsion.rules.verdict_line import Checks

DECADES = 3.0  # below the largest amplitude that shades show
TORQUE = "torque amplitude"
MEAN = 2  # orders from 0 on in which, by the Hann window, the mean torque stands


def orders(tracking: OrderTracking | None, name: str) -> Iterator[Block]:
    """What the tracking says; `name` is that of the motion."""
    if tracking is None:
        return
    reference = tracking.reference
    if tracking.turns < TURNS:
        text = f"{reference} makes {number(tracking.turns, 3)} revolutions; below {TURNS} no order is reported."
        yield Paragraph(text, "note")
        return
    left = ""
    if tracking.left_out:
        omitted = counted(tracking.left_out, "window")
        left = f" {omitted} omitted: the samples do not resolve the motion."
    yield Paragraph(
        f"Order analysis of the torques at equal angles of {reference}, in {len(tracking.time)} windows of {TURNS} "
        f"revolutions (Hann); order resolution 1/{TURNS}. With half as many samples no amplitude changes by more than "
        f"{number(tracking.aliased, 2)} of the maximum.{left}"
    )
    windows = along(tracking, "window")
    rows = [
        (order, torque_at, windows[k], Place(torque_at, "window", k))
        for torque in tracking.each
        for order, torque_at, k in zip(
            along(tracking, "order"), along(torque, "order"), torque.window.tolist(), strict=True
        )
    ]
    if rows:
        titles = (
            f"element: < Component | 1.order: Order of {reference}:g | largest: Maximum amplitude [~N m] | "
            "speed: at [rpm] | time: at [s] | torque: Phase [deg]:3pg"
        )
        text = "Orders: maximum amplitude and phase against the angle of the reference"
        yield table(titles, rows, text)
    if len(tracking.time) < 2:
        return

    # Amplitudes over the speed, or over the time where the speed does not go one way, as curves and as a waterfall.
    x, axis = tracking.speed * RPM, Axis(f"speed of {reference}", "rpm")
    steps = np.diff(x)
    if not ((steps > 0.0).all() or (steps < 0.0).all()):
        x, axis = tracking.time, Axis("time", "s")
    sort = np.argsort(x)
    x = x[sort]
    over, names = span(axis, x), [f"order {given(order)}" for order in tracking.order.tolist()]
    for tracked in tracking.each:
        amplitude = tracked.waterfall[sort, MEAN:]
        unit = scale("N m", amplitude.max(axis=1))
        size, sizes = amplitude * unit.factor, np.abs(tracked.torque[sort]) * unit.factor
        mark = f"{name} {tracked.element}".lstrip()
        words = tracked.element + (f", {name}" if name else "")
        if names:
            lines = list(zip(names, sizes.T, strict=True))
            drawn = ordered_lines(x, lines, np.zeros(len(x), dtype=bool))
            panel = Panel(over, amplitudes(TORQUE, unit.unit, [sizes]), drawn)
            yield Figure(f"orders {mark}", f"Orders of the torque in {words}", (panel,))
        order = np.arange(float(MEAN), tracked.waterfall.shape[1]) * tracking.resolution
        cells = Cells(order, x, size, TORQUE, unit.unit, float(size.max()) or 1.0, DECADES)
        across = Axis(f"order of {reference}", "", 0.0, float(order[-1]))
        caption = f"Waterfall of the torque in {words}, without its mean: the darker the larger"
        waterfall = Panel(across, over, cells=cells, height=210.0)
        yield Figure(f"waterfall {mark}", caption, (waterfall,))


MOST_CURVES = 5  # in the figures: of the elements with the largest torque
MOST_NAMED = 4  # components in a sentence
MOST_PASSAGES = 20  # lines of a table
MOST_EVENTS = 20  # of the changes of regime that are listed
METHOD = (
    "Exact at every sample: every mode has a closed-form response to the events, and a torque is the sum over"
    " the modes. Material damping acts as modal damping by energy share."
)
FROM_EVENT_TO_EVENT = (
    "Exact from event to event: the train is linear between two changes of a coupling's regime, and each change is a "
    "root of the exact motion. Material damping acts as modal damping by energy share."
)
DRIVEN = METHOD.replace("to the events", "to the torques of every step")
UNRESOLVED = (
    "The last column bounds the torque of modes that the samples do not resolve, and of phases between those "
    "computed. The checks add it to the peak. To resolve them, increase `samples`, or state the `phase`."
)
TRANSIENT_RULES = ("transient", "ice")  # rules that limit the greatest torque over time


def chapter(findings: Findings) -> Iterator[Block]:
    """One section for each transient; nothing if none was requested."""
    transients = findings.get(Transients)
    if transients is None:
        return
    yield Heading("Transient response")
    settings_of = {case.name: case for case, _ in cases(findings.study)}
    for motion in transients.each:
        settings = settings_of[motion.name]
        if len(transients.each) > 1:
            yield Heading(f"Transient: {motion.name}", 2)
        yield Paragraph(_introduction(motion, settings))
        yield Paragraph(ActingTorques(motion.acting, motion.not_acting).words, brief=True)
        yield from _faults(motion, settings)
        yield from _steady_begin(findings, motion, settings)
        if motion.status != "ok":
            yield Paragraph(f"Not reliable: {motion.status}.", "fail", brief=True)
        events = [
            (event.at, event.body.key, event.time, settings_in_words(event.body))
            for event in settings.events
        ]
        if events:
            titles = "< Component | < Event | Start [s] | < Settings"
            yield table(titles, events, "Events; torques at the speed of the component")
        yield from _ice(motion, settings)
        yield table(
            "component: < Component -> | maximum: Maximum torque [~N m] -> maximum, ~ | maximum_at: Time [s] -> at, s | "
            "minimum: Minimum torque [~N m] -> minimum, ~ | minimum_at: Time [s] | before: Initial [~N m] | "
            "of_before: Peak / initial:3 -> times | of_rated: Peak / rated:3? | reversals: Reversals -> | "
            "unresolved: Not sampled [~N m]:s",
            motion.elements,
            "Torques over time including the mean torque; a torque reversal in a gear separates its teeth",
            short=f"Transient: {motion.name}" if motion.name else "Transient response",
            rows_in_summary=3,
        )
        if motion.switching is not None:
            yield from _switching(motion.switching)
        yield from _following(motion)
        yield from _loads(motion, settings)
        if motion.unresolved.any():
            yield Paragraph(UNRESOLVED, "note")
        yield from _figures(findings, motion, settings)
        yield from orders(motion.orders, motion.name)


def _faults(motion: TransientMotion, settings: TransientSettings) -> Iterator[Block]:
    """Which short circuits were computed, which is the worst, and what becomes of the mean torque meanwhile."""
    loads = {event.body.load for event in settings.events if isinstance(event.body, ShortCircuit)}
    if not loads:
        return
    words = {"stays": "stays", "falls": "falls to zero"}
    load = "stays or falls as stated" if len(loads) > 1 else words[loads.pop()]
    text = f"The mean torque of the machine {load} during a short circuit (`load`)."
    if motion.faults_computed:
        text = (
            f"The program computed {motion.faults_computed} electrical faults. The curves show the worst: "
            f"{motion.worst_fault}. The maximum and minimum torques are over all faults. {text}"
        )
    yield Paragraph(text, "note", brief=True)


def _steady_begin(
    findings: Findings, motion: TransientMotion, settings: TransientSettings
) -> Iterator[Block]:
    """How a motion begins that is steady before its events; briefly, where the file says neither that nor a speed."""
    if not motion.speed_before or settings.initial not in (None, "steady"):
        return
    study = findings.study
    if study.excites and settings.torques != ():
        text = "The motion starts with the steady vibration at this speed."
        if motion.switching is not None:
            text = (
                "The train has backlash, friction, stiffness stages or clutches. Therefore the periodic torques start "
                "at time 0 with the mean torques only, and the first revolutions show their start."
            )
        yield Paragraph(text, "note")
    if settings.initial is None and study.operation.rated is None:
        text = (
            f"The file has no `initial` and no rated speed. The motion starts steady at the highest speed, "
            f"{rpm(motion.speed_before)} rpm. To start elsewhere, set `initial: rest` or `{{speed: ...}}`."
        )
        yield Paragraph(text, "note", brief=True)


def _introduction(motion: TransientMotion, settings: TransientSettings) -> str:
    before = f"at {rpm(motion.speed_before)} rpm" if motion.speed_before else "at rest"
    kept = ""
    if motion.change is not None:
        kept = f"With twice as many modes no peak changes by more than {number(motion.change, 2)}. "
    method = DRIVEN if motion.steps else METHOD
    if motion.switching is not None:
        method = FROM_EVENT_TO_EVENT
    return (
        f"{number(settings.duration)} s from a train {before}, in {counted(len(motion.time), 'sample')}, of "
        f"{counted(motion.modes, 'elastic mode')}. {method} {kept}Energy balance error: "
        f"{number(motion.residual, 2)} of the maximum energy."
    )


def _ice(motion: TransientMotion, settings: TransientSettings) -> Iterator[Block]:
    """How the greatest torque of a class of ice was found, and what of the ice is to be verified."""
    if any(isinstance(event.body, Ice) and event.body.case for event in settings.events):
        text = (
            "Factor, angle and milling sequence of the ice cases: edition not confirmed. Compare them with the edition "
            "in force."
        )
        yield Paragraph(text, "note")
    if not motion.ice:
        return
    titles = (
        "at: < Propeller | ice_class: < Class | thickness: H | is_ducted: < Ducted | factor: k | diameter: D | "
        "hub_ratio: d/D | pitch_ratio: P/D | speed: n [rpm] | revolutions: Revolutions | torque: Q_{max} [~N m]"
    )
    yield table(titles, motion.ice, "Maximum ice torque of the class (edition not confirmed)")
    small = "k (1 − d/D) (P/D)^0.16 (n D)^0.17 D³ for diameters up to 1.8 H"
    large = "1.9 k (1 − d/D) (P/D)^0.16 (n D)^0.17 D^1.9 H^1.1 for diameters beyond 1.8 H"
    text = "; ".join(dict.fromkeys(large if ice.is_large else small for ice in motion.ice))
    yield Paragraph(
        f"Q_{{max}} = {text}; in kN m, with lengths in m and n in 1/s. Formula, factors, ice thickness and 2 "
        "revolutions "
        "per metre: edition not confirmed. Compare them with the edition in force.",
        "note",
    )


def _following(motion: TransientMotion) -> Iterator[Block]:
    """How torques that follow the motion were found, when their laws changed, and what resonances were passed."""
    if not motion.steps:
        return
    following = listed(dict.fromkeys(motion.following), most=MOST_NAMED)
    yield Paragraph(
        f"These torques depend on the speed or angle: {following}. The program computes them by "
        f"exponential collocation in {counted(motion.steps, 'step')}; the modes are exact in each step. The last series "
        f"term is at most {number(motion.left_in_series, 2)} of the largest torque and bounds the error. Periodic "
        "torques "
        "follow the angle of their component, starting at angle 0."
    )
    if motion.undamped:
        text = f"The load law replaces the damping of {listed(dict.fromkeys(motion.undamped), most=MOST_NAMED)}."
        yield Paragraph(text, "note")
    if motion.phases_computed:
        shown = ", ".join(f"{number(math.degrees(phase), 3)} deg" for phase in motion.slip_phase)
        text = (
            f"The phase of the slip pulsation is not stated. The program computed "
            f"{counted(motion.phases_computed, 'phase')}, including the worst for each torque. The curves show the "
            "worst "
            f"phase, {shown}. The maximum and minimum torques are over all phases."
        )
        yield Paragraph(text, "note", brief=True)
    if motion.passages:
        titles = (
            "mode: Mode | what: < Excited by | time: Time [s] | speed: Reference speed [rpm]"
            " | frequency: Frequency [Hz] | seconds: Passing time [s]:3 | share: Peak / steady resonance [%]:3"
        )
        text = (
            "Resonances passed: time in the half-power width, and peak for a constant acceleration"
        )
        yield table(titles, motion.passages, text, most=MOST_PASSAGES)
    if motion.changes:
        title = "Changes of regime of torques that depend on the motion"
        yield table("what: < Torque | time: At", motion.changes, title, most=MOST_PASSAGES)


def _switching(switching: Switching) -> Iterator[Block]:
    """What the nonlinear couplings did, and how far single values can be relied upon."""
    titles = (
        "coupling: < Coupling -> | contacts: Contacts -> | separations: Separations -> | slips: Slips ->"
        " | heat: Heat [J] ->"
    )
    title = "Couplings with backlash, friction, stages or a capacity"
    yield table(titles, switching.couplings, title)
    if switching.events:
        titles = "time: Time | coupling: < Coupling | what: < What"
        yield table(titles, switching.events, "Events of these couplings", most=MOST_EVENTS)
    if switching.sensitive_after is not None:
        text = (
            f"From {number(switching.sensitive_after)} s on the motion is sensitive: impacts amplify rounding, and "
            "half the "
            "step changes torques by more than 1e-6 of their peak. Peaks, counts and heat remain valid; single "
            "values do "
            "not. The maximum and minimum torques are over both motions. The checks add the difference."
        )
        yield Paragraph(text, "note")
    if switching.band_change:
        text = (
            "With twice the frequency range of the modes the torques change by "
            f"{number(switching.band_change, 2)} of the peak."
        )
        yield Paragraph(text, "note")


def _loads(motion: TransientMotion, settings: TransientSettings) -> Iterator[Block]:
    """Stresses of the shafts and damage, where there are any."""
    line = settings.fatigue
    if motion.damage is not None and line is not None:
        mean = "no mean torque effect"
        if line.ultimate is not None:
            mean = f"ultimate torque {number(line.ultimate)} N m"
        yield Paragraph(
            "Fatigue: cycles of every torque by rainflow (ASTM E1049), the residue as half cycles; damage after Miner, "
            f"amplitude {number(line.amplitude)} N m for {number(line.cycles)} cycles, slope {number(line.slope)}; "
            f"{mean}. A damage sum of 1 is the fatigue life."
        )
    loaded = [peak for peak in motion.elements if (peak.stress, peak.damage) != (None, None)]
    if loaded:
        yield table(
            "component: < Component | stress: Maximum shear stress [N/mm²]:? | damage: Damage per event:3?",
            loaded,
            "Maximum nominal stress and damage",
        )


def _figures(
    findings: Findings, motion: TransientMotion, settings: TransientSettings
) -> Iterator[Block]:
    """Torques of the elements and speeds of the points that the file names, else of the largest and of both ends."""
    train, mark = findings.study.train, f"motion {motion.name} ".replace("  ", " ")
    of_motion = f", {motion.name}" if motion.name else ""
    ranked = sorted(
        elements(findings.system), key=lambda element: -float(element.largest(motion.peak))
    )
    stations = [(k, s) for k, s in enumerate(train.stations) if not s.is_ground]
    if settings.plot:
        ranked = [element for element in ranked if train.parts[element.part].name in settings.plot]
        stations = [(k, s) for k, s in stations if train.parts[s.part].name in settings.plot]
    else:
        ranked, stations = ranked[:MOST_CURVES], stations[:: max(len(stations) - 1, 1)]
    unit = scale("N m", [highest(motion.peak)])
    for element in ranked:
        span_drawn = max(element.spans, key=motion.peak.__getitem__)
        time, torque = motion.time, motion.torque[span_drawn]
        # Between the samples its maximum and minimum, if they are of the motion that is drawn.
        if motion.faults_computed <= 1 and motion.phases_computed <= 1:
            ends = (motion.greatest_at, motion.greatest), (motion.least_at, motion.least)
            at, size = np.array(
                sorted((times[span_drawn], sizes[span_drawn]) for times, sizes in ends)
            ).T
            places = np.searchsorted(time, at, side="right")
            time, torque = np.insert(time, places, at), np.insert(torque, places, size)
        limits = [(words, limit * unit.factor) for words, limit in _limits(findings, element)]
        lines = [(element.name, torque * unit.factor)]
        axis, caption = Axis("torque", unit.unit), f"Torque in {element.name}{of_motion}"
        yield over_time(f"{mark}{element.name}", caption, time, lines, axis, limits, has_peak=True)
    if stations:
        speeds = [(station.name, motion.speed[k] * RPM) for k, station in stations]
        axis = Axis("speed", "rpm")
        yield over_time(f"{mark}speeds", f"Speed{of_motion}", motion.time, speeds, axis)


def _limits(findings: Findings, element: Element) -> list[tuple[str, float]]:
    """The limits of the greatest torque over time, N m: of the checks, else the rating of the manufacturer."""
    limits = {
        f"limit {symbols(check.clause)}": check.limit
        for check in findings.need(Checks).lines
        if check.where == element.name
        and check.rule in TRANSIENT_RULES
        and check.clause.startswith("T_")
        and np.isfinite(check.limit)
    }
    ratings = findings.study.train.parts[element.part].ratings
    if not limits and ratings is not None and ratings.max_torque:
        limits = {"T_{Kmax} (manufacturer)": ratings.max_torque}
    return list(limits.items())
