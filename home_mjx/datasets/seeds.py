"""Ids of generated houses, and their order by seed."""

import hashlib
from collections.abc import Iterable

from home_mjx.errors import UnknownIdError

# "home" in hexadecimal. SUNCG's ids are hashes; one of its 45,622 has this prefix with probability 1e-5.
ID_PREFIX = "686f6d65"
GENERATED_MARKER = "generated.json"  # file in the root of a generated dataset
MAX_LOOKUP_SEED = 1 << 16  # exclusive maximum seed of a lookup by id; searching them all takes 0.1 s


def house_id(seed: int) -> str:
    """Return the id of a seed's house: 32 hexadecimal digits.

    Example:
        >>> house_id(0)
        '686f6d6574c24b12dede1f713a5bbb04'
    """
    return ID_PREFIX + hashlib.sha256(f"home_mjx house {seed}".encode()).hexdigest()[:24]


def sort_house_ids(ids: Iterable[str]) -> tuple[str, ...]:
    """Return the distinct house ids in order: generated houses by seed, then all others by id.

    The first houses of a generated folder thus stay first when houses of higher seeds are added. Sorted by id, which is
    a hash, a new house could come anywhere. Seeds of `MAX_LOOKUP_SEED` and more count as unknown.

    Example:
        >>> sort_house_ids(["b", house_id(9), "a", house_id(2)]) == (house_id(2), house_id(9), "a", "b")
        True
    """
    others = set(ids)
    found = _known(others)
    return (*found, *sorted(others.difference(found)))


def find_seeds(ids: Iterable[str]) -> tuple[int, ...]:
    """Return the distinct seeds of generated houses in ascending order.

    Raises:
        UnknownIdError: An id does not belong to a seed below `MAX_LOOKUP_SEED`.

    Example:
        >>> find_seeds([house_id(9), house_id(2)])
        (2, 9)
    """
    wanted = set(ids)
    found = _known(wanted)
    if strangers := sorted(wanted.difference(found)):
        hint = "Name its dataset: `houses=` in Python, `--dataset` on the command line."
        raise UnknownIdError(f"no house `{strangers[0]:.100}` can be generated without a dataset", hint=hint)
    return tuple(found.values())


def _known(ids: set[str]) -> dict[str, int]:
    """Map the ids of seeds below `MAX_LOOKUP_SEED` to their seeds, in ascending order; omit all other ids."""
    left = sum(name.startswith(ID_PREFIX) for name in ids)
    found: dict[str, int] = {}
    for seed in range(MAX_LOOKUP_SEED):
        if len(found) == left:
            break
        if (name := house_id(seed)) in ids:
            found[name] = seed
    return found
