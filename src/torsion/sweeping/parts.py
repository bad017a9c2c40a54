"""A chunk of a sweep as a Parquet file with a row for each variant, and its checksum."""

import io
import json
import os
from collections.abc import Mapping
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np

from torsion.errors import Fault, InputError
from torsion.study import Variation
from torsion.what_if.variants.chunks import Chunk, Part
from torsion.what_if.variants.one_by_one import Answers

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
            table[f"{figure.name} label"] = np.array(
                [figure.words(value) for value in column.tolist()]
            )
    about["modes"] = [f"mode {mode} (Hz)" for mode in range(1, 1 + len(answers.frequency))]
    table |= dict(zip(about["modes"], answers.frequency, strict=True))
    about["checks"] = []
    for key, (used, fails) in answers.checks.items():
        name = ", ".join(filter(None, key))
        about["checks"].append([*key, name])
        table[f"{name}: utilisation"], table[f"{name}: fails"] = used, fails
    table["fault"] = np.array([answers.faults.get(variant, "") for variant in range(chunk.size)])
    return table, about


def part_of(columns_of_part: Columns, about: Mapping[str, Any]) -> Part:
    """What the columns of a part hold, to the last bit as they were written."""
    values = np.stack([columns_of_part[name] for name in about["figures"]], axis=1)
    frequency = (
        np.stack([columns_of_part[name] for name in about["modes"]])
        if about["modes"]
        else np.empty((0, len(values)))
    )
    checks = {
        (rule, clause, where, what): (
            columns_of_part[f"{name}: utilisation"],
            columns_of_part[f"{name}: fails"],
        )
        for rule, clause, where, what, name in about["checks"]
    }
    faults = {
        variant: str(why) for variant, why in enumerate(columns_of_part["fault"].tolist()) if why
    }
    return values, Answers(frequency, checks, faults, about["method"])


def write_part(path: Path, columns_of_part: Columns, about: Mapping[str, Any]) -> str:
    """Write the columns so that the file is there whole or not at all; return its SHA-256."""
    import pyarrow
    from pyarrow import parquet

    table = pyarrow.table({name: pyarrow.array(column) for name, column in columns_of_part.items()})
    content = io.BytesIO()
    parquet.write_table(
        table.replace_schema_metadata({ABOUT: json.dumps(about)}), content, write_page_checksum=True
    )
    under_way = path.with_name(f"{path.name}.part")
    with under_way.open("wb") as file:
        file.write(content.getbuffer())
        file.flush()
        os.fsync(file.fileno())
    under_way.replace(path)
    return sha256(content.getbuffer()).hexdigest()


def read_part(path: Path, checksum: str) -> tuple[Columns, dict[str, Any]]:
    """Return the columns of a file and what they hold; raises InputError if a bit differs from what was written."""
    from pyarrow import ArrowException, parquet

    try:
        content = path.read_bytes()
        if sha256(content).hexdigest() != checksum:
            raise ValueError(
                "it is damaged: its SHA-256 differs from the SHA-256 of the file that was written"
            )
        table = parquet.read_table(io.BytesIO(content), page_checksum_verification=True)
        about = json.loads(table.schema.metadata[ABOUT.encode()])
        return {name: table[name].to_numpy() for name in table.column_names}, about
    except (ArrowException, OSError, ValueError, KeyError, TypeError) as error:
        message = f"{path} cannot be read as a part of a sweep: {error}"
        raise InputError(
            [Fault((), message)], f"{message} (remove it; it is then solved again)"
        ) from None
