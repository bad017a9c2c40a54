"""Steps and fillets of round shafts by finite elements: `python -m benchmarks.steps` writes reports/steps.md.

Error against run time of a junction, its excess length next to the handbook's, stress in fillets next to the classical
fits, and a line of eight sections next to an axisymmetric model of the whole. Takes half a minute.
"""

import math
from collections.abc import Iterator
from time import process_time

import numpy as np

from benchmarks import steps_line
from benchmarks.junction_table import errors_between
from benchmarks.page_file import Report
from torsion.analyses.response.fillet_stresses import keyway_fit, peterson
from torsion.assembly.junction.axisymmetric import fillet_stress, solved
from torsion.assembly.junction.hubs import bonded
from torsion.assembly.junction.profile import Corner, Length, Profile, junction
from torsion.assembly.section.grooved_sections import keyway, on_mesh
from torsion.kernels.junction_table import HIGHEST, LOWEST, SIZES, junction_table

HANDBOOK = {
    1.0: 0.0,
    1.25: 0.055,
    1.5: 0.085,
    2.0: 0.100,
    3.0: 0.107,
    math.inf: 0.125,
}  # from memory
SHARP = (1.0, 1.1, 1.25, 1.5, 2.0, 3.0, 6.0, 20.0)
SHIGLEY = {2.0: (0.863, -0.239), 1.2: (0.834, -0.216)}  # K_t = A (r/d)^b, from memory
STEPS = {
    "sharp, D/d 2": junction((1.0, 0.0), (2.0, 0.0)),
    "fillet r/d 0.05, D/d 1.5": junction((1.0, 0.0), (1.5, 0.0), Corner("fillet", 0.05)),
    "chamfer 0.1 d, bore 0.5 d, D/d 2": junction((1.0, 0.5), (2.0, 0.5), Corner("chamfer", 0.1)),
    "undercut 0.03 d by 0.08 d, r 0.02 d, D/d 2": junction(
        (1.0, 0.0), (2.0, 0.0), Corner("fillet", 0.02), between=(Length(0.08, (0.94, 0.94)),)
    ),
    "flange 2.2 d by 0.3 d, r 0.08 d, D/d 1": junction(
        (1.0, 0.0), (1.0, 0.0), Corner("fillet", 0.08), between=(Length(0.3, (2.2, 2.2)),)
    ),
}
WHAT = """\
The excess length of a junction is the length of the smaller shaft, in units of its diameter, whose twist the junction
has beyond that of both shafts each as if it were long. Bounds are those of energy and of complementary energy on one
mesh; coefficients are to be verified."""

STRESS = """\
K_t is the largest shear stress in the fillet over 16 T/(pi d^3). Fits: Peterson's (Pilkey 1997, chart 3.12, for
0.25 <= h/r <= 4) and A (r/d)^b (Shigley, to be verified); both read charts of electrical analogues, to be verified.
They lie above the elements by up to 3.2 % and 7.5 %, and the second below them where fillets are large. The meshes here
are divided until the two fields, and two meshes one after another, agree to 1e-4: the 3.2 % are not those of the
elements. """
KEYWAY = """\
A keyway d/4 wide with flanks of d/8. The fit is that of Peterson's chart 5.2 (to be verified), of
photoelastic tests. The meshes do not explain its difference: they converge from left to right, on a round groove the
same code is within 7e-6 of Weber's closed form, and charges in the groove (no mesh) agree within 3e-4 up to r/d 1/48.
"""
HUB = """\
Length of shaft that twists as its seat in a hub of its material, in diameters: bonded, the torque leaving the hub over
its rim or its face; the handbook's third (key) is that of a torque handed over evenly.
"""
FINE = 1e-4  # relative error of K_t on this page
LINES = (
    ("sharp", 0.0, 1.0),
    ("fillets of 5 mm", 0.005, 1.0),
    ("sharp, 2/3 as long", 0.0, 2.0 / 3.0),
)  # m; 1
LINE = """\
First five frequencies of a free line of diameters 100, 120, 200, 140, 280, 160, 120, 100 mm: relative error of shafts
one after another in the exact model, against an axisymmetric model of the whole with consistent inertia (elements of
degree 4; a mesh ten times finer in its bounds changes them by less than 1e-7). With junctions (the steps of the file,
springs with the inertia of fillets) the motion of the junction itself is left, which grows with the square of the
frequency: above 1e-4 where a wave is shorter than about five of the largest diameters.
"""


def main() -> None:
    """Computes, prints the page and writes it."""
    report = Report(__doc__, "steps")
    parts = [WHAT]
    for title, lines in (
        ("Error against run time", _times()),
        ("Excess length next to the handbook's", _handbook()),
        ("The table", _table()),
        ("Stress in a fillet", _stress()),
        ("Stress in a keyway", _keyway()),
        ("A shaft in a hub", _hub()),
        ("A line of eight sections", _line()),
    ):
        parts += [f"## {title}", "\n".join(lines)]
    report.publish("Steps and fillets of round shafts", parts)


