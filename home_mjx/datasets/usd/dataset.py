"""A dataset of USD scenes: one file, or the files of a folder, each a house."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

from home_mjx.core.files import is_folder
from home_mjx.datasets.base import DEFAULT_OPTIONS, ReadOptions
from home_mjx.datasets.gltf.house import HouseParts
from home_mjx.datasets.gltf.layout.room_file import read_room_file, room_file_path
from home_mjx.datasets.gltf.layout.triangle_set import collect_triangles
from home_mjx.datasets.gltf.objects import split_objects
from home_mjx.datasets.gltf.scene_dataset import MAX_NOTES, RootedOptions, SceneDataset, parse_options, scene_id
from home_mjx.datasets.gltf.scene_lights import add_lights, floor_area, plausible_lights
from home_mjx.datasets.gltf.scene_rooms import scene_rooms
from home_mjx.datasets.usd.joints import attach_joints, unit_of
from home_mjx.datasets.usd.layers import UsdScene, open_scene
from home_mjx.datasets.usd.lights import read_lights
from home_mjx.datasets.usd.prims import PrimReader
from home_mjx.errors import DatasetError, MissingFileError
from home_mjx.schema.house import House, Problem

FOLDER = Path(__file__).parent
SUFFIXES = (".usd", ".usda", ".usdc")
OPTIONS_HINT = "Options are `root=FOLDER` and `rooms=auto|one`, such as `usd:flat.usda?rooms=one`."


@dataclass(frozen=True)
class UsdOptions(RootedOptions):
    """Options of reading USD scenes, see `RootedOptions`."""

    hint = OPTIONS_HINT


def holds_usd(path: Path) -> bool:
    """Return whether a path is a USD file by its name, or a folder of some."""
    if is_folder(path):
        return any(file.suffix.lower() in SUFFIXES for file in path.iterdir())
    return path.suffix.lower() in SUFFIXES and path.is_file()


class UsdDataset(SceneDataset):
    """Houses from USD scenes; needs the extra `usd`.

    Args:
        text: Path of a scene or of a folder of scenes, `PATH` or `PATH?rooms=one`.

    Raises:
        ConfigError: An option is unknown or out of range.
        MissingFileError: The path does not exist, or the folder holds no scene.

    Example:
        >>> house = open_dataset("usd:flat.usda").load_house("flat")  # doctest: +SKIP
    """

    recognizes: ClassVar[Callable[[Path], bool]] = staticmethod(holds_usd)
    scheme = "usd"
    no_scene = "folder contains no .usd, .usda or .usdc file"
    code = (
        FOLDER,
        *(FOLDER.with_name(name) for name in ("gltf", "shapes.py", "taxonomy.csv", "taxonomy.py")),
        FOLDER.with_name("habitat") / "articulated.py",
        FOLDER.with_name("mjcf") / "files.py",
    )

    def read_options(self, query: str) -> UsdOptions:
        """Return the options of a name's query."""
        return parse_options(UsdOptions, query, OPTIONS_HINT)

    def find_scenes(self) -> Mapping[str, Path]:
        """Return the files of the scenes by house id: their stems, sorted."""
        files = sorted(self.path.iterdir()) if self.path.is_dir() else [self.path]
        return {scene_id(f.stem): f for f in reversed(files) if f == self.path or f.suffix.lower() in SUFFIXES}

    def load_house(self, house_id: str, options: ReadOptions = DEFAULT_OPTIONS) -> House:
        """Read one scene as a house.

        Args:
            house_id: One of `house_ids`.
            options: Categories to leave out; if strict, missing textures, layers and floors are errors.

        Raises:
            UnknownIdError: No scene has this id.
            DatasetError: The scene is broken, shows nothing, or names files outside of its folder.
        """
        self.check_known(house_id)
        path = self.scenes[house_id]
        stated, scene = read_room_file(path), self._open(path)
        reader, strict = PrimReader(scene), bool(options.strict)
        placed = list(reader.read())
        if not placed:
            raise DatasetError("scene shows nothing: no prim has triangles", file=path, hint="Export its meshes.")
        missing = [note for note in scene.notes.values() if "missing" in note]
        if strict and (reader.materials.fallbacks or missing):
            raise MissingFileError("scene lacks textures or layers", file=path, hint="Fetch them.")
        objects, architecture, lost = attach_joints(*split_objects(placed, stated.objects), reader.joints)
        triangles, split = collect_triangles(architecture), self.options.rooms == "auto"
        rooms = scene_rooms(path, objects, triangles, stated.rooms, split, strict, "stage")
        parts = HouseParts(path, rooms.rooms)
        levels = parts.levels(rooms.triangles, self.wanted(objects, options))
        notes: dict[str, str] = {}
        lights = plausible_lights(read_lights(reader.lights, unit_of(scene.frame), notes), floor_area(levels), notes)
        levels = add_lights(path, levels, parts.models, lights)
        fallbacks = (*reader.materials.fallbacks, *rooms.fallbacks)
        self.warn_fallbacks(house_id, fallbacks)
        fixed = "joint lacks bodies or limits, moves no part of an object, or one that another joint moves: fixed"
        unkept = (Problem(joint.path, fixed) for joint in lost)
        listed = (
            Problem(element, note) for element, note in {**scene.notes, **reader.materials.notes, **notes}.items()
        )
        problems = (*listed, *rooms.problems, *unkept)
        return House(house_id, "usd@1.0", path, levels, parts.models, problems[:MAX_NOTES], fallbacks=fallbacks)

    def _open(self, path: Path) -> UsdScene:
        """Open a scene, whose files are below the stated root."""
        stated = self.options.root
        return open_scene(path, Path(stated).expanduser().absolute() if stated else None)

    def scene_files(self, house_id: str) -> list[Path]:
        """Return the files of a scene: its layers and its room file."""
        path = self.scenes[house_id]
        try:
            layers = self._open(path).layers
        except DatasetError:
            layers = (path,)
        return [*layers, room_file_path(path)]
