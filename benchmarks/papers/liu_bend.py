"""The page of section 3 of Liu et al. (2023): torsion with two joints, and bearings bent by their couples."""

from collections.abc import Iterator
from functools import cache

import numpy as np

from benchmarks.papers import liu_bend_model as model
from benchmarks.papers import liu_bend_space as space
from benchmarks.papers.drawing import Panel, curves
from benchmarks.papers.liu_bend_model import Array, Boat
from benchmarks.papers.pump_lumped import modes_of
from benchmarks.papers.scenes import solved
from benchmarks.papers.writing import Misprint, Page, Picture, bound, stated

NAME = "liu_2023_section_3"
SOFT = 0.5  # stiffness of the softer shafts / that of the stiff ones
LAST, SAMPLES = 1.0, 2048  # s, samples: 1 Hz apart, up to 1024 Hz
SHOWN = 0.4  # s of the histories
HIGHEST = 500  # Hz of the spectra
CURVE = 1e-6  # relative tolerance of curves to look at
STIFF = Boat()
LINES = {"stiff shafts": STIFF, "softer shafts": STIFF.softer(SOFT)}


def page() -> Page:
    """Everything the page says."""
    return Page(
        name=NAME,
        title="Liu et al. 2023, section 3: torsion and bending of a line with two universal joints",
        reference="Liu et al., *Ship Science and Technology* 45(2), 2023, from page 80.",
        what="The paper sets up six inertias on three shafts, two joints between them and bearings that the joints' "
        "couples push sideways, integrates in time and shows histories and spectra (figures 9 and 10). As printed, "
        "(14) has more unknowns than equations; here it is closed and solved. **Its table of data is missing: every "
        "inertia, stiffness, damping and span below is our estimate**, only joint angle (8°), torque (800 N m) and "
        "speed (60 rad/s) are the paper's.",
        notation="`theta1` .. `theta6` angles of motor, four yokes, propeller, `G2` .. `G5` torques at the joints, "
        "`f1`, `f2` maps and `i1`, `i2` ratios of the joints, `y`, `z` displacement of a bearing along the normal of "
        "the plane of the shafts and square to it. The shafts start without twist at 60 rad/s, and the motor's torque "
        "comes on at once; the propeller takes 800 N m (speed/60 rad/s)². Softer shafts: half the stiffness.",
        numbers=(*_data(), *_found()),
        checks=_checks(),
        pictures=(_histories(), _spectra()),
        misprints=_misprints(),
        missing=(
            (
                "Figures 9 and 10 in numbers, with the lines at 616.7 and 449.67 Hz: Table 1 and the data of the "
                "supports are missing. Their features come out: ringing at the natural frequencies that dies out, a "
                "lasting line at twice the speed in the bearings, all natural frequencies lower with softer shafts."
            ),
            "Which shafts the paper makes softer, and by how much, is not recorded: here all three.",
        ),
        computed_by=f"`shafting_specs/papers/{NAME}.yaml` and `benchmarks/papers/liu_bend_model.py`",
        tested_by="test_liu_bend.py",
    )


@cache
def run(name: str) -> Array:
    """(16, samples) of a line by its name."""
    return model.motion(LINES[name], LAST / SAMPLES * np.arange(SAMPLES), tolerance=CURVE)


def spectrum(values: Array) -> tuple[Array, Array]:
    """Frequencies, Hz, and amplitudes of a history without its mean, by Hann's window."""
    window = np.hanning(values.size + 1)[:-1]
    lines = np.fft.rfft((values - values.mean()) * window) / window.sum() * 2.0
    return np.arange(lines.size) / LAST, np.abs(lines)


def peak(values: Array, near: float, within: float = 2.0) -> tuple[float, float]:
    """Frequency and amplitude of the largest line near a frequency."""
    at, size = spectrum(values)
    inside = np.flatnonzero(np.abs(at - near) <= within)
    best = inside[size[inside].argmax()]
    return float(at[best]), float(size[best])


