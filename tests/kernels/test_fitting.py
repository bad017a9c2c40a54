"""Values from measurements: what they identify, and intervals that hold as often as they say."""

from dataclasses import replace

import numpy as np

from torsion.kernels.fitting import fitted, identified

CHAIN = np.array(
    [  # d ln f/d ln value of a free chain of four discs: three stiffnesses, four inertias (50 digits)
        [
            0.403343153160794559,
            0.0206704170166392124,
            0.075986429822566229,
            -0.293803734606897595,
            -0.0119116068010872881,
            -0.0299821608160149916,
            -0.164302497776000125,
        ],
        [
            0.0842550621870688425,
            0.00246320490974162563,
            0.413281732903189532,
            -0.0125071575598935434,
            -0.120045703683979212,
            -0.185336914012647659,
            -0.182110224743479586,
        ],
        [
            0.0124017846521365989,
            0.476866378073619162,
            0.0107318372742442391,
            -0.000140720736434668295,
            -0.311591076611707694,
            -0.187906731622950252,
            -0.000361471028907385519,
        ],
    ]
)


def test_three_frequencies_identify_three_of_seven_values_and_never_their_common_scale() -> None:
    found = identified(CHAIN / 0.005)
    assert found.rank == 3
    common = np.ones(7) / np.sqrt(7.0)
    unseen = found.directions[3:]
    assert np.linalg.norm(unseen @ common) > 1.0 - 1e-12  # it lies wholly in what no frequency sees
    assert found.used < 3.0


def test_covariance_is_that_of_the_normal_equations() -> None:
    jacobian = np.random.default_rng(3).normal(size=(9, 4)) * [30.0, 1.0, 0.1, 5.0]
    direct = np.linalg.inv(jacobian.T @ jacobian + np.eye(4))
    assert np.allclose(identified(jacobian).covariance, direct, rtol=1e-12, atol=1e-14)


def test_intervals_of_95_percent_hold_the_true_value_in_93_to_97_of_100_fits() -> None:
    """Two discs with a lossy coupling: k (15 %), eta (25 %) and J2 (5 %) from one frequency and a torsiogram.

    f^2 = k (J1 + J2)/(J1 J2)/4 pi^2; angle of disc 2 to a torque at disc 1 by the flexibility of both in closed form.
    """
    rng, first, deviation = np.random.default_rng(11), 1.2, np.array([0.15, 0.25, 0.05])
    w = np.linspace(120.0, 320.0, 40)
    sigma = np.concatenate([[0.005], np.full(40, 0.05)])

    def logarithms(values: np.ndarray) -> np.ndarray:
        k, eta, second = np.array([2e4, 0.1, 0.8]) * np.exp(values * deviation)
        stiffness = k * (1.0 + 1j * eta)
        angle = stiffness / (w**4 * first * second - stiffness * w**2 * (first + second))
        return np.concatenate(
            [[0.5 * np.log(k * (first + second) / (first * second))], np.log(np.abs(angle))]
        )

    def slopes(values: np.ndarray) -> np.ndarray:
        step = 1e-5 * np.eye(3)
        return np.stack(
            [(logarithms(values + s) - logarithms(values - s)) / 2e-5 for s in step], axis=1
        )

    inside, over = 0, []
    for _ in range(120):
        true = rng.normal(size=3)
        data = logarithms(true) + sigma * rng.normal(size=41)
        found = fitted(
            lambda p, data=data: (logarithms(p) - data) / sigma,
            lambda p: slopes(p) / sigma[:, None],
            3,
        )
        each = np.sqrt(np.diag(identified(found.jacobian).covariance))
        inside += int((np.abs(found.values - true) <= 1.959964 * each).sum())
        over.append(np.square(found.residual).sum() / (41.0 - identified(found.jacobian).used))
    assert 0.93 <= inside / 360 <= 0.97
    assert abs(np.mean(over) - 1.0) < 0.05  # chi2 for each degree of freedom


def test_intervals_over_all_minima_hold_the_truth_where_modes_cross_and_those_around_the_best_alone_do_not() -> (
    None
):
    """A heavy disc between two light ones, stiffnesses known to 10 %: w^4 - w^2 (k1 + k2) 1.01 + k1 k2 1.02 = 0."""
    rng, sigma = np.random.default_rng(1), 0.005

    def squares(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        k = np.array([10000.0, 11000.0]) * np.exp(0.1 * values)
        half, product = 0.505 * k.sum(), 1.02 * k.prod()
        root = np.sqrt(half**2 - product)
        found = np.array([product / (half + root), half + root])
        return found, 0.1 * (1.01 * found[:, None] * k - product) / (2.0 * found - 2.0 * half)[
            :, None
        ]

    inside, alone = 0, 0
    for _ in range(100):
        true = rng.normal(size=2)
        data = 0.5 * np.log(squares(true)[0]) + sigma * rng.normal(size=2)

        def residual(values: np.ndarray, data: np.ndarray = data) -> np.ndarray:
            return (0.5 * np.log(squares(values)[0]) - data) / sigma

        def slopes(values: np.ndarray) -> np.ndarray:
            found, rise = squares(values)
            return 0.5 * rise / found[:, None] / sigma

        found = fitted(residual, slopes, 2)
        lower, upper = found.interval(1.959964)
        inside += int(((lower <= true) & (true <= upper)).sum())
        lower, upper = replace(found, others=()).interval(1.959964)
        alone += int(((lower <= true) & (true <= upper)).sum())
    assert inside >= 0.93 * 200
    assert alone < 0.85 * 200
