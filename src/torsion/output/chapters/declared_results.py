"""Chapter of an analysis that declares none: its results as they are declared, short arrays as tables by axis."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from torsion.analyses import Analysis
from torsion.findings import Findings
from torsion.output.blocks import Block, Column, Heading, Points, Table, table, texts
from torsion.output.plain import shown
from torsion.output.selection import Selection
from torsion.results import Quantity, is_declared, quantities

MOST_ROWS = 60  # of a table; a longer array is named with its key of results.json
MOST_COLUMNS = 5  # of a table on the terminal


def chapter(analysis: Analysis, findings: Findings) -> list[Block]:
    """Return the blocks of an analysis; none if none of its results was found."""
    chosen = Selection(findings.system)
    results = [(name, findings.results.get(name)) for name in analysis.results]
    blocks = [
        block for name, held in results if held is not None for block in _blocks(name, held, chosen)
    ]
    return [Heading(analysis.title[:1].upper() + analysis.title[1:]), *blocks] if blocks else []


def _blocks(path: str, held: Any, chosen: Selection) -> Iterator[Block]:
    """Yield single values in one table, arrays in one for each axis, then the inner results."""
    single: list[tuple[Any, ...]] = []
    arrays: dict[tuple[str, int], list[tuple[Quantity, Any]]] = {}
    left, inner = list[str](), list[tuple[str, Any]]()
    for quantity in quantities(type(held)):
        value, key = (
            shown(held, quantity, chosen),
            f"{path}.{quantity.key}" if quantity.key else path,
        )
        if is_declared(value):
            inner.append((key, value))
        elif (
            isinstance(value, list | tuple)
            and value
            and all(is_declared(record) for record in value)
        ):
            inner += [(f"{key}[{k}]", record) for k, record in enumerate(value)]
        elif np.ndim(value) == 1 and quantity.printed and len(value) <= MOST_ROWS:
            arrays.setdefault((quantity.printed[0], len(value)), []).append((quantity, value))
        elif np.ndim(value):
            left.append(
                f"{quantity.meaning}: {' by '.join(map(str, np.shape(value)))} values, `{key}` of results.json"
            )
        else:
            single.append((quantity.name.replace("_", " "), value, quantity.unit, quantity.meaning))
    if single:
        titles = "< Quantity -> | Value -> | < Unit -> | < Meaning"
        yield table(titles, single, f"Single values of {path}", short=path)
    for (axis, count), columns in arrays.items():
        yield _table(path, _names(axis, count, chosen), columns)
    if left:
        yield Points(tuple(left))
    for inner_path, value in inner[:MOST_ROWS]:
        yield from _blocks(inner_path, value, chosen)


def _table(path: str, names: list[str], columns: list[tuple[Quantity, Any]]) -> Table:
    """Return quantities over one axis, a row each place of it."""
    axis = columns[0][0].printed[0]
    heads = [texts(axis.capitalize(), axis)]
    for number, (quantity, _) in enumerate(columns, start=2):
        heads.append(
            Column(
                quantity.meaning,
                quantity.unit,
                short=quantity.key if number <= MOST_COLUMNS else "",
            )
        )
    rows = [
        (name, *(values[position] for _, values in columns)) for position, name in enumerate(names)
    ]
    return table(tuple(heads), rows, f"Values of {path} by {axis}", short=f"{path} by {axis}")


def _names(axis: str, count: int, chosen: Selection) -> list[str]:
    """Return the names of stations, spans and elements at the places of an axis, else numbers."""
    stations = [chosen.system.stations[k].name for k in chosen.groups.stations.tolist()]
    names_by_axis = {
        "station": stations,
        "span": chosen.groups.names(),
        "element": [element.name for element in chosen.elements],
    }
    names = names_by_axis.get(axis, [])
    return names if len(names) == count else [str(k) for k in range(1, count + 1)]
