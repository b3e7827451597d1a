"""A bank whose houses change while environments run: for datasets that are larger than memory."""

import functools
import logging
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Int
from tqdm import tqdm

from home_mjx.bank.bank import HouseBank, to_bank
from home_mjx.bank.packing.agent_model import agent_model
from home_mjx.bank.packing.capacity import capacity_of, row_stride
from home_mjx.bank.packing.library import Library
from home_mjx.bank.packing.pack import pack_house_slot, pack_house_slots
from home_mjx.bank.records.bank_arrays import array_of, with_arrays
from home_mjx.bank.records.declaration import Key
from home_mjx.bank.records.gpu_geometry import gpu_geometry
from home_mjx.core.array_store.entry import BROKEN
from home_mjx.core.checks import check_number
from home_mjx.datasets.base import Dataset
from home_mjx.errors import ConfigError, HomeMjxError
from home_mjx.houses.house_set import HouseSet
from home_mjx.houses.selection import HouseFilter
from home_mjx.scene_compile.pipeline.compile import DEFAULT_OPTIONS, CompileOptions
from home_mjx.schema.compiled import ARCHITECTURE, CompiledHouse, Model

log = logging.getLogger(__name__)

Prepared = tuple[str, dict[Key, Array], dict[Key, Array]]  # house id, rows, and where they begin


@dataclass
class _Retiring:
    """A house slot that no reset draws any more, and the house that will take it."""

    house_slot: int
    since: int  # the call of `advance` from which on no reset draws it
    house: "Future[Prepared | None]"


