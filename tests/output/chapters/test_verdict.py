"""The table of verdicts, the conclusion, the restrictions of speed and the measurements, of checks written by hand."""

import math
from collections.abc import Iterable
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

import torsion
from torsion.analyses.response.amplitudes import Response
from torsion.analyses.response.component_loads import ComponentLoads, ShaftLoad
from torsion.analyses.undamped_modes import Modes
from torsion.findings import Findings
from torsion.kernels.trees.tree_response import Status
from torsion.output.blocks import Block, Box, Heading, PageEnd, Paragraph, Points, Table
from torsion.output.chapters import closing, verdict
from torsion.rules.verdict_line import BarredRange, Check, Checks

RPM = 30.0 / math.pi
TRAIN = """
name: two shafts with a gear between them
operation: {at: flywheel, speeds: {from: 100 rpm, to: 600 rpm, steps: 6}, rated: {speed: 450 rpm}}
train:
- disc: {name: flywheel, inertia: 2}
- shaft: {name: quick, length: 1 m, diameter: 40 mm, segments: 2}
- gear: {name: stage, ratio: 5/2, inertia: [0.5, 1.5], mesh_stiffness: 40 kN*m/rad}
- shaft: {name: slow, length: 1 m, diameter: 60 mm, segments: 2}
- propeller: {name: screw, inertia: 12, damping: 3}
excitations: [{at: flywheel, order: 2, torque: 3}, {at: screw, frequency: 7, torque: 1}]
"""


@pytest.fixture(scope="module")
def found() -> Findings:
    return torsion.run(torsion.parse(TRAIN))


def check(verdict: str = "pass", **changed: object) -> Check:
    made = Check(
        "rule",
        "clause",
        "tail",
        "what",
        12.345,
        50.0,
        "N/mm2",
        verdict,
        "setting",
        30.0,
        Fraction(3, 2),
    )
    return replace(made, **changed)


def judged(findings: Findings, *checks: Check) -> Findings:
    return findings.having(checks=Checks(checks))


def texts(blocks: Iterable[Block]) -> list[str]:
    return [block.text for block in blocks if isinstance(block, Paragraph)]


def items(blocks: Iterable[Block]) -> list[str]:
    return [item for block in blocks if isinstance(block, Points) for item in block.items]


def test_cells_of_the_verdict_table(bare: Findings) -> None:
    lines = (
        check(),
        check("fail", at_least=True, unit="rad/s2", order=None, limit=20.0, speed=None),
        check("restricted", limit=math.nan, value=math.inf),
        check("fail", value=math.inf, clause="stability", limit=0.0),
    )
    (made,) = (block for block in verdict.chapter(judged(bare, *lines)) if isinstance(block, Table))
    basis = "rule: clause (stated by user)"
    assert made.rows == (
        (
            "what",
            "tail",
            "no finite value",
            "≤",
            "0",
            "N/mm²",
            "–",
            "286.48",
            "1.5",
            "rule: stability (stated by user)",
            "✗ FAIL",
        ),
        ("what", "tail", "12.345", "≥", "20", "rad/s²", "162.0", "–", "–", basis, "✗ FAIL"),
        ("what", "tail", "12.345", "≤", "50", "N/mm²", "24.69", "286.48", "1.5", basis, "✓ PASS"),
        (
            "what",
            "tail",
            "no finite value",
            "",
            "–",
            "N/mm²",
            "–",
            "286.48",
            "1.5",
            basis,
            "! PASS with restrictions",
        ),
    )
    assert made.marks == ("fail", "fail", "pass", "restricted")


