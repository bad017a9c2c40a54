"""Results as columns: a dictionary of lists, or a data frame of pandas, by the keys of results.json."""

from typing import TYPE_CHECKING, Any

import numpy as np

from torsion.analyses.response.amplitudes import Response, SpanTorque
from torsion.output.plain import plain
from torsion.output.results_json import listed
from torsion.output.selection import Selection
from torsion.results import RPM, quantities
from torsion.rules.verdict_line import Checks

if TYPE_CHECKING:
    import pandas

TRAIN_AXES = {"station", "span"}


def dictionary(result: Any) -> dict[str, Any]:
    """Return a result as results.json has it; of a list of records the columns. Raises TypeError without its train."""
    system: Any = getattr(result, "system", None)
    if system is None and any(
        TRAIN_AXES & {*quantity.axes} for quantity in quantities(type(result))
    ):
        name = type(result).__name__
        raise TypeError(
            f"{name} does not hold the train: use `findings.to_dict()`, which has all results"
        )
    values = listed(plain(result, Selection(system)))
    if isinstance(values, list):
        return {key: [row[key] for row in values] for key in (values[0] if values else ())}
    columns: dict[str, Any] = values
    return columns


def data_frame(result: Any) -> "pandas.DataFrame":
    """Return a row for each mode, check, or speed and order; raises ImportError without pandas."""
    try:
        import pandas
    except ImportError:
        raise ImportError("to_dataframe needs pandas: pip install pandas") from None
    if isinstance(result, Response | SpanTorque):
        index = pandas.MultiIndex.from_product(
            [result.speed * RPM, _orders(result)], names=["speed_rpm", "order"]
        )
        columns = _over_speed_and_order(result)
        return pandas.DataFrame(
            {key: np.ravel(values) for key, values in columns.items()}, index=index
        )
    if isinstance(result, Checks):
        records = dictionary(result)
        plain_keys = [
            key
            for key, column in records.items()
            if not any(isinstance(cell, list | dict) for cell in column)
        ]
        columns = {key: records[key] for key in plain_keys}
        return pandas.DataFrame(
            columns, index=pandas.RangeIndex(1, 1 + len(result.lines), name="check")
        )
    axis = next((quantity.axes[0] for quantity in quantities(type(result)) if quantity.axes), None)
    if axis is None:
        raise TypeError(f"{type(result).__name__} has no rows: use `to_dict()`")
    columns = {
        quantity.key: getattr(result, quantity.name)
        for quantity in quantities(type(result))
        if quantity.axes == (axis,)
    }
    frame = pandas.DataFrame(columns)
    if axis == "mode":
        return frame.set_index(pandas.RangeIndex(1, 1 + len(frame), name=axis))
    return frame.set_index(frame.columns[0])


def _orders(result: Response | SpanTorque) -> list[float]:
    """Orders per revolution of the reference; NaN of a fixed frequency."""
    orders = (
        result.orders if isinstance(result, SpanTorque) else [line.order for line in result.lines]
    )
    return [float("nan") if order is None else float(order) for order in orders]


def _over_speed_and_order(result: Response | SpanTorque) -> dict[str, Any]:
    """Return (speeds, orders) of every key over both, and of a response the torque in every component."""
    if isinstance(result, SpanTorque):
        return {"torque_Nm": result.torque}
    columns = {
        quantity.key: getattr(result, quantity.name)
        for quantity in quantities(Response)
        if quantity.axes == ("speed", "line")
    }
    names = [element.name for element in Selection(result.system).elements]
    return columns | {f"torque_Nm of {name}": result[name].torque for name in names}
