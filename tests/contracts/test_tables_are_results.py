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

from torsion.analyses.response.amplitudes import Response, Synthesis
from torsion.analyses.response.component_loads import NOTHING
from torsion.output.blocks import Column, Table
from torsion.output.chapters import chapters
from torsion.output.numbers import ROUNDING, symbols
from torsion.output.selection import elements

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
    if isinstance(value, list):
        for one in value:
            yield from flat(one)
    elif value is not None:
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


def written_number(path: str) -> Values:
    """The number of a value with its unit, as the file states it, in the row of its figure."""
    return lambda found, row: (
        float(str(one[path]).partition(" ")[0])
        for one in found["fit"]["figures"]
        if one["name"] == row["Parameter"]
    )


def largest(path: str) -> Values:
    """The largest over speed of the element that the row is about."""
    return lambda found, row: [max(flat(of_element(found, path, row)))]


def of_element(found: Found, path: str, row: Row) -> Any:
    result, name = path.split(".")
    element = next(row[title] for title in ("Component", "Mesh", "Coupling") if title in row)
    return found[result][name][found[result]["element"].index(element)]


def within(what: str) -> Values:
    """Any value in the spans of the element that the row is about; results.json has its largest alone."""

    def values(found: Found, row: Row) -> list[float]:
        findings = found["findings"]
        spans = next(
            list(one.spans) for one in elements(findings.system) if one.name == row["Component"]
        )
        return getattr(findings.need(Synthesis), what)[:, spans].ravel().tolist()

    return values


def amplitudes(what: str) -> Values:
    """The sizes of complex amplitudes of all lines; results.json has those at the ends of an element alone."""
    return of_every_row(
        lambda found: np.abs(getattr(found["findings"].need(Response), what)).ravel()
    )


def of_check(*names: str) -> Values:
    """Of the check that the row is about."""

    def values(found: Found, row: Row) -> Iterator[Any]:
        for one in found["checks"]:
            is_clause = row["Rule, clause and basis"].startswith(
                f"{one['rule']}: {symbols(one['clause'])} ("
            )
            if is_clause and (one["what"], one["where"]) == (row["Check"], row["Component"]):
                yield from (value for name in names for value in flat(one[name]))

    return values


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


def speed_amplitudes(found: Found, row: Row) -> Iterator[float]:
    for line in found["response"]["lines"]:
        for hertz, speed in zip(line["frequency_Hz"], line["angle_rad"], strict=True):
            yield from (
                math.hypot(*pair) * hertz * 2.0 * math.pi for pair in speed if pair[0] is not None
            )


def distances(found: Found, row: Row) -> Iterator[float]:
    return (one["margin"] for one in found["critical_speeds"])


def modes_counted(found: Found, row: Row) -> Iterator[float]:
    return (mode + 1.0 for mode in range(len(found["modes"]["frequency_Hz"])))


def spreads(end: str) -> Values:
    """How far the tolerances move each mode to one side."""

    def values(found: Found, row: Row) -> Iterator[float]:
        made = found["tolerances"]
        return (moved / f - 1.0 for f, moved in zip(made["frequency_Hz"], made[end], strict=True))

    return values


def moved(found: Found, row: Row) -> Iterator[float]:
    for one in found["tolerances"]["couplings"]:
        for f, low, high in zip(
            found["modes"]["frequency_Hz"], one["lower_Hz"], one["upper_Hz"], strict=True
        ):
            yield (high - low) / f


def swept(name: str) -> Values:
    """Of every check over the variants, and of any."""
    return key(f"sweep.checks[].{name}", f"sweep.any_fails.{name}")


