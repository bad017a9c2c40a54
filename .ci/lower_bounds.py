"""Print pip constraints with every dependency at its lower bound: `python .ci/lower_bounds.py test sweep`."""

import re
import sys
import tomllib
from pathlib import Path

project = tomllib.loads((Path(__file__).parents[1] / "pyproject.toml").read_text(encoding="utf-8"))[
    "project"
]
extras = project["optional-dependencies"]
for requirement in [
    *project["dependencies"],
    *(line for name in sys.argv[1:] for line in extras[name]),
]:
    if bound := re.fullmatch(r"([\w.-]+)(\[[\w,]+\])?>=([\d.]+)", requirement):
        print(f"{bound[1]}=={bound[3]}")
    else:
        sys.exit(f"pyproject.toml: `{requirement}` states no lower bound: write `name>=version`")