def test_checks_are_ranked_by_the_share_of_their_limit_and_those_that_fail_first(
    bare: Findings,
) -> None:
    """Of a least value the share is limit / value; a limit of 0 has none, and no value is the largest share."""
    lines = (
        check(value=10.0, where="a"),
        check(value=40.0, where="b"),
        check(value=60.0, at_least=True, where="c"),
        check("fail", value=51.0, where="d"),
        check("not kept", value=99.0, where="e"),
        check(limit=0.0, where="f"),
        check("fail", value=math.inf, where="g"),
    )
    made = next(
        block for block in verdict.chapter(judged(bare, *lines)) if isinstance(block, Table)
    )
    assert [(row[1], row[6]) for row in made.rows] == [
        ("g", "∞"),
        ("d", "102.0"),
        ("e", "198.0"),
        ("c", "83.33"),
        ("b", "80.00"),
        ("a", "20.00"),
        ("f", "–"),
    ]


def test_an_order_is_named_by_its_source(found: Findings) -> None:
    made = verdict.chapter(judged(found, check(order=Fraction(2)), check(order=Fraction(7))))
    rows = next(block for block in made if isinstance(block, Table)).rows
    assert [row[7] for row in rows] == ["2 × flywheel", "7"]


def test_symbols_of_a_rule_are_those_of_the_report(bare: Findings) -> None:
    lines = (check("fail", clause="tau_C", note="sigma_B 600 N/mm2 (lambda >= 0.8), 1.9e+06 N m"),)
    made = list(verdict.chapter(judged(bare, *lines)))
    assert (
        next(block for block in made if isinstance(block, Table)).rows[0][8]
        == "rule: τ_C (stated by user)"
    )
    assert items(made) == ["tail: what: σ_B 600 N/mm² (λ >= 0.8), 1.9·10⁶ N m"]


def test_remarks_stand_once_with_all_their_components(bare: Findings) -> None:
    """Those of checks that pass in an appendix."""
    lines = (
        check(note="n"),
        check(where="mid", note="n"),
        check(where="mid", note="n"),
        check(where="x", note="m"),
    )
    failing = [replace(one, verdict="fail") for one in lines]
    made = list(verdict.chapter(judged(bare, *failing, check())))
    assert made[0] == Heading("Verdict", at_end=True)
    assert Heading("Remarks", 2) in made
    assert items(made) == ["tail, mid: what: n", "x: what: m"]
    assert list(verdict.remarks(judged(bare, *failing, check()))) == []
    passing = judged(bare, *lines)
    assert not any(isinstance(block, Points) for block in verdict.chapter(passing))
    head, said = verdict.remarks(passing)
    assert head == Heading("Appendix: remarks on the checks")
    assert items([said]) == ["tail, mid: what: n", "x: what: m"]
    assert list(verdict.judged(judged(bare))) == []


SHAFTS = """
name: three shafts
operation: {speeds: {from: 100 rpm, to: 600 rpm, steps: 6}, rated: {speed: 500 rpm}}
train:
- motor: {inertia: 2}
- shaft: {name: free, length: 1 m, diameter: 40 mm}
- shaft: {name: ruled, length: 1 m, diameter: 40 mm, role: intermediate}
- coupling: {stiffness: 1e4, vibratory_torque: 5}
- shaft: {name: other, length: 1 m, diameter: 40 mm}
- propeller: {name: screw, inertia: 12, damping: 3, blades: 4, excitation: [{blade_order: 1, torque: 3}]}
rules: [iacs-m68]
"""


@pytest.mark.parametrize(
    ("rules", "words"),
    [
        ("[iacs-m68]", ["Shaft stress not checked: free, other (the shaft has no `role`)."]),
        (
            "[coupling-maker]",
            ["Shaft stress not checked: free, ruled, other (no rule of the file applies)."],
        ),
        ("[]", []),
    ],
)
def test_shafts_that_no_rule_judges_are_named_with_the_reason(rules: str, words: list[str]) -> None:
    text = SHAFTS.replace("[iacs-m68]", rules)
    said = texts(verdict.chapter(torsion.run(torsion.parse(text))))
    assert [one for one in said if one.startswith("Shaft stress")] == words


