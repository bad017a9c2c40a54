"""What the file says of a design: what may be chosen, what is aimed at, and what is to be kept."""

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, Literal

from pydantic import Field, WithJsonSchema

from torsion.errors import Fault, Refusal
from torsion.fields import Declared, Quantity, excludes, given, refuse, required, shown
from torsion.study import Study
from torsion.what_if.variants.laws import Amount, Choice

MODE = re.compile(r"mode-([1-9][0-9]{0,2})\.frequency")
MOST = 10_000_000  # values of a grid
SUBJECTS = "`mode-2.frequency`, `mass` or `cost`"
AIM = {
    "anyOf": [
        {"const": "margin"},
        {"type": "object", "additionalProperties": {"type": ["number", "string"]}},
    ]
}


@dataclass(frozen=True)
class Subject:
    """What is aimed at or kept: the frequency of a mode (Hz), the mass (kg) or the cost."""

    name: str
    mode: int = 0  # from 1; 0: none


@dataclass(frozen=True)
class Kept:
    """A condition: the value lies within `low` and `high`, or, where `is_outside`, not between them."""

    subject: Subject
    low: float
    high: float
    is_outside: bool
    words: str


class Condition(Declared):
    """What a value of a design has to keep."""

    clashes = (excludes("outside", "below", "above"),)

    outside: tuple[Amount, Amount] | None = given("[from, to]: not between these")
    below: Amount | None = given("greatest value")
    above: Amount | None = given("least value")


