"""Complex amplitudes of a forced response, and what all lines together make of them."""

from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any, TypeVar

import numpy as np

from torsion.analyses.response.excitation import Line
from torsion.kernels.tree import ComplexArray, FloatArray


@dataclass(frozen=True)
class Response:
    """Complex amplitudes (half ranges, time factor exp(+i omega t), phase at reference angle zero)."""

    speed: FloatArray  # (speeds,) rad/s of the reference station, refined around resonances
    asked: np.ndarray  # (speeds,) bool: speeds of the grid that was asked for
    lines: tuple[Line, ...]
    frequency: FloatArray  # (speeds, lines) Hz
    angle: ComplexArray  # (speeds, lines, stations) rad at own speed
    torque: ComplexArray  # (speeds, lines, spans) N m, elastic and damping share together
    mean: FloatArray  # (speeds, spans) N m, order 0
    residual: FloatArray  # (speeds, lines) relative equilibrium residual
    status: np.ndarray  # (speeds, lines) uint8: kernels.tree_response.Status
    joint_error: FloatArray  # (speeds, lines) estimated relative error of the first-order joint model; 0 without joints
    remark: str = ""  # what the refinement around resonances had to leave out
    left_out: tuple[Line, ...] = ()  # what excites by an order that was not asked for


@dataclass(frozen=True)
class Synthesis:
    """All lines together, true to phase, over the common cycle."""

    half_range: FloatArray  # (speeds, spans) N m: (max - min)/2
    peak: FloatArray  # (speeds, spans) N m: largest |mean + vibration|
    rms: FloatArray  # (speeds, spans) N m
    bound: FloatArray  # (speeds, spans) N m: sum of magnitudes
    turns: Fraction  # common cycle in turns of the reference station; 0 where lines have none


@dataclass(frozen=True)
class FrequencyResponse:
    """Complex amplitudes under the torques that act at every frequency, at one operating point."""

    frequency: FloatArray  # (frequencies,) Hz, refined around resonances
    asked: np.ndarray  # (frequencies,) bool: frequencies of the grid that was asked for
    sources: tuple[str, ...]  # names of what excites
    speed: float  # rad/s of the reference station, at which damping and mean torque were taken; 0 where none is given
    angle: ComplexArray  # (frequencies, stations) rad at own speed
    torque: ComplexArray  # (frequencies, spans) N m, elastic and damping share together
    residual: FloatArray  # (frequencies,) relative equilibrium residual
    status: np.ndarray  # (frequencies,) uint8: kernels.tree_response.Status
    remark: str = ""  # what the refinement around resonances had to leave out


Result = TypeVar("Result", Response, FrequencyResponse)


def merged(first: Result, second: Result) -> Result:
    """Both results in one, by ascending speed or frequency."""
    axis = "speed" if isinstance(first, Response) else "frequency"
    along = np.concatenate([getattr(first, axis), getattr(second, axis)])
    place = np.unique(along, return_index=True)[1]
    both: dict[str, Any] = {}
    for key, value in vars(first).items():
        if isinstance(value, np.ndarray):
            both[key] = np.concatenate([value, getattr(second, key)])[place]
    return replace(first, **both)


def joined(first: tuple[Response, Synthesis], second: tuple[Response, Synthesis]) -> tuple[Response, Synthesis]:
    """Two responses of the same lines with their syntheses in one, by ascending speed."""
    response = merged(first[0], second[0])
    place = np.unique(np.concatenate([first[0].speed, second[0].speed]), return_index=True)[1]
    both: dict[str, Any] = {
        key: np.concatenate([value, getattr(second[1], key)])[place]
        for key, value in vars(first[1]).items()
        if isinstance(value, np.ndarray)
    }
    return response, replace(first[1], **both)
