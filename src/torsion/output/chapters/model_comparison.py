"""Chapter: the models of the shafts side by side, the error of each against the exact one, and the verdict."""

from collections.abc import Iterator

import numpy as np

from torsion.analyses.compare.side_by_side import Compared, ModelCompared
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, Points, Table, on_terminal, table
from torsion.output.figures import error_curves
from torsion.output.nearest_criticals import of_torsion
from torsion.output.numbers import NONE, RPM, counted, given, number, order, rpm

MOST_MODES = 40  # of which a table is printed


def chapter(findings: Findings) -> Iterator[Block]:
    """Yield the comparison; nothing if it was not requested."""
    comparison = findings.get(Compared)
    if comparison is None:
        return
    yield Heading("Comparison of the models")
    if comparison.exact is None:
        yield Paragraph(comparison.same, "note", brief=True)
        return
    yield Paragraph(
        "The same train with lumped segments, finite elements and continuous shafts. The continuous model has no "
        "discretisation error and is the reference. "
        f"Frequencies and shapes may differ by {given(100 * comparison.tolerance)} %, torques by "
        f"{given(100 * comparison.torque_tolerance)} %."
    )
    yield from on_terminal([conclusion(comparison)])
    yield _summary(comparison)
    counted = [(f"{model.model}: {model.division}", model.certified) for model in _all(comparison)]
    yield Points(
        tuple(
            text if certified else f"{text}; not certified by Sturm counts"
            for text, certified in counted
        )
    )
    yield from on_terminal([_counts(comparison)])
    yield Heading("Frequencies and shapes", 2)
    yield _modes(comparison)
    caption = (
        "Relative errors against the exact model, by mode; errors below 10⁻¹⁶ are drawn at 10⁻¹⁶"
    )
    yield error_curves.modes(
        "check-modes",
        caption,
        tolerance=comparison.tolerance,
        frequency=[(model.model, np.abs(model.frequency_error)) for model in comparison.models],
        shape=[(model.model, model.shape_error) for model in comparison.models],
    )
    if len(comparison.exact.frequency) > MOST_MODES:
        left_out = f"{MOST_MODES + 1} to {len(comparison.exact.frequency)}"
        yield Paragraph(f"Modes {left_out} are in the JSON file.")
    yield Heading("Response torques", 2)
    yield from _torques(findings, comparison)


def conclusion(comparison: Compared) -> Paragraph:
    """Return the verdict of the comparison in one sentence."""
    if comparison.exact is None:
        return Paragraph(comparison.same, "note")
    limit = f"{given(100 * comparison.tolerance)} % of the exact model"
    if comparison.speed is not None and comparison.torque_tolerance != comparison.tolerance:
        limit += f" (torques: {given(100 * comparison.torque_tolerance)} %)"
    good = [model.model for model in comparison.models if model.model not in comparison.failed]
    if comparison.failed:
        kept = f"; {' and '.join(good)} is" if good else ""
        return Paragraph(
            f"The model {' and '.join(comparison.failed)} is not within {limit}{kept}.", "fail"
        )
    verb = ("model", "is") if len(good) == 1 else ("models", "are")
    return Paragraph(f"The {verb[0]} {' and '.join(good)} {verb[1]} within {limit}.", "pass")


def _summary(comparison: Compared) -> Table:
    """Return the largest errors of every model and its verdict."""
    exact, *_ = _all(comparison)
    rows = []
    for model in _all(comparison):
        verdict = (
            NONE if model is exact else ("FAIL" if model.model in comparison.failed else "PASS")
        )
        errors = [NONE if model is exact else _percent(error) for error in model.largest]
        times = " + ".join(
            number(1e3 * seconds, 2) for seconds in (model.modes_seconds, model.torques_seconds)
        )
        rows.append((model.model, *errors, str(model.below), times, verdict))
    return table(
        "< Model -> | Frequency [%] -> frequency, % | 1 − MAC [%] -> 1 − MAC, % | Torques [%] -> torques, % | "
        "Modes -> | Time [ms] -> ms | < Verdict ->",
        rows,
        f"Maximum errors against the exact model, of {len(exact.frequency)} modes; modes below "
        f"{number(comparison.highest)} Hz; times of one run of the modes and of the torques",
        marks=[row[-1].lower().strip(NONE) for row in rows],
        short="Maximum errors against the exact model",
        rows_in_summary=4,
    )


