"""Which room an object is in: by the file's lists and the outlines of floors, never by bounding boxes."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from block_houses import block
from hypothesis import given
from hypothesis import strategies as st

from home_mjx.geometry.polygons import is_inside_polygon, polygon_distance
from home_mjx.scene_compile.architecture.rooms import HouseFrame
from home_mjx.scene_compile.objects.placed_objects import MAX_ROOM_DISTANCE, place_objects
from home_mjx.schema.compiled import RoomTable
from home_mjx.schema.house import House, Level, Metadata, RoomNode

# An L around a square in its corner, and a small room within the L.
ELL = np.array([[0.0, 0], [6, 0], [6, 3], [3, 3], [3, 6], [0, 6]])
SQUARE = np.array([[3.0, 3], [6, 3], [6, 6], [3, 6]])
CLOSET = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])
ROOMS = RoomTable(
    np.array([0, 1, 2], np.int32),
    np.zeros(3, np.int32),
    (ELL, SQUARE, CLOSET),
    np.zeros(3),
    np.ones(3),
    np.array([1, 2, 4]),
)


def room_of(x: float, y: float, listed: tuple[int, ...]) -> int:
    """Where a cube is that some rooms list."""
    node, _ = block((x - 0.1, y - 0.1, 0), (x + 0.1, y + 0.1, 0.2))
    rooms = tuple(
        RoomNode("", 1 + i, "", None, f"fr_0rm_{i}", (), (0,) if i in listed else (), None, None, None)
        for i in range(3)
    )
    level = Level("0", 0, rooms, (), (replace(node, index=0),), ())
    (placed,) = place_objects(
        HouseFrame(House("h", "", Path("house.json"), (level,), {}), np.zeros(3), ROOMS), Metadata({})
    )
    return placed.room


@pytest.mark.parametrize(
    ("x", "y", "listed", "room"),
    [
        (2, 2, (), 0),
        (4, 4, (), 1),  # inside of the L's bounding box, outside of the L
        (0.5, 0.5, (), 2),  # the smaller of two that nest
        (0.5, 0.5, (0,), 0),  # unless the file says otherwise
        (0.5, 0.5, (0, 2), 2),
        (3.1, 4, (0,), 0),  # a door's leaf that swings into the next room
        (5.5, 5.5, (0,), 1),  # listed by a room that is far away
        (6.5, 1, (0,), 0),  # before the window
        (6 + MAX_ROOM_DISTANCE + 0.1, 1, (0,), -1),
        (9, 9, (), -1),
    ],
)
def test_rooms_are_found_by_outline(x, y, listed, room):
    assert room_of(x, y, listed) == room


@given(st.floats(-3, 9), st.floats(-3, 9))
def test_distance_to_a_polygon_is_that_to_dense_samples_of_it(x, y):
    point = np.array([x, y])
    ends = np.roll(ELL, -1, axis=0)
    edge = (ELL + np.linspace(0, 1, 400)[:, None, None] * (ends - ELL)).reshape(-1, 2)
    sampled = 0.0 if is_inside_polygon(ELL, point) else np.linalg.norm(edge - point, axis=1).min()
    assert polygon_distance(ELL, point) == pytest.approx(sampled, abs=0.01)


def test_a_room_without_outline_is_infinitely_far():
    assert polygon_distance(np.zeros((0, 2)), np.zeros(2)) == np.inf
