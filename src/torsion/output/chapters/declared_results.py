"""Chapter of an analysis that declares none: its results as they are declared, in the tables of data.zip."""

from typing import Any

import numpy as np

from torsion.analyses import Analysis
from torsion.findings import Findings
from torsion.output.blocks import Block, Column, Heading, Points, table
from torsion.output.files.data_tables import result_tables
from torsion.output.stored.scene import Selection
from torsion.results import is_declared, quantities

MOST_COLUMNS = 5  # of a table on the terminal


def chapter(analysis: Analysis, findings: Findings) -> list[Block]:
    """Return the single values of each result in one table, then arrays and records; an array of two axes is named."""
    selection = Selection(findings.system)
    names = {
        "station": [station.name for station in selection.system.stations],
        "span": [span.name for span in selection.system.spans],
        "element": [element.name for element in selection.elements],
    }
    blocks = list[Block]()
    for name in analysis.results:
        if (result := findings.results.get(name)) is None:
            continue
        single, named = list[tuple[Any, ...]](), list[str]()
        for quantity in quantities(type(result)):
            value = getattr(result, quantity.name)
            if np.ndim(value) > 1:
                shape = " by ".join(map(str, np.shape(value)))
                key = f"`{name}.{quantity.key}`"
                named.append(f"{quantity.meaning}: {shape} values, {key} of results.json")
            elif np.ndim(value) == 0 and not is_declared(value):
                words = quantity.name.replace("_", " ")
                single.append((words, value, quantity.unit, quantity.meaning))
        if single:
            titles = "< Quantity -> | Value -> | < Unit -> | < Meaning"
            blocks.append(table(titles, single, f"Single values of {name}", short=name))
        for values in result_tables(name, result, selection):
            columns = tuple(
                Column(key, short=key * (number < MOST_COLUMNS))
                for number, key in enumerate(values.columns)
            )
            rows = values.rows
            if len(places := names.get(values.columns[0], ())) == len(rows):
                rows = tuple((place, *row[1:]) for place, row in zip(places, rows, strict=True))
            blocks.append(table(columns, rows, f"Values of {values.name}", short=values.name))
        if named:
            blocks.append(Points(tuple(named)))
    return [Heading(analysis.title[:1].upper() + analysis.title[1:]), *blocks] if blocks else []
