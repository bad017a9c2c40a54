"""The model of the shafts, `analyses: model`, and the settings of its finite elements."""

from typing import Literal, cast

from torsion.analyses import MODELS
from torsion.errors import Fault, Path
from torsion.schema.faults import nearest
from torsion.schema.messages import declared, shown
from torsion.study import FiniteElements

Model = Literal["lumped", "fem", "exact"]
MODEL_KEYS = ("model", "fem")  # of the section `analyses`


def model_of(section: object, faults: list[Fault]) -> tuple[Model, FiniteElements]:
    """The model and its division into finite elements; the lumped model where the section does not say one."""
    if not isinstance(section, dict):
        return "lumped", FiniteElements()
    model = _model(section["model"], ("analyses", "model"), faults) if "model" in section else "lumped"
    if "fem" not in section:
        return model or "lumped", FiniteElements()
    path: Path = ("analyses", "fem")
    fem = declared(FiniteElements, section["fem"], path, faults) or FiniteElements()
    if model not in (None, "fem"):
        message = f"`fem` divides the shafts of the model fem, and the model is {model}"
        faults.append(Fault(path, message, "write `model: fem` too, or leave `fem` out", at_key=True))
    return model or "lumped", fem


def _model(value: object, path: Path, faults: list[Fault]) -> Model | None:
    """The model, or None with its fault noted."""
    if value in MODELS:
        return cast(Model, value)
    near = nearest(value, list(MODELS)) if isinstance(value, str) else None
    hint = f"did you mean '{near}'?" if near else f"there is {', '.join(MODELS)}"
    faults.append(Fault(path, f"{shown(value)} is no model", hint))
    return None
