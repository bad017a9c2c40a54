"""Chapter: the models of the shafts side by side, the error of each against the exact one, and the verdict."""

from typing import TYPE_CHECKING

import numpy as np

from torsion.analyses.compare.side_by_side import Compared
from torsion.findings import Findings
from torsion.output.blocks import Block, Column, Figure, Heading, Paragraph, Points, Table, on_terminal, texts
from torsion.output.numbers import NONE, RPM, given, number, order, rpm

if TYPE_CHECKING:
    from torsion.analyses.compare.side_by_side import ModelCompared

MOST_MODES = 40  # of which a table is printed


def chapter(findings: Findings) -> list[Block]:
    """Nothing where it was not requested."""
    found = findings.get(Compared)
    if found is None:
        return []
    blocks: list[Block] = [Heading("Comparison of the models")]
    if found.exact is None:
        return [*blocks, Paragraph(found.same, "note", brief=True)]
    blocks += [_introduction(found), *on_terminal([conclusion(found)]), summary(found), Points(_divisions(found))]
    blocks += [*on_terminal([counts(found)]), Heading("Frequencies and shapes", 2), modes(found), _modes_figure(found)]
    shown, all_of_them = min(MOST_MODES, len(found.exact.frequency)), len(found.exact.frequency)
    if shown < all_of_them:
        blocks.append(Paragraph(f"Modes {shown + 1} to {all_of_them} are left out of the table; see the JSON file."))
    return [*blocks, Heading("Response torques", 2), *_torques(found)]


def conclusion(found: "Compared") -> Paragraph:
    """The verdict in a sentence."""
    if found.exact is None:
        return Paragraph(found.same, "note")
    limit = f"{given(100 * found.tolerance)} % of the exact model"
    good = [model.model for model in found.models if model.model not in found.failed]
    if found.failed:
        kept = f"; {' and '.join(good)} is" if good else ""
        return Paragraph(f"The model {' and '.join(found.failed)} is not within {limit}{kept}.", "fail")
    verb = ("model", "is") if len(good) == 1 else ("models", "are")
    return Paragraph(f"The {verb[0]} {' and '.join(good)} {verb[1]} within {limit}.", "pass")


def summary(found: "Compared") -> Table:
    """The largest errors of every model and its verdict."""
    columns = (
        texts("Model", "model"), Column("Frequency", "%", short="frequency, %"),
        Column("1 − MAC", "%", short="1 − MAC, %"), Column("Torques", "%", short="torques, %"),
        Column("Modes", short="modes"), Column("Time", "ms", short="ms"), texts("Verdict", "verdict"),
    )  # fmt: skip
    rows = []
    for model in _all(found):
        errors, verdict = tuple(_percent(error) for error in model.largest), "PASS"
        if model is found.exact:
            errors, verdict = (NONE, NONE, NONE), NONE
        elif model.model in found.failed:
            verdict = "FAIL"
        times = " + ".join(number(1e3 * seconds, 2) for seconds in (model.modes_seconds, model.torques_seconds))
        rows.append((model.model, *errors, str(model.below), times, verdict))
    marks = ("", *("fail" if model.model in found.failed else "pass" for model in found.models))
    caption = (
        f"Largest errors against the exact model, of {len(_all(found)[0].frequency)} modes; modes below "
        f"{number(found.highest)} Hz; times of one run of the modes and of the torques"
    )
    return Table(columns, tuple(rows), caption, marks, "Largest errors against the exact model")


def counts(found: "Compared") -> Paragraph:
    """Whether all models have as many modes as the exact one."""
    exact, *others = _all(found)
    at = f"below {number(found.highest)} Hz"
    wrong = [f"{model.model} {model.below}" for model in others if model.below != exact.below]
    if wrong:
        return Paragraph(f"The exact model has {exact.below} elastic modes {at}, but {', '.join(wrong)}.", "note")
    names = " and ".join(model.model for model in others)
    has = "has" if len(others) == 1 else "have"
    how = "as counted" if all(model.certified for model in (exact, *others)) else "as found"
    return Paragraph(f"The exact model has {exact.below} elastic modes {at}, and so {has} {names}, {how} in each.")


