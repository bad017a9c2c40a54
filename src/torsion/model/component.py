"""What every component is: a frozen declaration of its fields, and how it lowers to primitives."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Annotated, Any, ClassVar, Literal

from pydantic import InstanceOf, WithJsonSchema

from torsion.errors import Path
from torsion.fields import Sized, given
from torsion.model.lowering import Arrival, Lowering, Part


def section_name(shaft: str, number: int) -> str:
    """Return the name of a section of a shaft; `Part.whole` is the way back.

    >>> section_name("line", 2)
    'line [2]'
    """
    return f"{shaft} [{number}]"


class Component(Sized):
    """One entry of the train."""

    keyword: ClassVar[str]  # its kind, the key of its entry in the train
    sort: ClassVar[Literal["point", "link", "line", "none"]]  # line: points and links in a row
    unbuilt: ClassVar[tuple[str, ...]] = ()  # keys of the format that are not built yet
    title: ClassVar[str]  # of its page in the manual
    example: ClassVar[str] = ""  # entries of a train
    groups: ClassVar[tuple[tuple[str, str], ...]] = ()  # of its keys in the manual: heading, keys

    name: str | None = given(
        "name by which excitations, links and results call it (default: kind and number)"
    )
    note: str | None = given("free text")
    source: str | None = given("source of the data: manufacturer, drawing, estimate")

    def __init_subclass__(cls, **facts: Any) -> None:
        super().__init_subclass__()
        for name, fact in facts.items():
            setattr(cls, name, fact)

    def lower(self, build: Lowering) -> None:
        """Add this component's stations and primitives where the train has arrived."""
        raise NotImplementedError

    def enter(self, build: Lowering, path: Path) -> None:
        """Make this component a part of the train where that has arrived, and lower it; `path` is its entry's."""
        build.number[self.keyword] += 1
        part = Part(
            self.name or f"{self.keyword}-{build.number[self.keyword]}",
            self.keyword,
            self.sort == "point",
            (*path, self.keyword),
            ratio=build.arrival.ratio,
            depth=build.arrival.depth,
            referred_to=build.arrival.referred_to,
            is_named=self.name is not None,
            note=self.note,
            source=self.source,
        )
        build.parts.append(part)
        self.lower(build)


Line = Annotated[
    tuple[InstanceOf[Component], ...], WithJsonSchema({"allOf": [{"$ref": "#/$defs/train"}]})
]  # a train in a component


def lower_line(build: Lowering, components: Sequence[Component], path: Path) -> None:
    """Lower a list of components, each from where the one before it ended."""
    for position, component in enumerate(components):
        component.enter(build, (*path, position))


def lower_branch(
    build: Lowering, start: Arrival, components: Sequence[Component], path: Path
) -> None:
    """Lower a branch from `start`, then return to where the train had arrived."""
    main, build.arrival = build.arrival, replace(start, depth=start.depth + 1)
    lower_line(build, components, path)
    build.arrival = main
