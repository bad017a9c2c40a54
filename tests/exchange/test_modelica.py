"""The Modelica text read back by a reader that knows nothing of the program: structure, and its periodic motion."""

import re
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from tests.for_all import for_all
from typer.testing import CliRunner

import torsion
from torsion.analyses.discretisation import assembled
from torsion.analyses.response.amplitudes import Response
from torsion.analyses.response.over_speed import response_of_orders
from torsion.cli import app
from torsion.errors import InputError
from torsion.exchange.modelica import modelica

SCENES = Path(__file__).parents[2] / "shafting_specs"
NUMBER = r"[-+.\de]+"


def parts_of(text: str) -> tuple[dict, list]:
    """Kind and parameters by name, and all connections."""
    parts = {}
    for kind, name, rest in re.findall(
        r"^  Modelica\.[\w.]+\.(\w+) (\w+)\(?(.*);$", text, re.MULTILINE
    ):
        assert name not in parts
        start = {
            f"{key}0": float(value)
            for key, value in re.findall(rf"(\w+)\(start=({NUMBER}), fixed=true\)", rest)
        }
        parts[name] = (
            kind,
            {key: float(v) for key, v in re.findall(rf"\b(\w+)=({NUMBER})[,)]", rest)} | start,
        )
    return parts, re.findall(r"connect\(([\w.]+), ([\w.]+)\);", text)


def nodes_of(parts: dict, joins: list) -> tuple[dict, dict, int]:
    """Node of every flange and its angle over that of the node; rigid parts join the nodes of their flanges."""
    edges = [(a, b, 1.0) for a, b in joins if "flange" in a]
    for name, (kind, given) in parts.items():
        if kind in ("Inertia", "TorqueSensor", "IdealGear"):
            edges.append((f"{name}.flange_a", f"{name}.flange_b", 1.0 / given.get("ratio", 1.0)))
    near: dict = {}
    for a, b, factor in edges:
        near.setdefault(a, []).append((b, factor))
        near.setdefault(b, []).append((a, 1.0 / factor))
    node, angle, count = {}, {}, 0
    for root in near:
        if root in node:
            continue
        node[root], angle[root], waiting = count, 1.0, [root]
        while waiting:
            flange = waiting.pop()
            for other, factor in near[flange]:
                if other not in node:
                    node[other], angle[other] = count, angle[flange] * factor
                    waiting.append(other)
        count += 1
    return node, angle, count


def periodic_torques(text: str) -> tuple[dict, dict]:
    """Complex torque of every elastic part at the one frequency of the text, and start angle and speed by node."""
    parts, joins = parts_of(text)
    node, angle, count = nodes_of(parts, joins)
    inertia, damping, stiffness = np.zeros((3, count, count))
    force, held, rows = np.zeros(count, complex), set(), {}
    sine = {b.split(".")[0]: a.split(".")[0] for a, b in joins if b.endswith(".tau")}
    frequency = {given["f"] for kind, given in parts.values() if kind == "Sine"}
    assert len(frequency) == 1
    w = 2 * np.pi * frequency.pop()
    for name, (kind, given) in parts.items():
        a, b = f"{name}.flange_a", f"{name}.flange_b"
        if kind == "Inertia":
            inertia[node[a], node[a]] += given["J"] * angle[a] ** 2
        elif kind in ("Spring", "Damper", "SpringDamper"):
            row = np.zeros(count)
            row[node[a]] += angle[a]
            row[node[b]] -= angle[b]
            stiffness += given.get("c", 0.0) * np.outer(row, row)
            damping += given.get("d", 0.0) * np.outer(row, row)
            rows[name] = row, given.get("c", 0.0), given.get("d", 0.0)
        elif kind == "Fixed":
            held.add(node[f"{name}.flange"])
        elif kind == "Torque":
            wave = parts[sine[name]][1]
            phasor = wave["amplitude"] * np.exp(1j * (wave["phase"] - np.pi / 2))
            force[node[f"{name}.flange"]] += angle[f"{name}.flange"] * phasor
    free = [k for k in range(count) if k not in held]
    motion = np.zeros(count, complex)
    dynamic = (stiffness + 1j * w * damping - w**2 * inertia)[np.ix_(free, free)]
    motion[free] = np.linalg.solve(dynamic, force[free])
    starts = {
        name: (motion[node[a]] * angle[a], given["phi0"], given["w0"], w)
        for name, (kind, given) in parts.items()
        if kind == "Inertia" and "phi0" in given and (a := f"{name}.flange_a")
    }
    return {name: (c + 1j * w * d) * (row @ motion) for name, (row, c, d) in rows.items()}, starts


