"""The system kept in factors: stations, spans and their data; and the tree, in one speed, that the sweeps run over.

With theta = ratio * q an inertia becomes J ratio^2, a flexibility h/ratio^2 at the ratio of its driving station, and a
rigid gear a rigid span: products only, so nothing is lost. The softest spans that close a loop are left over.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from torsion.arrays import BoolArray, FloatArray, IntArray
from torsion.errors import Fault, InputError
from torsion.kernels.trees.tree import Tree, closing_no_loop, connected, walk
from torsion.primitives import Bar, Damper, Station
from torsion.train import Train, fixed_point_faults

if TYPE_CHECKING:
    from torsion.assembly.distributed_spans import BarSpans
    from torsion.kernels.distributed.span_laws import Shafts
    from torsion.kernels.stiffness_laws import StiffnessTable


NOTHING = 1e-10  # of the largest torque of the train: what cancels to less is 0


@dataclass(frozen=True)
class Discretisation:
    """What was requested of the shafts: highest frequencies and, of the model `fem`, degree and number of elements."""

    frequency: float = 0.0  # Hz
    degree: int | None = None  # None: what the frequency needs
    elements: int | None = None  # of every shaft; None: what the frequency needs
    excited: float = 0.0  # Hz, of a response: the models `fem` and `exact` read its torques at the ends of pieces


@dataclass(frozen=True, slots=True)
class Span:
    """An elastic or rigid piece between two stations, or a mesh or joint."""

    name: str
    part: int
    driving: int
    driven: int
    ratio: Fraction = Fraction(1)  # speed of the driven / speed of the driving station
    error: tuple[
        tuple[int, complex], ...
    ] = ()  # of the driven angle, over the driving station's angle


@dataclass(frozen=True, slots=True)
class Row:
    """A shaft in segments: the rule for the stations between them and for their spans."""

    bar: Bar
    number: int  # of segments
    inside: int  # position of the first station between segments
    begin: Station  # at the driving end

    @property
    def stations(self) -> IntArray:
        """(number + 1,) positions of all stations, from the driving to the driven one."""
        ends = np.arange(self.inside - 1, self.inside + self.number, dtype=np.int64)
        ends[0], ends[-1] = self.bar.driving, self.bar.driven
        return ends


@dataclass(frozen=True)
class CondensedTrain:
    """A tree of the train's stations and spans in one speed."""

    tree: Tree
    node: IntArray  # (stations,) tree station of each station
    span: IntArray  # (spans,) tree station below each span; -1 where the span closes a loop or doubles another
    # (spans,) 1 where the driving station is the parent, -1 where the driven one is.
    sign: FloatArray
    extra: IntArray  # (extra,) spans that close loops
    viscous: FloatArray  # (tree stations,) N m s/rad of each tree span, referred
    loss_factor: FloatArray  # (tree stations,)


