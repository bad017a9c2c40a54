"""How far one figure of a train moves a frequency or an amplitude: closed forms, sums and products only.

With shapes of generalised inertia 1, the share of a span in the elastic energy is h t^2/w^2, that of a station in the
kinetic one J x^2, and a frequency follows ln k by half the first, ln J by minus half the second (Rayleigh 1877, 1,
art. 90). Of a forced response one more right side, the adjoint, gives the derivatives by all figures at once.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from torsion.arrays import ComplexArray, FloatArray
from torsion.kernels.loops import Chords, looped_response
from torsion.kernels.mode_shapes import TreeModes
from torsion.kernels.tree import Tree
from torsion.kernels.tree_response import TreeResponse, tree_response
from torsion.sources import source


@dataclass(frozen=True)
class FrequencySensitivity:
    """d ln f/d ln value of each mode: 0.1 is 1 % of the frequency for 10 % of the value.

    Over the stiffnesses and chords they add up to 1/2, over the inertias and shafts to -1/2. Of a repeated frequency
    they are those of the shapes as listed.
    """

    stiffness: FloatArray  # (stations, modes) of span i, of a distributed shaft by its shear modulus; 0 at a root
    inertia: FloatArray  # (stations, modes); 0 where fixed
    chord: FloatArray  # (chords, modes) by the stiffness of each
    shaft_inertia: FloatArray  # (shafts, modes) by the density of each distributed shaft


@source("Rayleigh1877")
def frequency_sensitivity(
    tree: Tree, modes: TreeModes, chords: FloatArray | None = None
) -> FrequencySensitivity:
    """Of the modes of a tree with its flexibilities and inertias; chords: their flexibility (chords,) rad/(N m).

    >>> two = Tree(np.array([-1, 0]), np.array([0.0, 5e-5]), np.array([1.2, 0.8]), np.zeros(2, dtype=bool))
    >>> from torsion.kernels.natural_modes import tree_modes
    >>> found = frequency_sensitivity(two, tree_modes(two))
    >>> found.stiffness[:, 0].round(12), found.inertia[:, 0].round(12)  # 1/2; 0.4/2 and 0.6/2
    (array([0. , 0.5]), array([-0.2, -0.3]))
    """
    inertia = -0.5 * tree.moving_inertia[:, None] * modes.angle**2
    chord = _elastic(np.empty(0) if chords is None else chords, modes.loop_torque, modes)
    if modes.shafts is None:
        return FrequencySensitivity(
            _elastic(tree.flexibility, modes.torque, modes), inertia, chord, inertia[:0]
        )
    return FrequencySensitivity(
        0.5 * modes.shafts.elastic, inertia, chord, -0.5 * modes.shafts.shaft_kinetic
    )


def _elastic(flexibility: FloatArray, torque: FloatArray, modes: TreeModes) -> FloatArray:
    """Half of each share (spans, modes) of the elastic energy."""
    if not len(torque):
        return np.empty((0, len(modes.frequency)))
    used = np.where(np.isfinite(flexibility), flexibility, 0.0)[:, None]
    return np.asarray(0.5 * used * (torque / modes.frequency) ** 2)


@dataclass(frozen=True)
class ResponseSensitivity:
    """Derivatives of one angle (rad) or torque (N m) at each frequency, not of its amplitude."""

    compliance: ComplexArray  # (stations, frequencies) by the complex compliance of span i; NaN of a distributed shaft
    inertia: ComplexArray  # (stations, frequencies) by the inertia, kg m2; 0 where fixed
    ground_damping: ComplexArray  # (stations, frequencies) by the damper to ground, N m s/rad
    chord: ComplexArray  # (chords, frequencies) by the complex compliance of each chord
    force: ComplexArray  # (stations, frequencies) by the torque that acts on each station, N m
    twist: ComplexArray  # (stations, frequencies) by the twist imposed on span i, rad
    chord_twist: ComplexArray  # (chords, frequencies) by that imposed on each chord


def response_sensitivity(
    tree: Tree,
    w: FloatArray,
    response: TreeResponse,
    *,
    span: int | None = None,
    station: int | None = None,
    chords: Chords | None = None,
    **given: Any,
) -> ResponseSensitivity:
    """Of the torque in `span`, or of the angle of `station`, in the `response` of a tree at `w` (frequencies,) rad/s.

    given: `compliance`, `ground_damping` and `shaft_loss` as `tree_response` had them; chords: as `looped_response`.
    The adjoint is the response to a unit twist of the span, or a unit torque at the station. Raises ValueError unless
    one of both is given, and for the torque of a distributed shaft.

    >>> one = Tree(np.array([-1, 0]), np.array([0.0, 1.0]), np.array([1.0, 2.0]), np.array([True, False]))
    >>> w = np.array([1.0])
    >>> response = tree_response(one, w, np.array([0.0, 1.0]))  # x = F/(k - w^2 J) = -1 rad
    >>> response_sensitivity(one, w, response, station=1).inertia[1].real  # w^2 x^2/F
    array([1.])
    """
    if (span is None) == (station is None):
        raise ValueError(
            "expected either the span whose torque or the station whose angle is meant"
        )
    unit, none = np.zeros(tree.size), np.zeros(tree.size)
    unit[station if span is None else span] = 1.0
    force, twist = (unit, none) if span is None else (none, unit)
    if chords is None:
        adjoint = tree_response(tree, w, force, twist=twist, check=False, **given)
    else:
        still = Chords(chords.begin, chords.end, chords.compliance, np.zeros_like(chords.twist))
        adjoint = looped_response(tree, still, w, force, twist=twist, **given)
    sign = 1.0 if span is None else -1.0
    by_force, by_twist, by_chord = (
        sign * adjoint.angle,
        -sign * adjoint.torque,
        -sign * adjoint.chord_torque,
    )
    product, compliance = by_force * response.angle, -by_twist * response.torque
    if tree.shafts is not None:
        compliance[tree.shafts.node] = np.nan
    chord = -by_chord * response.chord_torque
    return ResponseSensitivity(
        compliance, w * w * product, -1j * w * product, chord, by_force, by_twist, by_chord
    )


def compliance_slopes(
    stiffness: FloatArray, viscous: FloatArray, loss_factor: FloatArray, s: ComplexArray
) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
    """Derivatives (spans, columns) of 1/(k (1 + i eta) + s c) by ln k, by eta, and by c in N m s/rad.

    s: (columns,) 1/s, i w of a response or the root of a damped mode.

    >>> compliance_slopes(*(np.array([v]) for v in (2.0, 0.0, 0.0, 5j)))[0]
    array([[-0.5+0.j]])
    """
    k, c, eta = (
        np.asarray(values, dtype=np.float64)[:, None]
        for values in (stiffness, viscous, loss_factor)
    )
    square = -1.0 / (k * (1 + 1j * eta) + s * c) ** 2
    return square * k * (1 + 1j * eta), square * 1j * k, square * s