@pytest.mark.parametrize(
    ("scene", "order"),
    [
        ("haixun_06402", "40/21"),
        ("two_stroke_ship", "1"),
        ("v12_generator_set", "5"),
        ("wind_gearbox", None),
        ("twin_motor_ferry", None),
    ],
)
def test_the_text_read_back_has_the_periodic_torques_of_the_response(
    scene: str, order: str | None
) -> None:
    study = torsion.read(SCENES / f"{scene}.yaml")
    system, speed = assembled(study), study.operation.speed
    wanted = None if order is None else Fraction(order)
    if wanted is None:
        wanted = torsion.run(study, only=("response",)).need(Response).lines[0].order
    text = modelica(study, system, speed, wanted)
    reply = response_of_orders(study, system, [wanted], np.array([speed]))
    found, starts = periodic_torques(text)
    expected = dict(
        zip((span.name for span in reply.system.spans), reply.torque[0, 0], strict=True)
    )
    described = dict(re.findall(r'^  \S+ (\w+)\([^"]*"(.*)";$', text, re.MULTILINE))
    pairs = [
        (found[name], expected[described[name]])
        for name in found
        if described.get(name) in expected
    ]
    assert len(pairs) >= 2
    scale = max(abs(torque) for _, torque in pairs)
    assert max(abs(one - other) for one, other in pairs) <= 1e-11 * scale
    largest = max(abs(motion) for motion, *_ in starts.values())
    for motion, angle, velocity, w in starts.values():
        assert angle == pytest.approx(motion.real, abs=1e-10 * largest)
        assert velocity == pytest.approx((1j * w * motion).real, abs=1e-10 * largest * w)


def test_several_orders_of_a_train_with_loss_factors_are_refused() -> None:
    study = torsion.read(SCENES / "v12_generator_set.yaml")
    with pytest.raises(InputError, match="differ from order to order"):
        modelica(study, assembled(study), study.operation.speed)


@for_all(
    ("scene", "options", "words"),
    [
        ("usv", ["-o", "{}/a.mo"], "universal joint"),
        ("idling_gearbox", ["-o", "{}/a.mo", "--rpm", "800"], "amplitude"),
        ("two_discs", ["-o", "{}/a.mo"], "--rpm"),
        ("haixun_06402", ["-o", "{}/a.mo", "--order", "7"], "40/21"),
        ("haixun_06402", ["-o", "{}/a.txt"], "suffix"),
        ("haixun_06402", ["-o", "{}/none/a.mo", "--order", "40/21"], "written"),
        ("haixun_06402", ["-o", "{}/a.mo", "--at", "3"], "--at"),
        ("haixun_06402", ["-o", "{}/a.mo", "--order", "x"], "order"),
        ("haixun_06402", ["-o", "{}/a.npz"], "--at"),
        ("haixun_06402", ["-o", "{}/a.npz", "--rpm", "-1"], "positive"),
    ],
)
def test_what_has_no_counterpart_is_refused_in_words(
    scene: str, options: list, words: str, tmp_path: Path
) -> None:
    run = CliRunner().invoke(
        app,
        ["export", str(SCENES / f"{scene}.yaml"), *(option.format(tmp_path) for option in options)],
    )
    assert (run.exit_code, words in run.output) == (2, True), run.output
    assert not list(tmp_path.iterdir())


TWO_DISCS = """name: two discs
operation: {speeds: {from: 900 rpm, to: 1100 rpm}, rated: {speed: 1000 rpm, power: 10 kW}}
train:
- motor: {name: m, inertia: 0.4}
- coupling: {name: c, stiffness: 9 kN*m/rad, viscous: 6 N*m*s/rad}
- propeller: {name: p, inertia: 0.7}
excitations: [%s]
"""
BY_ORDER, FIXED = "{at: m, order: 2, torque: 5 N*m}", "{at: m, frequency: 50 Hz, torque: 7 N*m}"


def starts_of(excitations: str, order: Fraction | None = None) -> tuple[str, dict]:
    """The text of two discs, and the start values of its inertias."""
    study = torsion.parse(TWO_DISCS % excitations)
    text = modelica(study, assembled(study), 1000 * np.pi / 30, order)
    parts, _ = parts_of(text)
    values = [(given["phi0"], given["w0"]) for kind, given in parts.values() if "phi0" in given]
    return text, np.array(values)


def test_a_torque_of_a_fixed_frequency_is_in_the_model_and_in_its_start() -> None:
    fixed, start = starts_of(FIXED)
    _, expected = periodic_torques(fixed)
    for (motion, _, _, w), (angle, velocity) in zip(expected.values(), start, strict=True):
        assert angle == pytest.approx(motion.real, rel=1e-10)
        assert velocity == pytest.approx((1j * w * motion).real, rel=1e-10)
    text, both = starts_of(f"{BY_ORDER}, {FIXED}")
    by_order = starts_of(BY_ORDER)[1]
    assert text.count("Sources.Sine") == 2
    assert "m at 50 Hz" in text
    assert both == pytest.approx(by_order + start, rel=1e-12)
    chosen, alone = starts_of(f"{BY_ORDER}, {FIXED}", Fraction(2))
    assert chosen.count("Sources.Sine") == 1
    assert alone == pytest.approx(by_order, rel=1e-12)
