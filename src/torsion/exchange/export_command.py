"""The command `torsion export`."""

import math
from fractions import Fraction
from pathlib import Path

from torsion.analyses.discretisation import assembled
from torsion.errors import Fault, InputError, refusal
from torsion.exchange.modelica import modelica
from torsion.exchange.state_space import state_space, write_state_space
from torsion.runner import one_case
from torsion.schema.scene_reader import located, read
from torsion.user_files import printable

FORMS = ".mo (Modelica), .npz (Python) or .mat (MATLAB)"


def export(
    file: Path,
    out: Path,
    *,
    rpm: float | None = None,
    order: str | None = None,
    at: float | None = None,
    inputs: str = "",
    outputs: str = "",
    case: str | None = None,
) -> str:
    """Write a train to `out`, in the form of its suffix; return what was written in words. Raises InputError."""
    form = out.suffix.lower()
    if form not in (".mo", ".npz", ".mat"):
        raise refusal(
            f"'{printable(str(out))}' has no known form", f"write a name with the suffix {FORMS}"
        )
    given = (
        {"--order": order}
        if form != ".mo"
        else {"--at": at, "--inputs": inputs, "--outputs": outputs}
    )
    if unused := [option for option, value in given.items() if value]:
        raise refusal(f"{' and '.join(unused)} cannot be used for {form}")
    if not all(math.isfinite(value) and value > 0 for value in (rpm, at) if value is not None):
        raise refusal("--rpm and --at are positive numbers")

    try:
        exact = None if order is None else Fraction(order)
    except (ValueError, ZeroDivisionError):
        message = f"--order {printable(order or '')} is not an order"
        raise refusal(message, "--order 2, or --order 1/2") from None

    study = one_case(read(file), case)
    speed = study.operation.speed or 0.0 if rpm is None else rpm * math.pi / 30.0
    try:
        system = assembled(study)
        if form == ".mo":
            if not speed:
                raise InputError(
                    [Fault(("operation",), "the speed of the vibration is not known", "--rpm 1500")]
                )
            out.write_text(modelica(study, system, speed, exact), encoding="utf-8")
        else:
            loss_at = None if at is None else 2.0 * math.pi * at
            stations = [
                [name.strip() for name in names.split(",") if name.strip()]
                for names in (inputs, outputs)
            ]
            model = state_space(
                study, system, speed=speed, inputs=stations[0], outputs=stations[1], loss_at=loss_at
            )
            write_state_space(model, out)
    except InputError as error:
        if any(fault.path for fault in error.faults):
            raise located(error, study) from None
        reasons = (
            f"{fault.message} ({fault.hint})" if fault.hint else fault.message
            for fault in error.faults
        )
        raise refusal("\n".join(f"{file}: {reason}" for reason in reasons)) from None
    except OSError as error:
        raise refusal(f"{printable(str(out))} cannot be written: {error.strerror}") from None
    return f"{'Modelica model' if form == '.mo' else 'State space'}: {printable(str(out))}"
