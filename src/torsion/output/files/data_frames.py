"""Results as columns: a dictionary of lists, or a data frame of pandas, by the keys of results.json."""

from typing import TYPE_CHECKING, Any

import numpy as np

from torsion.analyses.response.amplitudes import Response, SpanTorque
from torsion.output.stored.results_json import listed, plain
from torsion.output.stored.scene import Selection
from torsion.results import RPM, quantities
from torsion.rules.verdict_line import Checks

if TYPE_CHECKING:
    import pandas

TRAIN_AXES = {"station", "span"}


def dictionary(result: Any) -> dict[str, Any]:
    """Return a result as results.json has it; of a list of records the columns. Raises TypeError without its train."""
    system: Any = getattr(result, "system", None)
    axes = {axis for quantity in quantities(type(result)) for axis in quantity.axes}
    if system is None and TRAIN_AXES & axes:
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

    columns: dict[str, Any]
    if isinstance(result, Response | SpanTorque):
        if isinstance(result, SpanTorque):
            columns, orders = {"torque_Nm": result.torque}, list(result.orders)
        else:  # in every component too
            orders = [line.order for line in result.lines]
            columns = {
                quantity.key: getattr(result, quantity.name)
                for quantity in quantities(Response)
                if quantity.axes == ("speed", "line")
            }
            for element in Selection(result.system).elements:
                columns[f"torque_Nm of {element.name}"] = result[element.name].torque
        # Orders are per revolution of the reference; a fixed frequency has none.
        per_revolution = [float("nan") if order is None else float(order) for order in orders]
        index = pandas.MultiIndex.from_product(
            [result.speed * RPM, per_revolution], names=["speed_rpm", "order"]
        )
        return pandas.DataFrame({key: np.ravel(values) for key, values in columns.items()}, index)

    if isinstance(result, Checks):
        axis = "check"
        columns = {
            key: cells
            for key, cells in dictionary(result).items()
            if not any(isinstance(cell, list | dict) for cell in cells)
        }
    else:
        arrays = [quantity for quantity in quantities(type(result)) if quantity.axes]
        axis = arrays[0].axes[0] if arrays else ""
        columns = {
            quantity.key: getattr(result, quantity.name)
            for quantity in arrays
            if quantity.axes == (axis,)
        }
        if len(columns) < (1 if axis == "mode" else 2):  # the first numbers the rows
            raise TypeError(f"{type(result).__name__} has no rows: use `findings.to_dict()`")
    frame = pandas.DataFrame(columns)
    if axis in ("check", "mode"):
        return frame.set_index(pandas.RangeIndex(1, 1 + len(frame), name=axis))
    return frame.set_index(frame.columns[0])
