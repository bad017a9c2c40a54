"""The manual of the model file, as Markdown pages, from the same declarations that read it and make the JSON Schema.

`python -m docs.site.model_file_manual` writes the pages to docs/reference/model-file.
"""

import sys
from collections.abc import Iterable, Mapping
from fractions import Fraction
from importlib.resources import files
from pathlib import Path
from string import Template
from types import UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic import BeforeValidator
from pydantic.fields import FieldInfo
from pydantic_core import PydanticUndefined

from torsion import units
from torsion.analyses import ANALYSES, MODELS, settings_classes
from torsion.fields import SHARE_OF_MEAN, Amount, Declared, OneOrMany, Quantity
from torsion.model import KINDS, KINDS_BY_ALIAS
from torsion.model.component import STEEL, Component, component_class
from torsion.rules import RULES
from torsion.rules import settings as rule_settings
from torsion.schema import template
from torsion.schema.aliases import aliases_of
from torsion.schema.declaration_reader import SECTIONS_BY_ALIAS, items_of, keys_of, mappings_of
from torsion.schema.json_schema import declarations, first_line, parts_within, setting_examples
from torsion.schema.scene_reader import LINKS, Scene
from torsion.study import FiniteElements

FOLDER = "docs/reference/model-file"
SECTIONS = (
    "operation",
    "materials",
    "document",
    "damping",
    "links",
    "excitations",
    "cases",
)  # pages of top-level keys
SORTS = {
    "point": "A point: it has an angle and an inertia.",
    "link": "A link: it joins the previous point to the next point.",
    "line": "A row of points and links.",
    "none": "It starts at the previous point.",
}


def pages() -> dict[str, str]:
    """Return the text of every page by its path in `FOLDER`."""
    texts = {f"{name}.md": _section(name) for name in (*SECTIONS, "tables")}
    texts |= {f"components/{kind}.md": _kind(kind) for kind in KINDS}
    texts |= {
        f"analyses/{name}.md": _settings("analyses", name, kind)
        for name, kind in settings_classes().items()
    }
    texts |= {f"rules/{name}.md": _settings("rules", name, rule_settings(name)) for name in RULES}
    kinds = [f"| [`{kind}`]({kind}.md) | {component_class(kind).title} |" for kind in KINDS]
    rows = "\n".join(["| kind | component |", "|---|---|", *kinds]) + "\n"
    texts["components/index.md"] = _page(
        "components", kinds=rows, common=key_table(Component), toctree=toctree(KINDS)
    )
    analyses = toctree(settings_classes())
    texts["analyses/index.md"] = _page(
        "analyses", models=_words(MODELS), fem=key_table(FiniteElements), toctree=analyses
    )
    texts["rules/index.md"] = _page("rules", toctree=toctree(RULES))
    # Every SI unit of the format with what it measures, and what a number without a unit is.
    quantities = ["| quantity | SI unit | a bare number |", "|---|---|---|"]
    parts = (part for declared in declarations().values() for part in parts_within(declared))
    for unit in dict.fromkeys(part.unit for part in parts if isinstance(part, Quantity)):
        bare = "or a percentage" if unit == "1" else "is in the SI unit"
        bare = "is an error" if units.needs_unit(unit) else bare
        written = "" if unit == "1" else f"`{unit}`"
        quantities.append(f"| {units.speak(unit)} | {written} | {bare} |")
    order = "operation materials components/index links excitations damping analyses/index rules/index cases document tables"
    texts["index.md"] = _page(
        "index",
        top=key_table(Scene).replace("see meaning", "section below"),
        quantities="\n".join(quantities) + "\n",
        aliases=_words(SECTIONS_BY_ALIAS[""]),
        toctree=toctree(order.split()),
    )
    return texts


def write_pages(folder: Path, texts: Mapping[str, str]) -> None:
    """Write every page below `folder`, and remove the pages that no longer exist."""
    for path in folder.rglob("*.md"):
        if path.relative_to(folder).as_posix() not in texts:
            path.unlink()
    for name, text in texts.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8", newline="\n")


def toctree(names: Iterable[str]) -> str:
    """Return the list of pages for the site's navigation."""
    return "```{toctree}\n:maxdepth: 1\n\n" + "\n".join(names) + "\n```\n"


def _page(name: str, **parts: str) -> str:
    """Return the page of a template in the folder `model_file`; `$docs` leads to the folder docs."""
    return Template(template(f"model_file/{name}.md")).substitute(docs="../..", **parts)


def _section(name: str) -> str:
    """Return the page of a section of the file."""
    steel = f"G {STEEL.shear_modulus / 1e9:g} GPa, E {(STEEL.youngs_modulus or 0.0) / 1e9:g} GPa, "
    steel += f"rho {STEEL.density:g} kg/m**3"
    declared = declarations().get(name.removesuffix("s"))  # of entries by the word for one
    table = "" if declared is None else "## Keys\n\n" + tables_with_parts(declared)
    page = _page(name, table=table, steel=steel, links=_words(LINKS))
    return page + _ending("", name, SECTIONS_BY_ALIAS.get(name, {}))


def _kind(kind: str) -> str:
    """Return the page of a kind of component: sentence, examples, keys, notes."""
    declared = component_class(kind)
    introduction = f"{first_line(declared)} {SORTS[declared.sort]}"
    example = f"```yaml\n{declared.example}\n```"
    keys = tables_with_parts(declared, Component, declared.groups)
    text = f"# `{kind}`: {declared.title}\n\n{introduction}\n\n{example}\n\n## Keys\n\n{keys}"
    aliases = {word: name for word, name in KINDS_BY_ALIAS.items() if name == kind} | aliases_of(
        keys_of(declared)
    )
    return text + _ending("components", kind, aliases) + "\n[Keys of every component](index.md)\n"


