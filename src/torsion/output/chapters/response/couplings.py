"""Chapters: couplings and dampers whose stiffness follows a table or law, and what follows over the speed."""

import math
from collections.abc import Iterator

import numpy as np

from torsion.analyses.modes.coupling_tables import CouplingTables
from torsion.analyses.modes.damper_optimum import Dampers
from torsion.analyses.modes.frequencies_by_torque import FrequenciesOverSpeed
from torsion.analyses.motion.derived.nonlinear_peaks import NonlinearPeaks
from torsion.analyses.response.coupling_temperatures import CouplingTemperatures
from torsion.analyses.response.pendulums import Pendulums
from torsion.analyses.response.vibratory_couplings import VibratoryTorques
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, table
from torsion.output.figures.curves import SPEED
from torsion.output.figures.figure import Axis, Figure, Level, Line, Marks, Panel
from torsion.output.numbers import RPM, number, rpm, scale
from torsion.output.records import Place, along

LINEAR = "Stiffness k and loss factor η are interpolated linearly between the points of a table."
BEYOND = {True: "constant outside the table", False: "not computed outside the table"}
BY_FREQUENCY = (
    "Every harmonic component has k and η at its frequency. Every mode has k at its natural frequency and its"
    " own Holzer table. These modes are not orthogonal. On every interval of a table d ln k/d ln ω is at most"
    " {}. Below 2 every mode has exactly one frequency, which Sturm counts prove."
)
BY_TORQUE = (
    "A table over mean torque gives the tangent stiffness. Every speed has k at its mean torque. Modes have k"
    " at {} rpm."
)
BY_VIBRATION = (
    "A table over vibratory torque gives k and η at the total torque amplitude of each speed. Modes have the "
    "first stiffness of the table (small vibration)."
)
LOSS = (
    "The modal loss factor is the sum of elastic energy share times loss factor over all components. The "
    "damping ratio is about half of it."
)
NO_COMPLEX = " A table gives k and η only at real frequencies. Complex modes are not computed."
LAW = (
    "A viscoelastic law holds at every complex s. Harmonic components use K(iω) = k (1 + iη), modes use k(ω),"
    " and damped modes use K(s) with one state for each relaxing term. The points below are samples of the "
    "law. In N m/rad:"
)
AXES = {
    "frequency": Axis("frequency", "Hz"),
    "mean torque": Axis("mean torque of the coupling", "N m"),
    "vibratory torque": Axis("vibratory torque of the coupling", "N m"),
}
ROOM = 0.015  # of the range of a table, free beyond its ends for the symbols
MOST_SPEEDS, MOST_MODES = 13, 8  # of the table of frequencies
OVER_SPEED = (
    "Every coupling with a table over mean torque has the tangent stiffness at the mean torque of each speed."
    " The natural frequencies therefore depend on the speed, and an order can have no, one or several "
    "critical speeds. The program searches the speed range."
)
OF_PENDULUMS = (
    "The restoring force of a pendulum grows with the square of the speed. The natural frequencies therefore "
    "depend on the speed. The program searches the speed range for critical speeds."
)
WARMING = (
    "A coupling softens with temperature, and its power loss depends on its stiffness. At thermal equilibrium"
    " the coupling loses as much heat as it generates. The table lists all equilibria up to the permissible "
    "temperature. A run-up reaches the lowest; a coast-down can stay at the highest. Without a stable "
    "equilibrium above the last unstable one, the coupling overheats. Each coupling is computed with the "
    "others cold. All other results are for cold couplings."
)
VIBRATING = (
    "At every speed the stiffness and the loss factor follow from the total torque amplitude T, which depends"
    " on them. The program finds all solutions T of every interval of the table. The report shows the largest"
    " solution, and every check uses the worst. The residual compares T with the amplitude of the whole train"
    " at this stiffness. If it stays above 10⁻⁹ or T does not converge, no check passes at this speed."
)
MOST_VIBRATING = 9  # speeds evenly through the range, besides those that matter


