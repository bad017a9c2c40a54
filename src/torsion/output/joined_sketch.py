"""The sketch of a train with very many components: those in a row are joined into one piece that says how many."""

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from torsion.output.figures.figure import Disc, Link, Place, Sketch
from torsion.output.numbers import counted

MOST_LINKS = 60  # that are drawn one by one
MOST_DRAWN = 240  # beside joined ones; of a train that has still more the main line alone is drawn
FEWEST = 6  # links in a row that are joined
LONGEST = 4.0  # units of the layout that a joined piece takes
PLAIN_LINKS = ("shaft", "coupling", "rigid")


def joined(sketch: Sketch) -> tuple[Sketch, str]:
    """The sketch as it is drawn, and what is to be said of it; the same and nothing where the train is short."""
    if len(sketch.links) <= MOST_LINKS:
        return sketch, ""
    number = len(sketch.discs) + sum(one.kind not in ("rigid", "tie") for one in sketch.links)
    made = _joined(sketch, every_kind=False)
    if len(made.links) <= MOST_DRAWN:
        return made, f"; of {number:,} components those alike in a row are joined"
    main = Sketch(
        tuple(one for one in sketch.discs if one.row == 0),
        tuple(one for one in sketch.links if one.start[1] == one.end[1] == 0),
    )
    return _joined(
        main, every_kind=True
    ), f"; of {number:,} components only the main line, components in a row joined"


def _joined(sketch: Sketch, *, every_kind: bool) -> Sketch:
    """Runs of components as one link each, and the train drawn together where they are."""
    discs = {(one.x, one.row): one for one in sketch.discs}
    runs = list(_runs(sketch, discs, every_kind=every_kind))
    inside = {place for run in runs for place in (one.end for one in run[:-1])}
    hidden = {id(one) for run in runs for one in run}
    kept = [one for one in sketch.links if id(one) not in hidden]
    shown = [one for one in sketch.discs if (one.x, one.row) not in inside]
    pieces = [_piece(run, [discs[one.end] for one in run[:-1] if one.end in discs]) for run in runs]
    return _drawn_together(Sketch(tuple(shown), (*kept, *pieces)))


def _runs(sketch: Sketch, discs: dict[Place, Disc], *, every_kind: bool) -> Iterator[list[Link]]:
    """Links one behind another, with nothing but plain discs between them and nothing that branches off."""
    meet = Counter(place for one in sketch.links for place in (one.start, one.end))
    run: list[Link] = []
    along = [
        one
        for one in sketch.links
        if one.start[1] == one.end[1] and (every_kind or one.kind in PLAIN_LINKS)
    ]
    for one in sorted(along, key=lambda link: (link.start[1], link.start[0])):
        follows = run and run[-1].end == one.start and meet[one.start] == 2
        if not (follows and _is_plain(discs.get(one.start), every_kind=every_kind)):
            if len(run) >= FEWEST:
                yield run
            run = []
        run.append(one)
    if len(run) >= FEWEST:
        yield run


def _is_plain(disc: Disc | None, *, every_kind: bool) -> bool:
    """What may stand within a joined piece."""
    if disc is None or every_kind:
        return True
    return disc.kind == "disc" and not (disc.is_held or disc.is_grounded or disc.ring)


def _piece(run: Sequence[Link], discs: Sequence[Disc]) -> Link:
    """A run as one link, with how many of which kind it is."""
    kinds = Counter(one.kind for one in discs) + Counter(
        one.kind for one in run if one.kind not in ("rigid", "tie")
    )
    words = " and ".join(counted(n, kind) for kind, n in kinds.items())
    return Link(
        "run",
        run[0].start,
        run[-1].end,
        words,
        parts=tuple(part for one in run for part in one.parts),
    )


def _drawn_together(sketch: Sketch) -> Sketch:
    """The sketch with no distance along the train longer than a joined piece takes."""
    places = np.unique(np.array(list(_places(sketch))))
    apart = np.minimum(np.diff(places), LONGEST)
    along = np.concatenate([places[:1], places[0] + np.cumsum(apart)])

    def moved(place: Place) -> Place:
        return float(np.interp(place[0], places, along)), place[1]

    discs = (replace(one, x=moved((one.x, one.row))[0]) for one in sketch.discs)
    links = (replace(one, start=moved(one.start), end=moved(one.end)) for one in sketch.links)
    return Sketch(tuple(discs), tuple(links))


def _places(sketch: Sketch) -> Iterable[float]:
    yield from (one.x for one in sketch.discs)
    yield from (place[0] for one in sketch.links for place in (one.start, one.end))
