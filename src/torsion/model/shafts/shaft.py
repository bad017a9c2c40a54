"""A shaft: distributed inertia and stiffness from its dimensions and material; uniform, conical or of any section."""

import math
from typing import Annotated, Any, Literal

from pydantic import (
    ConfigDict,
    Field,
    ValidationInfo,
    WithJsonSchema,
    field_validator,
)

from torsion import fields
from torsion.fields import (
    Declared,
    OneOrMany,
    Quantity,
    excludes,
    given,
    or_value,
    refuse,
    required,
)
from torsion.model.component import Component, Lowering, Strength
from torsion.model.elastic_element import given_damping
from torsion.model.parts import Role, ShaftRecord, Symbol
from torsion.model.shafts.shaft_details import (
    SOFTEST,
    STIFFEST,
    Hub,
    Notch,
    Step,
    Support,
    both_ends,
    refuse_details,
)
from torsion.primitives import Bar, SectionMesh
from torsion.units import WIDEST

UNITS = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "in": 0.0254}  # m, in which a mesh may be drawn

Feature = Literal[
    "flange",
    "shrink fit",
    "taper keyway",
    "cylinder keyway",
    "radial hole",
    "slot",
    "thrust collar",
    "roller bearing",
    "propeller flange",
    "propeller keyless",
    "propeller keyed",
    "tube shaft",
]
StepOrForm = Annotated[Step, or_value(Step, "form", str)]
ONE_SECTION = {"anyOf": [{"type": "array", "minItems": 2, "maxItems": 3}, {"type": "object"}]}
SECTIONS: dict[str, Any] = {
    "anyOf": [
        {"type": "array", "items": ONE_SECTION, "minItems": 1},
        {"type": "string"},
        {"$ref": "#/$defs/table"},
    ]
}


class MeshedSection(Declared):
    """A cross-section by mesh."""

    mesh: str = required(
        "file of triangles, relative to this file (.msh, .vtk, ...); its origin is the axis",
        min_length=1,
    )
    unit: Literal["m", "cm", "mm", "in"] = given("unit of the mesh's coordinates", "m")


