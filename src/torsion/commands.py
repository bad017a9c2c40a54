"""A file to its findings and its report: what the command does."""

from collections.abc import Collection, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from torsion.analyses import ANALYSES, ordered
from torsion.analyses.discretisation import (
    assembled,
    discretisation_words,
    has_inertia,
    highest_excited,
    no_response,
)
from torsion.analyses.undamped_modes import ModesSettings, modes_settings
from torsion.assembly.system import System
from torsion.errors import Fault, InputError, Refusal, refusal
from torsion.findings import Findings, Plan, Progress, silent
from torsion.rules import needed, not_judged
from torsion.runner import one_case, run, solved
from torsion.schema.scene_reader import located, read
from torsion.study import Case, Study

if TYPE_CHECKING:
    from torsion.analyses.compare.timing import Timings
    from torsion.output.document import Document

JOINT_RULE = "universal-joints"
REST = (
    "everything but the joints",
    "`torsion joint` reports only the joints; `torsion solve` does the rest",
)
REST_OF_CHECK = (
    "everything else",
    "`torsion check` only compares the models; `torsion solve` does the rest",
)
ON_SUPPORTS = "it stands on supports; `torsion solve` computes its bending and judges it"
NO_POWER = "neither the power of the loads nor a rated power is given"
OTHER_FOLDER = "choose another folder with -o"
ELSEWHERE = (
    "natural frequencies",
    "damped modes",
    "response over speed",
    "critical speeds",
    "mean torque",
    "rules",
)


def solve(
    file: str | Path,
    out: str | Path | None = None,
    *,
    pdf: bool = False,
    vtu: bool = False,
    full: bool = False,
    case: str | None = None,
    memory: str | float | None = None,
    progress: Progress = silent,
) -> Findings:
    """Read, solve and judge a scene; write its report into `out` (default: reports/<scene>/ beside where you stand).

    Every case of the file is solved beside it and has its own report in a folder there; or of them `case` alone.

    Raises InputError with every fault of the file, SolveError where no answer has the promised accuracy; an earlier
    report stays whole then. With `vtu` the mode shapes are written too; `full` adds all appendices to the report.
    """
    findings = solved(file, case=case, memory=memory, progress=progress)
    folder = folder_of(file, out, findings.study.case)
    also = [name for name, is_requested in (("pdf", pdf), ("vtu", vtu)) if is_requested]
    write(findings, folder, also=also, is_full=full)
    return findings


def _omit(
    findings: Findings, scene: Study, omitted: tuple[tuple[str, str], ...], command: str
) -> Findings:
    """Return the findings with what the command omitted, among it the cases of a scene of which it took one."""
    if scene.cases:
        words = f"`torsion {command}` computes one case: the nominal case, or the one of --case; `torsion solve` solves all"
        omitted = (*omitted, (f"the cases {', '.join(scene.cases)}", words))
    return replace(findings, plan=replace(findings.plan, left_out=omitted))


def folder_of(file: str | Path, out: str | Path | None, case: Case | None = None) -> Path:
    """Return the folder of the report of a scene, or of one case alone."""
    if out is not None:
        return Path(out)
    folder = Path("reports") / Path(file).stem
    return folder if case is None else folder / case.folder


def write(
    findings: Findings,
    folder: Path,
    report: str = "solve",
    *,
    also: Collection[str] = (),
    is_full: bool = False,
) -> "Document":
    """Write the files of a report, `also` those of outputs on request; return the report.

    Raises InputError where the folder cannot be written, or a file cannot be made of these findings.
    """
    from torsion.output.write import write as write_report

    with _writing(findings.study, "the report", folder, OTHER_FOLDER):
        return write_report(findings, folder, report, also=also, is_full=is_full)


