"""What stands before the first chapter: what the report is about, from what, by what and on whose responsibility."""

import hashlib
from dataclasses import dataclass
from datetime import date

import torsion
from torsion.findings import Findings
from torsion.output.numbers import given_rpm
from torsion.output.reported_values import reference

DISCLAIMER = (
    "This report was computed from the figures in the input file, which it repeats in full; it is as good as they are. "
    "Limits marked “to be verified” are to be compared with the edition in force before the report is submitted. "
    "It does not replace the approval of a classification society or measurements on the plant."
)


@dataclass(frozen=True)
class Cover:
    """Title, facts and disclaimer."""

    title: str
    subtitle: str
    facts: tuple[tuple[str, str], ...]
    disclaimer: str = DISCLAIMER


def cover(findings: Findings, today: date | None = None, title: str = "Torsional vibration calculation") -> Cover:
    """The cover of a report; without a date it bears none."""
    study = findings.study
    facts = [
        ("Scene", study.name),
        ("Description", study.description.strip()),
        ("Input file", study.file),
        ("SHA-256 of the input", checksum(study.text) if study.text else ""),
        ("Operation", _operation(findings)),
        ("Rules", ", ".join(name for name, _ in study.rules) or "none requested"),
        ("Computed by", f"torsion {torsion.__version__}"),
        ("Date", today.isoformat() if today else ""),
    ]
    return Cover(title, study.name, tuple(fact for fact in facts if fact[1]))


def checksum(text: str) -> str:
    """SHA-256 of the input as read, in UTF-8."""
    return hashlib.sha256(text.encode("utf-8")).hexdigest()


def _operation(findings: Findings) -> str:
    operation, words = findings.study.operation, []
    if operation.speeds is not None:
        words.append(f"{given_rpm(operation.speeds.first)} to {given_rpm(operation.speeds.last)} rpm")
    if operation.rated is not None:
        power = operation.rated.power
        rating = f" with {power / 1e3:.5g} kW" if power is not None else ""
        words.append(f"rated {given_rpm(operation.rated.speed)} rpm{rating}")
    return f"{', '.join(words)} (speed of {reference(findings)})" if words else ""
