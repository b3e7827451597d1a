"""Bakes: products of a house that cost many rays once, are stored on disk, and are read on the device.

A bake is named by what it is made from: its name, version and options, the device's platform, and every array of the
compiled house. So the store never returns a stale record. A distribution adds bakes with entry points of the group
`home_mjx.bakes`, whose name is the bake's and whose object makes it with default options.
"""

import hashlib
import logging
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import as_completed
from pathlib import Path
from typing import Any, Protocol, runtime_checkable

import jax
import numpy as np

from home_mjx.bank.bank import HouseBank
from home_mjx.core import workers
from home_mjx.core.array_store import READ_ERRORS, flatten, read_entry, rebuild, write_entry
from home_mjx.core.paths import cache_folder, installed
from home_mjx.core.progress import ProgressCount, plural
from home_mjx.core.workers import max_workers, usable_cores, worker_pool, worker_threads
from home_mjx.errors import ConfigError, UnknownNameError, did_you_mean
from home_mjx.schema.compiled import CompiledHouse

GROUP = "home_mjx.bakes"

CORES_PER_BAKE = 4  # cores for each of the houses that are baked at once: one house has stages of a single thread

log = logging.getLogger(__name__)


@runtime_checkable
class Bake(Protocol):
    """One kind of baked product; its properties may be plain attributes.

    A bake may have `substitutes`, a tuple of bakes with other options. The first of these with a stored record replaces
    the bake's own. A bake may have a `platform`, the JAX backend on which every record is made; without it that is the
    default backend. A bake may have a method `extra_key(house)`, which returns bytes that stand for what the record
    depends on besides arrays of the house, such as textures. With `in_processes` True several houses are baked in
    worker processes, each in a bank of its own: for code whose threads would wait for the interpreter's lock.

    Example:
        >>> class FloorArea:  # doctest: +SKIP
        ...     name, version, options, record, unused = "floor_area", 1, None, Area, frozenset()
        ...
        ...     def bake_house(self, bank, index, house):
        ...         return Area(np.array([...], np.float32))
        ...
        ...     def stack(self, records, houses, bank):
        ...         return jnp.stack([r.value for r in records])
        >>> bank = add_bakes(bank, houses, FloorArea())  # doctest: +SKIP
        >>> bank.bakes["floor_area"]  # doctest: +SKIP
    """

    @property
    def name(self) -> str:
        """Key of `HouseBank.bakes`, and folder of the store."""
        ...

    @property
    def version(self) -> int:
        """Number that is raised whenever the same house and options would give another record."""
        ...

    @property
    def options(self) -> Any:
        """Frozen dataclass of options, part of the key; None without options."""
        ...

    @property
    def record(self) -> type:
        """Class of the record of one house: a dataclass of NumPy arrays, see `core.array_store`."""
        ...

    @property
    def unused(self) -> frozenset[str]:
        """Fields of `CompiledHouse` that the record does not depend on."""
        ...

    def bake_house(self, bank: HouseBank, index: int, house: CompiledHouse) -> Any:
        """Return the record of one house, an instance of `record`; threads may bake several houses at once.

        Args:
            bank: Bank that holds the house.
            index: Index of the house in the bank.
            house: The compiled house.
        """
        ...

    def stack(self, records: Sequence[Any], houses: Sequence[CompiledHouse], bank: HouseBank) -> Any:
        """Return the records, one per house in bank order, as one pytree on the device with a leading house axis.

        Args:
            records: Results of `bake_house`.
            houses: The compiled houses.
            bank: Bank that gets the pytree. In a `HouseStream` its arrays have shapes and types only, and `records` and
                `houses` may be those of one slot.
        """
        ...


