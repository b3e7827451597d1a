"""The `Dataset` protocol: houses of one source, with the metadata and the digests that compiling and caching need.

Host only: nothing here loads JAX.
"""

import hashlib
import logging
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property
from pathlib import Path
from typing import Any, ClassVar, Protocol, runtime_checkable

from home_mjx.core.checks import check_flag
from home_mjx.core.files import read_code, resolve_below
from home_mjx.datasets.splits import split_of
from home_mjx.errors import UnknownIdError, UnknownNameError, did_you_mean
from home_mjx.schema.categories import COARSE, FINE, NYU40
from home_mjx.schema.compiled import Model
from home_mjx.schema.house import Fallback, House, Joints, Metadata, ModelInfo

log = logging.getLogger(__name__)


@dataclass(frozen=True)
class ReadOptions:
    """Selection of the parts of a house to read.

    Args:
        people: Keep models of the coarse category `person`: dense, static meshes.
        plants: Keep models of the coarse category `plant`: foliage of many thousand triangles.
        backdrops: Keep boxes over 20 m uncut. By default they are cut to the extent of the level.
        strict: Reject a house with a missing texture, model, room mesh or metadata row, instead of using fallbacks.
            None: strict for generated datasets, tolerant for all others.

    Example:
        >>> ReadOptions(people=False).excluded_categories
        ('person',)
    """

    people: bool = True
    plants: bool = True
    backdrops: bool = False
    strict: bool | None = None

    def __post_init__(self) -> None:
        for name in ("people", "plants", "backdrops"):
            check_flag(name, getattr(self, name))
        if self.strict is not None:
            check_flag("strict", self.strict)

    @property
    def excluded_categories(self) -> tuple[str, ...]:
        """Coarse categories of the objects to leave out."""
        return ("person",) * (not self.people) + ("plant",) * (not self.plants)


DEFAULT_OPTIONS = ReadOptions()


@runtime_checkable
class InputDigests(Protocol):
    """Digests of the files from which the houses of a dataset are compiled; part of the key of every cache entry."""

    def house(self, house_id: str) -> bytes:
        """Return a digest of all files that determine a house, except textures; missing files are no error."""
        ...

    def texture(self, path: str) -> str:
        """Return the hexadecimal digest of the image at an absolute path; "" if it does not exist."""
        ...

    def has_texture(self, name: str) -> bool:
        """Return whether the image of a missing texture, named by its `Material.missing_file`, now exists."""
        ...

    def save(self, interval: float = 0.0) -> None:
        """Write new digests to disk, unless the last write was less than `interval` [s] ago."""
        ...


@runtime_checkable
class ShippedSource(Protocol):
    """Compiled houses that a distribution ships, and the parts of them that it can make quickly; hashable."""

    @property
    def path(self) -> Path:
        """The archive, see `houses.shipped`; it may not exist."""
        ...

    def digest(self) -> bytes:
        """Return a digest of all code and data, apart from the compiler, that determine the houses."""
        ...

    def library_model(self, key: str) -> Model | None:
        """Return the compiled model with a key; None if the library does not have it."""
        ...

    def write_textures(self, paths: Sequence[str], progress: bool = False) -> None:
        """Write some textures unless they exist; paths are relative to the dataset."""
        ...


