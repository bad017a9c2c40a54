"""The page of the lumped pump train: the article's steps next to the program's tree elimination."""

import json
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache

import numpy as np

import torsion
from benchmarks.papers import pump_steps as steps
from benchmarks.papers.drawing import Panel, curves
from benchmarks.papers.pump_steps import Chain
from benchmarks.papers.scenes import solved
from benchmarks.papers.writing import Misprint, Page, Picture, bound, stated
from torsion.analyses.response.amplitudes import FrequencyResponse
from torsion.analyses.undamped_modes import Modes
from torsion.findings import Findings

NAME = "pump_lumped"
TEETH = (42, 125)
RATIO = TEETH[0] / TEETH[1]  # i = n2/n1
GEARS = 3  # the disc behind which the pump's speed begins
TIMES = 64  # instants of a cycle


@dataclass(frozen=True)
class Answer:
    """Complex amplitudes of one way of solving, (discs or sections, frequencies)."""

    angle: np.ndarray  # rad
    torque: np.ndarray  # N m, whole torque of each section


@cache
def found() -> Findings:
    """The model file as the program solves it."""
    return solved(NAME)


def frequencies_of(findings: Findings) -> np.ndarray:
    """(frequencies,) Hz of the response."""
    if findings.get(FrequencyResponse) is None:
        raise ValueError("the model file requests no response over frequency")
    return findings.need(FrequencyResponse).frequency


def modes_of(findings: Findings) -> Modes:
    """The natural frequencies."""
    if findings.get(Modes) is None:
        raise ValueError("the model file requests no modes")
    return findings.need(Modes)


@cache
def chain() -> Chain:
    """The article's figures, taken from the model file's train before any assembly."""
    train = found().study.train
    discs = [part.stations[0] for _, part in train.of_kind("disc")]
    damping, moment = np.zeros(len(discs)), np.zeros(len(discs), dtype=complex)
    for damper in train.dampers:
        damping[discs.index(damper.station)] += damper.constant
    for torque in train.torques:
        moment[discs.index(torque.station)] += torque.torque * np.exp(1j * torque.phase)
    return Chain(
        np.array([disc.inertia for disc in train.inertias]),
        damping,
        np.array([1.0 / link.flexibility for link in train.springs]),
        np.array([link.viscous for link in train.springs]),
        moment,
    )


def program(findings: Findings) -> Answer:
    """The program's answer at discs and sections."""
    train, sweep, spans = (
        findings.study.train,
        findings.need(FrequencyResponse),
        findings.system.spans,
    )
    if sweep is None:
        raise ValueError("the model file requests no response over frequency")
    discs = [part.stations[0] for _, part in train.of_kind("disc")]
    links = [part.name for _, part in train.of_kind("coupling")]
    places = [next(k for k, span in enumerate(spans) if span.name == name) for name in links]
    return Answer(sweep.angle[:, discs].T, sweep.torque[:, places].T)


def dense(solve: Callable[[Chain, float], np.ndarray], frequencies: np.ndarray) -> Answer:
    """The article's answer by `complex_steps` or `real_steps`; a section's torque is that of its driving side."""
    speed = 2.0 * np.pi * frequencies
    angle = np.stack([solve(chain(), w) for w in speed], axis=-1)
    stiffness = chain().stiffness[:, None] + 1j * chain().viscous[:, None] * speed
    return Answer(angle, -stiffness * np.diff(angle, axis=0))


