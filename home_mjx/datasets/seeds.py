"""Ids of generated houses: a prefix, the variant of the generator, and the seed."""

from collections.abc import Iterable
from typing import NamedTuple

# "home" in hexadecimal. SUNCG's ids are hashes; one of its 45,622 has this prefix with probability 1e-5.
ID_PREFIX = "686f6d65"
GENERATED_MARKER = "generated.json"  # file in the root of a generated dataset


class HouseKey(NamedTuple):
    """Variant and seed of a generated house."""

    variant: int  # version, preset and detail: see `home_procgen.presets.Variant.number`
    seed: int


def house_id(seed: int, variant: int) -> str:
    """Return the id of a generated house: 32 hexadecimal digits, which sort by variant, then by seed (< 2**63).

    Example:
        >>> house_id(26, 0x500)
        '686f6d6500000500000000000000001a'
    """
    return f"{ID_PREFIX}{variant:08x}{seed:016x}"


def parse_house_id(name: str) -> HouseKey | None:
    """Return the variant and the seed of a generated house's id; None for any other text.

    Example:
        >>> parse_house_id(house_id(7, 0x300))
        HouseKey(variant=768, seed=7)
    """
    try:
        key = HouseKey(int(name[8:16], 16), int(name[16:], 16))
    except ValueError:
        return None
    return key if min(key) >= 0 and name == house_id(key.seed, key.variant) else None


def sort_house_ids(ids: Iterable[str]) -> tuple[str, ...]:
    """Return the distinct house ids in order: those with `ID_PREFIX` by variant and seed, then all others by id.

    The first houses of a generated folder thus stay first when houses of higher seeds are added.

    Example:
        >>> sort_house_ids(["b", house_id(9, 0), "a", house_id(2, 0)]) == (house_id(2, 0), house_id(9, 0), "a", "b")
        True
    """
    return tuple(sorted(set(ids), key=lambda name: (not name.startswith(ID_PREFIX), name)))
