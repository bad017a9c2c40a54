"""Chapter of an analysis that declares none: its results as they are declared, in the tables of data.zip."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from torsion.analyses import Analysis
from torsion.findings import Findings
from torsion.output.blocks import Block, Column, Heading, Points, table
from torsion.output.data_tables import result_tables
from torsion.output.scene import Selection
from torsion.results import is_declared, quantities

MOST_COLUMNS = 5  # of a table on the terminal


def chapter(analysis: Analysis, findings: Findings) -> list[Block]:
    """Return the blocks of an analysis; none if none of its results was found."""
    selection = Selection(findings.system)
    results = [(name, findings.results.get(name)) for name in analysis.results]
    blocks = [
        block
        for name, result in results
        if result is not None
        for block in _blocks(name, result, selection)
    ]
    return [Heading(analysis.title[:1].upper() + analysis.title[1:]), *blocks] if blocks else []


def _blocks(name: str, result: Any, selection: Selection) -> Iterator[Block]:
    """Yield the single values in one table, then arrays and records; an array of two axes is named."""
    single, named = list[tuple[Any, ...]](), list[str]()
    for quantity in quantities(type(result)):
        value = getattr(result, quantity.name)
        if np.ndim(value) > 1:
            shape = " by ".join(map(str, np.shape(value)))
            named.append(
                f"{quantity.meaning}: {shape} values, `{name}.{quantity.key}` of results.json"
            )
        elif np.ndim(value) == 0 and not is_declared(value):
            single.append((quantity.name.replace("_", " "), value, quantity.unit, quantity.meaning))
    if single:
        titles = "< Quantity -> | Value -> | < Unit -> | < Meaning"
        yield table(titles, single, f"Single values of {name}", short=name)

    names = {
        "station": [station.name for station in selection.system.stations],
        "span": [span.name for span in selection.system.spans],
        "element": [element.name for element in selection.elements],
    }
    for values in result_tables(name, result, selection):
        columns = tuple(
            Column(key, short=key * (number < MOST_COLUMNS))
            for number, key in enumerate(values.columns)
        )
        rows = values.rows
        if len(places := names.get(values.columns[0], ())) == len(rows):
            rows = tuple((place, *row[1:]) for place, row in zip(places, rows, strict=True))
        yield table(columns, rows, f"Values of {values.name}", short=values.name)
    if named:
        yield Points(tuple(named))
