"""The manual of the file, as Markdown, from the same declarations that read it and that make the JSON Schema."""

from collections.abc import Iterator, Mapping
from fractions import Fraction
from string import Template
from types import UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic import BeforeValidator
from pydantic.fields import FieldInfo
from pydantic_core import PydanticUndefined

from torsion import units
from torsion.analyses import MODELS, UNBUILT, settings_classes
from torsion.components import KINDS, component
from torsion.components.component import Component
from torsion.components.harmonic_torques import Excitation
from torsion.components.material import STEEL, Material
from torsion.fields import SHARE_OF_MEAN, Amount, Declared, OneOrMany, Quantity
from torsion.rules import RULES
from torsion.rules import settings as rule_settings
from torsion.schema import template
from torsion.schema.cases import CaseKeys
from torsion.schema.declaration_reader import items_of, keys_of, mappings_of
from torsion.schema.kind_texts import EXAMPLES, NOTES
from torsion.schema.scene_reader import LINKS, Scene
from torsion.study import FiniteElements, FrontMatter, ModalDamping, Operation

PLAIN = {
    str: "text", bool: "`true` or `false`", int: "a whole number", float: "a number",
    Fraction: "an exact number: `2`, `0.5` or `21/8`", Amount: "N*m, `5 %` or `{of_mean: 5 %}`",
}  # fmt: skip
COMPONENT, MAPPING = "a component", "a mapping, below"
SEVERAL = {COMPONENT: "components", MAPPING: "mappings, below"}
SETTINGS = {  # an example of every analysis and rule
    "modes": "modes: {count: 8}",
    "response": "response: {orders: [2, 21/8], frequencies: {from: 1 Hz, to: 200 Hz, steps: 400}}",
    "stability": "stability: {speeds: {from: 300 rpm, to: 1800 rpm}, map: {over: angle, from: 1 deg, to: 20 deg}}",
    "joints": "joints: {optimise: phase, torque: 800 N*m}",
    "lateral": "lateral: {modes: 4, shear: true}",
    "transient": "transient: {duration: 2 s, events: [{at: motor-1, time: 0.1 s, step: {torque: 100 N*m}}]}",
    "tolerances": "tolerances: {aim: [{mode: 2, frequency: 40 Hz}]}",
    "sweep": "sweep: {vary: {coupling-1.stiffness: {uniform: +-15 %}, disc-1.inertia: {normal: 2 %}}, samples: 256}",
    "fit": "fit:\n  vary: {coupling-1.stiffness: 20 %, disc-1.inertia: 5 %}\n  measured:\n"
    "  - {mode: 1, frequency: 17.9 Hz, within: 0.5 %}\n"
    "  - {torsiogram: [{speed: 600 rpm, amplitude: 0.1 deg}], at: motor-1, order: 2, quantity: angle, within: 5 %}",
    "design": "design: {choose: {shaft-1.diameter: {from: 55 mm, to: 80 mm}},\n"
    "         keep: [{mode-2.frequency: {outside: [30 Hz, 36 Hz]}}]}",
    "check": "check: {models: [lumped, exact], tolerance: 0.1 %}",
    "iacs-m68": "iacs-m68: {drive: electric, tachometer: 2 %}",
    "iacs-m53": "iacs-m53: {pin: 200 mm, journal: 200 mm, pin_fillet: 12 mm, journal_fillet: 12 mm,\n"
    "           web_thickness: 70 mm, web_width: 260 mm, radius: 140 mm, bending: 40 MPa, shear: 5 MPa, strokes: 4}",
    "kr": "kr: {strokes: 4, arrangement: in-line, cylinders: 6, duty: generator set}",
    "lr": "lr: {tachometer: 2 %}",
    "dnv": "dnv: {drive: electric}",
    "abs": "abs: {alloy: line shaft}",
    "bv": "bv: {drive: slip coupling}",
    "ccs": "ccs: {tachometer: 2 %}",
    "nk": "nk: {strokes: 2, arrangement: in-line}",
    "rina": "rina: {drive: turbine}",
    "api-610": "api-610: {continuous: {from: 1450 rpm, to: 1500 rpm}, line_frequency: 50 Hz}",
    "api-617": "api-617: {line_frequency: {nominal: 60 Hz, tolerance: 2 %}}",
    "api-618": "api-618: {continuous: {from: 980 rpm, to: 990 rpm}, line_frequency: 50 Hz}",
    "api-684": "api-684: {continuous: {from: 3000 rpm, to: 3600 rpm}}",
    "mil-std-167": "mil-std-167: {continuous: {from: 400 rpm, to: 1200 rpm}}",
    "engine-maker": "engine-maker: {crank_stress: 40 MPa}",
    "nvh": "nvh: {at: gearbox, acceleration: 300 rad/s**2, fluctuation: 15 rpm, order: 3}",
    "coupling-maker": "coupling-maker: {continuous: {from: 400 rpm, to: 1800 rpm}}",
    "gear-hammer": "gear-hammer: {limit: 0.35}",
    "fillets": "fillets: {continuous: {from: 600 rpm, to: 1500 rpm}}",
    "shrink-fits": "shrink-fits: {safety: 2}",
    "ice": "ice: {factor: 1.3}",
    "universal-joints": "universal-joints: {speed_angle: 17000}",
}


