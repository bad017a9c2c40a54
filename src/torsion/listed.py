"""Names one after another in a sentence, as many as a reader takes in."""

from collections.abc import Collection
from itertools import islice

MOST = 12  # in one sentence


def listed(names: Collection[str], between: str = ", ", most: int = MOST) -> str:
    """The first names, and how many more there are.

    >>> listed(["a", "b", "c"]), listed([f"c{k}" for k in range(1, 9_985)], most=3)
    ('a, b, c', 'c1, c2, c3 and 9,981 more')
    """
    if len(names) <= most + 1:
        return between.join(names)
    return f"{between.join(islice(names, most))} and {len(names) - most:,} more"
