"""A branch: a train that the point before it carries."""

from torsion.fields import required
from torsion.model.component import Component, Line, Lowering, lower_branch


class Branch(Component, keyword="branch", sort="none"):
    """A branch is a side train. The main train continues from the point before it."""

    title = "side train of a point"
    example = "- branch: {train: [coupling: {stiffness: 20 kN*m/rad}, disc: {inertia: 1}]}"

    train: Line = required("the components of the branch")

    def lower(self, build: Lowering) -> None:
        if build.arrival.station is None:
            build.fault("a branch has no point before it that carries it", "put it after a point")
            return
        lower_branch(build, build.arrival, self.train, (*build.parts[-1].path, "train"))
