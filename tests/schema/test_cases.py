"""Cases: each is the file with its changes, and its results are those of a file that is written out by hand."""

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from tests.contracts.frozen import SCENES, solved
from tests.for_all import for_all
from tests.texts import ANY_CHARACTER

import torsion
from torsion.analyses.undamped_modes import ModesSettings
from torsion.errors import InputError
from torsion.findings import NORMAL, Findings
from torsion.output.stored.results_json import listed, makers, results
from torsion.schema.variants.cases import _effect, _is_same
from torsion.schema.variants.overlay import multiplied
from torsion.study import Study

FERRY = SCENES["ferry_cases"].read_text(encoding="utf-8")
ALONE = FERRY[: FERRY.index("cases:\n")]
PTO = ALONE[
    ALONE.index("            - coupling: {name: PTO clutch") : ALONE.index(
        "  - shaft: {name: intermediate"
    )
]
BASE = """name: base
operation: {speeds: {from: 300 rpm, to: 900 rpm, steps: 31}, rated: {speed: 800 rpm, power: 50 kW}}
train:
  - motor: {name: engine, inertia: 2, ripple: [{order: 3, torque: 10 %}]}
  - coupling: {stiffness: 40 kN*m/rad, psi: 0.9, tolerance: 10 %, vibratory_torque: 200 N*m}
  - disc: {inertia: 1.5}
  - branch: {train: [coupling: {name: clutch, stiffness: 9e3, psi: 0.5}, disc: {inertia: 0.4}]}
  - gear: {name: box, teeth: [20, 40], inertia: [0.1, 0.5]}
  - coupling: {stiffness: 80 kN*m/rad, loss_factor: 0.05}
  - propeller: {name: wheel, inertia: 4, damping: {model: archer, factor: 30}}
rules: [coupling-maker]
"""


def with_case(body: str, base: str = BASE) -> Study:
    """The case x of a file."""
    return torsion.parse(f"{base}cases:\n  x: {body}\n", "t.yaml").cases["x"]


def numbers(findings: Findings) -> dict[str, Any]:
    """Every result but the head that names the file, the plan with its times, the sources, and the places of faults.

    Rows of zero pitch and tolerances state what the cases of a file lack.
    """
    found = {
        key: listed(make())
        for key, make in makers(findings).items()
        if key not in ("scene", "plan", "cases", "sources")
    }
    found["checks"] = [
        check for check in found["checks"] if check["clause"] not in ("zero pitch", "tolerances")
    ]
    return found


def replaced(text: str, *pairs: tuple[str, str]) -> str:
    for old, new in pairs:
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    return text


BY_HAND = {  # of the scene: what a hand would change in the file
    "soft": [("stiffness: 90 kN*m/rad", "stiffness: 76.5 kN*m/rad")],
    "stiff": [("stiffness: 90 kN*m/rad", "stiffness: 103.5 kN*m/rad")],
    "warm": [("stiffness: 90 kN*m/rad", "stiffness: 72 kN*m/rad"), ("psi: 1.0", "psi: 0.8")],
    "zero pitch": [
        (
            "power: 750 kW}\n",
            "power: 750 kW}\n  load: [[400 rpm, 250 N*m], [1260 rpm, 1500 N*m]]\n",
        ),
        ("entrained: 25 %", "entrained: 10 %"),
    ],
    "PTO out": [(PTO, ""), ("          train:\n", "")],
    "damper seized": [
        ("stiffness: 90 kN*m/rad", "stiffness: 72 kN*m/rad"),
        ("psi: 1.0", "psi: 0.8"),
        ("damping: 900 N*m*s/rad", "damping: 1e9"),
    ],
}


@pytest.fixture(scope="module")
def ferry() -> Findings:
    return solved("ferry_cases")


def test_the_scene_has_the_cases_that_are_written_by_hand(ferry: Findings) -> None:
    assert list(ferry.each) == [NORMAL, *BY_HAND]


