"""A shaft: distributed inertia and stiffness from its dimensions and material; uniform, conical or of any section."""

import math
from typing import Annotated, Any, Literal

from pydantic import (
    BeforeValidator,
    ConfigDict,
    Field,
    ValidationInfo,
    WithJsonSchema,
    field_validator,
)

from torsion import fields
from torsion.fields import Declared, OneOrMany, Quantity, given, refuse, required
from torsion.model.component import Component
from torsion.model.lowering import Lowering, Role, ShaftRecord, Support
from torsion.model.material import Material, Strength
from torsion.model.shaft_details import SOFTEST, STIFFEST, Hub, Notch, Step, faults_of
from torsion.primitives import Bar, SectionMesh
from torsion.usual_ranges import WIDEST

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
StepOrForm = Annotated[
    Step,
    BeforeValidator(lambda value: {"form": value} if isinstance(value, str) else value, str | Step),
]
ONE_SECTION = {"anyOf": [{"type": "array", "minItems": 2, "maxItems": 3}, {"type": "object"}]}
SECTIONS: dict[str, Any] = {
    "anyOf": [
        {"type": "array", "items": ONE_SECTION, "minItems": 1},
        {"type": "string"},
        {"$ref": "#/$defs/table"},
    ]
}


def _length_or_sections(schema: dict[str, Any]) -> None:
    """What is required in an editor; the reader puts shafts in the place of their sections first."""
    schema["anyOf"] = [{"required": schema.pop("required")}, {"required": ["sections"]}]


class MeshedSection(Declared):
    """A cross-section by mesh."""

    mesh: str = required(
        "file of triangles, relative to this file (.msh, .vtk, ...); its origin is the axis",
        min_length=1,
    )
    unit: Literal["m", "cm", "mm", "in"] = given("unit of the mesh's coordinates", "m")


class Shaft(Component, keyword="shaft", sort="link"):
    """A uniform or conical shaft, solid or hollow, or one of any cross-section."""

    model_config = ConfigDict(json_schema_extra=_length_or_sections)

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
    segments: Annotated[int, Field(ge=1, le=1_000_000)] | None = given(
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
        cls, section: MeshedSection | None, known: ValidationInfo
    ) -> MeshedSection | None:
        """Of `diameter` and `section` one is there; a check of a field is reported beside the faults of others."""
        if section is None and known.data.get("diameter") == ():
            raise refuse(
                "`diameter` is missing", "outer diameter in m, or `section: {mesh: file.msh}`"
            )
        if section is not None and known.data.get("diameter"):
            raise refuse(
                "a shaft with a `section` has no `diameter`",
                "the mesh says the dimensions; remove one",
            )
        return section

    def refuse_clashes(self) -> None:
        if self.section is not None:
            if "bore" in self.model_fields_set:
                raise refuse(
                    "a shaft with a `section` has no `bore`", "the mesh says the dimensions", "bore"
                )
            if self.notches or self.hub:
                faults_of(self)
            return
        for key in ("diameter", "bore"):
            if len(getattr(self, key)) not in (1, 2):
                raise refuse(f"`{key}` is one value or [from, to]", key=key)
        pairs = zip(_ends(self.diameter), _ends(self.bore), strict=True)
        if any(bore >= outer for outer, bore in pairs):
            raise refuse("the bore is not smaller than the diameter", "both are diameters", "bore")
        if self.notches or self.hub:
            faults_of(self)
        words, hint = (
            "the length is {} times the diameter",
            str(self.length).removesuffix(".0") + " mm?" if self.length > 1.0 else "",
        )
        self.refuse_unusual(
            "length over diameter", self.length / min(self.diameter), words, hint, "length"
        )

    def lower(self, build: Lowering) -> None:
        build.record(
            shaft=ShaftRecord(
                self.material,
                self.role,
                self.features,
                self.support,
                step=self.step,
                endurance=self.endurance,
                notches=self.notches,
                hubs=self.hub,
            ),
            damping=None if self.loss_factor is None else ("loss_factor", self.loss_factor),
        )
        driving, driven = build.link()
        material = build.material(self.material)
        if material is None:
            return
        self._lower_hubs(build, material)
        section, widest = None, math.inf if self.unusual else WIDEST
        if self.section is not None:
            section = SectionMesh(self.section.mesh, UNITS[self.section.unit], widest)
        unknown = (math.nan, math.nan)
        build.add(
            Bar(
                build.name,
                build.part,
                driving,
                driven,
                length=self.length,
                section=section,
                outer=_ends(self.diameter) if section is None else unknown,
                bore=_ends(self.bore) if section is None else unknown,
                shear_modulus=material.shear_modulus,
                density=material.density,
                loss_factor=material.loss_factor if self.loss_factor is None else self.loss_factor,
                segments=self.segments,
            )
        )

    def _lower_hubs(self, build: Lowering, own: Material) -> None:
        """Faults of hubs of another material; raised here, where the materials are known."""
        for number, hub in enumerate(self.hub):
            made_of = build.material(hub.material, "hub", number) if hub.material else own
            least, most = SOFTEST if hub.torque == "face" else 1.0 / STIFFEST, STIFFEST
            if made_of and not least <= made_of.shear_modulus / own.shear_modulus <= most:
                limits = f"below {least:g} or above {most:g} of the shaft's"
                hint = "give hub and seat as a `coupling`; for a soft hub write `torque: rim`"
                build.fault(f"the shear modulus of the hub is {limits}", hint, "hub", number)


def _ends(values: tuple[float, ...]) -> tuple[float, float]:
    return values[0], values[-1]
