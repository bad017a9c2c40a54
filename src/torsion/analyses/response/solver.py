"""The answer of the train to harmonic components at many frequencies, at the stations' own speeds."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from torsion.analyses.response.amplitudes import blocks
from torsion.analyses.response.harmonic_components import Sources
from torsion.analyses.steady import Steady
from torsion.analyses.undamped_modes import Modes, modes_as_discretised, span_torques
from torsion.arrays import ComplexArray, FloatArray
from torsion.assembly.system import System
from torsion.errors import Fault, InputError, SolveError
from torsion.kernels.trees.tree_response import Chords, complex_compliance, status, tree_response

if TYPE_CHECKING:
    from torsion.kernels.describing_functions import Secant

TOGETHER = 2048  # frequencies at once: of fewer, calls cost more than sums
MOST_STATIONS = 3000  # of a train with damping by mode, whose modes are all taken
DAMPING = ("damping",)
NOTHING: "Mapping[int, Secant]" = {}
UNKNOWN: Mapping[int, FloatArray] = {}


@dataclass(frozen=True)
class Answer:
    """Complex amplitudes of one harmonic component."""

    angle: ComplexArray  # (frequencies, stations) rad at own speed
    torque: ComplexArray  # (frequencies, spans) N m at the driving station's speed, elastic and damping share
    residual: FloatArray  # (frequencies,) relative
    status: np.ndarray  # (frequencies,) uint8: kernels.tree_response.Status


def answer(
    system: System,
    w: FloatArray,
    sources: Sources,
    damping: FloatArray,
    added: "Mapping[int, Secant]" = NOTHING,
    *,
    stiffness: Mapping[int, ComplexArray] | None = None,
) -> Answer:
    """Return the response at circular frequencies `w` (frequencies,) rad/s, with the sources' amplitudes at each.

    damping: (stations, frequencies) N m s/rad to ground at own speed, of a train without damping by mode. added,
    stiffness: as of `swept`; raises SolveError where the train is damped by mode.
    """
    if not system.train.modal_damping:
        return swept(system, w, sources, damping, added, stiffness=stiffness)
    if any(not secant.is_linear for secant in added.values()):
        message = "friction in the response changes the modes, and the train is damped by mode"
        raise SolveError(message, "give the damping of the components", DAMPING)
    if sources.twist is not None or sources.loop_twist is not None:
        message = "damping by mode does not support joints or meshes that excite"
        raise SolveError(message, "give the components their damping", DAMPING)
    return _modal_answer(system, w, sources)


def _modal_answer(system: System, w: FloatArray, sources: Sources) -> Answer:
    """Return the response of a train with damping by mode: a sum over all modes, and the exact static rest.

    A mode answers with force / (w_i**2 - w**2 + 2 i zeta_i w_i w), a rigid motion with -force / w**2. What rigid spans
    and points without inertia carry beside that is the same at every frequency: the exact undamped answer at one, less
    the sum. Raises SolveError for a train of too many stations, or with distributed shafts.
    """
    from torsion.analyses.modes.mode_nodes import beside_modes, rigid_shapes

    basis: tuple[Modes, FloatArray] | None = vars(system).get("modal_basis")
    if basis is None:
        if system.bars is not None or system.condensed.tree.size > MOST_STATIONS:
            message = f"damping by mode is for lumped trains of at most {MOST_STATIONS} stations"
            raise SolveError(message, "model: lumped, with fewer `segments`", DAMPING)
        basis = modes_as_discretised(system, None), rigid_shapes(system)
        vars(system)["modal_basis"] = basis  # computed once
    modes, rigid = basis
    none = np.zeros(rigid.shape[1])
    mode_w = np.concatenate([none, 2.0 * math.pi * modes.frequency])[:, None]
    ratio = np.concatenate([none, system.modal_ratios(len(modes.frequency))])[:, None]
    shape = np.concatenate([rigid, modes.shape], axis=1)
    torque = np.pad(modes.torque, ((0, 0), (rigid.shape[1], 0)))
    on_tree = np.zeros((system.condensed.tree.size, len(mode_w)))
    on_tree[system.condensed.node] = shape / system.speed_ratio[:, None]
    force = on_tree.T @ sources.force
    with np.errstate(divide="ignore", invalid="ignore"):
        denominator = mode_w**2 - w**2 + 2j * ratio * mode_w * w
        moved = force / denominator
        amplification = ((mode_w**2 + w**2) / np.abs(denominator)).max(axis=0, initial=1.0)
    angle = shape @ moved
    carried = torque @ moved
    stations, spans = beside_modes(system)
    if stations.any() or spans.any():
        far = 0.5 * float(mode_w[mode_w > 0.0].min(initial=2.0))  # rad/s, far from every mode
        no_damping = np.zeros((len(stations), len(w)))
        still = swept(undamped(system), np.full(len(w), far), sources, no_damping)
        slow = force / (mode_w**2 - far**2)
        angle[stations] += still.angle.T[stations] - shape[stations] @ slow
        carried[spans] += still.torque.T[spans] - torque[spans] @ slow
    none = np.zeros(len(w))
    return Answer(angle.T, carried.T, none, status(amplification, none))


def answers(
    system: System,
    w: Sequence[FloatArray],
    sources: Sequence[Sources],
    damping: FloatArray,
    added: "Mapping[int, Secant]" = NOTHING,
    *,
    mean: FloatArray | None = None,
    speed: FloatArray | None = None,
    vibratory: Mapping[int, FloatArray] = UNKNOWN,
) -> Iterator[Answer]:
    """Yield the answers to several components, `w` and `sources` of each at the same speeds.

    mean: (spans, speeds) N m; speed: (speeds,) rad/s of the reference; vibratory: (speeds,) N m of spans by table.
    """
    if added or system.tables:
        from torsion.assembly.tabled_spans import complex_stiffness

        for own_w, force in zip(w, sources, strict=True):
            stiffness = complex_stiffness(system, own_w, mean, speed, vibratory)
            yield answer(system, own_w, force, damping, added, stiffness=stiffness)
        return
    for part in blocks(len(w), damping.shape[1], TOGETHER):
        forces = sources[part]
        # Several components in the columns of one; what nothing imposes on is 0 beside what something does.
        twists: list[ComplexArray | None] = []
        for name in ("twist", "loop_twist"):
            imposed = [getattr(force, name) for force in forces]
            rows = next((len(twist) for twist in imposed if twist is not None), None)
            none = np.zeros((rows or 0, damping.shape[1]))
            filled = [none if twist is None else twist for twist in imposed]
            twists.append(None if rows is None else np.hstack(filled))
        columns = Sources(np.hstack([force.force for force in forces]), *twists)
        ground = np.tile(damping, len(forces))
        result = answer(system, np.concatenate(w[part]), columns, ground)
        pieces = (np.split(values, len(forces)) for values in vars(result).values())
        yield from (Answer(*values) for values in zip(*pieces, strict=True))


def by_magnitude(answers: Sequence[Answer]) -> Answer:
    """Return one answer of several whose phases to each other are any: magnitudes added, phases of the first."""
    if len(answers) == 1:
        return answers[0]
    angle, torque = (
        np.abs(values).sum(axis=0) * np.exp(1j * np.angle(values[0]))
        for values in (
            np.array([answer.angle for answer in answers]),
            np.array([answer.torque for answer in answers]),
        )
    )
    residual = np.max(np.stack([answer.residual for answer in answers]), axis=0)
    return Answer(angle, torque, residual, np.max([answer.status for answer in answers], axis=0))


def undamped(system: System) -> System:
    """Return the system without the damping of its components."""
    none = np.zeros(len(system.spans))
    return replace(system, viscous=none, loss_factor=none, dampers=())


def swept(
    system: System,
    w: FloatArray,
    sources: Sources,
    damping: FloatArray,
    added: "Mapping[int, Secant]" = NOTHING,
    *,
    stiffness: Mapping[int, ComplexArray] | None = None,
) -> Answer:
    """Return the response of a train that its components damp, at circular frequencies `w` (frequencies,) rad/s.

    damping: (stations, frequencies) N m s/rad to ground at own speed. added: of some spans what is left of their own
    spring and damper, and a stiffness in parallel, at the driving station's speed. stiffness: (frequencies,) N m/rad
    complex, of spans at the driving station's speed, in place of their own; by default what their tables over frequency
    say. Raises ValueError where such a span closes a loop.
    """
    condensed = system.condensed
    tree = condensed.tree.cut(np.isinf(condensed.tree.flexibility) & (condensed.viscous == 0))
    # Chords of loops with a stiffness or a damping.
    chords = condensed.extra[
        np.isfinite(system.flexibility[condensed.extra]) | (system.viscous[condensed.extra] > 0)
    ]
    ground = np.zeros((tree.size, len(w)))
    ground[condensed.node] = damping * (system.speed_ratio**2)[:, None]

    compliance = complex_compliance(tree.flexibility, condensed.viscous, condensed.loss_factor, w)
    if stiffness is None and system.tables:
        from torsion.assembly.tabled_spans import complex_stiffness

        stiffness = complex_stiffness(system, w)
    stiffness = stiffness or {}
    secants = {span: secant for span, secant in added.items() if not secant.is_linear}
    if stiffness or secants:
        shape = tree.size, len(w)
        compliance = np.array(np.broadcast_to(compliance.reshape(tree.size, -1), shape), complex)
    for span in {*stiffness, *secants}:
        node = condensed.span[span]
        if node < 0:
            raise ValueError(f"'{system.spans[span].name}' closes a loop")
        ratio2 = system.span_ratio[span] ** 2
        if span in stiffness:
            compliance[node] = 1.0 / (stiffness[span] * ratio2)
        if span in secants:
            extra = secants[span].extra * ratio2
            compliance[node] /= secants[span].share + compliance[node] * extra

    acting: dict[str, Any] = {
        "twist": sources.twist,
        "ground_damping": ground,
        "compliance": compliance,
    }
    if (shafts := system.condensed_shafts) is not None:
        acting["shaft_loss"] = condensed.loss_factor[shafts.node]
        tree = replace(tree, shafts=shafts)
    if chords.size:
        ratio2 = system.span_ratio[chords] ** 2
        flexibility = system.flexibility[chords] / ratio2
        viscous = system.viscous[chords] * ratio2
        acting["chords"] = Chords(
            condensed.node[system.driving[chords]],
            condensed.node[system.driven[chords]],
            complex_compliance(flexibility, viscous, system.loss_factor[chords], w),
            twist=np.zeros(len(chords), dtype=np.complex128)
            if sources.loop_twist is None
            else sources.loop_twist[np.isin(condensed.extra, chords)],
        )
    result = tree_response(tree, w, sources.force, **acting)
    with np.errstate(invalid="ignore"):  # at a resonance without damping, whose status says so
        torque = span_torques(
            system, result.torque, result.torque_outer, chords, result.chord_torque
        )
        angle = result.angle[condensed.node] * system.speed_ratio[:, None]
    return Answer(angle.T, torque.T, result.residual, status(result.amplification, result.residual))


def ground_damping(system: System, speed: FloatArray, steady: Steady | None) -> FloatArray:
    """Return the damping to ground (stations, speeds) N m s/rad at reference speeds (speeds,) rad/s of `steady`.

    Raises InputError where a damping follows from the mean torque and that is not known.
    """
    following = [damper for damper in system.dampers if damper.needs_torque]
    if following and steady is None:
        name = system.stations[following[0].station].name
        message = f"the damping of '{name}' follows from the mean torque, which is not known"
        path = ("operation", "rated", "power")
        hint = "give the rated speed and power"
        raise InputError([Fault(path, message, hint)])
    applied = np.zeros((len(system.stations), len(speed))) if steady is None else steady.applied
    return system.ground_damping(speed, applied, None if steady is None else steady.load_slope)
