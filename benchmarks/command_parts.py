"""Seconds of processor of each part of `torsion solve FILE`, as JSON: `python -m benchmarks.command_parts FILE`.

Nothing heavy is imported before it is timed.
"""

import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from time import process_time


def main(file: str, folder: str) -> dict[str, float]:
    """Every part of the command in its order, in this process."""
    last, found = process_time(), {}
    found["interpreter"] = last

    def mark(name: str) -> None:
        nonlocal last
        found[name] = process_time() - last
        last = process_time()

    import numpy  # noqa: F401

    mark("numpy")
    import torsion.cli  # noqa: F401

    mark("command line")
    from torsion.schema.scene_reader import read

    study = read(file)
    mark("read")
    from torsion.runner import run

    findings = run(study)
    mark("solve")
    from torsion.output.document import document

    made = document(findings)
    mark("blocks")
    from torsion.output.renderers import OUTPUTS

    for name, title in (
        ("html", "page"),
        ("json", "results.json"),
        ("csv", "results.csv"),
        ("terminal", "terminal"),
    ):
        output = OUTPUTS[name]
        content = output(made, findings) if output.of_findings else output(made)
        if callable(content):
            content(Path(folder) / title)
        mark(title)
    return found


if __name__ == "__main__":
    with TemporaryDirectory() as folder:
        found = main(sys.argv[1], folder)
    import json

    print(json.dumps(found))