@pytest.mark.parametrize(
    ("source", "words"),
    [
        ("", "No source for the data of 2 of 3 components (k, b) and 1 of 1 excitation."),
        (
            ", source: list",
            "No source for the data of 1 of 3 components (k) and 1 of 1 excitation.",
        ),
    ],
)
def test_components_that_state_no_source_are_counted(source: str, words: str) -> None:
    text = f"""
name: x
train: [disc: {{name: a, inertia: 1, source: maker}}, coupling: {{name: k, stiffness: 5}},
  disc: {{name: b, inertia: 2{source}}}]
excitations: [{{at: a, frequency: 2, torque: 3}}]
operation: {{speeds: {{from: 300 rpm, to: 600 rpm, steps: 2}}}}
"""
    assert words in [
        block.text
        for block in verdict.chapter(torsion.run(torsion.parse(text)))
        if hasattr(block, "text")
    ]


def test_a_report_with_all_sources_has_no_remark_on_them() -> None:
    found = torsion.run(torsion.parse("name: x\ntrain: [disc: {inertia: 1, source: maker}]\n"))
    *_, last = verdict.chapter(found)
    assert last == PageEnd()


def test_checks_below_a_tenth_of_their_limit_are_one_line(bare: Findings) -> None:
    """Failed checks, restrictions and the five worst stand in the table whatever their utilisation."""
    small = [check(value=0.1 * k) for k in range(20)]
    made = list(
        verdict.chapter(judged(bare, *small, check("fail", value=0.2, limit=0.0), check(value=6.0)))
    )
    (table,) = (block for block in made if isinstance(block, Table))
    assert len(table.rows) == 5
    assert "17 more checks below 10 % of the limit in results.json." in texts(made)
    made = list(
        verdict.chapter(
            judged(bare, *[check(value=6.0)] * 20, check("restricted", restrictions=("x",)))
        )
    )
    (table,) = (block for block in made if isinstance(block, Table))
    assert len(table.rows) == 21


RANGES = (
    BarredRange(20.0, 30.0, 24.0, "tail", 21.0, 29.0441, Fraction(2)),
    BarredRange(29.0, 35.0, 31.0, "mid"),
)


def test_barred_ranges_of_shafts_and_of_the_train(found: Findings, bare: Findings) -> None:
    def barred(findings: Findings) -> list[Block]:
        blocks = list(verdict.chapter(findings))
        at = [
            k
            for k, block in enumerate(blocks)
            if isinstance(block, Table) and "Barred" in block.caption
        ]
        return blocks[at[0] - 1 : at[0] + 1] if at else []

    assert barred(judged(found, check())) == []
    modes = replace(found.need(Modes), frequency=np.array([1.0, 24.3 / math.pi]))
    said, made = barred(judged(found.having(modes=modes, damped_modes=None), check(barred=RANGES)))
    assert isinstance(made, Table)
    assert isinstance(said, Paragraph)
    rated = 450.0 / RPM
    assert made.rows == (
        (
            "tail",
            "190.99",
            "286.48",
            "2 × flywheel",
            "2",
            "229.18",
            f"{24.0 / rated:.4f}",
            "200.54",
            "277.35",
        ),
        ("mid", "276.93", "334.23", "–", "–", "296.03", f"{31.0 / rated:.4f}", "–", "–"),
    )
    assert made.caption == "Barred ranges (450.00 rpm rated)"
    assert "Barred for continuous operation: 190.9 to 334.3 rpm." in said.text
    _, made = barred(judged(bare, check(barred=RANGES)))
    assert isinstance(made, Table)
    assert [row[3] for row in made.rows] == ["2", "–"]
    assert "λ" not in [column.title for column in made.columns]
    assert made.caption == "Barred ranges"


