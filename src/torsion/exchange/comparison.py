"""What changed between two results: input, natural frequencies and checks.

Modes are paired by shape, not by number: the modal assurance criterion weighted by inertia (Allemang and Brown 1982)
over the components that both trains have. Checks are paired by rule, clause, component and name.
"""

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from torsion.arrays import FloatArray
from torsion.errors import InputError, printable, refusal
from torsion.findings import Findings
from torsion.output.results_json import results
from torsion.rules.verdict_line import WORDS, Verdict
from torsion.user_files import LARGEST_RESULTS, read_file

FORMAT = 1
TOLERANCE = 1e-6  # relative difference of a value or a utilisation that counts as a change
LEAST_MAC = 0.5  # two modes with a smaller criterion are not the same mode
HEAD = {  # key of `scene`: words, unit
    "name": ("name", ""),
    "model": ("model of the shafts", ""),
    "reference": ("reference", ""),
    "speed_range_rad_per_s": ("speed range", "rad/s"),
    "rated_speed_rad_per_s": ("rated speed", "rad/s"),
    "rated_power_W": ("rated power", "W"),
    "rules": ("rules", ""),
}
INERTIA, FLEXIBILITY = ("inertia", "kg m2"), ("flexibility", "rad/(N m)")  # name, unit
SEVERITY = ("pass", "restricted", "not judged", "not kept", "fail")


@dataclass(frozen=True)
class InputChange:
    """A value of the input that differs."""

    component: str
    what: str
    before: Any
    after: Any
    unit: str = ""


@dataclass(frozen=True)
class ModePair:
    """A mode of either train; None for a mode without a partner."""

    before: int | None
    after: int | None
    frequency_before: float | None  # Hz
    frequency_after: float | None  # Hz
    criterion: float  # modal assurance criterion, 0 to 1; NaN if modes are paired by number

    @property
    def change(self) -> float | None:
        """Relative change of the frequency; None for a mode without a partner."""
        if self.frequency_before is None or self.frequency_after is None:
            return None
        return self.frequency_after / self.frequency_before - 1.0

    @property
    def is_changed(self) -> bool:
        """The mode is new, gone, renumbered, or has another frequency."""
        return self.change is None or abs(self.change) > TOLERANCE or self.before != self.after


@dataclass(frozen=True)
class CheckChange:
    """A check whose verdict or utilisation differs; verdict None for a check that only one of both has."""

    rule: str
    clause: str
    component: str
    what: str
    verdict_before: Verdict | None
    verdict_after: Verdict | None
    utilisation_before: float | None
    utilisation_after: float | None

    @property
    def severity(self) -> tuple[int, float]:
        """Sort key: a verdict that worsens first, then the largest rise of the utilisation."""
        before, after = (
            -1 if v is None else SEVERITY.index(v)
            for v in (self.verdict_before, self.verdict_after)
        )
        rise = (self.utilisation_after or 0.0) - (self.utilisation_before or 0.0)
        return before - after, -rise


@dataclass(frozen=True)
class CaseComparison:
    """What changed in one case; the file without its cases has no name."""

    name: str
    verdict_before: str | None  # in words; None for a case that only one of both has
    verdict_after: str | None
    inputs: tuple[InputChange, ...] = ()
    modes: tuple[ModePair, ...] = ()
    checks: tuple[CheckChange, ...] = ()

    @property
    def is_changed(self) -> bool:
        """Verdict, input, a mode or a check differs."""
        is_other = self.verdict_before != self.verdict_after
        return (
            is_other
            or bool(self.inputs or self.checks)
            or any(pair.is_changed for pair in self.modes)
        )


@dataclass(frozen=True)
class Comparison:
    """What changed between the results A and B."""

    name_before: str
    name_after: str
    checksum_before: str  # SHA-256 of the input
    checksum_after: str
    cases: tuple[CaseComparison, ...]

    @property
    def is_changed(self) -> bool:
        """The results of at least one case differ."""
        return any(case.is_changed for case in self.cases)


def read_results(path: str | Path) -> dict[str, Any]:
    """Return the content of a results.json, or of that in a folder; raises InputError if it cannot be read."""
    file = Path(path) / "results.json" if Path(path).is_dir() else Path(path)
    try:
        data = json.loads(read_file(file, LARGEST_RESULTS).decode())
    except (OSError, UnicodeDecodeError) as error:
        raise _refused(
            file, f"cannot be read: {getattr(error, 'strerror', None) or 'not UTF-8 text'}"
        ) from None
    except (ValueError, RecursionError):
        raise _refused(file, "is not JSON") from None
    if not isinstance(data, dict) or not {"scene", "stations", "spans", "checks"} <= data.keys():
        raise _refused(file, "does not hold the results of `torsion solve`")
    if data.get("format") != FORMAT:
        raise _refused(
            file,
            f"has format {printable(str(data.get('format')))}; this version reads format {FORMAT}",
        )
    return data


