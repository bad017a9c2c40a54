"""Chapters: what was computed, how and in what time, what was left out and why; and the input as read."""

import hashlib
from collections.abc import Iterable, Iterator
from pathlib import Path

from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, KeyValues, Paragraph, Verbatim, table
from torsion.output.numbers import number
from torsion.output.scene import checksum, diagram_files
from torsion.primitives import SectionMesh
from torsion.results import listed


def steps(findings: Findings) -> Iterator[Block]:
    """Always printed."""
    plan = findings.plan
    rows = [(line.what, line.method, line.size, number(1e3 * line.seconds, 3), line.why) for line in plan.done]
    yield Heading("What was computed")
    yield table("< Step | < Method | < Size | Time [ms] | < Why", rows, "Steps that were done")
    if plan.left_out:
        yield table("< Left out | < Why", plan.left_out, "Left out")
    if plan.versions:
        yield KeyValues(tuple(plan.versions.items()))


def input_file(findings: Findings) -> Iterator[Block]:
    """Appendix with the text and the checksums of the meshes; left out where the scene did not come from a file."""
    text, bars = findings.study.text, findings.study.train.bars
    if not text:
        return
    folder, diagrams = Path(findings.study.file).parent, diagram_files(findings.study)
    files = dict.fromkeys(bar.section.file for bar in bars if isinstance(bar.section, SectionMesh))
    meshes = _sums((file, Path(file)) for file in files) + _sums((name, folder / name) for name in diagrams)
    what = listed([word for word, some in (("meshes", files), ("indicator diagrams", diagrams)) if some])
    also = f" and the {what} that it names{meshes}." if meshes else "."
    study = findings.study
    behind = " (of this text and of its tables behind it)" if study.tables else ""
    words = f"{study.file or 'Input'}, SHA-256 {checksum(study)}{behind}. The whole report was computed from this text"
    words += ", its tables" if study.tables and meshes else " and its tables" if study.tables else ""
    yield Heading("Appendix: the input as read")
    yield Paragraph(words + also)
    yield Verbatim(text)
    for name, table_text in study.tables:
        yield Paragraph(f"Table {name}, SHA-256 {hashlib.sha256(table_text.encode()).hexdigest()}:")
        yield Verbatim(table_text)


def _sums(files: Iterable[tuple[str, Path]]) -> str:
    """The checksum of every file behind its name."""
    return "".join(f"; {name}, SHA-256 {hashlib.sha256(file.read_bytes()).hexdigest()}" for name, file in files)