def _times() -> Iterator[str]:
    yield "| junction | largest half gap | triangles | excess length | half gap | time, ms |"
    yield "|---|---:|---:|---:|---:|---:|"
    for name, profile in STEPS.items():
        for fine in (1e-2, 1e-3, 1e-4, 1e-5, 1e-6):
            start = process_time()
            found = solved(profile, 2.0 * fine)
            spent = 1e3 * (process_time() - start)
            row = f"{found.levels[-1].triangles} | {found.excess_length:.7f} | {found.error:.1e} | {spent:.0f}"
            yield f"| {name} | {fine:.0e} | {row} |"


def _handbook() -> Iterator[str]:
    yield "Sharp corners, solid. The handbook's figures (to be verified) are low for large steps.\n"
    yield "| D/d | lower bound | upper bound | handbook | handbook / ours - 1 |"
    yield "|---:|---:|---:|---:|---:|"
    for larger in SHARP:
        found, known = solved(junction((1.0, 0.0), (larger, 0.0)), 4e-7), HANDBOOK.get(larger)
        if larger == SHARP[-1]:
            known = HANDBOOK[math.inf]
        off = f"{100 * (known / found.excess_length - 1):+.0f} %" if known else ""
        low, high = (f"{abs(one) if larger == 1.0 else one:.7f}" for one in found.excess)
        yield f"| {larger:g} | {low} | {high} | {'' if known is None else f'{known:g}'} | {off} |"
    yield f"\nThe last handbook figure is its limit for a very large step, next to D/d {SHARP[-1]:g}."


def _table() -> Iterator[str]:
    table, errors = junction_table(), errors_between(junction_table(), 200, seed=11)
    low, high = LOWEST, HIGHEST
    reach = f"bore/d {low[0]:g} to {high[0]:g}, step {low[1]:g} to {high[1]:g} d, fillets up to its height"
    yield f"- {math.prod(SIZES)} values: {reach}"
    yield f"- error that it states: {table.error:.1e} of a diameter"
    worst = f"largest {max(errors):.1e}, median {np.median(errors):.1e}"
    yield f"- against the elements at 200 places drawn afresh: {worst}"


def _stress() -> Iterator[str]:
    yield STRESS
    yield "| D/d | r/d | K_t | its error | Peterson | difference | A (r/d)^b | difference |"
    yield "|---:|---:|---:|---:|---:|---:|---:|---:|"
    for larger, (factor, power) in SHIGLEY.items():
        for radius in (0.02, 0.03, 0.05, 0.1, 0.15, 0.2, 0.3):
            found = fillet_stress(
                junction((1.0, 0.0), (larger, 0.0), Corner("fillet", radius)), FINE
            )
            cells = []
            for fit in (peterson((larger - 1.0) / 2.0, radius), factor * radius**power):
                cells += (
                    ["", ""]
                    if fit is None
                    else [f"{fit:.3f}", f"{100 * (fit / found.factor - 1):+.1f} %"]
                )
            yield f"| {larger:g} | {radius:g} | {found.factor:.4f} | {found.error:.0e} | {' | '.join(cells)} |"


def _keyway() -> Iterator[str]:
    yield KEYWAY
    yield "| r/d | K_t, first mesh | sides halved | once more | fields apart | Peterson | difference |"
    yield "|---:|---:|---:|---:|---:|---:|---:|"
    depth = 0.25 + 1.0 - math.sqrt(1.0 - 0.25**2)
    for radius in (0.01, 1.0 / 48.0, 0.03, 0.05, 0.07):
        found, fit = (
            [on_mesh(keyway(0.5, depth, 2.0 * radius), divided) for divided in (1, 2, 4)],
            keyway_fit(radius),
        )
        cells = " | ".join(f"{one.factor:.5f}" for one in found)
        off = f"{100 * (fit / found[-1].factor - 1):+.1f} %"
        yield f"| {radius:.4f} | {cells} | {found[-1].error:.0e} | {fit:.3f} | {off} |"


def _hub() -> Iterator[str]:
    yield HUB
    yield "| seat / d | hub / d | bonded, rim | bonded, face | error | handbook's third |"
    yield "|---:|---:|---:|---:|---:|---:|"
    for length in (0.5, 1.0, 1.5):
        for hub in (1.4, 1.6, 2.0):
            (rim, error), (face, other) = (
                bonded(length, hub, 0.0, torque) for torque in ("rim", "face")
            )
            yield f"| {length:g} | {hub:g} | {rim:.4f} | {face:.4f} | {max(error, other):.0e} | {length / 3.0:.4f} |"


def _line() -> Iterator[str]:
    yield LINE
    yield "| line | junctions | " + " | ".join(f"mode {mode}" for mode in range(1, 6)) + " |"
    yield "|---|---|---:|---:|---:|---:|---:|"
    for name, fillet, scale in LINES:
        whole: Profile = steps_line.line(fillet, scale)
        reference = steps_line.axisymmetric(whole)
        for word, junctions in (("with", True), ("without", False)):
            found = steps_line.one_dimensional(junctions=junctions, fillet=fillet, scale=scale)
            yield (
                f"| {name} | {word} | "
                + " | ".join(f"{one:+.1e}" for one in found / reference - 1.0)
                + " |"
            )


if __name__ == "__main__":
    main()
