"""Words that are no kind of the format, and what the format has for them."""

import re

ABSORBS = "`propeller` for what absorbs the power, `motor` for what drives"
KIND_FOR = {
    "generator": ABSORBS, "alternator": ABSORBS, "pump": ABSORBS, "fan": ABSORBS, "impeller": ABSORBS,
    "turbine": ABSORBS, "flywheel": "`disc: {inertia: ...}`",
    "spring": "`coupling: {stiffness: ...}`", "clutch": "`coupling: {stiffness: ..., capacity: ...}`",
    "table": "`- table: line.csv` names a file alone",
    "gearbox": "`gear: {ratio: ...}`", "cardan": "`joint: {angle: ...}`",
}  # fmt: skip


def of_its_number(word: str, candidates: list[str]) -> list[str]:
    """The candidates with the figures of the word, in any order: iacs-m86 is a slip for iacs-m68, iacs-m54 is none."""
    figures = sorted(re.findall(r"\d", word))
    return [one for one in candidates if not figures or sorted(re.findall(r"\d", one)) in ([], figures)]
