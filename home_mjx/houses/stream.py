"""Bank whose houses are exchanged while environments run, for datasets larger than device memory."""

import functools
import logging
from collections.abc import Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Int

from home_mjx.bank.bank import HouseBank, to_bank
from home_mjx.bank.packing.capacity import capacity_of, slot_stride
from home_mjx.bank.packing.library import Library, agent_model
from home_mjx.bank.packing.pack import check_house_fits, pack_house_slot, pack_house_slots
from home_mjx.bank.records.bank_arrays import get_array, replace_arrays
from home_mjx.bank.records.declaration import Key
from home_mjx.bank.records.gpu_geometry import gpu_geometry
from home_mjx.core.array_store import READ_ERRORS
from home_mjx.core.checks import check_number
from home_mjx.core.progress import ProgressCount, is_progress_shown, plural, track
from home_mjx.datasets.base import Dataset
from home_mjx.errors import ConfigError, HomeMjxError
from home_mjx.houses.bakes import Bake
from home_mjx.houses.house_set import HouseSet
from home_mjx.houses.selection import HouseFilter
from home_mjx.houses.slot_bakes import Records, SlotBakes
from home_mjx.scene_compile.pipeline.compile import DEFAULT_OPTIONS, CompileOptions
from home_mjx.schema.compiled import ARCHITECTURE, CompiledHouse, Model

log = logging.getLogger(__name__)


class _Prepared(NamedTuple):
    """A house packed for a slot, on the device."""

    rows: dict[Key, Array]
    starts: dict[Key, Array]  # first row of each array
    bakes: dict[str, Any]  # baked records by name, with a house axis of length 1
    house_slot: Array


@dataclass
class _Retiring:
    """A house slot that resets no longer draw, and the house that will replace its content."""

    house_slot: int
    since: int  # number of the `advance` call since which no reset draws it
    house: "Future[_Prepared | None]"