def _refused(file: Path, why: str) -> InputError:
    return refusal(f"{printable(str(file))} {why}", "write it with `torsion solve FILE -o FOLDER`")


def compare(before: str | Path | Findings, after: str | Path | Findings) -> Comparison:
    """Compare two results: findings, a results.json, or the folder of one.

    >>> import torsion
    >>> text = "name: pair\\ntrain: [disc: {inertia: 2}, coupling: {stiffness: 120}, disc: {inertia: 3}]"
    >>> stiffer = torsion.run(torsion.parse(text.replace("120", "480")))
    >>> round(compare(torsion.run(torsion.parse(text)), stiffer).cases[0].modes[0].change, 9)  # sqrt(480/120) - 1
    1.0

    Raises InputError if a file cannot be read.
    """
    contents = (
        results(side) if isinstance(side, Findings) else read_results(side)
        for side in (before, after)
    )
    return compare_results(*contents)


def compare_results(before: Mapping[str, Any], after: Mapping[str, Any]) -> Comparison:
    """Compare the contents of two results.json, case by case."""
    heads = before["scene"], after["scene"]
    cases = [_compare_case("", before, after)]
    for name in dict.fromkeys((*(before.get("cases") or {}), *(after.get("cases") or {}))):
        pair = [(data.get("cases") or {}).get(name) for data in (before, after)]
        cases.append(_compare_case(name, *pair))
    names = [str(head.get("name")) for head in heads]
    checksums = [str(head.get("sha256") or "") for head in heads]
    return Comparison(names[0], names[1], checksums[0], checksums[1], tuple(cases))


def _compare_case(
    name: str, before: Mapping[str, Any] | None, after: Mapping[str, Any] | None
) -> CaseComparison:
    old, new = (None if data is None else _verdict(data) for data in (before, after))
    comparison = CaseComparison(name, old, new)
    if before is None or after is None or not ("checks" in before and "checks" in after):
        return comparison
    checks = sorted(_checks(before, after), key=lambda change: change.severity)
    inputs, modes = tuple(_inputs(before, after)), tuple(_modes(before, after))
    return replace(comparison, inputs=inputs, modes=modes, checks=tuple(checks))


def _verdict(data: Mapping[str, Any]) -> str:
    """Return the worst verdict of the checks in words.

    Missing results are NOT JUDGED, and variants that fail make a PASS one with restrictions.
    """
    verdicts = {check["verdict"] for check in data.get("checks") or ()}
    worst = next((words for verdict, words in WORDS.items() if verdict in verdicts), "NOT JUDGED")
    if worst != "FAIL" and data.get("plan", {}).get("unanswered"):
        return "NOT JUDGED"
    some_fail = ((data.get("sweep") or {}).get("any_fails") or {}).get("failing")
    return WORDS["restricted"] if some_fail and worst == WORDS["pass"] else worst


def _inputs(before: Mapping[str, Any], after: Mapping[str, Any]) -> Iterator[InputChange]:
    """Yield what differs in the head of the file, and in the inertia and stiffness of every component."""
    for key, (words, unit) in HEAD.items():
        values = before["scene"].get(key), after["scene"].get(key)
        if not _is_same(*values):
            yield InputChange("", words, *values, unit)

    # Lumped segments give part of a shaft's inertia to its neighbours: other segments, other shares.
    names = [[row["name"] for row in data["stations"]] for data in (before, after)]
    properties = [_properties(data, has_inertia=names[0] == names[1]) for data in (before, after)]
    for component in dict.fromkeys((*properties[0], *properties[1])):
        old, new = (components.get(component) for components in properties)
        if old is None or new is None:
            presence = ("-" if values is None else "present" for values in (old, new))
            yield InputChange(component, "component", *presence)
            continue
        for what, unit in dict.fromkeys((*old, *new)):
            value, value_after = old.get((what, unit)), new.get((what, unit))
            if not _is_same(value, value_after):
                yield InputChange(component, what, value, value_after, unit)


