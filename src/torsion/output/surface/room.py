"""Room for the axes of a train: which places beside each other leave every body clear of all others."""

import math
from collections.abc import Iterator, Sequence

import numpy as np

Place = tuple[float, float]  # m, y and z of an axis along x
Box = tuple[float, float, float]  # from x, to x, radius: m
SIDES = tuple((math.cos(k * math.pi / 4), math.sin(k * math.pi / 4)) for k in (6, 2, 0, 4, 7, 5, 1, 3))  # below first
GROWTH = 1.15  # of a distance, until nothing overlaps


def sides(start: Place, distance: float) -> Iterator[Place]:
    """Places at a distance, below first."""
    return ((start[0] + distance * y, start[1] + distance * z) for y, z in SIDES)


class Room:
    """What is filled already; bodies of one axis never overlap."""

    def __init__(self, clearance: float, least: float) -> None:
        self.clearance, self.least = clearance, least  # m: between bodies; distance of two axes
        self._places: list[Place] = []
        self._boxes: list[Box] = []
        self._axes: list[int] = []

    def copy(self) -> "Room":
        """Another room, filled alike."""
        other = Room(self.clearance, self.least)
        other._places, other._boxes, other._axes = list(self._places), list(self._boxes), list(self._axes)
        return other

    def fill(self, axis: int, place: Place, boxes: Sequence[Box]) -> None:
        """Bodies of an axis now stand there."""
        self._axes.extend([axis] * len(boxes))
        self._places.extend([place] * len(boxes))
        self._boxes.extend(boxes)

    def is_free(self, axis: int, place: Place, boxes: Sequence[Box]) -> bool:
        """None of the bodies of an axis would overlap with what is there."""
        if not self._boxes or not boxes:
            return True
        mine, there = np.array(boxes), np.array(self._boxes)
        distance = np.hypot(*(np.array(self._places) - place).T)
        near = 1e-6 * self.clearance  # two that only touch are not beside each other
        beside = (mine[:, None, 0] < there[:, 1] - near) & (there[:, 0] < mine[:, None, 1] - near)
        apart = (distance >= mine[:, None, 2] + there[:, 2] + self.clearance) | (np.array(self._axes) == axis)
        return not np.any(beside & ~apart)

    def free(self, axis: int, start: Place, boxes: Sequence[Box]) -> Place:
        """The nearest place beside `start` where nothing overlaps."""
        distance = self.least
        while True:
            for place in sides(start, distance):
                if self.is_free(axis, place, boxes):
                    return place
            distance *= GROWTH