def geared() -> Findings:
    """The same train with its gears in place of figures referred to the motor: J = J'/i^2, K, C likewise, T = T'/i."""
    one, names = chain(), [part.name for part in found().study.train.parts]
    train: list[dict[str, dict[str, object]]] = []
    for k in range(one.inertia.size):
        square = 1.0 if k <= GEARS else RATIO**2
        disc = {"inertia": one.inertia[k] / square, "damping": one.ground[k] / square}
        train.append(
            {"disc": {"name": names[2 * k], **{key: value for key, value in disc.items() if value}}}
        )
        if k == GEARS:
            train.append({"gear": {"name": "gearbox", "teeth": TEETH}})
        if k < one.stiffness.size:
            square = 1.0 if k < GEARS else RATIO**2
            link = {"stiffness": one.stiffness[k] / square, "viscous": one.viscous[k] / square}
            train.append({"coupling": {"name": names[2 * k + 1], **link}})
    torques = [
        {
            "at": names[2 * k],
            "torque": abs(moment) / (1.0 if k <= GEARS else RATIO),
            "phase": f"{np.angle(moment)} rad",
        }
        for k, moment in enumerate(one.moment)
        if moment
    ]
    frequencies = {"from": 1, "to": 200, "steps": 400}
    requested = {"modes": {"count": 5}, "response": {"frequencies": frequencies}}
    scene = {"name": "geared", "train": train, "excitations": torques, "analyses": requested}
    return torsion.run(torsion.parse(json.dumps(scene)))


def by_line(values: np.ndarray, scale: np.ndarray) -> np.ndarray:
    """Each frequency relative to its largest value, so that none hides behind a resonance."""
    result: np.ndarray = values / np.abs(scale).max(axis=0)
    return result


def page() -> Page:
    """Everything the page says."""
    return Page(
        name=NAME,
        title="Lumped torsional calculation of a 1200 kW pump train",
        reference="Article on the lumped torsional calculation of a 1200 kW pump train (authors, journal, year and "
        "pages are not recorded in the available copy).",
        what="The article reduces a motor, gears and a pump to discs and springs and solves for complex amplitudes at "
        "one frequency, first as complex equations, then as twice as many real ones. Angles, phases and section "
        "torques follow.",
        notation="`J`, `C`, `K` inertias, dampings, stiffnesses; `A*` complex angles, `M*` complex moments, "
        "`R* = K − w²J + i w C`. All eighteen equations are missing in the available copy and are restored from the "
        "text; the numbering (11) to (14) is a guess. The figures of the train are ours.",
        numbers=tuple(_numbers()),
        checks=_checks(),
        pictures=(_amplitudes(),),
        misprints=_misprints(),
        missing=(
            (
                "Every number of the article: its tables of inertias, stiffnesses and moments and its figures are "
                "missing. The model file has the ratings of the plant and estimates for the rest."
            ),
            "The article's other parts, a truck's driveline and integration in time, are on [their page](shafting.md).",
        ),
    )


def _numbers() -> Iterator[tuple[str, ...]]:
    modes = modes_of(found())
    for k, frequency in enumerate(modes.frequency):
        yield stated(f"natural frequency {k + 1}", float(frequency), "Hz", "missing", 10)
    first = float(modes.frequency[0])
    amplitude = steps.complex_steps(chain(), 2.0 * np.pi * first)
    whole = steps.section_right(chain(), amplitude, 2.0 * np.pi * first)
    printed = steps.section_printed(chain(), amplitude)
    names = [part.name for part in found().study.train.parts][1::2]
    for name, elastic, full in zip(names, printed, whole, strict=True):
        what = f"{name} at the first natural frequency: (18), and the whole torque"
        yield what, f"{elastic:.6f} N m by (18)", f"{full:.6f} N m", f"{full - elastic:+.2g}"


def _checks() -> str:
    frequencies = frequencies_of(found())
    ten, fifteen = dense(steps.complex_steps, frequencies), dense(steps.real_steps, frequencies)
    ours = program(found())
    same = bound(by_line(fifteen.angle, ten.angle), by_line(ten.angle, ten.angle), "1e-11")
    angle = bound(by_line(ours.angle, ten.angle), by_line(ten.angle, ten.angle), "1e-11")
    torque = bound(by_line(ours.torque, ten.torque), by_line(ten.torque, ten.torque), "1e-10")
    speed, time = 2.0 * np.pi * frequencies, np.arange(TIMES) / TIMES
    worst = max(
        steps.imbalance(chain(), ours.angle[:, k], w, time * 2.0 * np.pi / w)
        for k, w in enumerate(speed.tolist())
    )
    own = np.where(np.arange(chain().inertia.size) <= GEARS, 1.0, RATIO)[:, None]
    free = geared()
    other = frequencies_of(free)
    part = np.isin(other, frequencies), np.isin(frequencies, other)
    turned = program(free).angle[:, part[0]] / own
    referred = bound(
        by_line(turned, ten.angle[:, part[1]]), by_line(ours.angle, ten.angle)[:, part[1]], "1e-10"
    )
    return (
        f"At {_round(frequencies.size)} or more frequencies from 1 to 200 Hz, each relative to its largest value: (10) "
        f"and (15) agree within {same}; the program, which forms no matrix, agrees with (10) within {angle} in angles "
        f"and {torque} in section torques. (16) put into (1) leaves at most {_least(worst)} of the largest term of a "
        f"disc. The same train with its gears instead of referred figures gives the same angles within {referred}."
    )


