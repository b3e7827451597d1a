"""Grids, distances, rooms and free places on the device; a follower of shortest paths on the host."""

from home_mjx.navigation.fields import distance_field, goal_fields
from home_mjx.navigation.grid import cell_of, geodesic_distance, ground_fields, place_position, random_position, room_of
from home_mjx.navigation.path_follower import Walker, make_walker
from home_mjx.navigation.spawn import random_source, random_yaw, spread_starts

__all__ = [
    "Walker",
    "cell_of",
    "distance_field",
    "geodesic_distance",
    "goal_fields",
    "ground_fields",
    "make_walker",
    "place_position",
    "random_position",
    "random_source",
    "random_yaw",
    "room_of",
    "spread_starts",
]