@pytest.mark.parametrize("name", BY_HAND)
def test_results_of_a_case_equal_those_of_the_file_written_out_by_hand(
    ferry: Findings, name: str
) -> None:
    by_hand = torsion.run(torsion.parse(replaced(ALONE, *BY_HAND[name]), "ferry.yaml"))
    case, alone = numbers(ferry.cases[name]), numbers(by_hand)
    if name in ("soft", "stiff"):  # at an end of the tolerances there is no band of them
        assert case.pop("tolerances") is None
        del alone["tolerances"]
    assert case == alone
    assert ferry.cases[name].results["modes"].frequency.size


def test_the_file_as_it_stands_is_no_different_beside_its_cases(ferry: Findings) -> None:
    assert numbers(ferry) == numbers(torsion.run(torsion.parse(ALONE, "ferry.yaml")))


@pytest.mark.parametrize(
    ("case", "pairs"),
    [
        ("{set: {box.teeth: [20, 60]}}", [("teeth: [20, 40]", "teeth: [20, 60]")]),
        ("{set: {box.inertia.2: 0.7}}", [("[0.1, 0.5]", "[0.1, 0.7]")]),
        ("{scale: {box.inertia.2: 140 %}}", [("[0.1, 0.5]", "[0.1, 0.7]")]),
        (
            "{scale: {coupling-1.stiffness: 115 %}}",
            [("stiffness: 40 kN*m/rad", "stiffness: 46 kN*m/rad")],
        ),
        ("{scale: {coupling-1.stiffness: 0.1}}", [("stiffness: 40 kN*m/rad", "stiffness: 4000")]),
        ("{set: {engine.ripple.1.torque: 5 %}}", [("torque: 10 %", "torque: 5 %")]),
        ("{remove: coupling-1.psi, set: {coupling-1.viscous: 50}}", [("psi: 0.9", "viscous: 50")]),
        (
            "{rules: [gear-hammer: {limit: 0.4}], set: {box.application_factor: 1.3}}",
            [
                ("[coupling-maker]", "[gear-hammer: {limit: 0.4}]"),
                ("inertia: [0.1", "application_factor: 1.3, inertia: [0.1"),
            ],
        ),
        (
            "{set: {analyses.modes.count: 3, analyses.response.method: first-order}}",
            [("rules:", "analyses: {modes: {count: 3}, response: {method: first-order}}\nrules:")],
        ),
    ],
)
def test_a_change_is_that_of_the_same_key_in_the_file(
    case: str, pairs: list[tuple[str, str]]
) -> None:
    made, hand = (
        torsion.run(with_case(case)),
        torsion.run(torsion.parse(replaced(BASE, *pairs), "t.yaml")),
    )
    assert numbers(made) == numbers(hand)


def test_speeds_of_a_case_are_those_of_the_file_and_a_part_of_its_range_that_is_meant() -> None:
    speeds = "{from: 400 rpm, to: 700 rpm, steps: 11}"
    made = torsion.run(with_case(f"{{speeds: {speeds}}}"))
    hand = torsion.run(
        torsion.parse(replaced(BASE, ("{from: 300 rpm, to: 900 rpm, steps: 31}", speeds)), "t.yaml")
    )
    (case,), (alone, above) = (numbers(one).pop("checks") for one in (made, hand))
    assert (case["value"], case["limit"]) == (alone["value"], alone["limit"])
    assert (case["verdict"], alone["verdict"], above["verdict"]) == (
        "restricted",
        "pass",
        "not judged",
    )
    assert [
        {key: value for key, value in numbers(one).items() if key != "checks"}
        for one in (made, hand)
    ] == [{key: value for key, value in numbers(made).items() if key != "checks"}] * 2


CHORD = "links: [{between: [engine, disc-1], coupling: {name: chord 1.2, stiffness: 5e3}}]\n"
SECTIONS = f"""{CHORD}excitations: [{{at: engine, order: 2, torque: 5}}, {{at: disc-1, order: 1, torque: 9}}]
analyses: {{modes: {{count: 3}}, response: {{}}}}
"""