class HouseStream:
    """A `HouseBank` with a fixed number of house slots, which a thread fills in turn with the houses of a dataset.

    Models and textures of all houses stay on the device; a slot stores only data private to its house, and its baked
    records. Shapes never change, so nothing is recompiled. To exchange a house, its slot is first retired: resets no
    longer draw it. When no environment uses the slot any more, the next house overwrites it in place.

    Houses should be in the cache (`home-mjx compile ROOT --bakes ...`); otherwise the first pass compiles them, and
    the thread bakes each before its first use.

    Args:
        root: Folder of the dataset, an open `Dataset`, or a `HouseSet`; None: the dataset of `SUNCG_DATA_DIR`.
        ids: House ids; all by default.
        num_slots: Number of houses in the bank at a time.
        num_retiring: Number of slots that are retired at a time.
        capacity_factor: Factor of the capacity over the largest of the first houses. Larger houses are skipped, see
            `skipped`.
        split: Restrict to houses of this split.
        seed: Seed of the order of houses, which is random from the first one and differs in every pass.
        options: Compiler options.
        progress: Show a progress bar while models and textures of all houses are collected.
        filter: Restrict to houses that meet this filter.
        num_houses: Maximum number of houses; the first are taken.
        bakes: Baked records that the bank gets, or their names, see `add_bakes`; those of an environment are
            `HouseholdEnv.bakes`.

    Attributes:
        bank: The current bank. Earlier banks are invalid after `advance`, since their memory is overwritten.
        skipped: Reason for each skipped house, by id.
        num_swaps: Number of houses exchanged so far.

    Raises:
        ConfigError: There are fewer houses than slots, or a value of `bakes` is not a bake.
        UnknownNameError: No bake has this name.

    Example:
        >>> with HouseStream("datasets/suncg", num_slots=64) as stream:  # doctest: +SKIP
        ...     states = reset(stream.bank, keys)
        ...     for _ in range(1000):
        ...         states = step(EnvParams(stream.advance(states.world.house)), states, actions)
    """

    def __init__(
        self,
        root: HouseSet | Dataset | str | Path | None,
        ids: Sequence[str] | None = None,
        *,
        num_slots: int = 8,
        num_retiring: int = 1,
        capacity_factor: float = 1.5,
        split: str | None = None,
        seed: int = 0,
        options: CompileOptions = DEFAULT_OPTIONS,
        progress: bool | None = None,
        filter: HouseFilter | None = None,
        num_houses: int | None = None,
        bakes: Bake | str | Sequence[Bake | str] = (),
    ) -> None:
        for name, value, least in (("num_slots", num_slots, 2), ("num_retiring", num_retiring, 1), ("seed", seed, 0)):
            check_number(name, value, least, integer=True)
        check_number("capacity_factor", capacity_factor, 1)
        choice = {"ids": ids, "split": split, "options": options, "filter": filter, "num_houses": num_houses}
        houses = HouseSet.coerce(root, **choice)
        if not 0 < num_retiring < num_slots:
            raise ConfigError(f"`num_retiring` must be from 1 to num_slots - 1, got {num_retiring} of {num_slots}")
        self.skipped: dict[str, str] = {}
        self.num_swaps = 0
        self._bakes = SlotBakes(bakes)
        self._cache = houses.open_cache()
        self._cache.prepare(houses.house_ids, is_progress_shown(progress))
        models, textures = self._look_through(houses.house_ids, progress)
        self._order = self._endless(houses.house_ids, np.random.default_rng(seed))
        first, records = self._first_houses(num_slots, progress)
        self._library = Library(models, textures, first[0].agent_materials)
        self._capacity, self._stride = capacity_of(first, capacity_factor), slot_stride(first, capacity_factor)
        bank = to_bank(pack_house_slots(first, self._library, self._capacity, self._stride))
        bank = self._bakes.reserve(records, first, bank, capacity_factor)
        # Compiled now, so that the first swap does not have to wait.
        self.bank: HouseBank = _write(bank, self._prepare(first[0], records[0], 0))
        self._calls, self._used, self._closed = 0, None, False
        self._num_envs = 0  # number of environments; 0: not known yet
        self._worker = ThreadPoolExecutor(1, "house-stream")
        self._active = list(range(num_slots))
        self._retiring: list[_Retiring] = []
        for _ in range(num_retiring):
            self._retire()

    def advance(self, houses: Int[Array, "..."]) -> HouseBank:
        """Replace retired houses that no environment uses and whose successor is ready; call it before every step.

        A house counts as unused if the previous call's `houses` lacked it. No call waits for a successor.

        Args:
            houses: House indices of all environments, as in `states.world.house`; empty if no house is in use.

        Returns:
            The bank for the next steps; do not use an earlier one.

        Raises:
            ConfigError: The stream is closed; or the number of indices, unless 0, differs from earlier calls, so that
                a house in use could be overwritten.
            Exception: An error of the background thread that is not a `HomeMjxError`; such errors only skip a house.
        """
        if self._closed:
            raise ConfigError("the stream is closed: it exchanges no more houses", hint="Step inside its `with` block.")
        self._check_all(houses.size)
        used = self._used  # of the previous call, so the host does not wait for the device
        self._calls += 1
        self._used = (self._calls, _slots_in_use(houses, self.bank.num_houses))
        if used is not None:
            call, in_use = used[0], np.asarray(used[1])
            for item in list(self._retiring):
                if item.since < call and not in_use[item.house_slot] and item.house.done():
                    self._exchange(item)
        return self.bank

    def _check_all(self, count: int) -> None:
        """Record the first nonzero count as the number of environments, and validate that later ones equal it or are 0.

        Raises:
            ConfigError: The count differs.
        """
        known = self._num_envs = self._num_envs or count
        if count not in (0, known):
            message = f"expected the house of every environment, of which there were {known}, got {count}"
            raise ConfigError(message, hint="Pass states.world.house of all; open another stream for another batch.")

    def close(self) -> None:
        """Wait for the background thread to stop; `advance` then raises, while `bank` stays valid.

        A house that is being prepared is finished and dropped. A second call does nothing.
        """
        self._closed = True
        self._worker.shutdown(cancel_futures=True)

    def __enter__(self) -> "HouseStream":
        return self

    def __exit__(self, kind: type | None, value: BaseException | None, trace: TracebackType | None) -> None:
        self.close()

    def _look_through(self, ids: Sequence[str], progress: bool | None) -> tuple[dict[str, Model], tuple[str, ...]]:
        """Return the models (the agent's and all library models) and sorted texture paths that the houses use.

        Models of the architecture are left out. Houses that cannot be compiled or read are added to `skipped`.
        """
        agent = agent_model()
        models, textures = {agent.key: agent}, set()
        for house_id in track(ids, f"reading models of {plural(len(ids), 'house')}", "house", progress):
            try:
                notes = self._cache.notes(house_id)
                for key in notes["instances.model"][ARCHITECTURE + 1 :]:
                    models[key] = self._cache.model(key)
                textures.update(filter(None, self._cache.texture_paths(notes)))
            except (HomeMjxError, *READ_ERRORS) as error:
                self.skipped[house_id] = str(error)
        return models, tuple(sorted(textures))

    def _endless(self, ids: Sequence[str], rng: np.random.Generator) -> Iterator[str]:
        """Yield ids of houses that are not skipped, shuffled anew in every pass; end if all are skipped."""
        while any(house_id not in self.skipped for house_id in ids):
            for i in rng.permutation(len(ids)):
                house_id = ids[int(i)]
                if house_id not in self.skipped:
                    yield house_id

    def _first_houses(self, num_slots: int, progress: bool | None) -> tuple[list[CompiledHouse], list[Records]]:
        """Return the first `num_slots` different houses of the order that load, and their baked records.

        Those that fail with a `HomeMjxError` are added to `skipped`, and the next ones are tried.

        Raises:
            ConfigError: Fewer than `num_slots` houses load.
        """
        found: dict[str, tuple[CompiledHouse, Records]] = {}
        with ProgressCount(f"loading {plural(num_slots, 'house')}", num_slots, "house", progress) as count:
            for house_id in self._order:
                if house_id in found:
                    break
                try:
                    house = self._cache.load(house_id)
                    found[house_id] = house, self._bakes.records(house, count)
                except HomeMjxError as error:
                    self._skip(house_id, error)
                    continue
                count.update()
                if len(found) == num_slots:
                    houses, records = zip(*found.values(), strict=True)
                    return list(houses), list(records)
        raise ConfigError(
            f"{num_slots} slots need at least as many houses, there are {len(found)}",
            hint="Use fewer slots, or a HouseBank with all houses.",
        )

    def _retire(self) -> None:
        """Exclude the longest active slot from resets, and prepare its next house in the background thread."""
        house_slot = self._active.pop(0)
        self._draw_active()
        self._retiring.append(_Retiring(house_slot, self._calls, self._worker.submit(self._next, house_slot)))

    def _draw_active(self) -> None:
        """Let resets draw the active slots alone."""
        self.bank = self.bank.replace(
            reset_houses=jnp.asarray(np.resize(self._active, self.bank.num_houses), jnp.int32)
        )

    def _exchange(self, item: _Retiring) -> None:
        """Write the prepared house into a retired slot and retire the next; without one, make the slot active again.

        An error of the background thread comes through.
        """
        self._retiring.remove(item)
        prepared = item.house.result()
        if prepared is None:  # no usable house is left, so the slot keeps its house, and resets draw it again
            self._active.append(item.house_slot)
            self._draw_active()
            return
        self.bank = _write(self.bank, prepared)
        self._active.append(item.house_slot)
        self.num_swaps += 1
        self._retire()

    def _next(self, house_slot: int) -> _Prepared | None:
        """Return the next house that fits, packed for a slot, in the background thread; None if all are in `skipped`.

        Houses that fail or do not fit are added to `skipped`. Other errors than `HomeMjxError` come through.
        """
        for house_id in self._order:
            try:
                house = self._cache.load(house_id)
                check_house_fits(house, self._capacity, self._stride)  # before it is baked
                return self._prepare(house, self._bakes.records(house), house_slot)
            except HomeMjxError as error:
                self._skip(house_id, error)
        return None

    def _skip(self, house_id: str, error: HomeMjxError) -> None:
        """Add a house to `skipped`, with the error's text as the reason, and log a warning."""
        self.skipped[house_id] = str(error)
        log.warning("house %s is skipped: %s", house_id, error)

    def _prepare(self, house: CompiledHouse, records: Records, house_slot: int) -> _Prepared:
        """Return a house packed for a slot, on the device; drop its architecture from the host's library of models.

        Raises:
            CapacityError: The house or one of its baked records does not fit.
        """
        rows, starts = pack_house_slot(house, self._library, self._capacity, self._stride, house_slot)
        bakes = self._bakes.pack(records, house)
        for key in house.instances.model[:1]:
            self._cache.library.pop(key, None)  # drop its architecture; shared models stay
        first = {key: np.int32(row) for key, row in starts.items()}
        return _Prepared(*jax.device_put((rows, first, bakes, np.int32(house_slot))))


@functools.partial(jax.jit, donate_argnums=0)
def _write(bank: HouseBank, house: _Prepared) -> HouseBank:
    """Return the bank with the house in its slot, in the memory of the argument, which becomes invalid."""
    write = functools.partial(jax.lax.dynamic_update_slice_in_dim, axis=0)
    rows = {key: write(get_array(bank, key), values, house.starts[key]) for key, values in house.rows.items()}
    bakes = jax.tree.map(lambda stack, record: write(stack, record, house.house_slot), bank.bakes, house.bakes)
    bank = replace_arrays(bank, rows).replace(bakes=bakes)
    if bank.geometry.gpu is not None:
        bank = bank.replace(geometry=bank.geometry.replace(gpu=gpu_geometry(bank.geometry)))
    return bank


@functools.partial(jax.jit, static_argnums=1)
def _slots_in_use(houses: Int[Array, "..."], num_slots: int) -> Bool[Array, " h"]:
    """Return the mask of slots that some environment uses; `houses` has any shape, also without entries."""
    return jnp.zeros(num_slots, bool).at[houses.reshape(-1)].set(True)
