"""The verdicts on stability: nothing may grow at any speed of the operation, of the train or of a bending shaft.

What was not looked at of the operation is not passed.
"""

from collections.abc import Iterable, Sequence
from dataclasses import replace
from operator import attrgetter

import numpy as np

from torsion.analyses.lateral.shaft_bending import Lateral
from torsion.analyses.lateral.tilt_stability import TiltRange
from torsion.analyses.law_slopes import mean_speed_slopes
from torsion.analyses.stability.mean_speed import SLOW
from torsion.analyses.stability.stability_over_speed import Stability
from torsion.analyses.stability.unstable_ranges import UnstableRange
from torsion.arrays import FloatArray
from torsion.findings import Results
from torsion.model.machine_torques import DriveLaw
from torsion.rules.class_rules.barred_time import barred_times, words
from torsion.rules.demands import distinct, with_reach
from torsion.rules.rule_over_speed import within
from torsion.rules.verdict_line import BarredRange, Check, Rule, RuleSettings, Verdict
from torsion.study import Operation, Study

NOTHING_DAMPS = "nothing in the train damps, so that a growth of 0 is the best there is"
WHOLE = "whole train"
GROWS = "within an unstable range, where it grows"
MOST = 4  # ranges without an answer that are stated one by one
_RPM = 30.0 / np.pi
ROUNDING = 1e-9  # of a logarithmic decrement, and of speeds relative to themselves
NO_SLOPE = 1e-9  # N m s/rad: less is none
NOT_DISTINGUISHED = "a drift of the mean speed and an instability were not distinguished"
PART = "only a part of the operation's speeds was looked at"


class StableMotion(Rule[RuleSettings]):
    """The rule on whatever stability was computed."""

    def judge(self, evidence: Results) -> Iterable[Check]:
        """Return the checks on the torsion of the whole train."""
        stability, study = evidence.need(Stability), evidence.study
        line, laws = stability_check(stability, study.operation), drive_laws(study)
        ranges = (BarredRange(band.first, band.last, band.at, WHOLE) for band in stability.ranges)
        times = barred_times(evidence, tuple(ranges))
        # Slopes of drive and load that do not damp torsional vibration.
        by_key = dict[str, list[str]]()
        for name, key in mean_speed_slopes(study).items():
            by_key.setdefault(key, []).append(f"'{name}'")
        slopes = (
            f"slope of {', '.join(names)} without `{key}`: it acts on the mean speed only"
            for key, names in by_key.items()
        )
        stated = mean_speed_words(stability, study)
        remarks = line.note, words(times, GROWS), "; ".join(slopes), stated
        lines = [replace(line, note="; ".join(filter(None, remarks)), times=times)]
        if laws and not any(law.law == "speed" for law in laws):
            lines.append(mean_speed_check(stability, study))
        return distinct(row for check in lines for row in with_reach(check, study))


def drive_laws(study: Study) -> list[DriveLaw]:
    """Return the laws of drive that the file states."""
    machines = [part.machine for part in study.train.parts if part.machine is not None]
    return [machine.drive for machine in machines if machine.drive is not None]


def mean_speed_check(stability: Stability, study: Study) -> Check:
    """Return the largest drift of the mean speed against 0, where the law of the drive is stated.

    Where a steep slope or a long lag leaves no slow exponent, every exponent is in the row on stability.
    """
    inside = within(study.operation.speeds, stability.speed) & np.isfinite(stability.growth)
    drifts = np.full(len(stability.speed), np.nan) if stability.drift is None else stability.drift
    rates = np.where(inside & np.isfinite(drifts), drifts, -np.inf)
    first, last, is_whole = _operated(stability.speed, study.operation)
    drifting = [drift for drift in stability.drifts if drift.first <= last and drift.last >= first]
    growth, speed, notes = float(rates.max()), float(stability.speed[rates.argmax()]), list[str]()
    for drift in drifting:
        growth, speed = max(growth, drift.growth), min(max(drift.at, first), last)
        notes.append(
            f"a further slope of {drift.slope:.3g} N m s/rad at '{drift.machine}' stops it"
        )
    if not is_whole:
        notes.append(PART)
    # A drift slower than that is within the error of the growth rates.
    kept = is_whole and not drifting and bool(inside.any()) and growth <= SLOW
    if is_doubtful := _is_doubtful(stability, first, last):
        notes.append(NOT_DISTINGUISHED)
    elif growth == -np.inf and inside.any():
        notes.append("the mean speed has no slow exponent of its own at any speed")
    about = "mean speed", WHOLE, "Growth of the mean speed"
    line = _check(about, growth, "1/s", speed, notes, kept=kept, is_open=is_doubtful)
    return replace(line, value=np.nan, speed=None) if growth == -np.inf else line


