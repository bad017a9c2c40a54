"""What holds for every scene of shafting_specs: laws of a scene by its name."""

import math
import re
import tempfile
from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from jsonschema import Draft202012Validator
from tests.contracts.frozen import SCENES, reported, solved, terminal

from torsion.analyses.joints.joint_lines import Joints
from torsion.analyses.motion.transient_motion import Transients
from torsion.analyses.response.amplitudes import FrequencyResponse, Response, Synthesis
from torsion.analyses.undamped_modes import Modes
from torsion.kernels.trees.tree_response import Status
from torsion.output.figures.figure import Figure
from torsion.output.files.data_tables import report_tables as archive
from torsion.output.pages.html import html
from torsion.output.pages.pdf import source
from torsion.output.report_figures import csv_of
from torsion.output.stored.stored_report import opened, rendered
from torsion.rules.verdict_line import Checks
from torsion.schema.json_schema import json_schema
from torsion.schema.yaml_source import parse_source

TABLE = (Path(__file__).parents[2] / "shafting_specs" / "README.md").read_text(encoding="utf-8")
HERTZ = {"Hz": 1.0, "rad/s": 1.0 / (2.0 * math.pi), "/min": 1.0 / 60.0}
HEAVIEST = 2_000_000  # bytes of a page, of whatever scene and all of its cases


@cache
def validator() -> Draft202012Validator:
    """Return the validator of every scene."""
    return Draft202012Validator(json_schema())


def is_valid_against_the_json_schema(scene: str) -> None:
    data = parse_source(SCENES[scene].read_text(encoding="utf-8"), SCENES[scene].name).data
    assert [error.message for error in validator().iter_errors(data)] == []


def every_frequency_is_certified_and_inside_its_bounds(scene: str) -> None:
    modes = solved(scene).get(Modes)
    if modes is None:
        assert not np.any(solved(scene).system.inertia > 0), "joints alone"
        return
    assert modes.certified
    assert modes.frequency.size > 0
    assert np.all((modes.lower <= modes.frequency) & (modes.frequency <= modes.upper))
    assert np.all(modes.upper - modes.lower <= 1e-11 * modes.frequency)
    for share in (modes.kinetic, modes.elastic):
        np.testing.assert_allclose(share.sum(axis=0), 1.0, rtol=1e-13)


def the_table_of_scenes_says_what_is_computed(scene: str) -> None:
    row = re.search(rf"^\| `{scene}` \|.*\| (.*) (\S+) \|$", TABLE, re.MULTILINE)
    found = solved(scene)
    if row[2] == "deg":
        values = np.degrees([line.resultant for line in found.need(Joints).lines])
    else:
        values = found.need(Modes).frequency / HERTZ[row[2]]
    for text, value in zip(row[1].split(", "), values, strict=False):
        assert abs(value - float(text)) <= 0.5000001 * 10.0 ** -len(text.partition(".")[2])


def every_response_is_finite_with_a_status_and_a_small_residual(scene: str) -> None:
    found = solved(scene)
    for answer in (found.get(Response), found.get(FrequencyResponse)):
        if answer is None:
            continue
        assert answer.status.shape == answer.residual.shape
        sound = answer.status == Status.OK
        assert sound.mean() > 0.9
        assert np.all(np.isfinite(answer.torque[sound]))
        assert np.all(np.isfinite(answer.angle[sound]))
        assert np.all(answer.residual[sound] < 1e-10)
    if found.get(Response) is not None:
        assert np.all(found.need(Response).status == Status.OK), "these trains are damped"
        total = found.need(Synthesis)
        assert np.all(np.isfinite(total.half_range))
        assert np.all(total.half_range <= total.bound * (1 + 1e-12))
        assert np.all(total.rms <= total.bound)


def the_report_read_from_its_results_is_the_one_of_solve(scene: str) -> None:
    """To the last bit, of the same types: so whatever draws it, draws the same. And every renderer draws it."""
    made = reported(scene)
    with tempfile.TemporaryDirectory() as folder:
        rendered(made, solved(scene))(Path(folder) / "results.json")
        unlike = list(differences(opened(Path(folder)), made))
        assert not unlike, unlike[:5]
        source(made, Path(folder))
    assert len(html(made).encode()) < HEAVIEST
    assert terminal(made)
    archive(made)
    drawn = [item.block for item in made.body if isinstance(item.block, Figure)]
    for figure in {type(figure.panels[0]): figure for figure in drawn}.values():
        csv_of(figure)


def differences(read: Any, made: Any, place: str = "report") -> Iterator[str]:
    """Where two values differ in type or in any bit, but for what a report does not keep."""
    if type(read) is not type(made):
        yield f"{place}: {type(read)}, not {type(made)}"
    elif is_dataclass(made):
        for field in fields(made):
            if field.metadata.get("kept", True):
                pair = getattr(read, field.name), getattr(made, field.name)
                yield from differences(*pair, f"{place}.{field.name}")
    elif isinstance(made, np.ndarray):
        if (read.dtype, read.shape, read.tobytes()) != (made.dtype, made.shape, made.tobytes()):
            yield place
    elif isinstance(made, dict):
        yield from differences(list(read.items()), list(made.items()), place)
    elif isinstance(made, list | tuple) and len(read) == len(made):
        for number, pair in enumerate(zip(read, made, strict=True)):
            yield from differences(*pair, f"{place}[{number}]")
    elif repr(read) != repr(made):
        yield f"{place}: {read!r:.80}, not {made!r:.80}"


def every_motion_over_time_balances_its_energy_and_can_be_trusted(scene: str) -> None:
    found = solved(scene).get(Transients)
    for one in () if found is None else found.each:
        assert one.residual < 1e-10
        assert one.status == "ok"


def every_rule_of_the_scene_gives_a_verdict_on_a_finite_value(scene: str) -> None:
    found = solved(scene)
    requested = {name for name, _ in found.study.rules}
    requested |= {"stability" for name in found.study.analyses if name in ("stability", "lateral")}
    requested |= {"transient" for name in found.study.analyses if name == "transient"}
    assert requested == {check.rule for check in found.need(Checks).lines}
    for check in found.need(Checks).lines:
        has_value = check.clause not in (
            "zero pitch",
            "normal firing",
            "misfire",
            "tolerances",
            "variants",
            "orders",
            "resonance",
        )
        assert math.isfinite(check.value) == has_value
        assert not math.isnan(check.limit) or check.verdict in ("restricted", "not judged")