def _properties(
    data: Mapping[str, Any], *, has_inertia: bool
) -> dict[str, dict[tuple[str, str], Any]]:
    """Return inertia and stiffness of every component from the sums over its segments, whatever their number."""
    properties: dict[str, dict[tuple[str, str], Any]] = {}
    for row in data["stations"]:
        values = properties.setdefault(str(row.get("component") or row["name"]), {})
        sums = values if has_inertia else properties.setdefault("whole train", {})
        sums[INERTIA] = sums.get(INERTIA, 0.0) + (row.get("inertia_kg_m2") or 0.0)
        values["speed ratio", ""] = row.get("speed_ratio")
    for row in data["spans"]:
        values = properties.setdefault(str(row.get("component") or row["name"]), {})
        for quantity, key in (
            (FLEXIBILITY, "flexibility_rad_per_Nm"),
            (("damping", "N m s/rad"), "viscous_Nms_per_rad"),
        ):
            values[quantity] = values.get(quantity, 0.0) + (row.get(key) or 0.0)
        values["loss factor", ""] = row.get("loss_factor")

    for values in properties.values():
        if flexibility := values.pop(FLEXIBILITY, 0.0):
            values["stiffness", "N m/rad"] = 1.0 / flexibility
    return properties


def _is_same(before: Any, after: Any) -> bool:
    """Whether two values agree to the tolerance; numbers in lists are compared one by one."""
    if isinstance(before, list) and isinstance(after, list):
        return len(before) == len(after) and all(map(_is_same, before, after))
    if isinstance(before, int | float) and isinstance(after, int | float):
        return abs(before - after) <= TOLERANCE * max(abs(before), abs(after))
    return bool(before == after)


def _modes(before: Mapping[str, Any], after: Mapping[str, Any]) -> Iterator[ModePair]:
    """Yield every mode of A with its partner in B, then the modes of B without a partner."""
    if not before.get("modes") or not after.get("modes"):
        return
    frequencies = [data["modes"]["frequency_Hz"] for data in (before, after)]
    criterion = _assurance(before, after)
    partners = {mode: mode for mode in range(min(map(len, frequencies)))}
    if criterion is not None:
        partners = _partners(criterion)
    for mode, frequency in enumerate(frequencies[0]):
        partner = partners.get(mode)
        other_value = None if partner is None else frequencies[1][partner]
        value = (
            np.nan
            if criterion is None
            else 0.0
            if partner is None
            else float(criterion[mode, partner])
        )
        yield ModePair(
            mode + 1, None if partner is None else partner + 1, frequency, other_value, value
        )
    for mode in sorted(set(range(len(frequencies[1]))) - set(partners.values())):
        yield ModePair(None, mode + 1, None, frequencies[1][mode], 0.0)


def _partners(criterion: FloatArray) -> dict[int, int]:
    """Return the partner of every mode of A in B: the pairs with the largest criterion first, each mode once."""
    partners: dict[int, int] = {}
    for index in np.argsort(-criterion, axis=None, kind="stable"):
        row, column = (int(position) for position in np.unravel_index(index, criterion.shape))
        if criterion[row, column] <= LEAST_MAC:
            break
        if row not in partners and column not in partners.values():
            partners[row] = column
    return partners


def _assurance(before: Mapping[str, Any], after: Mapping[str, Any]) -> FloatArray | None:
    """(modes of A, modes of B) modal assurance criterion; None if shapes are in another file or nothing is common."""
    shapes = [data["modes"].get("shape_rad") for data in (before, after)]
    names = [[row["name"] for row in data["stations"]] for data in (before, after)]
    common = [name for name in names[0] if name in set(names[1])]
    if not common or not all(isinstance(shape, list) for shape in shapes):
        return None
    inertia = dict(
        zip(names[0], (row.get("inertia_kg_m2") or 0.0 for row in before["stations"]), strict=True)
    )
    weight = np.sqrt([inertia[name] for name in common])
    scaled = []
    for shape, names_known in zip(shapes, names, strict=True):
        places = [names_known.index(name) for name in common]
        values = np.array(shape, dtype=float)[:, places] * weight
        norm = np.linalg.norm(values, axis=1, keepdims=True)
        scaled.append(np.divide(values, norm, out=np.zeros_like(values), where=norm > 0))
    return np.asarray((scaled[0] @ scaled[1].T) ** 2)


def _checks(before: Mapping[str, Any], after: Mapping[str, Any]) -> Iterator[CheckChange]:
    """Yield every check whose verdict or utilisation differs, and every check that only one of both has."""
    checks_by_name = [
        {(check["rule"], check["clause"], check["where"], check["what"]): check for check in rows}
        for rows in (data["checks"] or () for data in (before, after))
    ]
    for name in dict.fromkeys((*checks_by_name[0], *checks_by_name[1])):
        old, new = (checks.get(name, {}) for checks in checks_by_name)
        used, other_use = old.get("utilisation"), new.get("utilisation")
        is_same = old.get("verdict") == new.get("verdict") and _is_same(used, other_use)
        if used is None and other_use is None:  # a limit of 0, or none
            is_same = is_same and _is_same(old.get("value"), new.get("value"))
        if not is_same:
            yield CheckChange(*name, old.get("verdict"), new.get("verdict"), used, other_use)