def input_and_modes(findings: Findings) -> Iterator[Block]:
    """Yield tables and laws as given, their curves, and their values at the modes."""
    result = findings.need(CouplingTables)
    yield Heading("Couplings and dampers with tables or laws")

    tables = result.tables
    linear = [f"{law.coupling}: {BEYOND[law.holds]}" for law in tables if law.law is None]
    if linear:
        yield Paragraph(f"{LINEAR} {'; '.join(linear)}.")
    for law in (law for law in tables if law.law is not None and not law.is_complex):
        yield Paragraph(f"{law.coupling}: {law.law}.")
    if laws := [f"{law.coupling}: {law.law}" for law in tables if law.is_complex]:
        yield Paragraph(f"{LAW} {'; '.join(laws)}.")
    if steepest := [law.steepest for law in tables if law.over == "frequency"]:
        yield Paragraph(BY_FREQUENCY.format(number(max(steepest), 3)))
    if result.speed is not None:
        yield Paragraph(BY_TORQUE.format(rpm(result.speed)))
    if any(law.over == "vibratory torque" for law in tables):
        yield Paragraph(BY_VIBRATION)

    yield table(
        "coupling: < Coupling -> | over: < Over -> | at: At, Hz or N m:8g -> at | "
        "stiffness: k own [N m/rad]:8g -> k | loss_factor: Loss factor η:8g? -> η | "
        "viscous: Viscous c [N m s/rad]:8g?",
        [point for law in tables for point in along(law, "point")],
        "Couplings and dampers with tables: input data",
    )
    for count, law in enumerate(tables, 1):
        unit = scale("N m/rad", law.stiffness.tolist())
        axis, at = AXES[law.over], np.asarray(law.at)
        room = ROOM * float(at[-1] - at[0])
        x = Axis(axis.quantity, axis.unit, float(at[0]) - room, float(at[-1]) + room)
        curve = Line("stiffness", at, law.stiffness * unit.factor, symbol="box")
        upper = Axis("stiffness", unit.unit, low=0.0)
        modes = [
            mode
            for mode in result.at_modes
            if mode.coupling == law.coupling
            and law.over == "frequency"
            and at[0] <= mode.frequency <= at[-1]
        ]
        words = tuple(f"mode {mode.mode}: {number(mode.frequency)} Hz" for mode in modes)
        hertz = np.array([mode.frequency for mode in modes])
        stiffness = np.array([mode.stiffness * unit.factor for mode in modes])
        of_modes = Marks("modes", hertz, stiffness, pen="natural", words=words)
        marks = (of_modes,) if modes else ()
        panels = [Panel(x, upper, (curve,), marks=marks)]
        if law.loss_factor.any():
            lines = (Line("loss factor", at, law.loss_factor, 1, symbol="box"),)
            panels.append(Panel(x, Axis("loss factor", "", low=0.0), lines, height=95.0))
        caption = f"{law.coupling}: stiffness and loss factor over {axis.quantity}"
        yield Figure(f"coupling-table-{count}", caption, tuple(panels))

    if result.at_modes:
        yield Paragraph(LOSS + NO_COMPLEX * any(not law.is_complex for law in tables))
        yield table(
            "mode: Mode -> | frequency: Frequency [Hz]:7 -> Hz | coupling: < Component -> | "
            "stiffness: k own [N m/rad]:7 -> k | loss_factor: Loss factor η -> η | "
            "share: Share of the elastic energy [%]:4 -> share, % | "
            "modal_loss_factor: Modal loss factor of the train -> modal η",
            [
                (along(result, "mode", [mode.mode - 1])[0], mode)
                for mode in sorted(result.at_modes, key=lambda mode: mode.mode)
            ],
            "Couplings and dampers with tables: values at the modes",
        )


