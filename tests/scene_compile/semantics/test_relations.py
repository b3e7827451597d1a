"""Next to, left of, in front of: against dense samples of outlines and against what a camera sees."""

import numpy as np
import pytest
from block_houses import FLOOR, ROOM, block, place
from hypothesis import given
from hypothesis import strategies as st

from home_mjx.geometry.boxes import BoxSet, footprint, make_boxes
from home_mjx.scene_compile.semantics.relations import (
    MAX_NEIGHBOUR_GAP,
    MAX_VIEW_ANGLE,
    MIN_SEPARATION,
    OPPOSITE,
    ObserverPose,
    Relation,
    footprint_gap,
    observer_relations,
    static_relations,
)
from home_mjx.scene_compile.semantics.supports import Support, find_supports

SPOTS = st.tuples(st.floats(-4, 4), st.floats(-4, 4))
BOXES = st.tuples(SPOTS, st.tuples(st.floats(0.05, 1.5), st.floats(0.05, 1.5)), st.floats(-3.2, 3.2))
HERE = np.zeros((2, 2), int)


def two(*items: tuple) -> BoxSet:
    center, half, yaw = zip(*items, strict=True)
    return make_boxes([(*c, 0.0) for c in center], [(*h, 0.5) for h in half], yaw)


def outline(boxes: BoxSet, i: int) -> np.ndarray:
    corner = footprint(boxes, i)
    along = np.linspace(0, 1, 200)[:, None, None]
    return (corner + along * (np.roll(corner, -1, axis=0) - corner)).reshape(-1, 2)


@given(BOXES, BOXES)
def test_gap_is_the_distance_of_the_outlines(a, b):
    """Sampled outlines are at most a sampling step farther apart; boxes that overlap have no gap."""
    boxes = two(a, b)
    sampled = np.linalg.norm(outline(boxes, 0)[:, None] - outline(boxes, 1), axis=-1).min()
    assert footprint_gap(boxes, 0, 1) == pytest.approx(footprint_gap(boxes, 1, 0), abs=1e-9)
    assert footprint_gap(boxes, 0, 1) <= sampled + 1e-9
    if sampled > 0.05:
        inside = footprint_gap(boxes, 0, 1) == 0
        assert inside or footprint_gap(boxes, 0, 1) == pytest.approx(sampled, abs=0.02)


def test_boxes_that_cross_without_a_corner_or_centre_in_one_another_have_no_gap():
    boxes = make_boxes([(0.0, 0.0, 0.0), (1.0, 1.0, 0.0)], [(2.0, 0.1, 0.5), (0.1, 2.0, 0.5)])
    assert footprint_gap(boxes, 0, 1) == 0.0


def test_next_to_holds_both_ways_within_half_a_metre_and_one_room():
    floor = (0, 0, FLOOR)
    for apart, near in ((MAX_NEIGHBOUR_GAP - 0.01, True), (MAX_NEIGHBOUR_GAP + 0.01, False)):
        objects = place([block(floor, (1, 1, 1)), block((1 + apart, 0, FLOOR), (2 + apart, 1, 0.5))])
        boxes = make_boxes([o.box.center[0] for o in objects], [o.box.half[0] for o in objects])
        found = static_relations([4, 7], boxes, HERE, [Support("floor")] * 2)
        assert found == ((Relation(4, "next to", 7), Relation(7, "next to", 4)) if near else ())
        assert static_relations([4, 7], boxes, np.array([[0, 0], [0, 1]]), [Support("floor")] * 2) == ()
        assert static_relations([4, 7], boxes, np.full((2, 2), -1), [Support("floor")] * 2) == ()


def test_what_is_above_is_not_next_to():
    boxes = make_boxes([(0, 0, 0.5), (0.8, 0, 2.0)], [(0.3, 0.3, 0.5), (0.3, 0.3, 0.2)])
    assert static_relations([0, 1], boxes, HERE, [Support("floor"), Support("wall")]) == ()


