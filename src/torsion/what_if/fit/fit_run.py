"""A fit: the figures of a file, each with what is known of it beforehand, that agree best with measurements."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

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
    Direction,
    Fit,
    FittedCurve,
    FittedFigure,
    FittedMode,
    OtherFit,
)
from torsion.what_if.fit.fit_settings import FIT, UNITS, FitSettings, Measured
from torsion.what_if.fit.measurements import curves
from torsion.what_if.fit.predictions import Train, resolved_for

LEAST_PART = 0.05  # of the largest: smaller parts of a combination are not named
ALIKE = 0.02  # of each other: parts that are said as one
EXAMPLE = 1.0  # %, by which the first figure of a combination changes


def combination(change: FloatArray, names: Sequence[str]) -> str:
    """Changes (figures,) of logarithms in words.

    >>> combination(np.array([0.7, 0.7, 0.001]), ["shaft.stiffness", "disc.inertia", "disc.damping"])
    'shaft.stiffness, disc.inertia by a common factor'
    >>> combination(np.array([0.1, -0.2]), ["a.stiffness", "b.stiffness"])
    'b.stiffness by +1 % with a.stiffness by -0.5 %'
    """
    order = np.argsort(-np.abs(change), kind="stable")
    parts = change / change[order[0]]
    named = [int(k) for k in order if abs(parts[k]) >= LEAST_PART]
    if len(named) == 1:
        return f"{names[named[0]]} alone"
    if all(abs(parts[k] - 1.0) < ALIKE for k in named):
        return f"{listed([names[k] for k in sorted(named)])} by a common factor"
    first, *further = (f"{names[k]} by {EXAMPLE * parts[k]:+.2g} %" for k in named)
    return f"{first} with {listed(further)}"


BEHIND = 1e4  # more than the squared logarithms of all ratios of frequencies of one train together


@dataclass(frozen=True)
class Pairs:
    """Measured frequencies with the modes that they are paired with."""

    index: tuple[int, ...]  # in `measured`
    number: tuple[int, ...]  # of the mode, from 0
    lower: FloatArray  # Hz, band of that mode
    upper: FloatArray


def paired(train: Train, deviation: FloatArray, measured: Sequence[Measured]) -> Pairs:
    """Each frequency with the mode that the file names, the others with those to which all together are nearest.

    The number of a mode rises with its frequency whatever the figures, so that no others can be. A mode in whose band a
    frequency lies goes before all in whose it does not. deviation: (figures,) of the logarithms beforehand. Raises
    InputError for more frequencies than modes, or a mode that is not there.
    """
    hertz_of = {
        index: measurement.frequency
        for index, measurement in enumerate(measured)
        if measurement.frequency is not None
    }
    if not hertz_of:
        return Pairs((), (), np.empty(0), np.empty(0))
    nominal = train.modes(np.ones(len(deviation)).tolist()).frequency
    numbers = {index: mode - 1 for index in hertz_of if (mode := measured[index].mode)}
    for index, number in numbers.items():
        if number >= len(nominal):
            message = f"mode {number + 1} is not among the {len(nominal)} of the train"
            fault_path = (*FIT, "measured", index, "mode")
            raise InputError([Fault(fault_path, message, "a lower number")])
    if len(hertz_of) > len(nominal):
        message = f"of {len(hertz_of)} measured natural frequencies the train has {len(nominal)}"
        fault_path = (*FIT, "measured", max(hertz_of), "frequency")
        raise InputError([Fault(fault_path, message, "leave one out")])

    # The ends of every band: each mode at the corner to which its slopes point, which are the exact ends where a
    # frequency rises or falls with each figure throughout, as with every stiffness and every inertia.
    rise = train.slopes(np.zeros(len(deviation)), range(len(nominal)), ()) * deviation
    lower, upper = bands = np.empty((2, len(nominal)))
    for band, side in zip(bands, (-1.0, 1.0), strict=True):
        corners = np.exp(OUTSIDE * side * np.sign(rise) * deviation)
        for corner in np.unique(corners, axis=0):
            chosen = (corners == corner).all(axis=1)
            band[chosen] = train.modes(corner.tolist()).frequency[chosen]

    unnamed = sorted(hertz_of.keys() - numbers.keys(), key=lambda index: (hertz_of[index], index))
    hertz = np.array([hertz_of[index] for index in unnamed], dtype=float)[:, None]
    slack = np.exp([[OUTSIDE * measured[index].within] for index in unnamed]).reshape(-1, 1)

    # Squared logarithms of ratios (frequencies, modes); a mode outside whose band one lies is behind all others.
    is_inside = (lower / slack <= hertz) & (hertz <= upper * slack)
    distance = np.square(np.log(hertz / nominal)) + np.where(is_inside, 0.0, BEHIND)
    for row, index in enumerate(unnamed):
        for paired_index, mode in numbers.items():
            above = hertz_of[index] >= hertz_of[paired_index]
            distance[row, slice(mode + 1) if above else slice(mode, None)] = np.inf
    rising = _rising(distance)
    if rising is None:
        message = "no mode is left between those that are named for a frequency that is not"
        fault_path = (*FIT, "measured", unnamed[0], "frequency")
        raise InputError([Fault(fault_path, message, "say which `mode` each is")])
    numbers |= dict(zip(unnamed, rising, strict=True))
    modes = [numbers[index] for index in hertz_of]
    return Pairs(tuple(hertz_of), tuple(modes), lower[modes], upper[modes])


def _rising(cost: FloatArray) -> list[int] | None:
    """The rising columns, one of each row (rows, columns), that cost least together; None where there are none.

    >>> _rising(np.array([[0.0, 1.0, 9.0], [0.0, 2.0, 9.0]]))
    [0, 1]
    """
    states: list[tuple[float, list[int]]] = [(0.0, [])]  # of every last column the best
    for row in cost:
        below = [
            min(
                ((total, chosen) for total, chosen in states if not chosen or chosen[-1] < k),
                default=(np.inf, []),
            )
            for k in range(len(row))
        ]
        states = [
            (total + row[k], [*chosen, k])
            for k, (total, chosen) in enumerate(below)
            if total + row[k] < np.inf
        ]
    return min(states, default=(0.0, None))[1]


NINETY_FIVE = 1.959963984540054  # deviations of a normal distribution
FAR = 2.0  # deviations that a figure may move without a remark
CURVE_POINTS = 201
USUAL_STEPS = 10  # of a search, of which there is one and two for each figure
DIGITS = 7  # of a factor in the fitted file
SHOWN = 4  # of one in words


def run(work: Work) -> None:
    """Fit, if the file was read with figures that vary; the fitted file is solved the ordinary way too."""
    settings, variation = work.settings("fit", FitSettings), work.study.variations.get("fit")
    if variation is None or work.solve is None:
        work.log.without("fit", "no parameter of the file varies")
        return
    with work.log.step("fit to measurements", "the file names it") as step:
        measured = curves(work.study, settings.measured)
        modes = work.get(Modes)
        named = [measurement.mode or 0 for measurement in settings.measured]
        frequencies = sum(measurement.frequency is not None for measurement in settings.measured)
        count = max(0 if modes is None else modes.frequency.size, *named, frequencies)
        system = work.system if modes is None else modes.system
        train = Train(variation, resolved_for(system, measured), measured, count)
        problem = Problem(train, settings, work.progress)
        best = fitted(problem.residual, problem.jacobian, len(problem.deviation), problem.swapped)
        values = [float(f"{value:.{DIGITS}g}") for value in problem.factors(best.values)]
        solved = work.solve(variation.study(values), only=("modes",)).get(Modes)
        frequency = np.empty(0) if solved is None else solved.frequency
        step.method = "least squares of logarithms (Gauss-Newton in a trust region), with what is known beforehand"
        sizes = f"{len(values)} figures, {problem.sigma.size} measured values"
        step.size = f"{sizes}, {best.searches} starts, {best.steps} steps"
    work.put(fit=_result(problem, best, values, frequency))


class Problem:
    """Residuals of the measurements in their deviations, over figures in deviations of what is known of them."""

    def __init__(self, train: Train, settings: FitSettings, progress: Progress) -> None:
        self.train, self.settings, self.progress, self.steps = train, settings, progress, 0
        self.deviation = np.array([figure.law.lognormal for figure in train.variation.figures])
        self.pairs = paired(train, self.deviation, settings.measured)
        frequencies = [settings.measured[position] for position in self.pairs.index]
        measured = [np.log([measurement.frequency or 1.0]) for measurement in frequencies]
        within = [np.array([measurement.within]) for measurement in frequencies]
        for curve in train.curves:
            logs = np.log(curve.amplitude)
            measured += [logs.real, logs.imag] if curve.has_phase else [logs.real]
            within += [curve.deviation] * (1 + curve.has_phase)
        self.measured, self.sigma = np.concatenate(measured), np.concatenate(within)
        if len(self.deviation) > self.sigma.size:
            were = "value was" if self.sigma.size == 1 else "values were"
            counts = f"{len(self.deviation)} parameters vary, and {self.sigma.size}"
            hint = "vary fewer, or give more measurements"
            raise InputError([Fault((*FIT, "vary"), f"{counts} {were} measured", hint)])

    def factors(self, values: FloatArray) -> list[float]:
        """Return the factors of figures (figures,) in deviations."""
        return [float(factor) for factor in np.exp(values * self.deviation)]

    def residual(self, values: FloatArray) -> FloatArray:
        """Return the residuals (measurements,) of figures (figures,), each in its deviation."""
        train, numbers = self.train, self.pairs.number
        logs = train.logarithms(self.factors(values), numbers, train.curves)
        difference = train.wrapped(logs - self.measured, len(numbers), train.curves)
        return np.asarray(difference / self.sigma)

    def swapped(self, values: FloatArray) -> Iterator[FloatArray]:
        """Yield figures (figures,) as near as can be at which a measured mode and a neighbour swap, by slopes."""
        numbers = self.pairs.number
        frequency = self.train.modes(self.factors(values)).frequency if numbers else np.empty(0)
        for mode in sorted({number - below for number in numbers for below in (0, 1)}):
            if not 0 <= mode < len(frequency) - 1:
                continue
            logs = values * self.deviation
            rise = self.train.slopes(logs, [mode, mode + 1], ()) * self.deviation
            gap = float(np.log(frequency[mode + 1] / frequency[mode]))
            start = np.linalg.lstsq(rise, rise @ values + np.array([gap, -gap]), rcond=1e-3)[0]
            if (np.abs(start) < FARTHEST).all():
                yield start

    def jacobian(self, values: FloatArray) -> FloatArray:
        """Return the derivatives of the residuals (measurements, figures)."""
        self.steps += 1
        usual = USUAL_STEPS * (1 + 2 * len(values))
        self.progress(f"fit to measurements, step {self.steps}", min(self.steps / usual, 0.99))
        slopes = self.train.slopes(values * self.deviation, self.pairs.number, self.train.curves)
        return np.asarray(slopes * self.deviation / self.sigma[:, None])


def _result(problem: Problem, best: Fitted, values: Sequence[float], frequency: FloatArray) -> Fit:
    """Return all that is stated; values: factors as they stand in the fitted file."""
    identity, count, variation = best.identity, problem.sigma.size, problem.train.variation
    deviations = np.sqrt(np.diag(identity.covariance))
    names = [figure.name for figure in variation.figures]
    others = list[OtherFit]()
    for minimum in best.others:
        factors = problem.factors(minimum.values)
        words = (
            f"{name} {variation.stated(position, float(f'{factor:.{SHOWN}g}'))[1]}"
            for position, (name, factor) in enumerate(zip(names, factors, strict=True))
        )
        chi2, prior = (float(np.square(rows).sum()) for rows in (minimum.residual, minimum.values))
        others.append(OtherFit(np.array(factors), chi2, prior, listed(words)))
    directions = zip(identity.singular, identity.unseen, identity.directions, strict=True)
    fit = Fit(
        tuple(_figures(problem, best, deviations, values)),
        tuple(_modes(problem, best, values)),
        tuple(_curves(problem, best, values)),
        tuple(
            Direction(float(singular), bool(unseen), combination(row * problem.deviation, names))
            for singular, unseen, row in directions
        ),
        identity.covariance / np.outer(deviations, deviations),
        count,
        float(np.square(best.residual).sum()),
        count - identified(best.jacobian).used,
        float(np.square(best.values).sum()),
        identity.rank,
        best.steps,
        best.searches,
        tuple(others),
        (),
        frequency,
        variation.text(values),
    )
    return replace(fit, warnings=tuple(_warnings(fit, best)))


def _figures(
    problem: Problem, best: Fitted, deviations: FloatArray, values: Sequence[float]
) -> Iterator[FittedFigure]:
    variation, factors = problem.train.variation, problem.factors(best.values)
    lower, upper = (problem.factors(end) for end in best.interval(NINETY_FIVE))
    for position, figure in enumerate(variation.figures):
        prior, deviation = float(problem.deviation[position]), float(deviations[position])
        yield FittedFigure(
            figure.name,
            *variation.stated(position, values[position]),
            factors[position],
            prior,
            deviation * prior,
            lower[position],
            upper[position],
            float(best.values[position]),
            max(1.0 - deviation**2, 0.0),
        )


def _modes(problem: Problem, best: Fitted, values: Sequence[float]) -> Iterator[FittedMode]:
    pairs = problem.pairs
    if not pairs.index:
        return
    before, after = (
        problem.train.modes(factors).frequency for factors in ([1.0] * len(values), values)
    )
    for row, (position, number) in enumerate(zip(pairs.index, pairs.number, strict=True)):
        measured = problem.settings.measured[position]
        lower, upper = float(pairs.lower[row]), float(pairs.upper[row])
        hertz, slack = measured.frequency or 0.0, np.exp(OUTSIDE * measured.within)
        yield FittedMode(
            number + 1,
            measured.mode is not None,
            hertz,
            measured.within,
            lower,
            upper,
            float(before[number]),
            float(after[number]),
            float(best.residual[row]),
            bool(not lower / slack <= hertz <= upper * slack),
        )


def _curves(problem: Problem, best: Fitted, values: Sequence[float]) -> Iterator[FittedCurve]:
    train, nominal = problem.train, [1.0] * len(values)
    sizes = [curve.speed.size for curve in train.curves for _ in range(1 + curve.has_phase)]
    edges = np.cumsum([len(problem.pairs.index), *sizes])[:-1]
    residuals = iter(np.split(best.residual, edges)[1:])
    for curve in train.curves:
        fine = np.union1d(np.linspace(curve.speed[0], curve.speed[-1], CURVE_POINTS), curve.speed)
        before, after, drawn, drawn_fit = (
            np.abs(train.amplitudes(factors, curve, speed))
            for speed in (curve.speed, fine)
            for factors in (nominal, values)
        )
        yield FittedCurve(
            curve.at,
            curve.order,
            curve.quantity,
            UNITS[curve.quantity],
            curve.origin,
            curve.within,
            curve.deviation,
            curve.speed,
            np.abs(curve.amplitude),
            before,
            after,
            next(residuals),
            next(residuals) if curve.has_phase else None,
            fine,
            drawn,
            drawn_fit,
            curve.unused,
        )


def _warnings(fit: Fit, fitted_values: Fitted) -> Iterator[str]:
    """What does not go together, the gravest first."""
    for mode in fit.modes:
        if mode.is_outside:
            side = "below" if mode.measured < mode.lower else "above"
            yield (
                f"The measured {mode.measured:.6g} Hz of mode {mode.mode} lies {side} the band of that mode, "
                f"{mode.lower:.6g} to {mode.upper:.6g} Hz with every parameter within two deviations. The mode is "
                "another one, the measurement is wrong, or the model lacks something."
            )
    if fit.is_wrong:
        chi2, unit = fit.reduced, "degree of freedom"
        if chi2 is None:
            chi2, unit = fit.chi2 / fit.measurements, "measured value"
        yield (
            f"Chi2 is {chi2:.3g} for each {unit}, above {MOST_CHI2:g}: of {fit.searches} searches none found "
            "values that explain the measurements as exactly as `within` requires. The model lacks something, a "
            "measured frequency is of another mode, or `within` is stated too small; the deviations and intervals "
            "do not hold."
        )
    if fit.others:
        nearest, count = fit.others[0], len(fit.others) - 1
        greater = nearest.chi2 + nearest.prior_chi2 - fit.chi2 - fit.prior_chi2
        yield (
            f"Other values agree nearly as well: {nearest.words} (sum of squares greater by "
            f"{max(greater, 0.0):.2g}){f', and {count} more' if count else ''}. The measurements do not decide between "
            "them; intervals, deviations and what is known reach over all of them."
        )
    for figure in fit.figures:
        if abs(figure.shift) > FARTHEST - 1e-6:
            yield f"{figure.name} went to the end of what is tried, {figure.shift:+.2g} of its deviations beforehand."
        elif abs(figure.shift) > FAR:
            yield f"{figure.name} moved by {figure.shift:+.2g} of its deviations beforehand: more than was expected."
    if not fitted_values.converged:
        yield f"After {fitted_values.steps} steps the sum of squares still falls: the figures are not the best ones."
    for direction in fit.directions:
        if direction.is_unidentified:
            words = f"No measurement identifies {direction.words}: changed so, every measured value stays as it is"
            if not fit.curves and "common factor" in direction.words:
                words += (
                    " (frequencies never identify the common scale of stiffnesses and inertias)"
                )
            yield f"{words}. Its values are the prior values of the file."
