"""Navigation grids, geodesic distances, rooms and free positions on the device; a path follower on the host."""

from home_mjx.navigation.doors import door_angles, joined_rooms, open_portals
from home_mjx.navigation.fields import distance_field, goal_fields
from home_mjx.navigation.grid import (
    cell_of,
    geodesic_distance,
    ground_fields,
    near_home,
    place_position,
    random_position,
    room_of,
)
from home_mjx.navigation.path_follower import Walker, make_walker
from home_mjx.navigation.spawn import random_source, random_yaw, spread_starts

__all__ = [
    "Walker",
    "cell_of",
    "distance_field",
    "door_angles",
    "geodesic_distance",
    "goal_fields",
    "ground_fields",
    "joined_rooms",
    "make_walker",
    "near_home",
    "open_portals",
    "place_position",
    "random_position",
    "random_source",
    "random_yaw",
    "room_of",
    "spread_starts",
]
