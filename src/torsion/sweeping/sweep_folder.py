"""The folder of a sweep: what it is of, and the parts that are there; another sweep is never mixed into it."""

import csv
import io
import json
import math
import os
import re
import socket
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np

from torsion.errors import refusal
from torsion.findings import Work, version
from torsion.output.table_text import inert
from torsion.output.write import inputs
from torsion.study import Study, Variation
from torsion.user_files import LARGEST_SIGNAL, printable, read_file
from torsion.what_if.sweep.sweep_settings import SweepSettings
from torsion.what_if.variants.chunks import Answers, Chunk, Part

SUFFIX = ".parquet"
ABOUT = "torsion"  # key of what a part says of its columns, in JSON
Columns = Mapping[str, np.ndarray]  # (variants,) each


def columns(chunk: Chunk, variation: Variation, part: Part) -> tuple[Columns, dict[str, Any]]:
    """The columns of a part, and what they hold."""
    values, answers = part
    table: dict[str, np.ndarray] = {"variant": np.arange(chunk.begin, chunk.end)}
    about: dict[str, Any] = {
        "figures": [figure.name for figure in variation.figures],
        "method": answers.method,
    }
    for figure, column in zip(variation.figures, values.T, strict=True):
        table[figure.name] = column
        if figure.rows:
            table[f"{figure.name} label"] = np.array([*map(figure.words, column.tolist())])
    about["modes"] = [f"mode {mode} (Hz)" for mode in range(1, 1 + len(answers.frequency))]
    table |= dict(zip(about["modes"], answers.frequency, strict=True))
    about["checks"] = []
    for key, (used, fails) in answers.checks.items():
        name = ", ".join(filter(None, key))
        about["checks"].append([*key, name])
        table[f"{name}: utilisation"], table[f"{name}: fails"] = used, fails
    table["fault"] = np.array([answers.faults.get(variant, "") for variant in range(chunk.size)])
    return table, about


def read_part(path: Path, checksum: str) -> tuple[Columns, dict[str, Any]]:
    """Return the columns of a file and what they hold; raises InputError if a bit differs from what was written."""
    from pyarrow import ArrowException, parquet

    try:
        content = path.read_bytes()
        if sha256(content).hexdigest() != checksum:
            differs = "its SHA-256 differs from the SHA-256 of the file that was written"
            raise ValueError(f"it is damaged: {differs}")
        table = parquet.read_table(io.BytesIO(content), page_checksum_verification=True)
        about = json.loads(table.schema.metadata[ABOUT.encode()])
        return {name: table[name].to_numpy() for name in table.column_names}, about
    except (ArrowException, OSError, ValueError, KeyError, TypeError) as error:
        message = f"{path} cannot be read as a part of a sweep: {error}"
        raise refusal(message, "remove it; it is then solved again") from None


OF = "sweep.json"  # what the parts are of
SUMS = "SHA256SUMS"  # of the parts, beside them; `sha256sum -c` reads it
UNFINISHED = re.compile(r"part-\d{6}\.\w+\.part")
OWN = re.compile(r"part-\d{6}\.parquet")
ANEW = "--fresh to begin anew, or another folder with -o"
MOST_SAID = 4  # differences from another sweep
LIBRARIES = ("torsion", "numpy", "scipy")  # which may change the last bits of the answers


