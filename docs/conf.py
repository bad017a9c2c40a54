"""The documentation site, from the root of the repository: `sphinx-build -W -n -c docs -d build/pages . build/site`."""

import gc
import sys
from importlib import metadata
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent / "site"))
# Pages stay until the end: with the threshold of Python a third of the time goes to vain searches.
gc.set_threshold(200_000, 20, 100)

project = "torsion"
version = release = metadata.version("torsion")
root_doc = "docs/index"
include_patterns = [
    "README.md",
    "CONTRIBUTING.md",
    "CODE_OF_CONDUCT.md",
    "CHANGELOG.md",
    "docs/**.md",
    "reports/*.md",
    "reports/papers/*.md",
    "shafting_specs/README.md",
]
exclude_patterns = [".*", "build", "src", "tests", "benchmarks"]
extensions = [
    "myst_parser",
    "equations",
    "gallery",
    "entrance",
    "assistants",
    "python_reference",
    "navigation",
    "search_words",
]
moved_pages = {  # addresses before 0.1.0
    "tutorial": "tutorials/first-report",
    "pump_train": "tutorials/pump-train-api",
    "from_the_drawing": "how-to/model/shaft-from-drawing",
    "cardan_line": "how-to/drives/cardan-shaft",
    "ship_cpp": "how-to/drives/ship-cpp",
    "generator_set": "how-to/drives/diesel-generator",
    "diesel_misfire": "how-to/drives/diesel-misfire",
    "reciprocating_compressor": "how-to/drives/reciprocating-compressor",
    "wind_gearbox": "how-to/drives/wind-turbine-gearbox",
    "motor_start": "how-to/drives/motor-start",
    "cases": "how-to/study/load-cases",
    "tolerances": "how-to/study/tolerances",
    "sweeps": "how-to/study/parameter-study",
    "design": "how-to/study/optimisation",
    "fit": "how-to/study/model-updating",
    "live": "how-to/study/live-page",
    "many_machines": "how-to/study/cluster",
    "validation": "validation/index",
    "theory": "explanation/theory/index",
    "conventions": "reference/conventions",
}
myst_heading_anchors = 3
highlight_language = "none"

html_theme = "furo"
html_title = "torsion"
html_static_path = ["site/site.css"]
html_css_files = ["site.css"]
html_copy_source = False
html_show_copyright = False
html_theme_options = {"top_of_page_buttons": []}
