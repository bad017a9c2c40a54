"""The models of a shaft side by side on the terminal, against the closed form of a uniform chain."""

import io
import math
import re

import pytest
from rich.console import Console

import torsion
from torsion.analyses.compare.side_by_side import Compared
from torsion.output.document import document
from torsion.output.pages.terminal import show
from torsion.output.reports import REPORTS

SEGMENTS, COUNT = 8, 3
SCENE = f"""
name: held at both ends
train:
  - disc: {{held: true}}
  - shaft: {{length: 1 m, diameter: 50 mm, segments: {SEGMENTS}}}
  - disc: {{held: true}}
analyses: {{modes: {{count: {COUNT}}}, check: {{models: [lumped]}}}}
"""


def test_frequencies_errors_and_times_of_the_models() -> None:
    """Half waves k c/(2 L); n lumped segments lower them by sin(x)/x, x = k pi/(2 n)."""
    found, stream = torsion.run(torsion.parse(SCENE)), io.StringIO()
    show(
        document(found, report=REPORTS["check"]),
        None,
        Console(file=stream, width=120, color_system=None),
    )
    text = stream.getvalue()
    half_wave = math.sqrt(79.3e9 / 7850.0) / 2.0
    rows = re.findall(r"^ *(\d+) +(\d+\.\d+) +(−\d+\.\d+) *$", text, re.MULTILINE)
    assert [row[0] for row in rows] == [str(k) for k in range(1, COUNT + 1)]
    for k, (_, hertz, error) in enumerate(rows, start=1):
        x = k * math.pi / (2.0 * SEGMENTS)
        assert float(hertz) == pytest.approx(k * half_wave, rel=1e-8)
        assert float(error.replace("−", "-")) == pytest.approx(
            100.0 * (math.sin(x) / x - 1.0), rel=5e-3
        )
    (model,) = found.need(Compared).models
    assert re.search(r"^ *lumped .* no *$", text, re.MULTILINE)
    assert not model.passes
