"""Every number of every table of the report is a declared result, in the unit of its column and to its digits.

A column of declared quantities reads them from their records. Any other column names here the key of results.json that
its figures come from; a column that names none fails.
"""

import math
import re
from collections.abc import Callable, Iterable, Iterator
from typing import Any

import numpy as np
from tests.contracts.frozen import solved, written
from tests.contracts.printed import SLACK, Interval, Row, printed, rows

from torsion.analyses.response.component_loads import NOTHING
from torsion.output.blocks import Column, Table
from torsion.output.chapters import chapters
from torsion.output.numbers import ROUNDING

Found = dict[str, Any]
Values = Callable[[Found, Row], Iterable[Any]]
SI = {
    "rpm": math.pi / 30.0,
    "deg": math.pi / 180.0,
    "%": 0.01,
    "1/min": 1.0 / 60.0,
    "N/mm²": 1e6,
    "µm": 1e-6,
    "mm": 1e-3,
    "kN m": 1e3,
    "MN m": 1e6,
    "kW": 1e3,
    "kN": 1e3,
    "bar": 1e5,
    "ms": 1e-3,
    "deg/min": math.pi / 180.0 / 60.0,
    "cm²": 1e-4,
}
NUMBER = re.compile(r"[−\d][\d.·⁻⁰¹²³⁴⁵⁶⁷⁸⁹]*")
PAIR = re.compile(r"(\S+) / (?:≥ )?(\S+)")
FRACTION = re.compile(r"(\d+)/(\d+) ≈ .*")


def at(found: Any, path: str) -> Iterator[Any]:
    """Everything that stands at a path, `[]` for every element of a list, nested lists laid out."""
    step, _, rest = path.partition(".")
    name = step.removesuffix("[]")
    inner = found.get(name) if isinstance(found, dict) else None
    for one in inner if step.endswith("[]") and isinstance(inner, list) else [inner]:
        if rest and one is not None:
            yield from at(one, rest)
        elif one is not None:
            yield from flat(one)


def flat(value: Any) -> Iterator[Any]:
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if isinstance(value, list):
        for one in value:
            yield from flat(one)
    elif value is not None and not (isinstance(value, float) and not math.isfinite(value)):
        yield value


def key(*paths: str, times: float = 1.0) -> Values:
    """Any value at these keys."""
    return of_every_row(
        lambda found: (as_number(one) * times for path in paths for one in at(found, path))
    )


def of_every_row(values: Callable[[Found], Iterable[float]]) -> Values:
    """The same for all rows: gathered once of the results that were asked for last."""
    last: list[Any] = [None, ()]

    def gathered(found: Found, row: Row) -> np.ndarray:
        if last[0] is not found:
            last[:] = found, numbers(values(found))
        return last[1]

    return gathered


def numbers(values: Iterable[Any]) -> np.ndarray:
    return np.array([as_number(one) for one in values if one is not None], dtype=float)


def as_number(value: Any) -> float:
    """A number, or an exact one that is stated as text."""
    if isinstance(value, str):
        above, _, below = value.partition("/")
        return float(above) / float(below or 1)
    return float(value)


def of_cases(*paths: str, how: Callable[[list[Any]], Iterable[Any]] = iter) -> Values:
    """Any value at these keys in any case, or what follows from all in one."""
    return of_every_row(
        lambda found: (
            as_number(one)
            for case in (found, *found["cases"].values())
            for one in how([value for path in paths for value in at(case, path)])
        )
    )


def not_passed(verdicts: list[str]) -> Iterable[int]:
    return [sum(one in ("fail", "not kept") for one in verdicts)]


def modes_counted(found: Found, row: Row) -> Iterator[float]:
    return (mode + 1.0 for mode in range(len(found["modes"]["frequency_Hz"])))


def order_ratios(found: Found, row: Row) -> Iterator[float]:
    """A critical speed with a barred range over the rated speed."""
    rated = found["scene"]["rated_speed_rad_per_s"]
    return (one / rated for one in at(found, "checks[].barred[].critical_rad_per_s"))


