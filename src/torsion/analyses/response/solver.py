"""The answer of the train to one harmonic at many frequencies, at the stations' own speeds."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from torsion.analyses.response.amplitudes import blocks
from torsion.analyses.response.harmonic_components import Sources
from torsion.analyses.steady import Steady
from torsion.analyses.undamped_modes import bar_torques, span_torques
from torsion.arrays import ComplexArray, FloatArray, IntArray
from torsion.assembly.system import System
from torsion.errors import Fault, InputError, SolveError
from torsion.kernels.tree_response import complex_compliance, status, tree_response

if TYPE_CHECKING:
    from torsion.kernels.describing_functions import Secant
    from torsion.kernels.loops import Chords

TOGETHER = 2048  # frequencies at once: of fewer, calls cost more than sums
NOTHING: "Mapping[int, Secant]" = {}


@dataclass(frozen=True)
class Answer:
    """Complex amplitudes of one harmonic."""

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
    """The response at circular frequencies `w` (frequencies,) rad/s, with the sources' amplitudes at each of them.

    damping: (stations, frequencies) N m s/rad to ground at own speed, of a train without damping by mode. added,
    stiffness: as of `swept`; raises SolveError where the train is damped by mode.
    """
    if not system.train.modal_damping:
        return swept(system, w, sources, damping, added, stiffness=stiffness)
    if any(not one.is_linear for one in added.values()):
        message = "friction in the response changes the modes, and the train is damped by mode"
        raise SolveError(message, "give the damping of the components", ("damping",))
    from torsion.analyses.response.modal_response import modal_sums

    def still(at: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        found = swept(undamped(system), at, sources, np.zeros((len(system.stations), len(at))))
        return found.angle.T, found.torque.T

    angle, torque, amplification = modal_sums(system, w, sources, still)
    none = np.zeros(len(w))
    return Answer(angle.T, torque.T, none, status(amplification, none))


def answers(
    system: System,
    w: Sequence[FloatArray],
    sources: Sequence[Sources],
    damping: FloatArray,
    added: "Mapping[int, Secant]" = NOTHING,
    *,
    mean: FloatArray | None = None,
    speed: FloatArray | None = None,
    vibratory: Mapping[int, FloatArray] | None = None,
) -> Iterator[Answer]:
    """As `answer` of several harmonics, `w` and `sources` of each at the same speeds.

    mean: (spans, speeds) N m; speed: (speeds,) rad/s of the reference; vibratory: (speeds,) N m of spans by table.
    """
    if added or system.tables:
        for own, force in zip(w, sources, strict=True):
            stiffness = tabled_stiffness(system, own, mean, speed, vibratory)
            yield answer(system, own, force, damping, added, stiffness=stiffness)
        return
    for part in blocks(len(w), damping.shape[1], TOGETHER):
        some = sources[part]
        whole = answer(
            system, np.concatenate(w[part]), Sources.side_by_side(some), np.tile(damping, len(some))
        )
        yield from (
            Answer(*each)
            for each in zip(
                *(np.split(one, len(some)) for one in vars(whole).values()), strict=True
            )
        )


def by_magnitude(answers: Sequence[Answer]) -> Answer:
    """One answer of several whose phases to each other are any: magnitudes added, with the phases of the first."""
    first, *others = answers
    if not others:
        return first

    def added(values: Sequence[ComplexArray]) -> ComplexArray:
        size = np.abs(np.array(values)).sum(axis=0)
        return np.asarray(size * np.exp(1j * np.angle(values[0])))

    return Answer(
        added([one.angle for one in answers]),
        added([one.torque for one in answers]),
        np.max([one.residual for one in answers], axis=0),
        np.max([one.status for one in answers], axis=0),
    )


def undamped(system: System) -> System:
    """The same without the damping of its components."""
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
    """The response at circular frequencies `w` (frequencies,) rad/s, with the sources' amplitudes at each of them.

    The train is damped by its components.

    damping: (stations, frequencies) N m s/rad to ground at own speed. added: of some spans what is left of their own
    spring and damper, and a stiffness beside them, at the driving station's speed. stiffness: (frequencies,) N m/rad
    complex, of spans at the driving station's speed, in place of their own; by default what their tables over frequency
    say. Raises ValueError where such a span closes a loop.
    """
    condensed = system.condensed
    tree = condensed.tree.cut(np.isinf(condensed.tree.flexibility) & (condensed.viscous == 0))
    # chords of loops with a stiffness or a damping
    chords = condensed.extra[
        np.isfinite(system.flexibility[condensed.extra]) | (system.viscous[condensed.extra] > 0)
    ]
    ground = np.zeros((tree.size, len(w)))
    ground[condensed.node] = damping * (system.speed_ratio**2)[:, None]
    compliance = complex_compliance(tree.flexibility, condensed.viscous, condensed.loss_factor, w)
    stiffness = tabled_stiffness(system, w) if stiffness is None else stiffness
    if stiffness:
        compliance = _spread(compliance, len(w))
        for span, own in stiffness.items():
            compliance[_node(system, span)] = 1.0 / (own * system.span_ratio[span] ** 2)
    changed = {span: one for span, one in added.items() if not one.is_linear}
    if changed:
        compliance = _with_added(system, compliance, changed, len(w))
    acting: dict[str, Any] = {
        "twist": sources.twist,
        "ground_damping": ground,
        "compliance": compliance,
    }
    if system.condensed_shafts is not None:
        tree, loss = (
            replace(tree, shafts=system.condensed_shafts),
            condensed.loss_factor[system.condensed_shafts.node],
        )
        found = tree_response(tree, w, sources.force, shaft_loss=loss, **acting)
        torque = bar_torques(system, found.torque, found.torque_outer)
    elif chords.size:
        from torsion.kernels.loops import looped_response

        found = looped_response(
            tree, _chords(system, chords, w, sources), w, sources.force, **acting
        )
        torque = span_torques(system, found.torque, chords, found.chord_torque)
    else:
        found = tree_response(tree, w, sources.force, **acting)
        torque = span_torques(system, found.torque, chords, found.chord_torque)
    with np.errstate(invalid="ignore"):  # at a resonance without damping, whose status says so
        angle = found.angle[condensed.node] * system.speed_ratio[:, None]
    return Answer(angle.T, torque.T, found.residual, status(found.amplification, found.residual))


def tabled_stiffness(
    system: System,
    w: FloatArray,
    mean: FloatArray | None = None,
    speed: FloatArray | None = None,
    vibratory: Mapping[int, FloatArray] | None = None,
) -> Mapping[int, ComplexArray] | None:
    """As `complex_stiffness` of spans with a table; None where there is none."""
    if not system.tables:
        return None
    from torsion.assembly.tabled_spans import complex_stiffness

    return complex_stiffness(system, w, mean, speed, vibratory or {})


def _with_added(
    system: System, compliance: NDArray[Any], added: "Mapping[int, Secant]", frequencies: int
) -> ComplexArray:
    """(tree stations, frequencies) rad/(N m)."""
    whole = _spread(compliance, frequencies)
    for span, one in added.items():
        node = _node(system, span)
        whole[node] = whole[node] / (
            one.share + whole[node] * one.extra * system.span_ratio[span] ** 2
        )
    return whole


def _spread(compliance: NDArray[Any], frequencies: int) -> ComplexArray:
    """(tree stations, frequencies) rad/(N m), a copy."""
    whole = np.empty((len(compliance), frequencies), dtype=complex)
    whole[:] = compliance.reshape(len(compliance), -1)
    return whole


def _node(system: System, span: int) -> int:
    """The tree station below a span; raises ValueError where it closes a loop."""
    node = int(system.condensed.span[span])
    if node < 0:
        raise ValueError(f"'{system.spans[span].name}' closes a loop")
    return node


def ground_damping(system: System, speed: FloatArray, steady: Steady | None) -> FloatArray:
    """(stations, speeds) N m s/rad at reference speeds (speeds,) rad/s; `steady` holds the same speeds.

    Raises InputError where a damping follows from the mean torque and that is not known.
    """
    following = [damper for damper in system.dampers if damper.needs_torque]
    if following and steady is None:
        name = system.stations[following[0].station].name
        message = f"the damping of '{name}' follows from the mean torque, which is not known"
        raise InputError(
            [Fault(("operation", "rated", "power"), message, "give the rated speed and power")]
        )
    applied = np.zeros((len(system.stations), len(speed))) if steady is None else steady.applied
    return system.ground_damping(speed, applied, None if steady is None else steady.load_slope)


def _chords(system: System, chords: IntArray, w: FloatArray, sources: Sources) -> "Chords":
    """The spans `chords` that close loops."""
    from torsion.kernels.loops import Chords

    condensed, ratio = system.condensed, system.span_ratio[chords]
    flexibility, viscous = system.flexibility[chords] / ratio**2, system.viscous[chords] * ratio**2
    compliance = complex_compliance(flexibility, viscous, system.loss_factor[chords], w)
    ends = condensed.node[system.driving[chords]], condensed.node[system.driven[chords]]
    none = np.zeros(len(chords)) if sources.loop_twist is None else sources.loop_twist
    twist = none if sources.loop_twist is None else none[np.isin(condensed.extra, chords)]
    return Chords(*ends, compliance, twist=twist)
