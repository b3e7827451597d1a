"""A Habitat dataset: the scenes of a configuration, or a scan, each a house."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import ClassVar

from home_mjx.core.files import is_folder
from home_mjx.datasets.base import DEFAULT_OPTIONS, ReadOptions
from home_mjx.datasets.gltf.layout.room_file import UP_AXES
from home_mjx.datasets.gltf.scene_dataset import ROOM_MODES, FurnishedSceneDataset, parse_options
from home_mjx.datasets.habitat.build import SceneBuilder
from home_mjx.datasets.habitat.source import CONFIG_ENDING, HabitatSource
from home_mjx.errors import ConfigError, MissingFileError
from home_mjx.schema.house import House

FOLDER = Path(__file__).parent
OPTIONS_HINT = (
    "Options are `root=FOLDER`, `rooms=auto|one` and `up=y|z`, such as `habitat:hssd.scene_dataset_config.json`."
)


@dataclass(frozen=True)
class HabitatOptions:
    """Options of reading Habitat datasets.

    Attributes:
        root: Folder that contains all files; "": that of the configuration.
        rooms: `auto`: narrow passages separate rooms without regions; `one`: each storey's connected parts are rooms.
        up: Axis that points up in stages whose templates do not say; "": `y`, or `z` of scans without a configuration.

    Raises:
        ConfigError: A value is out of range.
    """

    root: str = ""
    rooms: str = "auto"
    up: str = ""

    def __post_init__(self) -> None:
        if self.rooms not in ROOM_MODES or self.up not in ("", *UP_AXES):
            raise ConfigError(f"unknown option: rooms={self.rooms!r}, up={self.up!r}", hint=OPTIONS_HINT)


def find_config(path: Path) -> Path | None:
    """Return the configuration that a path is or, of a folder, holds; None if there is none or several."""
    if path.name.endswith(CONFIG_ENDING) and path.is_file():
        return path
    found = sorted(path.glob(f"*{CONFIG_ENDING}")) if is_folder(path) else []
    return found[0] if len(found) == 1 else None


def holds_habitat(path: Path) -> bool:
    """Return whether a path is the configuration of a Habitat dataset, or a folder with one."""
    return find_config(path) is not None


class HabitatDataset(FurnishedSceneDataset):
    """Houses from Habitat's scene datasets.

    `root` is the folder in the cache that receives images of assets and textures of our furniture.

    Args:
        text: Path of a `.scene_dataset_config.json`, of its folder, or of a scan, with options after `?`.

    Raises:
        ConfigError: An option is unknown or out of range.
        MissingFileError: The path does not exist, or has no scene.
        DatasetError: The configuration is broken.

    Example:
        >>> dataset = open_dataset("habitat:replicaCAD.scene_dataset_config.json")  # doctest: +SKIP
        >>> house = dataset.load_house("apt_0")  # doctest: +SKIP
    """

    recognizes: ClassVar[Callable[[Path], bool]] = staticmethod(holds_habitat)
    scheme = "habitat"
    no_scene = "dataset has no scene instance and no stage"
    code = (
        FOLDER,
        FOLDER.with_name("gltf"),
        FOLDER.with_name("mjcf"),
        FOLDER.with_name("shapes.py"),
        FOLDER.with_name("taxonomy.csv"),
        FOLDER.with_name("taxonomy.py"),
    )

    def read_options(self, query: str) -> HabitatOptions:
        """Return the options of a name's query."""
        return parse_options(HabitatOptions, query, OPTIONS_HINT)

    @cached_property
    def source(self) -> HabitatSource:
        """The configuration."""
        config = find_config(self.path) or self.path
        if not config.is_file():
            hint = f"Name one of its files that end in `{CONFIG_ENDING}`, or a scan."
            raise MissingFileError("folder has no configuration, or several", file=self.path, hint=hint)
        root = Path(self.options.root).expanduser().absolute() if self.options.root else config.parent
        if not is_folder(root) or not config.is_relative_to(root):
            raise MissingFileError("root is not a folder that contains the dataset", file=root, hint=OPTIONS_HINT)
        return HabitatSource(config, root)

    def find_scenes(self) -> Mapping[str, Path]:
        """Return the file of each scene by house id."""
        found = {}
        for house_id, (section, handle) in self.source.scenes.items():
            found[house_id] = self.source.table(section).path(handle) or self.source.path
        return found

    def load_house(self, house_id: str, options: ReadOptions = DEFAULT_OPTIONS) -> House:
        """Read one scene as a house.

        Args:
            house_id: One of `house_ids`.
            options: Categories to leave out; if strict, missing assets are errors.

        Raises:
            UnknownIdError: No scene has this id.
            DatasetError: The scene is broken, or names files outside of the root.
        """
        self.check_known(house_id)
        builder = SceneBuilder(self.source, self.root, house_id, self.options.rooms, self.options.up, options)
        house = builder.build(self.wanted)
        return self.store_textures(house)

    def scene_files(self, house_id: str) -> list[Path]:
        """Return the files of a scene: configurations, assets and what these name."""
        builder = SceneBuilder(self.source, self.root, house_id, self.options.rooms, self.options.up, DEFAULT_OPTIONS)
        return builder.files()