def twist(name: str) -> Array:
    """(samples,) rad of the intermediate shaft."""
    boat, states = LINES[name], run(name)
    return np.array([model.front(x, boat.angle)[0] for x in states[1]]) - states[2]


def _data() -> Iterator[tuple[str, ...]]:
    """What was estimated, first."""
    J, K, C = STIFF.inertia, STIFF.stiffness, STIFF.damping
    yield stated(
        "inertias 1 to 6 (estimate)", ", ".join(f"{one:g}" for one in J), "kg m²", "missing"
    )
    yield stated(
        "stiffnesses K1 to K3 (estimate)", ", ".join(f"{one:g}" for one in K), "N m/rad", "missing"
    )
    yield stated(
        "dampings C1 to C3 (estimate)", ", ".join(f"{one:g}" for one in C), "N m s/rad", "missing"
    )
    bearing = f"{STIFF.mass:g} kg, {STIFF.bearing_stiffness:g} N/m, {STIFF.bearing_damping:g} N s/m, {STIFF.span:g} m"
    yield stated("mass, K4, C4, span of the bearings (estimate)", bearing, "", "missing")


def _found() -> Iterator[tuple[str, ...]]:
    for name, boat in LINES.items():
        for rank, frequency in enumerate(model.frequencies(boat), start=1):
            line, _ = peak(run(name)[0] - run(name)[1], frequency)
            words = f"{frequency:.4f} Hz, line at {line:.0f} Hz"
            yield stated(
                f"natural frequency {rank}, {name}; line of the driving shaft's twist", words
            )
    twice = STIFF.speed / np.pi
    for name in LINES:
        size = f"{1e3 * np.abs(twist(name)).max():.1f}"
        yield stated(f"largest twist of the intermediate shaft, {name}", size, "mrad")
    for name in LINES:
        line, size = peak(run(name)[8], twice)
        words = f"{1e6 * size:.0f} µm at {line:.0f} Hz (2 × speed: {twice:.2f} Hz)"
        yield stated(f"front bearing, y at twice the speed, {name}", words)
    mean = STIFF.torque * np.tan(STIFF.angle) / (2.0 * STIFF.span)
    yield stated("front bearing, mean force T tan r/(2 span)", mean, "N", digits=6)
    y = run("stiff shafts")[8]
    late = np.average(y, weights=np.hanning(y.size)) * STIFF.bearing_stiffness
    yield stated("the same from the motion", late, "N", digits=4)


def _checks() -> str:
    """Balance in space, energy, another integrator, and the program's own modes."""
    worst, free = 0.0, model.free(STIFF)
    for state in np.moveaxis(run("stiff shafts")[:, ::97], 1, 0):
        moving = model.turning(STIFF, state)
        found, joints, _ = space.balance(STIFF, moving)
        worst = max(worst, np.abs(found - moving.acceleration).max() / np.abs(found).max())
        worst = max(worst, np.abs(joints - moving.joint).max() / np.abs(joints).max())
    start = twisted(free)
    states = model.motion(free, np.linspace(0.0, 0.06, 13), tolerance=1e-11, start=start).T
    energies = np.array([model.energy(free, state) for state in states])
    times = np.linspace(0.0, 0.02, 5)
    other = model.motion(STIFF, times, tolerance=1e-8, method="Radau")[:8]
    own = model.motion(STIFF, times, tolerance=1e-10)[:8]
    modes = modes_of(solved(NAME)).frequency
    return (
        "Accelerations and joint torques were compared with six bodies whose joints are pins in space, ten equations "
        f"with the joint torques as unknowns: within {bound(worst + 1.0, 1.0, '1e-10')} at states all along the "
        "motion. Without damping and torque, from shafts twisted by 10 mrad, energy stays within "
        f"{bound(energies, energies[0], '1e-10')} over more than half a revolution. Dormand and Prince's method "
        f"(order 8) and Radau IIA differ by {bound(other, own, '1e-6')} of the largest value. The natural "
        f"frequencies are those that the program finds in the model file, "
        f"within {bound(model.frequencies(STIFF), modes, '1e-12')}."
    )


