"""The balance of power against torques worked out by hand from teeth, powers and laws, and what is refused."""

import json
import math
from pathlib import Path

import numpy as np
import pytest
from tests.for_all import for_all

import torsion
from torsion.analyses.motion.train.following_torques import _size
from torsion.analyses.power_balance import power_balance
from torsion.analyses.response.amplitudes import Response
from torsion.analyses.response.harmonic_components import amplitude
from torsion.analyses.steady import PowerBalance, steady
from torsion.assembly import assemble
from torsion.errors import InputError
from torsion.findings import Findings
from torsion.rules import rule_over_speed
from torsion.rules.verdict_line import Checks
from torsion.study import Study

ORACLES = json.loads(
    (Path(__file__).parent / "power_balance_oracles.json").read_text(encoding="utf-8")
)
MEAN = ORACLES["mean_torque"]
DIGITS = 1e-12  # of figures that are stated with 13

TRAIN_M = """
name: eight cylinders, propeller and shaft generator
operation: {speeds: {from: 450 rpm, to: 750 rpm, steps: 7}, rated: {speed: 750 rpm RATED}}
train:
- engine:
    {name: engine, cylinders: 8, strokes: 4, firing_order: [1, 3, 5, 7, 8, 6, 4, 2], inertia: 40, stiffness: 2e7,
     geometry: {bore: 320 mm, stroke: 400 mm, rod_length: 800 mm}, masses: {reciprocating: 90},
     gas: {table: [[1, 20 kN*m, 0 deg]], motored: [[1, 5 kN*m, 0 deg]]} ENGINE}
- coupling: {name: flange, stiffness: 1e8}
- disc: {inertia: 400}
- coupling: {name: rubber, stiffness: 2e6, psi: 1}
- gear:
    name: gear
    teeth: [29, 150]
    inertia: [5, 300]
    branches:
    - teeth: 58
      inertia: 20
      train:
      - coupling: {name: PTO coupling, stiffness: 1e6}
      - generator: {name: generator, inertia: 95 GENERATOR}
- coupling: {name: intermediate, stiffness: 3e7}
- disc: {inertia: 50}
- coupling: {name: tail, stiffness: 3e7}
- propeller: {name: CPP, inertia: 9200 CPP}
"""
STATED = {"GENERATOR": ", power: 1200 kW, load: constant-power", "CPP": ", power: 3280 kW"}


def train_m(**more: str) -> Study:
    """The train with words in its places; a word may close the mapping that it stands in."""
    text = TRAIN_M
    for key in ("RATED", "ENGINE", "GENERATOR", "CPP"):
        word = more.get(key, "")
        text = text.replace(f" {key}}}", word if word.startswith("}") else f"{word}}}")
    return torsion.parse(text)


def mean_torques(study: Study, rpm: float) -> dict[str, float]:
    """N m by the name of spans at their driving station, and by that of machines at their own speed."""
    system = assemble(study.train)
    found = steady(study.train, system, study.operation, np.array([rpm * math.pi / 30]))
    applied = {
        station.name: float(found.applied[k, 0]) for k, station in enumerate(system.stations)
    }
    return applied | {
        span.name: float(found.torque[k, 0]) for k, span in enumerate(system.own_spans)
    }


def assert_row(found: dict[str, float], row: dict) -> None:
    """Every figure of a row of the oracle."""
    crank = [torque for name, torque in found.items() if name.startswith("engine crank")]
    assert crank == pytest.approx(row["crank"][:-1], rel=DIGITS)
    for name in ("flange", "rubber", "intermediate", "tail"):
        assert found[name] == pytest.approx(row[name], rel=DIGITS)
    assert found["PTO coupling"] == pytest.approx(row["pto_coupling"], rel=DIGITS)
    assert found["generator"] == pytest.approx(row["generator"], rel=DIGITS)
    assert found["CPP"] == pytest.approx(row["cpp"], rel=DIGITS)
    assert found["gear wheel 2"] == pytest.approx(row["pto_mesh_at_driving"], rel=DIGITS)
    assert found["gear"] == pytest.approx(row["main_mesh_at_driving"], rel=DIGITS)


@pytest.mark.parametrize("rpm", [750, 600, 450])
@pytest.mark.parametrize(
    "more",
    [
        STATED,
        STATED | {"RATED": ", power: 4480 kW"},
        {**STATED, "CPP": "", "RATED": ", power: 4480 kW"},
    ],
)
def test_every_load_follows_its_own_law_and_the_engine_gives_their_sum(
    rpm: int, more: dict[str, str]
) -> None:
    found = mean_torques(train_m(**more), rpm)
    assert_row(found, MEAN["train_M"]["at_rpm"][str(rpm)])