@dataclass(frozen=True)
class SweepFolder:
    """Where the parts of one sweep are."""

    folder: Path
    checksums: dict[str, str] = field(default_factory=dict)  # SHA-256 by the name of a part

    @property
    def parts(self) -> Path:
        """The folder in which the parts of the sweep are kept."""
        return self.folder / "parts"

    def open(self, identity: Mapping[str, Any], *, fresh: bool) -> None:
        """Begin the sweep, or go on with it; raises InputError where parts of another one are there.

        fresh: those are removed.
        """
        identity_file = self.folder / OF
        if fresh:
            identity_file.unlink(missing_ok=True)
            (self.parts / SUMS).unlink(missing_ok=True)
        self.parts.mkdir(parents=True, exist_ok=True)
        for path in self.parts.glob("part-*"):
            if UNFINISHED.fullmatch(path.name) or (fresh and OWN.fullmatch(path.name)):
                path.unlink()

        # A line of checksums that was never finished is ended.
        sums = self.parts / SUMS
        text = sums.read_text(encoding="utf-8", errors="replace") if sums.exists() else ""
        if text and not text.endswith("\n"):
            with sums.open("a", encoding="utf-8") as file:
                file.write("\n")
        lines = (line.partition("  ") for line in text.splitlines())
        self.checksums.update((name, checksum) for checksum, _, name in lines)
        if identity_file.exists():
            try:
                stored = json.loads(identity_file.read_text(encoding="utf-8"))
                differences = list(_differences(stored, json.loads(json.dumps(identity))))
                if not differences:
                    return
                further = len(differences) - MOST_SAID
                words = "; ".join(differences[:MOST_SAID])
                words += f"; and {further} more" if further > 0 else ""
            except (OSError, ValueError, KeyError, AttributeError, TypeError):
                words = "it cannot be read"
            raise refusal(f"{identity_file} is of another sweep: {words}", ANEW)
        if any(OWN.fullmatch(path.name) for path in self.parts.glob("part-*")):
            message = f"{self.parts} holds parts of a sweep, and {OF}, which identifies the sweep, is missing"
            raise refusal(message, ANEW)
        under_way = identity_file.with_name(f"{OF}.part")
        under_way.write_text(json.dumps(identity, indent=1), encoding="utf-8")
        under_way.replace(identity_file)

    def part_path(self, chunk: Chunk) -> Path | None:
        """Return the part of a chunk; None if it is missing or its checksum was never written."""
        path = self._path(chunk)
        return path if path.name in self.checksums and path.exists() else None

    def _path(self, chunk: Chunk) -> Path:
        return self.parts / f"part-{chunk.number:06d}{SUFFIX}"

    def write(self, chunk: Chunk, variation: Variation, part: Part) -> None:
        """Write the part of a chunk whole or not at all, and its checksum behind those of the others."""
        import pyarrow
        from pyarrow import parquet

        values, about = columns(chunk, variation, part)
        table = pyarrow.table({name: pyarrow.array(column) for name, column in values.items()})
        table = table.replace_schema_metadata({ABOUT: json.dumps(about)})
        content = io.BytesIO()
        parquet.write_table(table, content, write_page_checksum=True)
        path = self._path(chunk)
        under_way = path.with_name(f"{path.name}.part")
        with under_way.open("wb") as file:
            file.write(content.getbuffer())
            file.flush()
            os.fsync(file.fileno())
        under_way.replace(path)
        checksum = sha256(content.getbuffer()).hexdigest()
        with (self.parts / SUMS).open("a", encoding="utf-8") as sums:
            sums.write(f"{checksum}  {path.name}\n")
            sums.flush()
            os.fsync(sums.fileno())
        self.checksums[path.name] = checksum

    def read(self, chunk: Chunk) -> Part:
        """What a chunk answers, to the last bit; raises InputError where its part is missing or another's."""
        path = self.part_path(chunk)
        if path is None:
            message = f"the part {chunk.number} has disappeared from {self.parts}"
            raise refusal(message, "the same command solves it again")
        columns_read, about = read_part(path, self.checksums[path.name])
        if not np.array_equal(columns_read["variant"], np.arange(chunk.begin, chunk.end)):
            message = f"{path} does not hold the variants {chunk.begin} to {chunk.end - 1}"
            raise refusal(message, "remove it; it is then solved again")
        values = np.stack([columns_read[name] for name in about["figures"]], axis=1)
        checks = {
            (rule, clause, where, what): (
                columns_read[f"{name}: utilisation"],
                columns_read[f"{name}: fails"],
            )
            for rule, clause, where, what, name in about["checks"]
        }
        why = enumerate(columns_read["fault"].tolist())
        faults = {variant: str(words) for variant, words in why if words}
        hertz = np.array([columns_read[name] for name in about["modes"]], dtype=float)
        return values, Answers(hertz.reshape(-1, len(values)), checks, faults, about["method"])

    def write_csv(self, chunks: Sequence[Chunk]) -> Path:
        """Write all variants into one table, a part at a time; its path."""
        paths = [path for path in map(self.part_path, chunks) if path is not None]
        names: dict[str, None] = {}
        for path in paths:
            names |= dict.fromkeys(read_part(path, self.checksums[path.name])[0])
        target = self.folder / "variants.csv"
        under_way = target.with_name("variants.csv.part")
        with under_way.open("w", newline="", encoding="utf-8") as file:
            rows = csv.writer(file)
            rows.writerow(map(inert, names))
            for path in paths:
                # An empty cell where a number is not known or a column is not there.
                part, _ = read_part(path, self.checksums[path.name])
                unknown = np.full(len(part["variant"]), np.nan)
                cells = (map(_cell, part.get(name, unknown).tolist()) for name in names)
                rows.writerows(zip(*cells, strict=True))
        under_way.replace(target)
        return target