class Dataset(ABC):
    """Houses of one source: a folder, or a name such as `procedural:16`.

    A subclass implements `house_ids`, `metadata`, `load_house` and `inputs`. Two datasets of one class and one name are
    equal, and a dataset can be pickled if its name opens it again.

    Attributes:
        root: Absolute folder that paths of textures are relative to.
        name: Text that opens the dataset again with `open_dataset`.
        shares_root: Whether `root` may hold houses that are not part of this dataset.
        reader: Name of the code that reads the houses, a part of the keys of compiled houses; default: the class.
        categories: Categories of the dataset by name, as (fine, coarse, NYU40) names; see `model_info`.

    Example:
        >>> class Boxes(Dataset):  # doctest: +SKIP
        ...     house_ids = ("box",)
        ...     metadata = Metadata({})
        ...
        ...     def load_house(self, house_id, options=DEFAULT_OPTIONS): ...
        ...     def inputs(self):
        ...         return FileDigests(self.root, lambda house_id: ())
        >>> register_dataset("boxes", lambda name: Boxes(Path.cwd(), f"boxes:{name}"))  # doctest: +SKIP
    """

    categories: ClassVar[Mapping[str, tuple[str, str, str]]] = {}
    shares_root: ClassVar[bool] = False
    reader: ClassVar[str]

    def __init_subclass__(cls, **options: Any) -> None:
        super().__init_subclass__(**options)
        if "reader" not in vars(cls):
            cls.reader = f"{cls.__module__}.{cls.__qualname__}"

    def __init__(self, root: Path, name: str | None = None) -> None:
        self.root = root
        self.name = str(root) if name is None else name

    def __eq__(self, other: object) -> bool:
        return type(self) is type(other) and isinstance(other, Dataset) and self.name == other.name

    def __hash__(self) -> int:
        return hash((type(self), self.name))

    @property
    @abstractmethod
    def house_ids(self) -> Sequence[str]:
        """Ids of all houses, in a fixed order."""

    @property
    @abstractmethod
    def metadata(self) -> Metadata:
        """Categories and sizes of the models.

        Raises:
            DatasetError: A table is missing or broken.
        """

    @abstractmethod
    def load_house(self, house_id: str, options: ReadOptions = DEFAULT_OPTIONS) -> House:
        """Read one house and the models that it uses.

        Args:
            house_id: One of `house_ids`.
            options: Parts of the house to read, and whether missing files are errors.

        Raises:
            UnknownIdError: No house has this id.
            DatasetError: A file that the house needs is missing or broken.
        """

    @abstractmethod
    def inputs(self) -> InputDigests:
        """Return the object that computes digests of the houses' files on request, see `InputDigests`."""

    def prepare(self, house_ids: Sequence[str], progress: bool = False) -> None:  # noqa: B027 (most need nothing)
        """Make houses available on disk before they are read, such as by generating them; by default do nothing.

        Args:
            house_ids: Some of `house_ids`.
            progress: Show a progress bar.

        Raises:
            DatasetError: The houses cannot be written.
        """

    @property
    def shipped(self) -> ShippedSource | None:
        """Compiled houses that the distribution of the dataset ships; None if there are none."""
        return None

    @property
    def joints(self) -> Joints:
        """Movable parts of models by model id; empty if the dataset has none."""
        return {}

    @property
    def fallbacks(self) -> str:
        """Version of the models that replace missing ones, part of cache keys; "" if the dataset replaces none."""
        return ""

    def split_of(self, house_id: str) -> str:
        """Return the split of a house: by a hash of its id, unless the dataset has official splits."""
        return split_of(house_id)

    def check_known(self, house_id: str) -> None:
        """Raise `UnknownIdError`, a `DatasetError`, if no house has this id."""
        if house_id not in self._known:
            raise UnknownIdError(
                f"unknown house `{house_id}`", file=self.root, hint=did_you_mean(house_id, self.house_ids)
            )

    def resolved(self, options: ReadOptions) -> ReadOptions:
        """Return the options with a `strict` of None replaced by True; subclasses may choose otherwise."""
        return options if options.strict is not None else replace(options, strict=True)

    def metadata_for(self, options: ReadOptions) -> Metadata:
        """Return the metadata for houses read with these options; by default `metadata`, whatever the options."""
        return self.metadata

    def model_info(self, model_id: str, category: str) -> ModelInfo:
        """Return a metadata row without size for a model whose category is a key of `categories`.

        The front is the default; whether the model exists is not checked.

        Raises:
            UnknownNameError: `categories` lacks the category, or maps it to a name outside `FINE`, `COARSE` or `NYU40`.
        """
        if category not in self.categories:
            message = f"category `{category}` of model `{model_id}` has no entry in {type(self).__name__}.categories"
            raise UnknownNameError(message, hint=did_you_mean(category, self.categories))
        row = self.categories[category]
        for name, known in zip(row, (FINE, COARSE, NYU40), strict=True):
            if name not in known:
                message = f"category `{category}` maps to `{name}`, which is not in SUNCG's vocabulary"
                raise UnknownNameError(message, hint=did_you_mean(name, known))
        return ModelInfo(model_id, *row)

    def warn_fallbacks(self, house_id: str, fallbacks: Sequence[Fallback]) -> None:
        """Log one warning that counts a house's fallbacks; nothing if there are none."""
        if fallbacks:
            log.warning("house %s lacks %d files: fallbacks are used", house_id, len(fallbacks))

    @cached_property
    def _known(self) -> frozenset[str]:
        """All house ids, for fast look-up."""
        return frozenset(self.house_ids)


class FileDigests:
    """Digests of whole files, for datasets that keep each house in files of its own.

    Args:
        root: Folder of the dataset.
        files_of: Paths of the files that decide how a house is read.

    Example:
        >>> digests = FileDigests(Path("houses"), lambda house_id: [Path("houses") / f"{house_id}.json"])
        >>> len(digests.house("a"))
        32
    """

    def __init__(self, root: Path, files_of: Callable[[str], Iterable[Path]]) -> None:
        self.root = root
        self.files_of = files_of

    def house(self, house_id: str) -> bytes:
        """Return a SHA-256 digest of the house's id, and of the paths and bytes of its files.

        Files are in the order of `files_of`; a missing one counts as empty.
        """
        digest = hashlib.sha256(house_id.encode())
        for path in self.files_of(house_id):
            digest.update(str(path).encode() + b"\0" + (path.read_bytes() if path.is_file() else b""))
        return digest.digest()

    def texture(self, path: str) -> str:
        """Return the hexadecimal SHA-256 of the image at an absolute path; "" if it does not exist."""
        file = Path(path)
        return hashlib.sha256(file.read_bytes()).hexdigest() if file.is_file() else ""

    def has_texture(self, name: str) -> bool:
        """Return whether a file exists at a path relative to the dataset's folder; False if it leads out of it."""
        found = resolve_below(self.root, self.root, name)
        return found is not None and found.is_file()

    def save(self, interval: float = 0.0) -> None:
        """Do nothing: digests are not stored."""


@cache
def code_digest(*paths: Path) -> bytes:
    """Return a SHA-256 digest of code and tables: files, and all below folders; comments and docstrings do not count.

    Args:
        paths: Python files, CSV files, and folders of both.
    """
    files = [file for path in paths for file in ([path] if path.is_file() else sorted(path.rglob("*")))]
    code = [read_code(file).encode() for file in files if file.suffix == ".py"]
    tables = [file.read_bytes() for file in files if file.suffix == ".csv"]
    return hashlib.sha256(b"".join(hashlib.sha256(part).digest() for part in code + tables)).digest()
