"""Words that are no kind or rule of the format, and what the format has for them."""

import re

ABSORBS = "`propeller` for what absorbs the power, `motor` for what drives"
KIND_FOR = {
    "generator": ABSORBS, "alternator": ABSORBS, "pump": ABSORBS, "fan": ABSORBS, "impeller": ABSORBS,
    "compressor": ABSORBS, "turbine": ABSORBS, "flywheel": "`disc: {inertia: ...}`",
    "spring": "`coupling: {stiffness: ...}`", "clutch": "`coupling: {stiffness: ..., capacity: ...}`",
    "table": "`- table: line.csv` names a file alone",
    "gearbox": "`gear: {ratio: ...}`", "cardan": "`joint: {angle: ...}`",
}  # fmt: skip
RULE_FOR = {
    "iacs-m53": "UR M53 is about crankshafts of engines and is not built; `iacs-m68` is another rule, about shafts",
}


def of_its_number(word: str, candidates: list[str]) -> list[str]:
    """The candidates with the figures of the word, in any order: iacs-m86 is a slip for iacs-m68, iacs-m53 is none."""
    figures = sorted(re.findall(r"\d", word))
    return [one for one in candidates if not figures or sorted(re.findall(r"\d", one)) in ([], figures)]
