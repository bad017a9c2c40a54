"""The scenes of the study of very long trains are scenes, with the components that they name."""

import pytest

import torsion


@pytest.mark.parametrize(("link", "bars"), [("coupling", 0), ("shaft", 4)])
def test_a_chain_has_so_many_discs_and_links_and_its_first_mode_in_the_range(benchmark, link, bars):
    study = torsion.parse(benchmark("scale").chain(5, link, orders=3))
    assert (len(study.train.parts), len(study.train.bars), len(study.train.torques)) == (9, bars, 3)
    found = torsion.parse(benchmark("scale").chain(400))
    assert torsion.modes(torsion.assemble(found.train), 1).frequency[0] == pytest.approx(
        20.0, rel=0.2
    )


def test_branches_and_a_long_shaft_are_as_many_as_is_said(benchmark):
    scale = benchmark("scale")
    assert len(torsion.parse(scale.branched(6)).train.parts) == 6 + 5 + 3 * 6
    assert torsion.assemble(torsion.parse(scale.long_shaft(77)).train).segments["tail shaft"] == 77