@for_all(
    ("case", "pair"),
    [
        ("{set: {excitations.2.torque: 11}}", ("torque: 9}", "torque: 11}")),
        ("{remove: excitations.1}", ("{at: engine, order: 2, torque: 5}, ", "")),
        (
            "{set: {excitations: [{at: disc-1, order: 1, torque: 9}]}}",
            ("{at: engine, order: 2, torque: 5}, ", ""),
        ),
        ("{set: {links.1.coupling.stiffness: 6e3}}", ("stiffness: 5e3", "stiffness: 6e3")),
        ("""{set: {'"chord 1.2".stiffness': 6e3}}""", ("stiffness: 5e3", "stiffness: 6e3")),
        ("""{scale: {"'chord 1.2'.stiffness": 1.2}}""", ("stiffness: 5e3", "stiffness: 6000")),
        ("""{scale: {"'chord 1.2' . stiffness": 120 %}}""", ("stiffness: 5e3", "stiffness: 6000")),
        ("{remove: chord 1.2}", (CHORD, "")),
        ("{remove: links.1}", (CHORD, "")),
        ("{set: {analyses.modes.count: 2}}", ("count: 3", "count: 2")),
        ("{remove: analyses.response, rules: []}", (", response: {}}\n", "}\n")),
        (
            "{set: {analyses: {modes: {count: 2}}}, rules: []}",
            ("count: 3}, response: {}}", "count: 2}}"),
        ),
        ("{set: {operation.rated.power: 40 kW}}", ("power: 50 kW", "power: 40 kW")),
        ("{set: {wheel.damping.factor: 40}}", ("factor: 30", "factor: 40")),
    ],
)
def test_every_section_is_reached_by_its_key(case: str, pair: tuple[str, str]) -> None:
    base = (
        replaced(BASE, ("tolerance: 10 %, ", "")) + SECTIONS
    )  # whose corners take half of the time
    hand = replaced(base, pair)
    if "rules: []" in case:
        hand = hand.replace("rules: [coupling-maker]\n", "")
    assert numbers(torsion.run(with_case(case, base))) == numbers(
        torsion.run(torsion.parse(hand, "t.yaml"))
    )


def test_a_name_with_dots_stands_in_quotes() -> None:
    with pytest.raises(InputError, match=re.escape('stands in quotes: `"chord 1.2".stiffness`')):
        with_case("{set: {chord 1.2.stiffness: 6e3}}", BASE + SECTIONS)
    with pytest.raises(InputError, match="`operation` is a section and a component"):
        with_case(
            "{set: {operation.inertia: 3}}", BASE.replace("disc: {", "disc: {name: operation, ", 1)
        )
    case = """{set: {'"operation".inertia': 3}}"""
    study = with_case(case, BASE.replace("- disc: {", "- disc: {name: operation, ", 1))
    assert study.train.inertias[1].inertia == 3.0


def test_components_keep_their_names_where_others_are_taken_away() -> None:
    study = with_case("{remove: clutch}")
    names = [part.name for part in study.train.parts]
    assert names == ["engine", "coupling-1", "disc-1", "box", "coupling-3", "wheel"]
    hand = "".join(line for line in BASE.splitlines(keepends=True) if "branch" not in line)
    hand = hand.replace("{stiffness: 80", "{name: coupling-3, stiffness: 80")
    assert numbers(torsion.run(study)) == numbers(torsion.run(torsion.parse(hand, "t.yaml")))
    branch = "  - branch: {train: [coupling: {stiffness: 8e3}, disc: {inertia: 0.3}]}\n"
    more = BASE.replace("  - gear:", f"{branch}  - gear:")
    later = [part.name for part in with_case("{remove: clutch}", more).train.parts]
    assert later[:3] == ["engine", "coupling-1", "disc-1"]
    assert later[3:] == ["branch-2", "coupling-3", "disc-3", "box", "coupling-4", "wheel"]


def test_what_acts_on_a_component_goes_with_it() -> None:
    loads = "excitations: [{at: engine, order: 2, torque: 5}, {at: disc-2, order: 1, torque: 9}]\nlinks: "
    loads += "[{between: [disc-1, disc-2], coupling: {name: chord, stiffness: 5e3}}]\n"
    case = with_case("{remove: clutch}", BASE + loads)
    assert [
        torque.name for torque in case.train.torques if torque.path[:1] == ("excitations",)
    ] == ["engine"]
    assert not case.train.has_loops
    assert case.case.changes[0].before == "branch-1, clutch, disc-2, chord, 1 excitation"


