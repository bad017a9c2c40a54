"""What a notebook shows of findings, modes and a response."""

import html
import re

import numpy as np
import pytest

import torsion
from torsion.analyses.response.amplitudes import Response
from torsion.analyses.undamped_modes import Modes
from torsion.findings import Findings
from torsion.output.numbers import RPM, number
from torsion.output.pages import notebook
from torsion.rules.verdict_line import Checks

KINDS = ("findings", "modes", "response")


def shown(findings: Findings, kind: str) -> str:
    results = {
        "findings": findings,
        "modes": findings.need(Modes),
        "response": findings.need(Response),
    }
    return str(results[kind]._repr_html_())


def rows(page: str) -> list[list[str]]:
    """The cells of all rows of all tables, as a reader sees them."""
    found = (
        re.findall(r"<td.*?>(.*?)</td>", row)
        for row in re.findall(r"<tr>(.*?)</tr>", page, re.DOTALL)
    )
    return [
        [html.unescape(re.sub("<.*?>", "", cell)) for cell in cells] for cells in found if cells
    ]


@pytest.mark.parametrize("kind", KINDS)
def test_names_are_escaped_and_nothing_runs_or_is_fetched(train: Findings, kind: str) -> None:
    page = shown(train, kind)
    assert not re.search(r"<script|<b>#1|\son\w+=|@import|url\(|src=|href=", page)
    assert page.count("<figcaption") == 1
    opened = re.findall(r"<(div|table|tr|p|ul|li|figure|svg|g)[\s>]", page)
    assert sorted(opened) == sorted(re.findall(r"</(div|table|tr|p|ul|li|figure|svg|g)>", page))


def test_findings_show_the_ranked_checks_with_their_share_of_the_limit(train: Findings) -> None:
    page = shown(train, "findings")
    checks = train.need(Checks).lines
    used = [row[6] for row in rows(page) if len(row) == 11]
    assert sorted(used) == sorted(
        "–" if check.utilisation is None else number(100.0 * check.utilisation, 4)
        for check in checks
        if check.utilisation is None or check.utilisation >= 0.1
    )
    assert html.escape(train.study.name) in page


def test_modes_show_every_frequency_with_its_bounds(train: Findings) -> None:
    modes = train.need(Modes)
    cells = np.array([[float(row[k]) for k in (1, 4, 5)] for row in rows(shown(train, "modes"))])
    np.testing.assert_allclose(cells[:, 0], modes.frequency, rtol=5e-7)
    np.testing.assert_allclose(cells[:, 1:], modes.enclosure, rtol=5e-10)


@pytest.mark.parametrize(
    ("kind", "line"),
    [
        ("findings", " checks; results: "),
        ("modes", "Modes: 6 elastic modes: "),
        ("response", "harmonic components at "),
    ],
)
def test_text_in_a_notebook_is_one_line(train: Findings, kind: str, line: str) -> None:
    results = {"findings": train, "modes": train.need(Modes), "response": train.need(Response)}
    text = results[kind]._repr_mimebundle_()["text/plain"]
    assert line in text
    assert "\n" not in text
    assert len(text) < 500


def test_many_modes_are_cut_and_counted(train: Findings, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(notebook, "MOST_MODES", 2)
    page = shown(train, "modes")
    assert len(rows(page)) == 2
    assert f"the first 2 of {train.need(Modes).frequency.size}" in page


def test_a_response_shows_the_largest_component_of_every_element(train: Findings) -> None:
    response = train.need(Response)
    found = {row[0]: row for row in rows(shown(train, "response"))}
    parts = [response.system.train.parts[one.part].name for one in response.system.spans]
    size = np.abs(response.torque[:, :, parts.index("rubber")])
    speed, _ = np.unravel_index(size.argmax(), size.shape)
    unit = 1e3 if "kN m" in shown(train, "response") else 1.0
    assert float(found["rubber"][1]) * unit == pytest.approx(size.max(), rel=5e-5)
    assert float(found["rubber"][2]) == pytest.approx(response.speed[speed] * RPM, rel=5e-5)


def test_what_has_nothing_to_show_says_so(bare: Findings) -> None:
    study = torsion.parse(
        "name: one\noperation: {speeds: {from: 1 rpm, to: 9 rpm}}\ntrain: [disc: {inertia: 2}]\n"
    )
    system = torsion.assemble(study.train)
    assert "no elastic modes" in torsion.modes(system)._repr_html_()
    assert "nothing excites" in torsion.response(study, system)._repr_html_()
    assert "NOT JUDGED: no rule is named" in bare._repr_html_()
