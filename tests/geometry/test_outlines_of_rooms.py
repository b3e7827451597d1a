"""Outlines of rooms from their floors: concave corners, fine arcs, corners on a line."""

import numpy as np
import pytest

from home_mjx.geometry.polygons import MAX_BEND, outline, polygon_area
from home_mjx.geometry.slabs import MAX_MITRE, MIN_CORNER_DISTANCE, offset_outwards, signed_area, simplify, slab

SQUARE = np.array([(0, 0), (4, 0), (4, 4), (0, 4)], float)


def rounded_room(segments, radius=1.0):
    """A square of 4 m whose corner at (4, 4) is an arc."""
    angle = np.linspace(0, np.pi / 2, segments + 1)
    arc = np.stack([np.cos(angle), np.sin(angle)], axis=1) * radius + 4 - radius
    return np.concatenate([[(0, 0), (4, 0)], arc, [(0, 4)]])


def floor_of(polygon):
    """Triangles of a slab over a polygon, Z up."""
    vertices, faces, _ = slab([polygon * (1, -1)], -0.05, 0.0, 0.0)
    x, y, z = vertices.T
    return np.stack([x, -z, y], axis=1)[faces]


@pytest.mark.parametrize("segments", [1, 8, 23, 79, 400, 3000])
def test_a_rounded_corner_keeps_its_shape_however_finely_it_is_divided(segments):
    room = rounded_room(segments)
    found = outline(floor_of(room))
    assert polygon_area(found) == pytest.approx(polygon_area(room), abs=2 * MAX_BEND)
    assert len(found) < 30
    away = np.linalg.norm(found[:, None] - room[None], axis=2).min(axis=1)
    assert away.max() < 2e-4  # corners of the room


@pytest.mark.parametrize("first", range(0, 40, 7))
def test_a_round_room(first):
    angle = np.arange(2000) * np.pi / 1000
    room = np.roll(2 * np.stack([np.cos(angle), np.sin(angle)], axis=1), first, axis=0)
    assert polygon_area(outline(floor_of(room))) == pytest.approx(4 * np.pi, rel=1e-3)


def test_corners_on_a_line_are_removed():
    steps = np.linspace(0, 1, 50, endpoint=False)[:, None]
    room = np.concatenate([a + steps * (b - a) for a, b in zip(SQUARE, np.roll(SQUARE, -1, axis=0), strict=True)])
    triangles = np.array([[SQUARE.mean(axis=0), a, b] for a, b in zip(room, np.roll(room, -1, axis=0), strict=True)])
    found = outline(np.concatenate([triangles, np.zeros((len(room), 3, 1))], axis=2))
    assert sorted(map(tuple, found.round(3).tolist())) == sorted(map(tuple, SQUARE.tolist()))


@pytest.mark.parametrize("segments", [8, 400, 5000])
def test_simplified_polygons_keep_fine_arcs(segments):
    room = rounded_room(segments)
    assert signed_area(simplify(room)) == pytest.approx(signed_area(room), abs=4 * MIN_CORNER_DISTANCE)


def test_simplified_polygons_lose_corners_on_a_line_and_repeated_ones():
    for first in range(8):
        line = [(0, 0), (1, 0), (1, 0), (2, 0), (3, 0), (3, 1), (3, 2), (0, 2)]
        found = simplify(np.roll(np.array(line, float), first, axis=0))
        assert sorted(map(tuple, found.tolist())) == [(0, 0), (0, 2), (3, 0), (3, 2)]


@pytest.mark.parametrize(("degrees", "moved"), [(90.0, np.sqrt(2)), (60.0, MAX_MITRE), (61.0, 1.97), (20.0, 0.69)])
def test_corners_are_mitred_down_to_60_degrees_and_never_move_farther(degrees, moved):
    angle = np.deg2rad(degrees)
    wedge = np.array([(0, 0), (4, 0), (4 * np.cos(angle), 4 * np.sin(angle))])
    assert np.linalg.norm(offset_outwards(wedge, 0.1)[0]) == pytest.approx(0.1 * moved, rel=0.01)
