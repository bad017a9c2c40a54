"""Chapter: the motion over time."""

import math
from collections.abc import Iterable, Iterator

import numpy as np

from torsion.analyses.transient.acting_torques import ActingTorques
from torsion.analyses.transient.compared_methods import ComparedMethod
from torsion.analyses.transient.event_driven_curves import Switching
from torsion.analyses.transient.milling_ice import Ice
from torsion.analyses.transient.short_circuit import ShortCircuit
from torsion.analyses.transient.transient_motion import TransientMotion, Transients
from torsion.analyses.transient.transient_settings import TransientSettings, cases
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, Table, table
from torsion.output.chapters.motion_orders import orders
from torsion.output.figures.curves_over_time import over_time
from torsion.output.numbers import NONE, RPM, Scale, counted, number, rpm, scale
from torsion.output.reported_values import NOTHING
from torsion.output.selection import Element, elements
from torsion.results import listed

MOST_CURVES = 5  # in the figures: of the elements with the largest torque
MOST_PASSAGES = 20  # lines of a table
MOST_ORDERS = 4  # named of those that excite it
METHOD = (
    "Exact at every sample: every mode answers the events in closed form, and the torque of a span is the sum over the "
    "modes. Losses of material act as modal damping, by their share of the energy."
)
FROM_EVENT_TO_EVENT = (
    "Exact from event to event: between two changes of a coupling's regime the train is linear, and the time of each "
    "is the root of the exact motion. Losses of material act as modal damping, by their share of the energy."
)
MOST_EVENTS = 20  # of the changes of regime that are listed
DRIVEN = METHOD.replace("answers the events", "answers the torques of every step")
Peaks = tuple[Element, int, int]  # an element and its spans of the greatest and the least torque


def chapter(findings: Findings) -> Iterator[Block]:
    """Every motion in a section of its own; nothing where none was requested."""
    found = findings.get(Transients)
    if found is None:
        return
    yield Heading("Motion over time")
    settings = {one.name: one for one, _ in cases(findings.study)}
    for one in found.each:
        if len(found.each) > 1:
            yield Heading(f"Motion: {one.name}", 2)
        yield from _motion(findings, one, settings[one.name])


def _first(names: Iterable[str]) -> str:
    """The first few, each once."""
    return listed(dict.fromkeys(names), most=4)


