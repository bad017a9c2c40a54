"""Details of a shaft as its drawing has them: steps to the next, keyways, splines, oil holes, hubs, supports."""

import math
from itertools import product
from typing import Annotated, Any, Literal

from pydantic import Field

from torsion import fields
from torsion.fields import (
    Across,
    Declared,
    OneOrMany,
    Quantity,
    exclusive,
    given,
    refuse,
    required,
    together,
)
from torsion.primitives import StepForm

FORMS = ("keyway", "splines", "hole")  # of a notch
Small = Annotated[float, Quantity("m", above=0, usual="detail of a shaft")]
Long = Annotated[float, Quantity("m", above=0, usual="length of a detail")]
LARGEST_HOLE = 0.2  # of the diameter, up to which its factor was measured (IACS UR M53)
THINNEST = 0.05  # wall between a groove and the bore / radius
SOFTEST = 0.1  # shear modulus of a hub / that of its shaft, from which on the elements take its face as fixed
STIFFEST = 1e4  # the same, up to which rounding leaves the bounds in order; of a rim the inverse is the softest
ROOM = 0.8  # of the angle of one of several grooves, that it may take well below its floor


Distance = Annotated[float, Quantity("m", at_least=0)]
LateralStiffness = Annotated[float, Quantity("N/m", at_least=0)]
LateralDamping = Annotated[float, Quantity("N*s/m", at_least=0)]


class Undercut(Declared):
    """A groove in the smaller shaft before the face of the larger one."""

    depth: Small = required("depth below the surface of the smaller shaft")
    width: Small = required("width along the shaft, within its length")
    fillet: Small | None = given("radius between its floor and the face (default: sharp)")


class Flange(Declared):
    """A disc between two shafts, beyond the lengths of both, forged with them."""

    diameter: Small = required("its outer diameter")
    thickness: Small = required("its thickness, in the length of neither shaft")
    fillet: Small | None = given("radius between the smaller shaft and its face (default: sharp)")


class Step(Declared):
    """The corner between this shaft and the one after it, where their diameters differ; one of its keys."""

    form: StepForm | None = given("sharp; by the handbook's table; or none: no additional twist")
    fillet: Small | None = given("radius of the fillet on the smaller shaft")
    chamfer: Small | None = given("leg of a chamfer of 45 degrees in the corner")
    undercut: Undercut | None = given(
        "{depth, width, fillet}: groove in the smaller shaft before the face"
    )
    flange: Flange | None = given(
        "{diameter, thickness, fillet}: disc between the shafts, of their material"
    )

    clashes = (
        exclusive(
            *("form", "fillet", "chamfer", "undercut", "flange"),
            hint="a step has one form; sharp, handbook and none are words for it",
            needed=True,
        ),
    )

    @property
    def round(self) -> float:
        """m, radius of its fillet; 0 where it has none."""
        groove_or_flange = self.undercut or self.flange
        return self.fillet or (groove_or_flange and groove_or_flange.fillet) or 0.0

    @property
    def size(self) -> float:
        """m, of what fills the corner; 0 where nothing does."""
        return self.round or self.chamfer or 0.0

    @property
    def words(self) -> str:
        """Label for tables: the form with its size."""
        undercut, flange = self.undercut, self.flange
        if undercut is not None:
            return f"undercut of {1e3 * undercut.depth:g} mm by {1e3 * undercut.width:g} mm"
        if flange is not None:
            return f"flange of {1e3 * flange.diameter:g} mm by {1e3 * flange.thickness:g} mm"
        return self.form or f"{'fillet' if self.fillet else 'chamfer'} of {1e3 * self.size:g} mm"