def test_on_and_in_are_not_next_to():
    shelf = block((0, 0, FLOOR), (1, 0.4, 2.0), "shelving")
    book = block((0.1, 0.1, 1.0), (0.2, 0.3, 1.2), "books")
    cat = block((0.4, 0.1, 1.98), (0.6, 0.3, 2.2), "pet")
    objects = place([shelf, book, cat])
    boxes = make_boxes([o.box.center[0] for o in objects], [o.box.half[0] for o in objects])
    found = static_relations([0, 1, 2], boxes, np.zeros((3, 2), int), find_supports(objects, ROOM))
    assert set(found) == {Relation(1, "in", 0), Relation(2, "on", 0)}


@given(SPOTS, SPOTS, SPOTS)
def test_each_pair_has_one_relation_and_its_opposite(a, b, eye):
    boxes = two((a, (0.1, 0.1), 0.0), (b, (0.1, 0.1), 0.0))
    found = observer_relations([3, 5], boxes, HERE, ObserverPose(*eye))
    mirrored = observer_relations([5, 3], boxes[np.array([1, 0])], HERE, ObserverPose(*eye))
    assert set(found) == set(mirrored)
    assert len(found) in (0, 2)
    for first, second in [found] if found else []:
        assert first.predicate in OPPOSITE
        assert (second.subject, second.predicate, second.object) == (
            first.object,
            OPPOSITE[first.predicate],
            first.subject,
        )


@given(SPOTS, SPOTS, SPOTS, st.floats(-3.1, 3.1))
def test_relations_agree_with_a_camera(a, b, eye, turn):
    """Left is left in the picture of a camera that looks between the two; nearer is in front."""
    a, b, eye = np.array(a), np.array(b), np.array(eye)
    reach = np.linalg.norm([a - eye, b - eye], axis=1)
    if reach.min() < 0.2:
        return
    axis = (a - eye) / reach[0] + (b - eye) / reach[1]
    if np.linalg.norm(axis) < 0.2:  # one is behind a camera that looks at the other
        return
    ahead = axis / np.linalg.norm(axis)
    right = np.array([ahead[1], -ahead[0]])
    column = [(p - eye) @ right / ((p - eye) @ ahead) for p in (a, b)]
    boxes = two((a, (0.1, 0.1), 0.0), (b, (0.1, 0.1), 0.0))
    found = observer_relations([0, 1], boxes, HERE, ObserverPose(*eye.tolist(), heading=turn))
    for relation in found:
        i, j = relation.subject, relation.object
        if relation.predicate == "left of":
            assert column[i] < column[j]
        elif relation.predicate == "in front of":
            assert reach[i] < reach[j]
    if not found:
        opposite = ((a - eye) @ (b - eye)) / reach.prod() < np.cos(MAX_VIEW_ANGLE) + 1e-9
        assert opposite or np.linalg.norm(a - b) < 2 * MIN_SEPARATION


def test_nothing_is_said_of_what_is_on_opposite_sides_or_where_the_observer_stands():
    ends = two(((2, 0), (0.1, 0.1), 0.0), ((-2, 0.5), (0.1, 0.1), 0.0))
    assert observer_relations([0, 1], ends, HERE, ObserverPose(0.0, 0.0)) == ()
    assert observer_relations([0, 1], ends, HERE, ObserverPose(2.0, 0.0)) == ()
    assert observer_relations([0, 1], ends, HERE, ObserverPose(0.0, -2.0))[0] == Relation(1, "left of", 0)


@given(SPOTS, st.floats(-3.1, 3.1), st.floats(-3.1, 3.1), st.floats(0.1, 5))
def test_sides_are_quarters_of_the_circle_around_the_heading(eye, heading, bearing, reach):
    if abs(abs((bearing % (np.pi / 2)) - np.pi / 4)) < 1e-3:
        return
    x, y = eye[0] + reach * np.cos(heading + bearing), eye[1] + reach * np.sin(heading + bearing)
    side = ObserverPose(*eye, heading=heading).side((x, y, 3.0))
    ahead, left = np.cos(bearing), np.sin(bearing)
    wanted = ("ahead" if ahead > 0 else "behind") if abs(ahead) > abs(left) else ("left" if left > 0 else "right")
    assert side == wanted
