"""The sliders of `torsion live`: one for every figure, or figures together, of a file that may vary."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from torsion.errors import Fault, InputError
from torsion.schema.overlay import in_words
from torsion.schema.variation import Variation
from torsion.schema.varied_figures import Figure
from torsion.study import Study

STEPS = 100  # of a slider without steps of its own, about


@dataclass(frozen=True)
class Slider:
    """Figures that vary as one, and the positions of their slider: a value, or the number of one."""

    name: str
    figures: tuple[Figure, ...]
    low: float
    high: float
    step: float

    @property
    def nominal(self) -> float | None:
        """The position that is the file as it stands; None where there is none."""
        first = self.figures[0]
        places = (
            np.flatnonzero(np.isclose(first.all_values(), first.nominal)) if first.places else None
        )
        if places is not None:
            return float(places[0]) if places.size else None
        return None if math.isnan(first.nominal) else first.nominal

    def value(self, position: float) -> float:
        """Return the value of its figures at a position; raises InputError where it has no such position."""
        slack = 1e-6 * self.step  # of decimals
        if not self.low - slack <= position <= self.high + slack:
            message = f"the slider '{self.name}' goes from {self.low:g} to {self.high:g}"
            raise InputError([Fault((), message)], message)
        first = self.figures[0]
        return float(first.all_values()[round(position)]) if first.places else position


def sliders_of(variation: Variation) -> dict[str, Slider]:
    """Return the sliders of a file by their names."""
    columns: dict[int, list[Figure]] = {}
    for figure in variation.figures:
        columns.setdefault(figure.column, []).append(figure)
    return {slider.name: slider for slider in map(_slider, columns.values())}


def _slider(figures: list[Figure]) -> Slider:
    name, first = ", ".join(figure.name for figure in figures), figures[0]
    if first.places:
        return Slider(name, tuple(figures), 0.0, first.places - 1.0, 1.0)
    low, high = np.sort(first.ends).tolist()
    digits = 1 - math.floor(math.log10((high - low) / STEPS))
    step = 10.0 ** (1 - digits)
    ends = math.ceil(low / step - 0.01) * step, math.floor(high / step + 0.01) * step
    return Slider(
        name, tuple(figures), round(ends[0], max(digits, 0)), round(ends[1], max(digits, 0)), step
    )


def moved_study(study: Study, variation: Variation, positions: Mapping[str, float]) -> Study:
    """Return the study with its sliders at these positions; the others are as in the file. Raises InputError."""
    figures, values = at_positions(variation, positions)
    return (
        replace(replace(variation, figures=figures).study(values), case=study.case)
        if figures
        else study
    )


def at_positions(
    variation: Variation, positions: Mapping[str, float]
) -> tuple[tuple[Figure, ...], tuple[float, ...]]:
    """Return the figures whose sliders are moved, and their values."""
    sliders, pairs = sliders_of(variation), list[tuple[Figure, float]]()
    for name, position in positions.items():
        if name not in sliders:
            message = f"the file has no figure '{name}' that may vary"
            raise InputError([Fault((), message)], message)
        value = sliders[name].value(position)
        pairs += [(figure, value) for figure in sliders[name].figures]
    return tuple(figure for figure, _ in pairs), tuple(value for _, value in pairs)


def shown(variation: Variation, positions: Mapping[str, float]) -> list[dict[str, Any]]:
    """Return every slider as the page shows it, with the figure of the file in words."""
    sliders = []
    for name, slider in sliders_of(variation).items():
        position = positions.get(name, slider.nominal)
        sliders.append(
            {
                "name": name,
                "low": slider.low,
                "high": slider.high,
                "step": slider.step,
                "nominal": slider.nominal,
                "now": slider.low if position is None else position,
                "moved": name in positions,
                "text": _words(slider, positions.get(name), variation),
            }
        )
    return sliders


def _words(slider: Slider, position: float | None, variation: Variation) -> str:
    """Return what the file states, or would state with the slider at a position."""
    first = slider.figures[0]
    if position is None:
        nominal_node = variation.source.at(first.paths[0][0]) if first.paths else None
        return "as in the file" if nominal_node is None else in_words(nominal_node.value)
    value = slider.value(position)
    if first.rows:
        return first.words(value)
    _, node = next(first.puts(value, variation.source))
    share = f" ({100.0 * (value - 1.0):+.3g} %)" if first.law.first is None else ""
    return f"{in_words(node.value)}{share}"