def worst(model: "ModelCompared", found: "Compared") -> str:
    """Where the torques of a model are farthest from the exact ones; empty where none were compared."""
    torques = model.torques
    if torques is None or torques.worst_speed is None or found.speed is None:
        return ""
    fixed = f"{number(torques.worst_frequency)} Hz"
    what = fixed if torques.worst_order is None else f"order {order(torques.worst_order)}"
    at = rpm(float(found.speed[torques.worst_speed]))
    return f"{model.model}: {_percent(torques.largest)} % at {at} rpm, {what}, largest in {torques.component}"


def _introduction(found: "Compared") -> Paragraph:
    return Paragraph(
        "The same train with its shafts as lumped segments, as finite elements and as continua, each discretised "
        "as in a calculation with that model alone. The continuum has no discretisation error: every error is "
        f"relative to it, and none may exceed {given(100 * found.tolerance)} %."
    )


def _all(found: "Compared") -> "tuple[ModelCompared, ...]":
    return found.models if found.exact is None else (found.exact, *found.models)


def _percent(error: float) -> str:
    return number(100.0 * error, 3)


def _divisions(found: "Compared") -> tuple[str, ...]:
    return tuple(
        f"{model.model}: {model.division}" + ("" if model.certified else "; not certified by counts")
        for model in _all(found)
    )


def modes(found: "Compared") -> Table:
    """Frequencies of all models, of every model but the exact one also the errors."""
    exact, *others = _all(found)
    columns = [Column("Mode", short="mode"), Column("exact", "Hz", short="exact, Hz")]
    for model in others:
        columns += [
            Column(model.model, "Hz"),
            Column(f"{model.model} error", "%", short=f"{model.model} error, %"),
            Column("1 − MAC"),
        ]
    rows = []
    for mode in range(min(MOST_MODES, len(exact.frequency))):
        row = [str(mode + 1), number(float(exact.frequency[mode]), 9)]
        for model in others:
            row += [number(float(model.frequency[mode]), 9), _percent(float(model.frequency_error[mode])),
                    number(float(model.shape_error[mode]), 2)]  # fmt: skip
        rows.append(tuple(row))
    caption = (
        "Natural frequencies of the models, mode by mode; MAC: agreement of shapes at the stations of the train, "
        "weighted by inertia"
    )
    return Table(tuple(columns), tuple(rows), caption, short="Natural frequencies of the models")


def _modes_figure(found: "Compared") -> Figure:
    values = {
        "frequency": [(model.model, np.abs(model.frequency_error)) for model in found.models],
        "shape": [(model.model, model.shape_error) for model in found.models],
        "tolerance": found.tolerance,
    }
    caption = "Relative errors against the exact model, mode by mode; what is below 10⁻¹⁶ is drawn there"
    return Figure("check-modes", caption, "check modes", values)


def _torques(found: "Compared") -> list[Block]:
    if found.speed is None:
        return [Paragraph(f"No torques are compared: {found.no_torques}.", "note", brief=True)]
    blocks: list[Block] = [
        Paragraph(
            "Complex torques at the driving end of every component, at every requested speed and order; a "
            "difference counts relative to the largest of these torques at that speed and order, all referred to one "
            "speed. Near a resonance an error of its frequency is magnified."
        )
    ]
    if places := tuple(text for model in found.models if (text := worst(model, found))):
        blocks += [Points(places, brief=True), _torques_figure(found, found.speed)]
    left_out = max(model.torques.left_out for model in found.models if model.torques is not None)
    if left_out:
        words = f"{left_out} answers that cannot be trusted (exactly in resonance without damping) are left out."
        blocks.append(Paragraph(words, "note"))
    return blocks


def _torques_figure(found: "Compared", speed: np.ndarray) -> Figure:
    lines = [(model.model, model.torques.error) for model in found.models if model.torques is not None]
    values = {"speed": speed * RPM, "lines": lines, "tolerance": found.tolerance}
    caption = "Relative error of the torques over the speed, the largest of all orders and components"
    return Figure("check-torques", caption, "check torques", values)