def test_the_main_train_loses_its_ends_alone() -> None:
    study = with_case("{remove: [box, coupling-3, wheel], rules: []}")
    names = [part.name for part in study.train.parts]
    assert names == ["engine", "coupling-1", "disc-1", "branch-1", "clutch", "disc-2"]
    first = with_case(
        "{remove: [engine, coupling-1], set: {operation.load: constant}, rules: []}",
        BASE.replace("operation: {", "operation: {at: wheel, "),
    )
    assert [part.name for part in first.train.parts][:2] == ["disc-1", "branch-1"]


def test_a_case_based_on_another_makes_its_changes_first() -> None:
    text = """cases:
  later: {based_on: warm, scale: {coupling-1.stiffness: 50 %}}
  warm: {set: {coupling-1.stiffness: 30 kN*m/rad}, judged: false}
"""
    cases = torsion.parse(BASE + text, "t.yaml").cases
    assert list(cases) == ["later", "warm"]
    assert cases["later"].train.springs[0].flexibility == 1.0 / 15e3
    assert [(one.before, one.after) for one in cases["later"].case.changes] == [
        ("40 kN*m/rad", "15 kN*m/rad")
    ]
    assert (cases["later"].case.is_judged, cases["warm"].case.is_judged) == (True, False)


def test_tolerances_make_two_corners_of_all_couplings_together() -> None:
    flexible = BASE.replace("stiffness: 80 kN*m/rad", "flexibility: 1.25e-5, tolerance: 20 %")
    stages = "stages: [{from: 2 deg, stiffness: 8e3}]"
    staged = flexible.replace(
        "stiffness: 9e3, psi: 0.5", f"stiffness: 9e3, tolerance: 5 %, {stages}"
    )
    cases = torsion.parse(f"{staged}cases: {{from: tolerances}}\n", "t.yaml").cases
    for name, sign in (("soft", -1), ("stiff", 1)):
        found = [1.0 / spring.flexibility for spring in cases[name].train.springs]
        wanted = [40e3 + sign * 4e3, 9e3 + sign * 450.0, 80e3 + sign * 16e3]
        np.testing.assert_allclose(found, wanted, rtol=3e-16)
        assert cases[name].train["clutch"].nonlinear.stages[0][1] == 8e3 + sign * 400.0
        assert cases[name].case.is_corner
    plan = torsion.run(torsion.parse(f"{BASE}cases: {{from: tolerances}}\n", "t.yaml")).plan
    assert not any("tolerance" in what for what, _ in plan.left_out)
    assert any(
        "tolerance" in what for what, _ in torsion.run(torsion.parse(BASE, "t.yaml")).plan.left_out
    )


def test_the_two_corners_enclose_the_frequencies_of_every_combination_of_tolerances() -> None:
    base = BASE.replace("stiffness: 9e3", "stiffness: 9e3, tolerance: 12 %")
    base = base.replace("stiffness: 80", "tolerance: 20 %, stiffness: 80")

    def frequencies(study: Study) -> np.ndarray:
        return (
            torsion.run(replace(study, rules=(), analyses={"modes": ModesSettings()}))
            .results["modes"]
            .frequency
        )

    corners = torsion.parse(f"{base}cases: {{from: tolerances}}\n", "t.yaml").cases
    soft, stiff = (frequencies(corners[name]) for name in ("soft", "stiff"))
    assert np.all(soft < stiff)
    random = np.random.default_rng(3)
    for _ in range(20):
        factors = 1.0 + np.array([0.1, 0.12, 0.2]) * random.choice([-1.0, -0.5, 0.0, 0.5, 1.0], 3)
        each = zip(("coupling-1", "clutch", "coupling-3"), factors, strict=True)
        scale = ", ".join(f"{name}.stiffness: {by}" for name, by in each if by != 1.0)
        between = frequencies(with_case(f"{{scale: {{{scale}}}}}", base))
        assert np.all((soft <= between * (1 + 1e-13)) & (between <= stiff * (1 + 1e-13)))