@dataclass(frozen=True, repr=False)
class System:
    """A train assembled. Twist of a span = driving angle - driven angle / its ratio; its torque is positive when the
    driving side pushes the driven one, and is reported at the driving station's speed."""

    train: Train
    model: str
    stations: tuple[Station, ...]
    spans: tuple[Span, ...]
    inertia: FloatArray  # (stations,) kg m2 at own speed; infinite where fixed; half of each piece of a shaft included
    # (spans,) rad/(N m) at the driving station's speed; 0 rigid, inf viscous only.
    flexibility: FloatArray
    viscous: FloatArray  # (spans,) N m s/rad
    loss_factor: FloatArray  # (spans,)
    dampers: tuple[Damper, ...]
    segments: dict[str, int]  # of every shaft, by name: segments, elements or pieces
    bars: "BarSpans | None" = None  # of the models `fem` and `exact`, where a shaft has inertia
    rows: tuple[
        Row, ...
    ] = ()  # shafts in segments, whose inner stations and spans come last, row by row
    requested: Discretisation = Discretisation()
    resolved_to: float = (
        math.inf
    )  # Hz, up to which the shafts keep the error of their model; see `assemble`
    tables: "Mapping[int, StiffnessTable]" = field(
        default_factory=dict
    )  # of spans that follow one: `tabled_spans`

    def __repr__(self) -> str:
        return f"System: {self.model}, {len(self.stations)} stations, {len(self.spans)} spans"

    @property
    def own_spans(self) -> tuple[Span, ...]:
        """The spans that are no segments of a row; they come first."""
        return self.spans[: len(self.spans) - sum(row.number for row in self.rows)]

    @cached_property
    def speed_ratio(self) -> FloatArray:
        """(stations,) speed of each station / reference speed."""
        return np.array([float(station.ratio) for station in self.stations])

    @cached_property
    def station_part(self) -> IntArray:
        """(stations,) the component that made each station, as a position in the train's parts."""
        return np.array([station.part for station in self.stations], dtype=np.int64)

    @cached_property
    def span_part(self) -> IntArray:
        """(spans,) the component that made each span."""
        return np.array([span.part for span in self.spans], dtype=np.int64)

    @cached_property
    def span_ratio(self) -> FloatArray:
        """(spans,) speed at which each span's torque is reported / reference speed."""
        return self.speed_ratio[self.driving]

    def twist(self, referred: np.ndarray) -> np.ndarray:
        """(spans, columns) twist of every span at its driving station's speed: driving - driven angle / ratio.

        referred: (stations, columns) angles referred to the reference speed.
        """
        return np.asarray(
            (referred[self.driving] - referred[self.driven]) * self.span_ratio[:, None]
        )

    @cached_property
    def driving(self) -> IntArray:
        """(spans,) driving station of each span."""
        return np.array([span.driving for span in self.spans], dtype=np.int64)

    @cached_property
    def driven(self) -> IntArray:
        """(spans,) driven station of each span."""
        return np.array([span.driven for span in self.spans], dtype=np.int64)

    @cached_property
    def held(self) -> BoolArray:
        """(stations,) where the station turns at exactly its mean speed."""
        return np.isinf(self.inertia)

    @cached_property
    def uneven_joints(self) -> IntArray:
        """(joints,) spans of joints that turn unevenly."""
        spans = [number for number, span in enumerate(self.own_spans) if span.error]
        return np.array(spans, dtype=np.int64)

    @cached_property
    def condensed(self) -> CondensedTrain:
        """The train referred to one speed, as a tree, and the spans that close loops.

        Raises InputError where rigid spans close a loop or join two fixed stations. Where rigid spans lead to several
        fixed stations of one part of the train, each of these is a root of its own, and the softest spans between them
        are left over as those that close a loop (through ground).
        """
        flexibility = self.flexibility / self.span_ratio**2
        nodes, driving, driven, copies, roots, anchors = _split_held(self)
        chosen = np.ones(len(flexibility), dtype=bool)
        way = walk(nodes, driving, driven, chosen, roots)
        has_loops = len(flexibility) > np.count_nonzero(way.parent >= 0)
        if anchors or has_loops:
            # The stiffest spans that close no loop and join no two anchors; those of `links` last.
            is_link = np.array([part.path[0] == "links" for part in self.train.parts])
            ranked = np.lexsort((is_link[self.span_part], flexibility))
            chosen = closing_no_loop(nodes, driving, driven, ranked, anchors)
            rigid = ranked[~chosen[ranked] & (flexibility[ranked] == 0)]
            if rigid.size:
                part = self.train.parts[self.span_part[rigid[0]]]
                key = () if part.ratings is None else ("flexibility",)  # a rigid coupling says so
                message = f"'{part.name}' is rigid and closes a loop of rigid links, whose torques nothing divides"
                loop = Fault((*part.path, *key), message, "give it a stiffness, or leave it out")
                raise InputError(fixed_point_faults(self.train) or [loop])
            way = walk(nodes, driving, driven, chosen, roots)

        # The tree is numbered from its roots to its leaves.
        stations, order, number = len(self.stations), way.order, len(way.order)
        tree_station = np.argsort(order)
        parent, above = way.parent[order], way.above[order]
        node = np.flatnonzero(above >= 0)
        span = above[node]
        flexible, viscous, loss = elastic = np.zeros((3, number))
        referred = np.array([flexibility, self.viscous * self.span_ratio**2, self.loss_factor])
        elastic[:, node] = referred[:, span]
        span_node = np.full(len(flexibility), -1, dtype=np.int64)
        span_node[span] = node
        source = np.append(np.arange(stations), np.array(copies, dtype=np.int64))[order]
        inertia = (self.lumped_inertia * self.speed_ratio**2)[source]
        parent = np.where(parent >= 0, tree_station[parent], -1)
        tree = Tree(parent, flexible, inertia, self.held[source])
        sign = np.where(tree_station[driven] == span_node, 1.0, -1.0)
        return CondensedTrain(
            tree, tree_station[:stations], span_node, sign, np.flatnonzero(~chosen), viscous, loss
        )

    @cached_property
    def lumped_inertia(self) -> FloatArray:
        """(stations,) kg m2 at own speed, without that of spans with distributed inertia; infinite where fixed."""
        return self.inertia if self.bars is None else self.bars.lumped

    @cached_property
    def condensed_shafts(self) -> "Shafts | None":
        """The spans with distributed inertia, on the tree; None where there are none."""
        bars, condensed = self.bars, self.condensed
        if bars is None:
            return None
        return bars.laws(
            condensed.span[bars.span], self.span_ratio[bars.span], condensed.sign[bars.span] < 0
        )

    @cached_property
    def damps(self) -> bool:
        """Anything in the train takes energy out."""
        given = any(self.train.modal_damping) or any(table.damps for table in self.tables.values())
        acts = np.any(self.viscous > 0) or np.any(self.loss_factor > 0)
        return given or bool(self.dampers) or bool(acts)

    def tables_over(self, over: str) -> "dict[int, StiffnessTable]":
        """The tables over frequency, mean or vibratory torque, by span."""
        return {span: table for span, table in self.tables.items() if table.over == over}

    def elastic(
        self,
        span: int,
        w: FloatArray,
        mean: FloatArray | None = None,
        speed: FloatArray | None = None,
    ) -> tuple[FloatArray | float, FloatArray | float]:
        """Stiffness (N m/rad) and loss modulus k eta + w c of a span at w (rad/s), any shape; by its table if any.

        mean: N m of that span that its table may be over, mean or vibratory; speed: rad/s of the reference; each of a
        shape that goes with w.
        """
        x = self.followed(span, w, mean, speed)
        if x is None:
            h, loss, viscous = (
                values[span] for values in (self.flexibility, self.loss_factor, self.viscous)
            )
            if h.ndim:  # a column for each point
                h, loss, viscous = (
                    values.reshape(-1, *(1,) * (w.ndim - 1)) for values in (h, loss, viscous)
                )
            return 1.0 / h, loss / h + w * viscous
        stiffness = self.tables[span].complex_stiffness(x, w)
        return stiffness.real, stiffness.imag

    def followed(
        self, span: int, w: FloatArray, mean: FloatArray | None, speed: FloatArray | None
    ) -> FloatArray | None:
        """What the table of a span is over, of the shape of w; None without a table, or where that is not known."""
        table = self.tables.get(span)
        if table is None or table.over == "frequency":
            return None if table is None else w
        if table.over == "speed":
            return (
                None if speed is None else np.broadcast_to(speed * self.span_ratio[span], w.shape)
            )
        return None if mean is None else np.broadcast_to(np.abs(mean), w.shape)

    def modal_ratios(self, modes: int) -> FloatArray:
        """(modes,) damping ratios given by mode, the last of them for all above; 0 where none is given."""
        given = self.train.modal_damping or (0.0,)
        return np.array([*given, *[given[-1]] * modes][:modes])

    def ground_damping(
        self, speed: FloatArray, mean_torque: FloatArray, load_slope: FloatArray | None = None
    ) -> FloatArray:
        """(stations, speeds) N m s/rad, at reference speeds (rad/s) and mean torques (stations, speeds) N m applied.

        load_slope: (stations, speeds) N m s/rad of the laws of load, where a damping follows them.
        """
        damping = np.zeros((len(self.stations), len(speed)))
        for damper in self.dampers:
            own_speed = speed * self.speed_ratio[damper.station]
            row = damper.constant + damper.speed_factor * own_speed
            if damper.torque_factor:
                row = row + damper.torque_factor * np.abs(mean_torque[damper.station]) / own_speed
            if damper.load_factor and load_slope is not None:
                row = row + damper.load_factor * load_slope[damper.station]
            damping[damper.station] += row
        return damping