def mean_speed_words(stability: Stability, study: Study) -> str:
    """Return what is said of a drift of the mean speed; empty where there is none."""
    if not stability.drifts:
        return ""
    drift, laws = stability.drifts[0], drive_laws(study)
    rpm = [f"{speed * _RPM:.4g}" for speed in (drift.at, drift.first, drift.last)]
    doubles = f"doubles in {np.log(2.0) / drift.growth:.2g} s"
    stated = f"Mean speed drifts: {drift.growth:.3g} 1/s at {rpm[0]} rpm ({doubles})"
    if any(law.law == "speed" for law in laws):
        return f"{stated} without its controller; kept by the controller"
    why = f"the slopes of drive and load, together {drift.given:.3g} N m s/rad at '{drift.machine}', are too small"
    if abs(drift.given) <= NO_SLOPE:
        why = "the torques of drive and load do not depend on speed"
    reach = (
        f"faster than {SLOW:g} 1/s from {rpm[1]} to {rpm[2]} rpm, slower or not at all elsewhere"
    )
    words = f"{stated}, as {why}; {reach}"
    if not np.isfinite(drift.slope):
        return f"{words}. No slope was found that removes it. State `drive`."
    further = "further slope" if abs(drift.given) > NO_SLOPE else "slope"
    slip = (
        f" (its slip of 1 % has {drift.slip:.3g})" if np.isfinite(drift.slip) and not laws else ""
    )
    state = "" if laws else " State `drive`."
    return f"{words}. A {further} of {drift.slope:.3g} N m s/rad at '{drift.machine}' removes it{slip}.{state}"


def stability_check(stability: Stability, operation: Operation) -> Check:
    """Return the largest growth rate within the operation's speeds (else those requested) against 0.

    It fails also where a speed has no periodic motion to be stable about, or part of the operation was not looked at.
    """
    first, last, is_whole = _operated(stability.speed, operation)
    unstable = [band for band in stability.ranges if band.meets(first, last)]
    growth, speed = _fastest(stability.speed, stability.growth, unstable, operation)
    # What lies between speeds without a periodic motion and their neighbours that have one.
    unsolved = stability.unsolved
    met = [(max(low, first), min(high, last)) for low, high in stability.unknown]
    bare = [
        (low, high)
        for low, high in met
        if low < high or ((unsolved >= low) & (unsolved <= high)).any()
    ]
    if not unstable and (bare or growth == -np.inf):
        missing = unsolved[(unsolved >= first) & (unsolved <= last)]
        growth, speed = np.inf, float(np.append(missing, first)[0])
    notes = list[str]()
    if bare:  # nothing is known there
        where = ", ".join(f"{low * _RPM:.5g} to {high * _RPM:.5g}" for low, high in bare[:MOST])
        further = f", the first {MOST} of {len(bare)} ranges" if len(bare) > MOST else ""
        missed = f"and so nothing is known, from {where} rpm{further}"
        notes.append(f"no periodic motion was found, {missed}")
        if np.isnan(stability.growth).all():
            tried = f"at any of the {stability.growth.size} speeds tried"
            notes = [f"no periodic motion was found {tried}"]
    if not is_whole:
        notes.append("stability was not requested at all speeds of the operation")
    if not stability.loses:
        notes.append(NOTHING_DAMPS)
    # The distance of the operation from the unstable ranges outside it.
    outside = [band for band in stability.ranges if not band.meets(first, last)]
    if below := [band.unknown[1] or band.last for band in outside if band.last <= first]:
        share = f"{100.0 * (1.0 - max(below) / first):.3g} %"
        notes.append(f"the next unstable range ends {share} below the lowest speed")
    if above := [band.unknown[0] or band.first for band in outside if band.first >= last]:
        share = f"{100.0 * (min(above) / last - 1.0):.3g} %"
        notes.append(f"the next unstable range begins {share} above the highest speed")
    if stability.doubtful is not None and stability.doubtful.size:
        notes.append(NOT_DISTINGUISHED)
    kept = is_whole and not (unstable or bare)
    about, is_open = (
        ("stability", WHOLE, "Growth of small vibrations"),
        _is_doubtful(stability, first, last),
    )
    return _check(about, growth, "1/s", speed, notes, kept=kept, is_open=is_open)


def _is_doubtful(stability: Stability, first: float, last: float) -> bool:
    """Return whether an exponent was not distinguished within speeds (rad/s), or between them and the next speed."""
    if stability.doubtful is None:
        return False
    places = np.flatnonzero(np.isin(stability.speed, stability.doubtful))
    below, above = np.maximum(places - 1, 0), np.minimum(places + 1, len(stability.speed) - 1)
    return bool(((stability.speed[below] <= last) & (stability.speed[above] >= first)).any())


