"""Appendix: the input as read."""

import hashlib
from pathlib import Path

from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, Verbatim
from torsion.output.scene import checksum
from torsion.primitives import SectionMesh


def chapter(findings: Findings) -> list[Block]:
    """Left out where the scene did not come from a file."""
    study = findings.study
    if not study.text:
        return []
    words = f"{study.file or 'Input'}, SHA-256 {checksum(study)}. The whole report was computed from this text"
    meshes = "".join(f"; {file}, SHA-256 {_of_file(file)}" for file in _meshes(findings))
    also = f" and the meshes that it names{meshes}." if meshes else "."
    return [Heading("Appendix: the input as read"), Paragraph(words + also), Verbatim(study.text)]


def _meshes(findings: Findings) -> list[str]:
    """The mesh files of the train, each once."""
    named = (bar.section.file for bar in findings.study.train.bars if isinstance(bar.section, SectionMesh))
    return list(dict.fromkeys(named))


def _of_file(file: str) -> str:
    return hashlib.sha256(Path(file).read_bytes()).hexdigest()
