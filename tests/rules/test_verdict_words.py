"""The words of a verdict: the headline of a set of checks is the worst word, and the exit status follows from it."""

import json
import re
from dataclasses import replace
from pathlib import Path
from typing import get_args

import pytest
from tests.for_all import for_all

import torsion
from torsion.output.document import document
from torsion.output.headline import headline
from torsion.output.pages.html import html
from torsion.output.pages.notebook import bundle
from torsion.rules.verdict_line import WORDS, Check, Checks, Verdict, worst_verdict

VECTORS = json.loads((Path(__file__).parent / "rules_oracles.json").read_text(encoding="utf-8"))[
    "vectors"
]
VERDICTS = {word: verdict for verdict, word in WORDS.items()}
OLD = re.compile(r"NOT KEPT|not kept|\bin part\b|OUTSIDE|outside the rules?\b|NOT WHOLLY")
TRAIN = """name: n
train:
- motor: {inertia: 2}
- coupling: {stiffness: 2e4}
- disc: {inertia: 6}
"""


def row(verdict: Verdict, **changed: object) -> Check:
    check = Check("rule", "clause", "line", "what", 12.5, 50.0, "N/mm2", verdict, "setting")
    return replace(
        check, restrictions=("kept below 90 rpm",) * (verdict == "restricted"), **changed
    )


@pytest.mark.parametrize(
    "vector", [one for one in VECTORS if one["rule"] == "verdict words"], ids=lambda one: one["id"]
)
def test_vectors_of_the_words_of_a_verdict(vector: dict) -> None:
    checks = tuple(row(VERDICTS[word]) for word in vector["input"])
    assert WORDS[worst_verdict(checks)] == vector["expected"]["headline"]
    findings = torsion.run(torsion.parse(TRAIN)).having(checks=Checks(checks))
    assert headline(findings)[0][1].partition(":")[0] == vector["expected"]["headline"]
    assert findings.exit_status == vector["expected"]["exit"]


def test_every_verdict_has_one_of_four_words() -> None:
    assert set(WORDS) == set(get_args(Verdict))
    assert list(dict.fromkeys(WORDS.values())) == [
        "FAIL",
        "NOT JUDGED",
        "PASS with restrictions",
        "PASS",
    ]


@for_all("verdict", get_args(Verdict))
def test_no_old_word_stands_in_what_a_person_sees(verdict: Verdict) -> None:
    findings = torsion.run(torsion.parse(TRAIN)).having(
        checks=Checks((row(verdict), row("pass", where="other")))
    )
    page = re.sub(r"<(script|style).*?</\1>|<[^>]*>", " ", html(document(findings)), flags=re.S)
    assert WORDS[verdict] in page
    assert not OLD.findall(page)
    line = bundle(findings)["text/plain"]
    assert WORDS[verdict] in line
    assert not OLD.findall(line)
