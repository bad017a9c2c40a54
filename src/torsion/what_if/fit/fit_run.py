"""A fit: the figures of a file, each with what is known of it beforehand, that agree best with measurements."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from torsion.analyses.undamped_modes import Modes
from torsion.arrays import FloatArray
from torsion.errors import Fault, InputError
from torsion.findings import Progress, Work
from torsion.kernels.fitting import FARTHEST, Fitted, fitted, identified
from torsion.results import listed
from torsion.what_if.fit.fit_results import (
    MOST_CHI2,
    OUTSIDE,
    Fit,
    FittedCurve,
    FittedFigure,
    FittedMode,
    OtherFit,
)
from torsion.what_if.fit.fit_settings import FIT, FitSettings
from torsion.what_if.fit.identified import directions, unidentified
from torsion.what_if.fit.measurements import curves, unit
from torsion.what_if.fit.pairing import highest_mode, paired
from torsion.what_if.fit.predictions import Train, resolved_for

NINETY_FIVE = 1.959963984540054  # deviations of a normal distribution
FAR = 2.0  # deviations that a figure may move without a remark
CURVE_POINTS = 201
USUAL_STEPS = 10  # of a search, of which there is one and two for each figure
DIGITS = 7  # of a factor in the fitted file
SHOWN = 4  # of one in words


def run(work: Work) -> None:
    """Where the file was read with figures that vary; the fitted file is solved the ordinary way too."""
    settings, variation = work.settings("fit", FitSettings), work.study.variations.get("fit")
    if variation is None or work.solve is None:
        work.log.without("fit", "no parameter of the file varies")
        return
    with work.log.step("fit to measurements", "the file names it") as step:
        made = curves(work.study, settings.measured)
        modes = work.get(Modes)
        count = highest_mode(settings.measured, 0 if modes is None else modes.frequency.size)
        system = work.system.whole if modes is None else modes.system.whole
        train = Train(variation, resolved_for(system, made), made, count)
        problem = Problem(train, settings, work.progress)
        found = problem.fitted()
        deviation = problem.deviation
        values = [float(f"{value:.{DIGITS}g}") for value in np.exp(found.values * deviation)]
        solved = work.solve(variation.study(values), only=("modes",)).get(Modes)
        frequency = np.empty(0) if solved is None else solved.frequency
        step.method = "least squares of logarithms (Gauss-Newton in a trust region), with what is known beforehand"
        sizes = f"{len(deviation)} figures, {problem.sigma.size} measured values"
        step.size = f"{sizes}, {found.searches} starts, {found.steps} steps"
    work.put(fit=_result(problem, found, values, frequency))


class Problem:
    """Residuals of the measurements in their deviations, over figures in deviations of what is known of them."""

    def __init__(self, train: Train, settings: FitSettings, progress: Progress) -> None:
        self.train, self.settings, self.progress, self.steps = train, settings, progress, 0
        self.deviation = np.array([one.law.lognormal for one in train.variation.figures])
        self.pairs = pairs = paired(train, self.deviation, settings.measured)
        measured, within = [], list[FloatArray]()
        for place in pairs.place:
            one = settings.measured[place]
            measured.append(np.log([one.frequency or 1.0]))
            within.append(np.array([one.within]))
        for curve in train.curves:
            logs = np.log(curve.amplitude)
            measured += [logs.real, logs.imag] if curve.has_phase else [logs.real]
            within += [curve.deviation] * (1 + curve.has_phase)
        self.measured, self.sigma = np.concatenate(measured), np.concatenate(within)
        if len(self.deviation) > self.sigma.size:
            were = "value was" if self.sigma.size == 1 else "values were"
            message = (
                f"{len(self.deviation)} parameters vary, and {self.sigma.size} {were} measured"
            )
            raise InputError(
                [Fault((*FIT, "vary"), message, "vary fewer, or give more measurements")]
            )

    def fitted(self) -> Fitted:
        """The least sum of squares."""
        return fitted(self.residual, self.jacobian, len(self.deviation), self.swapped)

    def residual(self, values: FloatArray) -> FloatArray:
        """(measurements,) of figures (figures,)."""
        logs = self.train.logarithms(np.exp(values * self.deviation).tolist(), self.pairs.number)
        return self.train.wrapped(logs - self.measured, len(self.pairs.number)) / self.sigma

    def swapped(self, values: FloatArray) -> Iterator[FloatArray]:
        """Figures (figures,) as near as can be at which a measured mode and a neighbour swap frequencies, by slopes."""
        frequency = (
            self.train.frequencies(np.exp(values * self.deviation).tolist())
            if self.pairs.number
            else ()
        )
        lower = sorted({number - below for number in self.pairs.number for below in (0, 1)})
        for mode in (one for one in lower if 0 <= one < len(frequency) - 1):
            rise = (
                self.train.mode_slopes(values * self.deviation, [mode, mode + 1]) * self.deviation
            )
            gap = float(np.log(frequency[mode + 1] / frequency[mode]))
            start = np.linalg.lstsq(rise, rise @ values + np.array([gap, -gap]), rcond=1e-3)[0]
            if (np.abs(start) < FARTHEST).all():
                yield start

    def jacobian(self, values: FloatArray) -> FloatArray:
        """(measurements, figures)."""
        self.steps += 1
        self.progress(
            f"fit to measurements, step {self.steps}",
            min(self.steps / (USUAL_STEPS * (1 + 2 * len(values))), 0.99),
        )
        slopes = self.train.slopes(values * self.deviation, self.pairs.number)
        return np.asarray(slopes * self.deviation / self.sigma[:, None])


def _result(problem: Problem, found: Fitted, values: Sequence[float], frequency: FloatArray) -> Fit:
    """All that is stated; values: factors as they stand in the fitted file."""
    known, train, count = found.known, problem.train, problem.sigma.size
    each = np.sqrt(np.diag(known.covariance))
    figures = tuple(_figures(problem, found, each, values))
    made = Fit(
        figures,
        tuple(_modes(problem, found, values)),
        tuple(_curves(problem, found, values)),
        directions(known, [one.name for one in figures], problem.deviation),
        known.covariance / np.outer(each, each),
        count,
        float(np.square(found.residual).sum()),
        count - identified(found.jacobian).used,
        float(np.square(found.values).sum()),
        known.rank,
        found.steps,
        found.searches,
        tuple(_others(problem, found)),
        (),
        frequency,
        train.variation.text(values),
    )
    return replace(made, warnings=tuple(_warnings(made, found)))


def _figures(
    problem: Problem, found: Fitted, each: FloatArray, values: Sequence[float]
) -> Iterator[FittedFigure]:
    variation, logs = problem.train.variation, found.values * problem.deviation
    lower, upper = (np.exp(end * problem.deviation) for end in found.interval(NINETY_FIVE))
    for place, one in enumerate(variation.figures):
        given, fitted_value = variation.stated(place, values[place])
        yield FittedFigure(
            one.name,
            given,
            fitted_value,
            float(np.exp(logs[place])),
            float(problem.deviation[place]),
            float(each[place] * problem.deviation[place]),
            float(lower[place]),
            float(upper[place]),
            float(found.values[place]),
            max(float(1.0 - each[place] ** 2), 0.0),
        )


def _others(problem: Problem, found: Fitted) -> Iterator[OtherFit]:
    variation = problem.train.variation
    for other in found.others:
        factors = np.exp(other.values * problem.deviation)
        values = (
            variation.stated(place, float(f"{factor:.{SHOWN}g}"))[1]
            for place, factor in enumerate(factors)
        )
        words = listed(
            [f"{one.name} {value}" for one, value in zip(variation.figures, values, strict=True)]
        )
        chi2, prior = (float(np.square(one).sum()) for one in (other.residual, other.values))
        yield OtherFit(factors, chi2, prior, words)


def _modes(problem: Problem, found: Fitted, values: Sequence[float]) -> Iterator[FittedMode]:
    pairs, measured = problem.pairs, problem.settings.measured
    if not pairs.place:
        return
    before, after = (problem.train.modes(one).frequency for one in ([1.0] * len(values), values))
    for row, (place, number) in enumerate(zip(pairs.place, pairs.number, strict=True)):
        one, lower, upper = measured[place], float(pairs.lower[row]), float(pairs.upper[row])
        hertz, slack = one.frequency or 0.0, np.exp(OUTSIDE * one.within)
        yield FittedMode(
            number + 1,
            one.mode is not None,
            hertz,
            one.within,
            lower,
            upper,
            float(before[number]),
            float(after[number]),
            float(found.residual[row]),
            bool(not lower / slack <= hertz <= upper * slack),
        )


def _curves(problem: Problem, found: Fitted, values: Sequence[float]) -> Iterator[FittedCurve]:
    train, place, plain = problem.train, len(problem.pairs.place), [1.0] * len(values)
    for curve in train.curves:
        size = curve.speed.size
        fine = np.union1d(np.linspace(curve.speed[0], curve.speed[-1], CURVE_POINTS), curve.speed)
        own = found.residual[place : place + size]
        place += size
        phase = found.residual[place : place + size] if curve.has_phase else None
        place += size if curve.has_phase else 0
        before, after, drawn, fitted_curve = (
            np.abs(train.amplitudes(factors, curve, speed))
            for speed in (curve.speed, fine)
            for factors in (plain, values)
        )
        yield FittedCurve(
            curve.at,
            curve.order,
            curve.quantity,
            unit(curve),
            curve.origin,
            curve.within,
            curve.deviation,
            curve.speed,
            np.abs(curve.amplitude),
            before,
            after,
            own,
            phase,
            fine,
            drawn,
            fitted_curve,
            curve.unused,
        )


def _warnings(made: Fit, found: Fitted) -> Iterator[str]:
    """What does not go together, the gravest first."""
    for one in made.modes:
        if one.is_outside:
            side = "below" if one.measured < one.lower else "above"
            yield (
                f"The measured {one.measured:.6g} Hz of mode {one.mode} lies {side} the band of that mode, "
                f"{one.lower:.6g} to {one.upper:.6g} Hz with every parameter within two deviations. The mode is "
                "another one, the measurement is wrong, or the model lacks something."
            )
    if made.is_wrong:
        share, each = made.reduced, "degree of freedom"
        if share is None:
            share, each = made.chi2 / made.measurements, "measured value"
        yield (
            f"Chi2 is {share:.3g} for each {each}, above {MOST_CHI2:g}: of {made.searches} searches none found "
            "values that explain the measurements as exactly as `within` requires. The model lacks something, a "
            "measured frequency is of another mode, or `within` is stated too small; the deviations and intervals "
            "do not hold."
        )
    if made.others:
        other, rest = made.others[0], len(made.others) - 1
        more = other.chi2 + other.prior_chi2 - made.chi2 - made.prior_chi2
        yield (
            f"Other values agree nearly as well: {other.words} (sum of squares greater by "
            f"{max(more, 0.0):.2g}){f', and {rest} more' if rest else ''}. The measurements do not decide between "
            "them; intervals, deviations and what is known reach over all of them."
        )
    for figure in made.figures:
        if abs(figure.shift) > FARTHEST - 1e-6:
            yield f"{figure.name} went to the end of what is tried, {figure.shift:+.2g} of its deviations beforehand."
        elif abs(figure.shift) > FAR:
            yield f"{figure.name} moved by {figure.shift:+.2g} of its deviations beforehand: more than was expected."
    if not found.converged:
        yield f"After {found.steps} steps the sum of squares still falls: the figures are not the best ones."
    yield from unidentified(made.directions, only_frequencies=not made.curves)
