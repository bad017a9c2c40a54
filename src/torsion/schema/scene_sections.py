"""The sections of the file beside the train: materials, links, excitations, analyses and rules."""

from typing import TypeVar

from torsion.analyses import ANALYSES, UNBUILT
from torsion.components.harmonic_torques import Excitation
from torsion.components.material import STEEL, Material
from torsion.errors import Fault, Path
from torsion.fields import Declared, shown
from torsion.rules import RULES
from torsion.rules import settings as rule_settings
from torsion.schema.declaration_reader import declared, unbuilt, unknown
from torsion.schema.train_reader import one_component
from torsion.study import ShaftModel
from torsion.train import Link

Found = TypeVar("Found")
LINKS = ("coupling", "shaft")  # kinds that can close a loop


def materials(section: object, faults: list[Fault]) -> dict[str, Material]:
    """The materials; steel stands in for a faulty one, so that the train can still be looked at."""
    path: Path = ("materials",)
    return {
        name: declared(Material, body, (*path, name), faults) or STEEL
        for name, body in _sound(dict, section, path, "`my-steel: {shear_modulus: 79.3 GPa, ...}`", faults).items()
    }


def excitations(section: object, faults: list[Fault]) -> list[Excitation | None]:
    """The excitations, None for a faulty one: their positions are places in the file."""
    entries = _sound(list, section, ("excitations",), "`- {at: motor-1, order: 2, torque: 100 N*m}`", faults)
    return [declared(Excitation, entry, ("excitations", place), faults) for place, entry in enumerate(entries)]


def links(section: object, faults: list[Fault]) -> list[Link | None]:
    """The links that close loops, None for a faulty one."""
    entries = _sound(list, section, ("links",), "`- {between: [a, b], coupling: {stiffness: 2e4}}`", faults)
    return [_link(entry, ("links", place), faults) for place, entry in enumerate(entries)]


def _link(entry: object, path: Path, faults: list[Fault]) -> Link | None:
    kinds = [key for key in entry if key != "between"] if isinstance(entry, dict) else []
    if not isinstance(entry, dict) or len(kinds) != 1:
        faults.append(Fault(path, "a link has `between` and one kind", "`{between: [a, b], coupling: {...}}`"))
        return None
    before = len(faults)
    ends = entry.get("between")
    if not isinstance(ends, list) or len(ends) != 2 or not all(isinstance(end, str) for end in ends):
        where = (*path, "between") if "between" in entry else path
        faults.append(Fault(where, "`between` is a list of the names of two points", "`between: [a, b]`"))
    kind = kinds[0]
    if kind in ("gear", "joint"):
        faults.append(unbuilt((*path, kind), f"a {kind} that closes a loop"))
    elif kind not in LINKS:
        faults.append(unknown((*path, kind), "link", kind, list(LINKS)))
    else:
        read = one_component(kind, entry[kind], (*path, kind), faults)
        if read is not None and len(faults) == before and isinstance(ends, list):
            return Link((ends[0], ends[1]), read)
    return None


def analyses(section: object, faults: list[Fault]) -> dict[str, Declared]:
    """The settings of every analysis that is named; defaults where it is named without any."""
    read: dict[str, Declared] = {}
    path: Path = ("analyses",)
    for name, body in _sound(dict, section, path, "`modes: {count: 6}`", faults).items():
        where = (*path, name)
        if name in ShaftModel.model_fields:
            continue
        if name in UNBUILT:
            faults.append(unbuilt(where, f"`{name}`"))
        elif name not in ANALYSES or not ANALYSES[name].settings:
            known = [key for key, analysis in ANALYSES.items() if analysis.settings]
            faults.append(unknown(where, "analysis", name, [*ShaftModel.model_fields, *known]))
        elif (settings := declared(ANALYSES[name].settings_class(), body, where, faults)) is not None:
            read[name] = settings
    return read


def shaft_model(section: object, faults: list[Fault]) -> ShaftModel:
    """The model of the shafts; the lumped model where the section names none."""
    stated = section if isinstance(section, dict) else {}
    named = {key: body for key, body in stated.items() if key in ShaftModel.model_fields}
    if "fem" in named:
        named["fem"] = {} if named["fem"] is None else named["fem"]
    return declared(ShaftModel, named, ("analyses",), faults) or ShaftModel()


def rules(section: object, faults: list[Fault]) -> list[tuple[str, Declared]]:
    """The rules with their settings, in the order of the file."""
    read: list[tuple[str, Declared]] = []
    seen: set[str] = set()
    for place, entry in enumerate(_sound(list, section, ("rules",), "`rules: [iacs-m68]`", faults)):
        path: Path = ("rules", place)
        if isinstance(entry, str):
            name, body = entry, None
        elif isinstance(entry, dict) and len(entry) == 1:
            ((name, body),) = entry.items()
            path = (*path, name)
        else:
            hint = "`- iacs-m68`, or `- gear-hammer: {limit: 0.35}`"
            faults.append(Fault(path, f"{shown(entry)} is not a rule", hint))
            continue
        if name not in RULES:
            faults.append(unknown(path, "rule", name, list(RULES)))
            continue
        if name in seen:
            faults.append(Fault(path, f"the rule `{name}` is named twice", "keep one of them", at_key=True))
        seen.add(name)
        if (settings := declared(rule_settings(name), body, path, faults)) is not None:
            read.append((name, settings))
    return read


def _sound(kind: type[Found], section: object, path: Path, example: str, faults: list[Fault]) -> Found:
    """The section as a mapping or a list, empty where it is none."""
    if section is not None and not isinstance(section, kind):
        what = "mapping" if kind is dict else "list"
        faults.append(Fault(path, f"{shown(section)} is not a {what}", f"for example {example}"))
    return section if isinstance(section, kind) else kind()
