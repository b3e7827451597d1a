"""A Habitat scene as a house: stage, objects, lights and rooms."""

from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

import numpy as np

from home_mjx.core.files import is_file
from home_mjx.datasets.base import ReadOptions
from home_mjx.datasets.furniture import furniture_provider
from home_mjx.datasets.gltf.dataset import external_files
from home_mjx.datasets.gltf.decode.scene import Matrix, PlacedMesh
from home_mjx.datasets.gltf.house import HouseParts, SceneObject
from home_mjx.datasets.gltf.layout.room_file import StatedRoom
from home_mjx.datasets.gltf.layout.triangle_set import TriangleSet, collect_triangles
from home_mjx.datasets.gltf.objects import split_objects
from home_mjx.datasets.gltf.scene_dataset import MAX_NOTES
from home_mjx.datasets.gltf.scene_lights import add_lights, floor_area
from home_mjx.datasets.gltf.scene_rooms import FoundRooms, scene_rooms
from home_mjx.datasets.habitat.assets import GLTF_SUFFIXES, AssetStore
from home_mjx.datasets.habitat.lights import NO_LIGHTS, read_lights
from home_mjx.datasets.habitat.objects import ObjectBuilder, kept_objects
from home_mjx.datasets.habitat.plain.plain_assets import OBJ, image_paths, library_paths
from home_mjx.datasets.habitat.scans import ScanLabels, read_scan_labels
from home_mjx.datasets.habitat.semantics import OBJECT_TABLE, SemanticDescriptor, read_descriptor, read_object_table
from home_mjx.datasets.habitat.source import HabitatSource
from home_mjx.datasets.habitat.templates import HabitatTemplate, path_below
from home_mjx.datasets.habitat.transforms import asset_frame, asset_matrix, read_placement
from home_mjx.datasets.habitat.urdf import read_urdf
from home_mjx.datasets.suncg.formats.json_value import JsonValue, read_json
from home_mjx.errors import DatasetError, MissingFileError
from home_mjx.geometry.polygons import is_inside_polygon
from home_mjx.schema.house import Fallback, House, Level, Problem

MAX_INSTANCES = 20_000  # maximum number of instances of a scene
ASSET_KEYS = ("render_asset", "collision_asset", "urdf_filepath", "semantic_asset", "semantic_descriptor_filename")
MAX_FLOOR_OFFSET = 0.5  # [m], maximum distance of the lowest point from 0, where stages have their floors
MIN_REGION_AREA = 1.0  # [m^2], of the stage in the plan of all regions; with less, regions are of another frame
Wanted = Callable[[Iterable[SceneObject], ReadOptions], Sequence[SceneObject]]


