"""What every component is: a frozen declaration of its fields, and how it lowers to primitives."""

from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import InstanceOf, WithJsonSchema

from torsion.fields import Sized, given

if TYPE_CHECKING:
    from torsion.components.lowering import Lowering


class Component(Sized):
    """One entry of the train."""

    keyword: ClassVar[str]  # its kind, the key of its entry in the train
    sort: ClassVar[Literal["point", "link", "none"]]
    unbuilt: ClassVar[tuple[str, ...]] = ()  # keys of the format that are refused because they are not built yet

    name: str | None = given("name by which excitations, links and results call it (default: kind and number)")
    note: str | None = given("free text")
    source: str | None = given("where the figures come from: maker, drawing, estimate")

    def __init_subclass__(cls, **facts: Any) -> None:
        super().__init_subclass__()
        for name, fact in facts.items():
            setattr(cls, name, fact)

    def lower(self, build: "Lowering") -> None:
        """Add this component's stations and primitives where the train has arrived."""
        raise NotImplementedError


Line = Annotated[
    tuple[InstanceOf[Component], ...], WithJsonSchema({"allOf": [{"$ref": "#/$defs/train"}]})
]  # a train in a component
