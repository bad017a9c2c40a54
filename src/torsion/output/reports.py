"""What the commands report: of each report its title, its chapters in their order, and the names of its files."""

from collections.abc import Mapping
from dataclasses import dataclass, field

STEPS = "closing:steps"  # chapter before which the appendices of the full report stand


@dataclass(frozen=True)
class Report:
    """A report of some findings.

    A chapter is a module of output/chapters, or a function `module:function`; `@modes` stands for the chapters of that
    analysis, `@*` for those of all analyses that are not named.
    """

    title: str
    chapters: tuple[str, ...]
    stem: str  # of its files
    files: Mapping[str, str] = field(
        default_factory=dict
    )  # output: name of its file, where that is not the stem's
    more: tuple[str, ...] = ()  # appendices of the full report, before the steps
    columns: str = ""  # chapter's function that gives the columns of the CSV; "" for no CSV


REPORTS = {
    "solve": Report(
        "Torsional vibration calculation",
        (
            "verdict",
            "case_comparison",
            "plant",
            "@modes",
            "@critical",
            "@tolerances",
            "@response",
            "@*",
            "closing",
            "modes/natural_frequencies:appendix",
            "@system data",
            "@tooth forces",
            "closing:steps",
            "closing:sources",
            "closing:input_file",
        ),
        "report",
        {
            "json": "results.json",
            "vtu": "modes.vtu",
            "motion": "motion.npz",
            "tables": "tables.zip",
            "data": "data.zip",
            "xlsx": "results.xlsx",
            "designed": "designed.yaml",
        },
        more=(
            "response/forced_response:angles",
            "response/crank_machines:engine_harmonics",
            "modes/natural_frequencies:all_modes",
            "verdict:remarks",
        ),
    ),
    "joint": Report(
        "Universal joints",
        (
            "joint_motion:summary",
            "verdict:judged",
            "joint_motion:alone",
            "closing:steps",
            "verdict:remarks",
            "closing:input_file",
        ),
        "joints",
        columns="joint_motion:columns",
    ),
    "check": Report(
        "Models of a shaft train compared",
        ("model_comparison", "closing:steps", "closing:input_file"),
        "check",
    ),
    "compare": Report("Two calculations compared", (), "compare"),
    "study": Report(
        "Error against run time", ("closing:input_file",), "study"
    ),  # behind the run times
}