def _check(
    about: tuple[str, str, str],
    value: float,
    unit: str,
    speed: float,
    notes: list[str],
    *,
    kept: bool,
    is_open: bool = False,
) -> Check:
    """A verdict against the limit 0, which holds by the definition of stability; NOT JUDGED if it is kept but open.

    about: clause, component and what is compared. It is open where an exponent is neither a drift nor torsional for sure.
    """
    met: Verdict = "not judged" if is_open else "pass"
    verdict, note = met if kept else "fail", "; ".join(notes)
    return Check("stability", *about, value, 0.0, unit, verdict, "by definition", speed, note=note)


class StableBending(Rule[RuleSettings]):
    """The rule on whatever bending was computed."""

    def judge(self, evidence: Results) -> Iterable[Check]:
        """Return the checks on every shaft that bends."""
        checks = bending_checks(evidence.need(Lateral), evidence.study.operation)
        return distinct(row for line in checks for row in with_reach(line, evidence.study))


def bending_checks(bending: Lateral, operation: Operation) -> tuple[Check, ...]:
    """Return one for the whirl and one for the tilting of every shaft whose speeds are known."""
    checks = list[Check]()
    for shaft in bending.shafts:
        whirl, tilting = shaft.whirl, shaft.tilting
        # The least logarithmic decrement within the operation against 0.
        if whirl is not None and np.isfinite(whirl.log_decrement).any():
            _, _, is_whole = _operated(whirl.speed, operation)
            inside = within(operation.speeds, whirl.speed)[:, None]
            is_known = inside & np.isfinite(whirl.log_decrement)
            decrements = np.where(is_known, whirl.log_decrement, np.inf).min(axis=1)
            row = int(decrements.argmin())
            value, speed = float(decrements[row]), float(whirl.speed[row])
            notes = [] if is_whole else [PART]
            if abs(value) <= ROUNDING:
                value = 0.0
                notes.insert(0, "nothing damps it")
            kept, what = (
                is_whole and 0 <= value < np.inf,
                "Damping of the whirl (logarithmic decrement)",
            )
            check = _check(("whirl", shaft.name, what), value, "", speed, notes, kept=kept)
            checks.append(replace(check, at_least=True, parts=shaft.parts))
        # The fastest growth of the tilt within the operation against 0.
        if tilting is not None:
            first, last, is_whole = _operated(tilting.speed, operation)
            unstable = [zone for zone in tilting.zones if zone.meets(first, last)]
            growth, speed = _fastest(tilting.speed, tilting.growth, unstable, operation)
            notes = (
                []
                if min(tilting.shaft.damping) > 0.0
                else ["its supports do not damp it in both directions"]
            )
            notes += [] if is_whole else [PART]
            has_all = bool(np.isfinite([growth, *tilting.growth]).all())
            kept, what = (
                is_whole and not unstable and has_all,
                f"Growth of the tilt by the couple of {tilting.joint}",
            )
            check = _check(("tilting", shaft.name, what), growth, "1/s", speed, notes, kept=kept)
            checks.append(replace(check, parts=shaft.parts))
    return tuple(checks)


def _operated(speed: FloatArray, operation: Operation) -> tuple[float, float, bool]:
    """The speeds of the operation, else all that were looked at, and whether all of them were."""
    if operation.speeds is None:
        return float(speed[0]), float(speed[-1]), True
    first, last = operation.speeds.first, operation.speeds.last
    is_whole = speed[0] <= first * (1 + ROUNDING) and speed[-1] >= last * (1 - ROUNDING)
    return first, last, bool(is_whole)


def _fastest(
    speed: FloatArray,
    growth: FloatArray,
    unstable: Sequence[UnstableRange | TiltRange],
    operation: Operation,
) -> tuple[float, float]:
    """The fastest growth within the operation and its speed; at most 0 without an unstable range.

    A range may lie between the speeds, or grow fastest beyond the operation.
    """
    first, last, _ = _operated(speed, operation)
    rates = np.where(within(operation.speeds, speed) & np.isfinite(growth), growth, -np.inf)
    row = int(rates.argmax())
    fastest, at_speed = float(rates[row]), float(speed[row])
    for band in sorted(unstable, key=attrgetter("growth"), reverse=True):
        if band.growth > fastest and (first <= band.at <= last or fastest <= 0):
            fastest, at_speed = band.growth, min(max(band.at, first), last)
    return fastest if unstable else min(fastest, 0.0), at_speed