@runtime_checkable
class SizedBake(Bake, Protocol):
    """A bake whose records differ in size between houses, for slots of a `HouseStream`, whose shapes never change."""

    def capacity(self, records: Sequence[Any], capacity_factor: float) -> Mapping[str, int]:
        """Return lengths by name that hold a record `capacity_factor` times as large as the largest of `records`."""
        ...

    def stack(
        self,
        records: Sequence[Any],
        houses: Sequence[CompiledHouse],
        bank: HouseBank,
        capacity: Mapping[str, int] | None = None,
    ) -> Any:
        """Return the records as `Bake.stack` does, padded to a result of `capacity`; None: to the largest.

        Raises:
            CapacityError: A record does not fit.
        """
        ...


_REGISTRY: dict[str, Callable[[], Bake]] = {}


def register_bake(name: str, make_bake: Callable[[], Bake]) -> None:
    """Register a function without arguments that makes a bake with default options; it replaces one of the same name.

    Raises:
        ConfigError: The name is empty, or `make_bake` is not callable.
    """
    if not name or not callable(make_bake):
        raise ConfigError(f"a bake needs a name and a function that makes it, got {name!r} and {make_bake!r}")
    _REGISTRY[name] = make_bake


def find_bake(name: str) -> Bake:
    """Return the bake of a name with default options; import and register it if an installed package provides it.

    Errors of that import come through.

    Raises:
        UnknownNameError: No bake has this name.
    """
    if name in _REGISTRY:
        return _REGISTRY[name]()
    if name not in installed(GROUP):
        raise UnknownNameError(f"unknown bake `{name}`", hint=did_you_mean(name, [*_REGISTRY, *installed(GROUP)]))
    register_bake(name, installed(GROUP)[name].load())
    return _REGISTRY[name]()


def add_bakes(
    bank: HouseBank,
    houses: Sequence[CompiledHouse],
    bakes: "Bake | str | Sequence[Bake | str]",
    progress: bool | None = None,
) -> HouseBank:
    """Return a bank with baked records of all its houses in `bakes`; those not in the store are computed and stored.

    Records of other bakes in the bank stay, those of the same name are replaced.

    Args:
        bank: The bank.
        houses: The compiled houses of the bank, in the same order.
        bakes: One or several bakes, or their names.
        progress: Show progress; None: by the rule of `home_mjx.core.progress`.

    Raises:
        ConfigError: The houses are not those of the bank, or a value is not a bake.
        UnknownNameError: No bake has this name.

    Example:
        >>> houses = HouseSet("datasets/demo", num_houses=8).load()  # doctest: +SKIP
        >>> bank = add_bakes(HouseBank.from_compiled(houses), houses, "late_reverb")  # doctest: +SKIP
    """
    given, held = tuple(house.id for house in houses), bank.house_ids
    if given != held:
        raise ConfigError(f"the bank holds houses {held}, but those given are {given}", hint="Give the bank's own.")
    for bake in find_bakes(bakes):
        text = f"loading {bake.name} of {plural(len(houses), 'house')}"
        with ProgressCount(text, len(houses), "house", progress) as count:
            records = _find_records(bake, bank, houses, count)
        bank = bank.replace(bakes={**bank.bakes, bake.name: bake.stack(records, houses, bank)})
    return bank


def _find_records(bake: Bake, bank: HouseBank, houses: Sequence[CompiledHouse], count: ProgressCount) -> list[Any]:
    """Return the records of all houses, in order; those not in the store are computed, several at once."""
    records = []
    for house in houses:
        records.append(read_record(bake, house))
        if records[-1] is not None:
            count.update()
    missing = [index for index, record in enumerate(records) if record is None]
    if not missing:
        return records
    count.describe(f"baking {bake.name} of {plural(len(houses), 'house')} (once, then cached)")
    importable = type(bake).__module__ != "__main__"
    apart = getattr(bake, "in_processes", False) and importable and max_workers(len(missing)) > 1
    made = _bake_in_processes(bake, houses, missing) if apart else _bake_in_threads(bake, bank, houses, missing)
    for index, record in made:
        records[index] = record
        count.update()
    return records


