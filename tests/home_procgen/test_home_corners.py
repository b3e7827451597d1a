"""Things in corners: where they may stand, and which of their sides is at which wall."""

import numpy as np
import pytest

from home_procgen.floor_plan.placed_model import PlacedModel
from home_procgen.floor_plan.rooms import Rect, RoomPlan
from home_procgen.floor_plan.walls import PRISM_THICKNESS
from home_procgen.furnish.space.collision_boxes import BoxStore, collision_boxes
from home_procgen.furnish.space.corner_placement import corner_spots, place_across_corner
from home_procgen.furnish.space.floor_placement import WALL_GAP, random_point
from home_procgen.furnish.space.room_space import RoomSpace
from home_procgen.style.object_kinds import list_models

OBLONG = (Rect(0.0, 0.0, 5.0, 4.0),)
L_SHAPE = (Rect(0.0, 0.0, 6.0, 3.0), Rect(0.0, 3.0, 3.0, 6.0))
KINDS = (
    "corner_sofa",
    "corner_desk",
    "corner_wardrobe",
    "corner_shelf",
    "corner_bathtub",
    "corner_wall_cabinet",
    "shower",
)


def room(rects=OBLONG, fits: bool = True) -> RoomSpace:
    """A room without doors, in which everything fits, or nothing."""
    bare = object.__new__(RoomSpace)
    bare.plan, bare.rng, bare.solid = RoomPlan("Office", rects), np.random.default_rng(0), BoxStore()
    vars(bare)["try_place"] = lambda *_: fits
    return bare


def thing(kind: str, mirrored: bool = False) -> PlacedModel:
    return PlacedModel(list_models(kind)[0], (0.0, 0.0, 0.0), mirrored=mirrored)


@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize("kind", KINDS)
def test_a_corner_piece_has_its_corner_in_each_corner_of_a_room(kind, mirrored):
    """The corner of its box that is behind on the left, or right, is beside a corner of the room, all of it inside."""
    item, seen = thing(kind, mirrored), set()
    spots = corner_spots(room(), item)
    for spot in spots:
        placed = item.moved_to(*spot)
        low, high = placed.box[:, [0, 2]]
        assert (low > PRISM_THICKNESS + WALL_GAP / 2).all()
        assert (high < np.array([5.0, 4.0]) - PRISM_THICKNESS - WALL_GAP / 2).all()
        half = item.size / 2
        behind = np.array(placed.local_point(half[0] if mirrored else -half[0], -half[2]))
        ends = np.array([[x, z] for x in (0.0, 5.0) for z in (0.0, 4.0)])
        distance = abs(behind - ends).max(axis=1)
        assert distance.min() == pytest.approx(PRISM_THICKNESS + WALL_GAP, abs=2e-3)
        seen.add(int(distance.argmin()))
    assert seen == {0, 1, 2, 3}
    assert len(spots) == 4


def test_corners_that_jut_into_a_room_are_none():
    """An L has five corners that things can stand in, and one around which they would have to bend."""
    spots = corner_spots(room(L_SHAPE), thing("corner_shelf"))
    assert len(spots) == 5
    assert not any(abs(np.array([s[0], s[2]]) - 3.0).max() < 0.5 for s in spots)


@pytest.mark.parametrize("kind", ["armchair", "corner_toilet"])
def test_across_a_corner_things_look_into_the_room_and_touch_both_walls(kind):
    placed = place_across_corner(room(), thing(kind))
    assert placed is not None
    way = placed.linear @ (0.0, 0.0, 1.0)
    assert abs(way[[0, 2]]) == pytest.approx(np.sqrt(0.5), abs=1e-3)
    middle = np.array([2.5, 2.0]) - np.array(placed.position)[[0, 2]]
    assert (np.sign(middle) == np.sign(way[[0, 2]])).all()
    walls = np.array(
        [[PRISM_THICKNESS + WALL_GAP] * 2, [5.0 - PRISM_THICKNESS - WALL_GAP, 4.0 - PRISM_THICKNESS - WALL_GAP]]
    )
    boxes = collision_boxes(placed)[..., [0, 2]]
    gaps = abs(np.stack([boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)]) - walls)
    assert np.sort(gaps.min(axis=0)) == pytest.approx([0.0, 0.0], abs=1e-3)
    assert place_across_corner(room(fits=False), thing(kind)) is None


def test_points_in_narrow_rooms_are_on_their_middle_line():
    """A strip of half a metre: there is no place so far from both of its sides."""
    narrow = room((Rect(0.0, 0.0, 0.5, 3.0),))
    points = np.array([random_point(narrow, 0.3)[:2] for _ in range(200)])
    assert points[:, 0] == pytest.approx(0.25)
    assert points[:, 1].min() < 0.6
    assert points[:, 1].max() > 2.4
    assert (points[:, 1] >= 0.3).all()
    assert (points[:, 1] <= 2.7).all()