def twisted(boat: Boat) -> Array:
    """`untwisted` with the motor and the propeller turned 10 mrad on."""
    start = model.untwisted(boat)
    start[0] += 0.01
    start[3] += 0.01
    return start


def _histories() -> Picture:
    number = int(SHOWN / LAST * SAMPLES)
    times = LAST / SAMPLES * np.arange(number)
    panels = [
        Panel("propeller, rad/s", [(name, run(name)[7, :number]) for name in LINES]),
        Panel("rear yoke, rad/s", [(name, run(name)[6, :number]) for name in LINES]),
        Panel("front bearing y, µm", [(name, 1e6 * run(name)[8, :number]) for name in LINES]),
        Panel("front bearing z, µm", [(name, 1e6 * run(name)[9, :number]) for name in LINES]),
    ]
    svg = curves("liu_2023_section_3_fig_9", times, "time, s", panels, height=1.5)
    words = (
        "Figure 9, in kind: the torque comes on at once, the shafts ring, the bearings settle on a motion at twice the "
        "speed about a displacement in y. The rear yoke (driving yoke of the rear joint) also turns unevenly by the "
        "joint itself."
    )
    return Picture("liu_2023_section_3_fig_9", words, svg)


def _spectra() -> Picture:
    at = spectrum(run("stiff shafts")[6])[0][: HIGHEST + 1]
    names = {6: "rear yoke, rad/s", 9: "front bearing z, µm"}
    panels = []
    for row, axis in names.items():
        scale = 1e6 if row >= 8 else 1.0
        found = {name: scale * spectrum(run(name)[row])[1][: HIGHEST + 1] for name in LINES}
        panels.append(
            Panel(f"log10 {axis}", [(name, np.log10(size)) for name, size in found.items()])
        )
    svg = curves("liu_2023_section_3_fig_10", at, "frequency, Hz", panels, height=2.2)
    words = (
        f"Figure 10, in kind: amplitudes over {LAST:g} s, logarithms. The lines at {STIFF.speed / np.pi:.1f} Hz are "
        "the joints', twice the speed, and stay where they are; those of the shafts move down by √2 "
        "with half the stiffness; bearings ring at their own frequency as well."
    )
    return Picture("liu_2023_section_3_fig_10", words, svg)


def _misprints() -> tuple[Misprint, ...]:
    ratio = 1.0 / np.cos(STIFF.angle) - 1.0
    printed = STIFF.damping[0] / (2.0 * np.sqrt(STIFF.bearing_stiffness * STIFF.mass))
    right = STIFF.bearing_damping / (2.0 * np.sqrt(STIFF.bearing_stiffness * STIFF.mass))
    return (
        Misprint(
            "(14) a, torsion",
            "three shafts of two inertias each; G2, G3, G4, G5 as free torques",
            "`theta3 = f1(theta2)`, `G3 = G2/i1`, `theta5 = f2(theta4)`, `G5 = G4/i2`; eliminated: `(J2 + i1² J3) "
            "theta2'' + i1 i1' J3 theta2'² = shaft 1 − i1 shaft 2`, likewise theta4",
            "eight equations for twelve unknowns as printed; closed, all agrees with pins in space and keeps its "
            f"energy (above). With G3 = G2 instead, up to {100 * ratio:.2g} % of the power would be lost or made",
        ),
        Misprint(
            "(14) b, supports",
            "C1 in the rows of y and z",
            "C4, as the text defines",
            f"dimensions, N m s/rad against N s/m; with our figures the bearing's damping ratio would be {printed:.2g} "
            f"in place of {right:.2g}",
        ),
        Misprint(
            "(14) c, supports",
            "`F_y`, `F_z` undefined",
            "couple of the joint on that shaft/span of its bearings: driving shaft `T tan r (1 + cos 2a)/(2 L)`, "
            "`T tan r sin 2a/(2 L)`; driven shaft by sin r and 1 − cos 2a in the first, T the torque of the moment",
            "couple square to both pins in space (test); one-way: y and z do not act back on the angles",
        ),
        Misprint("(14) d, fig. 9", "rotational speed in mm", "rad/s", "dimensions"),
    )