def _cell(value: Any) -> object:
    if isinstance(value, str):
        return inert(value)
    return "" if math.isnan(value) else value


def identity(work: Work, variation: Variation, chunks: Sequence[Chunk]) -> dict[str, Any]:
    """What a sweep is of: its files, settings and chunks, and the programs that solve it."""
    study, settings = work.study, work.settings("sweep", SweepSettings)
    return {
        "scene": Path(study.file).name,
        "case": "" if study.case is None else study.case.name,
        "files": digests(study),
        "settings": settings.model_dump(mode="json", exclude_defaults=True),
        "figures": [f"{figure.name} ({figure.law.words})" for figure in variation.figures],
        "variants": chunks[-1].end,
        "variants of a chunk": chunks[0].size,
        "versions": {name: version(name) for name in LIBRARIES},
    }


def digests(study: Study, *, shipped: bool = True) -> dict[str, str]:
    """SHA-256 of every file that a scene was read from: of the scene and its tables as they were read.

    Without the `shipped` ones: of those that variants read themselves, by their paths.
    """
    folder = Path(study.file).parent
    texts = {Path(study.file): study.text, **{folder / name: text for name, text in study.tables}}
    sums = {}
    for path in inputs(study):
        if path in texts and not shipped:
            continue
        content = texts[path].encode() if path in texts else read_file(path, LARGEST_SIGNAL)
        is_near = shipped and path.is_relative_to(folder)
        name = path.relative_to(folder).as_posix() if is_near else str(path)
        sums[name] = sha256(content).hexdigest()
    return sums


def _differences(
    stored: Mapping[str, Any], current: Mapping[str, Any], section: str = ""
) -> Iterator[str]:
    """Yield what differs, in words."""
    for key in dict.fromkeys((*stored, *current)):
        before, after = stored.get(key), current.get(key)
        if before == after:
            continue
        if isinstance(before, Mapping) and isinstance(after, Mapping):
            yield from _differences(before, after, key)
        elif section == "files":
            yield f"the file {key} was changed"
        else:
            pair = ("not given" if value is None else value for value in (before, after))
            old, new = (printable(str(value)) for value in pair)
            yield f"`{key}` was {old} and is {new}"


LOCK = "sweep.lock"


@contextmanager
def alone(folder: Path) -> Iterator[None]:
    """The folder for this process alone; raises InputError where another one is at work there.

    On Windows, which has no such lock, it is for the user to see to it.
    """
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / LOCK).open("a+", encoding="utf-8", errors="replace") as file:
        if os.name == "posix":
            import fcntl

            try:
                fcntl.lockf(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError:
                file.seek(0)
                message = f"{printable(file.read()) or 'another command'} is at work in {folder}"
                raise refusal(message, "wait for it, or choose another folder with -o") from None
        file.truncate(0)
        file.write(f"process {os.getpid()} on {socket.gethostname()}")
        file.flush()
        try:
            yield
        finally:
            (folder / LOCK).unlink(missing_ok=True)