def _split_held(
    system: System,
) -> tuple[int, IntArray, IntArray, list[int], list[int], list[int]]:
    """A fixed station stays the root of its train once; every other fixed station becomes one leaf a span.

    One with a single span is a root or a leaf as it is. A rigid span can only lead away from a root. Number of stations
    and copies; driving and driven end of every span; the fixed station that each further node copies; fixed stations
    (no ground) to walk from, in this order; those that rigid spans join to one part, where there are several.
    """
    driving, driven = system.driving.copy(), system.driven.copy()
    number = len(system.stations)
    if not system.held.any():
        return number, driving, driven, [], [], []
    free = ~system.held[driving] & ~system.held[driven]
    group = connected(
        number, driving[free], driven[free]
    )  # stations joined without passing through a fixed one
    held = np.flatnonzero(system.held).tolist()

    # Of every fixed station: 0 as its driving end or 1, span, station at the other end, of every span.
    sides = (0, system.driving, system.driven), (1, system.driven, system.driving)
    touching = {
        station: [
            (side, span, int(far[span]))
            for side, near, far in sides
            for span in np.flatnonzero(near == station).tolist()
        ]
        for station in held
    }

    # The first fixed station that a rigid span joins to each group, and the anchors.
    root, anchors = dict[int, int](), set[int]()
    for station, spans in touching.items():
        for _, span, neighbour in spans:
            if system.flexibility[span] == 0:
                first = neighbour
                if not system.held[neighbour]:
                    first = root.setdefault(int(group[neighbour]), station)
                anchors |= {first, station} if first != station else set()
    copies: list[int] = []
    for station in held:
        is_ground = system.stations[station].is_ground
        for side, span, neighbour in touching[station] if len(touching[station]) > 1 else []:
            near, far = (driving, driven) if side == 0 else (driven, driving)
            is_between = bool(system.held[neighbour]) and far[span] < number
            is_elsewhere = root.get(int(group[neighbour]), station) != station
            if system.flexibility[span] > 0 and (is_ground or is_between or is_elsewhere):
                near[span] = number + len(copies)
                copies.append(station)
        if not is_ground:
            for _, _, neighbour in touching[station]:
                root.setdefault(int(group[neighbour]), station)
    free_of_ground = (station for station in held if not system.stations[station].is_ground)
    roots = list(dict.fromkeys([*root.values(), *free_of_ground]))
    return number + len(copies), driving, driven, copies, roots, sorted(anchors)
