"""Navigation grids, geodesic distances, rooms and free positions on the device."""

from home_mjx.navigation.compartments import compartment_at, containers_at, store_bodies
from home_mjx.navigation.distance_fields import distance_field, goal_fields
from home_mjx.navigation.doors import connected_rooms, door_angles, opening_fractions, passable_portals
from home_mjx.navigation.grid import (
    cell_at_feet,
    cell_below,
    geodesic_distance,
    grid_position,
    is_near_home_region,
    random_position,
    room_at_feet,
    room_below,
)
from home_mjx.navigation.spawn import random_source, random_yaw, sample_starts

__all__ = [
    "cell_at_feet",
    "cell_below",
    "compartment_at",
    "connected_rooms",
    "containers_at",
    "distance_field",
    "door_angles",
    "geodesic_distance",
    "goal_fields",
    "grid_position",
    "is_near_home_region",
    "opening_fractions",
    "passable_portals",
    "random_position",
    "random_source",
    "random_yaw",
    "room_at_feet",
    "room_below",
    "sample_starts",
    "store_bodies",
]