def test_all_loads_fall_alike_where_a_cylinder_does_not_fire_and_the_plan_says_it_in_kw() -> None:
    row = MEAN["train_M"]["one_cylinder_of_8_without_fuel_all_consumers_fall_alike"]
    study = train_m(**STATED, ENGINE=", misfire: 8")
    found = mean_torques(study, 750)
    for name, key in (
        ("PTO coupling", "pto_coupling"),
        ("tail", "tail"),
        ("flange", "flange"),
        ("CPP", "cpp"),
    ):
        assert found[name] == pytest.approx(row[key], rel=DIGITS)
    assert "3920 kW of 4480 kW enter" in power_balance(study.train, study.operation).sentence
    kept = mean_torques(train_m(**STATED, ENGINE=", misfire: 8, keep_power: true"), 750)
    assert kept["PTO coupling"] == pytest.approx(
        MEAN["train_M"]["at_rpm"]["750"]["pto_coupling"], rel=DIGITS
    )


def test_a_machine_that_helps_the_engine_takes_its_power_from_that() -> None:
    text = TRAIN_M.replace("generator: {name: generator, inertia: 95 GENERATOR}", "motor: MOTOR")
    text = text.replace("MOTOR", "{name: helper, inertia: 9, power: 600 kW, speed: 1800 rpm}")
    text = text.replace(" RATED", "").replace(" ENGINE", "").replace(" CPP}", ", power: 3280 kW}")
    text = text.replace("[29, 150]", "[144, 750]").replace("teeth: 58", "teeth: 60")
    found = mean_torques(torsion.parse(text), 750)
    assert found["helper"] == pytest.approx(MEAN["pti"]["pti_motor_at_1800"], rel=DIGITS)
    assert found["flange"] == pytest.approx(MEAN["pti"]["engine"], rel=DIGITS)


PUMPS = """
name: two pumps
operation: {speeds: {from: 1000 rpm, to: 1500 rpm}, rated: {speed: 1480 rpm}}
train:
- motor: {inertia: 9}
- coupling: {name: first, stiffness: 1e5}
- pump: {name: pump 1, inertia: 3, power: 250 kW}
- coupling: {name: second, stiffness: 1e5}
- gear: {ratio: 0.5, inertia: [1, 1]}
- coupling: {stiffness: 1e5}
- pump: {name: pump 2, inertia: 1, power: 90 kW}
"""


def test_a_coupling_carries_what_the_pumps_behind_it_take() -> None:
    study, row = torsion.parse(PUMPS), MEAN["two_pumps"]
    ratio = float(study.train["pump 2"].ratio)
    assert ratio == 2.0
    found = mean_torques(study, row["speed"])
    assert found["first"] == pytest.approx(row["motor"], rel=DIGITS)
    assert found["pump 1"] == pytest.approx(row["pump 1"], rel=DIGITS)
    assert found["pump 2"] == pytest.approx(row["pump 2"], rel=DIGITS)
    assert found["second"] == pytest.approx(
        2 * row["coupling 2 (second pump, geared up 1:2)"], rel=DIGITS
    )


GENSET = """
name: turbine, generator, exciter
operation: {rated: {speed: 3000 rpm, power: POWER}}
train:
- turbine: {inertia: 1800}
- coupling: {name: main, stiffness: 1e8}
- generator: {inertia: 2500 GENERATOR}
- coupling: {name: to exciter, stiffness: 1e7}
- KIND: {inertia: 20 EXCITER}
"""


@pytest.mark.parametrize(
    ("power", "kind", "more", "main", "behind"),
    [
        ("20 MW", "disc", "", "main", "exciter_generator_absorbs"),
        ("20.08 MW", "generator", ", power: 80 kW", "main_80kW", "exciter_80kW"),
    ],
)
def test_an_exciter_takes_its_own_power_alone(
    power: str, kind: str, more: str, main: str, behind: str
) -> None:
    text = (
        GENSET.replace("POWER", power)
        .replace("KIND", kind)
        .replace(" GENERATOR", "")
        .replace(" EXCITER", more)
    )
    found = mean_torques(torsion.parse(text), 3000)
    assert found["main"] == pytest.approx(MEAN["genset_20_MW"][main], rel=DIGITS)
    assert found["to exciter"] == pytest.approx(MEAN["genset_20_MW"][behind], rel=DIGITS)


