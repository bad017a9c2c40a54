"""Of the first page: as what the engines of the train are judged."""

from collections.abc import Iterator

from torsion.findings import Findings
from torsion.results import listed

WORDS = {"motored": "motored (misfire)", "cut out": "cut out"}


def states(findings: Findings) -> Iterator[str]:
    """As what the engines are judged, where not every cylinder fires alike or a phase is any."""
    for part in findings.study.train.parts:
        if part.engine is None:
            continue
        words = [
            f"cylinder {one.number} {WORDS[one.state]}"
            for one in part.engine.cylinders
            if one.state in WORDS
        ]
        firing = [one for one in part.engine.cylinders if one.state == "firing"]
        for share in dict.fromkeys(one.share for one in firing if one.share != 1.0):
            numbers = [str(one.number) for one in firing if one.share == share]
            named = f"cylinder{'s' * (len(numbers) > 1)} {listed(numbers)}"
            who = "all others" if words and len(numbers) == len(firing) else named
            words.append(f"{who} with {100 * share:.4g} % of the heat")
        words += (
            ["any phase to the rest of the train (magnitudes are added)"]
            if part.engine.by_chance
            else []
        )
        words += ["each cylinder in turn (the worst of each check)"] * part.engine.tries_all
        if words:
            yield f"{part.name} with {listed(words)}"
