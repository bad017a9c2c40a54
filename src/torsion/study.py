"""What is to be computed: the train, how it is operated, which analyses and which rules."""

import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pkgutil import resolve_name
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

import numpy as np
from pydantic import AfterValidator, BeforeValidator, Field

from torsion import fields
from torsion.arrays import FloatArray
from torsion.errors import Fault, refusal
from torsion.fields import Declared, OneOrMany, Quantity, Sized, given, needs, refuse, required
from torsion.model.machine_torques import Load
from torsion.results import RPM, Displayed, listed, one_line
from torsion.train import Train
from torsion.user_files import without_controls

ModalRatio = Annotated[float, Quantity("1", at_least=0, below=1, usual="damping ratio")]
MEMORY = 2e9  # bytes that a response may need where nothing else is said


class Range(Declared):
    """Values from one to another, evenly spaced."""

    if TYPE_CHECKING:
        first: float
        last: float
        steps: int

    def refuse_clashes(self) -> None:
        if self.first >= self.last:
            raise refuse(
                "`from` is not below `to`", "a range runs from the lower to the higher value", "to"
            )

    def values(self) -> FloatArray:
        """Return (steps,) values in the unit of both ends."""
        return np.linspace(self.first, self.last, self.steps)


class SpeedRange(Range):
    """Speeds (rad/s) of the component `at`."""

    first: fields.Speed = required("lowest speed", alias="from")
    last: fields.Speed = required("highest speed", alias="to")
    steps: Annotated[int, Field(ge=2, le=1_000_000)] = given("number of speeds", 201)


class FrequencyRange(Range):
    """Frequencies (Hz)."""

    first: fields.Frequency = required("lowest frequency", alias="from")
    last: fields.Frequency = required("highest frequency", alias="to")
    steps: Annotated[int, Field(ge=2, le=10_000_000)] = given("number of frequencies", 1000)


class Rated(Declared):
    """The rated point, at the component `at`."""

    speed: fields.Speed = required("rated speed")
    power: fields.Power | None = given("rated power")


class Operation(Sized):
    """How the train is run; speeds and power are those of the component `at`."""

    clashes = (needs("by", "highest", hint="highest: 100 rpm"),)

    at: str | None = given("the component whose speed is meant (default: the first)")
    speeds: SpeedRange | None = given("speed range")
    rated: Rated | None = given("rated speed and power")
    highest: fields.Speed | None = given(
        "highest speed that the train can run at; rules demand none above it"
    )
    by: str | None = given("what keeps `highest`: governor", examples=["governor"])
    load: Load = given(
        "law of loads that have no `load`: propeller or quadratic (T ~ n**2), linear, constant, constant-power, "
        "{exponent, at_rest}; or the mean torque, [[speed, torque], ...]",
        "propeller",
        validate_default=True,
    )

    def refuse_clashes(self) -> None:
        last = 0.0 if self.speeds is None else self.speeds.last
        if self.highest is not None and last > self.highest * (1 + 1e-9):
            message = "`highest` is below the last of `speeds`"
            raise refuse(message, "let `speeds` end at it", "highest")

    @property
    def speed(self) -> float | None:
        """rad/s at which damping that depends on speed is taken: rated, else the highest; None where none is given."""
        if self.rated is not None:
            return self.rated.speed
        return None if self.speeds is None else self.speeds.last


class ModalDamping(Declared):
    """Damping by mode, in place of that of the components."""

    modal: Annotated[tuple[ModalRatio, ...], OneOrMany, Field(min_length=1, max_length=10_000)] = (
        required(
            "damping ratio of every elastic mode, or a list by mode whose last value holds for all above: [1 %, 2 %]"
        )
    )


class FiniteElements(Declared):
    """How finely the model `fem` takes every shaft."""

    degree: Annotated[int, Field(ge=1, le=10)] | None = given(
        "degree of the elements (default: 4, or what the number of elements needs)"
    )
    elements: Annotated[int, Field(ge=1, le=19_999)] | None = given(
        "elements of every shaft (default: as many as needed)"
    )


