"""The train as a tree: which spans close loops."""

import pytest

import torsion
from torsion.errors import InputError

LOOP = """name: a loop
train:
  - disc: {name: a, inertia: 1}
  - coupling: {flexibility: 0}
  - disc: {name: b, inertia: 1}
  - coupling: {stiffness: 1e4}
  - disc: {name: c, inertia: 1}
  - joint: {angle: 0 deg}
  - disc: {name: d, inertia: 1}
links:
  - {between: [a, c], coupling: {name: soft, stiffness: 100}}
  - {between: ENDS, coupling: {name: hard, flexibility: 0}}
"""


@pytest.mark.parametrize("ends", ["[a, b]", "[c, d]"])
def test_loop_of_rigid_links_is_a_fault_of_the_link_that_closes_it(ends):
    with pytest.raises(
        InputError, match="'hard' is rigid and closes a loop of rigid links"
    ) as raised:
        torsion.run(torsion.parse(LOOP.replace("ENDS", ends)))
    (fault,) = raised.value.faults
    assert (fault.line, fault.path) == (12, ("links", 1, "coupling", "flexibility"))


def test_rigid_link_that_closes_a_loop_with_a_spring_in_it_is_no_fault():
    found = torsion.run(torsion.parse(LOOP.replace("ENDS", "[b, c]")))
    assert [found.system.spans[span].name for span in found.system.condensed.extra] == [
        "coupling-2",
        "soft",
    ]