def frequencies(findings: Findings) -> Iterator[Block]:
    """Yield the natural frequencies at speeds evenly through the range."""
    result = findings.need(FrequenciesOverSpeed)
    couplings = result.couplings
    yield Heading("Frequencies over the speed")
    yield Paragraph(OVER_SPEED if couplings else OF_PENDULUMS)
    chosen = np.linspace(0, len(result.speed) - 1, MOST_SPEEDS).round().astype(int)
    titles = ["1.speed: Speed [rpm] -> rpm"]
    titles += [
        f"{k}.torque: Mean torque of {coupling.coupling} [~N m] | "
        f"{k}.stiffness: k of {coupling.coupling} [N m/rad]:7"
        for k, coupling in enumerate(couplings, 2)
    ]
    shown = range(1, min(len(result.frequency), MOST_MODES) + 1)
    titles += [f"frequency@{mode}: Mode {mode} [Hz]:7" for mode in shown]
    at_speeds = np.unique(chosen).tolist()
    places = zip(*(along(part, "speed", at_speeds) for part in (result, *couplings)), strict=True)
    yield table(" | ".join(titles), places, "Natural frequencies over the speed")


def temperatures(findings: Findings) -> Iterator[Block]:
    """Yield the equilibria of every coupling that warms, and its temperatures over the speed."""
    couplings = findings.need(CouplingTemperatures).each
    yield Heading("Temperatures of couplings")
    yield Paragraph(WARMING)
    for coupling in couplings:
        hot = coupling.speed[np.isnan(coupling.highest)]
        if hot.size:
            text = f"{coupling.coupling} overheats at {hot.size} of {coupling.speed.size} speeds, from "
            yield Paragraph(f"{text}{rpm(float(hot[0]))} to {rpm(float(hot[-1]))} rpm.", "note")
    yield table(
        "coupling: < Coupling -> | speed: Speed [rpm] -> rpm | temperature: Temperature [°C]:6 -> °C | "
        "heat: Power loss [W] -> W | stiffness: k own [N m/rad]:7 | loss_factor: Loss factor η | is_stable: Stable ->",
        [(coupling, state) for coupling in couplings for state in coupling.equilibria],
        "Equilibrium temperatures of couplings, at the worst speed and at speeds with several equilibria",
        short="Temperatures of couplings",
    )
    for count, coupling in enumerate(couplings, 1):
        curves = ("lowest", coupling.lowest), ("highest", coupling.highest)
        panel = Panel(
            SPEED,
            Axis("temperature", "°C", low=min(0.0, coupling.surroundings)),
            tuple(
                Line(name, coupling.speed * RPM, curve, k) for k, (name, curve) in enumerate(curves)
            ),
            (
                Level("permissible", coupling.permissible, is_reached=True),
                Level("surroundings", coupling.surroundings, "pale"),
            ),
        )
        caption = f"{coupling.coupling}: equilibrium temperatures"
        yield Figure(f"coupling-temperature-{count}", caption, (panel,))