class DesignSettings(Declared):
    """What the file states of `design`: variables, objective and constraints."""

    choose: Annotated[dict[str, Choice], Field(min_length=1)] = required(
        "design variables by `component.key` with their values: `from` and `to`, or `values`; for a component a "
        "`catalogue`"
    )
    aim: Annotated[Any, WithJsonSchema(AIM)] = given(
        "margin: maximise the smallest margin to the limits of all checks; or {mode-2.frequency: 40 Hz}",
        "margin",
    )
    keep: tuple[dict[str, Condition], ...] = given(
        f"what the choice has to keep, of {SUBJECTS}: {{outside: [30 Hz, 36 Hz]}}, `below`, `above`",
        (),
    )
    against: Literal["mass", "cost"] | None = given(
        "what the best of every mass, or cost, is reported for"
    )
    robust: bool = given("true: by the worst of samples of `sweep`", False)
    evaluations: Annotated[int, Field(ge=20, le=MOST)] | None = given(
        "most trains of the search (default: 2000 that are judged, or all combinations of lists and steps up to 50000 "
        "choices; 50000 with a frequency as aim)"
    )
    seed: Annotated[int, Field(ge=0)] = given(
        "of the search; the same seed gives the same choice", 1
    )

    def refuse_clashes(self) -> None:
        """Words and units of the aim and the conditions."""
        _ = self.target, self.kept

    @property
    def varied(self) -> tuple[str, Mapping[str, Choice]]:
        """The key that names the figures, and what each may be."""
        return "choose", self.choose

    @property
    def target(self) -> tuple[Subject, float] | None:
        """The mode and the frequency (Hz) that are aimed at; None for the margin."""
        if self.aim == "margin":
            return None
        if not isinstance(self.aim, dict) or len(self.aim) != 1:
            raise refuse(
                f"{shown(self.aim)} is no aim", "margin, or {mode-2.frequency: 40 Hz}", "aim"
            )
        ((words, value),) = self.aim.items()
        subject = _subject(words, ("aim", words))
        if not subject.mode:
            raise refuse(
                f"`{words}` is no aim",
                "`against` reports the best for every mass or cost",
                ("aim", words),
            )
        return subject, _read(value, subject, ("aim", words))

    @property
    def kept(self) -> tuple[Kept, ...]:
        """Every condition that a candidate has to meet, with its ends in SI."""
        kept = list[Kept]()
        listed = (
            (("keep", position, words), words, condition)
            for position, conditions in enumerate(self.keep)
            for words, condition in conditions.items()
        )
        for path, words, condition in listed:
            subject = _subject(words, path)
            low, high, pair, limits = 0.0, math.inf, condition.outside, list[str]()
            if pair is not None:
                ends = (*path, "outside")
                low, high = (_read(value, subject, (*ends, k)) for k, value in enumerate(pair))
                limits = [f"outside {pair[0]} to {pair[1]}"]
            if condition.above is not None:
                low = _read(condition.above, subject, (*path, "above"))
                limits.append(f"above {condition.above}")
            if condition.below is not None:
                high = _read(condition.below, subject, (*path, "below"))
                limits.append(f"below {condition.below}")
            if not limits:
                message = f"nothing says what `{words}` keeps"
                raise refuse(message, "`outside`, `below` or `above`", path)
            if low >= high:
                message = f"the lower end of `{words}` is not below the upper one"
                raise refuse(message, "exchange them", path)
            limit = f"{words} {' and '.join(limits)}"
            kept.append(Kept(subject, low, high, pair is not None, limit))
        return tuple(kept)

    def refused(self, study: Study, figures: Sequence[Any]) -> Iterator[Fault]:
        """What the file lacks for them."""
        if self.target is None and not study.rules:
            hint = "name `rules`, or aim at {mode-2.frequency: 40 Hz}"
            yield Fault(("aim",), "`aim: margin` has no limit: the file has no rules", hint)
        if self.robust and "sweep" not in study.analyses:
            hint = "`sweep: {vary: {coupling-1.stiffness: {uniform: +-15 %}}}`"
            yield Fault(
                ("robust",),
                "`robust` is at the worst of `sweep`, which the file does not name",
                hint,
            )
        # Values that the sweep puts in the place of what is chosen.
        sweep = study.analyses.get("sweep") if self.robust else None
        varied: Mapping[str, Choice] = getattr(sweep, "varied", ("", {}))[1]
        for name, law in varied.items():
            pairs = [sorted([f"{name}.", f"{figure.name}."]) for figure in figures]
            if not law.is_relative and any(long.startswith(short) for short, long in pairs):
                words = f"`sweep` puts values in the place of `{name}`, which the design chooses"
                yield Fault(("robust",), words, "vary it about the chosen value: {uniform: +-15 %}")
        places = [figure.places for figure in figures]
        if all(places) and math.prod(places) > MOST:
            words = f"{math.prod(places):,} combinations, more than {MOST:,}"
            yield Fault(("choose",), words, "longer steps or shorter lists", at_key=True)
        chosen: dict[Any, str] = {}
        for figure in figures:
            for path in sorted({*figure.all_paths}, key=str):
                if chosen.setdefault(path, figure.name) != figure.name:
                    words = f"`{path[-1]}` is chosen by `{chosen[path]}` already"
                    hint = "leave one of them out"
                    yield Fault(("choose", figure.name), words, hint, at_key=True)
                    break

        # A mass or cost that a catalogue does not state.
        stated = [(key, ("keep", k)) for k, kept in enumerate(self.keep) for key in kept]
        listed = [figure for figure in figures if figure.law.catalogue is not None]
        for key, place in [(self.against or "", ("against",)), *stated]:
            if key not in ("mass", "cost"):
                continue
            lacking = [
                figure.law.catalogue
                for figure in listed
                if any(key not in row.amounts for row in figure.rows)
            ]
            if lacking:
                words = f"{lacking[0]} has no column `{key}`"
                yield Fault(place, words, "every catalogue states it", at_key=True)
            elif key == "cost" and not listed:
                hint = "a catalogue with a column `cost`"
                yield Fault(place, "no catalogue states a cost", hint, at_key=True)


def _subject(words: str, path: tuple[str | int, ...]) -> Subject:
    mode = MODE.fullmatch(words)
    if mode is None and words not in ("mass", "cost"):
        raise refuse(
            f"`{words}` is none of {SUBJECTS}",
            "modes are counted from 1, the lowest elastic one",
            path,
        )
    return Subject(words, int(mode[1]) if mode else 0)


def _read(value: object, subject: Subject, path: tuple[str | int, ...]) -> float:
    unit = "Hz" if subject.mode else "kg" if subject.name == "mass" else "1"
    try:
        return Quantity(unit, above=0).read(value)
    except Refusal as fault:
        raise refuse(fault.message, fault.hint, path) from None
