"""A dataset of glTF scenes: one file, or the files of a folder, each a house."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar
from urllib.parse import parse_qsl

import numpy as np

from home_mjx.core.files import NUM_HEAD_BYTES
from home_mjx.datasets.base import DEFAULT_OPTIONS, ReadOptions
from home_mjx.datasets.gltf.decode.container import (
    GLB_MAGIC,
    IGNORED_EXTENSIONS,
    TEXTURE_EXTENSIONS,
    GltfDocument,
    read_document,
    uri_path,
)
from home_mjx.datasets.gltf.decode.images import ImageStore
from home_mjx.datasets.gltf.decode.materials import MaterialReader
from home_mjx.datasets.gltf.decode.primitives import MeshReader
from home_mjx.datasets.gltf.decode.scene import Matrix, place_meshes
from home_mjx.datasets.gltf.house import HouseParts
from home_mjx.datasets.gltf.joints import join_exported_parts
from home_mjx.datasets.gltf.layout.room_file import UP_AXES, RoomFile, read_room_file, room_file_path
from home_mjx.datasets.gltf.layout.rooms import find_rooms
from home_mjx.datasets.gltf.layout.triangle_set import collect_triangles
from home_mjx.datasets.gltf.objects import split_objects
from home_mjx.datasets.gltf.punctual_lights import LightReader
from home_mjx.datasets.gltf.scene_dataset import MAX_NOTES, ROOM_MODES, SceneDataset, scene_id
from home_mjx.datasets.gltf.scene_lights import add_lights, floor_area, plausible_lights
from home_mjx.errors import ConfigError, DatasetError
from home_mjx.geometry.meshes import Z_UP
from home_mjx.schema.house import House, Problem

FOLDER = Path(__file__).parent
SUFFIXES = (".glb", ".gltf")
OPTIONS_HINT = "Options are `up=y|z`, `scale=METRES` and `rooms=auto|one`, such as `gltf:scan.glb?up=z&scale=0.01`."


@dataclass(frozen=True)
class SceneOptions:
    """Options of reading a scene.

    Attributes:
        up: Axis of the scene that points up, `y` or `z`; "": as the room file says, else `y`.
        scale: Metres per unit of the scene; None: as the room file says, else 1.
        rooms: `auto`: narrow passages separate rooms; `one`: each storey's connected parts are rooms.

    Raises:
        ConfigError: A value is out of range.
    """

    up: str = ""
    scale: float | None = None
    rooms: str = "auto"

    def __post_init__(self) -> None:
        if self.up not in ("", *UP_AXES) or self.rooms not in ROOM_MODES:
            raise ConfigError(f"unknown option: up={self.up!r}, rooms={self.rooms!r}", hint=OPTIONS_HINT)
        if self.scale is not None and not 1e-6 <= self.scale <= 1e6:
            raise ConfigError(f"`scale` must be from 1e-6 to 1e6, got {self.scale:g}", hint=OPTIONS_HINT)

    def frame(self, stated: RoomFile) -> Matrix:
        """Return the transform from the scene to the house: metres, Y up."""
        matrix, up = np.eye(4), self.up or stated.up or "y"
        if up == "z":
            matrix[:3, :3] = Z_UP.T
        matrix[:3, :3] *= self.scale or stated.scale or 1.0
        return matrix


def holds_scenes(path: Path) -> bool:
    """Return whether a path is a glTF file, by its content, or a folder of some."""
    if path.is_dir():
        return any(file.suffix.lower() in SUFFIXES for file in path.iterdir())
    if not path.is_file():
        return False
    with path.open("rb") as file:
        head = file.read(NUM_HEAD_BYTES)
    return head[:4] == GLB_MAGIC or (path.suffix.lower() in SUFFIXES and head.lstrip()[:1] == b"{")


class GltfDataset(SceneDataset):
    """Houses from glTF scenes.

    `root` is the folder in the cache that receives the images, since most are inside of GLB files.

    Args:
        text: Path of a scene or of a folder of scenes, `PATH` or `PATH?up=z&scale=0.01&rooms=one`.

    Raises:
        ConfigError: An option is unknown or out of range.
        MissingFileError: The path does not exist, or the folder holds no scene.

    Example:
        >>> house = open_dataset("gltf:flat.glb").load_house("flat")  # doctest: +SKIP
    """

    recognizes: ClassVar[Callable[[Path], bool]] = staticmethod(holds_scenes)
    scheme = "gltf"
    no_scene = "folder contains no .glb or .gltf file"
    code = (FOLDER, FOLDER.with_name("taxonomy.csv"), FOLDER.with_name("taxonomy.py"))

    def read_options(self, query: str) -> SceneOptions:
        """Return the options of a name's query."""
        values = dict(parse_qsl(query, keep_blank_values=True))
        try:
            scale = float(values["scale"]) if "scale" in values else None
            return SceneOptions(**{**values, "scale": scale})  # type: ignore[arg-type]
        except (TypeError, ValueError) as error:
            if isinstance(error, ConfigError):
                raise
            raise ConfigError(f"cannot read the options `{query[:60]}`", hint=OPTIONS_HINT) from None

    def find_scenes(self) -> dict[str, Path]:
        """Return the files of the scenes by house id: their stems, sorted."""
        files = [self.path] if self.path.is_file() else sorted(self.path.iterdir())
        found: dict[str, Path] = {}
        for file in files:
            if file == self.path or file.suffix.lower() in SUFFIXES:
                found.setdefault(scene_id(file.stem), file)
        return found

    def load_house(self, house_id: str, options: ReadOptions = DEFAULT_OPTIONS) -> House:
        """Read one scene as a house.

        Args:
            house_id: One of `house_ids`.
            options: Categories to leave out; if strict, images that are missing or of other formats are errors.

        Raises:
            UnknownIdError: No scene has this id.
            DatasetError: The scene is broken, shows nothing, or has no floor.
        """
        self.check_known(house_id)
        path, stated = self.scenes[house_id], read_room_file(self.scenes[house_id])
        document = read_document(path, frozenset() if options.strict else TEXTURE_EXTENSIONS)
        images = ImageStore(document, self.root, bool(options.strict))
        materials = MaterialReader(document, images)
        meshes = MeshReader(document, materials)
        frame = self.options.frame(stated)
        placed = list(place_meshes(document, meshes, frame))
        if not placed:
            raise DatasetError("scene shows nothing: no node has triangles", file=path, hint="Export its meshes.")
        objects, architecture = split_objects(placed, stated.objects)
        objects = join_exported_parts(objects, frame)
        triangles = collect_triangles(architecture)
        rooms = find_rooms(triangles, stated.rooms, self.options.rooms == "auto")
        if not rooms:
            hint = f"State its units by `?scale=` and `?up=`, or its rooms in {room_file_path(path).name}."
            raise DatasetError("scene has no floor: no level area with walls above", file=path, hint=hint)
        parts = HouseParts(path, rooms)
        levels = parts.levels(triangles, self.wanted(objects, options))
        if not any(room.floor or room.ceiling or room.walls for level in levels for room in level.rooms):
            raise DatasetError("no triangle is in a room", file=path, hint="Correct the outlines of its room file.")
        lights = LightReader(document)
        found = plausible_lights(lights.read(frame), floor_area(levels), lights.notes)
        levels = add_lights(path, levels, parts.models, found)
        self.warn_fallbacks(house_id, images.fallbacks)
        notes = {**materials.notes, **meshes.notes, **lights.notes}
        problems = _problems(document, notes, stated, len(rooms), len(levels))
        return House(
            id=house_id,
            version="gltf@2.0",
            path=path,
            levels=levels,
            models=parts.models,
            problems=problems,
            fallbacks=tuple(images.fallbacks),
        )

    def scene_files(self, house_id: str) -> list[Path]:
        """Return the files of a scene: itself, its room file, its buffers and images."""
        path = self.scenes[house_id]
        return [path, room_file_path(path), *external_files(path)]


def external_files(path: Path) -> list[Path]:
    """Return the files that a scene names by URIs; none if it cannot be read."""
    try:
        document = read_document(path, TEXTURE_EXTENSIONS)
        uris = [value.member("uri") for key in ("buffers", "images") for value in document.items(key)]
        named = [uri for uri in uris if uri.has_value and not uri.text().startswith("data:")]
        return [uri_path(path.parent, uri) for uri in named]
    except DatasetError:
        return []


def _problems(
    document: GltfDocument, notes: dict[str, str], stated: RoomFile, rooms: int, levels: int
) -> tuple[Problem, ...]:
    """Return the irregularities of a scene, and how its rooms were found."""
    found = [Problem(element, message) for element, message in notes.items()][:MAX_NOTES]
    if document.items("animations"):
        found.append(Problem("animations", "not shown"))
    for name in sorted({str(value.data) for value in document.items("extensionsUsed")} & IGNORED_EXTENSIONS):
        found.append(Problem(f"extensionsUsed.{name}", "not kept"))
    if not stated.rooms:
        message = f"{rooms} rooms on {levels} storeys were found from the geometry, without types"
        found.append(Problem("scenes", message))
    return tuple(found)
