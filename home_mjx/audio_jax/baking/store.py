"""Disk cache of baked late reverberation."""

import hashlib
import logging
from collections.abc import Sequence
from pathlib import Path

import jax
import numpy as np
from tqdm import tqdm

from home_mjx.audio_jax.baking.bake import BakeOptions, bake_house
from home_mjx.audio_jax.baking.late_field import LateField, stacked
from home_mjx.bank.bank import HouseBank
from home_mjx.core.paths import cache_folder
from home_mjx.errors import ConfigError
from home_mjx.scene_compile.cache.entry import BROKEN, read_entry, write_entry
from home_mjx.scene_compile.cache.flatten import flatten, rebuild
from home_mjx.schema.compiled import CompiledHouse

VERSION = 9  # increase it when the same house and options produce a different field

log = logging.getLogger(__name__)


def with_late_sound(
    bank: HouseBank,
    houses: Sequence[CompiledHouse],
    options: BakeOptions | None = None,
    progress: bool = False,
) -> HouseBank:
    """Return the bank with the late sound of its houses, for `AudioConfig(late="baked")`.

    Houses that are not in the cache are baked, which takes 0.5 to 1.5 minutes per house on two cores.

    Args:
        bank: Bank of the houses.
        houses: The same houses as compiled, in the same order.
        options: Bake options; None: defaults.
        progress: Show a progress bar.

    Raises:
        ConfigError: The houses are not those of the bank, or one has no room.

    Example:
        >>> houses = HouseSet("datasets/demo", num_houses=8).load()  # doctest: +SKIP
        >>> bank = with_late_sound(HouseBank.from_compiled(houses), houses)  # doctest: +SKIP
        >>> env = home_mjx.make("AudioNav-v0", bank, audio=AudioConfig(late="baked"))  # doctest: +SKIP
    """
    options = options or BakeOptions()
    given, held = tuple(house.id for house in houses), bank.house_ids
    if given != held:
        raise ConfigError(f"the bank holds houses {held}, got {given}", hint="Pass the houses of the bank, in order.")
    shown = tqdm(houses, desc="bake sound", unit="house", disable=not progress, delay=1)
    fields = [_field(bank, index, house, options) for index, house in enumerate(shown)]
    spec = bank.spec
    return bank.replace(late=stacked(fields, [h.doors.rows(spec.num_doors, spec.num_slides) for h in houses]))


def _field(bank: HouseBank, index: int, house: CompiledHouse, options: BakeOptions) -> LateField:
    entry = entry_of(house, options)
    try:
        return rebuild(LateField, *read_entry(entry))
    except FileNotFoundError:
        pass
    except BROKEN as error:
        log.warning("broken cache entry %s is rebuilt: %s", entry, error)
    field = bake_house(house, options, bank, index)
    try:
        write_entry(entry, *flatten(field))
    except OSError as error:
        log.warning("baked sound is not cached: %s", error)
    return field


def entry_of(house: CompiledHouse, options: BakeOptions) -> Path:
    """Return the cache path of a house's baked sound; its name is a hash of all inputs."""
    name = hashlib.sha256(repr((VERSION, options, jax.default_backend())).encode())
    arrays, notes = flatten(house, skip=frozenset(("models", "lights", "gloss")))
    name.update(repr((sorted(arrays), notes["instances.model"])).encode())
    meshes = [house.models[key].triangle for key in sorted(house.models)]
    for array in (*(arrays[key] for key in sorted(arrays)), *meshes):
        name.update(np.ascontiguousarray(array).tobytes())
    return cache_folder() / "late_sound" / f"{name.hexdigest()}.zip"
