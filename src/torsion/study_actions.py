"""What a study does from Python; each action is the function of the package, named so that no floor is passed."""

from collections.abc import Mapping, Sequence
from functools import cached_property
from pkgutil import resolve_name
from typing import Any, Self


class StudyActions:
    """The questions that are put to a study in a notebook."""

    @cached_property
    def system(self) -> Any:
        """The train as assembled, in the model of the file."""
        return resolve_name("torsion.analyses.discretisation:assembled")(self)

    def modes(self, count: int = 6) -> Any:
        """Return the lowest `count` elastic modes."""
        return resolve_name("torsion.analyses.undamped_modes:modes")(self.system, count)

    def response(self) -> Any:
        """Return the response over the speed range of the file."""
        return resolve_name("torsion.analyses.response.over_speed:response")(self, self.system)

    def critical_rpm(self, order: float, count: int = 6) -> list[float]:
        """Return the speeds of the reference, rpm, at which an order meets the lowest modes."""
        return [60.0 * hertz / float(order) for hertz in self.modes(count).frequency.tolist()]

    def run(self) -> Any:
        """Return the findings of everything that the file requests."""
        return resolve_name("torsion.runner:run")(self)

    def with_(
        self,
        changes: Mapping[str, Any] | None = None,
        *,
        factor: Mapping[str, Any] | None = None,
        remove: Sequence[str] = (),
        **values: Any,
    ) -> Self:
        """Return the study with other values, by the paths of `cases: set`, times factors, without components.

        The result has the changed text; its cases are left out. Raises InputError as a case of the file does.
        """
        vary = resolve_name("torsion.schema.builder:vary")
        varied: Self = vary(self, {**(changes or {}), **values}, factor or {}, remove)
        return varied
