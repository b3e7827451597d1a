"""A dataset of MJCF scenes: one file, or the files of a folder, each a house."""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

from home_mjx.core.files import NUM_HEAD_BYTES, is_folder
from home_mjx.datasets.base import DEFAULT_OPTIONS, ReadOptions
from home_mjx.datasets.gltf.house import HouseParts
from home_mjx.datasets.gltf.layout.room_file import RoomFile, read_room_file, room_file_path
from home_mjx.datasets.gltf.scene_dataset import MAX_NOTES, RootedOptions, SceneDataset, parse_options, scene_id
from home_mjx.datasets.gltf.scene_lights import add_lights, floor_area
from home_mjx.datasets.gltf.scene_rooms import scene_rooms
from home_mjx.datasets.mjcf.categories import metadata_path, read_body_words
from home_mjx.datasets.mjcf.files import SceneFiles, package_root
from home_mjx.datasets.mjcf.lights import read_lights
from home_mjx.datasets.mjcf.materials import MjcfMaterials
from home_mjx.datasets.mjcf.model import MjcfScene, compile_scene
from home_mjx.datasets.mjcf.objects import MjcfObject, ObjectReader
from home_mjx.errors import DatasetError, MissingFileError
from home_mjx.schema.house import House, Problem

FOLDER = Path(__file__).parent
SUFFIX, EXPORT_FILE, CEILING_SUFFIX = ".xml", "house.xml", "_ceiling"
OPTIONS_HINT = "Options are `root=FOLDER` and `rooms=auto|one`, such as `mjcf:kitchen.xml?rooms=one`."
MAX_MATERIALS = 60_000  # maximum number of looks of a scene


@dataclass(frozen=True)
class MjcfOptions(RootedOptions):
    """Options of reading MJCF scenes, see `RootedOptions`."""

    hint = OPTIONS_HINT


def holds_mjcf(path: Path) -> bool:
    """Return whether a path is an MJCF file, by its content, or a folder of some, or of exported houses."""
    if path.is_dir():
        return any(_is_mjcf(file) for file in _scene_files(path))
    return _is_mjcf(path)


def _is_mjcf(path: Path) -> bool:
    """Return whether a file has the element `mujoco` near its start."""
    if path.suffix.lower() != SUFFIX or not path.is_file():
        return False
    with path.open("rb") as file:
        return re.search(rb"<mujoco[\s>]", file.read(NUM_HEAD_BYTES)) is not None


def _scene_files(path: Path) -> list[Path]:
    """Return the files of scenes: a file itself; of a folder its XML files, and the exported houses below it."""
    if path.is_file():
        return [path]
    own = sorted(file for file in path.iterdir() if file.suffix.lower() == SUFFIX)
    return own + sorted(path.glob(f"*/{EXPORT_FILE}"))


