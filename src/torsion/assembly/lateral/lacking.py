"""Why the bending of a shaft cannot be computed, and at which key of the file that would be mended."""

from torsion.assembly.lateral.shaft import Beam
from torsion.components.support import Support
from torsion.errors import Path
from torsion.primitives import Bar
from torsion.train import Train

SOFTEST = 1e-8  # of E I/L^3: the lowest frequency is wrong by about 1e-13 over this share (measured), here 1e-5
PLANES = "yz"


def supports_of(train: Train, bar: Bar) -> list[tuple[Support, Path]]:
    """The supports of a shaft and where each stands in the file."""
    every, path = train.shaft(bar).support, (*train.parts[bar.part].path, "support")
    return [(one, path if len(every) == 1 else (*path, number)) for number, one in enumerate(every)]


def missing(train: Train, row: list[Bar], beam: Beam) -> tuple[str, Path]:
    """Why a shaft made of `row` cannot be computed, and the key it is about; both empty where it can."""
    of_mesh = [bar for bar in row if bar.section is not None]
    if of_mesh:
        place = (*train.parts[of_mesh[0].part].path, "section")
        return "its section is a mesh, and bending needs diameters", place
    why, place = _not_held(train, row, beam)
    if why:
        return why, place
    if not any(bar.density for bar in row) and not any(point.mass for point in beam.points):
        place = (*train.parts[row[0].part].path, "material")
        return "it has no mass: neither its material a density nor a support a `mass`", place
    return "", ()


def _not_held(train: Train, row: list[Bar], beam: Beam) -> tuple[str, Path]:
    """Why joints and supports do not hold a shaft in both planes."""
    free = [beam.rigid_motions(plane) for plane in (0, 1)]
    given = [one for bar in row for one in supports_of(train, bar)]
    if not any(free):
        return _held_softly(beam, given)
    if not given:
        return "it is not supported: it needs a joint at either end, a joint and a `support`, or two supports", ()
    if free[0] != free[1]:
        plane = free.index(max(free))
        path = next(path for one, path in given if not one.stiffness_of_planes[plane] > 0)
        why = f"it is not supported in the plane {PLANES[plane]}, in which its support has no stiffness"
        return why, (*path, "stiffness")
    at = [point.at for point in beam.points]
    if len(set(at)) < len(at):
        where = "on the joint itself" if any(point.held == "pinned" for point in beam.points) else "where another does"
        path = given[-1][1]
        return f"it is supported at one place only, as its support stands {where}", (*path, "at")
    return "it is supported at one place only: add another `support`, or a joint at an end", given[-1][1]


def _held_softly(beam: Beam, given: list[tuple[Support, Path]]) -> tuple[str, Path]:
    """That its supports are too soft to differ from none."""
    hold = min(beam.hold(0), beam.hold(1))
    if hold >= SOFTEST or not given:
        return "", ()
    softest = min(given, key=lambda one: min(one[0].stiffness_of_planes))
    bent = f"{beam.bending_stiffness:.3g} N/m, E I/L^3"
    why = f"its supports hold it with {hold:.2g} of its bending stiffness ({bent}), which is too soft to compute"
    return f"{why}; at least {SOFTEST:g} of it is needed", (*softest[1], "stiffness")
