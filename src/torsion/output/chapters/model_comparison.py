"""Chapter: the models of the shafts side by side, the error of each against the exact one, and the verdict."""

from collections.abc import Iterator

from torsion.analyses.compare.side_by_side import Compared
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, Points, table
from torsion.output.numbers import counted, given, number, order, rpm
from torsion.output.records import along
from torsion.rules.verdict_line import WORDS

MOST_MODES = 40  # of which a table is printed
WHAT = (
    "The same train with lumped segments, finite elements and continuous shafts. The continuous model has no "
    "discretisation error and is the reference."
)
TORQUES = (
    "Complex torques at the driving end of every component, at every requested speed and order. The error is relative "
    "to the maximum torque at this speed and order, referred to one speed. The models are compared at equal "
    "distances from their own resonances; the table above has the frequency errors."
)


def chapter(findings: Findings) -> Iterator[Block]:
    """Yield the comparison; nothing if it was not requested."""
    comparison = findings.get(Compared)
    if comparison is None:
        return
    yield Heading("Comparison of the models")
    if comparison.exact is None:
        yield Paragraph(comparison.same, "note", brief=True)
        return
    yield Paragraph(WHAT)
    verdict = conclusion(comparison)
    yield Paragraph(verdict.text, verdict.kind, brief=True)
    yield table(
        "model: < Model -> | largest_frequency_error: Frequency [%]:3 -> frequency, % | "
        "largest_shape_error: 1 − MAC [%]:3 -> 1 − MAC, % | largest_torque_error: Torques [%]:3 -> torques, % | "
        "below: Modes -> | certified: < Proven by counts | modes_seconds: Time of modes [ms]:2 | "
        "torques_seconds: Time of torques [ms]:2 | passes: < Within the tolerance -> within",
        comparison.all_models,
        f"Maximum errors against the exact model, of {len(comparison.exact.frequency)} modes; modes below "
        f"{number(comparison.highest)} Hz; times of one run",
        marks=["", *("pass" if model.passes else "fail" for model in comparison.models)],
        short="Maximum errors against the exact model",
        rows_in_summary=4,
    )
    # Frequencies of all models, with errors for every model but the exact one.
    titles = "mode: Mode -> | 1.frequency: exact [Hz]:9 -> exact, Hz"
    for k, model in enumerate(comparison.models, 2):
        titles += (
            f" | {k}.frequency: {model.model} [Hz]:9 | {k}.frequency_error: {model.model} error [%]:3 -> "
            f"{model.model} error, % | {k}.shape_error: 1 − MAC:2"
        )
    yield table(
        titles,
        zip(*(along(model, "mode") for model in comparison.all_models), strict=True),
        "Natural frequencies of the models; MAC: modal assurance criterion of the shapes, weighted by inertia",
        most=MOST_MODES,
        short="Natural frequencies of the models",
    )
    if comparison.speed is None:
        yield Paragraph(f"No torques are compared: {comparison.no_torques}.", "note", brief=True)
        return
    yield Paragraph(TORQUES)
    # Where the torques of each model are farthest from the exact ones.
    places, omitted = list[str](), 0
    for model in comparison.models:
        if (torques := model.torques) is None:
            continue
        omitted = max(omitted, torques.left_out)
        if torques.worst_speed is not None:
            what = f"{number(torques.worst_frequency)} Hz"
            if torques.worst_order is not None:
                what = f"order {order(torques.worst_order)}"
            where = f"at {rpm(float(comparison.speed[torques.worst_speed]))} rpm, {what}"
            percent = number(100.0 * torques.largest, 3)
            places.append(f"{model.model}: {percent} % {where}, largest in {torques.component}")
    if places:
        yield Points(tuple(places), brief=True)
    if omitted:
        words = f"{counted(omitted, 'solution')} at undamped resonances."
        yield Paragraph(f"Omitted: {words}", "note")


def conclusion(comparison: Compared) -> Paragraph:
    """Return the verdict of the comparison in one sentence."""
    if comparison.exact is None:
        return Paragraph(comparison.same, "note")
    limit = f"{given(100 * comparison.tolerance)} % of the exact model"
    if comparison.speed is not None and comparison.torque_tolerance != comparison.tolerance:
        limit += f" (torques: {given(100 * comparison.torque_tolerance)} %)"
    good = [model.model for model in comparison.models if model.passes]
    if comparison.failed:
        kept = f"; {' and '.join(good)} is" if good else ""
        return Paragraph(
            f"{WORDS['fail']}: the model {' and '.join(comparison.failed)} is not within {limit}{kept}.",
            "fail",
        )
    verb = ("model", "is") if len(good) == 1 else ("models", "are")
    models = f"the {verb[0]} {' and '.join(good)} {verb[1]} within {limit}"
    return Paragraph(f"{WORDS['pass']}: {models}.", "pass")
