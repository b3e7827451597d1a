"""Selection of houses of a dataset and their compile options, shared by bank, stream, job and command line."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import islice
from pathlib import Path
from typing import Any

from home_mjx.core.checks import check_known, check_number, check_type
from home_mjx.core.progress import ProgressCount, is_progress_shown, plural
from home_mjx.datasets.base import Dataset
from home_mjx.datasets.registry import has_scheme, open_dataset
from home_mjx.datasets.splits import SPLITS
from home_mjx.errors import ConfigError
from home_mjx.houses.house_cache import HouseCache
from home_mjx.houses.pools import compile_missing
from home_mjx.houses.selection import HouseFilter
from home_mjx.scene_compile.pipeline.compile import DEFAULT_OPTIONS, CompileOptions
from home_mjx.schema.compiled import CompiledHouse


@dataclass(frozen=True)
class HouseSet:
    """Houses of a dataset, and their compile options.

    Attributes:
        dataset: Root folder, an open dataset, or a name such as `procedural:16?seed=0`; None: the dataset
            that `SUNCG_DATA_DIR` names.
        ids: House ids, in this order, repeated ones repeatedly; None: all, in the order of the dataset. Unknown ones
            raise an error when they are compiled, not before.
        split: Restrict to `train`, `val` or `test`; None: all.
        filter: Restrict to houses that this filter accepts; None: all.
        num_houses: Maximum number of houses, taken from the start of the selection; None: all.
        options: Compile options.

    Raises:
        ConfigError: An option is invalid.

    Example:
        >>> beds = HouseSet("houses", split="train", filter=HouseFilter(categories=("bed",)))
        >>> beds.house_ids  # doctest: +SKIP
        ('0004d52d1aeeb8ae6de39d6bd993e992',)
    """

    dataset: Dataset | str | Path | None = None
    ids: Sequence[str] | None = None
    split: str | None = None
    filter: HouseFilter | None = None
    num_houses: int | None = None
    options: CompileOptions = DEFAULT_OPTIONS

    def __post_init__(self) -> None:
        if self.dataset is not None and not isinstance(self.dataset, Dataset | str | Path):
            raise ConfigError(f"`dataset` must be the folder of a dataset or an open one, got {self.dataset!r}")
        if has_scheme(self.dataset):
            _ = self.resolved_dataset  # refuses a wrong name now
        if isinstance(self.ids, str):
            raise ConfigError(f"`ids` must be a sequence of ids, got `{self.ids}`", hint="Write a single id as [id].")
        if self.ids is not None:
            object.__setattr__(self, "ids", tuple(self.ids))
        if self.split is not None:
            check_known("split", [self.split], SPLITS)
        if self.filter is not None:
            check_type("filter", self.filter, HouseFilter)
        if self.num_houses is not None:
            check_number("num_houses", self.num_houses, 1, integer=True)
        check_type("options", self.options, CompileOptions)

    @classmethod
    def coerce(cls, houses: "HouseSet | Dataset | str | Path | None", **choice: Any) -> "HouseSet":
        """Return a `HouseSet` unchanged, or make one from a dataset and the other arguments of a function.

        Args:
            houses: A `HouseSet`, or a value of its field `dataset`.
            **choice: Other fields. Next to a `HouseSet`, only None and the default options are allowed.

        Raises:
            ConfigError: A `HouseSet` is given together with another choice.
        """
        if not isinstance(houses, HouseSet):
            return cls(houses, **choice)
        twice = [name for name, value in choice.items() if value is not None and value != DEFAULT_OPTIONS]
        if twice:
            raise ConfigError(f"`{twice[0]}` is chosen beside a HouseSet", hint="Choose it in the HouseSet.")
        return houses

    @cached_property
    def resolved_dataset(self) -> Dataset:
        """The open dataset.

        Raises:
            DatasetError: There is none.
        """
        return self.dataset if isinstance(self.dataset, Dataset) else open_dataset(self.dataset)

    @property
    def is_complete(self) -> bool:
        """True if no field restricts the houses, and the dataset's folder has no others (`shares_root` is False)."""
        return (
            self.ids is None
            and self.split is None
            and self.filter is None
            and self.num_houses is None
            and not self.resolved_dataset.shares_root
        )

    @cached_property
    def house_ids(self) -> tuple[str, ...]:
        """Ids of the houses, in order. With `filter`, houses that are not in the cache are compiled.

        Raises:
            ConfigError: No house is left.
            DatasetError: The dataset, or with `filter` a house, is missing or broken.
        """
        return self._require_houses(tuple(self._choose(self.open_cache())))

    def open_cache(self) -> HouseCache:
        """Return a new cache of the dataset's compiled houses, with the set's compile options."""
        return HouseCache(self.resolved_dataset, self.options)

    def load(self, progress: bool | None = None) -> list[CompiledHouse]:
        """Return the compiled houses, in order, with shared models; houses that are not in the cache are compiled.

        Many are compiled in worker processes, except with `filter`.

        Args:
            progress: Show progress; None: by the rule of `home_mjx.core.progress`.

        Raises:
            ConfigError: No house is left.
            DatasetError: The dataset or one of the houses is missing or broken.
        """
        cache, total = self.open_cache(), self.num_houses
        if self.filter is None:
            cache.prepare(self.house_ids, is_progress_shown(progress))
            compile_missing(cache, self.house_ids, progress)
            total = len(self.house_ids)
        what = "houses" if total is None else plural(total, "house")
        with ProgressCount(f"loading {what}", total, "house", progress) as count:
            cache.on_compile = lambda: count.describe(f"loading {what}, compiling those that are not cached")
            houses = []
            for house_id in self._choose(cache):
                houses.append(cache.load(house_id))
                count.update()
        return list(self._require_houses(tuple(houses)))

    def _choose(self, cache: HouseCache) -> Iterator[str]:
        """Yield the ids of the selected houses in order; with `filter`, compile no more houses than necessary."""
        known = self.resolved_dataset.house_ids if self.ids is None else self.ids
        found = (i for i in known if self.split is None or self.resolved_dataset.split_of(i) == self.split)
        wanted = (i for i in found if self.filter is None or self.filter.matches(cache.contents(i)))
        yield from islice(wanted, self.num_houses)

    def _require_houses(self, found: tuple[Any, ...]) -> tuple[Any, ...]:
        """Return `found` unchanged; raise `ConfigError`, which names split and filter, if it is empty."""
        if not found:
            known = self.resolved_dataset.house_ids
            limits = (f"are in the split `{self.split}`" if self.split else "", "fit the filter" if self.filter else "")
            which = f": none of its {len(known)} houses {' and '.join(filter(None, limits))}" if any(limits) else ""
            hint = "Choose another split, a wider filter or more houses." if which else None
            raise ConfigError(f"no house of the dataset was chosen{which}", hint=hint)
        return found
