"""An engine train of twenty stations in twelve cases next to one: `python -m benchmarks.twelve_cases`.

It writes reports/twelve_cases.md in two minutes.
"""

import resource
import statistics
import subprocess
import sys
from itertools import pairwise
from pathlib import Path
from tempfile import TemporaryDirectory
from time import process_time

import torsion
from benchmarks.page_file import Report, verdict
from torsion.findings import Findings
from torsion.output.document import document
from torsion.output.pages.html import html

TIMES, BYTES = 7.0, 2_000_000  # of one case, of the page
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
propeller; 66 speeds and the peaks between them, two rule sets. Twelve cases: nominal, soft and stiff by the
tolerance of the coupling, warm, misfires, a worn and a seized damper, part load, zero pitch; seven trains differ in
more than their excitation. The command is `torsion solve` in a fresh process with all that it writes: the page over
all cases, that of every case, results.json and series.npz. Next to it, in one process, reading, `torsion.run` and the
page over all cases. Processor time, medians of runs in turn. The superposed misfires of the nominal case are found
with the page, which alone reads them. Every case has a response and a total of its own, at its own speeds: their
results are those of a file of its own, bit for bit."""


def main() -> None:
    """Measures, prints the page and writes it."""
    report = Report(__doc__, "twelve_cases", calls=5)
    texts = {"one case": ONE, "twelve cases": TWELVE}
    each = {name: measured(text) for name, text in texts.items()}  # imports all there is to import
    tries = [
        {name: measured(text) for name, text in texts.items()} for _ in range(report.chosen.calls)
    ]
    commands = [
        {name: of_command(text) for name, text in texts.items()} for _ in range(report.chosen.calls)
    ]
    median = {
        name: [
            statistics.median(one[name][0][part] for one in tries)
            for part in range(len(each[name][0]))
        ]
        for name in texts
    }
    rows = [
        f"| {name} | {len(found.each)} | {len(found.system.stations)} | "
        f"{' | '.join(f'{seconds:.3f}' for seconds in (*median[name], sum(median[name])))} | {size / 1e6:.3f} |"
        for name, (_, found, size) in each.items()
    ]
    read, solved, written = (median["twelve cases"][k] / median["one case"][k] for k in range(3))
    ratio = sum(median["twelve cases"]) / sum(median["one case"])
    size = each["twelve cases"][2]
    head = "| | cases | stations | read, s | solve, s | page, s | all, s | page, MB |\n|---|---|---|---|---|---|---|---|"
    command = {name: statistics.median(one[name] for one in commands) for name in texts}
    of_all = command["twelve cases"] / command["one case"]
    what = f"the command takes {command['one case']:.2f} s for one case, {command['twelve cases']:.2f} s for twelve"
    lines = (
        f"- {what}, {of_all:.2f} times as long, meant <= {TIMES:g}: {verdict(of_all <= TIMES)}",
        f"- in one process, reading, solving and the page over all cases take {ratio:.2f} times as long",
        f"- to read them takes {read:.2f} times, to solve them {solved:.2f}, to write their page {written:.2f} times",
        f"- the page weighs {size / 1e6:.3f} MB, meant < {BYTES / 1e6:g}: {verdict(size < BYTES)}",
    )
    report.publish("Twelve cases next to one", [WHAT, "\n".join([head, *rows]), "\n".join(lines)])


def measured(text: str) -> tuple[list[float], Findings, int]:
    """s of processor time to read, solve and report a file; what was found; bytes of the page."""
    times = [process_time()]
    study = torsion.parse(text)
    times.append(process_time())
    found = torsion.run(study)
    times.append(process_time())
    size = len(html(document(found)).encode())
    times.append(process_time())
    return [end - start for start, end in pairwise(times)], found, size


def of_command(text: str) -> float:
    """s of processor time of `torsion solve` in a process of its own, with all files that it writes."""
    with TemporaryDirectory() as folder:
        file = Path(folder) / "train.yaml"
        file.write_text(text, encoding="utf-8")
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        command = [
            sys.executable,
            "-m",
            "torsion",
            "solve",
            str(file),
            "-o",
            str(Path(folder) / "report"),
        ]
        subprocess.run(command, check=False, stdout=subprocess.DEVNULL)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


if __name__ == "__main__":
    main()