class Shaft(Component, keyword="shaft", sort="link", symbol=Symbol(width=1.6)):
    """A shaft is uniform or conical, solid or hollow, or has any cross-section from a mesh."""

    title = "uniform, conical or stepped shaft"
    example = """\
- shaft: {length: 4.5 m, diameter: 150 mm}
- shaft: {length: 4.5 m, diameter: [150 mm, 140 mm], bore: 40 mm, role: propeller, features: shrink fit}"""
    groups = (
        ("Dimensions", "length diameter bore section sections"),
        ("Material and model", "material loss_factor segments"),
        ("Details and strength", "role features step notches hub endurance"),
        ("Bending", "support"),
    )

    # What an editor requires; the reader puts shafts in the place of their sections first.
    model_config = ConfigDict(
        json_schema_extra=lambda schema: schema.update(
            anyOf=[{"required": schema.pop("required")}, {"required": ["sections"]}]
        )
    )
    clashes = (excludes("section", "notches", "hub", hint="they belong to a round shaft"),)

    length: Annotated[float, Quantity("m", above=0, usual="length of a shaft")] = required("length")
    diameter: Annotated[tuple[fields.Across, ...], OneOrMany] = given(
        "outer diameter, or [from, to] of a cone", ()
    )
    bore: Annotated[tuple[fields.Bore, ...], OneOrMany] = given(
        "bore, or [from, to] of a conical bore", (0.0,)
    )
    section: MeshedSection | None = given(
        "cross-section by mesh, in place of `diameter` and `bore`", validate_default=True
    )
    material: str = given("name of one of `materials`", "steel")
    segments: Annotated[int, Field(ge=1, le=19_999)] | None = given(
        "lumped segments (default: as many as needed)"
    )
    loss_factor: fields.LossFactor | None = given("loss factor (default: the material's)")
    role: Role | None = given("what the class rules call this shaft")
    features: Annotated[tuple[Feature, ...], OneOrMany] = given(
        "details that the rules reduce the limit for", ()
    )
    step: StepOrForm | None = given(
        "corner to the shaft after it: {fillet: 4 mm}, {chamfer: 5 mm}, {undercut: {...}}, {flange: {...}}, sharp, "
        "handbook or none (default: `steps`)"
    )
    endurance: Strength | None = given(
        "amplitude of shear stress that its material endures at the fillet of `step` and in its `notches`, surface and "
        "size counted in; read by the rule `fillets`"
    )
    notches: Annotated[tuple[Notch, ...], OneOrMany] = given(
        "{keyway: {...}}, {splines: {...}} or {hole: 8 mm}, for the stress in them; class rules count them too",
        (),
    )
    hub: Annotated[tuple[Hub, ...], OneOrMany] = given(
        "hub on its end, in which it twists over a part of the seat (default: over all of its length)",
        (),
    )
    support: Annotated[tuple[Support, ...], OneOrMany] = given(
        "bearings on springs that hold the shaft sideways", ()
    )
    sections: Annotated[tuple[Any, ...], WithJsonSchema(SECTIONS)] = given(
        "rows [length, diameter, bore], or with the keys above, in place of `length`; or a CSV file of them",
        (),
    )

    @field_validator("section")
    @classmethod
    def _stands_alone(
        cls, section: MeshedSection | None, info: ValidationInfo
    ) -> MeshedSection | None:
        """Require either `diameter` or `section`; a check of a field is reported beside the faults of others."""
        diameter = info.data.get("diameter")
        if section is None and diameter == ():
            hint = "outer diameter in m, or `section: {mesh: file.msh}`"
            raise refuse("`diameter` is missing", hint)
        if section is not None and diameter:
            message = "a shaft with a `section` has no `diameter`"
            raise refuse(message, "the mesh says the dimensions; remove one")
        return section

    def refuse_clashes(self) -> None:
        if self.section is not None:
            if "bore" in self.model_fields_set:
                message = "a shaft with a `section` has no `bore`"
                raise refuse(message, "the mesh says the dimensions", "bore")
            return
        for key in ("diameter", "bore"):
            if len(getattr(self, key)) not in (1, 2):
                raise refuse(f"`{key}` is one value or [from, to]", key=key)
        pairs = zip(both_ends(self.diameter), both_ends(self.bore), strict=True)
        if any(bore >= outer for outer, bore in pairs):
            raise refuse("the bore is not smaller than the diameter", "both are diameters", "bore")
        if self.notches or self.hub:
            refuse_details(self)
        words, hint = "the length is {} times the diameter", ""
        if self.length > 1.0:
            hint = f"{str(self.length).removesuffix('.0')} mm?"
        slenderness = self.length / min(self.diameter)
        self.refuse_unusual("length over diameter", slenderness, words, hint, "length")

    def lower(self, build: Lowering) -> None:
        record = ShaftRecord(
            self.material,
            self.role,
            self.features,
            self.support,
            step=self.step,
            endurance=self.endurance,
            notches=self.notches,
            hubs=self.hub,
        )
        build.record(record)
        build.place(damping=given_damping(self, ("loss_factor",)))
        ends, material = build.link(), build.material(self.material)
        if material is None:
            return
        for number, hub in enumerate(self.hub):
            # The material of a hub is known here only.
            of_hub = build.material(hub.material, "hub", number) if hub.material else material
            softest = SOFTEST if hub.torque == "face" else 1.0 / STIFFEST
            if of_hub and not softest <= of_hub.shear_modulus / material.shear_modulus <= STIFFEST:
                limits = f"below {softest:g} or above {STIFFEST:g} of the shaft's"
                hint = "give hub and seat as a `coupling`; for a soft hub write `torque: rim`"
                build.fault(f"the shear modulus of the hub is {limits}", hint, "hub", number)
        if self.section is None:
            section, outer, bore = None, both_ends(self.diameter), both_ends(self.bore)
        else:
            widest = math.inf if self.unusual else WIDEST
            section = SectionMesh(self.section.mesh, UNITS[self.section.unit], widest)
            outer = bore = (math.nan, math.nan)
        build.add(
            Bar(
                build.name,
                build.part,
                *ends,
                length=self.length,
                section=section,
                outer=outer,
                bore=bore,
                shear_modulus=material.shear_modulus,
                density=material.density,
                loss_factor=material.loss_factor if self.loss_factor is None else self.loss_factor,
                segments=self.segments,
            )
        )