def manual() -> str:
    """The text of docs/format.md."""
    return Template(template("manual.md")).substitute(
        quantities=_quantities(),
        top=_table(Scene).replace("see meaning", "section below"),
        document=_table(FrontMatter),
        material=_table(Material),
        steel=f"G {STEEL.shear_modulus / 1e9:g} GPa, E {(STEEL.youngs_modulus or 0.0) / 1e9:g} GPa, "
        f"rho {STEEL.density:g} kg/m**3",
        operation=_with_parts(Operation),
        damping=_table(ModalDamping),
        common=_table(Component),
        kinds="\n".join(_kind(kind) for kind in KINDS),
        links=_words(LINKS),
        excitation=_with_parts(Excitation),
        models=_words(MODELS),
        fem=_table(FiniteElements),
        analyses="\n".join(_settings("analysis", name, kind) for name, kind in settings_classes().items()),
        rules="\n".join(_settings("rule", name, rule_settings(name)) for name in RULES),
        cases=_table(CaseKeys),
        unbuilt=_unbuilt(),
    )


def _kind(kind: str) -> str:
    """The section of one kind: what it is, its keys, an example."""
    declared = component(kind)
    sort = {"point": "a point", "link": "a link", "line": "points and links in a row", "none": "is carried by a point"}[
        declared.sort
    ]
    example = f"```yaml\n{EXAMPLES[kind]}\n```\n"
    words = " ".join([(declared.__doc__ or "").strip().partition("\n")[0], *([NOTES[kind]] if kind in NOTES else [])])
    return f"### `{kind}`: {sort}\n\n{words}\n\n{_with_parts(declared, Component)}\n{example}"


def _settings(what: str, name: str, declared: type[Declared]) -> str:
    """The section of an analysis or a rule."""
    example = f"\n```yaml\n{SETTINGS[name]}\n```\n" if name in SETTINGS else ""
    return f"### {what} `{name}`\n\n{_with_parts(declared)}{example}"


def _with_parts(declared: type[Declared], common: type[Declared] | None = None) -> str:
    """The keys of a declaration, then those of every mapping in it and in these, once; `common` has others."""
    text, parts, left = _table(declared, common), dict[type[Declared], str](), [declared]
    while left:
        for key, field in sorted(keys_of(left.pop(0)).items(), key=lambda entry: not entry[1].is_required()):
            for part in mappings_of(field):
                if not issubclass(part, Component) and part not in parts:
                    parts[part] = key
                    left.append(part)
    return text + "".join(f"\nKeys of `{key}`:\n\n{_table(part)}" for part, key in parts.items())


def _words(names: tuple[str, ...]) -> str:
    return ", ".join(f"`{name}`" for name in names)


def declarations() -> dict[str, type[Declared]]:
    """Every declaration of the format by its word in the file."""
    return {
        **{kind: component(kind) for kind in KINDS},
        "document": FrontMatter,
        "material": Material, "operation": Operation, "damping": ModalDamping, "excitation": Excitation,
        "fem": FiniteElements, "case": CaseKeys,
        **settings_classes(), **{name: rule_settings(name) for name in RULES},
    }  # fmt: skip


