"""A lumped train as Modelica text: its vibration about the mean motion at one speed.

Components of Modelica.Mechanics.Rotational 4.0. Angles count in the sense of each station, so ratios are positive. The
torque of a span is minus the torque `tau` of its component, whose flange_a is on the driving side. Start values are
those of the periodic motion, so that no transient precedes it.
"""

import json
import re
from dataclasses import dataclass, field
from fractions import Fraction

import numpy as np

from torsion.analyses.response.amplitudes import Response
from torsion.analyses.response.harmonic_components import amplitude, excitations
from torsion.analyses.response.over_speed import response_of_orders
from torsion.analyses.response.solver import ground_damping
from torsion.analyses.steady import Steady, steady_if_known
from torsion.arrays import FloatArray
from torsion.assembly.system import System
from torsion.errors import Fault, InputError, refusal
from torsion.kernels.trees.tree import connected
from torsion.study import Study

ROTATIONAL = "Modelica.Mechanics.Rotational"
PERIODS = 10  # of the lowest order, simulated by default
SAME_DAMPING = 1e-12  # relative; a loss factor gives another viscous damping at every frequency


@dataclass
class _Text:
    """The declarations and connections written so far."""

    taken: set[str]
    declared: list[str] = field(default_factory=list)
    connections: list[str] = field(default_factory=list)
    flanges: dict[int, str] = field(default_factory=dict)  # station: the first flange at it

    def declare(self, kind: str, label: str, modifiers: str = "") -> str:
        """Declare a component; return its name, which is legal and occurs once."""
        word = re.sub(r"\W+", "_", label, flags=re.ASCII).strip("_") or "part"
        word = word if word[0].isalpha() else f"p_{word}"
        name, count = word, 1
        while name in self.taken:
            count += 1
            name = f"{word}_{count}"
        self.taken.add(name)
        given = f"({modifiers})" if modifiers else ""
        comment = json.dumps(label, ensure_ascii=False)
        self.declared.append(f"  {kind} {name}{given} {comment};")
        return name

    def connect(self, flange: str, other_flange: str) -> None:
        self.connections.append(f"  connect({flange}, {other_flange});")

    def join(self, station: int, flange: str) -> None:
        """Connect a flange to the node of a station."""
        if station in self.flanges:
            self.connect(self.flanges[station], flange)
        self.flanges.setdefault(station, flange)


def modelica(study: Study, system: System, speed: float, order: Fraction | None = None) -> str:
    """Return the Modelica text of a lumped train at a reference speed (rad/s), for one order or for all.

    Raises InputError for what has no counterpart: another model, universal joints, damping by mode, couplings that
    follow their amplitude, and several orders of a train with loss factors.
    """
    reasons = {  # for which there is no counterpart in the library
        f"the model {system.model} has no discrete components (write `model: lumped`)": system.bars
        is not None,
        "a universal joint has no counterpart in Modelica.Mechanics.Rotational": any(
            span.error for span in system.own_spans
        ),
        "a coupling that follows its amplitude has no linear counterpart": (
            system.train.has_nonlinear_couplings or system.train.has_tables_over("vibratory torque")
        ),
        "damping by mode has no counterpart; give the components their damping": bool(
            system.train.modal_damping
        ),
    }
    if faults := [Fault((), reason) for reason, is_so in reasons.items() if is_so]:
        raise InputError(faults)
    grid = np.array([speed])
    possible = excitations(system)
    # Orders first, then fixed frequencies, which belong to no order.
    acting = [item for item in possible if order in (None, item.line.order)]
    orders = [item.line.order for item in acting if item.line.order is not None]
    if not acting:
        listed = ", ".join(str(item.line.order) for item in possible if item.line.order is not None)
        raise refusal(f"order {order} does not excite the train", f"orders: {listed or 'none'}")
    response = response_of_orders(study, system, orders, grid)
    system = response.system
    steady = steady_if_known(study, system, grid)
    # (orders,) rad/s
    frequencies = np.array([float(item.line.circular_frequency(grid)[0]) for item in acting])

    text = _Text({"Train"})
    _declare_stations(text, system, response, frequencies)
    _declare_spans(text, system, grid, steady, frequencies)
    # A damper from every station with damping to one fixed ground.
    damping = ground_damping(system, grid, steady)[:, 0]
    stations = np.flatnonzero(damping).tolist()
    ground = text.declare(f"{ROTATIONAL}.Components.Fixed", "ground") if stations else ""
    for station in stations:
        label, size = f"{system.stations[station].name} to ground", float(damping[station])
        damper = text.declare(f"{ROTATIONAL}.Components.Damper", label, f"d={size!r}")
        text.join(station, f"{damper}.flange_a")
        text.connect(f"{damper}.flange_b", f"{ground}.flange")
    # A sine and a torque for every harmonic component at every station; cos(wt + p) = sin(wt + p + pi/2).
    for item, frequency in zip(acting, frequencies.tolist(), strict=True):
        for torque in item.torques:
            phasor = complex(amplitude(system, torque, grid, steady)[0])
            phase, hertz = float(np.angle(phasor)) + np.pi / 2.0, frequency / (2.0 * np.pi)
            is_order = item.line.order is not None
            label = f"{torque.name} " + (
                f"order {item.line.order}" if is_order else f"at {hertz:.6g} Hz"
            )
            modifiers = f"amplitude={abs(phasor)!r}, f={hertz!r}, phase={phase!r}"
            sine = text.declare("Modelica.Blocks.Sources.Sine", label, modifiers)
            about = f"{label} torque", "useSupport=false"
            source = text.declare(f"{ROTATIONAL}.Sources.Torque", *about)
            text.connect(f"{sine}.y", f"{source}.tau")
            text.join(torque.station, f"{source}.flange")

    title = f"{study.name}: vibration at {speed * 30.0 / np.pi:.6g} rpm"
    end = 2.0 * np.pi * PERIODS / float(frequencies.min())
    experiment = f'annotation(uses(Modelica(version="4.0.0")), experiment(StopTime={end!r}, Tolerance=1e-9));'
    lines = [
        f"model Train {json.dumps(title, ensure_ascii=False)}",
        *text.declared,
        "equation",
        *text.connections,
    ]
    return "\n".join([*lines, f"  {experiment}", "end Train;"]) + "\n"


