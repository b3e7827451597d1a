"""Dataset `procthor:PATH`: houses of ProcTHOR and its dialects, in furniture of our own."""

import hashlib
import logging
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cache, cached_property
from pathlib import Path
from typing import ClassVar

from home_mjx.core.paths import cache_folder
from home_mjx.datasets.base import DEFAULT_OPTIONS, Dataset, FileDigests, ReadOptions, code_digest
from home_mjx.datasets.furniture import furniture_provider, textures_of, with_texture_root
from home_mjx.datasets.procthor.assets import AssetTable, find_database, read_assets
from home_mjx.datasets.procthor.build import HouseBuilder
from home_mjx.datasets.procthor.parse import parse_house
from home_mjx.datasets.procthor.source import (
    ProcthorName,
    ProcthorSource,
    parse_text,
    recognizes_procthor,
    text_digest,
)
from home_mjx.datasets.splits import SPLITS
from home_mjx.datasets.suncg.formats.json_value import JsonValue
from home_mjx.datasets.taxonomy import CLASSES, TABLE
from home_mjx.errors import DatasetError
from home_mjx.schema.house import Fallback, House, Metadata, ModelInfo

SCHEME = "procthor"
FOLDER = "own-furniture"  # in the cache folder: textures of our furniture in houses of other datasets
log = logging.getLogger(__name__)


class ProcthorDataset(Dataset):
    """Houses of ProcTHOR. Their models are not public: our own furniture has their category, front and size.

    Args:
        text: What follows the scheme, such as `train.jsonl.gz?first=0&count=100`, or a path.

    Raises:
        ConfigError: The text is not valid.
        MissingFileError: The file does not exist or has no house.

    Example:
        >>> dataset = open_dataset("procthor:train.jsonl.gz?count=100")  # doctest: +SKIP
        >>> len(dataset.load_house("train_00003").levels[0].rooms)  # doctest: +SKIP
        4
    """

    shares_root = True
    recognizes: ClassVar[Callable[[Path], bool]] = staticmethod(recognizes_procthor)

    def __init__(self, text: str) -> None:
        self.parsed = ProcthorName.parse(text)
        super().__init__(cache_folder().absolute() / FOLDER, f"{SCHEME}:{text}")
        self.source = ProcthorSource(self.parsed)
        self._database = find_database(self.parsed.assets, self.parsed.path)
        self._written: set[str] = set()

    @cached_property
    def house_ids(self) -> tuple[str, ...]:
        """Ids of the houses, in the order of files and lines."""
        return tuple(self.source.houses)

    @cached_property
    def assets(self) -> AssetTable:
        """Kinds and sizes of the models; empty if there is no asset database."""
        return read_assets(self._database)

    @cached_property
    def metadata(self) -> Metadata:
        """One row per fine category, which is the id of the models that show it."""
        return Metadata({fine: ModelInfo(fine, fine, *classes) for fine, classes in self.classes.items()})

    @cached_property
    def classes(self) -> Mapping[str, tuple[str, str]]:
        """Coarse and NYU40 category by fine one."""
        return {**CLASSES, **furniture_provider().categories()}

    def load_house(self, house_id: str, options: ReadOptions = DEFAULT_OPTIONS) -> House:
        """Read one house, and write the textures that it uses.

        Raises:
            UnknownIdError: No house has this id.
            DatasetError: The house is broken; the message names the line or the element.
        """
        self.check_known(house_id)
        text, options = self.source.houses[house_id], self.resolved(options)
        provider = furniture_provider()
        document = JsonValue(text.file, text.place, parse_text(text))
        records = parse_house(document)
        builder = HouseBuilder(records, text.file, self.assets, provider, options, self.classes)
        house = builder.build(house_id)
        names = textures_of(house) - self._written
        provider.write_textures(self.root, names)
        self._written |= names
        self.warn_fallbacks(house_id, house.fallbacks)
        return with_texture_root(house, self.root)

    def split_of(self, house_id: str) -> str:
        """Return the official split of a house of `train`, `val` or `test`; of other files as of any dataset."""
        stem = house_id.rpartition("_")[0]
        return stem if stem in SPLITS else super().split_of(house_id)

    def resolved(self, options: ReadOptions) -> ReadOptions:
        """Return the options with a `strict` of None replaced by False: each house is shown in other furniture."""
        return options if options.strict is not None else replace(options, strict=False)

    def warn_fallbacks(self, house_id: str, fallbacks: Sequence[Fallback]) -> None:
        """Log, once per dataset, that houses are shown in other furniture than their own."""
        if fallbacks:
            _warn(self.name, self._database is None)

    @property
    def fallbacks(self) -> str:
        """Version of the furniture, part of cache keys."""
        return furniture_provider().version

    def inputs(self) -> "ProcthorDigests":
        """Return the object that computes digests of the houses' texts."""
        return ProcthorDigests(self)

    def __reduce__(self) -> tuple[type["ProcthorDataset"], tuple[str]]:
        return ProcthorDataset, (self.name.partition(":")[2],)


class ProcthorDigests(FileDigests):
    """Digests of the texts of houses, of the asset database and of the reader.

    Args:
        dataset: The dataset.
    """

    def __init__(self, dataset: ProcthorDataset) -> None:
        super().__init__(dataset.root, lambda house_id: ())
        self._dataset = dataset

    def house(self, house_id: str) -> bytes:
        """Return a digest of everything that determines a house, except textures; missing files are no error."""
        text = self._dataset.source.houses.get(house_id)
        try:
            found = b"" if text is None else text_digest(text)
        except DatasetError:
            found = b""
        return hashlib.sha256(house_id.encode() + found + self._dataset.assets.digest + reader_digest()).digest()

    @cache  # noqa: B019 (one object per cache of houses)
    def texture(self, path: str) -> str:
        """Return the hexadecimal SHA-256 of the image at an absolute path; "" if it does not exist."""
        return super().texture(path)


def reader_digest() -> bytes:
    """Return a digest of the code and tables that read houses."""
    folder = Path(__file__).parent
    return code_digest(folder, folder.parent / "outlines.py", folder.parent / "taxonomy.py", TABLE)


@cache
def _warn(name: str, has_no_sizes: bool) -> None:
    """Log a warning about a dataset; cached, so once in a process."""
    log.warning("%s: houses are shown in our own furniture, models of AI2-THOR are not public", name)
    if has_no_sizes:
        log.warning("%s: no asset-database.json was found: models have typical sizes; name it by `assets=`", name)
