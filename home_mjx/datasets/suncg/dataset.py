"""A SUNCG dataset on disk, v1 or v2: its houses and metadata tables."""

import logging
import os
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cached_property, lru_cache
from pathlib import Path

from home_mjx.core.files import is_file
from home_mjx.core.paths import ROOT_VARIABLE
from home_mjx.datasets.base import DEFAULT_OPTIONS, Dataset, ReadOptions
from home_mjx.datasets.seeds import GENERATED_MARKER, sort_house_ids
from home_mjx.datasets.suncg.digests import SuncgDigests
from home_mjx.datasets.suncg.fallbacks.builtin_categories import add_builtin_categories
from home_mjx.datasets.suncg.fallbacks.models import fallback_version
from home_mjx.datasets.suncg.fallbacks.summary import describe_fallbacks
from home_mjx.datasets.suncg.formats.asset_library import AssetLibrary
from home_mjx.datasets.suncg.formats.json_value import JsonValue
from home_mjx.datasets.suncg.formats.variants import SuncgMetadata
from home_mjx.datasets.suncg.read.house_json import read_house
from home_mjx.datasets.suncg.read.joints import read_joints
from home_mjx.datasets.suncg.read.metadata import read_metadata
from home_mjx.errors import MissingFileError, UnknownIdError, did_you_mean
from home_mjx.schema.house import Fallback, House, Joints, Mesh

log = logging.getLogger(__name__)

LAYOUT = "A dataset root contains house/, room/, object/, texture/ and metadata/."