def _motion(findings: Findings, found: TransientMotion, settings: TransientSettings) -> Iterator[Block]:
    spans = [(one, np.array(list(one.spans))) for one in elements(findings.system)]
    rows = [(one, int(k[found.greatest[k].argmax()]), int(k[found.least[k].argmin()])) for one, k in spans]
    unit = scale("N m", [value for _, high, low in rows for value in (found.greatest[high], found.least[low])])
    yield Paragraph(_introduction(found, settings))
    yield Paragraph(ActingTorques(found.acting, found.not_acting).words, brief=True)
    yield from _faults(found, settings)
    yield from _steady_begin(findings, found, settings)
    if found.status != "ok":
        yield Paragraph(f"Not to be relied upon: {found.status}.", "fail", brief=True)
    events = [(event.at, event.body.key, event.time, event.words) for event in settings.events]
    if events:
        yield table("< At | < Event | Begins at [s] | < Settings", events, "Events; torques at the point's own speed")
    yield from _ice(found, settings)
    yield _peaks(found, rows, unit)
    if found.switching is not None:
        yield from _switching(found.switching)
    yield from _following(found)
    yield from _compared(found.compared)
    yield from _loads(findings, found, rows, settings)
    if found.unresolved.any():
        text = (
            "Modes too fast for the times at which peaks are looked for add at most what the last column says; "
            "verdicts add it to the peak. More `samples` resolve them."
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
    load = "stays or falls as the file states" if is_both else "acts on" if "stays" in loads else "is gone"
    text = f"The mean torque of the machine {load} during a short circuit (`load`)."
    if found.faults_computed:
        text = (
            f"{found.faults_computed} faults were computed; the worst: {found.worst_fault}. Its curves are shown; "
            f"greatest and least torques are those of all. {text}"
        )
    yield Paragraph(text, "note", brief=True)


def _steady_begin(findings: Findings, found: TransientMotion, settings: TransientSettings) -> Iterator[Block]:
    """How a motion begins that is steady before its events; briefly, where the file says neither that nor a speed."""
    if not found.speed_before or settings.initial not in (None, "steady"):
        return
    if findings.study.excites and settings.torques != ():
        text = "The motion begins with the steady vibration that periodic torques and joints make at this speed."
        begun = (
            "Beside play, friction, stages and clutches periodic torques begin at time 0, upon the mean torques alone; "
            "the first revolutions are a transient of their own."
        )
        yield Paragraph(text if found.switching is None else begun, "note")
    if settings.initial is None and findings.study.operation.rated is None:
        orders = [f"order {one.order} at {one.name}" for one in findings.study.train.torques if one.order is not None]
        excited = f", excited by {', '.join(dict.fromkeys(orders[:MOST_ORDERS]))}" if orders else ""
        more = ", ..." if len(orders) > MOST_ORDERS else ""
        text = (
            f"The file names no `initial` and no rated speed: the motion begins steady at {rpm(found.speed_before)} "
            f"rpm, the highest of its speeds{excited}{more}. `initial: rest` or `{{speed: ...}}` begins elsewhere."
        )
        yield Paragraph(text, "note", brief=True)


def _introduction(found: TransientMotion, settings: TransientSettings) -> str:
    before = f"at {rpm(found.speed_before)} rpm" if found.speed_before else "at rest"
    kept = (
        "" if found.change is None else f"Twice as many modes change no peak by more than {number(found.change, 2)}. "
    )
    return (
        f"{number(settings.duration)} s from a train {before}, in {counted(len(found.time), 'sample')}, of "
        f"{counted(found.modes, 'elastic mode')}. {_method(found)} {kept}The balance of energy holds to "
        f"{number(found.residual, 2)} of the largest energy."
    )


def _method(found: TransientMotion) -> str:
    if found.switching is not None:
        return FROM_EVENT_TO_EVENT
    return DRIVEN if found.steps else METHOD


def _ice(found: TransientMotion, settings: TransientSettings) -> Iterator[Block]:
    """How the greatest torque of a class of ice was found, and what of the ice is to be verified."""
    if any(isinstance(event.body, Ice) and event.body.case for event in settings.events):
        text = (
            "Factor, angle and blocks of the cases of ice were not compared with the printed rules: to be verified "
            "against the edition in force."
        )
        yield Paragraph(text, "note")
    if not found.ice:
        return
    rows = [
        (one.at, one.ice_class, number(one.thickness), "duct" if one.is_ducted else "open", number(one.factor),
         number(one.diameter), number(one.hub_ratio), number(one.pitch_ratio), number(one.speed / (2.0 * np.pi)),
         number(one.revolutions), number(one.torque * 1e-3))
        for one in found.ice
    ]  # fmt: skip
    titles = (
        "< Propeller | < Class | H [m] | < Propeller is | k | D [m] | d/D | P/D | n [1/s] | Revolutions "
        "| Q_{max} [kN m]"
    )
    yield table(titles, rows, "Greatest ice torque of the class, to be verified against the edition in force")
    small = "k (1 − d/D) (P/D)^0.16 (n D)^0.17 D³"
    large = "1.9 k (1 − d/D) (P/D)^0.16 (n D)^0.17 D^1.9 H^1.1"
    used = {large if one.is_large else small: ("beyond" if one.is_large else "up to") for one in found.ice}
    text = "; ".join(f"{formula} for diameters {ends} 1.8 H" for formula, ends in used.items())
    yield Paragraph(
        f"Q_{{max}} = {text}; in kN m, with lengths in m and n in 1/s. Formula, factors, thickness of the ice and its "
        "2 revolutions a metre were not compared with the printed rules: to be verified against the edition in force.",
        "note",
    )


def _following(found: TransientMotion) -> Iterator[Block]:
    """How torques that follow the motion were found, when their laws changed, and what resonances were passed."""
    if not found.steps:
        return
    yield Paragraph(
        f"These torques follow the speed or the angle of their point: {_first(found.following)}. They are found by "
        f"exponential collocation in {counted(found.steps, 'step')}, between which the modes are exact. The last term "
        f"kept of their series is at most {number(found.left_in_series, 2)} of the largest of them; the error is "
        "smaller. Periodic torques of the file follow the angle of their point too, from its angle 0 on."
    )
    if found.undamped:
        text = f"The damping of {_first(found.undamped)} is left out: the law of the load there damps in its place."
        yield Paragraph(text, "note")
    if found.phases_computed:
        shown = ", ".join(f"{number(math.degrees(one), 3)} deg" for one in found.slip_phase)
        text = (
            f"The file leaves the phase of the slip pulsation open: of {counted(found.phases_computed, 'phase')} that "
            f"were computed, among them those at which it adds most to each torque, {shown} is the worst, and its "
            "curves are shown; greatest and least torques are those of all."
        )
        yield Paragraph(text, "note", brief=True)
    if found.passages:
        cells = [
            (one.mode, one.what, one.time, rpm(one.speed), number(one.frequency), number(one.seconds, 3),
             number(100.0 * one.share, 3))
            for one in found.passages[:MOST_PASSAGES]
        ]  # fmt: skip
        titles = (
            "Mode | < Excited by | Met at [s] | Reference speed [rpm] | Frequency [Hz] | Passed in [s] "
            "| Reached, of the steady resonance [%]"
        )
        more = len(found.passages) - MOST_PASSAGES
        text = "Resonances passed: time within the range of half the power, and what a constant rate lets them reach"
        yield table(titles, cells, text + (f"; {more} more are in results.json" if more > 0 else ""))
    if found.changes:
        changed = [(_first(one.what.split(", ")), one.time) for one in found.changes[:MOST_PASSAGES]]
        yield table(
            "< Torque | At [s]", changed, "When a torque that follows the motion came to another part of its law"
        )


def _peaks(found: TransientMotion, rows: list[Peaks], unit: Scale) -> Table:
    titles = (
        f"< Element -> | Greatest torque [{unit.unit}] -> greatest, {unit.unit} | at [s] -> at, s "
        f"| Least torque [{unit.unit}] -> least, {unit.unit} | at [s] | Before [{unit.unit}] "
        f"| Largest / before -> times | Largest / rated | Reversals -> | Not sampled [{unit.unit}]"
    )
    largest = max((float(found.peak[list(one.spans)].max()) * one.ratio for one, _, _ in rows), default=0.0)
    cells = []
    for element, high, low in rows:
        spans, first = np.array(list(element.spans)), element.spans[0]
        every = (found.greatest[high], found.least[low], found.before[first], found.unresolved[spans].max())
        greatest, least, before, lacking = (
            _known(float(one) * element.ratio, largest) / element.ratio for one in every
        )
        most, rated = max(abs(greatest), abs(least)), 0.0 if found.rated is None else float(found.rated[first])
        times = [number(most / abs(mean), 3) if mean else NONE for mean in (before, rated)]
        cells.append((
            element.name, unit.text(greatest), float(found.greatest_at[high]), unit.text(least),
            float(found.least_at[low]), unit.text(before), *times, int(found.reversals[spans].max()),
            unit.text(lacking),
        ))  # fmt: skip
    text = "Torques of the motion, mean torque included; where the torque of a gear reverses its teeth separate"
    title = f"Motion over time: {found.name}" if found.name else "Motion over time"
    return table(titles, cells, text, short=title, rows_in_summary=3)


def _known(torque: float, largest: float) -> float:
    """A torque, or 0 where it is less than what is rounding beside the largest of the train at its speed, N m."""
    return 0.0 if abs(torque) < NOTHING * largest else torque


def _switching(found: Switching) -> Iterator[Block]:
    """What the nonlinear couplings did, and how far single values can be relied upon."""
    rows = [(one.coupling, one.contacts, one.separations, one.slips, number(one.heat)) for one in found.couplings]
    titles = "< Coupling -> | Contacts -> | Separations -> | Slips -> | Heat [J] ->"
    yield table(titles, rows, "Couplings with play, friction, stages or a capacity")
    if found.events:
        first = [(one.time, one.coupling, one.what) for one in found.events[:MOST_EVENTS]]
        title = f"The first {len(first)} of {len(found.events)} events" if len(found.events) > len(first) else "Events"
        yield table("Time [s] | < Coupling -> | < What", first, f"{title} of these couplings")
    if found.sensitive_after is not None:
        text = (
            f"From {number(found.sensitive_after)} s on the motion is sensitive: impacts amplify rounding until halved "
            "steps change torques by more than 1e-6 of their peak. Read peaks, counts and heat there, not the moment. "
            "Greatest and least torques are those of both motions, and verdicts add their difference."
        )
        yield Paragraph(text, "note")
    if found.band_change:
        text = f"Twice the band of modes changes torques by {number(found.band_change, 2)} of their peaks."
        yield Paragraph(text, "note")


def _compared(found: ComparedMethod | None) -> Iterator[Block]:
    """The method of integration that the file names, beside the exact motion."""
    if found is None:
        return
    step = "" if found.step is None else f" with steps of {number(found.step)} s"
    error = (
        "has no answer: it is not stable there"
        if found.error is None
        else f"differs by {number(100.0 * found.error, 3)} % of the largest torque of a span, at most"
    )
    text = f"Compared: {found.method}{step} {error}; it takes {number(found.seconds, 2)} s. All results are exact."
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
        yield table("< Shaft | Largest shear stress [N/mm²]", cells, "Nominal stress of the shafts at their peaks")
    line = settings.fatigue
    if found.damage is not None and line is not None:
        worst = [(one.name, float(found.damage[list(one.spans)].max())) for one, _, _ in rows]
        mean = "mean torques are left out" if line.ultimate is None else f"ultimate torque {number(line.ultimate)} N m"
        yield Paragraph(
            "Fatigue: cycles of every torque by rainflow (ASTM E1049), the residue as half cycles; damage after Miner, "
            f"amplitude {number(line.amplitude)} N m borne {number(line.cycles)} times, slope {number(line.slope)}; "
            f"{mean}."
        )
        cells = [(name, number(sum_, 3)) for name, sum_ in worst if np.isfinite(sum_)]
        yield table("< Element | Damage of one such motion", cells, "Miner's sums; at 1 the life is used up")


def _figures(findings: Findings, found: TransientMotion, settings: TransientSettings, unit: Scale) -> Iterator[Block]:
    every = sorted(elements(findings.system), key=lambda one: -float(found.peak[list(one.spans)].max()))
    train, plot, mark = findings.study.train, settings.plot, f"{found.name} ".lstrip()
    drawn = [one for one in every if train.parts[one.part].name in plot] if plot else every[:MOST_CURVES]
    for one in drawn:
        span = max(one.spans, key=lambda span: found.peak[span])
        time, torque = _with_peaks(found, span)
        curves = [(one.name, torque * unit.factor)]
        caption = f"Torque in {one.name} over time" + (f", {found.name}" if found.name else "")
        yield over_time(f"motion {mark}{one.name}", caption, time=time, lines=curves, quantity="torque", unit=unit.unit)
    stations = [(k, s.name) for k, s in enumerate(train.stations) if not s.is_ground]
    ends = [stations[0], stations[-1]] if len(stations) > 1 else stations
    ends = [one for one in stations if train.parts[train.stations[one[0]].part].name in plot] if plot else ends
    if ends:
        curves = [(name, found.speed[k] * RPM) for k, name in ends]
        caption = "Speed over time" + (f", {found.name}" if found.name else "")
        yield over_time(
            f"motion {mark}speeds", caption, time=found.time, lines=curves, quantity="own speed", unit="rpm"
        )


def _with_peaks(found: TransientMotion, span: int) -> tuple[np.ndarray, np.ndarray]:
    """The samples of a torque, and between them its greatest and least value."""
    at, value = [found.greatest_at[span], found.least_at[span]], [found.greatest[span], found.least[span]]
    place = np.searchsorted(found.time, at, side="right")
    order = np.argsort(at, kind="stable")
    chosen = place[order], np.array(at)[order], np.array(value)[order]
    return np.insert(found.time, chosen[0], chosen[1]), np.insert(found.torque[span], chosen[0], chosen[2])
