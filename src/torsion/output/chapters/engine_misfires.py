"""Section of the chapter on engines: every cylinder without heat in turn, and the stress of the crankshaft."""

from collections.abc import Iterator

import numpy as np

from torsion.analyses.engine.engine_results import EngineFound, MisfireFound
from torsion.analyses.response.amplitudes import Response
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, Table, table
from torsion.output.figures import engine_curves
from torsion.output.numbers import RPM, Scale, number, rpm, scale
from torsion.output.selection import Element, elements, worst

MOST_CURVES = 13  # in the figure, the first with every cylinder firing
N_PER_MM2 = 1e-6  # of 1 Pa


def misfires(findings: Findings, engine: EngineFound, place: int) -> Iterator[Block]:
    """Table by element with its worst cylinder, table by cylinder, and the curves of the most loaded element."""
    if not engine.misfires:
        return
    system = findings.need(Response).system
    each = [one for one in elements(system) if system.flexibility[one.spans[0]] > 0]
    if not each:
        return
    unit = scale("N m", [float(case.half_range.max()) for case in engine.misfires])
    yield Heading(f"Misfire of each cylinder of {engine.name}", 2)
    yield Paragraph(
        "One cylinder after the other is motored: it compresses, has no heat, and its masses go on; all others fire "
        "alike, with the heat that they had, and damping that follows the mean torque stays as it was. Half ranges of "
        "the synthesis of all orders, over the speeds requested and around every peak."
    )
    yield _by_element(engine, each, unit)
    yield _by_cylinder(engine, [one for one in each if one.kind == "crank"] or each, unit)
    if engine.stress_modulus is not None:
        yield _stress(engine, [one for one in each if one.kind == "crank"], engine.stress_modulus)
    speed = engine.misfires[0].speed * RPM
    for drawn, element in enumerate(_drawn(engine, each)):
        curves = [(_named(case), element.largest(case.half_range) * unit.factor) for case in engine.misfires]
        caption = f"Vibratory torque in {element.name} while a cylinder of {engine.name} misfires"
        name = f"engine-{place + 1}-misfires-{drawn + 1}"
        yield engine_curves.misfires(name, caption, speed, curves[:MOST_CURVES], unit.unit)


def _drawn(engine: EngineFound, each: list[Element]) -> list[Element]:
    """The most loaded element, and that in which a misfire raises the torque most."""
    normal = {one: float(one.largest(engine.misfires[0].half_range).max()) for one in each}
    worst_of = {one: float(one.largest(_worst(engine, one).half_range).max()) for one in each}
    raised = max(each, key=lambda one: worst_of[one] / normal[one] if normal[one] else 0.0)
    return list(dict.fromkeys([max(each, key=lambda one: worst_of[one]), raised]))


def _named(case: MisfireFound) -> str:
    return f"cylinder {case.cylinder}" if case.cylinder else "all fire"


def _worst(engine: EngineFound, element: Element) -> MisfireFound:
    """Of the cases with a misfire that with the largest half range in an element."""
    return max(engine.misfires[1:], key=lambda case: float(element.largest(case.half_range).max()))


def _by_element(engine: EngineFound, each: list[Element], unit: Scale) -> Table:
    rows = []
    for element in each:
        normal, bad = engine.misfires[0], _worst(engine, element)
        curve, least = (element.largest(case.half_range) for case in (bad, normal))
        largest = float(least.max())
        share = number(float(curve.max()) / largest, 4) if largest else "–"
        rows.append((
            element.name, element.kind, *worst(least, normal.speed, unit), *worst(curve, bad.speed, unit),
            f"no. {bad.cylinder}", share,
        ))  # fmt: skip
    return table(
        f"< Element -> | < Kind | All fire [{unit.unit}] -> all fire, {unit.unit} | At speed [rpm] | "
        f"Worst misfire [{unit.unit}] -> worst misfire, {unit.unit} | At its speed [rpm] -> at rpm | < Cylinder -> | "
        "Worst / all fire",
        rows, f"Misfire of one cylinder of {engine.name}: largest half range of every element",
        short=f"One cylinder of {engine.name} without heat",
    )  # fmt: skip


def _by_cylinder(engine: EngineFound, each: list[Element], unit: Scale) -> Table:
    rows = []
    for case in engine.misfires:
        most = max(each, key=lambda one, case=case: float(one.largest(case.half_range).max()))  # type: ignore[misc]
        curve = most.largest(case.half_range)
        rows.append((_named(case), most.name, *worst(curve, case.speed, unit)))
    where = "crank spans" if each[0].kind == "crank" else "elements"
    return table(
        f"< Case | < Element | Largest half range [{unit.unit}] | At speed [rpm]", rows,
        f"Misfire by cylinder of {engine.name}: the most loaded of the {where}",
    )  # fmt: skip


def _stress(engine: EngineFound, each: list[Element], modulus: float) -> Table:
    rows = []
    for element in each:
        normal, bad = engine.misfires[0], _worst(engine, element)
        sizes = [float(element.largest(case.half_range).max()) / modulus * N_PER_MM2 for case in (normal, bad)]
        at = int(np.argmax(element.largest(bad.half_range)))
        rows.append((element.name, *sizes, rpm(float(bad.speed[at])), f"no. {bad.cylinder}"))
    return table(
        "< Crank span | All fire [N/mm²] | Worst misfire [N/mm²] | At speed [rpm] | < Cylinder", rows,
        f"Nominal shear stress of the crankshaft of {engine.name}: half range / least W_{{p}} of journal and pin",
    )  # fmt: skip
