"""The cover of a report."""

import hashlib
from datetime import date

import pytest
from tests.output.conftest import BARE, solved

import torsion
from torsion.findings import Findings
from torsion.output.document import document
from torsion.output.reports import REPORTS


def test_the_cover_states_what_was_computed_and_how_it_runs(train: Findings) -> None:
    cover = document(train, date(2024, 2, 3)).cover
    assert (cover.title, cover.subtitle) == (REPORTS["solve"].title, train.study.name)
    assert dict(cover.facts) == {
        "Input file": "scene.yaml",
        "Input SHA-256": hashlib.sha256(train.study.text.encode()).hexdigest(),
        "Operation": "300 to 1800 rpm, rated 1500 rpm with 100 kW (speed of motor-1)",
        "Rules": "iacs-m68, coupling-maker, gear-hammer",
        "Computed by": f"torsion {torsion.__version__}",
        "Date": "2024-02-03",
    }


def test_the_cover_leaves_out_what_there_is_not(bare: Findings) -> None:
    assert dict(document(bare).cover.facts) == {
        "Input file": "scene.yaml",
        "Input SHA-256": hashlib.sha256(BARE.encode()).hexdigest(),
        "Rules": "none requested",
        "Computed by": f"torsion {torsion.__version__}",
    }


@pytest.mark.parametrize(
    ("operation", "words"),
    [
        ("rated: {speed: 12 rad/s}", "rated 114.592 rpm (speed of disc-1)"),
        (
            "rated: {speed: 900 rpm, power: 123.456 kW}, at: far",
            "rated 900 rpm with 123.46 kW (speed of far)",
        ),
        ("speeds: {from: 300 rpm, to: 900 rpm}", "300 to 900 rpm (speed of disc-1)"),
    ],
)
def test_the_operation_in_words(operation: str, words: str) -> None:
    named = BARE.replace("{inertia: 3}", "{name: far, inertia: 3}")
    found = solved(named.replace("train:", f"operation: {{{operation}}}\ntrain:"))
    assert dict(document(found).cover.facts)["Operation"] == words