def _settings(section: str, name: str, declared: type[Declared]) -> str:
    """Return the page of an analysis or a rule."""
    named = ANALYSES[name].title if name in ANALYSES else name
    lines = (line.split(" | ") for line in template("titles.txt").splitlines())
    title, sentence = next((words for key, *words in lines if key == name), (named, ""))
    parts = [f"# `{name}`: {title}", sentence]
    if setting := setting_examples().get(name):
        item = "- " if section == "rules" else ""
        example = (item + setting).replace("\n", "\n  ")
        parts.append(f"```yaml\n{section}:\n  {example}\n```")
    text = "\n\n".join(part for part in parts if part)
    ending = _ending(section, name, SECTIONS_BY_ALIAS.get(name, {}))
    return f"{text}\n\n## Keys\n\n{tables_with_parts(declared)}{ending}"


def _ending(section: str, name: str, aliases: Mapping[str, str]) -> str:
    """Return the notes of a page and its table of aliases, where it has any."""
    file = files("torsion.schema").joinpath("templates", section, f"{name}.md")
    notes = f"\n## Notes\n\n{file.read_text(encoding='utf-8')}" if file.is_file() else ""
    rows = [f"| `{alias}` | `{key}` |" for alias, key in aliases.items()]
    head = "\n## Aliases\n\nGive only one word for a key.\n\n| alias | key |\n|---|---|\n"
    return notes + (head + "\n".join(rows) + "\n" if rows else "")


def _words(names: Iterable[str]) -> str:
    return ", ".join(f"`{name}`" for name in names)


PLAIN = {
    str: "text",
    bool: "`true` or `false`",
    int: "a whole number",
    float: "a number",
    Fraction: "an exact number: `2`, `0.5` or `21/8`",
    Amount: "N*m, `5 %` or `{of_mean: 5 %}`",
}
COMPONENT, MAPPING = "a component", "a mapping, below"
SEVERAL = {COMPONENT: "components", MAPPING: "mappings, below"}
HEAD = ["| key | value | limits | default | meaning |", "|---|---|---|---|---|"]


def key_table(declared: type[Declared], keys: Iterable[str] | None = None) -> str:
    """Return a Markdown table of `keys`, or of all keys, the required keys first."""
    fields = keys_of(declared)
    chosen = list(fields) if keys is None else [key for key in fields if key in set(keys)]
    rows = [
        _row(key, fields[key])
        for key in sorted(chosen, key=lambda key: not fields[key].is_required())
    ]
    return "\n".join([*HEAD, *rows]) + "\n" if rows else "There are no settings.\n"


def tables_with_parts(
    declared: type[Declared],
    common: type[Declared] | None = None,
    groups: Iterable[tuple[str, str]] = (),
) -> str:
    """Return the tables of a declaration without the keys of `common`, then one for every mapping within it.

    groups: headings of groups of keys, with their keys parted by blanks; other keys follow as "Other keys".
    """
    keys = [key for key in keys_of(declared) if common is None or key not in keys_of(common)]
    text = key_table(declared, keys)
    if grouped := {heading: names.split() for heading, names in groups}:
        named = {name for names in grouped.values() for name in names}
        grouped["Other keys"] = [key for key in keys if key not in named]
        text = "\n".join(
            f"### {heading}\n\n{key_table(declared, names)}"
            for heading, names in grouped.items()
            if names
        )

    headings = dict[type[Declared], str]()
    waiting = [declared]
    while waiting:
        for key, field in sorted(
            keys_of(waiting.pop(0)).items(), key=lambda entry: not entry[1].is_required()
        ):
            for part in mappings_of(field):
                if not issubclass(part, Component) and part not in headings:
                    headings[part] = key
                    waiting.append(part)
    return text + "".join(
        f"\n### Keys of `{key}`\n\n{key_table(part)}" for part, key in headings.items()
    )


def _row(key: str, field: FieldInfo) -> str:
    annotation = (
        Annotated[(field.annotation, *field.metadata)] if field.metadata else field.annotation
    )
    limits: dict[str, None] = {}
    for item in items_of(field):
        if isinstance(item, Quantity):
            limits |= dict.fromkeys(f"{words} {limit:.5g}" for words, limit, _ in item.limits)
            limits[f"usually {item.usual_words()}"] = None
        if item is Amount:
            limits[f"usually {SHARE_OF_MEAN.usual_words()} of the mean"] = None
        for words, name in (("at least", "ge"), ("at most", "le")):
            if isinstance(limit := getattr(item, name, None), int):
                limits[f"{words} {limit}"] = None
    default, words = field.default, "**required**"
    if not field.is_required():
        default = default[0] if isinstance(default, tuple) and len(default) == 1 else default
        words = str(default).lower() if isinstance(default, bool | str | None) else ""
        words = f"`{words or f'{default:g}'}`" if default not in (None, (), "", {}) else ""
    cells = (f"`{key}`", _value(annotation), ", ".join(limits), words, field.description or "")
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def _value(annotation: Any) -> str:
    """Return what a value may be, in words."""
    metadata: list[Any] = []
    while get_origin(annotation) is Annotated:
        annotation, *annotations = get_args(annotation)
        metadata += annotations
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
        return (
            f"a list of {SEVERAL.get(words[0], words[0])}"
            if inner[-1] is Ellipsis
            else f"[{', '.join(words)}]"
        )
    if origin in (dict, Mapping):
        return f"a mapping of names to {_value(inner[1])}"
    if isinstance(annotation, type) and issubclass(annotation, Declared):
        return COMPONENT if issubclass(annotation, Component) else MAPPING
    return PLAIN.get(annotation, "see meaning")


if __name__ == "__main__":
    write_pages(Path(*sys.argv[1:] or [FOLDER]), pages())
