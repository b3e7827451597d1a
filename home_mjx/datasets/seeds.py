"""Ids of generated houses, and the order of seeds that they stand for."""

import hashlib
from collections.abc import Iterable

from home_mjx.errors import UnknownIdError

# "home" in hexadecimal: SUNCG's ids are hashes, so one of its 45,622 begins so with probability 1e-5.
ID_PREFIX = "686f6d65"
MARKER = "generated.json"  # lies in the root of a generated dataset
MAX_KNOWN = 1 << 16  # seeds from here on are not looked for: this many take 0.1 s


def house_id(seed: int) -> str:
    """The id of a seed's house: 32 hexadecimal digits.

    Example:
        >>> house_id(0)
        '686f6d6574c24b12dede1f713a5bbb04'
    """
    return ID_PREFIX + hashlib.sha256(f"home_mjx house {seed}".encode()).hexdigest()[:24]


def in_order(ids: Iterable[str]) -> tuple[str, ...]:
    """Ids of houses: generated ones by their seeds, then all others, sorted.

    So the first houses of a generated folder stay the first when houses of higher seeds are added. Ids are hashes: in
    their own order a new house could come anywhere. Seeds of `MAX_KNOWN` and more count as unknown.

    Example:
        >>> in_order(["b", house_id(9), "a", house_id(2)]) == (house_id(2), house_id(9), "a", "b")
        True
    """
    others = set(ids)
    found = _known(others)
    return (*found, *sorted(others.difference(found)))


def seeds_of(ids: Iterable[str]) -> tuple[int, ...]:
    """Seeds of generated houses, each once, the lowest first.

    Raises:
        UnknownIdError: One is of no seed below `MAX_KNOWN`.

    Example:
        >>> seeds_of([house_id(9), house_id(2)])
        (2, 9)
    """
    wanted = set(ids)
    found = _known(wanted)
    if strangers := sorted(wanted.difference(found)):
        hint = "Name its dataset: `houses=` in Python, `--dataset` on the command line."
        raise UnknownIdError(f"no house `{strangers[0]:.100}` is generated without a dataset", hint=hint)
    return tuple(found.values())


def _known(ids: set[str]) -> dict[str, int]:
    """Seeds of those that are known, in order."""
    left = sum(name.startswith(ID_PREFIX) for name in ids)
    found: dict[str, int] = {}
    for seed in range(MAX_KNOWN):
        if len(found) == left:
            break
        if (name := house_id(seed)) in ids:
            found[name] = seed
    return found
