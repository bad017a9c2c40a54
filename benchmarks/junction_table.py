"""Computes the table of junctions: `python -m benchmarks.junction_table` writes it in a minute or two."""

from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np

from torsion.assembly.junction.axisymmetric import Solved, solved
from torsion.assembly.junction.profile import Corner, junction
from torsion.kernels import junction_table
from torsion.kernels.junction_table import (
    FILE,
    HIGHEST,
    LOWEST,
    NODES,
    SIZES,
    JunctionTable,
    _smooth,
)

FINE = 2e-6  # gap of the bounds of every value
BETWEEN = 300  # places between those of the table at which it is compared with the elements


def of_step(bore: float, height: float, share: float, fine: float = FINE) -> Solved:
    """Two shafts of one bore; bore and height of the step / diameter, radius of its fillet / height."""
    corner = Corner("fillet", share * height) if share else None
    return solved(junction((1.0, bore), (1.0 + 2.0 * height, bore), corner), fine)


def places() -> list[np.ndarray]:
    """Of bore, height and radius: where the table has values."""
    low, high = _smooth(LOWEST), _smooth(HIGHEST)
    bore, height, fillet = (
        a + (b - a) * (1.0 + nodes) / 2.0 for a, b, nodes in zip(low, high, NODES, strict=True)
    )
    return [bore, np.exp(height), fillet**1.5]


def computed() -> JunctionTable:
    """The table, with its error at places between its own."""
    steps = [of_step(*map(float, sizes)) for sizes in product(*places())]
    table = JunctionTable(np.array([step.excess_length for step in steps]).reshape(SIZES), 0.0)
    return replace(
        table, error=float(max(errors_between(table, BETWEEN)) + max(step.error for step in steps))
    )


def errors_between(table: JunctionTable, number: int, seed: int = 1) -> list[float]:
    """Differences from the elements at places drawn over the whole table."""
    random, low, high = np.random.default_rng(seed), np.array(LOWEST), np.array(HIGHEST)
    low[1], high[1] = np.log(low[1]), np.log(high[1])
    errors = []
    for bore, height, share in random.uniform(low, high, (number, 3)):
        sizes = float(bore), float(np.exp(height)), float(share)
        tabled = table.excess_length(sizes[0], sizes[1], sizes[1] * sizes[2])
        errors.append(abs((tabled or 0.0) - of_step(*sizes).excess_length))
    return errors


def main() -> None:
    """Writes the file of the package."""
    table = computed()
    rows = [
        " ".join(f"{value:.6f}" for value in row) for row in table.values.reshape(-1, SIZES[-1])
    ]
    text = "\n".join([f"{table.error:.1e}", *rows]) + "\n"
    Path(junction_table.__file__).with_name(FILE).write_text(text, encoding="utf-8")
    print(f"{len(rows) * SIZES[-1]} values, error {table.error:.1e}")


if __name__ == "__main__":
    main()
