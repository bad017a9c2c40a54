"""A line of six cross joints at a million angles: `python -m benchmarks.joints` writes reports/joints.md in a minute.

The time is that of one core; some of the angles are composed again in 40 digits.
"""

import statistics
from collections.abc import Iterator
from time import process_time

import numpy as np
from mpmath import mp, mpf

from benchmarks.page_file import Report, verdict
from torsion.kernels.joints.cross import Transfer
from torsion.kernels.joints.line import Line, line_of, motion

ANGLES, JOINTS, TARGET = 1_000_000, 6, 2.0  # the last in s
CHECKED = 200  # angles composed again
WHAT = f"""\
Angle, speed and acceleration downstream of each of six cross joints (5 to 89 degrees, planes and phases random) at
{ANGLES} driving angles in one call. An angle of up to 100 rad is stored to 1.4e-14 rad by double precision;
steep joints magnify that."""


def main() -> None:
    """Measures, prints the page and writes it."""
    report = Report(__doc__, "joints", calls=7)
    random = np.random.default_rng(6)
    plane = np.append(0.0, random.uniform(-np.pi, np.pi, JOINTS - 1))
    line = line_of(
        np.radians([5.0, 25.0, 45.0, 60.0, 75.0, 89.0]),
        plane,
        random.uniform(-np.pi, np.pi, JOINTS),
    )
    driving = random.uniform(-100.0, 100.0, ANGLES)
    times = []
    for _ in range(report.chosen.calls):
        start = process_time()
        found = motion(driving, line)
        times.append(process_time() - start)
    errors = _errors(driving[:CHECKED], line, found)
    report.publish(
        "A million angles of a line of six joints", [WHAT, "\n".join(_lines(times, errors))]
    )


def _errors(driving: np.ndarray, line: Line, found: Transfer) -> dict[str, float]:
    """Worst error of what stands after the last joint, against the same composition in 40 digits."""
    worst = {"angle, rad": 0.0, "speed, relative": 0.0}
    with mp.workdps(40):
        for place, turned in enumerate(driving.tolist()):
            lead, rate, offset = mpf(0), mpf(1), mpf(0)
            for rank in range(JOINTS):
                phase, plane = (mpf(float(values[rank])) for values in (line.phase, line.plane))
                offset += phase - plane + (mp.pi / 2 if rank else 0)
                yoke, angle = mpf(turned) + lead + offset, mpf(float(line.angle[rank]))
                share = mp.tan(angle / 2) ** 2
                ratio = (1 - share**2) / (1 - 2 * share * mp.cos(2 * yoke) + share**2)
                lead, rate = lead - mp.arg(1 - share * mp.expj(2 * yoke)), rate * ratio
            worst["angle, rad"] = max(
                worst["angle, rad"], float(abs(found.error[-1][place] - lead))
            )
            gap = float(abs(found.ratio[-1][place] / rate - 1))
            worst["speed, relative"] = max(worst["speed, relative"], gap)
    return worst


def _lines(times: list[float], errors: dict[str, float]) -> Iterator[str]:
    middle = statistics.median(times)
    yield (
        f"- time of one core: best {min(times):.2f} s, median {middle:.2f} s of {len(times)} calls; meant < "
        f"{TARGET:g} s: {verdict(middle < TARGET)}"
    )
    for what, size in errors.items():
        yield f"- worst error of {CHECKED} angles after the last joint, {what}: {size:.1e}"


if __name__ == "__main__":
    main()
