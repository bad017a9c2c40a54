"""The manual of the model file, as Markdown pages, from the same declarations that read it and make the JSON Schema.

`python -m torsion.schema.manual` writes the pages to docs/reference/model-file.
"""

import sys
from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from importlib.resources import files
from pathlib import Path
from string import Template

from torsion import units
from torsion.analyses import ANALYSES, MODELS, settings_classes
from torsion.fields import Declared, Quantity
from torsion.model import KINDS, KINDS_BY_ALIAS, component_class
from torsion.model.component import STEEL, Component, Material
from torsion.model.machine_torques import Excitation
from torsion.rules import RULES
from torsion.rules import settings as rule_settings
from torsion.schema import template
from torsion.schema.aliases import aliases_of
from torsion.schema.cases import CaseKeys
from torsion.schema.declaration_reader import items_of, keys_of, mappings_of
from torsion.schema.key_tables import key_table, tables_with_parts
from torsion.schema.other_words import SECTIONS_BY_ALIAS
from torsion.schema.scene_reader import LINKS, Scene
from torsion.study import FiniteElements, FrontMatter, ModalDamping, Operation

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
    texts["components/index.md"] = _page(
        "components", kinds=_kinds(), common=key_table(Component), toctree=toctree(KINDS)
    )
    analyses = toctree(settings_classes())
    texts["analyses/index.md"] = _page(
        "analyses", models=_words(MODELS), fem=key_table(FiniteElements), toctree=analyses
    )
    texts["rules/index.md"] = _page("rules", toctree=toctree(RULES))
    texts["index.md"] = _page(
        "index",
        top=key_table(Scene).replace("see meaning", "section below"),
        quantities=_quantities(),
        aliases=_words(SECTIONS_BY_ALIAS[""]),
        toctree=toctree(
            [
                "operation",
                "materials",
                "components/index",
                "links",
                "excitations",
                "damping",
                "analyses/index",
                "rules/index",
                "cases",
                "document",
                "tables",
            ]
        ),
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


def declarations() -> dict[str, type[Declared]]:
    """Every declaration of the format by its word in the file."""
    return {
        **{kind: component_class(kind) for kind in KINDS},
        "document": FrontMatter,
        "material": Material,
        "operation": Operation,
        "damping": ModalDamping,
        "excitation": Excitation,
        "fem": FiniteElements,
        "case": CaseKeys,
        **settings_classes(),
        **{name: rule_settings(name) for name in RULES},
    }


def first_line(declared: type) -> str:
    """Return the first line of a docstring, with PYTHONOPTIMIZE=2 an empty text."""
    return (declared.__doc__ or "").strip().partition("\n")[0]


def toctree(names: Iterable[str]) -> str:
    """Return the list of pages for the site's navigation."""
    return "```{toctree}\n:maxdepth: 1\n\n" + "\n".join(names) + "\n```\n"


def _page(name: str, **parts: str) -> str:
    """Return the page of a template in the folder `model_file`; `$docs` leads to the folder docs."""
    return Template(_template(f"model_file/{name}.md")).substitute(docs="../..", **parts)


def _template(name: str) -> str:
    """Return a template, or an empty text if there is none."""
    path = files("torsion.schema").joinpath("templates", *name.split("/"))
    return path.read_text(encoding="utf-8") if path.is_file() else ""


def _section(name: str) -> str:
    """Return the page of a section of the file."""
    steel = f"G {STEEL.shear_modulus / 1e9:g} GPa, E {(STEEL.youngs_modulus or 0.0) / 1e9:g} GPa, "
    steel += f"rho {STEEL.density:g} kg/m**3"
    declarations_of_sections: dict[str, type[Declared]] = {
        "operation": Operation,
        "materials": Material,
        "document": FrontMatter,
        "damping": ModalDamping,
        "excitations": Excitation,
        "cases": CaseKeys,
    }
    declared = declarations_of_sections.get(name)
    table = "" if declared is None else "## Keys\n\n" + tables_with_parts(declared)
    return _page(name, table=table, steel=steel, links=_words(LINKS)) + _aliases(
        SECTIONS_BY_ALIAS.get(name, {})
    )


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
    return (
        text
        + _notes("components", kind)
        + _aliases(aliases)
        + "\n[Keys of every component](index.md)\n"
    )


def _settings(section: str, name: str, declared: type[Declared]) -> str:
    """Return the page of an analysis or a rule."""
    named = ANALYSES[name].title if name in ANALYSES else name
    title, sentence = titles().get(name, (named, ""))
    parts = [f"# `{name}`: {title}", sentence]
    if setting := setting_examples().get(name):
        item = "- " if section == "rules" else ""
        example = (item + setting).replace("\n", "\n  ")
        parts.append(f"```yaml\n{section}:\n  {example}\n```")
    text = "\n\n".join(part for part in parts if part)
    return (
        f"{text}\n\n## Keys\n\n{tables_with_parts(declared)}"
        + _notes(section, name)
        + _aliases(SECTIONS_BY_ALIAS.get(name, {}))
    )


def _notes(section: str, name: str) -> str:
    """Return the notes of a page, if it has any."""
    notes = _template(f"{section}/{name}.md")
    return f"\n## Notes\n\n{notes}" if notes else ""


def _aliases(aliases: Mapping[str, str]) -> str:
    """Return the table of aliases of a page, if it has any."""
    rows = [f"| `{alias}` | `{key}` |" for alias, key in aliases.items()]
    head = "\n## Aliases\n\nGive only one word for a key.\n\n| alias | key |\n|---|---|\n"
    return head + "\n".join(rows) + "\n" if rows else ""


def _kinds() -> str:
    """Return a table of all kinds."""
    rows = ["| kind | component |", "|---|---|"]
    rows += [f"| [`{kind}`]({kind}.md) | {component_class(kind).title} |" for kind in KINDS]
    return "\n".join(rows) + "\n"


def _words(names: Iterable[str]) -> str:
    return ", ".join(f"`{name}`" for name in names)


def _quantities() -> str:
    """Return a table of every SI unit of the format with what it measures."""
    quantities = (
        quantity for declared in declarations().values() for quantity in _quantities_of(declared)
    )
    rows = ["| quantity | SI unit | a bare number |", "|---|---|---|"]
    for unit in dict.fromkeys(quantity.unit for quantity in quantities):
        bare = (
            "is an error"
            if units.needs_unit(unit)
            else "is in the SI unit"
            if unit != "1"
            else "or a percentage"
        )
        rows.append(f"| {units.speak(unit)} | {'' if unit == '1' else f'`{unit}`'} | {bare} |")
    return "\n".join(rows) + "\n"


def _quantities_of(declared: type[Declared]) -> Iterator[Quantity]:
    """Yield every quantity in a declaration and in its mappings, without components."""
    for field in declared.model_fields.values():
        yield from (item for item in items_of(field) if isinstance(item, Quantity))
        for part in mappings_of(field):
            if not issubclass(part, Component):
                yield from _quantities_of(part)


if __name__ == "__main__":
    write_pages(Path(*sys.argv[1:] or [FOLDER]), pages())


@cache
def titles() -> dict[str, tuple[str, str]]:
    """Return title and first sentence of the page of every analysis and rule by its name."""
    lines = template("titles.txt").splitlines()
    rows = (line.split(" | ") for line in lines if not line.startswith("#"))
    return {name: (title, sentence) for name, title, sentence in rows}


@cache
def setting_examples() -> dict[str, str]:
    """Return an example of the settings of every analysis and rule by its name."""
    examples = template("setting_examples.txt").strip().split("\n\n")
    return {example.partition(":")[0]: example for example in examples}