def report(
    results: str | Path, out: str | Path | None = None, *, also: Collection[str] = ()
) -> "tuple[Document, Path]":
    """Draw the report again that a file of results, or the results.json of a folder, holds; nothing is solved.

    Writes its page, and `also` those of outputs on request that it alone makes, into `out` (default: beside the
    results). The report and its folder. Raises InputError.
    """
    from torsion.output.stored.stored_report import file_at, opened
    from torsion.output.write import redraw

    source = Path(results)
    made = opened(source)
    folder = Path(out) if out is not None else source if source.is_dir() else source.parent
    with _writing(None, "the report", folder, OTHER_FOLDER):
        redraw(made, folder, also=also, results=file_at(source))
    return made, folder


@contextmanager
def _writing(study: Study | None, what: str, target: Path, remedy: str = "") -> Iterator[None]:
    """Raise InputError where something cannot be written to its place, or that is a file of the scene itself; locate
    other faults in the file."""
    from torsion.output.write import inputs, refuse_inputs

    try:
        refuse_inputs([target], [] if study is None else inputs(study))
        yield
    except OSError as error:
        message = f"{what} cannot be written to {target}: {error.strerror or error}"
        raise refusal(message, remedy) from None
    except InputError as error:
        raise error if study is None else located(error, study) from None


def joint(
    file: str | Path,
    *,
    turns: int | None = None,
    case: str | None = None,
    progress: Progress = silent,
) -> Findings:
    """Read a scene, or one case of it, and compute its joints alone, with their rules; nothing is written.

    `turns` takes the place of the file's own. Raises InputError, also where the train has no joint, and SolveError.
    """
    from torsion.analyses.joints.joint_analysis import JointsSettings
    from torsion.rules.universal_joints import tubes

    scene = read(file)
    study = one_case(scene, case)
    if not study.has_joints:
        hint = "`torsion joint` reports joints; use `torsion solve`"
        raise located(InputError([Fault(("train",), "the train has no joint", hint)]), study)
    settings = study.analyses.get("joints") or JointsSettings()
    if turns is not None:
        settings = settings.model_copy(update={"turns": turns})
    rules = tuple(rule for rule in study.rules if rule[0] == JOINT_RULE)
    joints_only = replace(study, analyses={"joints": settings}, rules=rules)
    findings = run(joints_only, only=("joints",), progress=progress)
    omitted = tuple(pair for pair in findings.plan.left_out if pair[0] not in ELSEWHERE)
    unjudged = tuple(
        (f"{JOINT_RULE}: bending of {tube.name}", ON_SUPPORTS)
        for tube in (tubes(study.train) if rules else ())
        if tube.has_support and not tube.lacks
    )
    return _omit(findings, scene, (REST, *omitted, *unjudged), "joint")


def check(file: str | Path, *, case: str | None = None, progress: Progress = silent) -> Findings:
    """Read a scene, or one case of it, and compare the models of its shafts, requested or not; nothing is written.

    Raises InputError, also for closed loops, of which there is no exact model, and SolveError.
    """
    scene = read(file)
    study = one_case(scene, case)
    findings = run(replace(study, rules=()), only=("check",), progress=progress)
    omitted = (*findings.plan.left_out, REST_OF_CHECK)
    return _omit(replace(findings, study=study), scene, omitted, "check")


def study(
    file: str | Path,
    *,
    tolerance: str | float | None = None,
    quick: bool = False,
    case: str | None = None,
    progress: Progress = silent,
) -> "tuple[Findings, Timings]":
    """Read a scene, or one case of it, and time every model of its shafts against its error; nothing is written.

    tolerance: relative, or text such as "0.1 %". Raises InputError, also where there is nothing to compare, and
    SolveError.
    """
    from torsion.analyses.compare.run_times import TOLERANCE, study_times
    from torsion.units import to_si

    try:
        goal = to_si(str(TOLERANCE if tolerance is None else tolerance), "1")
    except Refusal as fault:
        raise refusal(f"the tolerance: {fault.message} (write 0.1 % or 1e-3)") from None
    if not 0.0 < goal < 1.0:
        raise refusal(f"the tolerance {tolerance} is out of range: more than 0 and less than 100 %")
    scene = one_case(read(file), case)
    try:
        system, ruled = assembled(scene), needed(scene)
        timings = study_times(
            scene,
            highest=highest_excited(scene, system, ruled),
            count=getattr(scene.analyses.get("modes"), "count", None),
            no_response=no_response(scene, system, ruled),
            tolerance=goal,
            quick=quick,
            progress=progress,
        )
    except InputError as error:
        raise located(error, scene) from None
    return Findings(scene, {"system": system}, Plan((), (), {})), timings