# (begin of the caption, title): what a column may show that reads no quantity of a record, with the reason
COLUMNS: dict[tuple[str, str], Values] = {
    # several cases in one table: each case has its own results
    ("Checks by case", ""): of_cases("checks[].value", "checks[].limit"),
    ("Cases of the model file", "Checks"): of_cases(
        "checks[].verdict", how=lambda verdicts: [len(verdicts)]
    ),
    ("Cases of the model file", "Failed"): of_cases("checks[].verdict", how=not_passed),
    ("Cases of the model file", "Highest utilisation"): of_cases("checks[].utilisation"),
    ("Cases: barred ranges", "From"): of_cases("checks[].barred[].lower_rad_per_s"),
    ("Cases: barred ranges", "To"): of_cases("checks[].barred[].upper_rad_per_s"),
    # words: the name of an order, the mode that it excites
    ("Barred ranges", "Order"): key("checks[].barred[].order"),
    ("Barred ranges", "Mode"): modes_counted,
    ("Barred ranges", "λ"): order_ratios,
    ("Critical speeds, order by mode", "Order"): key("critical_speeds[].order"),
    ("First order against", "Order"): key("first_order_compared[].order"),
    # one value of a matrix
    ("Correlation of updated", "Correlation"): key("fit.correlation"),
    # the unit follows the quantity that was measured
    ("Measured a", "Measured"): key("fit.curves[].measured"),
    ("Measured a", "Before"): key("fit.curves[].before"),
    ("Measured a", "Fitted"): key("fit.curves[].after"),
}
INPUT = ("Changes of the input", "Events", "Variants", "The 10 variants")  # texts of the file
COUNTS = ("No.", "Candidate")  # numbers of rows


def named(table: Table, column: Column) -> Values | None:
    """What may stand in a column; the longest begin of its title counts."""
    fitting = [
        (len(title), values)
        for (caption, title), values in COLUMNS.items()
        if table.caption.startswith(caption) and column.title.startswith(title)
    ]
    return max(fitting, key=lambda pair: pair[0])[1] if fitting else None


def numbers_of(table: Table, k: int) -> Iterator[tuple[Row, str]]:
    """The cells of a column that are a number, each with its row."""
    for row, cells in zip(rows(table), table.rows, strict=True):
        text = cells[k].removesuffix(" *").removeprefix("≥ ")
        if NUMBER.fullmatch(text) or FRACTION.fullmatch(text):
            yield row, FRACTION.sub(r"\1/\2", text)
        elif PAIR.match(text):  # two numbers and their unit
            yield from ((row, one) for one in PAIR.match(text).groups() if NUMBER.fullmatch(one))


def digits_of(text: str) -> int:
    """The significant digits of a cell; zeros at the end of a whole number may be none."""
    mantissa = text.partition("·")[0].lstrip("−")
    mantissa = mantissa if "." in mantissa else mantissa.rstrip("0")
    return max(len(mantissa.replace(".", "").lstrip("0")), 1)


def holds(text: str, unit: str, found: Iterable[Any]) -> bool:
    """A declared value is rounded to the cell; 0 stands for what is next to nothing beside the largest."""
    values = found if isinstance(found, np.ndarray) else numbers(found)
    cell = printed(text, digits_of(text))
    factor = SI.get(unit, 1.0)
    wanted = Interval(cell.low * factor, cell.high * factor)
    if cell.low == cell.high == 0.0:
        least = (
            math.sqrt(ROUNDING) if unit == "deg" else ROUNDING
        )  # a resultant angle is a root of what cancels
        size = np.abs(values)
        return bool(size.size) and bool(size.min() <= max(NOTHING * size.max(), least))
    if math.isfinite(cell.high):
        values = values[np.isfinite(values)]
    slack = SLACK * np.maximum(np.abs(values), max(abs(wanted.low), abs(wanted.high)))
    return bool(np.any((wanted.low <= values + slack) & (values <= wanted.high + slack)))


def every_number_of_a_table_is_a_declared_result(scene: str) -> None:
    findings = solved(scene)
    found, wrong = {**written(scene), "findings": findings}, list[str]()
    for table in (block for block in chapters(findings, is_full=True) if isinstance(block, Table)):
        for k, column in enumerate(table.columns):
            if column.name:
                continue  # declared: the table reads the quantity from its record, in the unit that it shows
            values_of = named(table, column)
            for row, text in numbers_of(table, k):
                if values_of is not None:
                    if not holds(text, column.unit, values_of(found, row)):
                        wrong.append(f"{table.caption[:40]} | {column.title}: {text}")
                elif column.title not in COUNTS and not table.caption.startswith(INPUT):
                    wrong.append(f"{table.caption[:40]} | {column.title} names no result")
    assert list(dict.fromkeys(wrong)) == []


def test_every_exception_is_of_some_scene() -> None:
    """An entry of the list that no table needs would hide the next column without a quantity."""
    scenes = ("ferry_cases", "measured_drive", "two_stroke_ship", "tripod_drive")
    needed = {
        entry
        for scene in scenes
        for table in chapters(solved(scene), is_full=True)
        if isinstance(table, Table)
        for column in table.columns
        if not column.name and (entry := named(table, column)) is not None
    }
    assert set(COLUMNS.values()) == needed


def test_another_number_is_none_of_the_results() -> None:
    assert holds("826.97", "rpm", [86.6])
    assert not holds("827.07", "rpm", [86.6])
    assert not holds("0", "N m", [1.0, 2.0])
    assert holds("0", "N m", [1e-13, 2.0])
    assert [digits_of(text) for text in ("0.0120", "1410", "1.50·10⁻⁷", "0")] == [3, 3, 3, 1]
