"""The analyses, in a registry: what each reads, when it runs, what it finds, and the chapters that report it.

An analysis is one module with a function `run(work)`, which puts its results under the names given here, and one entry
here. `run` follows the order of the entries, which is that of `needs`; the module is imported when the analysis runs.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from importlib import import_module
from typing import TYPE_CHECKING, Any

from torsion.fields import Declared

if TYPE_CHECKING:
    from torsion.study import Study

VARYING = (
    "sweep",
    "design",
    "fit",
)  # whose settings vary figures of the file; a variant of it has none of them
MODELS = ("lumped", "fem", "exact")


@dataclass(frozen=True)
class Analysis:
    """One entry of the registry."""

    title: str  # as the plan and the terminal name it
    module: str
    run: str = "run"  # function (Work) -> None
    settings: str = ""  # class of its settings; "" for none under a key of its own
    needs: tuple[str, ...] = ()  # analyses whose results it reads, where they are there
    results: Mapping[str, str] = field(
        default_factory=dict
    )  # name in every output: class, or module:class
    # By a study that does not name it; True of one that says itself what it leaves out.
    wanted: bool | Callable[["Study"], bool] = False
    # Function (study, system, analyses that rules read) -> str: why it finds nothing; its module is then not imported.
    lacks: str = ""
    chapters: tuple[
        str, ...
    ] = ()  # of the report, in output/chapters; where none, its results as they are declared
    place: tuple[
        str, ...
    ] = ()  # key of the file that is at fault where it has no answer; () for its own
    is_listed: bool = False  # a list of settings may stand in the file, one for each time it is run

    def is_wanted(self, study: "Study") -> bool:
        """Return whether a study that does not name the analysis wants it."""
        return self.wanted if isinstance(self.wanted, bool) else self.wanted(study)

    def imported(self, word: str) -> Any:
        """Import and return what `run`, `settings` or an entry of `results` names."""
        module, _, name = word.rpartition(":")
        return getattr(import_module(module or self.module), name)


ANALYSES: dict[str, Analysis] = {
    "sections": Analysis(
        "cross-sections",
        "torsion.analyses.discretisation",
        "run_sections",
        wanted=lambda study: study.train.has_meshed_sections,
    ),
    "assembly": Analysis(
        "assembly",
        "torsion.analyses.discretisation",
        "run_assembly",
        needs=("sections",),
        wanted=True,
    ),
    "modes": Analysis(
        "natural frequencies",
        "torsion.analyses.discretisation",
        "run_modes",
        settings="torsion.analyses.undamped_modes:ModesSettings",
        needs=("assembly",),
        results={"modes": "torsion.analyses.undamped_modes:Modes"},
        wanted=True,
        chapters=("modes/natural_frequencies",),
    ),
    "sharp steps": Analysis(
        "steps between shafts",
        "torsion.analyses.modes.steps_and_hubs",
        "run_steps",
        needs=("modes",),
        results={"sharp_steps": "SharpSteps"},
        chapters=("modes/natural_frequencies",),
        place=("steps",),
        wanted=lambda study: study.train.has_corners,
    ),
    "hubs": Analysis(
        "hubs on shafts",
        "torsion.analyses.modes.steps_and_hubs",
        "run_hubs",
        needs=("modes",),
        results={"hubs": "HubMoves"},
        chapters=("modes/natural_frequencies",),
        place=("train",),
        wanted=lambda study: study.train.has_hubs,
    ),
    "damped": Analysis(
        "damped modes",
        "torsion.analyses.damped_modes",
        needs=("couplings by table",),
        results={"damped_modes": "DampedModes"},
        wanted=True,
        lacks="torsion.analyses.discretisation:no_damped_modes",
        chapters=("modes/natural_frequencies",),
        place=("analyses", "modes", "damped"),
    ),
    "dampers": Analysis(
        "optimum of the dampers",
        "torsion.analyses.modes.damper_optimum",
        needs=("modes",),
        results={"dampers": "Dampers"},
        chapters=("response/couplings:dampers",),
        wanted=lambda study: any(part.kind == "damper" for part in study.train.parts),
        place=("train",),
    ),
    "couplings by table": Analysis(
        "couplings by table",
        "torsion.analyses.modes.coupling_tables",
        needs=("modes",),
        results={"coupling_tables": "CouplingTables"},
        chapters=("response/couplings:input_and_modes",),
        place=("train",),
        wanted=lambda study: (
            study.train.has_tables_over("frequency") or study.train.has_tables_over("mean torque")
        ),
    ),
    "frequencies over speed": Analysis(
        "frequencies over the speed",
        "torsion.analyses.modes.frequencies_by_torque",
        needs=("couplings by table",),
        results={"frequencies_over_speed": "FrequenciesOverSpeed"},
        chapters=("response/couplings:frequencies",),
        wanted=lambda study: study.train.follows_speed,
        place=("train",),
    ),
    "steady": Analysis(
        "mean torque",
        "torsion.analyses.steady",
        needs=("damped",),
        results={"mean": "Steady", "machines": "PowerBalance", "mean_loads": "MeanLoads"},
        wanted=True,
        lacks="torsion.analyses.discretisation:no_mean_torque",
        chapters=("response/mean_torques",),
        place=("operation",),
    ),
    "slopes": Analysis(
        "slopes of the laws of load and drive",
        "torsion.analyses.law_slopes",
        needs=("steady",),
        wanted=lambda study: any(
            part.machine and (part.machine.drive or part.machine.load) for part in study.train.parts
        ),
    ),
    "system data": Analysis(
        "data of the system",
        "torsion.analyses.system_data",
        needs=("steady",),
        results={"system_data": "SystemData"},
        wanted=True,
        chapters=("modes/mass_elastic",),
        place=("train",),
    ),
    "tooth forces": Analysis(
        "tooth forces",
        "torsion.analyses.tooth_forces",
        needs=("steady",),
        results={"tooth_forces": "ToothForces"},
        wanted=lambda study: any(mesh.toothing is not None for mesh in study.train.constraints),
        chapters=("modes/mass_elastic",),
        place=("operation", "rated"),
    ),
    "response": Analysis(
        "response over speed",
        "torsion.analyses.response.over_speed",
        settings="ResponseSettings",
        needs=("steady",),
        results={
            "response": "Response",
            "synthesis": "torsion.analyses.response.amplitudes:Synthesis",
        },
        wanted=True,
        lacks="torsion.analyses.discretisation:no_response",
        chapters=(
            "response/forced_response",
            "response/component_loads:shafts",
            "response/component_loads:gears",
            "response/component_loads:couplings",
        ),
    ),
    "fillets": Analysis(
        "stress in fillets",
        "torsion.analyses.response.fillet_stresses",
        needs=("response", "nonlinear peaks"),
        results={"fillets": "Fillets"},
        wanted=lambda study: any(  # a step of a stated radius, or notches
            part.shaft.notches or (part.shaft.step is not None and part.shaft.step.round)
            for part in study.train.parts
            if part.shaft is not None
        ),
        chapters=("modes/natural_frequencies:fillets",),
        place=("train",),
    ),
    "pendulums": Analysis(
        "pendulums",
        "torsion.analyses.response.pendulums",
        needs=("modes", "response"),
        results={"pendulums": "Pendulums"},
        chapters=("response/couplings:pendulums",),
        place=("train",),
        wanted=lambda study: any(part.pendulum is not None for part in study.train.parts),
    ),
    "coupling temperatures": Analysis(
        "temperatures of couplings",
        "torsion.analyses.response.coupling_temperatures",
        needs=("response",),
        results={"coupling_temperatures": "CouplingTemperatures"},
        chapters=("response/couplings:temperatures",),
        wanted=lambda study: any(part.warming is not None for part in study.train.parts),
        place=("train",),
    ),
    "vibratory torques": Analysis(
        "vibratory torque of couplings by table",
        "torsion.analyses.response.vibratory_couplings",
        needs=("response",),
        results={"vibratory_torques": "VibratoryTorques"},
        chapters=("response/couplings:vibratory_torques",),
        wanted=lambda study: study.train.has_tables_over("vibratory torque"),
        place=("train",),
    ),
    "periodic": Analysis(
        "exact periodic response",
        "torsion.analyses.stability.requested_motion",
        "run_periodic",
        needs=("response",),
        results={
            "periodic": "torsion.analyses.stability.periodic_orbits:PeriodicResponse",
            "first_order_compared": (
                "torsion.analyses.stability.first_order_compared:FirstOrderCompared"
            ),
        },
        wanted=lambda study: (
            study.has_joints or study.setting("analyses", "response", "method") is not None
        ),
        chapters=("response/exact_response",),
        place=("analyses", "response", "method"),
    ),
    "stability": Analysis(
        "stability",
        "torsion.analyses.stability.requested_motion",
        "run_stability",
        settings="StabilitySettings",
        needs=("modes",),
        results={"stability": "torsion.analyses.stability.stability_over_speed:Stability"},
        chapters=("stability_ranges",),
    ),
    "stability map": Analysis(
        "stability map",
        "torsion.analyses.stability.requested_motion",
        "run_map",
        needs=("modes",),
        results={"stability_map": "torsion.analyses.stability.stability_over_speed:StabilityMap"},
        wanted=lambda study: study.setting("analyses", "stability", "map") is not None,
        chapters=("stability_ranges",),
        place=("analyses", "stability", "map"),
    ),
    "nonlinear peaks": Analysis(
        "exact motion at the peaks of nonlinear couplings",
        "torsion.analyses.motion.derived.raised_synthesis",
        needs=("response",),
        results={
            "nonlinear_peaks": "torsion.analyses.motion.derived.nonlinear_peaks:NonlinearPeaks"
        },
        wanted=lambda study: study.train.has_nonlinear_couplings,
        chapters=("response/couplings:nonlinear_at_peaks",),
        place=("analyses", "response"),
    ),
    "component loads": Analysis(
        "loads of gear meshes and couplings",
        "torsion.analyses.response.component_loads",
        needs=("response", "nonlinear peaks"),
        results={"component_loads": "ComponentLoads"},
        wanted=lambda study: study.excites,
        chapters=("response/component_loads:gears", "response/component_loads:couplings"),
        place=("analyses", "response"),
    ),
    "frequency response": Analysis(
        "response over frequency",
        "torsion.analyses.response.over_frequency",
        needs=("steady",),
        results={"frequency_response": "FrequencyResponse"},
        wanted=lambda study: study.setting("analyses", "response", "frequencies") is not None,
        chapters=("response/forced_response:over_frequency",),
        place=("analyses", "response", "frequencies"),
    ),
    "critical": Analysis(
        "critical speeds",
        "torsion.analyses.critical",
        needs=("modes", "frequencies over speed"),
        results={"critical_speeds": "CriticalSpeeds"},
        wanted=True,
        chapters=("modes/critical_speeds",),
    ),
    "tolerances": Analysis(
        "bands of the natural frequencies",
        "torsion.analyses.modes.tolerances",
        settings="TolerancesSettings",
        needs=("critical",),
        results={"tolerances": "Tolerances"},
        chapters=("modes/tolerances",),
        wanted=lambda study: study.has_tolerances,
    ),
    "joints": Analysis(
        "universal joints",
        "torsion.analyses.joints.joint_analysis",
        settings="JointsSettings",
        needs=("steady",),
        results={"joints": "Joints"},
        wanted=lambda study: study.has_joints,
        chapters=("joint_motion",),
    ),
    "lateral": Analysis(
        "bending of the shafts",
        "torsion.analyses.lateral.shaft_bending",
        settings="LateralSettings",
        needs=("steady",),
        results={"lateral": "Lateral"},
        wanted=lambda study: study.has_supports,
        chapters=("shaft_bending",),
    ),
    "engine": Analysis(
        "engines",
        "torsion.analyses.engine.engine_analysis",
        needs=("response", "damped"),
        results={"engines": "torsion.analyses.engine.engine_results:Engines"},
        wanted=lambda study: any(part.engine is not None for part in study.train.parts),
        chapters=("response/crank_machines:engines",),
        place=("train",),
    ),
    "compressor": Analysis(
        "compressors",
        "torsion.analyses.compressor.compressors",
        needs=("response", "damped"),
        results={"compressors": "Compressors"},
        wanted=lambda study: any(part.compressor is not None for part in study.train.parts),
        chapters=("response/crank_machines:compressors",),
        place=("train",),
    ),
    "transient": Analysis(
        "motion over time",
        "torsion.analyses.motion.motion_from_events",
        settings="torsion.analyses.motion.events.transient_settings:TransientSettings",
        needs=("steady",),
        results={"transient": "Transients"},
        chapters=("motion_over_time",),
        is_listed=True,
    ),
    "sweep": Analysis(
        "sweep",
        "torsion.what_if.sweep.sweep_run",
        settings="torsion.what_if.sweep.sweep_settings:SweepSettings",
        needs=("modes",),
        results={"sweep": "torsion.what_if.sweep.sweep_results:Sweep"},
        chapters=("what_if/sweep",),
    ),
    "design": Analysis(
        "design",
        "torsion.what_if.design.design_run",
        settings="torsion.what_if.design.design_settings:DesignSettings",
        needs=("modes", "sweep"),
        results={"design": "torsion.what_if.design.design_results:Design"},
        chapters=("what_if/design",),
    ),
    "fit": Analysis(
        "fit to measurements",
        "torsion.what_if.fit.fit_run",
        settings="torsion.what_if.fit.fit_settings:FitSettings",
        needs=("modes",),
        results={"fit": "torsion.what_if.fit.fit_results:Fit"},
        chapters=("what_if/fit",),
    ),
    "check": Analysis(
        "comparison of the models",
        "torsion.analyses.compare.side_by_side",
        "run_check",
        settings="CheckSettings",
        needs=("assembly",),
        results={"check": "Compared"},
        chapters=("model_comparison",),
    ),
}


def settings_classes() -> dict[str, type[Declared]]:
    """Return the settings of every analysis that a file can name."""
    return {
        name: analysis.imported(analysis.settings)
        for name, analysis in ANALYSES.items()
        if analysis.settings
    }


def ordered(analyses: Mapping[str, Analysis]) -> list[str]:
    """Return names of the analyses, each after those that it needs, else in the order of the registry."""
    names: dict[str, None] = {}

    def add(name: str) -> None:
        for before in analyses[name].needs:
            add(before)
        names.setdefault(name)

    for name in analyses:
        add(name)
    return list(names)
