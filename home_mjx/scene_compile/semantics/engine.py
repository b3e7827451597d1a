"""Semantic engine: describes all rooms, surfaces and objects of a house."""

from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float

from home_mjx.datasets.kept_results import kept_result
from home_mjx.geometry.meshes import surface_areas
from home_mjx.geometry.polygons import polygon_area
from home_mjx.scene_compile.architecture.rooms import HouseFrame, find_frame, house_rooms
from home_mjx.scene_compile.architecture.shell import BuildingShell, build_shell, inner_normal
from home_mjx.scene_compile.objects.placed_objects import PlacedObject, place_objects
from home_mjx.scene_compile.semantics.appearance import (
    Appearance,
    SemanticOptions,
    TexturedTriangles,
    compute_appearance,
    texture_digest,
)
from home_mjx.scene_compile.semantics.describe import short_text
from home_mjx.scene_compile.semantics.sizes import SizeTable, size_table
from home_mjx.scene_compile.semantics.supports import Support, find_supports
from home_mjx.scene_compile.semantics.types import (
    UNKNOWN,
    HouseSemantics,
    ObjectSemantics,
    PartSemantics,
    RoomSemantics,
)
from home_mjx.schema.categories import ROOM_TYPES, room_types_in
from home_mjx.schema.color_names import COLOR_LEVELS
from home_mjx.schema.compiled import RoomTable
from home_mjx.schema.house import House, Metadata, ObjectNode

DEFAULT_OPTIONS = SemanticOptions()


def house_semantics(house: House, metadata: Metadata, options: SemanticOptions = DEFAULT_OPTIONS) -> HouseSemantics:
    """Compute categories, rooms, colours, materials, sizes, supports and relations of all objects in a house.

    Args:
        house: House as read from the dataset.
        metadata: Categories and sizes of its models.
        options: Rules for colours, materials and sizes.

    Raises:
        DatasetError: The house has no room with a mesh, or a texture cannot be read.

    Example:
        >>> dataset = open_dataset("/data/suncg")  # doctest: +SKIP
        >>> meaning = house_semantics(dataset.load_house(dataset.house_ids[0]), dataset.metadata)  # doctest: +SKIP
        >>> meaning.objects[0].description  # doctest: +SKIP
        'dark gray window'
    """
    frame = find_frame(house)
    return describe_house(frame, build_shell(frame), place_objects(frame, metadata), metadata, options)


def describe_house(
    frame: HouseFrame,
    shell: BuildingShell,
    objects: Sequence[PlacedObject],
    metadata: Metadata,
    options: SemanticOptions = DEFAULT_OPTIONS,
) -> HouseSemantics:
    """Compute the result of `house_semantics` for a house that is already built in the world frame."""
    house, rooms = frame.house, frame.rooms
    sizes, supports, looks = size_table(metadata), find_supports(objects, rooms), _AppearanceCache(options)
    return HouseSemantics(
        id=house.id,
        rooms=tuple(
            RoomSemantics(i, room.types, level, polygon_area(rooms.polygon[i]))
            for i, (level, room) in enumerate(house_rooms(house))
        ),
        parts=tuple(_part(shell, i, rooms, looks) for i in range(len(shell.parts))),
        objects=tuple(
            _object(item, support, rooms, sizes, looks) for item, support in zip(objects, supports, strict=True)
        ),
    )


@dataclass(frozen=True)
class _AppearanceCache:
    """Cache of the appearances in a house, since chairs and the walls of a room often share theirs."""

    options: SemanticOptions
    found: dict[Hashable, Appearance] = field(default_factory=dict)

    def get(self, key: Hashable, skin: Callable[[], TexturedTriangles]) -> Appearance:
        """Return the cached appearance of a key, else compute it of `skin()`; the first skin of a key counts."""
        if key not in self.found:
            self.found[key] = compute_appearance(skin(), self.options)
        return self.found[key]

    def of_object(self, item: PlacedObject) -> Appearance:
        """Return the appearance of an object, cached in memory and on disk by its model, its surfaces and its scale."""
        surfaces, stretch = item.surfaces, (item.pose[:, :3].T @ item.pose[:, :3]).round(6)  # determines the areas

        def skin() -> TexturedTriangles:
            """Return the object's triangles with their areas and surfaces."""
            return TexturedTriangles(surface_areas(item.triangles), item.model.uv, item.model.slot, surfaces)

        key = (item.model.key, surfaces, stretch.tobytes())
        if key not in self.found:
            shown = tuple((replace(s, texture=Path(s.texture).name), texture_digest(s.texture)) for s in surfaces)
            inputs = repr((item.model.key, shown, stretch.tobytes(), self.options)).encode()
            found = kept_result(_Look, inputs, lambda: _Look.of(compute_appearance(skin(), self.options)))
            self.found[key] = found.appearance
        return self.found[key]