class Several(Declared):
    """The settings of an analysis that the file names more than once, in a list."""

    each: tuple[Any, ...]


class ShaftModel(Declared):
    """The model of the shafts, in `analyses`."""

    model: Literal["lumped", "fem", "exact"] = given("the model of the shafts", "lumped")
    fem: FiniteElements | None = given("{degree, elements} of the model fem")

    def refuse_clashes(self) -> None:
        if self.fem is not None and self.model != "fem":
            message = f"`fem` sets the elements of the model fem, and the model is {self.model}"
            raise refuse(message, "write `model: fem` too, or leave `fem` out", "fem")


def _one_line(value: str) -> str:
    if not value.strip():
        raise refuse("the text is empty", "a few words")
    if not value.isprintable():
        raise refuse("the text is not on one line", "a few words")
    return value


def _imo_number(value: Any) -> str:
    """Return seven digits, the last of which is that of 7 a + 6 b + 5 c + 4 d + 3 e + 2 f (IMO resolution A.1117(30))."""
    digits = re.sub(r"^IMO *", "", value.strip()) if isinstance(value, str) else str(value)
    if type(value) not in (int, str) or not re.fullmatch("[0-9]{7}", digits) or not int(digits):
        raise refuse(f"{fields.shown(value)} is no IMO number", "seven decimal digits, as 9074729")
    total = sum(weight * int(digit) for weight, digit in zip(range(7, 1, -1), digits, strict=False))
    if total % 10 != int(digits[6]):
        rule = f"the last digit checks the others, and after {digits[:6]} it is {total % 10}"
        hint = "compare it with the register: a digit is wrong, or two are in each other's place"
        raise refuse(f"{digits} is not an IMO number: {rule}", hint)
    return digits


Words = Annotated[str, Field(max_length=100), AfterValidator(_one_line)]
Label = Annotated[str, Field(max_length=50), AfterValidator(_one_line)]
ImoNumber = Annotated[
    str, BeforeValidator(_imo_number, int | Annotated[str, Field(pattern="^(IMO *)?[0-9]{7}$")])
]


class FrontMatter(Declared):
    """What the cover and the running head of a submission say; all of it is optional."""

    vessel: Words | None = given("name of the vessel, or of the plant", examples=["Example Star"])
    yard: Words | None = given(
        "yard and number of the building", examples=["Example Yard, hull 123"]
    )
    imo_number: ImoNumber | None = given(
        "IMO number of the vessel; its check digit is checked", examples=[9074729]
    )
    society: Words | None = given(
        "the classification society that it is submitted to", examples=["Lloyd's Register"]
    )
    document_number: Label | None = given(
        "number of the document, on every page", examples=["TVC-0123"]
    )
    revision: Label | None = given("its revision, on every page", examples=["B"])
    prepared: Words | None = given(
        "who prepared it, next to a line for the signature", examples=["A. Engineer"]
    )
    checked: Words | None = given("who checked it", examples=["B. Engineer"])
    approved: Words | None = given("who approved it", examples=["C. Engineer"])
    logo: str | None = given(
        "picture on the cover: a PNG or JPEG file of at most 300 kB, its path from the folder of this file",
        examples=["logo.png"],
    )


@dataclass(frozen=True)
class Change:
    """One thing that a case changes, in words: what, its value without the case, and with it."""

    what: str
    before: str
    after: str


@dataclass(frozen=True)
class Case:
    """What makes a study the case of another one."""

    name: str
    changes: tuple[Change, ...]
    is_judged: bool = True  # it counts for the verdict over all cases
    is_corner: bool = False  # its couplings are at an end of their tolerances
    source: Any = field(
        default=None, repr=False, compare=False
    )  # the values of the file, changed, with their places

    @property
    def has_own_speeds(self) -> bool:
        """It changes the range of speeds: it is meant for no others."""
        return any(change.what.startswith("operation.speeds") for change in self.changes)

    @property
    def folder(self) -> str:
        """The folder of its report, in that of the others."""
        return case_folder(self.name)


@dataclass(frozen=True)
class CaseStates:
    """States that a judged case of a file has, of those that rules demand, each with its component, and its rules."""

    states: frozenset[tuple[str, str]]
    rules: tuple[str, ...]