class Keyway(Declared):
    """Equal grooves with parallel flanks and a flat floor."""

    width: Small = required("width")
    depth: Small = required("depth below the circumference in its middle, t1 of DIN 6885")
    fillet: Small = required("radius between floor and flank")
    number: Annotated[int, Field(ge=1, le=12)] = given("of keyways around the shaft", 1)

    def refuse_clashes(self) -> None:
        if self.fillet >= self.depth:
            message = "the fillet is not smaller than the depth"
            raise refuse(message, "a fillet lies in its keyway", "fillet")
        if 2.0 * self.fillet > self.width:
            message = "the fillet is larger than half the width"
            raise refuse(message, "two fillets fit into the floor", "fillet")

    def lacks(self, outer: float, bore: float) -> str:
        """Why a round shaft of these diameters (m) has no room for it; empty where it has."""
        radius, half = outer / 2.0, self.width / 2.0
        floor = radius - self.depth
        if half >= radius or floor + self.fillet >= math.sqrt(radius**2 - half**2):
            return "its flanks end below its fillets"
        if floor < max(bore / 2.0 + THINNEST * radius, 1.25 * half):
            return "it is too deep, or too wide, for what is left below it"
        within = (max(bore / 2.0, half) + floor) / 2.0
        if half > within * math.sin(min(ROOM * math.pi / self.number, math.pi / 2.0)):
            return "its number is too large for its width"
        return ""


class Splines(Declared):
    """Straight-sided splines; the diameter of the shaft is that over their teeth."""

    teeth: Annotated[int, Field(ge=3, le=100)] = required("number of teeth")
    root: Across = required("diameter between the teeth")
    width: Small = required("width of a tooth, its flanks parallel")
    fillet: Small = required("radius between root and flank")

    def lacks(self, outer: float, bore: float) -> str:
        """Why a round shaft of these diameters (m) has no room for them; empty where it has."""
        radius, root, half = outer / 2.0, self.root / 2.0, self.width / 2.0
        if root >= radius:
            return "the root is not smaller than the shaft"
        if root < bore / 2.0 + THINNEST * radius:
            return "the root is too close to the bore"
        if half + self.fillet >= (root + self.fillet) * math.sin(math.pi / self.teeth):
            return "the fillets do not fit between the teeth"
        if (root + self.fillet) ** 2 - (half + self.fillet) ** 2 >= radius**2 - half**2:
            return "the fillet is higher than the teeth"
        return ""


class Notch(Declared):
    """What concentrates the shear stress of a shaft; one of its keys."""

    keyway: Keyway | None = given("{width, depth, fillet}: keyway, its floor and flanks as drawn")
    splines: Splines | None = given("{teeth, root, width, fillet}: straight-sided splines")
    hole: Small | None = given("diameter of a radial oil hole")

    clashes = (
        exclusive(*FORMS, hint="a notch has one form; a list has several notches", needed=True),
    )

    @property
    def form(self) -> str:
        """The one of its keys that is given."""
        return self.keys_given(*FORMS)[0]

    def lacks(self, outer: float, bore: float) -> str:
        """Why a round shaft of these diameters (m) has no room for it; empty where it has."""
        if self.hole is not None:
            if self.hole <= LARGEST_HOLE * outer:
                return ""
            return (
                f"it is larger than {LARGEST_HOLE:g} of the diameter, up to which its factor holds"
            )
        grooves = self.keyway or self.splines
        return grooves.lacks(outer, bore) if grooves else ""