RPM, HZ = "speed_rad_per_s", "frequency_Hz"
COLUMNS: dict[
    tuple[str, str], Values
] = {  # (begin of the caption, title): the figures that may stand there
    ("Checks, each", "Value"): of_check("value"),
    ("Checks, each", "Limit"): of_check("limit"),
    ("Checks, each", "Utilisation"): of_check("utilisation"),
    ("Checks, each", "Speed"): of_check(RPM),
    ("Checks by case", ""): of_cases("checks[].value", "checks[].limit"),
    ("Cases of the model file", "Checks"): of_cases(
        "checks[].verdict", how=lambda verdicts: [len(verdicts)]
    ),
    ("Cases of the model file", "Failed"): of_cases("checks[].verdict", how=not_passed),
    ("Cases of the model file", "Highest utilisation"): of_cases("checks[].utilisation"),
    ("Natural frequencies of the cases", "Mode"): of_cases("modes.frequency_Hz"),
    ("Cases: barred ranges", "From"): of_cases("checks[].barred[].lower_rad_per_s"),
    ("Cases: barred ranges", "To"): of_cases("checks[].barred[].upper_rad_per_s"),
    ("Components", "Speed ratio"): key("stations[].speed_ratio"),
    ("Critical speeds, order by mode", "Mode"): key(f"critical_speeds[].{RPM}"),
    ("Critical speeds, order by mode", "Order"): key("critical_speeds[].order"),
    ("Natural frequencies within", "Mode"): modes_counted,
    ("Natural frequencies within", "Frequency"): key("tolerances.frequency_Hz"),
    ("Natural frequencies within", "Minimum"): key("tolerances.lower_Hz"),
    ("Natural frequencies within", "Maximum"): key("tolerances.upper_Hz"),
    ("Natural frequencies within", "Down"): spreads("lower_Hz"),
    ("Natural frequencies within", "Up"): spreads("upper_Hz"),
    ("Dominant parameters", "Mode"): modes_counted,
    ("Dominant parameters", "Tolerance"): key("tolerances.figures[].tolerance"),
    ("Dominant parameters", "Sensitivity"): key("tolerances.figures[].sensitivity"),
    ("Dominant parameters", "Change"): key("tolerances.figures[].change"),
    ("Critical speeds that can lie", "Minimum"): key("tolerances.critical_lower_rad_per_s"),
    ("Critical speeds that can lie", "Critical speed"): key(f"critical_speeds[].{RPM}"),
    ("Critical speeds that can lie", "Maximum"): key("tolerances.critical_upper_rad_per_s"),
    ("Critical speeds that can lie", "Order"): key("critical_speeds[].order"),
    ("Critical speeds that can lie", "Mode"): key("critical_speeds[].mode"),
    ("Effect of each coupling", "Mode"): modes_counted,
    ("Effect of each coupling", "Tolerance"): key("tolerances.couplings[].tolerance"),
    ("Effect of each coupling", "Soft"): key("tolerances.couplings[].lower_Hz"),
    ("Effect of each coupling", "Stiff"): key("tolerances.couplings[].upper_Hz"),
    ("Effect of each coupling", "Change"): moved,
    ("Effect of each coupling", "Without it"): key("tolerances.couplings[].softest_Hz"),
    ("Effect of each coupling", "Rigid"): key("tolerances.couplings[].stiffest_Hz"),
    ("Stiffness for a target", "Mode"): key("tolerances.aims[].mode"),
    ("Stiffness for a target", "Target"): key("tolerances.aims[].frequency_Hz"),
    ("Stiffness for a target", "Required stiffness"): key("tolerances.aims[].stiffness_Nm_per_rad"),
    ("Stiffness for a target", "Required / nominal"): key("tolerances.aims[].factor"),
    ("Stiffness for a target", "Without it"): key("tolerances.aims[].softest_Hz"),
    ("Stiffness for a target", "Rigid"): key("tolerances.aims[].stiffest_Hz"),
    ("Varied parameters", "Group"): key("sweep.figures[].together"),
    ("Natural frequencies of all variants", "Mode"): modes_counted,
    ("Natural frequencies of all variants", "Nominal"): key("sweep.nominal_Hz"),
    ("Natural frequencies of all variants", "Mean"): key("sweep.mean_Hz"),
    ("Natural frequencies of all variants", "Standard"): key("sweep.deviation_Hz"),
    ("Natural frequencies of all variants", "2.5 %"): key("sweep.low_Hz"),
    ("Natural frequencies of all variants", "97.5 %"): key("sweep.high_Hz"),
    ("Natural frequencies of all variants", "Minimum"): key("sweep.least_Hz"),
    ("Natural frequencies of all variants", "Maximum"): key("sweep.greatest_Hz"),
    ("Checks over", "Variants"): swept("failing"),
    ("Checks over", "Minimum"): swept("best"),
    ("Checks over", "Maximum"): swept("worst"),
    ("Sensitivity: share", "First index"): key("sweep.indices[].first"),
    ("Sensitivity: share", "Total index"): key("sweep.indices[].total"),
    ("Sensitivity: share", "±"): key("sweep.indices[].first_error", "sweep.indices[].total_error"),
    ("Changes between pass", "Passes"): key("sweep.grid.turns[].kept"),
    ("Changes between pass", "Fails"): key("sweep.grid.turns[].failing"),
    ("Changes between pass", "Limit"): key("sweep.grid.turns[].between"),
    ("Variants", "Mode"): key("sweep.grid.frequency_Hz"),
    ("Variants", "Maximum"): key("sweep.grid.greatest"),
    ("The 10 variants", "Mode"): key("sweep.grid.frequency_Hz"),
    ("The 10 variants", "Maximum"): key("sweep.grid.greatest"),
    ("Failure probability", "Variants"): swept("failing"),
    ("Failure probability", "Probability"): swept("probability"),
    ("Failure probability", "From"): swept("lower"),
    ("Failure probability", "To"): swept("upper"),
    ("Failure probability", "Median"): swept("median"),
    ("Failure probability", "Maximum"): swept("worst"),
    ("Failure probability", "Rank"): swept("correlation"),
    ("Updated parameters", "Nominal"): written_number("given"),
    ("Updated parameters", "Fitted"): written_number("fitted"),
    ("Updated parameters", "Factor"): key("fit.figures[].factor"),
    ("Updated parameters", "95 % from"): key("fit.figures[].lower"),
    ("Updated parameters", "95 % to"): key("fit.figures[].upper"),
    ("Updated parameters", "Deviation before"): key("fit.figures[].prior"),
    ("Updated parameters", "Deviation after"): key("fit.figures[].deviation"),
    ("Updated parameters", "Shift"): key("fit.figures[].shift"),
    ("Updated parameters", "Identified"): key("fit.figures[].from_data"),
    ("Other solutions that agree", "Chi2"): key("fit.others[].chi2"),
    ("Other solutions that agree", "Squared shifts"): key("fit.others[].prior_chi2"),
    ("Measured natural", "Mode"): key("fit.modes[].mode"),
    ("Measured natural", "Measured"): key("fit.modes[].measured_Hz"),
    ("Measured natural", "Deviation"): key("fit.modes[].within"),
    ("Measured natural", "Band from"): key("fit.modes[].lower_Hz"),
    ("Measured natural", "Band to"): key("fit.modes[].upper_Hz"),
    ("Measured natural", "Before"): key("fit.modes[].before_Hz"),
    ("Measured natural", "Fitted"): key("fit.modes[].after_Hz"),
    ("Measured natural", "Residual"): key("fit.modes[].residual"),
    ("Measured a", "Deviation"): key("fit.curves[].deviation"),
    ("Measured a", "Speed"): key(f"fit.curves[].{RPM}"),
    ("Measured a", "Measured"): key("fit.curves[].measured"),
    ("Measured a", "Before"): key("fit.curves[].before"),
    ("Measured a", "Fitted"): key("fit.curves[].after"),
    ("Measured a", "Residual"): key("fit.curves[].residual", "fit.curves[].phase_residual"),
    ("Identified combinations", "Information"): key("fit.directions[].information"),
    ("Correlation of updated", "Correlation"): key("fit.correlation"),
    ("Best candidates", "Candidate"): lambda found, row: range(1, len(found["design"]["best"]) + 1),
    ("Best candidates", "Minimum"): key("design.best[].margin"),
    ("Best candidates", "Utilisation"): key("design.best[].utilisation"),
    ("Best candidates", "Frequency"): key("design.best[].frequency_Hz"),
    ("Best candidates", "Mass"): key("design.best[].mass_kg"),
    ("Best candidates", "Cost"): key("design.best[].cost"),
    ("Maximum vibratory torque", "Total"): largest("synthesis.half_range_Nm"),
    ("Maximum vibratory torque", "Speed"): key(f"response.{RPM}"),
    ("Maximum vibratory torque", "Torque of this"): amplitudes("torque"),
    ("Maximum vibratory torque", "RMS"): within("rms"),
    ("Maximum vibratory torque", "Sum of magnitudes"): within("bound"),
    ("Maximum vibratory torque", "Mean"): key("response.mean_torque_Nm", "mean.torque_Nm"),
    ("Maximum torque amplitude", "Frequency"): key("frequency_response.frequency_Hz"),
    ("Maximum angular amplitude", "Frequency"): key("frequency_response.frequency_Hz"),
    ("Angles of the joints", "Angle"): key("joints.joints[].angle_rad"),
    ("Angles of the joints", "Plane"): key("joints.joints[].plane_rad"),
    ("Angles of the joints", "Phase"): key("joints.joints[].phase_rad"),
    ("Single joints", "Order, own shaft"): key("joints.joints[].order"),
    ("Single joints", "Error amplitude"): lambda found, row: (
        math.hypot(*one["amplitude_rad"]) for one in found["joints"]["joints"]
    ),
    ("Single joints", "Speed fluctuation"): key("joints.joints[].unevenness"),
    ("Joints of one shaft line", "Resultant angle"): key("joints.lines[].resultant_rad"),
    ("Joints of one shaft line", "Small-angle sum"): key("joints.lines[].classical_rad"),
    ("Joints of one shaft line", "Phase"): key("joints.lines[].phase_rad"),
    ("Joints of one shaft line", "Maximum"): key("joints.lines[].greatest.speed_ratio"),
    ("Joints of one shaft line", "Minimum"): key("joints.lines[].least.speed_ratio"),
    ("Joints of one shaft line", "at"): key(
        "joints.lines[].greatest.at_rad", "joints.lines[].least.at_rad"
    ),
    ("Joints of one shaft line", "Degree"): key("joints.lines[].index"),
    ("Speed and acceleration", "Mean speed"): key("joints.joints[].speed_rad_per_s"),
    ("Secondary couples", "Torque"): key("joints.joints[].torque_Nm"),
    ("Secondary couples", "Order"): key("joints.joints[].couples[].order"),
    ("Secondary couples", "Maximum"): key("joints.joints[].couples[].largest_Nm"),
    ("Secondary couples", "Bearings"): key("joints.joints[].couples[].bearing_N"),
    ("Secondary couples", "Force across"): key("joints.joints[].force_N"),
    ("Unstable ranges of speed", "From"): key("stability.ranges[].from_rad_per_s"),
    ("Unstable ranges of speed", "To"): key("stability.ranges[].to_rad_per_s"),
    ("Unstable ranges of speed", "Maximum growth"): key("stability.ranges[].growth_per_s"),
    ("Unstable ranges of speed", "Speed"): key("stability.ranges[].at_rad_per_s"),
    ("Unstable ranges of the tilt", "From"): key(
        "lateral.shafts[].tilting.unstable[].from_rad_per_s"
    ),
    ("Unstable ranges of the tilt", "To"): key("lateral.shafts[].tilting.unstable[].to_rad_per_s"),
    ("Unstable ranges of the tilt", "Maximum growth"): key(
        "lateral.shafts[].tilting.unstable[].growth_per_s"
    ),
    ("Unstable ranges of the tilt", "Speed"): key(
        "lateral.shafts[].tilting.unstable[].at_rad_per_s"
    ),
    ("Rigid shafts that tilt", "Transverse"): key(
        "lateral.shafts[].tilting.transverse_inertia_kgm2"
    ),
    ("Rigid shafts that tilt", "Polar"): key("lateral.shafts[].tilting.polar_inertia_kgm2"),
    ("Natural frequencies over the speed", "Speed"): key("frequencies_over_speed.speed_rad_per_s"),
    ("Natural frequencies over the speed", "Mean torque"): key(
        "frequencies_over_speed.couplings[].torque_Nm"
    ),
    ("Natural frequencies over the speed", "k of"): key(
        "frequencies_over_speed.couplings[].stiffness_Nm_per_rad"
    ),
    ("Natural frequencies over the speed", "Mode"): key("frequencies_over_speed.frequency_Hz"),
    ("Torque amplitudes at the peaks", "Speed"): key("nonlinear_peaks[].speed_rad_per_s"),
    ("Torque amplitudes at the peaks", "Response"): key("nonlinear_peaks[].response_Nm"),
    ("Torque amplitudes at the peaks", "Exact"): key("nonlinear_peaks[].exact_Nm"),
    ("Torque amplitudes at the peaks", "Difference"): key("nonlinear_peaks[].difference"),
    ("Torque amplitudes at the peaks", "Exact total"): key("nonlinear_peaks[].half_range_Nm"),
    ("Torque amplitudes at the peaks", "Mode"): key("nonlinear_peaks[].mode"),
    ("Torque amplitudes at the peaks", "Frequency"): key("nonlinear_peaks[].natural_frequency_Hz"),
    ("Maximum ice torque", "H"): key("transient[].ice[].thickness_m"),
    ("Maximum ice torque", "k"): key("transient[].ice[].factor"),
    ("Maximum ice torque", "D"): key("transient[].ice[].diameter_m"),
    ("Maximum ice torque", "d/D"): key("transient[].ice[].hub_ratio"),
    ("Maximum ice torque", "P/D"): key("transient[].ice[].pitch_ratio"),
    ("Maximum ice torque", "n"): key("transient[].ice[].speed_rad_per_s", times=0.5 / math.pi),
    ("Maximum ice torque", "Revolutions"): key("transient[].ice[].revolutions"),
    ("Maximum ice torque", "Q_{max}"): key("transient[].ice[].torque_Nm"),
    ("Orders: maximum amplitude", "Order of"): key("transient[].orders.order[]"),
    ("Orders: maximum amplitude", "Maximum amplitude"): key(
        "transient[].orders.each[].largest_Nm[]"
    ),
    ("Maximum errors against", "Frequency"): key("check.models[].largest_frequency_error"),
    ("Maximum errors against", "1 − MAC"): key("check.models[].largest_shape_error"),
    ("Maximum errors against", "Torques"): key("check.models[].largest_torque_error"),
}
# the figures of the file, checked by their chapters
INPUT = (
    "Changes of the input",
    "Changes of the input",
)
OF_OTHERS = {  # columns of figures that follow from declared ones by a formula of their chapter, checked there
    "Couplings and dampers with tables: values": ("Modal loss",),
    "Components": ("Rated speed",),
    "Barred ranges": ("λ",),
    "Maximum stress amplitude": ("Maximum stress", "τ_{C}", "τ_{T}", "Maximum τ / τ_{C}"),
    "Vibratory torque (": ("Maximum vibratory / mean",),
    "Torque and power loss": ("T_{", "Power loss", "P_{KW}"),
    "Maximum torque amplitude": ("Amplitude",),
    "Maximum angular amplitude": ("Amplitude",),
    "Angles of the joints": ("Driving yoke", "q ="),
    "Single joints": ("Driving yoke", "Order, reference", "Phase"),
    "Speed and acceleration": ("Maximum", "Minimum", "Speed × angle"),
    "Secondary couples": ("Mean", "Amplitude"),
    "Optimum phase": ("Phase now", "Optimum", "Non-uniformity"),
    "Response of the train to the order": (
        "Order",
        "Maximum torque",
        "Speed",
        "Estimated model error",
    ),
    "Shafts and their": ("Lowest", "z"),
    "Rigid shafts that tilt": ("Frequency of the tilt", "z", "Decay rate"),
    "Natural frequencies of the models": ("",),
    "Maximum errors against": ("Modes",),
    "Maximum growth": ("",),
    "Speeds with unreliable": ("",),
    "First order against exact": ("",),
    "Orders: maximum amplitude": ("at", "Phase"),
    "Torques over time": ("",),
    "Resonances passed": ("",),
    "Changes of regime": ("",),
    "Events": ("",),
    "Maximum nominal stress": ("",),
    "Couplings with backlash": ("",),
    "The first": ("",),
}
COUNTS = ("No.", "Mode", "Unit")  # where no key is named: numbers of rows and modes


