"""Generated flats, for tests that need a small house and not a particular one."""

from collections.abc import Sequence
from functools import cache
from pathlib import Path

from home_mjx.schema.house import House
from home_procgen import build_home, generate_dataset
from home_procgen.presets import Variant

FLAT = Variant("flat")


def flat_id(seed: int) -> str:
    """Return the id of a flat."""
    return FLAT.house_id(seed)


@cache
def flat(seed: int) -> House:
    """Return the flat of a seed, as it is before it is written."""
    return build_home(seed, FLAT)


def generate_flats(root: str | Path, seeds: Sequence[int]) -> tuple[str, ...]:
    """Write flats below a dataset root, and return their ids."""
    return generate_dataset(root, seeds, preset="flat")
