"""Doors, windows and the entrance of a floor plan."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from home_procgen.floor_plan.placed import Box, PlacedModel
from home_procgen.floor_plan.rooms import PlanWall, RoomPlan

DOOR_Y, SILL_Y = 0.02, 0.85  # [m], heights of the models' origins, as in SUNCG
HIGH_SILL_Y = 1.4  # [m], sill height of the small windows of bathrooms
PASSAGE_DEPTH = 0.9  # [m], depth of the free floor on either side of a door
MIN_OPENING_MARGIN = 0.12  # [m], minimum distance between an opening and the end of its wall


@dataclass(frozen=True)
class PlanOpening:
    """A door or window in a wall, and the rooms it connects; a single room if it leads outside."""

    object: PlacedModel
    rooms: tuple[int, ...]  # the first one owns the object

    @property
    def is_door(self) -> bool:
        """True if an agent can walk through the opening."""
        return self.object.model.fine == "door"

    @property
    def passage(self) -> Box:
        """Box on both sides of the opening that must stay free for walking [m]."""
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
