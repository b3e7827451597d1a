"""Dataset splits by a hash of the house id."""

import hashlib
from collections.abc import Iterable, Mapping

from home_mjx.core.checks import check_known
from home_mjx.errors import ConfigError

SPLITS: Mapping[str, float] = {"train": 0.8, "val": 0.1, "test": 0.1}


def split_of(house_id: str, fractions: Mapping[str, float] = SPLITS) -> str:
    """Return the split of a house, which depends only on its id and the fractions, in their order.

    The first 64 bits of the id's SHA-256 are a fraction of 2**64. The first split whose cumulative fraction exceeds it
    is returned.

    Args:
        house_id: Id of the house.
        fractions: Fraction of all houses in each split; they must sum to 1.

    Raises:
        ConfigError: They do not, or one is negative.

    Example:
        >>> split_of("0004d52d1aeeb8ae6de39d6bd993e992")
        'test'
    """
    if abs(sum(fractions.values()) - 1) > 1e-9 or min(fractions.values()) < 0:
        raise ConfigError(f"fractions of splits must sum to 1, got {dict(fractions)}")
    at = int.from_bytes(hashlib.sha256(house_id.encode()).digest()[:8], "big") / 2**64
    names = list(fractions)
    for name in names[:-1]:
        at -= fractions[name]
        if at < 0:
            return name
    return names[-1]


def select_ids(ids: Iterable[str], split: str | None) -> list[str]:
    """Return the house ids of a split of `SPLITS` in the given order; all if the split is None.

    Raises:
        ConfigError: The split is unknown.
    """
    if split is None:
        return list(ids)
    check_known("split", [split], SPLITS)
    return [house_id for house_id in ids if split_of(house_id) == split]
