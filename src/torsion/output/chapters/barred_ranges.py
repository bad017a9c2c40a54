"""Chapter: barred speed ranges."""

from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, Table, head
from torsion.output.numbers import RPM, number, rpm
from torsion.output.reported_values import band_words, barred, barred_rpm, rated


def chapter(findings: Findings) -> list[Block]:
    """Nothing where no range is barred."""
    found = barred(findings)
    if not found:
        return []
    speed = rated(findings)
    columns = head("< Shaft | Critical speed [rpm] | λ = n/n_{rated} | From [rpm] | To [rpm]")
    rows = tuple(
        (b.shaft, rpm(b.critical), number(b.critical / speed, 4) if speed else "–", rpm(b.lower), rpm(b.upper))
        for b in found
    )
    together = "; ".join(band_words(band) for band in barred_rpm(findings))
    text = (
        f"Barred for continuous operation: {together}. The range is to be passed rapidly, to be marked on the "
        "tachometer and to be shown on a notice at every control station. Lower limit 16 n_{c}/(18 − λ_{c}), upper "
        "limit (18 − λ_{c}) n_{c}/16, extended to every speed at which the stress exceeds τ_{C} (IACS UR M68); n_{c} "
        "is the critical speed."
    )
    table = Table(columns, rows, f"Barred ranges ({number(speed * RPM)} rpm rated)" if speed else "Barred ranges")
    return [Heading("Barred speed ranges"), Paragraph(text), table]
