"""Section of the chapter on engines: misfire of every cylinder in turn."""

from collections.abc import Iterator

from torsion.analyses.engine.engine_results import EngineFound, MisfireFound
from torsion.analyses.response.amplitudes import Response
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, Table, table
from torsion.output.figures import engine_curves
from torsion.output.numbers import NONE, RPM, Scale, number, scale
from torsion.output.selection import Element, elements, worst

MOST_CURVES = 13  # in the figure, the first with every cylinder firing
N_PER_MM2 = 1e-6  # of 1 Pa


def misfires(findings: Findings, engine: EngineFound, place: int) -> Iterator[Block]:
    """The worst cylinder for every element, and the curves of the most loaded element."""
    if not engine.misfires:
        return
    system = findings.need(Response).system
    each = [one for one in elements(system) if system.flexibility[one.spans[0]] > 0]
    if not each:
        return
    unit = scale("N m", [float(case.half_range.max()) for case in engine.misfires])
    yield Heading(f"Misfire of each cylinder of {engine.name}", 2)
    yield Paragraph(
        "Each cylinder is motored in turn: it compresses without combustion, and its masses keep moving. The other "
        "cylinders keep their gas torque. Damping that depends on the mean torque is unchanged."
    )
    yield _by_element(engine, each, unit)
    speed = engine.misfires[0].speed * RPM
    for drawn, element in enumerate(_drawn(engine, each)):
        curves = [
            (_named(case), element.largest(case.half_range) * unit.factor)
            for case in engine.misfires
        ]
        caption = (
            f"Vibratory torque in {element.name} with misfire of one cylinder of {engine.name}"
        )
        name = f"engine-{place + 1}-misfires-{drawn + 1}"
        yield engine_curves.misfires(name, caption, speed, curves[:MOST_CURVES], unit.unit)


def _drawn(engine: EngineFound, each: list[Element]) -> list[Element]:
    """The most loaded element, and the element with the largest increase by a misfire."""
    normal = {one: float(one.largest(engine.misfires[0].half_range).max()) for one in each}
    worst_of = {one: float(one.largest(_worst(engine, one).half_range).max()) for one in each}
    raised = max(each, key=lambda one: worst_of[one] / normal[one] if normal[one] else 0.0)
    return list(dict.fromkeys([max(each, key=lambda one: worst_of[one]), raised]))


def _named(case: MisfireFound) -> str:
    return f"cylinder {case.cylinder}" if case.cylinder else "all firing"


def _worst(engine: EngineFound, element: Element) -> MisfireFound:
    """Return the misfire with the largest torque in an element."""
    return max(engine.misfires[1:], key=lambda case: float(element.largest(case.half_range).max()))


def _by_element(engine: EngineFound, each: list[Element], unit: Scale) -> Table:
    """Return the worst misfire of every element, with the nominal stress of crank spans."""
    has_stress = engine.stress_modulus is not None and any(
        element.kind == "crank" for element in each
    )
    rows = []
    for element in each:
        normal, bad = engine.misfires[0], _worst(engine, element)
        torque, normal_torque = (element.largest(case.half_range) for case in (bad, normal))
        maximum = float(normal_torque.max())
        ratio = number(float(torque.max()) / maximum, 4) if maximum else NONE
        stress = []
        if has_stress:
            modulus = engine.stress_modulus if element.kind == "crank" else None
            stress = [
                NONE if modulus is None else number(float(torque.max()) / modulus * N_PER_MM2)
            ]
        rows.append(
            (
                element.name,
                *worst(normal_torque, normal.speed, unit),
                *worst(torque, bad.speed, unit),
                f"no. {bad.cylinder}",
                ratio,
                *stress,
            )
        )
    return table(
        f"< Component -> | All firing [{unit.unit}] -> all firing, {unit.unit} | Speed [rpm] | "
        f"Worst misfire [{unit.unit}] -> worst misfire, {unit.unit} | Speed [rpm] -> rpm | < Cylinder -> | "
        "Ratio" + " | Nominal stress, worst misfire [N/mm²]" * has_stress,
        rows,
        f"Misfire of one cylinder of {engine.name}: maximum total vibratory torque of every component",
        short=f"Misfire of one cylinder of {engine.name}",
    )
