"""Laws of cylinders by parts of the speed: an edge stands where the law changes, and there alone."""

import numpy as np

from torsion.kernels.motion.torque_laws import quadratics, without_equal_parts


def test_parts_of_one_parabola_are_one_part_and_a_corner_stays() -> None:
    """|s - 30| is a corner at 30; 3 + s^2 has none."""
    edges = np.array([5.0, 10.0, 20.0, 30.0, 45.0, 60.0])
    speed = np.stack([edges[:-1], (edges[:-1] + edges[1:]) / 2.0, edges[1:]], axis=1)
    smooth, corner = 3.0 + 1j * speed**2, np.abs(speed - 30.0)
    for values, expected in (
        ([smooth, 2.0 * smooth], [5.0, 60.0]),
        ([smooth, corner], [5.0, 30.0, 60.0]),
    ):
        every = quadratics(edges, np.stack(values, axis=-1).astype(complex))
        kept, polynomial = without_equal_parts(edges, every)
        assert kept.tolist() == expected
        np.testing.assert_allclose(polynomial[:, 2, 0], 1j, atol=1e-12)
