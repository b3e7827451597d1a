"""Doors and windows of a floor plan, and the stretches of wall that can take them."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from home_procgen.floor_plan.placed_model import Box, PlacedModel
from home_procgen.floor_plan.rooms import PlanWall, RoomPlan, outer_spans, shared_span

DOOR_Y, SILL_Y = 0.02, 0.85  # [m], heights of the models' origins, as in SUNCG
HIGH_SILL_Y = 1.4  # [m], sill height of the small windows of bathrooms
PASSAGE_DEPTH = 0.9  # [m], depth of the free floor on either side of a door
MIN_OPENING_MARGIN = 0.12  # [m], minimum distance between an opening and the end of its wall

MIN_DOOR_WALL = 1.1  # [m], minimum length of wall for a door


@dataclass(frozen=True)
class PlanOpening:
    """A door or window in a wall, and the rooms it connects; a single room if it leads outside."""

    object: PlacedModel
    rooms: tuple[int, ...]  # the first one owns the object

    @property
    def is_door(self) -> bool:
        """True if an agent can walk through the opening; False for windows and garage doors."""
        return self.object.model.fine == "door"

    @property
    def passage(self) -> Box:
        """Box as wide as the opening and `PASSAGE_DEPTH` deep on both sides, which stays free for walking [m]."""
        x, y, z = self.object.position
        width, height, _ = self.object.model.size
        half = np.array([width / 2, PASSAGE_DEPTH])[:: 1 if self.object.quarter % 2 == 0 else -1]
        return np.array([[x - half[0], y, z - half[1]], [x + half[0], y + height, z + half[1]]])


@dataclass(frozen=True)
class LevelPlan:
    """Rooms with their openings."""

    rooms: tuple[RoomPlan, ...]
    openings: tuple[PlanOpening, ...]
    height: float  # [m], of the walls

    def openings_of(self, room: int) -> list[PlanOpening]:
        """Return the doors and windows of a room, including those that another room owns."""
        return [opening for opening in self.openings if room in opening.rooms]


class OpeningSite(NamedTuple):
    """A stretch of wall that can take an opening."""

    wall: PlanWall  # with the normal towards the first room
    span: tuple[float, float]
    rooms: tuple[int, ...]


def find_inner_sites(rooms: Sequence[RoomPlan]) -> list[OpeningSite]:
    """Return the stretches of wall that two rooms share and that are long enough for a door."""
    return [
        OpeningSite(wall, span, (a, b))
        for b in range(len(rooms))
        for a in range(b)
        for wall in rooms[a].walls
        for other in rooms[b].walls
        if (span := shared_span(wall, other)) and span[1] - span[0] >= MIN_DOOR_WALL
    ]


def find_outer_sites(rooms: Sequence[RoomPlan], room: int) -> list[OpeningSite]:
    """Return the stretches, of any length, of a room's walls that no other room shares."""
    others = [wall for i, other in enumerate(rooms) if i != room for wall in other.walls]
    return [OpeningSite(wall, span, (room,)) for wall in rooms[room].walls for span in outer_spans(wall, others)]
