"""Words that are no kind of the format, and what the format has for them."""

import re

KIND_FOR = {
    "alternator": "`generator: {inertia: ...}`", "exciter": "`generator: {inertia: ...}`",
    "impeller": "`pump: {inertia: ...}` or `fan: {inertia: ...}`", "blower": "`fan: {inertia: ...}`",
    "flywheel": "`disc: {inertia: ...}`", "load": "`machine: {inertia: ..., power: ...}`",
    "spring": "`coupling: {stiffness: ...}`", "clutch": "`coupling: {stiffness: ..., capacity: ...}`",
    "table": "`- table: line.csv` names a file alone",
    "gearbox": "`gear: {ratio: ...}`", "cardan": "`joint: {angle: ...}`",
}  # fmt: skip


def of_its_number(word: str, candidates: list[str]) -> list[str]:
    """The candidates with the figures of the word, in any order: iacs-m86 is a slip for iacs-m68, iacs-m54 is none."""
    figures = sorted(re.findall(r"\d", word))
    return [one for one in candidates if not figures or sorted(re.findall(r"\d", one)) in ([], figures)]
