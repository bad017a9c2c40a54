"""Faulty files made of the scenes that are shipped: each is one scene with one value changed, by its number."""

import random
from functools import cache
from pathlib import Path
from typing import Any

from torsion.schema.yaml_source import parse_source, yaml_text

SCENES = Path(__file__).parents[2] / "shafting_specs"
KINDS = (
    "delete",
    "null",
    "unit",
    "large",
    "small",
    "repeat",
    "unknown",
    "kind",
    "negative",
    "zero",
)
UNITS = ("kg", "rpm", "N*m/rad", "mm", "Hz", "%", "furlong")
AGAIN = "repeated-key-of-a-mutation"


@cache
def scenes() -> tuple[Path, ...]:
    """Every scene, in the order of its path."""
    return tuple(sorted(SCENES.rglob("*.yaml")))


@cache
def _text(scene: Path) -> str:
    return scene.read_text(encoding="utf-8")


def _places(value: Any) -> list[tuple[Any, Any]]:
    """Every container with the key or position of a value in it."""
    pairs = list(
        value.items()
        if isinstance(value, dict)
        else enumerate(value)
        if isinstance(value, list)
        else ()
    )
    return [(value, step) for step, _ in pairs] + [
        place for _, part in pairs for place in _places(part)
    ]


@cache
def mutation(number: int) -> tuple[Path, str, str]:
    """The scene, what is changed in it, and its text with one value changed; the same for the same number."""
    draw = random.Random(number)
    scene = scenes()[number % len(scenes())]
    kind = KINDS[draw.randrange(len(KINDS))]
    data = parse_source(_text(scene), str(scene)).data
    holder, step = draw.choice(_places(data))
    value = holder[step]
    words, again = f"{kind} `{step}` of {scene.name}", ""
    if kind == "delete":
        del holder[step]
    elif kind == "null":
        holder[step] = None
    elif kind == "unit":
        holder[step] = f"{_number(value) or 5} {draw.choice(UNITS)}"
    elif kind in ("large", "small"):
        holder[step] = _scaled(value, "1e12" if kind == "large" else "1e-12")
    elif kind == "negative":
        holder[step] = _scaled(value, "-1")
    elif kind == "zero":
        holder[step] = _scaled(value, "0")
    elif kind == "unknown" and isinstance(holder, dict):
        holder["an_unknown_key"] = value
    elif kind == "kind":
        holder[step] = draw.choice(([], {}, "a word", True, [value], {"a": value}))
    elif isinstance(holder, dict):
        again = step
        holder[AGAIN] = value
    else:
        holder.insert(step, value)
    return scene, words, yaml_text(data).replace(AGAIN, again)


def _number(value: Any) -> str:
    """The number with which a quantity begins; empty of what is none."""
    text = str(value).split(" ")[0]
    try:
        float(text)
    except ValueError:
        return ""
    return "" if isinstance(value, bool) else text


def _scaled(value: Any, number: str) -> Any:
    """The number in the place of that of a quantity, its unit kept."""
    if isinstance(value, int | float) and not isinstance(value, bool):
        return float(number)
    rest = str(value).split(" ", 1)[1:] if isinstance(value, str) and _number(value) else []
    return " ".join([number, *rest])
