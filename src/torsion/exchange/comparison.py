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
from torsion.errors import refusal
from torsion.findings import Findings
from torsion.output.stored.results_json import results
from torsion.rules.verdict_line import WORDS, Verdict
from torsion.user_files import LARGEST_RESULTS, printable, read_file

FORMAT, PARTS = 1, {"scene", "stations", "spans", "checks"}
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
NOT_JUDGED = WORDS["not judged"]
INERTIA, FLEXIBILITY = ("inertia", "kg m2"), ("flexibility", "rad/(N m)")  # name, unit
SEVERITY = (None, *reversed(tuple(WORDS)))  # of a check; None: only the other result has it


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
        is_other = self.verdict_before != self.verdict_after or self.inputs or self.checks
        return bool(is_other) or any(pair.is_changed for pair in self.modes)


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
    data, why = dict[str, Any](), ""
    try:
        data = json.loads(read_file(file, LARGEST_RESULTS).decode())
    except (OSError, UnicodeDecodeError) as error:
        why = f"cannot be read: {getattr(error, 'strerror', None) or 'not UTF-8 text'}"
    except (ValueError, RecursionError):
        why = "is not JSON"
    is_of_torsion = isinstance(data, dict) and data.keys() >= PARTS
    if not why and not is_of_torsion:
        why = "does not hold the results of `torsion solve`"
    elif not why and data.get("format") != FORMAT:
        found = printable(str(data.get("format")))
        why = f"has format {found}; this version reads format {FORMAT}"
    if why:
        hint = "write it with `torsion solve FILE -o FOLDER`"
        raise refusal(f"{printable(str(file))} {why}", hint)
    return data


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
    cases = [_compare_case("", before, after)]
    of_cases = before.get("cases") or {}, after.get("cases") or {}
    for name in dict.fromkeys((*of_cases[0], *of_cases[1])):
        cases.append(_compare_case(name, *(data.get(name) for data in of_cases)))
    heads = before["scene"], after["scene"]
    names = [str(head.get("name")) for head in heads]
    checksums = [str(head.get("sha256") or "") for head in heads]
    return Comparison(names[0], names[1], checksums[0], checksums[1], tuple(cases))


def _compare_case(
    name: str, before: Mapping[str, Any] | None, after: Mapping[str, Any] | None
) -> CaseComparison:
    # The worst verdict in words: missing results are NOT JUDGED, variants that fail make a PASS one with restrictions.
    words = list[str | None]()
    for data in (before, after):
        verdicts = {check["verdict"] for check in (data or {}).get("checks") or ()}
        worst = next((text for verdict, text in WORDS.items() if verdict in verdicts), NOT_JUDGED)
        if worst != "FAIL" and data and data.get("plan", {}).get("unanswered"):
            worst = NOT_JUDGED
        elif data and ((data.get("sweep") or {}).get("any_fails") or {}).get("failing"):
            worst = WORDS["restricted"] if worst == WORDS["pass"] else worst
        words.append(None if data is None else worst)
    comparison = CaseComparison(name, words[0], words[1])
    if before is None or after is None or not ("checks" in before and "checks" in after):
        return comparison

    def severity(change: CheckChange) -> tuple[int, float]:
        """Sort a verdict that worsens first, then the largest rise of the utilisation."""
        verdicts = change.verdict_before, change.verdict_after
        earlier, later = (SEVERITY.index(verdict) for verdict in verdicts)
        shares = change.utilisation_before or 0.0, change.utilisation_after or 0.0
        return earlier - later, shares[0] - shares[1]

    checks = tuple(sorted(_checks(before, after), key=severity))
    inputs, modes = tuple(_inputs(before, after)), tuple(_modes(before, after))
    return replace(comparison, inputs=inputs, modes=modes, checks=checks)


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
    old, new = (data["modes"]["frequency_Hz"] for data in (before, after))

    # (modes of A, modes of B) modal assurance criterion; None if shapes are in another file or nothing is common.
    criterion: FloatArray | None = None
    shapes = [data["modes"].get("shape_rad") for data in (before, after)]
    names = [[row["name"] for row in data["stations"]] for data in (before, after)]
    common = [name for name in names[0] if name in set(names[1])]
    if common and all(isinstance(shape, list) for shape in shapes):
        inertia = {row["name"]: row.get("inertia_kg_m2") or 0.0 for row in before["stations"]}
        weight = np.sqrt([inertia[name] for name in common])
        scaled = []
        for shape, stations in zip(shapes, names, strict=True):
            values = np.array(shape, dtype=float)[:, [*map(stations.index, common)]] * weight
            norm = np.linalg.norm(values, axis=1, keepdims=True)
            scaled.append(np.divide(values, norm, out=np.zeros_like(values), where=norm > 0))
        criterion = np.asarray((scaled[0] @ scaled[1].T) ** 2)
    partners = dict[int, int]()
    if criterion is None:
        partners = {mode: mode for mode in range(min(len(old), len(new)))}
    # The pairs with the largest criterion first, each mode once.
    for index in () if criterion is None else np.argsort(-criterion, axis=None, kind="stable"):
        row, column = divmod(int(index), len(new))
        if criterion is None or criterion[row, column] <= LEAST_MAC:
            break
        if row not in partners and column not in partners.values():
            partners[row] = column
    for mode, frequency in enumerate(old):
        value = 0.0 if criterion is not None else np.nan
        if (partner := partners.get(mode)) is None:
            yield ModePair(mode + 1, None, frequency, None, value)
            continue
        if criterion is not None:
            value = float(criterion[mode, partner])
        yield ModePair(mode + 1, partner + 1, frequency, new[partner], value)
    for mode in sorted(set(range(len(new))) - set(partners.values())):
        yield ModePair(None, mode + 1, None, new[mode], 0.0)


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