class Hub(Declared):
    """A hub on the end of a shaft, which twists in it; the end of the shaft is the end of the hub."""

    clashes = together("pressure", "friction", hint="the fit carries their product")

    length: Long = required("length of its seat, within the length of the shaft")
    diameter: Across | None = given("outer diameter of the hub of a shrink fit")
    fit: Literal["shrink", "key"] = required(
        "shrink: joined to the shaft all along, by finite elements; key: torque handed over evenly along it"
    )
    material: str | None = given(
        "name of one of `materials`; of a shrink fit (default: the shaft's)"
    )
    torque: Literal["rim", "face"] = given(
        "where the torque of a shrink fit leaves the hub: over its outer surface, or its face at the shaft's end",
        "rim",
    )
    pressure: Annotated[float, Quantity("Pa", above=0, usual="pressure of a fit")] | None = given(
        "smallest mean pressure in a shrink fit, for the rule `shrink-fits`; the finite elements do not know it"
    )
    friction: Annotated[float, Quantity("1", above=0, below=1, usual="friction")] | None = given(
        "coefficient of friction in a shrink fit, together with `pressure`"
    )
    end: Literal["first", "last"] = given("end of the shaft on which it sits", "last")

    def refuse_clashes(self) -> None:
        if (self.fit == "shrink") != (self.diameter is not None):
            lacks = "lacks its `diameter`" if self.diameter is None else "has no `diameter`"
            hint = "finite elements need it; a key counts as rigid"
            raise refuse(f"a hub with `fit: {self.fit}` {lacks}", hint, "fit")
        if self.fit == "key" and self.material is not None:
            message = "a hub with `fit: key` has no `material`"
            raise refuse(message, "a key counts as rigid", "material")
        if self.fit == "key" and self.pressure is not None:
            message = "a hub with `fit: key` has no `pressure`"
            raise refuse(message, "a key carries the torque", "pressure")


class Support(Declared):
    """A bearing on springs: y lies along the normal of the joint's plane, z in the plane, square to the shaft."""

    at: Distance = required("distance along this shaft from its end that faces the joint")
    stiffness: Annotated[tuple[LateralStiffness, ...], OneOrMany] = required(
        "stiffness, one or [y, z]"
    )
    damping: Annotated[tuple[LateralDamping, ...], OneOrMany] = given(
        "damping, one or [y, z]", (0.0,)
    )
    mass: fields.Mass = given("mass that moves with the shaft there", 0.0)
    source: str | None = given("source of the data: manufacturer, drawing, estimate")

    def refuse_clashes(self) -> None:
        for key in ("stiffness", "damping"):
            if len(getattr(self, key)) not in (1, 2):
                hint = "y: along the normal of the joint's plane"
                raise refuse(f"`{key}` is one value or [y, z]", hint, key)
        if not any(self.stiffness):
            message = "a support of no stiffness holds nothing"
            raise refuse(message, "give a stiffness above 0", "stiffness")


def refuse_details(shaft: Any) -> None:
    """Refuse notches and hubs that do not go together with the dimensions of a round shaft."""
    sizes = sorted(set(zip(both_ends(shaft.diameter), both_ends(shaft.bore), strict=True)))
    for (number, notch), (outer, bore) in product(enumerate(shaft.notches), sizes):
        if reason := notch.lacks(outer, bore):
            message = f"the shaft has no room for {notch.form}: {reason}"
            hint = f"compare its dimensions with the diameter of {1e3 * outer:g} mm"
            raise refuse(message, hint, ("notches", number))
    ends = [hub.end for hub in shaft.hub]
    if len(set(ends)) < len(ends):
        hint = "`end: first` and `end: last` are the two ends"
        raise refuse("two hubs sit on one end", hint, "hub")
    if sum(hub.length for hub in shaft.hub) > shaft.length * (1.0 + 1e-12):
        hint = "the shaft's length has the seat of the hub in it"
        raise refuse("the hub is longer than its shaft", hint, "hub")
    for hub in shaft.hub:
        if len(sizes) > 1:
            hint = "give its seat as a separate cylindrical shaft"
            raise refuse("a hub on a conical shaft", hint, "hub")
        if hub.diameter is not None and hub.diameter <= shaft.diameter[0]:
            message = "the hub is not larger than its shaft"
            raise refuse(message, "`diameter` is its outer one", "hub")
        if hub.end == "last" and shaft.step is not None:
            raise refuse("a hub sits at the place of a `step`", "`end: first`, or no `step`", "hub")


def both_ends(values: tuple[float, ...]) -> tuple[float, float]:
    """Return the values at both ends of a shaft, or in y and z of a support, which may be one value for both."""
    return values[0], values[-1]
