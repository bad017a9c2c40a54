"""A branch: a train that hangs on the point before it."""

from typing import ClassVar, Literal

from torsion.components.component import Component, Line
from torsion.components.lowering import Lowering
from torsion.fields import required


class Branch(Component):
    """A side train; the main train goes on from the point before it."""

    keyword: ClassVar[str] = "branch"
    sort: ClassVar[Literal["point", "link", "none"]] = "none"

    train: Line = required("the components of the branch")

    def lower(self, build: Lowering) -> None:
        if build.at.here is None:
            build.fault("a branch has no point before it to hang on", "put it after a point")
            return
        build.branch(build.at, self.train, (*build.parts[-1].path, "train"))