def _quantities() -> str:
    """Every SI unit of the format with what it measures."""
    every = (quantity for declared in declarations().values() for quantity in _quantities_of(declared))
    rows = ["| quantity | SI unit | a bare number |", "|---|---|---|"]
    for unit in dict.fromkeys(quantity.unit for quantity in every):
        bare = "is an error" if units.needs_unit(unit) else "is in the SI unit" if unit != "1" else "or a percentage"
        rows.append(f"| {units.speak(unit)} | {'' if unit == '1' else f'`{unit}`'} | {bare} |")
    return "\n".join(rows) + "\n"


def _unbuilt() -> str:
    """What the format has a word for and the program refuses, as a list."""
    rows = [f"- keys of `{kind}`: {_words(component(kind).unbuilt)}" for kind in KINDS if component(kind).unbuilt]
    rows += [f"- analyses: {_words(UNBUILT)}"]
    return "\n".join(rows) + "\n"


def _quantities_of(declared: type[Declared]) -> Iterator[Quantity]:
    """Every quantity in a declaration and in its mappings, components left out."""
    for field in declared.model_fields.values():
        yield from (item for item in items_of(field) if isinstance(item, Quantity))
        for part in mappings_of(field):
            if not issubclass(part, Component):
                yield from _quantities_of(part)


def _table(declared: type[Declared], without: type[Declared] | None = None) -> str:
    """A Markdown table of the keys, the required ones first, but for those that `without` has already."""
    known = set(without.model_fields) if without is not None else set()
    rows = ["| key | value | limits | default | meaning |", "|---|---|---|---|---|"]
    for key, field in sorted(keys_of(declared).items(), key=lambda entry: not entry[1].is_required()):
        if key not in known:
            whole = Annotated[(field.annotation, *field.metadata)] if field.metadata else field.annotation
            limits = ", ".join(dict.fromkeys(_limits(field)))
            cells = (f"`{key}`", _value(whole), limits, _default(field), field.description or "")
            rows.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
    return "\n".join(rows) + "\n" if len(rows) > 2 else "It has no settings.\n"


def _value(annotation: Any) -> str:
    """What may stand there, in words."""
    metadata: list[Any] = []
    while get_origin(annotation) is Annotated:
        annotation, *more = get_args(annotation)
        metadata += more
    for item in metadata:
        if isinstance(item, Quantity) and item.unit == "1":
            return "a number or %"
        if isinstance(item, Quantity):
            return f"`{item.unit}`" + (", unit required" if units.needs_unit(item.unit) else "")
        if isinstance(item, BeforeValidator):
            if item.func is OneOrMany.func:
                return f"{_value(get_args(annotation)[0])}, or a list"
            if item.json_schema_input_type not in (PydanticUndefined, Any):
                return _value(item.json_schema_input_type)
    origin, inner = get_origin(annotation), get_args(annotation)
    if origin in (Union, UnionType):
        return " or ".join(dict.fromkeys(_value(part) for part in inner if part is not type(None)))
    if origin is Literal:
        return ", ".join(f"`{choice}`" for choice in inner)
    if origin is tuple:
        words = [_value(part) for part in inner if part is not Ellipsis]
        return f"a list of {SEVERAL.get(words[0], words[0])}" if inner[-1] is Ellipsis else f"[{', '.join(words)}]"
    if origin in (dict, Mapping):
        return f"a mapping of names to {_value(inner[1])}"
    if isinstance(annotation, type) and issubclass(annotation, Declared):
        return COMPONENT if issubclass(annotation, Component) else MAPPING
    return PLAIN.get(annotation, "see meaning")


def _limits(field: FieldInfo) -> Iterator[str]:
    for item in items_of(field):
        if isinstance(item, Quantity):
            yield from (f"{words} {limit:.5g}" for words, limit, _ in item.limits)
            yield f"usually {item.usual_words()}"
        if item is Amount:
            yield f"usually {SHARE_OF_MEAN.usual_words()} of the mean"
        for words, name in (("at least", "ge"), ("at most", "le")):
            if isinstance(limit := getattr(item, name, None), int):
                yield f"{words} {limit}"


def _default(field: FieldInfo) -> str:
    if field.is_required():
        return "**required**"
    value = field.default
    if isinstance(value, tuple) and len(value) == 1:
        value = value[0]
    if value is None or value in ((), "", {}):
        return ""
    return f"`{str(value).lower()}`" if isinstance(value, bool | str) else f"`{value:g}`"
