"""Chapter: shear stress in the stated fillets and notches of shafts, with K_t and its error."""

from collections.abc import Iterator

from torsion.analyses.response.fillet_stresses import Fillet, Fillets
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, table
from torsion.output.numbers import NONE, number, rpm

TEXT = (
    "K_{t} is the maximum shear stress in the fillet over the nominal stress T/W_{p} of the smaller end, for "
    "a shoulder between two long shafts (finite elements of axisymmetric torsion). The column Peterson gives "
    "the fit of chart 3.12 (Pilkey 1997, edition not confirmed) for solid shafts and 0.25 ≤ shoulder height /"
    " radius ≤ 4. The peak stress is K_{t} times the total nominal stress amplitude at its worst speed. Class"
    " limits apply to nominal stresses and include their own factors. Corners without a stated radius, the "
    "second corner of a flange or undercut, corners between different bores and hub mouths are not included. "
    "A short shaft between two larger shafts is computed with both shoulders. At a larger shaft with a thin "
    "wall the peak is at least its nominal stress."
)
NOTCHES = (
    "Keyways and splines: K_{t} of the section over T/W_{p} of the plain shaft, by plane finite elements. The"
    " pressure of the key and the ends of the groove are not included. For a keyway of width d/4 and depth "
    "d/8 the column Peterson gives the fit of chart 5.2 (edition not confirmed), 2 % (radius d/100) to 7 % "
    "(0.07 d) above the finite elements; their error is below 1e-3. Radial oil holes: the formula of IACS UR "
    "M53 for the maximum normal stress, over √3. The nominal stress is at the end of the shaft with the "
    "highest notch stress."
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
            one.shaft,
            one.words,
            number(1e3 * one.radius, 4),
            number(1e3 * one.diameter, 5),
            NONE if one.larger is None else number(1e3 * one.larger, 5),
            number(one.factor, 4),
            NONE if one.error is None else number(100.0 * one.error, 2),
            NONE if one.peterson is None else number(one.peterson, 4),
            *_under_load(one),
        )
        for one in found
    ]
    yield table(
        "< Shaft | < Detail | Radius [mm] | d [mm] | D [mm] | K_{t} | Error of K_{t} [%] | Peterson | "
        "Nominal [N/mm²] | Peak [N/mm²] | Speed [rpm] | Endurance limit [N/mm²] -> endurance | Utilisation [%]",
        rows,
        "Shear stress in fillets and notches",
        marks=[
            "fail" if one.utilisation is not None and one.utilisation > 1.0 else "" for one in found
        ],
    )


def _under_load(one: Fillet) -> tuple[str, ...]:
    values = (one.nominal, one.peak)
    stress = (NONE if value is None else number(1e-6 * value, 4) for value in values)
    speed = NONE if one.speed is None else rpm(one.speed)
    endures = NONE if one.endurance is None else number(1e-6 * one.endurance, 4)
    return (
        *stress,
        speed,
        endures,
        NONE if one.utilisation is None else number(100.0 * one.utilisation, 4),
    )
