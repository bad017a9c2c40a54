"""Complex amplitudes of a forced response, all harmonic components together, and how much memory they need.

A response that needs more memory than it may is refused beforehand; any other is computed in blocks.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from itertools import zip_longest
from pkgutil import resolve_name
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from torsion.analyses.response.harmonic_components import Line, Sources
from torsion.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from torsion.assembly.elements import elements, spans_by_name
from torsion.assembly.system import System
from torsion.errors import Fault, InputError, Path
from torsion.kernels.trees.tree_response import Status
from torsion.results import (
    RPM,
    TO_DATAFRAME,
    Displayed,
    Keyed,
    by_name,
    derived,
    listed,
    one_line,
    reported,
    result,
    words,
)

if TYPE_CHECKING:
    from torsion.kernels.describing_functions import Secant

BLOCK_VALUES = 2**22  # points times stations of one line solved at once: 64 MB an array
SMALL_BLOCK = 2**20  # the same of the synthesis, which needs some twenty arrays on the way
COMPLEX, REAL = 16, 8  # bytes
COPIES = 2  # of all amplitudes, while points are added or written
OrderLike = int | float | str | Fraction
REAL_ROWS = 5  # of a span over the points: mean torque, half range, peak, RMS, bound


@dataclass(frozen=True)
class Balanced:
    """Couplings with play, friction or stages in harmonic balance; arrays (points, couplings)."""

    spans: tuple[int, ...]  # of the couplings
    number: IntArray  # of solutions
    settled: BoolArray  # (points,) all couplings are in balance
    amplitude: (
        FloatArray  # rad, of the twist in the largest harmonic component: the largest solution
    )
    smallest: FloatArray  # rad, the smallest solution
    first: FloatArray  # rad, up to which the coupling stays linear about its mean twist
    share: FloatArray  # of its own spring and damper
    extra: ComplexArray  # N m/rad beside them

    @property
    def added(self) -> "dict[int, Secant]":
        """What each span with such a coupling is in the linear train."""
        from torsion.kernels.describing_functions import Secant

        return {
            span: Secant(self.share[:, k], self.extra[:, k]) for k, span in enumerate(self.spans)
        }


@dataclass(frozen=True)
class Components:
    """The harmonic components of a response at some points, ready to be answered."""

    orders: Sequence[Fraction | None]
    w: Sequence[FloatArray]  # of each: (points,) rad/s
    apart: Sequence[Sequence[Sources]]  # of each: sources in any phase to each other
    ground: FloatArray  # (stations, points) N m s/rad
    mean: FloatArray  # (spans, points) N m
    speed: FloatArray | None = None  # (points,) rad/s of the reference station

    @property
    def separate(self) -> list[tuple[Fraction | None, FloatArray, Sources]]:
        """Order, frequencies and sources of each part of a component whose sources have a phase to each other."""
        rows = zip(self.orders, self.w, self.apart, strict=True)
        return [(order, w, source) for order, w, apart in rows for source in apart]


@dataclass(frozen=True)
class Following:
    """Couplings by table over their own vibratory torque; arrays (points, couplings)."""

    spans: tuple[int, ...]  # of the couplings
    torque: FloatArray  # N m, half range of all harmonic components: the solution that stands
    number: IntArray  # of solutions, the other couplings as they stand
    residual: FloatArray  # |half range at the stiffness of `torque` / torque - 1|
    rounds: IntArray  # (points,) over the couplings
    settled: BoolArray  # (points,)


@dataclass(frozen=True, repr=False)
class SpanTorque:
    """Complex torque amplitudes in a component; NaN where the response has no reliable value."""

    name: str
    orders: tuple[
        Fraction | None, ...
    ]  # per revolution of the reference; None of a fixed frequency
    speed: FloatArray  # (speeds,) rad/s of the reference
    torque: ComplexArray  # (speeds, orders) N m

    @property
    def speed_rpm(self) -> FloatArray:
        """Speeds (speeds,) rpm of the reference."""
        return self.speed * RPM

    @property
    def complex_Nm(self) -> ComplexArray:  # noqa: N802
        """Complex amplitudes (speeds, orders) N m."""
        return self.torque

    @property
    def abs_Nm(self) -> FloatArray:  # noqa: N802
        """Largest amplitude (speeds,) N m of any one order. The total of all orders is `synthesis`."""
        return np.asarray(np.abs(self.torque).max(axis=1))

    def max(self) -> float:
        """Return the largest amplitude in N m; NaN if a speed has no reliable value."""
        return float(self.abs_Nm.max())

    @property
    def at_max_rpm(self) -> float:
        """Reference speed of the largest amplitude, or of the first one without a reliable value."""
        return float(self.speed_rpm[self.abs_Nm.argmax()])

    def to_dataframe(self) -> Any:
        """Return a pandas.DataFrame with one row for each speed and order; raises ImportError without pandas."""
        return resolve_name(TO_DATAFRAME)(self)

    def __repr__(self) -> str:
        orders = ", ".join(
            "fixed frequency" if order is None else str(order) for order in self.orders
        )
        peak = f"{self.max():.4g}" if np.isfinite(self.max()) else "no reliable value"
        return one_line(
            f"Torque of {self.name} [N m]: {peak} at {self.at_max_rpm:.5g} rpm; order {orders}"
        )


@reported
class Response(Displayed, Keyed):
    """Complex amplitudes (half ranges, time factor exp(+i omega t), phase at reference angle zero)."""

    speed: FloatArray = result(
        "rad/s",
        "speed",
        "reference speeds, more of them around resonances and where rules judge",
    )
    requested: np.ndarray = result(
        "", "speed", "the speed is one of those requested", key="is_asked"
    )
    lines: tuple[Line, ...] = result("", "line", "harmonic components of the excitation", record="")
    frequency: FloatArray = result("Hz", ("speed", "line"), "of the component")
    angle: ComplexArray = result(
        "rad",
        ("speed", "line", "station"),
        "complex amplitude at own speed; null if the status is not ok",
        printed=("speed", "named station"),
        known_by="status",
    )
    torque: ComplexArray = result(
        "N*m",
        ("speed", "line", "span"),
        "complex amplitude, elastic and damping share together",
        printed=("speed", "end span"),
        known_by="status",
    )
    mean: FloatArray = result(
        "N*m", ("speed", "span"), "mean torque", key="mean_torque_Nm", printed=("speed", "end span")
    )
    residual: FloatArray = result("1", ("speed", "line"), "relative equilibrium residual")
    status: np.ndarray  # (speeds, lines) uint8: kernels.tree_response.Status
    joint_error: FloatArray = result(
        "1",
        ("speed", "line"),
        "estimated relative error of the first-order joint model; 0 without joints",
    )
    system: System = field(
        repr=False
    )  # whose stations and spans these are; `response` may have refined it
    remark: str = result("what the refinement of speeds omitted", default="")
    left_out: tuple[Line, ...] = ()  # what excites by an order that was not requested
    by_magnitude: bool = result(
        "amplitudes of engines whose phase is any are added by their magnitudes, and so all orders",
        default=False,
    )
    balanced: Balanced | None = field(default=None, repr=False)  # None without nonlinear couplings
    following: Following | None = field(
        default=None, repr=False
    )  # None without a table over vibratory torque
    others: "tuple[Response, ...]" = field(
        default=(), repr=False
    )  # of the other solutions of such couplings, by rank

    def __getitem__(self, key: str | tuple[str, OrderLike]) -> SpanTorque:
        """Return the torque in a component, of every order or of one; raises KeyError with the nearest name.

        Of a shaft in segments it is that of the segment with the largest amplitude; `shaft [3]` is one segment.
        """
        name, order = key if isinstance(key, tuple) else (key, None)
        spans = by_name(name, spans_by_name(self.system))
        orders = [line.order for line in self.lines]
        lines = [k for k, value in enumerate(orders) if order is None or value == Fraction(order)]
        if not lines:
            orders_listed = listed(str(value) for value in orders if value is not None) or "none"
            raise KeyError(
                f"no order {order} excites; orders: {orders_listed}"
                if self.lines
                else "nothing excites"
            )
        torque = np.where(
            (self.status == Status.OK)[:, lines, None], self.torque[:, lines][:, :, spans], np.nan
        )
        largest = int(np.nan_to_num(np.abs(torque)).max(axis=(0, 1), initial=0.0).argmax())
        return SpanTorque(name, tuple(orders[k] for k in lines), self.speed, torque[:, :, largest])

    @property
    def points(self) -> FloatArray:
        """The speeds or frequencies (points,) at which it was computed."""
        return self.speed

    @property
    def unreliable(self) -> BoolArray:
        """(speeds,) whether any harmonic component is not ok."""
        return np.asarray((self.status != Status.OK).any(axis=1))

    def amplitude(self, spans: Sequence[int]) -> FloatArray:
        """Return the largest torque amplitude (speeds, lines) N m in the spans; NaN where the line is not ok."""
        size = np.abs(self.torque[:, :, list(spans)]).max(axis=2)
        return np.where(self.status == Status.OK, size, np.nan)

    @derived("", ("speed", "line"), "ok, near-singular or singular", key="status")
    def status_words(self) -> np.ndarray:
        """Words of the status (speeds, lines) of every component."""
        return words(self.status, Status)

    @derived("orders that excite and are not in `orders`, exact; empty if a rule judges all")
    def orders_left_out(self) -> tuple[Fraction | None, ...]:
        """Orders that excite and were not requested, ascending; None of a fixed frequency."""
        return tuple(line.order for line in self.left_out)


@reported
class Synthesis:
    """All lines together, true to phase, over the common cycle."""

    half_range: FloatArray = result(
        "N*m",
        ("speed", "span"),
        "(max - min)/2; for couplings with backlash, friction or stages at least the amplitude of the exact motion; "
        "null if unknown",
        printed=("element", "speed"),
    )
    peak: FloatArray = result(
        "N*m",
        ("speed", "span"),
        "largest magnitude of mean and vibration, raised to the exact motion as `half_range_Nm`",
        printed=("element", "speed"),
    )
    rms: FloatArray = result(
        "N*m", ("speed", "span"), "root mean square", printed=("element", "speed")
    )
    bound: FloatArray = result(
        "N*m",
        ("speed", "span"),
        "sum of magnitudes, or a larger total amplitude",
        printed=("element", "speed"),
    )
    turns: Fraction  # common cycle in revolutions of the reference station; 0 where lines have none

    @derived("revolutions of the reference after which all orders repeat, exact; null if none")
    def common_cycle_turns(self) -> Fraction | None:
        """The common cycle in revolutions, exact: text such as 21/8 in outputs."""
        return self.turns or None


@reported
class FrequencyPeak:
    """The largest torque of one element over the frequency."""

    component: str = result("name of the element")
    torque: float | None = result("N*m", "amplitude; null where one is not reliable")
    frequency: float | None = result("Hz", "where it stands")


@reported
class FrequencyResponse:
    """Complex amplitudes under the torques that act at every frequency, at one operating point."""

    frequency: FloatArray = result("Hz", "frequency", "ascending, refined around resonances")
    requested: np.ndarray = result(
        "", "frequency", "the frequency is one of those requested", key="is_asked"
    )
    sources: tuple[str, ...] = result("what excites")
    speed: float = result(
        "rad/s", "reference speed at which damping was taken; 0 if the file has none"
    )
    angle: ComplexArray = result(
        "rad",
        ("frequency", "station"),
        "complex amplitude at own speed; null if the status is not ok",
        printed=("frequency", "named station"),
        known_by="status",
    )
    torque: ComplexArray = result(
        "N*m",
        ("frequency", "span"),
        "complex amplitude, elastic and damping share together",
        printed=("frequency", "end span"),
        known_by="status",
    )
    residual: FloatArray = result("1", "frequency", "relative equilibrium residual")
    status: np.ndarray  # (frequencies,) uint8: kernels.tree_response.Status
    system: System = field(repr=False)  # as of `Response`
    remark: str = result("what the refinement of frequencies omitted", default="")
    balanced: Balanced | None = field(default=None, repr=False)  # None without nonlinear couplings
    following: Following | None = field(
        default=None, repr=False
    )  # None without a table over vibratory torque

    @property
    def points(self) -> FloatArray:
        """The speeds or frequencies (points,) at which it was computed."""
        return self.frequency

    @derived("largest torque of every elastic element")
    def peaks(self) -> tuple[FrequencyPeak, ...]:
        """Return the peaks, without a value where any amplitude is not reliable, which may be the largest."""
        is_known = bool(self.frequency.size) and bool((self.status == Status.OK).all())
        peaks = []
        for element in elements(self.system):
            peak = FrequencyPeak(element.name, None, None)
            if is_known:
                size = element.largest(np.abs(self.torque))
                worst = int(np.argmax(size))
                peak = replace(
                    peak, torque=float(size[worst]), frequency=float(self.frequency[worst])
                )
            peaks.append(peak)
        return tuple(peaks)

    @derived("", "frequency", "ok, near-singular or singular", key="status")
    def status_words(self) -> np.ndarray:
        """Words of the status (frequencies,) of the answer."""
        return words(self.status, Status)


def blocks(points: int, width: int, values: int = BLOCK_VALUES) -> Iterator[slice]:
    """Return the points in blocks, of `width` stations or spans each; one block for all but large trains."""
    length = max(values // max(width, 1), 1)
    return (slice(start, start + length) for start in range(0, max(points, 1), length))


def refuse_too_large(
    system: System, lines: int, limit: float, path: Path, axis: str, points: int
) -> None:
    """Raise InputError where a response of so many points needs more memory than `limit` (bytes).

    `path` is where the file gives the points, `axis` what they are.
    """
    stations = len(system.stations)
    spans = len(system.spans)
    needed = points * (COPIES * COMPLEX * lines * (stations + spans) + REAL * REAL_ROWS * spans)
    if needed <= limit:
        return
    count = f"up to {points} {axis} (those around resonances included) x {lines} orders x {stations} stations"
    message = f"the response has {count}, which needs about {needed / 1e9:.3g} GB; {limit / 1e9:.3g} GB are allowed"
    name, segments = max(system.segments.items(), key=lambda item: item[1], default=("", 1))
    finer = f", fewer segments of `{name}` ({segments})" if segments > 1 else ""
    hint = f"a narrower range or fewer steps, fewer orders{finer}, or --memory {1.1 * needed / 1e9:.2g}GB"
    raise InputError([Fault(path, message, hint)])


Result = TypeVar("Result", bound=Response | Synthesis | FrequencyResponse | Balanced | Following)
Block = TypeVar("Block", Balanced, Following)
SEVERAL = "{} several solutions from {:.5g} to {:.5g} {}; the results use the largest"
BY_BALANCE = (
    "backlash, friction or stages have",
    "harmonic balance failed at {} points: use a transient analysis",
)
BY_TABLE = (
    "a stiffness over vibratory torque has",
    "a stiffness over vibratory torque does not converge at {} points, which have no solution",
)


def merged(first: Result, second: Result, points: FloatArray, added: FloatArray) -> Result:
    """Return two results at the speeds or frequencies `points` and `added`, both ascending, as one.

    `first` stands where both have a point.
    """
    order = np.unique(np.concatenate([points, added]), return_index=True)[1]
    of_first = order < len(points)
    kept = slice(None) if np.count_nonzero(of_first) == len(points) else order[of_first]
    changed: dict[str, Any] = {}
    for key, value in vars(first).items():
        if isinstance(value, np.ndarray):
            changed[key] = np.empty((len(order), *value.shape[1:]), dtype=value.dtype)
            changed[key][of_first] = value[kept]
            changed[key][~of_first] = getattr(second, key)[order[~of_first] - len(points)]
        elif isinstance(value, Balanced | Following):
            changed[key] = merged(value, getattr(second, key), points, added)
    if isinstance(first, Response) and isinstance(second, Response):
        # Of fewer solutions the last stands for all.
        last = [(result.others or (result,))[-1] for result in (first, second)]
        alone = [replace(result, others=()) for result in last]
        pairs = zip_longest(first.others, second.others)
        changed["others"] = tuple(
            merged(a or alone[0], b or alone[1], points, added) for a, b in pairs
        )
    return replace(first, **changed)


def with_balance(response: Response | FrequencyResponse, factor: float, unit: str) -> str:
    """Return the remark on a response, with where its couplings have several solutions or none.

    The points are shown times `factor`, in `unit`.
    """
    words = [response.remark] if response.remark else []
    for block, (subject, failure) in (
        (response.balanced, BY_BALANCE),
        (response.following, BY_TABLE),
    ):
        if block is None:
            continue
        several = response.points[(block.number > 1).any(axis=1)] * factor
        if several.size:
            words.append(SEVERAL.format(subject, several[0], several[-1], unit))
        if lost := int(np.count_nonzero(~block.settled)):
            words.append(failure.format(lost))
    return "; ".join(words)


def joined(parts: Sequence[Block | None]) -> Block | None:
    """Return blocks of points one after another as one; None where there is none."""
    blocks = [part for part in parts if part is not None]
    if not blocks:
        return None
    rows: dict[str, Any] = {
        key: np.concatenate([getattr(block, key) for block in blocks])
        for key in vars(blocks[0])
        if key != "spans"
    }
    return replace(blocks[0], **rows)