def test_a_converter_at_constant_power_takes_more_torque_at_less_speed() -> None:
    oracle = ORACLES["constant_power_load"]
    text = f"""
name: x
operation: {{speeds: {{from: 500 rpm, to: 1500 rpm}}, rated: {{speed: {oracle["speed_rpm"]} rpm}}}}
train: [motor: {{inertia: 5}}, coupling: {{name: c, stiffness: 4e4, viscous: 10}},
        generator: {{inertia: 30, torque: {oracle["T"]}, load: constant-power}}]
"""
    study = torsion.parse(text)
    for rpm in (1500, 1000, 500):
        assert mean_torques(study, rpm)["c"] == pytest.approx(
            oracle["T"] * oracle["speed_rpm"] / rpm, rel=DIGITS
        )


def test_a_table_of_a_machine_is_over_its_own_speed() -> None:
    text = PUMPS.replace("power: 90 kW", "load: [[0 rpm, 100 N*m], [3000 rpm, 400 N*m]]").replace(
        ", power: 250 kW", ""
    )
    text = text.replace("rated: {speed: 1480 rpm}", "rated: {speed: 1480 rpm, power: 340 kW}")
    found = mean_torques(torsion.parse(text), 1000)
    assert found["pump 2"] == pytest.approx(-300.0, rel=DIGITS)
    rated = 340e3 / (1480 * math.pi / 30) - 2 * (100 + 300 * 2960 / 3000)  # of the rest
    assert found["pump 1"] == pytest.approx(-rated * (1000 / 1480) ** 2, rel=DIGITS)


def test_what_is_stated_and_what_is_computed_is_in_the_results() -> None:
    findings: Findings = torsion.run(train_m(**{**STATED, "CPP": "", "RATED": ", power: 4480 kW"}))
    machines = {machine.name: machine for machine in findings.need(PowerBalance).machines}
    row = MEAN["train_M"]["at_rpm"]["750"]
    for name, key in (("engine", "engine"), ("generator", "generator"), ("CPP", "cpp")):
        assert machines[name].power == pytest.approx(row["power"][key], rel=DIGITS)
        assert machines[name].torque == pytest.approx(row[key], rel=DIGITS)
    assert [
        (machine.name, machine.enters, machine.law, machine.free) for machine in machines.values()
    ] == [
        ("engine", True, "", False),
        ("generator", False, "constant power", False),
        ("CPP", False, "quadratic", True),
    ]


def test_a_share_of_the_mean_torque_is_one_of_the_machine_s_own() -> None:
    text = PUMPS.replace(
        "power: 90 kW", "power: 90 kW, blades: 5, excitation: [{blade_order: 1, torque: 10 %}]"
    )
    study = torsion.parse(text)
    system, speed = assemble(study.train), np.array([1000.0, 1480.0]) * math.pi / 30
    (torque,) = study.train.torques
    size = amplitude(system, torque, speed, steady(study.train, system, study.operation, speed))
    expected = 0.1 * -MEAN["two_pumps"]["pump 2"] * np.array([(1000 / 1480) ** 2, 1.0])
    assert size.real == pytest.approx(expected, rel=DIGITS)


@for_all(
    ("more", "message", "hint", "place"),
    [
        (
            {"RATED": ", power: 4480 kW"},
            (
                "4480 kW enter, and the file does not say how they divide between 'generator' "
                "and 'CPP'"
            ),
            "give `power` to both, or to one of them and the other takes the rest",
            "generator",
        ),
        (
            STATED | {"GENERATOR": ", power: 1670 kW", "RATED": ", power: 4480 kW"},
            "the loads absorb 4950 kW, `rated` has 4480 kW",
            ("leave out the power of the one that takes the rest, or correct one"),
            "power",
        ),
        (
            {"GENERATOR": ", power: 4950 kW", "RATED": ", power: 4480 kW"},
            "the loads absorb 4950 kW, `rated` has 4480 kW",
            "make a machine that drives a `motor`",
            "power",
        ),
        (
            {"GENERATOR": ", power: 1200 kW"},
            "'CPP' has no `power`",
            "operation.rated.power",
            "propeller",
        ),
        (
            STATED | {"RATED": "}, load: [[400 rpm, 2 kN*m], [800 rpm, 3 kN*m]]"},
            "a table of `load` is the total",
            "give the table to one machine",
            "load",
        ),
    ],
)
def test_a_balance_that_the_file_does_not_say_is_refused(
    more: dict[str, str], message: str, hint: str, place: str
) -> None:
    with pytest.raises(InputError) as caught:
        train_m(**more)
    (fault,) = caught.value.faults
    assert message in fault.message
    assert hint in fault.hint
    assert place in fault.path
    assert fault.line is not None


