"""A rule: what it needs, what it does not judge, and its verdicts."""

from typing import Any

import numpy as np

from torsion.arrays import FloatArray
from torsion.errors import Fault
from torsion.fields import Declared
from torsion.findings import Results
from torsion.rules.check import Check
from torsion.study import Study


class Rule:
    """Base of all rules, which need nothing, leave nothing out and judge nothing until they say so.

    `asked` are the settings of the file, of the class `settings`.
    """

    settings: type[Declared] = Declared
    needs: tuple[str, ...] = ()  # analyses that it reads

    def faults(self, study: Study, asked: Any) -> list[Fault]:
        """What the file lacks."""
        return []

    def left_out(self, study: Study, asked: Any) -> tuple[tuple[str, str], ...]:
        """What it does not judge, and why."""
        return ()

    def speeds(self, study: Study, asked: Any) -> tuple[float, ...]:
        """Speeds (rad/s of the reference station) that must be computed, where they lie in the range."""
        return ()

    def speeds_between(self, evidence: Results, asked: Any) -> FloatArray:
        """(speeds,) rad/s between those computed at which it may find more."""
        return np.empty(0)

    def check(self, evidence: Results, asked: Any) -> tuple[Check, ...]:
        """Its verdicts."""
        return ()
