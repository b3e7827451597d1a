"""Ids of generated houses, and the order of seeds that they stand for."""

import hashlib
from collections.abc import Iterable

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
    left = sum(name.startswith(ID_PREFIX) for name in others)
    found: list[str] = []
    for seed in range(MAX_KNOWN):
        if len(found) == left:
            break
        if (name := house_id(seed)) in others:
            found.append(name)
    return (*found, *sorted(others.difference(found)))
