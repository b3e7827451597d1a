"""Plugin of `home_mjx`: houses by a name such as `procedural:16?seed=100`, and fallback models.

Importing this module is cheap: generators are imported when a house is written.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import overload
from urllib.parse import parse_qsl

import numpy as np
from jaxtyping import Float

from home_mjx.core.checks import check_known, check_number
from home_mjx.core.paths import cache_folder
from home_mjx.datasets.base import DEFAULT_OPTIONS, ReadOptions
from home_mjx.datasets.furniture import FurnitureProvider
from home_mjx.datasets.seeds import house_id, parse_house_id
from home_mjx.datasets.suncg.dataset import SuncgDataset
from home_mjx.errors import ConfigError, UnknownIdError
from home_mjx.schema.house import House, Mesh
from home_procgen.presets import GENERATOR_VERSION, HOME_VARIANT, Variant
from home_procgen.shipped import ShippedHomes

SCHEME = "procedural"
MAX_SEED = 2**63 - 1
NAME_FORMAT_HINT = "Write `procedural:N` or `procedural:N?seed=S&preset=flat`; N and S are whole numbers."
OPTIONS = ("seed", "preset", "detail")
VERSION_HINT = "Leave it out; flats, as of version 1, are `preset=flat`, homes of several storeys are the default."


@dataclass(frozen=True)
class ProceduralName:
    """Parts of a name such as `procedural:16?seed=100&preset=flat`.

    Attributes:
        count: Number of houses.
        seed: Seed of the first one; the others follow.
        variant: Preset and detail.

    Raises:
        ConfigError: A number is out of range.
    """

    count: int
    seed: int = 0
    variant: Variant = HOME_VARIANT

    def __post_init__(self) -> None:
        check_number("N", self.count, 1, MAX_SEED, integer=True)
        check_number("seed", self.seed, 0, MAX_SEED, integer=True)

    @classmethod
    def parse(cls, text: str) -> "ProceduralName":
        """Parse the text after the scheme.

        Raises:
            ConfigError: The text is malformed, or an option, the preset or the detail is unknown.

        Example:
            >>> ProceduralName.parse("16?seed=100&preset=flat").variant.detail
            'low'
        """
        count, _, options = text.partition("?")
        try:
            listed = parse_qsl(options, keep_blank_values=True, strict_parsing=bool(options))
            pairs = dict(listed)
            if "version" in pairs:
                message = f"generated houses have no option `version`: all are of version {GENERATOR_VERSION}"
                raise ConfigError(message, hint=VERSION_HINT)
            check_known("option of generated houses", pairs, OPTIONS)
            if len(pairs) < len(listed):
                twice = next(name for number, (name, _) in enumerate(listed) if name in dict(listed[:number]))
                raise ConfigError(f"name of generated houses has `{twice}` twice", hint="Leave one of them out.")
            return cls(_whole(count), _whole(pairs.pop("seed", "0")), Variant(**pairs))
        except ValueError as error:
            if isinstance(error, ConfigError):
                raise
            raise ConfigError(f"`{SCHEME}:{text}` does not name generated houses", hint=NAME_FORMAT_HINT) from None


def _whole(text: str) -> int:
    """Return a whole number in decimal digits; `ValueError` for others, such as `1_0`, which `int` reads."""
    if not re.fullmatch(r"-?[0-9]{1,30}", text.strip()):
        raise ValueError(text)
    return int(text)


class SeedIds(Sequence[str]):
    """Ids of the houses of consecutive seeds, computed on demand."""

    def __init__(self, seeds: range, variant: int) -> None:
        self.seeds, self.variant = seeds, variant

    def __len__(self) -> int:
        return len(self.seeds)

    @overload
    def __getitem__(self, index: int) -> str: ...
    @overload
    def __getitem__(self, index: slice) -> Sequence[str]: ...
    def __getitem__(self, index: int | slice) -> str | Sequence[str]:
        picked = self.seeds[index]
        return SeedIds(picked, self.variant) if isinstance(picked, range) else house_id(picked, self.variant)


class ProceduralDataset(SuncgDataset):
    """Generated houses of consecutive seeds, in SUNCG's on-disk format; `prepare` writes the missing ones.

    Houses are written to the cache folder, one dataset per variant.

    Args:
        text: What follows the scheme, such as `16?seed=100&preset=flat`.

    Raises:
        ConfigError: The text is not valid.
    """

    shares_root = True
    reader = SuncgDataset.reader  # compiled houses are those of the folder

    def __init__(self, text: str) -> None:
        self.parsed = ProceduralName.parse(text)
        super().__init__(cache_folder().absolute() / f"generated-{self.parsed.variant.text}")
        self.name = f"{SCHEME}:{text}"
        self._written: set[str] = set()

    @property
    def house_ids(self) -> Sequence[str]:
        """Ids of the houses, in the order of their seeds."""
        seeds = range(self.parsed.seed, self.parsed.seed + self.parsed.count)
        return SeedIds(seeds, self.parsed.variant.number)

    @property
    def fallbacks(self) -> str:
        """Empty: no model is missing, so none is replaced."""
        return ""

    @property
    def shipped(self) -> ShippedHomes | None:
        """Shipped default homes; None for other variants."""
        return ShippedHomes(self.root, self.parsed.variant) if self.parsed.variant == HOME_VARIANT else None

    def resolved(self, options: ReadOptions) -> ReadOptions:
        """Return the options with a `strict` of None replaced by True, whether or not a house is on disk yet."""
        return options if options.strict is not None else replace(options, strict=True)

    def prepare(self, house_ids: Sequence[str], progress: bool = False) -> None:
        """Write the houses that are not on disk yet, with worker processes if there are many.

        Raises:
            UnknownIdError: An id is not among `house_ids`.
            DatasetError: The cache folder cannot be written to.
        """
        wanted = [name for name in house_ids if name not in self._written]
        if wanted:
            from home_procgen.generate import generate_dataset

            variant = self.parsed.variant
            generate_dataset(self.root, self._seeds(wanted), progress, variant.preset, variant.detail)
            self._written.update(wanted)

    def load_house(self, house_id: str, options: ReadOptions = DEFAULT_OPTIONS) -> House:
        """Read a house; write it first if it is missing."""
        self.prepare((house_id,))
        return super().load_house(house_id, options)

    def check_known(self, house_id: str) -> None:
        """Raise `UnknownIdError` if the id is not the id of one of the seeds."""
        self._seeds((house_id,))

    def __reduce__(self) -> tuple[type["ProceduralDataset"], tuple[str]]:
        return ProceduralDataset, (self.name.partition(":")[2],)

    def _seeds(self, ids: Sequence[str]) -> list[int]:
        """Return the seeds of ids, in their order; raise `UnknownIdError` for an id of no seed."""
        first, variant = self.parsed.seed, self.parsed.variant.number
        keys = [parse_house_id(name) for name in ids]
        for name, key in zip(ids, keys, strict=True):
            if key is None:
                hint = "Name its dataset: `houses=` in Python, `--dataset` on the command line."
                raise UnknownIdError(f"`{self.name}` has no house `{name:.100}`, which is not generated", hint=hint)
            if key.variant != variant:
                hint = f"Ids of its houses begin with `{house_id(0, variant)[:16]}`: choose another preset or detail."
                raise UnknownIdError(f"`{self.name}` has no house `{name}` of another variant", hint=hint)
            if not first <= key.seed < first + self.parsed.count:
                hint = f"Its seeds are {first} to {first + self.parsed.count - 1}, that of the house is {key.seed}."
                raise UnknownIdError(f"`{self.name}` has no house `{name}`", hint=hint)
        return [key.seed for key in keys if key is not None]


class GeneratedModels:
    """Provider of fallback models: generator models, stretched to the bounding box of the missing model."""

    version = "home-1"  # increase it whenever the same arguments would return another mesh

    def __call__(
        self, path: Path, fine: str, bounds: Float[np.ndarray, "2 3"] | None, closed: bool
    ) -> tuple[Mesh, str]:
        """Return a mesh and its description; see `home_procgen.fallback_models.make_fallback_model`."""
        from home_procgen.fallback_models import make_fallback_model

        return make_fallback_model(path, fine, bounds, closed)

    def furniture(self) -> FurnitureProvider:
        """Return furniture for datasets whose own models are not public."""
        from home_procgen.foreign.provider import ForeignFurniture

        return ForeignFurniture()


fallback_models = GeneratedModels()
