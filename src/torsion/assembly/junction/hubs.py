"""The twist of a shaft in a hub on its end, as a length of it: bonded by finite elements, keyed in closed form."""

from dataclasses import replace
from functools import lru_cache
from typing import Literal

from torsion.errors import Fault
from torsion.model.shafts.shaft_details import Hub
from torsion.primitives import Bar
from torsion.train import Train

MOST_WITH_HUBS = 0.95  # of its twist that hubs and fillets together may take
THIRD = (
    1.0 / 3.0
)  # of the seat, of a torque that is handed over evenly: the energy of T (1 - z/L); handbooks' rule


def with_hubs(
    train: Train, shorter: dict[str, float], faults: list[Fault]
) -> tuple[Train, dict[str, float]]:
    """The train with remarks on its hubs; and what fillets (`shorter`, m by shaft) and hubs take from its lengths."""
    saved = dict(shorter)
    for bar in train.bars:
        record = train.parts[bar.part].shaft
        for hub in record.hubs if record is not None else ():
            left, error = seat_length(train, bar, hub)
            source = "of a torque that is handed over evenly"
            if error is not None:
                material = f" of {hub.material}" if hub.material else ""
                source = f"by finite elements{material} without slip, within {1e3 * error:.1g} mm"
            seat = f"its seat of {1e3 * hub.length:g} mm in the hub at its {hub.end} end twists as {1e3 * left:.4g} mm"
            remark = (
                f"{seat} of it (a model: {source}; handbooks: {1e3 * THIRD * hub.length:.4g} mm)"
            )
            train = with_remark(train, bar.part, remark)
            saved[bar.name] = saved.get(bar.name, 0.0) + hub.length - left
        if saved.get(bar.name, 0.0) > MOST_WITH_HUBS * bar.length:
            message = f"hubs and fillets take up the complete twist of '{bar.name}'"
            path = train.parts[bar.part].path
            faults.append(Fault(path, message, "join it with the adjacent shaft"))
            del saved[bar.name]
    return train, saved


def with_remark(train: Train, part: int, remark: str) -> Train:
    """Return the train with one more remark on a part."""
    parts, before = list(train.parts), train.parts[part].remark
    parts[part] = replace(parts[part], remark=f"{before}; {remark}" if before else remark)
    return replace(train, parts=tuple(parts))


def seat_length(train: Train, bar: Bar, hub: Hub) -> tuple[float, float | None]:
    """m of the shaft, which twists as much as its seat and the hub; and its error (m), None by formula."""
    if hub.diameter is None:
        return THIRD * hub.length, None
    unit, material = bar.outer[0], train.shaft(bar).material
    modulus = (
        train.materials[hub.material or material].shear_modulus
        / train.materials[material].shear_modulus
    )
    length, error = bonded(
        hub.length / unit, hub.diameter / unit, bar.bore[0] / unit, hub.torque, modulus
    )
    return unit * length, unit * error


@lru_cache(maxsize=256)
def bonded(
    length: float, hub: float, bore: float, torque: Literal["rim", "face"], modulus: float = 1.0
) -> tuple[float, float]:
    """Length of shaft that twists as a seat in a bonded hub and the hub itself, and its error; all in diameters.

    modulus: shear modulus of the hub / that of the shaft.

    >>> length, error = bonded(1.0, 1.8, 0.0, "rim")
    >>> round(length, 3), error < 2e-5
    (0.151, True)
    """
    from torsion.assembly.junction.axisymmetric import solved
    from torsion.assembly.junction.profile import REACH, Length, Profile

    free = Length(REACH * (1.0 - bore) / 2.0, (1.0, 1.0), (bore, bore))
    seat = Length(length, (hub, hub), (bore, bore), modulus)
    solution = solved(Profile((free, seat), (None,), torque))
    return solution.excess_length, solution.error