@dataclass
class SceneBuilder:
    """Builder of one house.

    Attributes:
        source: The dataset.
        images: Folder that receives images.
        house_id: Id of the house.
        rooms: `auto` or `one`, see `HabitatOptions`.
        up: Axis of stages that do not say which one points up; "": `y`, or `z` of bare scans.
        options: Parts to read, and whether missing assets are errors.
        problems: Irregularities, and what is not kept.
    """

    source: HabitatSource
    images: Path
    house_id: str
    rooms: str
    up: str
    options: ReadOptions
    problems: list[Problem] = field(default_factory=list)

    @cached_property
    def scene(self) -> HabitatTemplate:
        """The scene instance."""
        return self.source.scene(self.house_id)

    @property
    def strict(self) -> bool:
        """Whether missing assets are errors."""
        return bool(self.options.strict)

    @property
    def path(self) -> Path:
        """File of the scene, for messages."""
        return self.scene.file or self.source.path

    def build(self, wanted: Wanted) -> House:
        """Return the house; textures of our furniture have relative paths.

        Args:
            wanted: Returns the objects that the options do not exclude.

        Raises:
            DatasetError: A file is broken, leads out of the root or, if strict, is missing.
        """
        assets = AssetStore(self.images, self.strict)
        descriptor = self._descriptor()
        objects, builder = self._objects(assets, descriptor)
        placed, stage_fallbacks, labels = self._stage(assets)
        found, architecture = split_objects(placed, {})
        triangles = collect_triangles(architecture)
        labelled, triangles = labels.split(triangles)
        everything: list[SceneObject] = [*objects, *found, *labelled]
        if not everything and not len(triangles):
            raise DatasetError("scene shows nothing", file=self.path, hint="Fetch its assets.")
        stated = self._used_regions((*descriptor.rooms, *labels.rooms), triangles)
        kept = wanted(everything, self.options)
        rooms, parts, levels = self._levels(kept, triangles, stated)
        if stated and not _has_rooms(levels):
            self.problems.append(Problem("region_annotations", "no floor or wall is in a region: ignored"))
            rooms, parts, levels = self._levels(kept, triangles, ())
        if not _has_rooms(levels):
            raise DatasetError("no triangle is in a room", file=self.path, hint="State its regions.")
        levels = self._lit(parts, levels)
        self.problems += [*builder.problems, *rooms.problems, *labels.problems]
        self.problems += [Problem(element, note) for element, note in {**self.source.notes, **assets.notes}.items()]
        fallbacks = (*stage_fallbacks, *builder.fallbacks, *assets.fallbacks, *rooms.fallbacks)
        problems, models = tuple(self.problems[:MAX_NOTES]), parts.models
        return House(self.house_id, "habitat@1.0", self.path, levels, models, problems, fallbacks=fallbacks)

    def _descriptor(self) -> SemanticDescriptor:
        """Return the scene's semantic descriptor; an empty one, with a note, if it is missing."""
        name, _ = self.scene.text("semantic_scene_instance")
        self._note_navmesh()
        for path in self.source.descriptors(name):
            if path.suffix == ".json" and is_file(path):
                found = read_descriptor(read_json(path))
                self.problems += found.problems
                return found
        if name.has_value:
            self.problems.append(Problem(name.element, f"semantic descriptor `{name.text()[:60]}` is missing: ignored"))
        return SemanticDescriptor()

    def _note_navmesh(self) -> None:
        """Note that the scene's navmesh is not used."""
        value = self.scene.member("navmesh_instance")
        if value.has_value:
            self.problems.append(Problem(value.element, "navmesh is not read: the package makes its own grid"))

    def _objects(
        self, assets: AssetStore, descriptor: SemanticDescriptor
    ) -> tuple[Sequence[SceneObject], ObjectBuilder]:
        """Return the rigid and articulated objects, and their builder with its notes."""
        classes, table = descriptor.classes, read_object_table(self.source.root)
        builder = ObjectBuilder(self.source, assets, furniture_provider(), classes, table, self.strict)
        origin = self.scene.member("translation_origin")
        rigid = [builder.rigid(value, origin) for value in self._instances("object_instances")]
        moving = [builder.articulated(value, origin) for value in self._instances("articulated_object_instances")]
        return kept_objects([*rigid, *moving]), builder

    def _instances(self, key: str) -> list[JsonValue]:
        """Return the instances of a list of the scene; `DatasetError` beyond `MAX_INSTANCES`."""
        value = self.scene.member(key)
        found = value.entries() if value.has_value else []
        if len(found) > MAX_INSTANCES:
            raise value.error(f"scene has {len(found)} instances, at most {MAX_INSTANCES} are read")
        return found

    def _stage(self, assets: AssetStore) -> tuple[list[PlacedMesh], list[Fallback], ScanLabels]:
        """Return the meshes of the stage in the house, what is missing of it, and its labels if it is a scan."""
        value = self.scene.member("stage_instance")
        name = value.member("template_name") if value.has_value else None
        if name is None or name.data in (None, "NONE", "none"):
            return [], [], ScanLabels()
        template = self.source.table("stages").find(name)
        path = self._stage_path(template)
        if template is None or path is None or not is_file(path):
            if self.strict:
                raise name.error(f"stage `{name.text()[:60]}` is missing", "Fetch its asset.", MissingFileError)
            what = "a level floor around everything, without walls"
            return [], [Fallback("room mesh", name.text()[:100], name.element, what, "stage is missing")], ScanLabels()
        frame = self._stage_frame(template)
        placement = read_placement(value, self.scene.member("translation_origin"))
        matrix, origin = asset_matrix(placement, frame, np.zeros(3), np.zeros((2, 3))), template.member("origin")
        if origin.has_value:
            matrix[:3, 3] += origin.vector(3)
        placed = assets.placed(path, matrix)
        return placed, [], read_scan_labels(template, self.source.root, matrix, assets)

    def _stage_path(self, template: HabitatTemplate | None) -> Path | None:
        """Return the file of a stage's mesh; None if it has none."""
        if template is None:
            return None
        value, folder = template.text("render_asset")
        if value.has_value:
            return path_below(self.source.root, folder, value)
        bare = template.file is not None and not template.file.name.endswith(".json")
        return template.file if bare else None

    def _stage_frame(self, template: HabitatTemplate) -> Matrix:
        """Return the frame of a stage; a note says which axis points up if the template does not."""
        if template.member("up").has_value:
            return asset_frame(template)
        bare = template.file is not None and not template.file.name.endswith(".json")
        up = self.up or ("z" if bare else "y")
        message = f"`up` is not stated: {up} points up; state it by `?up=`"
        self.problems.append(Problem(f"stages[{template.handle}]", message))
        return asset_frame(template, up)

    def _used_regions(self, stated: Sequence[StatedRoom], triangles: TriangleSet) -> tuple[StatedRoom, ...]:
        """Return the regions; none, with a note, if the stage is not in them."""
        if not stated or not len(triangles):
            return tuple(stated)
        plan = triangles.middle[:, [0, 2]]
        inside = np.any([is_inside_polygon(room.corners, plan) for room in stated], axis=0)
        if triangles.area[inside].sum() >= MIN_REGION_AREA:
            return tuple(stated)
        message = f"{len(stated)} regions do not contain the stage: ignored"
        self.problems.append(Problem("region_annotations", message))
        return ()

    def _levels(
        self, objects: Sequence[SceneObject], triangles: TriangleSet, stated: Sequence[StatedRoom]
    ) -> tuple[FoundRooms, HouseParts, tuple[Level, ...]]:
        """Return the rooms, those stated or found from the stage, and the levels with their models."""
        split, lowest = self.rooms == "auto", min((float(one.points[:, 1].min()) for one in objects), default=0.0)
        floor = 0.0 if abs(lowest) <= MAX_FLOOR_OFFSET else lowest
        found = scene_rooms(self.path, objects, triangles, stated, split, self.strict, "stage_instance", floor)
        parts = HouseParts(self.path, found.rooms)
        return found, parts, parts.levels(found.triangles, objects)

    def _lit(self, parts: HouseParts, levels: tuple[Level, ...]) -> tuple[Level, ...]:
        """Return levels with the lights of the scene's setup; without one the package adds its own."""
        name = self.scene.member("default_lighting")
        if not name.has_value or name.text() in NO_LIGHTS:
            return levels
        setup = self.source.table("light_setups").find(name)
        if setup is None:
            self.problems.append(Problem(name.element, f"light setup `{name.text()[:60]}` is missing: ignored"))
            return levels
        notes: dict[str, str] = {}
        lights = read_lights(setup, floor_area(levels), notes)
        self.problems += [Problem(element, note) for element, note in notes.items()]
        return add_lights(self.path, levels, parts.models, lights)

    def files(self) -> list[Path]:
        """Return all files that determine the house, in a fixed order; those up to the first broken one."""
        found: dict[Path, None] = dict.fromkeys((self.source.path, self.source.root / OBJECT_TABLE))
        with suppress(DatasetError):
            for path in self._scene_files():
                found[path] = None
        return list(found)

    def _scene_files(self) -> Iterable[Path]:
        """Yield the files of the scene, its templates and their assets."""
        if self.scene.file is not None:
            yield self.scene.file
        yield from self.source.descriptors(self.scene.text("semantic_scene_instance")[0])
        names = [("light_setups", self.scene.member("default_lighting"))]
        stage = self.scene.member("stage_instance")
        names += [("stages", stage.member("template_name"))] if stage.has_value else []
        for section, key in (
            ("objects", "object_instances"),
            ("articulated_objects", "articulated_object_instances"),
        ):
            names += [(section, value.member("template_name")) for value in self._instances(key)]
        for section, text in {(section, name.data): name for section, name in names if name.has_value}.items():
            template = self.source.table(section[0]).find(text)
            yield from self._template_files(template) if template is not None else ()

    def _template_files(self, template: HabitatTemplate) -> Iterable[Path]:
        """Yield the files of a template: its own, its assets, and what these name."""
        paths = [template.file] if template.file is not None else []
        for key in ASSET_KEYS:
            value, folder = template.text(key)
            if value.has_value:
                paths.append(path_below(self.source.root, folder, value))
        for path in paths:
            yield from asset_files(path)
            if path.suffix == ".urdf" and is_file(path):
                shapes = [s for link in read_urdf(path).links.values() for s in link.visuals if s.kind == "mesh"]
                for shape in shapes:
                    yield from asset_files(path_below(self.source.root, path.parent, shape.file))


def asset_files(path: Path) -> list[Path]:
    """Return an asset and the files that it names."""
    suffix = path.suffix.lower()
    if suffix in GLTF_SUFFIXES:
        return [path, *external_files(path)]
    libraries = library_paths(path) if suffix == OBJ else []
    return [path, *libraries, *image_paths(libraries)]


def _has_rooms(levels: Sequence[Level]) -> bool:
    """Return whether a room has a floor, a ceiling or walls."""
    return any(room.floor or room.ceiling or room.walls for level in levels for room in level.rooms)
