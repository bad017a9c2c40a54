"""The study of error against run time: every number of its table, sentences and JSON, from rows made up.

Of five runs whose assembly takes a + i d and whose solve takes 2 a + 3 i d (i = 0..4), the whole takes 3 a + 4 i d:
quartiles are those of i = 1, 2, 3.
"""

import json
import math
from dataclasses import replace
from datetime import date
from pathlib import Path

import pytest

from torsion.analyses.compare.timing import TimedQuantity, TimedRow, Timings
from torsion.findings import Findings
from torsion.output import run_time_study as study
from torsion.output.blocks import Heading, KeyValues, Paragraph, Points, Table


def row(curve: str, size: int, error: float, start: float, step: float) -> TimedRow:
    runs = range(5)
    assembly, solve = (
        tuple(start + i * step for i in runs),
        tuple(2.0 * start + 3.0 * i * step for i in runs),
    )
    return TimedRow(curve, f"{size} pieces", size, (error / 4.0, error), assembly, solve)


LUMPED = row("lumped, elimination", 8, 0.02, 1e-3, 1e-4)  # 3.0, 3.4, 3.8, 4.2, 4.6 ms
FINER = row("lumped, elimination", 16, 5e-4, 2e-3, 2e-4)  # 6.0, 6.8, 7.6, 8.4, 9.2 ms
FEM = row("fem, degree 3, dense", 4, 2e-5, 2.2e-3, 3e-4)  # 6.6, 7.8, 9.0, 10.2, 11.4 ms
MODES = row(
    "modal superposition, static correction", 5, 6e-4, 2.1e-3, 4e-4
)  # 6.3, 7.9, 9.5, 11.1, 12.7 ms
FEW = row("modal superposition", 2, math.inf, 1e-5, 1e-6)
EXACT = row("exact", 1, 1e-9, 3e-3, 5e-4)  # 9, 11, 13, 15, 17 ms
ROWS = (LUMPED, FINER, FEM, MODES, FEW, EXACT)
QUANTITY = TimedQuantity(
    "frequencies",
    "Natural frequencies",
    "Error of each.",
    "The exact model.",
    2e-6,
    120.0,
    ("mode 1", "mode 2"),
    ROWS,
    ("not run: x",),
)
TIMINGS = Timings(1e-3, (QUANTITY,), ("nothing to divide",), 7, (("CPU", "four cores"),))


def test_every_method_with_error_times_and_what_makes_it_worth_taking() -> None:
    made = study.methods(QUANTITY, 1e-3)
    assert [column.title for column in made.columns] == [
        *("Method", "Discretisation", "Error", "Median", "Assembly", "Solve", "Remark"),
    ]
    assert made.rows[0] == (
        *("lumped, elimination", "8 pieces", "2 %", "3.80", "1.20", "2.60", "not beaten"),
    )
    assert made.rows[1][-1] == "recommended"
    assert made.marks == ("", "pass", "", "", "", "")
    assert made.rows[4][2] == "no value"
    assert [row[-1] for row in made.rows] == [
        *("not beaten", "recommended", "not beaten", "", "", "not beaten"),
    ]


def test_errors_that_the_reference_does_not_resolve_make_no_method_better() -> None:
    made = study.methods(replace(QUANTITY, bound=6e-4), 1e-3)
    assert [row[-1] for row in made.rows[2:]] == ["", "", "", ""]


def test_headings_and_sentences_of_a_quantity() -> None:
    made = [*study.blocks(TIMINGS)]
    assert [one.text for one in made if isinstance(one, Heading)] == [
        "What to take",
        "Natural frequencies",
        "How the times were taken",
    ]
    assert made[0] == Heading("What to take", at_end=True)
    words = "Natural frequencies. For 0.1 % up to 120 Hz: lumped, elimination, 16 pieces, 7.60 ms (error 0.05 %)."
    assert made[1:3] == [
        Paragraph(words, "pass", brief=True),
        Points(("nothing to divide",), brief=True),
    ]
    assert Paragraph("Error of each. The exact model. Here it is 2.0·10⁻⁶.") in made
    assert Points(("not run: x",)) in made
    assert made[-1] == KeyValues((("CPU", "four cores"),))
    how = next(one for one in made if isinstance(one, Paragraph) and "warms up" in one.text)
    assert (
        "in 7 rounds, a fast one several times a round, one slower than 0.3 s in 3 of them"
        in how.text
    )


def test_a_study_of_nothing_has_no_table() -> None:
    made = study.blocks(Timings(1e-3, (), (), 7, ()))
    assert not any(isinstance(one, Table) for one in made)