def write_study(findings: Findings, timings: "Timings", folder: Path) -> "Document":
    """Write study.html and study.json; return the report. Raises InputError where the folder cannot be written."""
    from torsion.output.run_time_study import write_study as write_pages

    with _writing(findings.study, "the report", folder, OTHER_FOLDER):
        return write_pages(findings, timings, folder)


def write_matrices(findings: Findings, file: Path) -> str:
    """Write J, K, C and H in free coordinates as .npz, and state in a sentence at which speed their damping is.

    The damping is that of the rated speed, else of the highest, as of the damped modes. Raises InputError where the
    file cannot be written, the damping follows from a speed or a mean torque that the scene does not give, or the model
    is the exact one, which has no matrices.
    """
    from torsion.analyses.response.solver import ground_damping
    from torsion.analyses.steady import steady_if_known
    from torsion.assembly.matrices import matrices

    study, system, speed = findings.study, findings.system, findings.study.operation.speed
    following = [damper for damper in system.dampers if damper.needs_torque or damper.speed_factor]
    with _writing(study, "the matrices", file):
        if following and not speed:
            name = system.stations[following[0].station].name
            message = f"the damping of '{name}' follows from the speed, and so do the matrices; none is given"
            hint = "`operation: {rated: {speed: 1500 rpm, power: 100 kW}}`"
            raise InputError([Fault(("operation",), message, hint)])
        grid = np.array([speed or 0.0])
        steady = steady_if_known(study, system, grid) if speed else None
        view = matrices(system, ground_damping=ground_damping(system, grid, steady)[:, 0])
        mean = np.full(len(system.stations), np.nan) if steady is None else steady.applied[:, 0]
        arrays: dict[str, Any] = {key: np.asarray(value) for key, value in asdict(view).items()}
        with file.open("wb") as target:
            np.savez(target, **arrays, speed=speed or np.nan, mean_torque=mean)
    if not speed:
        return f"Matrices: {file}; no damping of theirs follows from the speed"
    torque = "" if steady is None else " and its mean torque"
    return f"Matrices: {file}; damping to ground at {speed * 30.0 / np.pi:.6g} rpm{torque}"


@dataclass(frozen=True)
class Planned:
    """What would be computed of a scene: steps with their sizes and reasons, and what would be left out and why."""

    steps: tuple[tuple[str, str, str], ...]  # (what, size, why)
    left_out: tuple[tuple[str, str], ...]  # (what, why)
    cases: "Mapping[str, Planned]" = field(default_factory=dict)  # by name


def plan(file: str | Path, *, case: str | None = None) -> Planned:
    """Read a scene and say what `solve` would compute of it and of its cases, or of one `case`; nothing is solved.

    Raises InputError as `solve` does.
    """
    study = read(file)
    planned, cases = _planned(one_case(study, case)), study.cases if case is None else {}
    return replace(planned, cases={name: _planned(variant) for name, variant in cases.items()})


