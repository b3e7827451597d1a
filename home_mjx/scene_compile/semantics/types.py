"""Semantics of a house as frozen records."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from home_mjx.geometry.boxes import BoxSet, concat_boxes
from home_mjx.scene_compile.semantics.appearance import Appearance
from home_mjx.scene_compile.semantics.relations import ObserverPose, Relation, observer_relations, static_relations
from home_mjx.scene_compile.semantics.supports import Support

UNKNOWN = "unknown"


@dataclass(frozen=True)
class RoomSemantics:
    """Semantics of one room.

    Attributes:
        index: Position in the house.
        types: Labels as in the file, such as ("Bedroom",); empty if unknown.
        level: Level index.
        area: Area of its floor [m^2].
    """

    index: int
    types: tuple[str, ...]
    level: int
    area: float


@dataclass(frozen=True)
class PartSemantics:
    """Semantics of one architectural surface: a floor, a ceiling, a ground, or a wall of one room.

    Attributes:
        index: Semantic part, which is also its row in the house's semantic table.
        category: `wall`, `floor` or `ceiling`, in all three vocabularies.
        room: Room index; -1 outdoors.
        room_type: First label of the room, or `unknown`.
        room_types: All labels of the room; empty without a known one.
        level: Level index.
        partition: Physical wall or slab.
        appearance: Colours and materials of the side that faces its room.
        area: Area of that side [m^2].
        description: Short text, such as `white wall made of wallpaper`.
    """

    index: int
    category: str
    room: int
    room_type: str
    room_types: tuple[str, ...]
    level: int
    partition: int
    appearance: Appearance
    area: float
    description: str


@dataclass(frozen=True)
class ObjectSemantics:
    """Semantics of one object or box.

    Attributes:
        object_id: Node index in file order over all levels, as in the instance image.
        node: Id in the file.
        model: Library model; "" for boxes.
        fine: One of the 187 fine v1 categories, or one of v2.
        coarse: Coarse category.
        nyu40: NYUv2-40 class.
        room: Room index; -1 outside all rooms.
        room_type: First label of the room, or `unknown`.
        room_types: All labels of the room; empty without a known one.
        level: Level index.
        box: Upright box around it, in the world [m, rad].
        appearance: Colours and materials.
        size: One of `SIZES` within its category; "" without models to compare with.
        support: Support of the object.
        description: Short text, such as `small linen coffee table made of wood`.
    """

    object_id: int
    node: str
    model: str
    fine: str
    coarse: str
    nyu40: str
    room: int
    room_type: str
    room_types: tuple[str, ...]
    level: int
    box: BoxSet
    appearance: Appearance
    size: str
    support: Support
    description: str

    @property
    def position(self) -> tuple[float, float, float]:
        """Centre of its box in the world [m]."""
        x, y, z = self.box.center[0].tolist()
        return x, y, z


@dataclass(frozen=True)
class HouseSemantics:
    """Semantics of one house.

    Attributes:
        id: House id.
        rooms: Rooms in file order.
        parts: Surfaces of the architecture, in the order of their rows.
        objects: Objects in file order.
    """

    id: str
    rooms: tuple[RoomSemantics, ...]
    parts: tuple[PartSemantics, ...]
    objects: tuple[ObjectSemantics, ...]

    @cached_property
    def objects_by_id(self) -> Mapping[int, ObjectSemantics]:
        """Objects by id."""
        return {item.object_id: item for item in self.objects}

    @property
    def objects_outside(self) -> tuple[ObjectSemantics, ...]:
        """Objects outside all rooms."""
        return tuple(item for item in self.objects if item.room < 0)

    @cached_property
    def relations(self) -> tuple[Relation, ...]:
        """Relations on, in and next to, which are independent of the observer."""
        return static_relations(self._ids, self._boxes, self._places, [item.support for item in self.objects])

    def relations_from(self, viewpoint: ObserverPose) -> tuple[Relation, ...]:
        """Return observer-dependent relations of each pair of objects in a room; the heading is not used.

        Each pair is left and right of, or in front of and behind each other, by the larger separation.
        Pairs that are too close, or on opposite sides of the observer, have none.
        """
        return observer_relations(self._ids, self._boxes, self._places, viewpoint)

    @property
    def _ids(self) -> list[int]:
        """Object ids in the order of `objects`, as `_boxes` and `_places`."""
        return [item.object_id for item in self.objects]

    @cached_property
    def _boxes(self) -> BoxSet:
        """Boxes of all objects, in order."""
        return concat_boxes(item.box for item in self.objects)

    @property
    def _places(self) -> np.ndarray:
        """Level and room of each object."""
        return np.array([(item.level, item.room) for item in self.objects]).reshape(-1, 2)