def _declare_stations(
    text: _Text, system: System, response: Response, frequencies: FloatArray
) -> None:
    """Declare inertias and fixed stations; the first inertia of every rigid group has the start values."""
    # (components, stations) complex; torques of a fixed frequency are in every response, behind the orders
    angles = response.angle[0][: len(frequencies)]
    angle, velocity = angles.real.sum(0), (1j * frequencies[:, None] * angles).real.sum(0)
    rigid = system.flexibility == 0
    groups = connected(len(system.stations), system.driving[rigid], system.driven[rigid])
    started = set[int]()
    for number, station in enumerate(system.stations):
        if system.held[number] or station.is_ground:
            fixed = text.declare(f"{ROTATIONAL}.Components.Fixed", station.name)
            text.join(number, f"{fixed}.flange")
        elif system.inertia[number] > 0:
            modifiers = f"J={float(system.inertia[number])!r}"
            if int(groups[number]) not in started:
                started.add(int(groups[number]))
                modifiers += f", phi(start={float(angle[number])!r}, fixed=true)"
                modifiers += f", w(start={float(velocity[number])!r}, fixed=true)"
            text.join(
                number,
                f"{text.declare(f'{ROTATIONAL}.Components.Inertia', station.name, modifiers)}.flange_a",
            )


def _declare_spans(
    text: _Text, system: System, grid: FloatArray, steady: Steady | None, frequencies: FloatArray
) -> None:
    """Declare what joins two stations: spring and damper, then the ideal gear; a rigid span is a torque sensor.

    Raises InputError for a loss at several frequencies.
    """
    mean = np.zeros((len(system.spans), 1)) if steady is None else steady.torque
    for number, span in enumerate(system.spans):
        ends, ratio = list[tuple[str, str]](), float(span.ratio)
        if system.flexibility[number] != 0:
            about = frequencies[None], mean[number][:, None], grid[:, None]
            parts = system.elastic(number, *about)
            stiffness, loss = (np.broadcast_to(part, (1, len(frequencies)))[0] for part in parts)
            damping = loss / frequencies
            if any(
                np.ptp(x) > SAME_DAMPING * max(abs(x).max(), 1e-300) for x in (stiffness, damping)
            ):
                message = f"stiffness and damping of '{span.name}' differ from order to order"
                raise refusal(message, "write one order at a time: --order 1/2")
            is_free = np.isinf(system.flexibility[number])
            sizes = {"c": 0.0 if is_free else float(stiffness[0]), "d": float(damping[0])}
            kind = "SpringDamper" if all(sizes.values()) else "Spring" if sizes["c"] else "Damper"
            modifiers = ", ".join(f"{key}={value!r}" for key, value in sizes.items() if value)
            part = text.declare(f"{ROTATIONAL}.Components.{kind}", span.name, modifiers)
            ends.append((f"{part}.flange_a", f"{part}.flange_b"))
        elif ratio == 1:
            part = text.declare(f"{ROTATIONAL}.Sensors.TorqueSensor", span.name)
            ends.append((f"{part}.flange_a", f"{part}.flange_b"))
        if ratio != 1:
            kind, label = f"{ROTATIONAL}.Components.IdealGear", f"{span.name} gear"
            gear = text.declare(kind, label, f"ratio={1.0 / ratio!r}")
            ends.append((f"{gear}.flange_a", f"{gear}.flange_b"))
        text.join(span.driving, ends[0][0])
        if len(ends) == 2:
            text.connect(ends[0][1], ends[1][0])
        text.join(span.driven, ends[-1][1])