MOST_AT_ZERO_PITCH = (
    0.4  # of the normal load, at every speed: what a case at zero pitch absorbs (ours; about 0.2)
)


def case_folder(name: str) -> str:
    """Return the name of a case as that of a folder.

    >>> case_folder("zero pitch, 50 %")
    'zero-pitch-50'
    """
    return re.sub(r"[^\w+]+", "-", name).strip("-") or "case"


class Variation:
    """Figures of a file that vary, and the studies of other values, as the reader of files makes them.

    `torsion.schema.variants.variation.Variation` says what each function answers.
    """

    figures: Sequence[
        Any
    ]  # `torsion.schema.variants.varied_figures.Figure`: name, law, column, values
    base: "Study"  # whose figures vary
    study: "Callable[[Sequence[float]], Study]"
    stated: Callable[[int, float], tuple[str, str]]
    text: Callable[..., str]
    in_case: "Callable[[Study], Variation]"
    in_columns: Callable[[FloatArray], Train]
    studies: "Callable[[FloatArray], Callable[[int], Study]]"
    behind: "Callable[[Any], Variation]"


@dataclass(frozen=True, repr=False)
class Study(Displayed):
    """A scene: everything that a file says."""

    name: str
    train: Train
    description: str = ""
    operation: Operation = field(default_factory=Operation)
    model: Literal["lumped", "fem", "exact"] = "lumped"
    fem: FiniteElements = field(default_factory=FiniteElements)
    analyses: Mapping[str, Declared] = field(
        default_factory=dict
    )  # settings of every analysis that is named
    rules: tuple[tuple[str, Declared], ...] = ()  # (rule, its settings)
    file: str = ""
    text: str = ""  # the file as read
    tables: tuple[tuple[str, str], ...] = ()  # the tables that it names: file, text as read
    memory: float = MEMORY  # bytes that a response may need
    document: FrontMatter | None = None
    logo: str = ""  # its picture as a data URI
    variations: "Mapping[str, Variation]" = field(
        default_factory=dict, repr=False, compare=False
    )  # by the analysis
    case: Case | None = None  # which one of another study it is
    changes: tuple[Change, ...] = ()  # of `with_`, from the file as it was
    cases: "Mapping[str, Study]" = field(default_factory=dict)  # by name, what is solved beside it
    case_states: tuple[
        CaseStates, ...
    ] = ()  # of the normal and every judged case of its file, which a case and a variant know too

    def __repr__(self) -> str:
        words, speeds = [f"{len(self.train.parts)} components"], self.operation.speeds
        if speeds is not None:
            words.append(f"{speeds.first * RPM:.5g} to {speeds.last * RPM:.5g} rpm")
        if self.cases:
            words.append(f"cases {listed(self.cases, most=3)}")
        return one_line(f"Study '{self.name}': {', '.join(words)}")

    @property
    def reference(self) -> str:
        """Name of the component whose speed is the speed axis."""
        return self.operation.at or self.train.parts[0].name

    @property
    def shown_file(self) -> str:
        """The name of its file for texts: a name may hold control characters and need not be UTF-8."""
        return without_controls(self.file)

    @property
    def has_supports(self) -> bool:
        """A shaft has a `support`: its bending is computed."""
        return any(self.train.shaft(bar).support for bar in self.train.bars)

    def covers(self, state: str, rule: str, name: str = "") -> bool:
        """Return whether a judged case of the file, under that rule, has a state (of a component) that rules demand."""
        return any((state, name) in case.states and rule in case.rules for case in self.case_states)

    def engines_with(self, *states: str) -> list[str]:
        """Return the engines with a cylinder in a state; `misfire: worst` has each of its cylinders motored."""
        return [
            part.name
            for part in self.train.parts
            if (engine := part.engine) is not None
            and (
                (engine.tries_all and "motored" in states)
                or any(cylinder.state in states for cylinder in engine.cylinders)
            )
        ]

    @property
    def varies_tolerances(self) -> bool:
        """It, or a case of it, has the couplings at an end of their tolerances."""
        return any(
            study.case is not None and study.case.is_corner
            for study in (self, *self.cases.values())
        )

    @property
    def has_mean_torque(self) -> bool:
        """The file says enough for a mean torque."""
        return states_mean_torque(self.train, self.operation)

    @property
    def has_tolerances(self) -> bool:
        """A stiffness or an inertia has a tolerance, and couplings are not at an end of theirs."""
        if self.case is not None and self.case.is_corner:
            return False
        return any(part.stiffness_tolerance or part.inertia_tolerance for part in self.train.parts)

    @property
    def has_joints(self) -> bool:
        """A universal joint stands in the train."""
        return any(part.joint for part in self.train.parts)

    def setting(self, *place: str) -> Any:
        """Return what the file states at a place of `operation` or `analyses`; None if it states nothing."""
        value: Any = self
        for key in place:
            value = value.get(key) if isinstance(value, Mapping) else getattr(value, key, None)
        return value

    @property
    def excites(self) -> bool:
        """Something in the train excites it by order, or at a frequency of its own."""
        train = self.train
        return bool(train.periodic_torques) or any(mesh.error for mesh in train.constraints)

    # What a study does from Python; each action is the function of the package, named so that no floor is passed.

    @cached_property
    def system(self) -> Any:
        """The train as assembled, in the model of the file."""
        return resolve_name("torsion.analyses.discretisation:assembled")(self)

    def modes(self, count: int = 6) -> Any:
        """Return the lowest `count` elastic modes."""
        return resolve_name("torsion.analyses.undamped_modes:modes")(self.system, count)

    def response(self) -> Any:
        """Return the response over the speed range of the file."""
        return resolve_name("torsion.analyses.response.over_speed:response")(self, self.system)

    def critical_rpm(self, order: float, count: int = 6) -> list[float]:
        """Return the speeds of the reference, rpm, at which an order meets the lowest modes."""
        return [60.0 * hertz / float(order) for hertz in self.modes(count).frequency.tolist()]

    def run(self) -> Any:
        """Return the findings of everything that the file requests."""
        return resolve_name("torsion.runner:run")(self)

    def with_(
        self,
        changes: Mapping[str, Any] | None = None,
        *,
        factor: Mapping[str, Any] | None = None,
        remove: Sequence[str] = (),
        **values: Any,
    ) -> Self:
        """Return the study with other values, by the paths of `cases: set`, times factors, without components.

        The result has the changed text; its cases are left out. Raises InputError as a case of the file does.
        """
        vary = resolve_name("torsion.schema.builder:vary")
        varied: Self = vary(self, {**(changes or {}), **values}, factor or {}, remove)
        return varied