class MjcfDataset(SceneDataset):
    """Houses from MJCF scenes of MuJoCo.

    `root` is the folder in the cache that receives the images, which MuJoCo decodes or makes.

    Args:
        text: Path of a scene or of a folder of scenes, `PATH` or `PATH?root=FOLDER&rooms=one`.

    Raises:
        ConfigError: An option is unknown or out of range.
        MissingFileError: The path does not exist, or the folder holds no scene.

    Example:
        >>> house = open_dataset("mjcf:kitchen.xml").load_house("kitchen")  # doctest: +SKIP
    """

    recognizes: ClassVar[Callable[[Path], bool]] = staticmethod(holds_mjcf)
    scheme = "mjcf"
    no_scene = "folder contains no scene of MJCF"
    code = (FOLDER, *(FOLDER.with_name(name) for name in ("gltf", "shapes.py", "taxonomy.csv", "taxonomy.py")))

    def read_options(self, query: str) -> MjcfOptions:
        """Return the options of a name's query."""
        return parse_options(MjcfOptions, query, OPTIONS_HINT)

    def find_scenes(self) -> dict[str, Path]:
        """Return the files of the scenes by house id: their stems, sorted, then names of exported houses' folders.

        Scenes of MolmoSpaces with a ceiling are left out of folders that have them without one.
        """
        files = [file for file in _scene_files(self.path) if file == self.path or _is_mjcf(file)]
        stems = {file.stem for file in files}
        found: dict[str, Path] = {}
        for file in files:
            if file.stem.removesuffix(CEILING_SUFFIX) not in stems - {file.stem}:
                found.setdefault(scene_id(file.parent.name if file.name == EXPORT_FILE else file.stem), file)
        return found

    def load_house(self, house_id: str, options: ReadOptions = DEFAULT_OPTIONS) -> House:
        """Read one scene as a house.

        Args:
            house_id: One of `house_ids`.
            options: Categories to leave out; if strict, a scene without a floor is an error.

        Raises:
            UnknownIdError: No scene has this id.
            DatasetError: The scene is broken, shows nothing, or names files outside of its root.
        """
        self.check_known(house_id)
        path, stated, words = self.scenes[house_id], *self._sidecars(house_id)
        self._collected(path)
        scene = compile_scene(path)
        table = MjcfMaterials(scene, self.root)
        reader = ObjectReader(scene, table, stated.objects, words)
        objects, architecture = reader.read()
        if not objects and not len(architecture):
            raise DatasetError("scene shows nothing: no geom is visible", file=path, hint="Name another file.")
        split = self.options.rooms == "auto"
        found = scene_rooms(path, objects, architecture, stated.rooms, split, bool(options.strict))
        parts = HouseParts(path, found.rooms)
        levels = parts.levels(found.triangles, self.wanted(objects, options))
        levels = add_lights(path, levels, parts.models, read_lights(scene, floor_area(levels)))
        self.warn_fallbacks(house_id, found.fallbacks)
        notes = {**table.notes, **reader.dropped}
        return House(
            id=house_id,
            version="mjcf@1.0",
            path=path,
            levels=levels,
            models=parts.models,
            problems=(*_problems(scene, objects, notes), *found.problems),
            fallbacks=found.fallbacks,
        )

    def _sidecars(self, house_id: str) -> tuple[RoomFile, Mapping[str, str]]:
        """Return the room file and the metadata of MolmoSpaces beside a scene."""
        path = self.scenes[house_id]
        stated = read_room_file(path)
        if stated.up or stated.scale is not None:
            hint = "Remove `up` and `scale`: lengths of MJCF are metres, and z is up."
            raise DatasetError("room file of an MJCF scene has units", file=room_file_path(path), hint=hint)
        return stated, read_body_words(path)

    def _collected(self, path: Path) -> SceneFiles:
        """Return all files of a scene, checked."""
        root = Path(self.options.root).expanduser().absolute() if self.options.root else package_root(path)
        if not is_folder(root):
            raise MissingFileError("root of the scene is not a folder", file=root, hint=OPTIONS_HINT)
        files = SceneFiles(root)
        files.add_model(path)
        return files

    def scene_files(self, house_id: str) -> list[Path]:
        """Return the files of a scene: itself, its sidecars, and all that it names, unless one is missing."""
        path = self.scenes[house_id]
        try:
            named = list(self._collected(path).paths)
        except DatasetError:
            named = [path]
        return [*named, room_file_path(path), metadata_path(path)]


def _problems(scene: MjcfScene, objects: Sequence[MjcfObject], notes: dict[str, str]) -> tuple[Problem, ...]:
    """Return the irregularities of a scene, and what of it is not kept."""
    found = [Problem("mujoco", note) for note in scene.notes]
    found += [Problem(element, message) for element, message in list(notes.items())[:MAX_NOTES]]
    carried = sum(one.finder.num_carried() for one in objects)
    if carried:
        found.append(Problem("worldbody", f"{carried} joints are on parts that other joints move: fixed"))
    hidden = int((~scene.shown).sum())
    if hidden:
        found.append(Problem("worldbody", f"{hidden} geoms are colliders or transparent: the package makes its own"))
    for name, count in (("flex", scene.model.nflex), ("skin", scene.model.nskin)):
        if count:
            found.append(Problem(name, "not shown"))
    return tuple(found)