def test_where_nothing_drives_the_powers_of_loads_are_refused() -> None:
    with pytest.raises(InputError, match="every machine absorbs; nothing drives"):
        torsion.parse(PUMPS.replace("- motor:", "- disc:"))


def test_a_power_without_a_speed_is_refused() -> None:
    with pytest.raises(InputError, match="`power` of 'pump 1' holds at a speed that is not given"):
        torsion.parse(PUMPS.replace(", rated: {speed: 1480 rpm}", ""))


def test_a_compressor_beside_a_fan_absorbs_by_its_pressures() -> None:
    folder = Path(torsion.__file__).parents[2] / "shafting_specs"
    text = (folder / "reciprocating_compressor.yaml").read_text(encoding="utf-8")
    alone = torsion.parse(text, str(folder / "reciprocating_compressor.yaml"))
    needed = next(part for part in alone.train.parts if part.compressor is not None).compressor
    assert needed is not None
    gas = -sum(throw.gas[0].real for throw in needed.throws) / needed.efficiency
    text = text[: text.index("cases:")] if "cases:" in text else text
    fan = "train:\n  - fan: {name: blower, inertia: 2, power: 5 kW}\n  - coupling: {name: to blower, stiffness: 1e5}\n"
    text = text.replace("train:\n", fan, 1).replace(", power: 140.6 kW", "")
    study = torsion.parse(text, str(folder / "reciprocating_compressor.yaml"))
    found = mean_torques(study, 742)
    own = 5e3 / (742 * math.pi / 30)
    assert found["motor"] == pytest.approx(gas + own, rel=1e-12)
    assert abs(found["to blower"]) == pytest.approx(own, rel=1e-12)


def test_the_full_torque_of_every_span_is_that_when_all_cylinders_fire() -> None:
    for more in (STATED, {**STATED, "CPP": "", "RATED": ", power: 4480 kW"}):
        findings = torsion.run(train_m(**more, ENGINE=", misfire: 8"))
        rated, full = rule_over_speed.rated_torque(findings), rule_over_speed.full_torque(findings)
        assert rated is not None
        assert full is not None
        names = [span.name for span in findings.system.own_spans]
        at, row = names.index("PTO coupling"), MEAN["train_M"]["at_rpm"]["750"]
        assert full[at] == pytest.approx(row["pto_coupling"], rel=DIGITS)
        assert full[names.index("tail")] == pytest.approx(row["tail"], rel=DIGITS)
        assert rated[at] == pytest.approx(row["pto_coupling"], rel=DIGITS)


def test_the_mesh_of_a_shaft_generator_has_a_mean_torque_of_its_own() -> None:
    study = train_m(**STATED)
    findings = torsion.run(torsion.parse(study.text + "rules: [gear-hammer]\n"))
    checks = {
        check.where: check
        for check in findings.need(Checks).lines
        if check.clause == "torque reversal"
    }
    at = int(np.argmin(np.abs(findings.need(Response).speed - checks["gear wheel 2"].speed)))
    rpm = float(findings.need(Response).speed[at]) * 30 / math.pi
    generator = 1200e3 / (rpm * math.pi / 30)  # referred to the engine, at constant power
    assert checks["gear wheel 2"].limit == pytest.approx(generator, rel=1e-9)


@pytest.mark.parametrize(("rpm", "within"), [(1500, 1e-12), (1000, 1e-5), (500, 1e-5), (60, 1e-5)])
def test_a_share_of_a_torque_at_constant_power_follows_the_speed_over_time(
    rpm: float, within: float
) -> None:
    text = PUMPS.replace(
        "pump: {name: pump 1, inertia: 3, power: 250 kW}",
        "generator: {name: g, inertia: 3, power: 250 kW, load: constant-power, "
        "ripple: [{order: 2, torque: 4 %}]}",
    ).replace("1480 rpm}", "1500 rpm}")
    study = torsion.parse(text)
    system, speed = assemble(study.train), rpm * math.pi / 30
    size = _size(study, system, study.train.torques[0], begins=0.0, staying=None)
    value = size.value(size.part(speed), np.array([speed]))[0]
    assert value == pytest.approx([0.04 * 250e3 / speed], rel=within)
