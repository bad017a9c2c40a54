"""An engine train of twenty stations in twelve cases beside one: `python -m benchmarks.twelve_cases`.

It writes reports/twelve_cases.md in a minute.
"""

import statistics
from collections.abc import Callable
from functools import partial
from time import process_time

import torsion
from benchmarks.page_file import Report, verdict
from torsion.findings import Findings
from torsion.output.document import document
from torsion.output.html import html

TIMES, BYTES = 4.0, 2_000_000  # of one case, of the page
ONE = """name: Six cylinders, gearbox and propeller
operation:
  at: engine
  speeds: {from: 600 rpm, to: 1900 rpm, steps: 66}
  rated: {speed: 1800 rpm, power: 300 kW}
  load: propeller
materials:
  steel: {shear_modulus: 79.3 GPa, youngs_modulus: 206 GPa, density: 7850, tensile_strength: 600 MPa}
train:
- damper: {name: damper, housing: 0.12, ring: 0.35, damping: 60 N*m*s/rad}
- coupling: {name: damper flange, stiffness: 1.2 MN*m/rad}
- engine:
    name: engine
    cylinders: 6
    strokes: 4
    firing_order: [1, 5, 3, 6, 2, 4]
    crank_inertia: 0.08
    stiffness: 1.1 MN*m/rad
    damping: 2 N*m*s/rad
    loss_factor: 3.5 %
    geometry: {bore: 115 mm, stroke: 137 mm, rod_length: 207 mm}
    masses: {piston: 2.0 kg, rod: {mass: 2.6 kg, centre: 70 mm, inertia: 0.02}}
    gas:
      {cycle: wiebe, compression_ratio: 16, charge: 3 bar, exhaust: 2.5 bar, imep: 19 bar, p_max: 150 bar,
       duration: 60 deg}
- coupling: {name: flywheel flange, stiffness: 2.5 MN*m/rad}
- disc: {name: flywheel, inertia: 1.8}
- coupling:
    name: rubber
    stiffness: 20 kN*m/rad
    psi: 1.0
    tolerance: 15 %
    inertia: [0.3, 0.15]
    rated_torque: 2.5 kN*m
    vibratory_torque: 0.9 kN*m
    max_torque: 7 kN*m
- shaft: {name: input shaft, length: 0.6 m, diameter: 70 mm, material: steel, segments: 1}
- gear: {name: gearbox, ratio: 2.5, inertia: [0.08, 0.9]}
- shaft: {name: intermediate shaft, length: 2.4 m, diameter: 95 mm, role: intermediate, material: steel, segments: 3}
- coupling: {name: flange, stiffness: 30 MN*m/rad, inertia: [0.1, 0.1]}
- shaft: {name: propeller shaft, length: 3.0 m, diameter: 100 mm, role: propeller, material: steel, segments: 4}
- propeller:
    name: propeller
    inertia: 7
    entrained: 25 %
    blades: 4
    damping: {model: archer, factor: 28}
    excitation: [{blade_order: 1, torque: 5 %}]
rules: [iacs-m68, coupling-maker]
"""
TWELVE = (
    ONE
    + """cases:
  from: tolerances
  warm: {set: {rubber.stiffness: 16 kN*m/rad, rubber.psi: 0.8}}
  misfire of 1: {set: {engine.misfire: 1}}
  misfire of 4: {set: {engine.misfire: 4}}
  misfire of 6: {set: {engine.misfire: 6}}
  warm with misfire: {set: {engine.misfire: 6}, based_on: warm}
  damper seized: {set: {damper.damping: 1e6}, judged: false}
  aged damper: {scale: {damper.damping: 0.6}}
  part load: {set: {engine.gas.imep: 12 bar, engine.gas.p_max: 130 bar}}
  zero pitch: {set: {propeller.entrained: 10 %}}
"""
)
WHAT = """\
Twenty stations: damper, flange, six cylinders with a closed Wiebe cycle, flywheel, rubber coupling, gearbox, shafts and
propeller; 66 speeds and the peaks between them, two rule sets. Twelve cases: as it stands, soft and stiff by the
tolerance of the coupling, warm, misfires, a worn and a seized damper, part load, zero pitch. Time: processor time of
`torsion.run` and of the page, median of runs in turn."""


def main() -> None:
    """Measures, prints the page and writes it."""
    report = Report(__doc__, "twelve_cases", calls=5)
    texts = {"one case": ONE, "twelve cases": TWELVE}
    studies = {name: torsion.parse(text) for name, text in texts.items()}
    found = {name: torsion.run(study) for name, study in studies.items()}
    pages = {name: page(one) for name, one in found.items()}
    solve = {name: partial(torsion.run, study) for name, study in studies.items()}
    write = {name: partial(page, one) for name, one in found.items()}
    seconds = in_turn(solve, report.chosen.calls), in_turn(write, report.chosen.calls)
    rows = [
        f"| {name} | {len(found[name].each)} | {len(found[name].system.stations)} | {seconds[0][name]:.3f} | "
        f"{seconds[1][name]:.3f} | {len(pages[name].encode()) / 1e6:.3f} |"
        for name in texts
    ]
    ratio, written = (one["twelve cases"] / one["one case"] for one in seconds)
    size = len(pages["twelve cases"].encode())
    head = "| | cases | stations | solve, s | report, s | page, MB |\n|---|---|---|---|---|---|"
    lines = (
        f"- twelve cases take {ratio:.2f} times the time of one, meant <= {TIMES:g}: {verdict(ratio <= TIMES)}",
        f"- their page is written in {written:.2f} times the time of that of one",
        f"- the page weighs {size / 1e6:.3f} MB, meant < {BYTES / 1e6:g}: {verdict(size < BYTES)}",
    )
    report.publish("Twelve cases beside one", [WHAT, "\n".join([head, *rows]), "\n".join(lines)])


def page(found: Findings) -> str:
    """The report in HTML."""
    return html(document(found))


def in_turn(calls: dict[str, Callable[[], object]], times: int) -> dict[str, float]:
    """s of processor time of each, median of so many calls."""
    tries = dict[str, list[float]]()
    for _ in range(times):
        for name, call in calls.items():
            start = process_time()
            call()
            tries.setdefault(name, []).append(process_time() - start)
    return {name: statistics.median(each) for name, each in tries.items()}


if __name__ == "__main__":
    main()