def states_mean_torque(train: Train, operation: Operation) -> bool:
    """Return whether a rated power, a table of the load, or the power of a load is given."""
    if operation.load.table or (operation.rated is not None and operation.rated.power is not None):
        return True
    machines = (part.machine for part in train.parts if part.machine is not None)
    return any(machine.is_stated for machine in machines if not machine.is_driver)


def mesh_faults(study: Study, what: str) -> list[Fault]:
    """Return the faults of excitations at meshes, which `what` does not support."""
    hint = "leave it out here; a case may take it away: `remove`"
    message = f"{what} does not support an excitation at a mesh"
    meshes = (torque for torque in study.train.torques if torque.mesh is not None)
    return [Fault(torque.path, message, hint) for torque in meshes]


def bytes_of(memory: str | float) -> float:
    """Return the bytes of a number, or of text such as "4 GB"; raise InputError."""
    value = memory
    if isinstance(memory, str):
        match = re.fullmatch(r"\s*(\d+(?:\.\d+)?)\s*([kMGT]?)B\s*", memory)
        if match is None:
            raise refusal(f"'{memory}' is not an amount of memory", "for example 4GB or 500MB")
        value = float(match[1]) * 1000.0 ** " kMGT".index(match[2] or " ")
    if not 0.0 < float(value) < math.inf:
        raise refusal(f"{memory} is not an amount of memory")
    return float(value)