def _bake_in_threads(
    bake: Bake, bank: HouseBank, houses: Sequence[CompiledHouse], missing: Sequence[int]
) -> Iterator[tuple[int, Any]]:
    """Yield indices and records of the houses `missing`, in order."""
    with worker_threads(max(1, usable_cores() // CORES_PER_BAKE)) as pool:
        made = pool.map(lambda index: make_record(bake, bank, index, houses[index]), missing)
        yield from zip(missing, made, strict=True)


def _bake_in_processes(
    bake: Bake, houses: Sequence[CompiledHouse], missing: Sequence[int]
) -> Iterator[tuple[int, Any]]:
    """Yield indices and records of the houses `missing`, as they are ready; processes share the cores equally."""
    processes = max_workers(len(missing))
    threads = -(-usable_cores() // processes)
    with worker_pool(processes, imports_main=False) as pool:
        made = {pool.submit(_bake_alone, bake, houses[index], threads): index for index in missing}
        for future in as_completed(made):
            yield made[future], future.result()


def _bake_alone(bake: Bake, house: CompiledHouse, threads: int) -> Any:
    """Return the record of a house, made and stored by this worker process in a bank of its own."""
    jax.config.update("jax_platforms", getattr(bake, "platform", None))
    workers.thread_limit = threads
    return make_record(bake, HouseBank.from_compiled([house]), 0, house)


def find_bakes(bakes: "Bake | str | Sequence[Bake | str]") -> tuple[Bake, ...]:
    """Return one or several bakes, given by themselves or by name, in their order; an instance is returned unchanged.

    A sequence may be empty, and repeat a bake.

    Raises:
        ConfigError: A value is not a bake.
        UnknownNameError: No bake has this name.
    """
    listed = bakes if isinstance(bakes, Sequence) and not isinstance(bakes, str) else [bakes]
    found = tuple(find_bake(item) if isinstance(item, str) else item for item in listed)
    for item in found:
        if not isinstance(item, Bake):
            raise ConfigError(f"expected a bake or its name, got {item!r}")
    return found


def read_record(bake: Bake, house: CompiledHouse) -> Any:
    """Return one house's stored record: of the first substitute that has one, else of the bake; None without any.

    Corrupted entries are logged and count as missing.

    Args:
        bake: The bake.
        house: The compiled house.
    """
    for stored in (*getattr(bake, "substitutes", ()), bake):
        entry = bake_entry(stored, house)
        try:
            return rebuild(bake.record, *read_entry(entry))
        except FileNotFoundError:
            pass
        except READ_ERRORS as error:
            log.warning("broken cache entry %s is made again: %s", entry, error)
    return None


def make_record(bake: Bake, bank: HouseBank, index: int, house: CompiledHouse) -> Any:
    """Return one house's record, computed even if it is stored, and store it; a failed write is only logged.

    Arguments are as of `Bake.bake_house`.
    """
    record = bake.bake_house(bank, index, house)
    try:
        write_entry(bake_entry(bake, house), *flatten(record))
    except OSError as error:
        log.warning("bake `%s` of house %s is not cached: %s", bake.name, house.id, error)
    return record


def bake_entry(bake: Bake, house: CompiledHouse) -> Path:
    """Return the path of a record in the store, whether or not it exists.

    Its name is a digest of the bake, its platform and the content of the house that the bake uses.

    Args:
        bake: The bake.
        house: The compiled house.
    """
    platform = getattr(bake, "platform", None) or jax.default_backend()
    key = hashlib.sha256(repr((bake.name, bake.version, bake.options, platform)).encode())
    arrays, notes = flatten(house, skip=frozenset(("models", *bake.unused)))
    key.update(repr((sorted(arrays), notes["instances.model"])).encode())
    meshes = [house.models[name].triangle for name in sorted(house.models)]
    for array in (*(arrays[name] for name in sorted(arrays)), *meshes):
        key.update(np.ascontiguousarray(array).tobytes())
    extra = getattr(bake, "extra_key", None)
    key.update(extra(house) if extra is not None else b"")
    return cache_folder() / "bakes" / bake.name / f"{key.hexdigest()}.zip"
