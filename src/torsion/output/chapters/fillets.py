"""Chapter: shear stress in the stated fillets and notches of shafts, with K_t and its error."""

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
    "those of nominal stresses with factors of their own; no K_{t} enters them. Corners of no stated radius, "
    "among them the other corner of a flange or undercut and that between unlike bores, and the mouths of hubs are not "
    "in it. A short shaft between two larger ones is computed with both of its steps. Beside a larger shaft of thin "
    "wall K_{t} is so large that the peak is at least the nominal stress of that."
)
NOTCHES = (
    "Keyways and splines: K_{t} of the section alone, by plane finite elements, over T/W_{p} of the plain shaft; no "
    "key presses on the flanks, and what the ends of the groove add is not in it. Beside a keyway d/4 wide with flanks "
    "of d/8 stands the fit of Peterson's chart 5.2 (from memory, to be verified), which lies 2 % "
    "(radius d/100) to 7 % (0.07 d) above the elements; those hold within 1e-3. Radial oil holes: the formula of IACS "
    "UR M53 for the largest normal stress, over √3: the shear of equal distortion energy. The nominal stress is "
    "that at the end of the shaft where the notch stresses it most."
)


def chapter(findings: Findings) -> Iterator[Block]:
    """Nothing without a fillet."""
    found = findings.need(Fillets).each
    yield Heading("Stress in fillets")
    yield Paragraph(TEXT)
    if any(one.following is None for one in found):
        yield Paragraph(NOTCHES)
    rows = [
        (
            one.shaft, one.words, number(1e3 * one.radius, 4), number(1e3 * one.diameter, 5),
            NONE if one.larger is None else number(1e3 * one.larger, 5), number(one.factor, 4),
            NONE if one.error is None else number(100.0 * one.error, 2),
            NONE if one.peterson is None else number(one.peterson, 4), *_under_load(one),
        )
        for one in found
    ]  # fmt: skip
    yield table(
        "< Shaft | < Detail | Radius [mm] | d [mm] | D [mm] | K_{t} | Error of K_{t} [%] | Peterson | "
        "Nominal [N/mm²] | Peak [N/mm²] | At speed [rpm] | Endurance limit [N/mm²] -> endurance | Utilisation [%]",
        rows,
        "Shear stress in fillets and notches",
        marks=["fail" if one.utilisation is not None and one.utilisation > 1.0 else "" for one in found],
    )


def _under_load(one: Fillet) -> tuple[str, ...]:
    values = (one.nominal, one.peak)
    stress = (NONE if value is None else number(1e-6 * value, 4) for value in values)
    speed = NONE if one.speed is None else rpm(one.speed)
    endures = NONE if one.endurance is None else number(1e-6 * one.endurance, 4)
    return *stress, speed, endures, NONE if one.utilisation is None else number(100.0 * one.utilisation, 4)
