"""Navigation grids, geodesic distances, rooms and free positions on the device."""

import importlib
from typing import TYPE_CHECKING, Any

from home_mjx.navigation.doors import connected_rooms, door_angles, passable_portals
from home_mjx.navigation.grid import (
    cell_at_feet,
    cell_below,
    geodesic_distance,
    grid_position,
    ground_fields,
    is_near_home_region,
    random_position,
    room_at_feet,
    room_below,
)
from home_mjx.navigation.spawn import random_source, random_yaw, sample_starts

if TYPE_CHECKING:
    from home_mjx.navigation.distance_fields import distance_field, goal_fields

_FIELDS = ("distance_field", "goal_fields")  # loaded on first use: the audio engine needs no distance fields

__all__ = [
    "cell_at_feet",
    "cell_below",
    "connected_rooms",
    "distance_field",
    "door_angles",
    "geodesic_distance",
    "goal_fields",
    "grid_position",
    "ground_fields",
    "is_near_home_region",
    "passable_portals",
    "random_position",
    "random_source",
    "random_yaw",
    "room_at_feet",
    "room_below",
    "sample_starts",
]


def __getattr__(name: str) -> Any:
    if name not in _FIELDS:
        raise AttributeError(f"module 'home_mjx.navigation' has no attribute {name!r}")
    return getattr(importlib.import_module("home_mjx.navigation.distance_fields"), name)
