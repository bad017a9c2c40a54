"""A branch: a train that the point before it carries."""

from torsion.fields import required
from torsion.model.component import Component, Line, lower_branch
from torsion.model.lowering import Lowering


class Branch(Component, keyword="branch", sort="none"):
    """A side train; the main train goes on from the point before it."""

    train: Line = required("the components of the branch")

    def lower(self, build: Lowering) -> None:
        if build.arrival.station is None:
            build.fault("a branch has no point before it that carries it", "put it after a point")
            return
        lower_branch(build, build.arrival, self.train, (*build.parts[-1].path, "train"))