def vibratory_torques(findings: Findings) -> Iterator[Block]:
    """Yield every coupling over vibratory torque at its worst speed, through the range, and with several solutions."""
    couplings = findings.need(VibratoryTorques).each
    yield Heading("Couplings with a table over vibratory torque")
    yield Paragraph(VIBRATING)
    rows = list[Place]()
    for coupling in couplings:
        count, lost = coupling.speed.size, np.flatnonzero(~coupling.settled)
        if lost.size:
            text = f"{coupling.coupling}: {lost.size} of {count} speeds did not converge."
            yield Paragraph(text, "note")
        # Speeds through the range, the worst, the ends of those with several solutions, the first without any.
        through = np.linspace(0, count - 1, min(MOST_VIBRATING, count)).round().astype(int)
        several, worst = np.flatnonzero(coupling.number > 1), int(np.argmax(coupling.torque))
        chosen = {*through.tolist(), *several[[0, -1] if several.size else []].tolist(), worst}
        rows += along(coupling, "speed", sorted(chosen | set(lost[:1].tolist())))
    yield table(
        "coupling: < Coupling -> | speed: Speed [rpm] -> rpm | torque: T [~N m] -> T | "
        "number: Solutions -> solutions | smallest: Smallest [~N m] | stiffness: k own [N m/rad]:7 -> k | "
        "loss_factor: Loss factor η -> η | residual: Residual:2 | rounds: Rounds | settled: Converged",
        rows,
        "Couplings with a table over vibratory torque, at the worst speeds and over the range",
        short="Couplings with a table over vibratory torque",
    )
    for count, coupling in enumerate(couplings, 1):
        torque, stiffness = (
            scale(unit, values.tolist())
            for unit, values in (("N m", coupling.torque), ("N m/rad", coupling.stiffness))
        )
        speed = coupling.speed * RPM
        lines = [Line("largest solution", speed, coupling.torque * torque.factor, 0)]
        if (coupling.number > 1).any():
            lines.append(Line("smallest solution", speed, coupling.smallest * torque.factor, 1))
        curve = Line("k", speed, coupling.stiffness * stiffness.factor, 0)
        yield Figure(
            f"coupling-vibration-{count}",
            f"{coupling.coupling}: total vibratory torque and stiffness",
            (
                Panel(SPEED, Axis("total vibratory torque", torque.unit, low=0.0), tuple(lines)),
                Panel(SPEED, Axis("stiffness", stiffness.unit, low=0.0), (curve,)),
            ),
        )


DAMPERS = (
    "Each mode of the train without the ring is one undamped mass, with the modal inertia at the housing. The"
    " optimum ring minimises the peak magnification (amplitude / static twist): viscous (Den Hartog), or "
    "tuned with a spring and viscous damping (Nishihara and Asami). Use this as a first estimate. Check it in"
    " the forced response, which includes all modes, the damping and the excitation."
)
FAR = math.radians(30.0)  # deflection from which a linear pendulum misses its order by 2 % and more
PENDULUMS = (
    "A pendulum of order q = sqrt(R/l) adds the inertia m (R + l)²/(1 − n²/q²) to its carrier at order n. The"
    " inertia is larger than the mass inertia below q and negative above; at n = q the carrier is fixed for "
    "this order. The restoring force is the centrifugal force, so that natural frequencies depend on the "
    "speed. Modes are for {} rpm. At rest the bobs add nothing."
)
OUT_OF_LINEAR_RANGE = (
    "Deflections are linear. On a circular path a deflection φ lowers the order by about φ²/16 (1.7 % at 30 "
    "degrees). Larger deflections: {}."
)


def dampers(findings: Findings) -> Iterator[Block]:
    """Yield the rings beside what would be best for each mode that they reach; nothing where none reaches one."""
    optima = findings.need(Dampers).each
    if optima:
        yield Heading("Dampers")
        yield Paragraph(DAMPERS)
        yield table(
            "damper: < Damper -> | mode: Mode without the ring -> mode | frequency: Frequency [Hz] -> Hz | "
            "inertia: Modal inertia [kg m²] | ratio: Ring / modal inertia:4 | "
            "viscous: Optimum viscous c [N m s/rad] -> viscous c | viscous_peak: Magnification, viscous:4 | "
            "stiffness: Optimum k, tuned [N m/rad] -> tuned k | damping: Optimum c, tuned [N m s/rad] -> tuned c | "
            "tuned_peak: Magnification, tuned:4 | given_peak: Magnification as given:4g -> as given",
            optima,
            "Optimum damper rings, at the speed of the damper",
            short="Optimum damper rings",
        )