def _counts(comparison: Compared) -> Paragraph:
    """Whether all models have as many modes as the exact one."""
    exact, *approximate = _all(comparison)
    limit = f"below {number(comparison.highest)} Hz"
    wrong = [f"{model.model} {model.below}" for model in approximate if model.below != exact.below]
    if wrong:
        return Paragraph(
            f"The exact model has {exact.below} elastic modes {limit}, but {', '.join(wrong)}.",
            "note",
        )
    names = " and ".join(model.model for model in approximate)
    has = "has" if len(approximate) == 1 else "have"
    how = "as counted" if all(model.certified for model in (exact, *approximate)) else "as found"
    return Paragraph(
        f"The exact model has {exact.below} elastic modes {limit}, and so {has} {names}, {how} in each."
    )


def _worst(model: ModelCompared, comparison: Compared) -> str:
    """Return where the torques of a model are farthest from the exact ones; empty if none were compared."""
    torques = model.torques
    if torques is None or torques.worst_speed is None or comparison.speed is None:
        return ""
    fixed = f"{number(torques.worst_frequency)} Hz"
    what = fixed if torques.worst_order is None else f"order {order(torques.worst_order)}"
    speed = rpm(float(comparison.speed[torques.worst_speed]))
    return f"{model.model}: {_percent(torques.largest)} % at {speed} rpm, {what}, largest in {torques.component}"


def _all(comparison: Compared) -> tuple[ModelCompared, ...]:
    return comparison.models if comparison.exact is None else (comparison.exact, *comparison.models)


def _percent(error: float) -> str:
    return number(100.0 * error, 3)


def _modes(comparison: Compared) -> Table:
    """Return frequencies of all models, with errors for every model but the exact one."""
    exact, *approximate = _all(comparison)
    titles = "Mode -> | exact [Hz] -> exact, Hz"
    titles += "".join(
        f" | {approximation.model} [Hz] | {approximation.model} error [%] -> {approximation.model} error, % | 1 − MAC"
        for approximation in approximate
    )
    rows = []
    for mode in range(min(MOST_MODES, len(exact.frequency))):
        row = [str(mode + 1), number(float(exact.frequency[mode]), 9)]
        for model in approximate:
            row += [
                number(float(model.frequency[mode]), 9),
                _percent(float(model.frequency_error[mode])),
                number(float(model.shape_error[mode]), 2),
            ]
        rows.append(row)
    return table(
        titles,
        rows,
        "Natural frequencies of the models; MAC: modal assurance criterion of the shapes, weighted by inertia",
        short="Natural frequencies of the models",
    )


def _torques(findings: Findings, comparison: Compared) -> Iterator[Block]:
    if comparison.speed is None:
        yield Paragraph(f"No torques are compared: {comparison.no_torques}.", "note", brief=True)
        return
    yield Paragraph(
        "Complex torques at the driving end of every component, at every requested speed and order. The error is "
        "relative "
        "to the maximum torque at this speed and order, referred to one speed. The models are compared at equal "
        "distances from their own resonances; the table above has the frequency errors."
    )
    compared = [
        (model.model, model.torques) for model in comparison.models if model.torques is not None
    ]
    if places := tuple(text for model in comparison.models if (text := _worst(model, comparison))):
        lines = [(name, torques.error) for name, torques in compared]
        caption = "Maximum relative error of the torques over the speed"
        yield Points(places, brief=True)
        speed = comparison.speed * RPM
        figure = error_curves.torques(
            "check-torques",
            caption,
            speed=speed,
            lines=lines,
            tolerance=comparison.torque_tolerance,
        )
        yield of_torsion(findings, figure)
    left_out = max(torques.left_out for _, torques in compared)
    if left_out:
        words = f"{counted(left_out, 'solution')} at undamped resonances."
        yield Paragraph(f"Omitted: {words}", "note")