@pytest.mark.parametrize(
    ("verdicts", "said", "kind"),
    [
        ("", "NOT JUDGED: no rule is named", "note"),
        ("P", "PASS: 1 limit met.", "pass"),
        ("PP", "PASS: 2 limits met.", "pass"),
        ("PPO", "PASS with restrictions: ", "note"),
        ("PU", "NOT JUDGED: what, tail", "note"),
        ("F", "FAIL: what, tail", "fail"),
        ("N", "FAIL: what, tail", "fail"),
        ("FFNPO", "FAIL: what, tail", "fail"),
    ],
)
def test_conclusion_in_a_sentence(bare: Findings, verdicts: str, said: str, kind: str) -> None:
    word = {"P": "pass", "O": "restricted", "U": "not judged", "F": "fail", "N": "not kept"}
    overall = next(
        iter(
            closing.conclusion(
                judged(
                    bare,
                    *(check(word[one], restrictions=("x",) * (one == "O")) for one in verdicts),
                )
            )
        )
    )
    assert isinstance(overall, Paragraph)
    assert overall.text.startswith(said)
    assert overall.kind == kind


def test_limits_of_an_unconfirmed_edition_are_counted(bare: Findings) -> None:
    unconfirmed = check(standing="to be verified")
    for lines, words in (
        ([check()], ""),
        ([check(), unconfirmed], ". 1 of 2 limits follows an edition that"),
        ([unconfirmed] * 3, ". 3 of 3 limits follow an edition that is not confirmed"),
    ):
        (box,) = (
            block for block in verdict.chapter(judged(bare, *lines)) if isinstance(block, Box)
        )
        assert words in dict(box.lines)["Checks"]
        assert bool(words) == ("edition" in dict(box.lines)["Checks"])


def with_status(findings: Findings, bad: Iterable[tuple[int, int]]) -> Findings:
    status = np.full_like(findings.need(Response).status, Status.OK)
    for place in bad:
        status[place] = Status.SINGULAR
    return findings.having(response=replace(findings.need(Response), status=status))


NOTHING = "No restriction of speed follows from the checks."


def test_restrictions_of_speed(found: Findings, bare: Findings) -> None:
    def said(findings: Findings) -> list[str]:
        return items(closing.conclusion(findings))

    fine = with_status(found, ())
    assert said(judged(fine, check())) == [NOTHING]
    assert (
        said(judged(fine, check("fail"))) == said(judged(fine)) == said(judged(bare, check())) == []
    )
    barred = judged(fine, check("restricted", barred=RANGES))
    (one,) = said(barred)
    assert one == "Barred range: 190.9 to 334.3 rpm. No continuous operation; pass it rapidly."
    assert "PASS with restrictions: barred range" in texts(closing.conclusion(barred))[0]
    speed = found.need(Response).speed
    (one,) = said(judged(with_status(found, [(0, 0)]), check()))
    assert one.startswith(f"At {speed[0] * RPM:.2f} rpm the response has no reliable finite value")


@pytest.mark.parametrize(
    ("speeds", "said"),
    [
        ([600.0], "600.00 rpm"),
        ([600.0, 605.0], "600.00–605.00 rpm"),
        ([600.0, 606.1, 611.0], "600.00, 606.10–611.00 rpm"),
        ([600.0, 606.05], "600.00–606.05 rpm"),
        ([600.0, 606.07], "600.00, 606.07 rpm"),
        ([0.5, 0.9], "0.50000, 0.90000 rpm"),
        (
            [10.0 * k for k in range(1, 9)],
            "10.000, 20.000, 30.000, 40.000, 50.000, 60.000, 70.000, 80.000 rpm",
        ),
        (
            [10.0 * k for k in range(1, 12)],
            "10.000, 20.000, 30.000, 40.000, 50.000, 60.000, 70.000, 80.000 rpm (the first 8 of 11 ranges)",
        ),
    ],
)
def test_speeds_within_a_hundredth_of_each_other_are_one_range(
    found: Findings, speeds: list[float], said: str
) -> None:
    response = found.need(Response)
    response = replace(
        response,
        speed=np.array([1.0, *speeds]) / RPM,
        status=np.array([[Status.OK]] + [[Status.SINGULAR]] * len(speeds)),
    )
    (one,) = items(closing.conclusion(judged(found.having(response=response), check("fail"))))
    assert one.startswith(f"At {said} the response has no reliable")