@dataclass(frozen=True)
class _Look:
    """An `Appearance` in fields that can be kept."""

    basic: tuple[str, ...]
    css: tuple[str, ...]
    xkcd: tuple[str, ...]
    materials: tuple[str, ...]
    is_textured: bool

    @classmethod
    def of(cls, look: Appearance) -> "_Look":
        """Create the record of an appearance."""
        return cls(**look.colors, materials=look.materials, is_textured=look.is_textured)

    @property
    def appearance(self) -> Appearance:
        """The appearance."""
        colors = {level: getattr(self, level) for level in COLOR_LEVELS}
        return Appearance(colors, self.materials, self.is_textured)


def _part(shell: BuildingShell, index: int, rooms: RoomTable, looks: _AppearanceCache) -> PartSemantics:
    """Return the semantics of part `index`; appearance and area are those of the largest slot on its room's side.

    Parts whose largest slots have equal surfaces share the appearance of the first one.
    """
    part, model = shell.parts[index], shell.model
    seen = np.flatnonzero((model.part == index) & (model.slot == shell.inner_slot[index]))
    triangles = model.triangle[seen].astype(np.float64)
    area = surface_areas(triangles) * _faces(triangles, inner_normal(part, rooms))
    skin = TexturedTriangles(area, model.uv[seen], model.slot[seen], shell.surfaces)
    look = looks.get(shell.surfaces[shell.inner_slot[index]], lambda: skin)
    category = "floor" if part.kind == "ground" else part.kind
    return PartSemantics(
        index=index,
        category=category,
        room=part.room,
        room_type=room_type(rooms, part.room),
        room_types=room_types(rooms, part.room),
        level=part.level,
        partition=int(shell.partition[index]),
        appearance=look,
        area=float(area.sum()),
        description=short_text("", look, category),
    )


def _faces(triangles: Float[np.ndarray, "t 3 3"], toward: Float[np.ndarray, "3"]) -> Bool[np.ndarray, " t"]:
    """Return a mask of the triangles whose normals are within 45 degrees of unit `toward`."""
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    return normal @ toward > 0.7 * np.linalg.norm(normal, axis=1)


def _object(
    item: PlacedObject, support: Support, rooms: RoomTable, sizes: SizeTable, looks: _AppearanceCache
) -> ObjectSemantics:
    """Return the semantics of one object."""
    look = looks.of_object(item)
    size = sizes.log_volume_size(_volume(item), item.info)
    return ObjectSemantics(
        object_id=item.object_id,
        node=item.node.id,
        model=item.node.model_id if isinstance(item.node, ObjectNode) else "",
        fine=item.info.fine,
        coarse=item.info.coarse,
        nyu40=item.info.nyu40,
        room=item.room,
        room_type=room_type(rooms, item.room),
        room_types=room_types(rooms, item.room),
        level=item.level,
        box=item.box,
        appearance=look,
        size=size,
        support=support,
        description=short_text(size, look, item.info.fine),
    )


def _volume(item: PlacedObject) -> float:
    """Return the volume of the model's scaled bounding box [m^3]; every edge counts as at least 1 mm."""
    edges = np.ptp(item.model.box.astype(np.float64), axis=0) * np.linalg.norm(item.pose[:, :3], axis=0)
    return float(np.maximum(edges, 1e-3).prod())


def room_type(rooms: RoomTable, room: int) -> str:
    """Return the first label of room `room` (-1: no room); `unknown` for no room or no label."""
    kind = int(rooms.type[room]) if room >= 0 else -1
    return ROOM_TYPES[kind] if kind >= 0 else UNKNOWN


def room_types(rooms: RoomTable, room: int) -> tuple[str, ...]:
    """Return all labels of room `room` (-1: no room), the first one first; () for no room or no label."""
    if room < 0:
        return ()
    first, labels = int(rooms.type[room]), room_types_in(int(rooms.labels[room]))
    return tuple(ROOM_TYPES[kind] for kind in sorted(labels, key=lambda kind: kind != first))