class HouseStream:
    """A `HouseBank` of a fixed number of house slots, which a thread fills with the houses of a dataset in turn.

    Models and textures of all houses stay on the device; a house slot holds what is a house's own. Shapes never
    change, so nothing is compiled again. A slot is first retired: resets stop drawing it. When no environment is in it
    any more, the next house is written over it, in place.

    Houses should be in the cache (`home-mjx compile ROOT`), or the first pass compiles them.

    Args:
        root: Folder of the dataset, an open one, or a `HouseSet`; None: the dataset that `SUNCG_DATA_DIR` names.
        ids: Which houses; all by default.
        num_slots: Houses in the bank at a time.
        spare: How many of them may be retired at a time.
        headroom: How many times as large as the largest of the first houses a house may be. Houses that do not fit are
            skipped, see `skipped`.
        split: Only houses of this split.
        seed: Of the order, which is another one in every pass over the dataset.
        options: How to compile.
        progress: Show a progress bar while all houses are looked through.
        where: Only houses that have all this.
        num_houses: Only the first so many of them.

    Attributes:
        bank: The bank as it is now. The one before is gone once `advance` was called: its memory is written over.
        skipped: Reason by id of each house that cannot be shown.
        swaps: Houses exchanged so far.

    Raises:
        ConfigError: There are fewer houses than slots.

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
        spare: int = 1,
        headroom: float = 1.5,
        split: str | None = None,
        seed: int = 0,
        options: CompileOptions = DEFAULT_OPTIONS,
        progress: bool = False,
        where: HouseFilter | None = None,
        num_houses: int | None = None,
    ) -> None:
        for name, value, least in (("num_slots", num_slots, 2), ("spare", spare, 1), ("seed", seed, 0)):
            check_number(name, value, least, whole=True)
        check_number("headroom", headroom, 1)
        choice = {"ids": ids, "split": split, "options": options, "where": where, "num_houses": num_houses}
        houses = HouseSet.of(root, **choice)
        if not 0 < spare < num_slots:
            raise ConfigError(f"`spare` must be from 1 to num_slots - 1, got {spare} of {num_slots}")
        self.skipped: dict[str, str] = {}
        self.swaps = 0
        self._cache = houses.open_cache()
        houses.opened.prepare(houses.house_ids, progress)
        models, textures = self._look_through(houses.house_ids, progress)
        self._order = self._endless(houses.house_ids, np.random.default_rng(seed))
        first = self._first_houses(num_slots)
        self._library = Library(models, textures, first[0].agent_materials)
        self._capacity, self._stride = capacity_of(first, headroom), row_stride(first, headroom)
        self.bank: HouseBank = to_bank(pack_house_slots(first, self._library, self._capacity, self._stride))
        self.bank = _write(
            self.bank, *self._prepare(first[0], 0)[1:]
        )  # compiled now, so that the first swap does not wait
        self._calls, self._used, self._closed = 0, None, False
        self._num_envs = 0  # of which there were indices; 0: not known yet
        self._worker = ThreadPoolExecutor(1, "house-stream")
        self._active = list(range(num_slots))
        self._retiring: list[_Retiring] = []
        for _ in range(spare):
            self._retire()

    def advance(self, houses: Int[Array, "..."]) -> HouseBank:
        """Exchanges a house if one is ready; call it before every step, or as often as houses may change.

        Args:
            houses: House index of every environment that there is, as in `states.world.house`.

        Returns:
            The bank for the next steps; do not use an earlier one.

        Raises:
            ConfigError: The stream is closed; or there are indices of more or fewer environments than before, so that a
                house that somebody is in could be written over.
        """
        if self._closed:
            raise ConfigError("the stream is closed: no house comes any more", hint="Step inside its `with` block.")
        self._check_all(houses.size)
        used = self._used  # of the last call: it is known by now, so nothing waits for the device
        self._calls += 1
        self._used = (self._calls, _slots_in_use(houses, self.bank.num_houses))
        if used is not None:
            call, in_use = used[0], np.asarray(used[1])
            for item in list(self._retiring):
                if item.since < call and not in_use[item.house_slot] and item.house.done():
                    self._exchange(item)
        return self.bank

    def _check_all(self, count: int) -> None:
        """Refuses indices of some of the environments; without any there are none to be hurt."""
        known = self._num_envs = self._num_envs or count
        if count not in (0, known):
            message = f"expected the house of every environment, of which there were {known}, got {count}"
            raise ConfigError(message, hint="Give states.world.house of all; open another stream for another batch.")

    def close(self) -> None:
        """Ends the thread."""
        self._closed = True
        self._worker.shutdown(cancel_futures=True)

    def __enter__(self) -> "HouseStream":
        return self

    def __exit__(self, kind: type | None, value: BaseException | None, trace: TracebackType | None) -> None:
        self.close()

    def _look_through(self, ids: Sequence[str], progress: bool) -> tuple[dict[str, Model], tuple[str, ...]]:
        """Every model and texture of the houses; those that cannot be compiled are skipped."""
        agent = agent_model()
        models, textures = {agent.key: agent}, set()
        for house_id in tqdm(ids, desc="models", unit="house", disable=not progress):
            try:
                notes = self._cache.notes(house_id)
                for key in notes["instances.model"][ARCHITECTURE + 1 :]:
                    models[key] = self._cache.model(key)
                textures.update(filter(None, self._cache.textures(notes)))
            except (HomeMjxError, *BROKEN) as error:
                self.skipped[house_id] = str(error)
        return models, tuple(sorted(textures))

    def _endless(self, ids: Sequence[str], rng: np.random.Generator) -> Iterator[str]:
        """Ids of houses that are not skipped, every pass in another order; ends if none is left."""
        while any(house_id not in self.skipped for house_id in ids):
            for i in rng.permutation(len(ids)):
                house_id = ids[int(i)]
                if house_id not in self.skipped:
                    yield house_id

    def _first_houses(self, num_slots: int) -> list[CompiledHouse]:
        houses: dict[str, CompiledHouse] = {}
        for house_id in self._order:
            if house_id in houses:
                break
            houses[house_id] = self._cache.load(house_id)
            if len(houses) == num_slots:
                return list(houses.values())
        raise ConfigError(
            f"{num_slots} slots need at least as many houses, there are {len(houses)}",
            hint="Use fewer slots, or a HouseBank: it holds all houses.",
        )

    def _retire(self) -> None:
        """Takes the slot that was filled first out of what resets draw, and has the next house made ready for it."""
        house_slot = self._active.pop(0)
        self.bank = self.bank.replace(draw=jnp.asarray(np.resize(self._active, self.bank.num_houses), jnp.int32))
        self._retiring.append(_Retiring(house_slot, self._calls, self._worker.submit(self._next, house_slot)))

    def _exchange(self, item: _Retiring) -> None:
        self._retiring.remove(item)
        prepared = item.house.result()
        if prepared is None:  # no house is left that could be shown: the slot stays as it is
            return
        _, rows, starts = prepared
        self.bank = _write(self.bank, rows, starts)
        self._active.append(item.house_slot)
        self.swaps += 1
        self._retire()

    def _next(self, house_slot: int) -> Prepared | None:
        """The next house that fits, made ready for a slot; in the thread."""
        for house_id in self._order:
            try:
                return self._prepare(self._cache.load(house_id), house_slot)
            except HomeMjxError as error:
                self.skipped[house_id] = str(error)
                log.warning("house %s is skipped: %s", house_id, error)
        return None

    def _prepare(self, house: CompiledHouse, house_slot: int) -> Prepared:
        """Raises `CapacityError` if the house does not fit."""
        rows, starts = pack_house_slot(house, self._library, self._capacity, self._stride, house_slot)
        for key in house.instances.model[:1]:
            self._cache.library.pop(key, None)  # its architecture; models stay
        return house.id, jax.device_put(rows), jax.device_put({k: np.int32(v) for k, v in starts.items()})


@functools.partial(jax.jit, donate_argnums=0)
def _write(bank: HouseBank, rows: Mapping[Key, Array], starts: Mapping[Key, Array]) -> HouseBank:
    """The bank with other rows, in the same memory."""
    write = functools.partial(jax.lax.dynamic_update_slice_in_dim, axis=0)
    bank = with_arrays(bank, {key: write(array_of(bank, key), values, starts[key]) for key, values in rows.items()})
    if bank.geometry.gpu is not None:
        bank = bank.replace(geometry=bank.geometry.replace(gpu=gpu_geometry(bank.geometry)))
    return bank


@functools.partial(jax.jit, static_argnums=1)
def _slots_in_use(houses: Int[Array, "..."], num_slots: int) -> Bool[Array, " h"]:
    return jnp.zeros(num_slots, bool).at[houses.reshape(-1)].set(True)
