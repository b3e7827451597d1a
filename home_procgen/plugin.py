"""What this package plugs into `home_mjx`: houses by a name such as `procedural:16?seed=100`, and fallback models.

Importing this module is cheap: generators are imported when a house is written.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import overload
from urllib.parse import parse_qsl

import numpy as np
from jaxtyping import Float

from home_mjx.core.checks import check_known, check_number
from home_mjx.core.paths import cache_folder
from home_mjx.datasets.base import DEFAULT_OPTIONS, ReadOptions
from home_mjx.datasets.seeds import MAX_LOOKUP_SEED, find_seeds, house_id
from home_mjx.datasets.suncg.dataset import SuncgDataset
from home_mjx.errors import ConfigError, UnknownIdError
from home_mjx.schema.house import House, Mesh

SCHEME = "procedural"
NAME_FORMAT_HINT = "Write `procedural:N` or `procedural:N?seed=S&version=V`, all whole numbers; V is 1 or 3."
VERSIONS = (1, 3)  # of the generators, see `home_procgen.generate`
DEFAULT_VERSION = 1


@dataclass(frozen=True)
class ProceduralName:
    """Parts of a name such as `procedural:16?seed=100&version=3`.

    Attributes:
        count: Number of houses.
        seed: Seed of the first one; the others follow.
        version: Version of the generator.

    Raises:
        ConfigError: A number is out of range, or no generator has this version.
    """

    count: int
    seed: int = 0
    version: int = DEFAULT_VERSION

    def __post_init__(self) -> None:
        check_number("N", self.count, 1, integer=True)
        check_number("seed", self.seed, 0, integer=True)
        if isinstance(self.version, bool) or self.version not in VERSIONS:
            raise ConfigError(
                f"no generator of houses has version {self.version!r}",
                hint=f"Write `version=` with one of {', '.join(map(str, VERSIONS))}: `procedural:4?version=3`.",
            )

    @classmethod
    def parse(cls, text: str) -> "ProceduralName":
        """Parse the text after the scheme.

        Raises:
            ConfigError: The text is malformed or has an unknown option.

        Example:
            >>> ProceduralName.parse("16?seed=100")
            ProceduralName(count=16, seed=100, version=1)
        """
        count, _, options = text.partition("?")
        try:
            pairs = dict(parse_qsl(options, keep_blank_values=True, strict_parsing=bool(options)))
            check_known("option of generated houses", pairs, ("seed", "version"))
            return cls(int(count), **{name: int(value) for name, value in pairs.items()})
        except ValueError as error:
            if isinstance(error, ConfigError):
                raise
            raise ConfigError(f"`{SCHEME}:{text}` does not name generated houses", hint=NAME_FORMAT_HINT) from None


class SeedIds(Sequence[str]):
    """Ids of the houses of consecutive seeds, computed on demand."""

    def __init__(self, seeds: range) -> None:
        self.seeds = seeds

    def __len__(self) -> int:
        return len(self.seeds)

    @overload
    def __getitem__(self, index: int) -> str: ...
    @overload
    def __getitem__(self, index: slice) -> Sequence[str]: ...
    def __getitem__(self, index: int | slice) -> str | Sequence[str]:
        picked = self.seeds[index]
        return SeedIds(picked) if isinstance(picked, range) else house_id(picked)


class ProceduralDataset(SuncgDataset):
    """Generated houses of consecutive seeds, in SUNCG's on-disk format; `prepare` writes the missing ones.

    Houses are written to the cache folder, one dataset per generator version.

    Args:
        text: What follows the scheme, such as `16?seed=100`.

    Raises:
        ConfigError: The text is not valid.
    """

    shares_root = True
    reader = SuncgDataset.reader  # compiled houses are those of the folder

    def __init__(self, text: str) -> None:
        self.parsed = ProceduralName.parse(text)
        self._by_id: dict[str, int] = {}  # seeds of the ids computed so far, in ascending order
        super().__init__(cache_folder().absolute() / f"generated-v{self.parsed.version}")
        self.name = f"{SCHEME}:{text}"
        self._written: set[str] = set()

    @property
    def house_ids(self) -> Sequence[str]:
        """Ids of the houses, in the order of their seeds."""
        return SeedIds(range(self.parsed.seed, self.parsed.seed + self.parsed.count))

    @property
    def fallbacks(self) -> str:
        """Empty: no model is missing, so none is replaced."""
        return ""

    def prepare(self, house_ids: Sequence[str], progress: bool = False) -> None:
        """Write the houses that are not on disk yet, with worker processes if there are many.

        Raises:
            UnknownIdError: An id is not among `house_ids`.
            DatasetError: The cache folder cannot be written to.
        """
        wanted = [name for name in house_ids if name not in self._written]
        if wanted:
            from home_procgen.generate import generate_dataset

            seeds = self._seeds(wanted)
            generate_dataset(self.root, seeds, progress, self.parsed.version)
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
        known, last = range(self.parsed.seed, self.parsed.seed + self.parsed.count), len(self._by_id)
        for seed in known[last:]:
            if all(name in self._by_id for name in ids):
                break
            self._by_id[house_id(seed)] = seed
        missing = [name for name in ids if name not in self._by_id]
        if missing:
            if self.parsed.count == MAX_LOOKUP_SEED:
                find_seeds(missing)  # raises with its hint
            raise UnknownIdError(f"`{self.name}` has no house `{missing[0]:.100}`")
        return [self._by_id[name] for name in ids]


class GeneratedModels:
    """Provider of fallback models: generator models, stretched to the bounding box of the missing model."""

    version = "v1-1"  # increase it whenever the same arguments would return another mesh

    def __call__(
        self, path: Path, fine: str, bounds: Float[np.ndarray, "2 3"] | None, closed: bool
    ) -> tuple[Mesh, str]:
        """Return a mesh and its description; see `home_procgen.fallback_models.make_fallback_model`."""
        from home_procgen.fallback_models import make_fallback_model

        return make_fallback_model(path, fine, bounds, closed)


fallback_models = GeneratedModels()