def responding(findings: Findings) -> Findings:
    """Half a newton metre in the quick shaft, more in the slow one, which is less at the speed of the flywheel."""
    response = findings.need(Response)
    speed, spans = np.array([10.0, 20.0, 30.0, 40.0]), [span.name for span in findings.system.spans]
    torque = np.zeros((4, 2, len(spans)), dtype=complex)
    torque[:, 0, [name.startswith("quick") for name in spans]] = np.array([0.1, 0.2, 0.5j, 0.9])[
        :, None
    ]
    torque[:, 1, [name.startswith("slow") for name in spans]] = np.array([0.3, 0.4, 0.6, 0.9])[
        :, None
    ]
    status = np.full((4, 2), Status.OK)
    status[3] = Status.SINGULAR
    return findings.having(response=replace(response, speed=speed, torque=torque, status=status))


def measurements(findings: Findings) -> list[str]:
    return items(list(closing.chapter(judged(findings, check())))[-1:])


def test_what_is_to_be_measured(found: Findings) -> None:
    made = found.need(Modes)
    shape = np.zeros((len(found.system.stations), 4))
    names = [station.name for station in found.system.stations]
    for name, values in {
        "flywheel": (0.5, 9.0),
        "stage end": (-0.3, 0.0),
        "screw": (0.1, 0.1),
    }.items():
        shape[names.index(name), :2] = values
    modes = replace(made, frequency=np.array([1.23456, 2.5, 3.0, 44.0]), shape=shape)
    loads = ComponentLoads((), (), (ShaftLoad("quick", None, 5.0, 30.0),), (), (), ())
    loaded = responding(found).having(modes=modes, component_loads=loads)
    run, strain, angle, compared = measurements(loaded)
    assert run.startswith(
        "Run up and down slowly from 100 to 600 rpm (speed of flywheel) and at steps"
    )
    assert "Analyse the orders (2) and the natural frequencies." in run
    assert strain == (
        "Torque by strain gauges with telemetry on quick; the largest amplitude is expected at 286.48 rpm."
    )
    assert (
        angle
        == "Angular vibration by encoder or laser at stage end, where mode 1 has its largest amplitude."
    )
    assert compared.startswith(
        "Compare the measured natural frequencies with 1.235, 2.500, 3.000 Hz. If they differ"
    )


def test_what_is_not_known_is_not_to_be_measured(found: Findings, bare: Findings) -> None:
    loud = responding(found)
    still = ComponentLoads((), (), (ShaftLoad("quick", None, None, None),), (), (), ())
    assert not any("strain" in item for item in measurements(loud.having(component_loads=still)))
    assert not any("Angular" in item for item in measurements(loud.having(modes=None)))
    none = replace(found.need(Modes), frequency=np.empty(0))
    assert not any("Angular" in item for item in measurements(loud.having(modes=none)))
    one = replace(found.need(Modes), frequency=found.need(Modes).frequency[:1])
    assert any("Angular" in item for item in measurements(loud.having(modes=one)))
    fixed = replace(loud.need(Response), lines=loud.need(Response).lines[1:])
    assert "Analyse the orders and" in measurements(found.having(response=fixed))[0]
    line = loud.need(Response).lines[0]
    nine = tuple(replace(line, order=Fraction(order)) for order in range(1, 10))
    many = replace(
        found.need(Response),
        lines=nine,
        torque=np.zeros((1, 9, len(found.system.spans))),
        status=np.full((1, 9), Status.OK),
    )
    assert "(1, 2, 3, 4, 5, 6, 7, 8)" in measurements(found.having(response=many))[0]
    assert list(closing.chapter(judged(bare))) == []
    assert len(list(closing.chapter(judged(bare, check())))) == 2
    silent = judged(found.having(response=replace(found.need(Response), lines=())))
    assert "Measurements" not in str(list(closing.chapter(silent)))
    assert len(list(closing.chapter(silent))) == 2
