"""Chapter: transient responses."""

import math
from collections.abc import Iterable, Iterator

import numpy as np

from torsion.analyses.motion.acting_torques import ActingTorques
from torsion.analyses.motion.event_driven_curves import Switching
from torsion.analyses.motion.milling_ice import Ice
from torsion.analyses.motion.short_circuit import ShortCircuit
from torsion.analyses.motion.transient_motion import TransientMotion, Transients
from torsion.analyses.motion.transient_settings import TransientSettings, cases
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, Table, table
from torsion.output.chapters.motion_orders import orders
from torsion.output.figures.curves_over_time import over_time
from torsion.output.numbers import NONE, RPM, Scale, counted, number, rpm, scale, symbols
from torsion.output.reported_values import NOTHING
from torsion.output.selection import Element, elements
from torsion.results import listed
from torsion.rules.verdict_line import Checks

MOST_CURVES = 5  # in the figures: of the elements with the largest torque
MOST_PASSAGES = 20  # lines of a table
MOST_ORDERS = 4  # named of those that excite it
METHOD = (
    "Exact at every sample: every mode has a closed-form response to the events, and a torque is the sum over"
    " the modes. Material damping acts as modal damping by energy share."
)
FROM_EVENT_TO_EVENT = (
    "Exact from event to event: the train is linear between two changes of a coupling's regime, and each change is a "
    "root of the exact motion. Material damping acts as modal damping by energy share."
)
MOST_EVENTS = 20  # of the changes of regime that are listed
DRIVEN = METHOD.replace("to the events", "to the torques of every step")
TRANSIENT_RULES = ("transient", "ice")  # rules that limit the greatest torque over time
Peaks = tuple[Element, int, int]  # an element and its spans of the greatest and the least torque


def chapter(findings: Findings) -> Iterator[Block]:
    """One section for each transient; nothing if none was requested."""
    found = findings.get(Transients)
    if found is None:
        return
    yield Heading("Transient response")
    settings = {one.name: one for one, _ in cases(findings.study)}
    for one in found.each:
        if len(found.each) > 1:
            yield Heading(f"Transient: {one.name}", 2)
        yield from _motion(findings, one, settings[one.name])


def _first(names: Iterable[str]) -> str:
    """The first few, each once."""
    return listed(dict.fromkeys(names), most=4)


def _motion(
    findings: Findings, found: TransientMotion, settings: TransientSettings
) -> Iterator[Block]:
    spans = [(one, np.array(list(one.spans))) for one in elements(findings.system)]
    rows = [
        (one, int(k[found.greatest[k].argmax()]), int(k[found.least[k].argmin()]))
        for one, k in spans
    ]
    unit = scale(
        "N m",
        [value for _, high, low in rows for value in (found.greatest[high], found.least[low])],
    )
    yield Paragraph(_introduction(found, settings))
    yield Paragraph(ActingTorques(found.acting, found.not_acting).words, brief=True)
    yield from _faults(found, settings)
    yield from _steady_begin(findings, found, settings)
    if found.status != "ok":
        yield Paragraph(f"Not reliable: {found.status}.", "fail", brief=True)
    events = [(event.at, event.body.key, event.time, event.words) for event in settings.events]
    if events:
        yield table(
            "< Component | < Event | Start [s] | < Settings",
            events,
            "Events; torques at the speed of the component",
        )
    yield from _ice(found, settings)
    yield _peaks(found, rows, unit)
    if found.switching is not None:
        yield from _switching(found.switching)
    yield from _following(found)
    yield from _loads(findings, found, rows, settings)
    if found.unresolved.any():
        text = (
            "The last column bounds the torque of modes that the samples do not resolve. The checks add it to the "
            "peak. To resolve these modes, increase `samples`."
        )
        yield Paragraph(text, "note")
    yield from _figures(findings, found, settings, unit)
    yield from orders(found.orders, found.name)


def _faults(found: TransientMotion, settings: TransientSettings) -> Iterator[Block]:
    """Which short circuits were computed, which is the worst, and what becomes of the mean torque meanwhile."""
    loads = {event.body.load for event in settings.events if isinstance(event.body, ShortCircuit)}
    if not loads:
        return
    is_both = loads == {"stays", "falls"}
    load = (
        "stays or falls as stated" if is_both else "stays" if "stays" in loads else "falls to zero"
    )
    text = f"The mean torque of the machine {load} during a short circuit (`load`)."
    if found.faults_computed:
        text = (
            f"The program computed {found.faults_computed} electrical faults. The curves show the worst: "
            f"{found.worst_fault}. The maximum and minimum torques are over all faults. {text}"
        )
    yield Paragraph(text, "note", brief=True)


