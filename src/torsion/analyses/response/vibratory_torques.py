"""Couplings by table over their own vibratory torque: the torque, stiffness and solutions of every speed."""

import numpy as np

from torsion.analyses.response.amplitudes import Response
from torsion.arrays import BoolArray, FloatArray, IntArray
from torsion.findings import Work
from torsion.results import reported, result


@reported
class VibratoryTorque:
    """One coupling over the speed."""

    coupling: str = result("", "its name")
    speed: FloatArray = result("rad/s", ("speed",), "reference speeds")
    torque: FloatArray = result(
        "N*m",
        ("speed",),
        "amplitude (zero to peak) of all harmonic components; of several solutions the largest",
    )
    smallest: FloatArray = result("N*m", ("speed",), "the smallest solution")
    number: IntArray = result(
        "", ("speed",), "solutions, as far as found between the points of the table"
    )
    stiffness: FloatArray = result("N*m/rad", ("speed",), "dynamic stiffness at `torque`")
    loss_factor: FloatArray = result("1", ("speed",), "loss factor at `torque`")
    residual: FloatArray = result(
        "1", ("speed",), "relative: amplitude at that stiffness against `torque`"
    )
    rounds: IntArray = result("", ("speed",), "rounds over all such couplings")
    settled: BoolArray = result(
        "", ("speed",), "it is an answer; no other speed has one", key="has_settled"
    )


@reported
class VibratoryTorques:
    """Couplings with such a table."""

    each: tuple[VibratoryTorque, ...] = result(
        "", "couplings by table over vibratory torque", key=""
    )


def vibratory_torques(response: Response) -> VibratoryTorques:
    """Return the couplings by table over vibratory torque of a response over speed."""
    following = response.following
    rows = []
    if following is None:
        return VibratoryTorques(())
    last = response.others[-1].following if response.others else following
    for k, span in enumerate(following.spans):
        stiffness, eta, _ = response.system.tables[span].values(following.torque[:, k])
        smallest = (following if last is None else last).torque[:, k]
        rows.append(
            VibratoryTorque(
                response.system.spans[span].name,
                response.speed,
                following.torque[:, k],
                np.minimum(smallest, following.torque[:, k]),
                following.number[:, k],
                stiffness,
                eta,
                following.residual[:, k],
                following.rounds,
                following.settled,
            )
        )
    return VibratoryTorques(tuple(rows))


def run(work: Work) -> None:
    """Put the couplings where there is a response over speed."""
    response = work.get(Response)
    if response is None:
        work.log.without("vibratory torque of couplings by table", "no response over speed")
        return
    work.put(vibratory_torques=vibratory_torques(response))
