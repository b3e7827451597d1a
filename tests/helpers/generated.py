"""Generated flats, for tests that need a small house and not a particular one."""

import atexit
import shutil
import tempfile
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
    """Write flats below a dataset root, and return their ids; an empty root gets a copy of those written before."""
    if Path(root).exists() and any(Path(root).iterdir()):
        return write_flats(root, seeds)
    shutil.copytree(_written(tuple(seeds)), root, dirs_exist_ok=True)
    return tuple(map(flat_id, seeds))


def write_flats(root: str | Path, seeds: Sequence[int]) -> tuple[str, ...]:
    """Write flats below a dataset root by the generator, and return their ids."""
    return generate_dataset(root, seeds, preset="flat")


@cache
def _written(seeds: tuple[int, ...]) -> Path:
    """A folder that nobody changes, with flats."""
    folder = Path(tempfile.mkdtemp(prefix="home_mjx_flats_"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    write_flats(folder, seeds)
    return folder