class SuncgDataset(Dataset):
    """A dataset in SUNCG's on-disk format, v1 or v2; library models are parsed once and shared by its houses.

    Args:
        root: Absolute dataset root.

    Example:
        >>> dataset = open_dataset("/data/suncg")  # doctest: +SKIP
        >>> house = dataset.load_house(dataset.house_ids[0])  # doctest: +SKIP
        >>> dataset.metadata.info(house.levels[0].objects[0].model_id).fine  # doctest: +SKIP
        'window'
    """

    def __init__(self, root: Path) -> None:
        super().__init__(root)
        self.assets = AssetLibrary(root)
        self._tolerant = AssetLibrary(root, tolerant=True)

    @cached_property
    def house_ids(self) -> tuple[str, ...]:
        """Names of the folders with a house.json: generated houses by seed, then all others, sorted."""
        return sort_house_ids(path.parent.name for path in (self.root / "house").glob("*/house.json"))

    @cached_property
    def metadata(self) -> SuncgMetadata:
        """Categories, sizes and lights of the models; read on first use.

        Raises:
            DatasetError: The category table is missing, or a table is broken.
        """
        return read_metadata(self.root / "metadata")

    @cached_property
    def joints(self) -> Joints:
        """Movable parts of library models by model id, see `Joint`; empty if the dataset has no joint table.

        They are read on first use. Nothing else uses them: the compiler treats furniture as rigid.

        Raises:
            DatasetError: The table is broken.

        Example:
            >>> drawer, *others = dataset.joints["home_dresser_1"]  # doctest: +SKIP
            >>> pulled = drawer.move(dataset.load_model(drawer.model_id), drawer.high)  # doctest: +SKIP
        """
        return read_joints(self.root / "metadata")

    def load_house(self, house_id: str, options: ReadOptions = DEFAULT_OPTIONS) -> House:
        """Read one house and the models that it uses.

        Args:
            house_id: One of `house_ids`.
            options: Selection of people, plants and backdrops, and whether missing parts are rejected. If not,
                `fallbacks` of the house lists the fallbacks, and a warning counts them.

        Raises:
            DatasetError: The house is unknown, or a file that it needs is missing or broken.
        """
        self.check_known(house_id)
        options = self.resolved(options)
        if options.strict:
            return read_house(house_id, self.assets, options, self._left_out(options), self._tables)
        house = read_house(house_id, self._tolerant, options, self._left_out(options), self._tables)
        self.warn_fallbacks(house_id, house.fallbacks)
        return house

    def resolved(self, options: ReadOptions) -> ReadOptions:
        """Return the options with a `strict` of None replaced: True for generated (complete) datasets, else False."""
        if options.strict is not None:
            return options
        return replace(options, strict=is_file(self.root / GENERATED_MARKER))

    def metadata_for(self, options: ReadOptions) -> SuncgMetadata:
        """Return the metadata tables for houses read with these options.

        If not strict, tables may be missing; categories of SUNCG's doors, windows and similar models are then built in.

        Raises:
            DatasetError: A table is missing or broken, see `metadata`.
        """
        return self.metadata if self.resolved(options).strict else add_builtin_categories(self._tables)

    @cached_property
    def _tables(self) -> SuncgMetadata:
        """The tables that exist; missing ones are empty."""
        return read_metadata(self.root / "metadata", tolerant=True)

    def load_model(self, key: str) -> Mesh:
        """Return one library model, such as `122` or its variants `122_0` (closed) and, in v2, `122_2` (frame only).

        It is read once; later calls and houses share the mesh. Missing files are errors in every dataset.

        Raises:
            DatasetError: Its OBJ, an MTL or a texture is missing or broken.
        """
        place = JsonValue(self.root / "object", "", key)
        return self.assets.model(place.name(), key, place)

    def inputs(self) -> SuncgDigests:
        """Return the object that computes digests of the houses' files on request."""
        return SuncgDigests(self.root)

    @property
    def fallbacks(self) -> str:
        """Version of the models that replace missing ones; "" for generated datasets, which lack nothing."""
        return "" if is_file(self.root / GENERATED_MARKER) else fallback_version()

    def warn_fallbacks(self, house_id: str, fallbacks: Sequence[Fallback]) -> None:
        """Log one warning that counts the fallbacks by kind; nothing if there are none, and nothing twice."""
        if fallbacks:
            _warn(self.root, house_id, describe_fallbacks(fallbacks))

    def __reduce__(self) -> tuple[Callable[[Path], "SuncgDataset"], tuple[Path]]:
        return open_suncg, (self.root,)

    def check_known(self, house_id: str) -> None:
        """Raise `UnknownIdError`, a `DatasetError`, if the dataset has no house with this id."""
        if house_id not in self._known:
            where = self.root / "house"
            hint = did_you_mean(house_id, self.house_ids)
            raise UnknownIdError(f"unknown house `{house_id}`", file=where, hint=hint)

    def _left_out(self, options: ReadOptions) -> Callable[[str], bool]:
        """Return a predicate of model ids that is True for the categories which the options exclude."""
        unwanted = options.excluded_categories
        return lambda model_id: bool(unwanted) and self.metadata_for(options).info(model_id).coarse in unwanted


@lru_cache(maxsize=100_000)
def _warn(root: Path, house_id: str, missing: str) -> None:
    """Log a warning that a house lacks files; cached, so once per house and message in a process."""
    listing = f"home-mjx inspect {house_id} --dataset {root}"
    log.warning("house %s lacks %s: fallbacks are used, `%s` lists them", house_id, missing, listing)


def open_suncg(root: str | Path) -> SuncgDataset:
    """Open the folder of a dataset in SUNCG's on-disk format, real or generated.

    Raises:
        MissingFileError: The folder holds no house.
    """
    path = Path(os.path.abspath(Path(root).expanduser()))
    dataset = SuncgDataset(path)
    if not dataset.house_ids:
        raise MissingFileError("folder contains no house/<id>/house.json", file=path, hint=_root_hint(path))
    return dataset


def _root_hint(path: Path) -> str:
    """Return a hint for a folder without houses: its parent or grandparent if that has some, else the layout."""
    for parent in path.parents[:2]:
        if any((parent / "house").glob("*/house.json")):
            return f"Did you mean {parent}? {LAYOUT}"
    return f"Correct the path or {ROOT_VARIABLE}. {LAYOUT}"