@for_all(
    ("value", "factor", "made"),
    [
        ("180 kN*m/rad", "1.15", "207 kN*m/rad"),
        ("25 %", "0.5", "12.5 %"),
        (2.4e6, "1.1", 2.64e6),
        (7, "2", 14),
        (7, "0.5", 3.5),
        ("1e3 N*m", "1.001", "1001 N*m"),
        ("1_000", "1/4", "250"),
        ("1500 rpm", "2/3", "1000 rpm"),
        ("steel", "2", None),
        ("21/8", "2", None),
        (True, "2", None),
        ([1], "2", None),
        (None, "2", None),
        (float("inf"), "2", None),
        ("1e300 N*m", "2", "2E300 N*m"),
        ("1e-300 N*m", "0.5", "5E-301 N*m"),
    ],
)
def test_a_factor_multiplies_the_digits_of_the_file_exactly(
    value: Any, factor: str, made: Any
) -> None:
    assert multiplied(value, torsion.fields.Fraction(factor)) == made


def rows() -> list[tuple[str, str, str]]:
    file = Path(__file__).parents[1] / "faults" / "faulty_cases.txt"
    lines = [
        line
        for line in file.read_text(encoding="utf-8").splitlines()
        if line and not line.startswith("#")
    ]
    return [tuple(line.split(" | ")) for line in lines]  # type: ignore[misc]


def test_a_section_is_removed_by_its_name() -> None:
    study = torsion.parse(
        "name: a\ntrain: [disc: {inertia: 1}, coupling: {stiffness: 5}, disc: {inertia: 2}]\n"
        "damping: {modal: 2 %}\ncases: {bare: {remove: [damping]}}\n"
    )
    assert study.train.modal_damping == (0.02,)
    assert study.cases["bare"].train.modal_damping == ()


@for_all(("place", "text", "words"), rows())
def test_a_faulty_case_is_refused_at_the_fault_and_only_there(
    place: str, text: str, words: str
) -> None:
    first = BASE.count("\n") + 2
    with pytest.raises(InputError) as caught:
        torsion.parse(f"{BASE}cases:\n  {text}\n".replace("\\n", "\n"), "bad.yaml")
    faults = caught.value.faults
    found = [(fault.line, fault.column) for fault in faults]
    assert [
        f"{line - first}:{column}" if line >= first else f"{line}" for line, column in found
    ] == [place]
    said = f"{faults[0].message} ({faults[0].hint})"
    assert [word for word in words.split() if word not in said] == [], said
    assert str(caught.value).startswith("bad.yaml:")


def test_all_faults_of_all_cases_are_reported_at_once_each_with_its_case() -> None:
    text = "cases:\n  a: {set: {engine.inertia: -1}}\n  b: {scale: {enginee.inertia: 2}}\n"
    text += (
        "  c: {based_on: a, set: {wheel.inertia: 5}}\n  d: {remove: coupling-1}\n  e: {sett: 1}\n"
    )
    with pytest.raises(InputError) as caught:
        torsion.parse(BASE + text, "t.yaml")
    said = [re.match(r"case '(.)'", fault.message) for fault in caught.value.faults]
    assert [one and one[1] for one in said] == ["a", "b", "d", None]


def test_a_fault_found_while_solving_is_located_in_its_case() -> None:
    link = "links: [{between: [engine, disc-1], coupling: {name: chord, stiffness: 1e4}}]\n"
    gone = "remove: [coupling-1.stiffness, coupling-1.psi, chord.stiffness]"
    rigid = f"{link}cases: {{x: {{{gone}, set: {{coupling-1.flexibility: 0, chord.flexibility: 0}}}}}}\n"
    found = torsion.run(torsion.parse(BASE + rigid, "t.yaml"))
    assert found.is_answered
    assert not found.cases["x"].is_answered
    (one,) = found.cases["x"].plan.unanswered
    assert one.is_input
    assert re.match(r"t\.yaml:\d+:\d+: case 'x': ", one.text)
    assert results(found)["cases"]["x"].keys() == {"plan"}