def _steady_begin(
    findings: Findings, found: TransientMotion, settings: TransientSettings
) -> Iterator[Block]:
    """How a motion begins that is steady before its events; briefly, where the file says neither that nor a speed."""
    if not found.speed_before or settings.initial not in (None, "steady"):
        return
    if findings.study.excites and settings.torques != ():
        text = "The motion starts with the steady vibration at this speed."
        begun = (
            "The train has backlash, friction, stiffness stages or clutches. Therefore the periodic torques start at "
            "time 0 with the mean torques only, and the first revolutions show their start."
        )
        yield Paragraph(text if found.switching is None else begun, "note")
    if settings.initial is None and findings.study.operation.rated is None:
        orders = [
            f"order {one.order} at {one.name}"
            for one in findings.study.train.torques
            if one.order is not None
        ]
        excited = f", excited by {', '.join(dict.fromkeys(orders[:MOST_ORDERS]))}" if orders else ""
        more = ", ..." if len(orders) > MOST_ORDERS else ""
        text = (
            f"The file has no `initial` and no rated speed. The motion starts steady at the highest speed, "
            f"{rpm(found.speed_before)} rpm{excited}{more}. To start elsewhere, set `initial: rest` or "
            f"`{{speed: ...}}`."
        )
        yield Paragraph(text, "note", brief=True)


def _introduction(found: TransientMotion, settings: TransientSettings) -> str:
    before = f"at {rpm(found.speed_before)} rpm" if found.speed_before else "at rest"
    kept = (
        ""
        if found.change is None
        else f"With twice as many modes no peak changes by more than {number(found.change, 2)}. "
    )
    return (
        f"{number(settings.duration)} s from a train {before}, in {counted(len(found.time), 'sample')}, of "
        f"{counted(found.modes, 'elastic mode')}. {_method(found)} {kept}Energy balance error: "
        f"{number(found.residual, 2)} of the maximum energy."
    )


def _method(found: TransientMotion) -> str:
    if found.switching is not None:
        return FROM_EVENT_TO_EVENT
    return DRIVEN if found.steps else METHOD


def _ice(found: TransientMotion, settings: TransientSettings) -> Iterator[Block]:
    """How the greatest torque of a class of ice was found, and what of the ice is to be verified."""
    if any(isinstance(event.body, Ice) and event.body.case for event in settings.events):
        text = (
            "Factor, angle and milling sequence of the ice cases: edition not confirmed. Compare them with the edition "
            "in force."
        )
        yield Paragraph(text, "note")
    if not found.ice:
        return
    rows = [
        (
            one.at,
            one.ice_class,
            number(one.thickness),
            "duct" if one.is_ducted else "open",
            number(one.factor),
            number(one.diameter),
            number(one.hub_ratio),
            number(one.pitch_ratio),
            number(one.speed / (2.0 * np.pi)),
            number(one.revolutions),
            number(one.torque * 1e-3),
        )
        for one in found.ice
    ]
    titles = "< Propeller | < Class | H [m] | < Type | k | D [m] | d/D | P/D | n [1/s] | Revolutions | Q_{max} [kN m]"
    yield table(titles, rows, "Maximum ice torque of the class (edition not confirmed)")
    small = "k (1 − d/D) (P/D)^0.16 (n D)^0.17 D³"
    large = "1.9 k (1 − d/D) (P/D)^0.16 (n D)^0.17 D^1.9 H^1.1"
    used = {
        large if one.is_large else small: ("beyond" if one.is_large else "up to")
        for one in found.ice
    }
    text = "; ".join(f"{formula} for diameters {ends} 1.8 H" for formula, ends in used.items())
    yield Paragraph(
        f"Q_{{max}} = {text}; in kN m, with lengths in m and n in 1/s. Formula, factors, ice thickness and 2 "
        "revolutions "
        "per metre: edition not confirmed. Compare them with the edition in force.",
        "note",
    )