def pendulums(findings: Findings) -> Iterator[Block]:
    """Yield the inertia that each order meets at every pendulum, and the deflection of its bobs."""
    result = findings.need(Pendulums)
    yield Heading("Pendulums")
    yield Paragraph(PENDULUMS.format(rpm(result.speed)))
    far = [pendulum.pendulum for pendulum in result.each if (pendulum.deflection or 0.0) > FAR]
    if far:
        yield Paragraph(OUT_OF_LINEAR_RANGE.format(", ".join(far)), "note")
    yield table(
        "pendulum: < Pendulum -> | tuned: Tuned to order:8g -> order | inertia: Inertia of the bobs [kg m²]:7 | "
        "deflection: Maximum deflection [deg] -> deg | speed: Speed [rpm] -> rpm",
        result.each,
        "Pendulums, at the speed of their shaft",
    )
    rows = [(pendulum, order) for pendulum in result.each for order in pendulum.at_orders]
    if rows:
        yield table(
            "pendulum: < Pendulum -> | order: Order of the shaft:o -> order | inertia: Inertia [kg m²]:7 | "
            "deflection: Deflection [deg] -> deg | speed: Speed [rpm] -> rpm",
            rows,
            "Inertia and deflection of pendulums by order",
        )


REMEDY = "Compute the transient response at this speed."
DIFFERS = 0.10  # of the exact amplitude: more is pointed at
METHOD = (
    "The response models backlash, stages and dry friction by harmonic balance: each coupling has one "
    "stiffness for its largest harmonic twist about the mean twist. Natural frequencies are for closed "
    "backlash, without friction, in the first stage. The program also computes the exact motion at the "
    "largest amplitude of each coupling and in each quarter of its nonlinear speed range. The total and the "
    "checks use the larger value. If no exact motion settles, no check passes. The last columns give the mode"
    " with the largest share in the coupling, and its frequency at this amplitude."
)
TITLES = (
    "coupling: < Coupling -> | component: < Order | speed: Speed [rpm] -> rpm | response: Response -> | "
    "exact: Exact -> | difference: Difference [%]:2 -> | half_range: Exact total | mode: Mode | "
    "natural_frequency: Frequency"
)


def nonlinear_at_peaks(findings: Findings) -> Iterator[Block]:
    """Nothing without such couplings, or without a response."""
    peaks = findings.get(NonlinearPeaks)
    if peaks is None or not peaks.each:
        return
    yield Heading("Backlash and friction at the peaks of the response")
    yield Paragraph(METHOD)
    title = "Backlash and friction at the peaks"
    yield table(TITLES, peaks.each, "Torque amplitudes at the peaks", short=title)
    for name in dict.fromkeys(peak.coupling for peak in peaks.each):
        peaks_of_coupling = [peak for peak in peaks.each if peak.coupling == name]
        notes, peak = list[str](), peaks_of_coupling[0]
        # Where its play opens, and where there are several solutions.
        if peak.opens_from is not None and peak.opens_to is not None:
            where = f"between {rpm(peak.opens_from)} and {rpm(peak.opens_to)} rpm"
            where = f"at {rpm(peak.opens_from)} rpm" if peak.opens_from == peak.opens_to else where
            notes.append(f"the backlash opens {where}: the faces separate and hammer.")
        if peak.several_from is not None and peak.several_to is not None:
            notes.append(
                f"Between {rpm(peak.several_from)} and {rpm(peak.several_to)} rpm the response has several solutions, "
                "and the amplitude can jump between them. The report shows the largest."
            )
        for peak in peaks_of_coupling:
            at_speed = f"At {rpm(peak.speed)} rpm"
            if peak.from_rest is not None:
                reached = f"reaches {number(peak.from_rest)} N m."
                notes.append(f"{at_speed} the exact motion that starts without vibration {reached}")
            if not peak.ended:
                notes.append(f"{at_speed} the exact motion needs too much computing time. {REMEDY}")
            elif peak.exact is None:
                unsettled = "the motion that starts from the response does not settle."
                notes.append(f"{at_speed} {unsettled} {REMEDY}")
            elif peak.difference is not None and abs(peak.difference) > DIFFERS:
                text = f"{at_speed} the response differs by more than {100.0 * DIFFERS:.0f} %; use the exact motion"
                leaves = peak.solutions > 1 and peak.response > peak.exact
                notes.append(text + (", which leaves the largest solution." if leaves else "."))
        if notes:
            yield Paragraph(f"{name}: {' '.join(notes)}", "note")
