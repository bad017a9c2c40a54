"""Chapter: shear stress in the stated fillets between shafts, with K_t and its error."""

from collections.abc import Iterator

from torsion.analyses.fillet_stresses import Fillet, Fillets
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, table
from torsion.output.numbers import NONE, number, rpm

TEXT = (
    "K_{t} is the largest shear stress in the fillet over the nominal one of the smaller end, T/W_{p}, of a step "
    "between two long shafts, by finite elements of axisymmetric torsion; beside it the fit of Peterson's chart 3.12 "
    "(Pilkey 1997, to be verified), which holds for solid shafts and 0.25 ≤ step height / radius ≤ 4. Peak stress: "
    "K_{t} times the nominal vibratory stress, half range of all orders, at its worst speed. Limits of class rules are "
    "those of nominal stresses with factors of their own; no K_{t} enters them."
)


def chapter(findings: Findings) -> Iterator[Block]:
    """Nothing without a fillet."""
    found = findings.need(Fillets).each
    yield Heading("Stress in fillets")
    yield Paragraph(TEXT)
    rows = [
        (
            one.shaft, one.following, number(1e3 * one.radius, 4), number(1e3 * one.diameter, 5),
            number(1e3 * one.larger, 5), number(one.factor, 4), number(100.0 * one.error, 2),
            NONE if one.peterson is None else number(one.peterson, 4), *_under_load(one),
        )
        for one in found
    ]  # fmt: skip
    yield table(
        "< Shaft | < To | Radius [mm] | d [mm] | D [mm] | K_{t} | Error of K_{t} [%] | Peterson | "
        "Nominal [N/mm²] | Peak [N/mm²] | At speed [rpm] | Endures [N/mm²] | Used",
        rows,
        "Shear stress in the fillets",
        marks=["fail" if one.utilisation is not None and one.utilisation > 1.0 else "" for one in found],
    )


def _under_load(one: Fillet) -> tuple[str, ...]:
    values = (one.nominal, one.peak)
    stress = (NONE if value is None else number(1e-6 * value, 4) for value in values)
    speed = NONE if one.speed is None else rpm(one.speed)
    endures = NONE if one.endurance is None else number(1e-6 * one.endurance, 4)
    return *stress, speed, endures, NONE if one.utilisation is None else number(one.utilisation, 4)