def _planned(study: Study) -> Planned:
    """Return what would be computed of one study."""
    ruled, system = needed(study), assembled(study)
    if highest := highest_excited(study, system, ruled):
        system = assembled(study, highest, highest)
    from torsion.analyses.response.harmonic_components import lines

    components = lines(system)
    sizes = _sizes(study, system, ruled, len(components))

    # Why a step would be left out; empty words if it would not.
    modes = "" if modes_settings(study, ruled) is not None else "`analyses` does not name modes"
    if not has_inertia(system):
        modes = "no component has an inertia"
    has_orders = any(line.order is not None for line in components)
    lacking = {
        "modes": modes,
        "damped": modes or ("" if system.damps else "nothing damps"),
        "critical": modes or ("" if has_orders else "no order excites"),
        "response": no_response(study, system, ruled),
        "steady": "" if study.has_mean_torque else NO_POWER,
    }
    steps, left_out = [], list[tuple[str, str]]()
    for name in ordered(ANALYSES):
        is_named, title = name in study.analyses, ANALYSES[name].title
        if not (is_named or ANALYSES[name].is_wanted(study)):
            continue
        if lacking.get(name):
            left_out.append((title, lacking[name]))
        elif name in sizes or is_named:
            why = "a rule of the file reads it" if name in ruled else "the default"
            steps.append((title, sizes.get(name, ""), "the file names it" if is_named else why))
    if study.rules:
        steps.append(("rules", ", ".join(name for name, _ in study.rules), "the file names them"))
    return Planned(tuple(steps), (*study.train.taken_as_linear, *left_out, *not_judged(study)))


def _sizes(study: Study, system: System, ruled: frozenset[str], components: int) -> dict[str, str]:
    """Return the size of every step by the names of analyses; steps without a size are prepared by others.

    components: how many orders and frequencies excite.
    """
    speeds, requested = study.operation.speeds, modes_settings(study, ruled)
    count = ModesSettings().count if requested is None else requested.count
    sizes = {
        "assembly": f"{len(system.stations)} stations, {len(system.spans)} spans; {discretisation_words(system)}",
        "modes": f"{count} elastic modes",
        "damped": f"{count} modes",
        "critical": f"{components} orders and frequencies by {count} modes",
        "joints": f"{sum(part.joint is not None for part in study.train.parts)} joints",
        "lateral": f"{sum(bool(study.train.shaft(bar).support) for bar in study.train.bars)} shafts on supports",
    }
    if study.has_mean_torque:
        from torsion.analyses.power_balance import power_balance

        balance = power_balance(study.train, study.operation)
        sizes["steady"] = f"the mean torque in every span. {balance.sentence}"
    if variation := study.variations.get("sweep"):
        settings = study.analyses["sweep"]
        from torsion.what_if.sweep.sweep_settings import Points, SweepSettings

        assert isinstance(settings, SweepSettings)
        sizes["sweep"] = Points.from_settings(study, settings, variation.figures).words
    if "transient" in study.analyses:
        from torsion.analyses.motion.events.transient_settings import cases
        from torsion.analyses.motion.train.state_before import acting_torques, expected_steps

        motions = (
            f"{motion.name}: {acting_torques(study, motion).words}{expected_steps(study, system, motion)}"
            for motion, _ in cases(study)
        )
        sizes["transient"] = " ".join(words.removeprefix(": ") for words in motions)
    if speeds is not None:
        at_speeds = f"at {speeds.steps} speeds, and more around resonances"
        sizes["response"] = f"{components} harmonic components {at_speeds}"
    return sizes


def sketch(file: str | Path, out: str | Path | None = None, *, case: str | None = None) -> Path:
    """Draw the train of a scene, or of one case, as SVG, into `out` (default: <scene>.svg where you stand); its path.

    Nothing is solved. Raises InputError, also where the file cannot be written.
    """
    from torsion.output.chapters import plant
    from torsion.output.drawing.svg import svg
    from torsion.output.figures.figure import Figure

    findings = run(replace(one_case(read(file), case), rules=()), only=("assembly",))
    target = Path(out) if out is not None else Path(f"{Path(file).stem}.svg")
    caption = "Train, numbered from its driving end (not to scale)"
    figure = Figure("plant", caption, (plant.sketch(findings),))
    with _writing(findings.study, "the sketch", target):
        target.write_text(
            f'<?xml version="1.0" encoding="UTF-8"?>\n{svg(figure)}', encoding="utf-8"
        )
    return target