def _following(found: TransientMotion) -> Iterator[Block]:
    """How torques that follow the motion were found, when their laws changed, and what resonances were passed."""
    if not found.steps:
        return
    yield Paragraph(
        f"These torques depend on the speed or angle: {_first(found.following)}. The program computes them by "
        f"exponential collocation in {counted(found.steps, 'step')}; the modes are exact in each step. The last series "
        f"term is at most {number(found.left_in_series, 2)} of the largest torque and bounds the error. Periodic "
        "torques "
        "follow the angle of their component, starting at angle 0."
    )
    if found.undamped:
        text = f"The load law replaces the damping of {_first(found.undamped)}."
        yield Paragraph(text, "note")
    if found.phases_computed:
        shown = ", ".join(f"{number(math.degrees(one), 3)} deg" for one in found.slip_phase)
        text = (
            f"The phase of the slip pulsation is not stated. The program computed "
            f"{counted(found.phases_computed, 'phase')}, including the worst for each torque. The curves show the "
            "worst "
            f"phase, {shown}. The maximum and minimum torques are over all phases."
        )
        yield Paragraph(text, "note", brief=True)
    if found.passages:
        cells = [
            (
                one.mode,
                one.what,
                one.time,
                rpm(one.speed),
                number(one.frequency),
                number(one.seconds, 3),
                number(100.0 * one.share, 3),
            )
            for one in found.passages[:MOST_PASSAGES]
        ]
        titles = (
            "Mode | < Excited by | Time [s] | Reference speed [rpm] | Frequency [Hz] | Passing time [s] "
            "| Peak / steady resonance [%]"
        )
        more = len(found.passages) - MOST_PASSAGES
        text = (
            "Resonances passed: time in the half-power width, and peak for a constant acceleration"
        )
        yield table(titles, cells, text + (f"; {more} more in results.json" if more > 0 else ""))
    if found.changes:
        changed = [
            (_first(one.what.split(", ")), one.time) for one in found.changes[:MOST_PASSAGES]
        ]
        yield table(
            "< Torque | At [s]", changed, "Changes of regime of torques that depend on the motion"
        )


def _peaks(found: TransientMotion, rows: list[Peaks], unit: Scale) -> Table:
    titles = (
        f"< Component -> | Maximum torque [{unit.unit}] -> maximum, {unit.unit} | Time [s] -> at, s "
        f"| Minimum torque [{unit.unit}] -> minimum, {unit.unit} | Time [s] | Initial [{unit.unit}] "
        f"| Peak / initial -> times | Peak / rated | Reversals -> | Not sampled [{unit.unit}]"
    )
    largest = max(
        (float(found.peak[list(one.spans)].max()) * one.ratio for one, _, _ in rows), default=0.0
    )
    cells = []
    for element, high, low in rows:
        spans, first = np.array(list(element.spans)), element.spans[0]
        every = (
            found.greatest[high],
            found.least[low],
            found.before[first],
            found.unresolved[spans].max(),
        )
        greatest, least, before, lacking = (
            _known(float(one) * element.ratio, largest) / element.ratio for one in every
        )
        most, rated = (
            max(abs(greatest), abs(least)),
            0.0 if found.rated is None else float(found.rated[first]),
        )
        times = [number(most / abs(mean), 3) if mean else NONE for mean in (before, rated)]
        cells.append(
            (
                element.name,
                unit.text(greatest),
                float(found.greatest_at[high]),
                unit.text(least),
                float(found.least_at[low]),
                unit.text(before),
                *times,
                int(found.reversals[spans].max()),
                unit.text(lacking),
            )
        )
    text = "Torques over time including the mean torque; a torque reversal in a gear separates its teeth"
    title = f"Transient: {found.name}" if found.name else "Transient response"
    return table(titles, cells, text, short=title, rows_in_summary=3)


def _known(torque: float, largest: float) -> float:
    """A torque, or 0 where it is less than what is rounding beside the largest of the train at its speed, N m."""
    return 0.0 if abs(torque) < NOTHING * largest else torque


def _switching(found: Switching) -> Iterator[Block]:
    """What the nonlinear couplings did, and how far single values can be relied upon."""
    rows = [
        (one.coupling, one.contacts, one.separations, one.slips, number(one.heat))
        for one in found.couplings
    ]
    titles = "< Coupling -> | Contacts -> | Separations -> | Slips -> | Heat [J] ->"
    yield table(titles, rows, "Couplings with backlash, friction, stages or a capacity")
    if found.events:
        first = [(one.time, one.coupling, one.what) for one in found.events[:MOST_EVENTS]]
        title = (
            f"The first {len(first)} of {len(found.events)} events"
            if len(found.events) > len(first)
            else "Events"
        )
        yield table("Time [s] | < Coupling -> | < What", first, f"{title} of these couplings")
    if found.sensitive_after is not None:
        text = (
            f"From {number(found.sensitive_after)} s on the motion is sensitive: impacts amplify rounding, and "
            "half the "
            "step changes torques by more than 1e-6 of their peak. Peaks, counts and heat remain valid; single "
            "values do "
            "not. The maximum and minimum torques are over both motions. The checks add the difference."
        )
        yield Paragraph(text, "note")
    if found.band_change:
        text = (
            "With twice the frequency range of the modes the torques change by "
            f"{number(found.band_change, 2)} of the peak."
        )
        yield Paragraph(text, "note")


