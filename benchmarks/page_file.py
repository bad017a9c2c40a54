"""A study as a command: its options, the machine that it runs on, and its page with figures next to it."""

import argparse
import warnings
from collections.abc import Iterable, Mapping
from pathlib import Path
from time import perf_counter

REPORTS = Path(__file__).parents[1] / "reports"


class Report:
    """The page `name`.md that a study makes; --quick where `quick` says what it does, further numbers as options."""

    def __init__(self, about: str | None, name: str, quick: str = "", **numbers: int):
        from benchmarks import machine  # a child process that measures its memory does without

        parser = argparse.ArgumentParser(description=about)
        parser.set_defaults(quick=False)
        if quick:
            parser.add_argument(
                "--quick", action="store_true", help=f"{quick}, nothing written unless --out"
            )
        for option, default in numbers.items():
            parser.add_argument(f"--{option}", type=int, default=default)
        parser.add_argument(
            "--out", type=Path, help=f"the page to write (default: reports/{name}.md)"
        )
        self.name, self.chosen = name, parser.parse_args()
        self.machine, self.start = machine.lines(), perf_counter()
        warnings.simplefilter(
            "ignore"
        )  # of the peers; torsion's own tests turn warnings into errors

    def publish(
        self, title: str, parts: Iterable[str], figures: Mapping[str, str] | None = None
    ) -> None:
        """Prints the page; writes it and its figures (SVG by file name) unless the run is quick and has no --out."""
        seconds, quick = (
            perf_counter() - self.start,
            " Quick run: less of everything." if self.chosen.quick else "",
        )
        how = f"Written by `python -m benchmarks.{self.name}` in {seconds:.0f} s.{quick}"
        page = [f"# {title}", how, "\n".join(f"- {line}" for line in self.machine), *parts]
        text = "\n\n".join(part.strip() for part in page) + "\n"
        print(text)
        target: Path | None = self.chosen.out or (
            None if self.chosen.quick else REPORTS / f"{self.name}.md"
        )
        if target:
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_text(text, encoding="utf-8")
            for name, svg in (figures or {}).items():
                (target.parent / name).write_text(svg, encoding="utf-8")


def verdict(is_met: bool) -> str:
    """Whether a target is met."""
    return "met" if is_met else "MISSED"
