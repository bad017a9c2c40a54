"""Patterns by which an editor marks a quantity in the wrong unit: `20 kN/m` for a stiffness.

A pattern refuses the usual spellings of all other quantities and text that begins with no number. Whatever else is
written the reader judges alone, so that no pattern refuses what the reader takes.
"""

from torsion import units

_AND = "(?: ?[*·⋅×-] ?| )?"  # between two units of a product
_SIGN = "(?: ?[*·⋅×-] ?| )"  # between a force and a time: `kgfs` is a force, `lbf ins` a torque: pint knows plurals
_PER = " ?/ ?"
_FORCE = "(?:[kMG]?N|kgf|kp|lbf)"
_LENGTH = "(?:[mck]?m|in|ft)"
_ANGLE = "(?:m?rad|deg|°|turn|rev)"
_MASS = "(?:kg|g|t|lb)"
_TIME = "(?:ms|s)"
_TORQUE = f"{_FORCE}{_AND}{_LENGTH}"
_MOMENTUM = f"(?:[kMG]?Nm{_TIME}|{_TORQUE}{_SIGN}{_TIME})"
_SPELLINGS = {  # SI unit: its usual spellings; those that stand for two quantities, as 1/min, stand nowhere
    "1": "(?:%|ppm)",
    "rad": _ANGLE,
    "rad/s": f"(?:rpm|RPM|{_ANGLE}{_PER}(?:s|min))",
    "Hz": "(?:[kM]?Hz|1/s)",
    "s": f"(?:{_TIME}|min|h|hour)",
    "degC": "(?:°C|degC)",
    "K": "K",
    "N*m/rad": f"{_TORQUE}{_PER}{_ANGLE}",
    "rad/(N*m)": f"{_ANGLE}{_PER}(?:{_FORCE}{_LENGTH}|\\({_TORQUE}\\))",
    "N*m*s/rad": f"{_MOMENTUM}{_PER}{_ANGLE}",
    "kg*m**2": f"{_MASS}{_AND}{_LENGTH}(?:\\*\\*|\\^)?[2²]",
    "N*m": f"(?:{_TORQUE}|[kM]?J)",
    "W": "(?:[kM]?W|PS|hp)",
    "m": _LENGTH,
    "m**2": f"{_LENGTH}(?:\\*\\*|\\^)?[2²]",
    "m**3": f"{_LENGTH}(?:\\*\\*|\\^)?[3³]",
    "m/s": f"(?:{_LENGTH}{_PER}s|km/h)",
    "m**2/s": f"(?:{_LENGTH}(?:\\*\\*|\\^)?[2²]{_PER}s|c?St)",
    "rad/s**2": f"{_ANGLE}{_PER}s(?:\\*\\*|\\^)?[2²]",
    "kg": _MASS,
    "kg/m**3": f"{_MASS}{_PER}{_LENGTH}(?:\\*\\*|\\^)?[3³]",
    "N": _FORCE,
    "N/m": f"{_FORCE}{_PER}{_LENGTH}",
    "N*s/m": f"(?:[kMG]?Ns|{_FORCE}{_SIGN}{_TIME}){_PER}{_LENGTH}",
    "Pa": f"(?:[kMG]?Pa|bar|{_FORCE}{_PER}{_LENGTH}(?:\\*\\*|\\^)?[2²])",
    "N*m*s": _MOMENTUM,
}
_ALSO = {"degC": "K"}  # SI unit: another, in which the reader takes it too
_NUMBER = "[+−-]?(?:[0-9][0-9_]*\\.?[0-9_]*|\\.[0-9][0-9_]*)(?:[eE][+-]?[0-9]+)?"


def spellings(unit: str) -> str:
    """A regular expression of the usual spellings of an SI unit."""
    return _SPELLINGS[unit]


def pattern(*expected: str) -> str:
    """A regular expression, of Python and of ECMAScript, that quantities in one of these SI units fulfil.

    >>> import re
    >>> [bool(re.search(pattern("N*m/rad"), text)) for text in ("20 kN*m/rad", "3 lbf-in/deg", "20 kN/m", "soft")]
    [True, True, False, False]
    """
    taken = {*expected, *(_ALSO.get(unit, unit) for unit in expected)}
    others = "|".join(spelling for unit, spelling in _SPELLINGS.items() if unit not in taken)
    bare = "?" if all(map(units.needs_unit, expected)) else ""
    return f"^(?!\\s*{_NUMBER}\\s*(?:{others}){bare}\\s*$)\\s*[+−-]?\\.?[0-9]"


def definition(expected: tuple[str, ...]) -> dict[str, object]:
    """The schema of a text in one of these SI units."""
    words = " or ".join(
        f"{units.speak(unit)}" + ("" if unit == "1" else f" in {unit}") for unit in expected
    )
    shown = [units.example(unit) for unit in expected]
    return {
        "type": "string",
        "description": f"{words}, for example {' or '.join(shown)}",
        "pattern": pattern(*expected),
        "examples": shown,
    }