NAMES = st.sampled_from(
    [
        "engine",
        "coupling-1",
        "disc-1",
        "clutch",
        "box",
        "branch-1",
        "wheel",
        "operation",
        "analyses",
        "materials",
        "links",
        "excitations",
        "rules",
        "train",
        '"box"',
        "'",
        "",
        ".",
        "box.",
        "0",
        "näme",
        "damping",
    ]
)
KEYS = st.sampled_from(
    [
        "inertia",
        "stiffness",
        "psi",
        "teeth",
        "1",
        "2",
        "0",
        "-1",
        "99999999999999999999",
        "name",
        "branches",
        "train",
        "speeds",
        "from",
        "load",
        "rated",
        "modes",
        "count",
        "ripple",
        "unusual",
        "between",
        "damping",
        "held",
        "",
    ]
)
VALUES = st.recursive(
    st.one_of(
        st.none(),
        st.booleans(),
        st.integers(),
        st.floats(),
        st.text(ANY_CHARACTER, max_size=5),
        st.sampled_from(["40 kN*m/rad", "115 %", "engine", "steel", "1e400", "nan"]),
    ),
    lambda inner: (
        st.lists(inner, max_size=3)
        | st.dictionaries(st.text(ANY_CHARACTER, min_size=1, max_size=4), inner, max_size=2)
    ),
    max_leaves=5,
)
PATHS = st.builds(lambda name, keys: ".".join([name, *keys]), NAMES, st.lists(KEYS, max_size=3))
CASE = st.fixed_dictionaries(
    {},
    optional={
        "set": st.dictionaries(PATHS, VALUES, max_size=3) | VALUES,
        "scale": st.dictionaries(
            PATHS, st.floats() | st.sampled_from(["115 %", 2, "x"]), max_size=3
        )
        | VALUES,
        "remove": st.lists(PATHS | NAMES, max_size=3) | VALUES,
        "based_on": st.sampled_from(["a", "b", "soft", "normal", "z"]),
        "rules": VALUES | st.just(["gear-hammer"]),
        "speeds": VALUES,
        "judged": VALUES,
    },
)


CASE_NAMES = st.sampled_from(["a", "b", "c", "from", "soft", "normal", ""])


@settings(max_examples=150, deadline=None)
@example(
    {"a": {"based_on": "soft", "rules": ["gear-hammer"]}, "soft": "tolerances"}
)  # based on one that is at fault
@given(st.dictionaries(CASE_NAMES, CASE | VALUES | st.just("tolerances"), min_size=1, max_size=3))
def test_no_case_ends_in_a_traceback(cases: dict[str, Any]) -> None:
    import yaml

    text = yaml.safe_dump({"cases": cases}, allow_unicode=True, sort_keys=False)
    try:
        study = torsion.parse(BASE + text, "t.yaml")
    except InputError as error:
        found = error
    else:
        assert study.cases
        return
    assert all(fault.line for fault in found.faults)


def test_a_case_based_on_one_at_fault_leaves_that_one_fault_alone() -> None:
    with pytest.raises(InputError) as caught:
        torsion.parse(
            BASE + "cases:\n  soft: tolerances\n  a: {based_on: soft, rules: [gear-hammer]}\n",
            "t.yaml",
        )
    assert [fault.line for fault in caught.value.faults] == [13]


def test_any_digit_of_any_array_is_an_effect_of_a_case() -> None:
    study = torsion.read(SCENES["six_cylinder_pressure"])
    parts = list(study.train.parts)
    place, record = next(
        (place, part.engine) for place, part in enumerate(parts) if part.engine is not None
    )
    assert record.gas is not None
    firing = record.gas.firing.copy()
    firing[0, firing.shape[1] // 2] *= 1.0 + 1e-12
    parts[place] = parts[place].with_records(
        replace(record, gas=replace(record.gas, firing=firing))
    )
    changed = replace(study, train=replace(study.train, parts=tuple(parts)))
    assert not _is_same(_effect(changed), _effect(study))
    parts = [replace(part) for part in study.train.parts]
    same = replace(study, train=replace(study.train, parts=tuple(parts)))
    assert _is_same(_effect(same), _effect(study))
