"""Base of datasets of scenes: one file, or the files of a folder, each a house."""

import hashlib
import os
import re
from abc import abstractmethod
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar, TypeVar
from urllib.parse import parse_qsl

from home_mjx.core.paths import cache_folder
from home_mjx.datasets.base import Dataset, FileDigests, ReadOptions, code_digest
from home_mjx.datasets.furniture import furniture_provider, textures_of, with_texture_root
from home_mjx.datasets.gltf.categories import category_metadata
from home_mjx.datasets.gltf.house import SceneObject
from home_mjx.errors import ConfigError, MissingFileError
from home_mjx.schema.house import House, Metadata

ROOM_MODES = ("auto", "one")
MAX_NOTES = 100  # maximum number of problems listed per house
MAX_ID_LENGTH = 128  # [characters]
T = TypeVar("T", bound=SceneObject)
Options = TypeVar("Options")


def parse_options(record: type[Options], query: str, hint: str) -> Options:
    """Return a record of texts from a query such as `root=houses&rooms=one`.

    Raises:
        ConfigError: The record has no such field, or refuses a value.
    """
    try:
        return record(**dict(parse_qsl(query, keep_blank_values=True)))
    except TypeError:
        raise ConfigError(f"cannot read the options `{query[:60]}`", hint=hint) from None


@dataclass(frozen=True)
class RootedOptions:
    """Options of reading scenes that name files.

    Attributes:
        root: Folder whose files scenes may name; "": see `package_root`.
        rooms: `auto`: narrow passages separate rooms; `one`: each storey's connected parts are rooms.
        hint: Advice in errors.

    Raises:
        ConfigError: `rooms` has another value.
    """

    hint: ClassVar[str]
    root: str = ""
    rooms: str = "auto"

    def __post_init__(self) -> None:
        if self.rooms not in ROOM_MODES:
            raise ConfigError(f"unknown option: rooms={self.rooms!r}", hint=self.hint)


class SceneDataset(Dataset):
    """Houses from scenes.

    `root` is the folder in the cache that receives the images. A subclass implements `read_options`, `find_scenes`,
    `scene_files` and `load_house`.

    Args:
        text: Path of a scene or of a folder of scenes, `PATH` or `PATH?OPTION=VALUE&...`.

    Attributes:
        path: The file or folder.
        options: Options of reading.
        scheme: Scheme of the dataset's names, and name of its folder in the cache.
        no_scene: Message for folders without a scene.
        code: Files and folders of the code that determines the houses.

    Raises:
        ConfigError: An option is unknown or out of range.
        MissingFileError: The path does not exist, or the folder holds no scene.
    """

    scheme: ClassVar[str]
    no_scene: ClassVar[str]
    code: ClassVar[tuple[Path, ...]]

    def __init__(self, text: str) -> None:
        name, _, query = text.partition("?")
        if os.path.exists(text):
            name, query = text, ""
        self.path = Path(os.path.abspath(Path(name).expanduser()))
        self.options = self.read_options(query)
        folder = hashlib.sha256(str(self.path).encode()).hexdigest()[:16]
        super().__init__(cache_folder() / self.scheme / folder, f"{self.scheme}:{self.path}{'?' * bool(query)}{query}")
        if not self.path.exists():
            raise MissingFileError("scene does not exist", file=self.path, hint="Correct the path.")
        if not self.house_ids:
            raise MissingFileError(self.no_scene, file=self.path)

    @abstractmethod
    def read_options(self, query: str) -> Any:
        """Return the options of a name's query; raise `ConfigError` if they cannot be read."""

    @abstractmethod
    def find_scenes(self) -> Mapping[str, Path]:
        """Return the files of the scenes by house id."""

    @abstractmethod
    def scene_files(self, house_id: str) -> list[Path]:
        """Return all files on which the house of a scene depends."""

    @cached_property
    def scenes(self) -> Mapping[str, Path]:
        """Files of the scenes by house id."""
        return self.find_scenes()

    @property
    def house_ids(self) -> tuple[str, ...]:
        """Names of the scenes, see `scene_id`, in the order of their files."""
        return tuple(self.scenes)

    @property
    def metadata(self) -> Metadata:
        """Categories of the models: their ids are fine categories."""
        return category_metadata()

    def resolved(self, options: ReadOptions) -> ReadOptions:
        """Return the options with a `strict` of None replaced by False."""
        return ReadOptions(**{**vars(options), "strict": bool(options.strict)})

    def wanted(self, objects: Iterable[T], options: ReadOptions) -> Sequence[T]:
        """Return the objects whose coarse category the options do not exclude."""
        metadata = self.metadata
        return [one for one in objects if metadata.info(one.fine).coarse not in options.excluded_categories]

    def inputs(self) -> "SceneDigests":
        """Return the object that computes digests of the scenes' files."""
        return SceneDigests(self)


class FurnishedSceneDataset(SceneDataset):
    """Houses from scenes whose missing models our furniture replaces."""

    @property
    def fallbacks(self) -> str:
        """Version of the furniture that replaces missing models, part of cache keys."""
        return furniture_provider().version

    def store_textures(self, house: House) -> House:
        """Write textures of furniture to `root`, warn of what was replaced, and return the house with that root."""
        furniture_provider().write_textures(self.root, textures_of(house))
        self.warn_fallbacks(house.id, house.fallbacks)
        return with_texture_root(house, self.root)


class SceneDigests(FileDigests):
    """Digests of scenes, which also depend on the readers' code and their options."""

    def __init__(self, dataset: SceneDataset) -> None:
        super().__init__(dataset.root, dataset.scene_files)
        self.key = repr(dataset.options).encode() + code_digest(*dataset.code)

    def house(self, house_id: str) -> bytes:
        """Return a SHA-256 digest of the files of a scene and of what else determines the house."""
        return hashlib.sha256(self.key + super().house(house_id)).digest()


def scene_id(name: str) -> str:
    """Return the house id of a scene's name; characters other than letters, digits, `.`, `_` and `-` become `_`.

    Example:
        >>> scene_id("my flat")
        'my_flat'
    """
    return re.sub(r"[^A-Za-z0-9._-]", "_", name)[:MAX_ID_LENGTH]
