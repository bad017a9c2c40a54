"""Every cell and sentence of the comparison of models, of errors written here by hand."""

import math
from collections.abc import Iterable
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from torsion.analyses.compare.side_by_side import Compared, ModelCompared, TorquesCompared
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, Points, Table
from torsion.output.chapters.model_comparison import chapter, conclusion

RPM = 30.0 / math.pi
SPEED = np.array([10.0, 20.0, 30.0])
FREQUENCY = np.array([12.3456789, 23.4567891, 345.678912])


def torques(largest: float, **changed: object) -> TorquesCompared:
    made = TorquesCompared(
        np.array([0.1, 1.0, 0.5]) * largest, largest, 1, Fraction(3, 2), None, "tube", 0
    )
    return replace(made, **changed)


def model(name: str, error: float, **changed: object) -> ModelCompared:
    made = ModelCompared(
        name,
        f"{name} pieces",
        True,
        FREQUENCY * (1 + error),
        error * np.array([1.0, -2.0, 1.5]),
        error * np.array([0.1, 0.2, 0.5]),
        3,
        torques(3 * error),
        0.01249,
        0.456,
        (1e-2, 1e-2, 1e-2),
    )
    return replace(made, **changed)


EXACT = model("exact", 0.0, torques=None)
GOOD = Compared(1e-2, 1e-2, EXACT, (model("lumped", 2e-3), model("fem", 1e-3)), 54.321, SPEED)


def comparing(*models: ModelCompared, **changed: object) -> Compared:
    return replace(GOOD, models=models, **changed)


def blocks(bare: Findings, found: Compared) -> list[Block]:
    return list(chapter(bare.having(check=found)))


def tables(made: Iterable[Block]) -> list[Table]:
    return [block for block in made if isinstance(block, Table)]


def texts(made: Iterable[Block]) -> list[str]:
    return [block.text for block in made if isinstance(block, Paragraph)]


def items(made: Iterable[Block]) -> list[str]:
    return [item for block in made if isinstance(block, Points) for item in block.items]


def test_largest_errors_and_times(bare: Findings) -> None:
    made = tables(blocks(bare, comparing(model("lumped", 4e-3), model("fem", 1e-3, torques=None))))[
        0
    ]
    assert made.rows == (
        ("exact", "0", "0", "–", "3", "yes", "12", "460", "yes"),
        ("lumped", "0.800", "0.200", "1.20", "3", "yes", "12", "460", "no"),
        ("fem", "0.200", "0.0500", "–", "3", "yes", "12", "460", "yes"),
    )
    assert made.marks == ("", "fail", "pass")
    assert made.caption.startswith(
        "Maximum errors against the exact model, of 3 modes; modes below 54.321 Hz"
    )


def test_modes_side_by_side(bare: Findings) -> None:
    made = tables(blocks(bare, GOOD))[1]
    titles = [column.title for column in made.columns]
    assert titles == [
        "Mode",
        "exact",
        "lumped",
        "lumped error",
        "1 − MAC",
        "fem",
        "fem error",
        "1 − MAC",
    ]
    assert [row[:3] for row in made.rows] == [
        ("1", "12.3456789", f"{12.3456789 * 1.002:.7f}"),
        ("2", "23.4567891", f"{23.4567891 * 1.002:.7f}"),
        ("3", "345.678912", f"{345.678912 * 1.002:.6f}"),
    ]
    assert [row[3:5] for row in made.rows] == [
        ("0.200", "0.00020"),
        ("−0.400", "0.00040"),
        ("0.300", "0.0010"),
    ]
    assert [row[6] for row in made.rows] == ["0.100", "−0.200", "0.150"]


@pytest.mark.parametrize("number", [40, 41])
def test_forty_modes_stand_in_the_table(bare: Findings, number: int) -> None:
    frequency = np.arange(1.0, number + 1)
    exact, lumped = (
        replace(one, frequency=frequency, frequency_error=0 * frequency, shape_error=0 * frequency)
        for one in (EXACT, model("lumped", 1e-3))
    )
    made = blocks(bare, comparing(lumped, exact=exact))
    assert [row[0] for row in tables(made)[1].rows] == [str(k) for k in range(1, 41)]
    assert tables(made)[1].caption.endswith("; the first 40 of 41") == (number == 41)


def test_blocks_in_their_order(bare: Findings) -> None:
    made = blocks(bare, GOOD)
    assert [block.text for block in made if isinstance(block, Heading)] == [
        "Comparison of the models"
    ]
    shown = [block.text for block in made if isinstance(block, Paragraph) and block.brief]
    assert shown == ["PASS: the models lumped and fem are within 1 % of the exact model."]
    guessed = comparing(model("lumped", 1e-3, certified=False))
    assert [row[5] for row in tables(blocks(bare, guessed))[0].rows] == ["yes", "no"]
    same = Compared(1e-2, 1e-2, same="All are the same.")
    assert blocks(bare, same) == [
        Heading("Comparison of the models"),
        Paragraph("All are the same.", "note", brief=True),
    ]
    assert conclusion(same) == Paragraph("All are the same.", "note")


@pytest.mark.parametrize(
    ("errors", "said"),
    [
        ({"fem": 1e-3}, "PASS: the model fem is within 1 % of the exact model."),
        (
            {"lumped": 2e-3, "fem": 1e-3},
            "PASS: the models lumped and fem are within 1 % of the exact model.",
        ),
        (
            {"lumped": 4e-3, "fem": 1e-3},
            "FAIL: the model lumped is not within 1 % of the exact model; fem is.",
        ),
        ({"lumped": 4e-3}, "FAIL: the model lumped is not within 1 % of the exact model."),
    ],
)
def test_the_verdict_in_a_sentence(errors: dict[str, float], said: str) -> None:
    made = conclusion(comparing(*(model(name, error) for name, error in errors.items())))
    assert (made.text, made.kind) == (said, "fail" if "not within" in said else "pass")


def test_where_the_torques_are_farthest_off(bare: Findings) -> None:
    fixed = model(
        "lumped", 2e-3, torques=torques(0.006, worst_order=None, worst_frequency=7.5, worst_speed=0)
    )
    made = blocks(bare, comparing(fixed, model("fem", 1e-3)))
    assert items(made) == [
        "lumped: 0.600 % at 95.493 rpm, 7.5000 Hz, largest in tube",
        "fem: 0.300 % at 190.99 rpm, order 1.5, largest in tube",
    ]
    assert next(
        block.brief
        for block in made
        if isinstance(block, Points) and "at 190.99" in block.items[-1]
    )


def test_torques_that_are_not_compared_or_not_known(bare: Findings) -> None:
    nothing = comparing(
        model("lumped", 1e-3, torques=None), speed=None, no_torques="nothing excites"
    )
    made = blocks(bare, nothing)
    assert made[-1] == Paragraph("No torques are compared: nothing excites.", "note", brief=True)
    singular = torques(math.nan, worst_speed=None, left_out=6)
    made = blocks(
        bare,
        comparing(
            model("lumped", 1e-3, torques=singular), model("fem", 1e-3, torques=torques(1e-3))
        ),
    )
    assert [item.split(":")[0] for item in items(made)] == ["fem"]
    assert texts(made)[-1].startswith("Omitted: 6 solutions at undamped resonances.")
    once = blocks(bare, comparing(model("lumped", 1e-3, torques=torques(1e-3, left_out=1))))
    assert texts(once)[-1].startswith("Omitted: 1 solution at")
    assert not any("Omitted" in text for text in texts(blocks(bare, GOOD)))
