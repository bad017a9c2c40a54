"""Names one after another in a sentence, as many as a reader takes in."""

from collections.abc import Iterable

MOST = 12  # in one sentence


def listed(names: Iterable[str], between: str = ", ", most: int = MOST) -> str:
    """The first names, and how many more there are.

    >>> listed("abc"), listed((f"c{k}" for k in range(1, 9_985)), most=3)
    ('a, b, c', 'c1, c2, c3 and 9,981 more')
    """
    found = list(names)
    if len(found) <= most + 1:
        return between.join(found)
    return f"{between.join(found[:most])} and {len(found) - most:,} more"