def _round(count: int) -> int:
    return count // 100 * 100


def _least(worst: float) -> str:
    if worst > 1e-12:
        raise ArithmeticError(f"(1) lacks {worst:.2g}")
    return "1e-12"


def _amplitudes() -> Picture:
    frequencies = frequencies_of(found())
    few = np.arange(5.0, 200.0, 5.0)
    ours, fifteen = program(found()), dense(steps.real_steps, few)
    names = [part.name for part in found().study.train.parts]
    angles, torques = (
        Panel(
            f"log10 of {what}",
            [(names[2 * k + odd], np.log10(np.abs(getattr(ours, field)[k]))) for k in chosen],
            dots=[("(15)", few, np.log10(np.abs(getattr(fifteen, field)[k]))) for k in chosen],
        )
        for what, field, odd, chosen in (
            ("angle, rad", "angle", 0, (0, 5)),
            ("section torque, N m", "torque", 1, (1, 4)),
        )
    )
    svg = curves(
        "pump_lumped_amplitudes", frequencies, "frequency, Hz", [angles, torques], height=2.4
    )
    words = "Amplitudes over frequency, amplitude: the program's curves and points of (15)."
    return Picture("pump_lumped_amplitudes", words, svg)


def _misprints() -> tuple[Misprint, ...]:
    modes = modes_of(found())
    discs = [part.stations[0] for _, part in found().study.train.of_kind("disc")]
    top = 2.0 * np.pi * float(modes.frequency[-1])
    shape = modes.shape[discs, -1]
    calm, wild = (steps.central_differences(chain(), shape, share / top) for share in (1.99, 2.01))
    return (
        Misprint(
            "(18)",
            "`T = K |A*_k − A*_(k+1)|`",
            "`T = |(K + i w C)(A*_k − A*_(k+1))|`: the section's damper carries torque too",
            f"torques of the program and of (10), see above; on this train (18) lacks up to {_lack()} of a section's "
            "torque below 200 Hz",
        ),
        Misprint("list of symbols", "unit of K other than N m/rad", "N m/rad", "dimensions of (1)"),
        Misprint(
            "(1)", "`T_t(t)` on the right", "`T_k(t)`, one moment a disc", "the index of the disc"
        ),
        Misprint(
            "finite differences (part 3)",
            "no limit of the time step in the available copy",
            "stable only for `dt < 2/w_max`",
            f"200 steps of the highest mode: largest angle grows by {calm:.3g} at 1.99/w_max, by {wild:.1e} at "
            "2.01/w_max",
        ),
        Misprint(
            "joint behind a gear",
            "order 2 of the motor",
            "order 2i, i = n2/n1; a common period exists for rational i only",
            "not computed here: this train has no joint",
        ),
    )


def _lack() -> str:
    """Largest share of a section's torque that (18) leaves out."""
    frequencies = np.linspace(1.0, 200.0, 400)
    share = 0.0
    for w in 2.0 * np.pi * frequencies:
        amplitude = steps.complex_steps(chain(), w)
        elastic, whole = (
            steps.section_printed(chain(), amplitude),
            steps.section_right(chain(), amplitude, w),
        )
        share = max(share, float((1.0 - elastic / whole).max()))
    return f"{100.0 * share:.3g} %"