def named(table: Table, column: Column) -> Values | None:
    """What may stand in a column; the longest begin of its title counts."""
    fitting = [
        (len(title), values)
        for (caption, title), values in COLUMNS.items()
        if table.caption.startswith(caption) and column.title.startswith(title)
    ]
    return max(fitting, key=lambda pair: pair[0])[1] if fitting else None


def is_of_others(table: Table, column: Column) -> bool:
    if table.caption.startswith(INPUT) or column.title in COUNTS:
        return True
    titles = (titles for caption, titles in OF_OTHERS.items() if table.caption.startswith(caption))
    return any(column.title.startswith(one) for own in titles for one in own)


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
                elif not is_of_others(table, column):
                    wrong.append(f"{table.caption[:40]} | {column.title} names no result")
    assert list(dict.fromkeys(wrong)) == []


UNDECLARED = {  # by begin of the caption: columns that no quantity declares; "" stands for all
    # words that a chapter makes of declared values, and values of several results side by side
    "Checks, each": ("Value", "Limit", "Unit", "Order", "Rule, clause", "Verdict"),
    "Barred ranges": ("Order", "Mode", "λ"),
    "Critical speeds in the": ("Excited by",),
    "Critical speeds, order by mode": ("",),
    "Couplings and dampers with tables: values": ("Modal loss",),
    "Natural frequencies over the speed": ("Mean torque of", "k of"),
    "Power balance": ("Power",),
    "Vibratory torque (": ("Torque reversal",),
    "Shafts and their": ("Supports", "Lowest", "z"),
    "Critical bending": ("Shaft", "Whirl", "In the range"),
    "Whirl over": ("Whirl at", "Stability"),
    "Forces of the shafts": ("Shaft",),
    "Maximum torque amplitude": ("",),
    "Maximum angular amplitude": ("",),
    # all cases in one table
    "Cases": ("",),
    "Checks by case": ("",),
    "Natural frequencies of the cases": ("",),
    "Changes of the input": ("",),
    # the plan and the sources
    "Computed steps": ("Size",),
    "Rules used": ("Clauses", "Basis"),
    # motion, joints, stability, variants and comparisons
    "Best candidates": ("",),
    "Correlation": ("",),
    "Critical speeds that can lie": ("",),
    "Effect of": ("",),
    "Events": ("",),
    "First order against": ("",),
    "Joints of": ("",),
    "Maximum nominal stress": ("",),
    "Measured": ("Measured", "Before", "Fitted"),
    "Natural frequencies of": ("",),
    "Natural frequencies within": ("",),
    "Optimum phase": ("",),
    "Orders": ("",),
    "Response of the train": ("",),
    "Secondary couples": ("",),
    "Single joints": ("Driving yoke", "Order, reference"),
    "Speed and acceleration": ("",),
    "Speeds with unreliable": ("",),
    "The ": ("",),
    "Torques over time": ("",),
    "Torques that": ("",),
    "Unstable ranges": ("Shaft", "Type", "In the operating", "Beyond"),
    "Variants": ("",),
    "Rigid shafts that tilt": ("",),
}


def every_column_is_a_declared_quantity_or_listed(scene: str) -> None:
    tables = (block for block in chapters(solved(scene), is_full=True) if isinstance(block, Table))
    assert not [
        f"{table.caption[:50]} | {column.title}"
        for table in tables
        for column in table.columns
        if not column.name
        and not any(
            table.caption.startswith(caption) and column.title.startswith(titles)
            for caption, titles in UNDECLARED.items()
        )
    ]


def test_another_number_is_none_of_the_results() -> None:
    assert holds("826.97", "rpm", [86.6])
    assert not holds("827.07", "rpm", [86.6])
    assert not holds("0", "N m", [1.0, 2.0])
    assert holds("0", "N m", [1e-13, 2.0])
    assert [digits_of(text) for text in ("0.0120", "1410", "1.50·10⁻⁷", "0")] == [3, 3, 3, 1]
