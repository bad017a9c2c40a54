"""A study with other values: one unnamed case of its file, with the paths and faults of `cases`."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from torsion.errors import Fault, refusal
from torsion.schema.builder import plain_value
from torsion.schema.cases import CaseKeys, change_overlay, merge_changes
from torsion.schema.declaration_reader import declared
from torsion.schema.edited_text import edited
from torsion.schema.fault_text import input_error
from torsion.schema.overlay import Overlay
from torsion.schema.scene_reader import parse, reread
from torsion.schema.yaml_source import parse_source, yaml_text
from torsion.study import Study


def vary(
    study: Study, values: Mapping[str, Any], factors: Mapping[str, Any], removed: Sequence[str]
) -> Study:
    """Return the study of the changed text, without its cases; raises InputError. A value as it stands is no fault."""
    if not study.text:
        raise refusal(
            "the study was not read from a text, so that it has no keys to change", "torsion.build"
        )
    keys = {"set": plain_value(values), "scale": plain_value(factors), "remove": list(removed)}
    case = parse_source(yaml_text({key: value for key, value in keys.items() if value}), "with_")
    faults: list[Fault] = []
    stated = declared(CaseKeys, case.data, (), faults)
    if stated is None or faults:
        raise input_error(faults, case)

    source, _ = reread(study)
    overlay = Overlay(source, study.train.parts, study.reference, permits_no_change=True)
    change_overlay(stated, (), case.root, overlay)
    if overlay.faults:
        raise input_error(overlay.faults, case)
    overlay.removed["cases",] = None

    changes = [(path, node) for path, node, _ in overlay.puts]
    text = edited(source, changes, overlay.removed, overlay.applied().data)
    earlier = study.changes if study.case is None else study.case.changes
    changed = parse(text, study.file or "train.yaml")
    return replace(
        changed, changes=merge_changes((*earlier, *overlay.changes)), memory=study.memory
    )
