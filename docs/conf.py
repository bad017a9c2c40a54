"""The documentation site, from the root of the repository: `sphinx-build -W -n -c docs -d build/pages . build/site`."""

import sys
from importlib import metadata
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent / "site"))

project = "torsion"
version = release = metadata.version("torsion")
root_doc = "docs/index"
include_patterns = [
    "README.md", "CONTRIBUTING.md", "CHANGELOG.md", "docs/**.md", "reports/*.md", "reports/papers/*.md",
    "shafting_specs/README.md",
]  # fmt: skip
exclude_patterns = [".*", "build", "src", "tests", "benchmarks"]
extensions = ["myst_parser", "equations", "gallery", "entrance"]
myst_heading_anchors = 3
highlight_language = "none"

html_theme = "furo"
html_title = "torsion"
html_static_path = ["site/site.css"]
html_css_files = ["site.css"]
html_copy_source = False
html_show_copyright = False
html_theme_options = {"top_of_page_buttons": []}
