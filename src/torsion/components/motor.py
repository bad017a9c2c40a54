"""A motor: an inertia that drives the train, with an optional torque ripple."""

from torsion import fields
from torsion.components.disc import Rotor
from torsion.components.harmonic_torques import Ripple
from torsion.components.lowering import Lowering
from torsion.fields import given, refuse


class Motor(Rotor, keyword="motor"):
    """An electric motor, turbine or other driver."""

    power: fields.Power | None = given(
        "rated power; shares the load where several motors drive one train, and says nothing where one does"
    )
    ripple: tuple[Ripple, ...] = given("torque ripple: list of {order or frequency, torque, phase}", ())

    def refuse_clashes(self) -> None:
        super().refuse_clashes()
        if self.held and self.ripple:
            raise refuse(
                "a fixed motor cannot be moved by its ripple", "give its `inertia` in place of `held`", "ripple"
            )

    def lower(self, build: Lowering) -> None:
        build.record(power=self.power)
        here = self.place(build)
        path = (*build.parts[-1].path, "ripple")
        for place, line in enumerate(self.ripple):
            build.add(line.primitive(build.name, here, (*path, place), self.source))
