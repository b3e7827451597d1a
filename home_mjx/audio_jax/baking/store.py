"""Baked sound of a bank: from disk, or baked now and kept there."""

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

VERSION = 9  # raise it whenever the same house and options would give another field

log = logging.getLogger(__name__)


def with_late_sound(
    bank: HouseBank,
    houses: Sequence[CompiledHouse],
    options: BakeOptions | None = None,
    progress: bool = False,
) -> HouseBank:
    """The bank with the late sound of its houses, for `AudioConfig(late="baked")`.

    What is not in the cache is baked: half a minute to a minute and a half per house on two cores.

    Args:
        bank: The houses.
        houses: The same ones as they were compiled, in the same order.
        options: How sound is baked.
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
        raise ConfigError(f"the bank holds houses {held}, but those given are {given}", hint="Give the bank's own.")
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
        log.warning("broken cache entry %s is made again: %s", entry, error)
    field = bake_house(house, options, bank, index)
    try:
        write_entry(entry, *flatten(field))
    except OSError as error:
        log.warning("baked sound is not cached: %s", error)
    return field


def entry_of(house: CompiledHouse, options: BakeOptions) -> Path:
    """Where the baked sound of a house is in the cache, or would be: named by all that it is made from."""
    name = hashlib.sha256(repr((VERSION, options, jax.default_backend())).encode())
    arrays, notes = flatten(house, skip=frozenset(("models", "lights", "gloss")))
    name.update(repr((sorted(arrays), notes["instances.model"])).encode())
    meshes = [house.models[key].triangle for key in sorted(house.models)]
    for array in (*(arrays[key] for key in sorted(arrays)), *meshes):
        name.update(np.ascontiguousarray(array).tobytes())
    return cache_folder() / "late_sound" / f"{name.hexdigest()}.zip"