def _loads(
    findings: Findings, found: TransientMotion, rows: list[Peaks], settings: TransientSettings
) -> Iterator[Block]:
    """Stresses of the shafts and damage, where there are any."""
    if found.stress is not None:
        cells = []
        for element, _, _ in rows:
            most = float(found.stress[list(element.spans)].max())
            if np.isfinite(most):
                cells.append((element.name, number(most * 1e-6)))
        yield table(
            "< Shaft | Maximum shear stress [N/mm²]", cells, "Maximum nominal stress of the shafts"
        )
    line = settings.fatigue
    if found.damage is not None and line is not None:
        worst = [(one.name, float(found.damage[list(one.spans)].max())) for one, _, _ in rows]
        mean = (
            "no mean torque effect"
            if line.ultimate is None
            else f"ultimate torque {number(line.ultimate)} N m"
        )
        yield Paragraph(
            "Fatigue: cycles of every torque by rainflow (ASTM E1049), the residue as half cycles; damage after Miner, "
            f"amplitude {number(line.amplitude)} N m for {number(line.cycles)} cycles, slope {number(line.slope)}; "
            f"{mean}."
        )
        cells = [(name, number(sum_, 3)) for name, sum_ in worst if np.isfinite(sum_)]
        yield table(
            "< Component | Damage per event", cells, "Miner damage sum; 1 is the fatigue life"
        )


def _figures(
    findings: Findings, found: TransientMotion, settings: TransientSettings, unit: Scale
) -> Iterator[Block]:
    every = sorted(
        elements(findings.system), key=lambda one: -float(found.peak[list(one.spans)].max())
    )
    train, plot, mark = findings.study.train, settings.plot, f"{found.name} ".lstrip()
    drawn = (
        [one for one in every if train.parts[one.part].name in plot]
        if plot
        else every[:MOST_CURVES]
    )
    for one in drawn:
        span = max(one.spans, key=lambda span: found.peak[span])
        time, torque = _with_peaks(found, span)
        curves = [(one.name, torque * unit.factor)]
        caption = f"Torque in {one.name}" + (f", {found.name}" if found.name else "")
        yield over_time(
            f"motion {mark}{one.name}",
            caption,
            time=time,
            lines=curves,
            quantity="torque",
            unit=unit.unit,
            limits=[(words, limit * unit.factor) for words, limit in _limits(findings, one)],
            has_peak=True,
        )
    stations = [(k, s.name) for k, s in enumerate(train.stations) if not s.is_ground]
    ends = [stations[0], stations[-1]] if len(stations) > 1 else stations
    ends = (
        [one for one in stations if train.parts[train.stations[one[0]].part].name in plot]
        if plot
        else ends
    )
    if ends:
        curves = [(name, found.speed[k] * RPM) for k, name in ends]
        caption = "Speed" + (f", {found.name}" if found.name else "")
        yield over_time(
            f"motion {mark}speeds",
            caption,
            time=found.time,
            lines=curves,
            quantity="speed",
            unit="rpm",
        )


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


def _with_peaks(found: TransientMotion, span: int) -> tuple[np.ndarray, np.ndarray]:
    """The samples of a torque, and between them its maximum and minimum, if they are of the motion that is drawn."""
    if found.faults_computed > 1 or found.phases_computed > 1:
        return found.time, found.torque[span]
    at, value = (
        [found.greatest_at[span], found.least_at[span]],
        [found.greatest[span], found.least[span]],
    )
    place = np.searchsorted(found.time, at, side="right")
    order = np.argsort(at, kind="stable")
    chosen = place[order], np.array(at)[order], np.array(value)[order]
    return np.insert(found.time, chosen[0], chosen[1]), np.insert(
        found.torque[span], chosen[0], chosen[2]
    )