def test_where_no_method_keeps_the_tolerance_the_nearest_is_named() -> None:
    strict = replace(TIMINGS, tolerance=1e-10)
    words = "For 1.0·10⁻¹⁰ up to 120 Hz: no method that was run is as accurate; the nearest is exact, 1 pieces, 13.0 ms"
    assert study.recommendation(QUANTITY, 1e-10) == f"{words} (error 1.0·10⁻⁹)."
    assert [*study.blocks(strict)][1] == Paragraph(
        f"Natural frequencies. {words} (error 1.0·10⁻⁹).", "fail", brief=True
    )
    made = study.methods(QUANTITY, 1e-10)
    assert "recommended" not in [line[-1] for line in made.rows]
    assert set(made.marks) == {""}


def test_a_reference_that_is_not_ten_times_as_good_as_the_tolerance_is_doubted() -> None:
    words = (
        "The bound of the reference, 1.26 %, is not a tenth of the tolerance: take more than that."
    )
    for bound, is_doubted in ((0.0125, False), (0.0126, True)):
        doubted = replace(TIMINGS, quantities=(replace(QUANTITY, bound=bound),), tolerance=0.125)
        notes = [
            one.text
            for one in study.blocks(doubted)
            if isinstance(one, Paragraph) and one.kind == "note"
        ]
        assert notes == ([words] if is_doubted else [])


@pytest.mark.parametrize(
    ("error", "text"),
    [
        (1e-3, "0.1 %"),
        (0.25, "25 %"),
        (0.12345, "12.3 %"),
        (2.34e-9, "2.3·10⁻⁹"),
        (0.0, "0"),
        (1e-4, "0.01 %"),
        (math.inf, "no value"),
    ],
)
def test_an_error_is_stated_as_people_read_it(error: float, text: str) -> None:
    assert study.share(error) == text


def test_the_json_states_every_run_and_which_rows_are_best(bare: Findings) -> None:
    text = study.json_text(bare, TIMINGS)
    assert text.startswith('{\n "format": 1,\n')
    assert text.endswith("\n}\n")
    stated = json.loads(text)
    assert stated["scene"]["name"] == "two discs"
    assert [stated[key] for key in ("tolerance", "rounds", "machine", "remarks")] == [
        1e-3,
        7,
        {"CPU": "four cores"},
        ["nothing to divide"],
    ]
    (one,) = stated["quantities"]
    assert [
        one[key]
        for key in (
            "key",
            "title",
            "meaning",
            "reference",
            "highest_Hz",
            "errors_are_of",
            "remarks",
        )
    ] == [
        "frequencies",
        "Natural frequencies",
        "Error of each.",
        {"what": "The exact model.", "bound": 2e-6},
        120.0,
        ["mode 1", "mode 2"],
        ["not run: x"],
    ]
    assert one["recommendation"] == study.recommendation(QUANTITY, 1e-3)
    assert (one["recommended_row"], one["unbeaten_rows"]) == (1, [0, 1, 2, 5])
    assert (one["rows"][4]["error"], one["rows"][4]["errors"]) == (None, [None, None])
    second = one["rows"][1]
    assert [second[key] for key in ("method", "division", "size", "error", "errors")] == [
        "lumped, elimination",
        "16 pieces",
        16,
        5e-4,
        [1.25e-4, 5e-4],
    ]
    keys = ("least_s", "quarter_s", "median_s", "three_quarters_s", "runs")
    assert second["total"] == pytest.approx(
        dict(zip(keys, (6e-3, 6.8e-3, 7.6e-3, 8.4e-3, 5), strict=True))
    )
    assert second["assembly_s"] == list(FINER.assembly)
    assert second["solve_s"] == list(FINER.solve)
    unmatched = json.loads(study.json_text(bare, replace(TIMINGS, tolerance=1e-10)))["quantities"][
        0
    ]
    assert unmatched["recommended_row"] is None


def test_the_json_is_finite_and_keeps_its_letters(bare: Findings) -> None:
    assert '"Größe"' in study.json_text(bare, replace(TIMINGS, remarks=("Größe",)))
    with pytest.raises(ValueError, match="not JSON compliant"):
        study.json_text(bare, replace(TIMINGS, tolerance=math.nan))


def test_both_files_are_written_with_the_date(bare: Findings, tmp_path: Path) -> None:
    made = study.write_study(bare, TIMINGS, tmp_path, today=date(2024, 2, 3))
    assert made.body[0].block == Heading("What to take", at_end=True)
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        "study.html",
        "study.json",
    ]
    assert "2024-02-03" in (tmp_path / "study.html").read_text(encoding="utf-8")
    assert (tmp_path / "study.json").read_text(encoding="utf-8") == study.json_text(bare, TIMINGS)


def test_without_a_date_that_of_today_stands_on_the_cover(bare: Findings, tmp_path: Path) -> None:
    before = date.today()
    made = study.write_study(bare, replace(TIMINGS, quantities=()), tmp_path)
    assert before.isoformat() <= dict(made.cover.facts)["Date"] <= date.today().isoformat()
