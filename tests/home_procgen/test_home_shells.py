"""Shells of homes: corners without grey ends, floors and walls that do not coincide, leaves of doors."""

from itertools import combinations
from pathlib import Path

import numpy as np
import pytest

from home_mjx.geometry.mesh_pieces import CUT_MATERIAL
from home_mjx.geometry.wall_prisms import WALL_DEPTH
from home_procgen.floor_plan.rooms import Rect, RoomPlan
from home_procgen.floor_plan.walls import RoomSurfaces
from home_procgen.meshes import build_room_meshes
from home_procgen.plan.shape.cut_rooms import CutRoom
from home_procgen.primitives.palette import plain
from home_procgen.things.openings.leaves import leaf

SURFACES = RoomSurfaces(*map(plain, ("#111111", "#222222", "#333333", "#444444", "#555555")))
L_SHAPE = (Rect(0.0, 0.0, 6.0, 3.0), Rect(0.0, 3.0, 3.0, 6.0))


def walls(room: RoomPlan, opened: bool = False):
    return build_room_meshes(Path("fr_0rm_0"), room, 2.7, [], SURFACES, has_ceiling_opening=opened)[2]


def covers(mesh, point) -> bool:
    """Return whether a prism of the walls contains a point: all its faces have it behind them."""
    for group in range(len(mesh.groups)):
        a, b, c = mesh.vertices[mesh.faces[mesh.group == group]].transpose(1, 0, 2)
        if (((point - a) * np.cross(b - a, c - a)).sum(axis=1) < 0).all():
            return True
    return False


@pytest.mark.parametrize(
    "room", [RoomPlan("Office", L_SHAPE), CutRoom("Office", (Rect(0.0, 0.0, 6.0, 5.0),), ((0.0, 0.0, 0.6),))]
)
def test_corners_of_walls_are_closed_on_both_sides(room):
    """Just inside each mitre the wall is solid: no notch that shows the ends of its prisms."""
    mesh = walls(room)
    corners = np.asarray(room.polygon)
    for before, corner, after in zip(np.roll(corners, 1, 0), corners, np.roll(corners, -1, 0), strict=True):
        ways = [(p - q) / np.linalg.norm(p - q) for p, q in ((corner, before), (after, corner))]
        normals = [np.array([-z, x]) for x, z in ways]  # into the room
        mitre = sum(normals) / (1 + normals[0] @ normals[1])
        for depth in (WALL_DEPTH / 2 - 1e-3, 1e-3 - WALL_DEPTH * 0.447):
            x, z = corner + depth * mitre
            assert covers(mesh, np.array([x, 1.3, z])), (corner, depth)


def test_walls_have_no_grey_faces():
    assert not any(m.diffuse == CUT_MATERIAL.diffuse for m in walls(RoomPlan("Office", L_SHAPE)).materials)


def test_floors_of_neighbours_and_walls_above_each_other_do_not_overlap():
    left, right = (RoomPlan("Office", (Rect(x, 0.0, x + 3.0, 4.0),)) for x in (0.0, 3.0))
    floors = [build_room_meshes(Path("fr_0rm_0"), room, 2.7, [], SURFACES)[0].vertices for room in (left, right)]
    assert floors[0][:, 0].max() == floors[1][:, 0].min() == 3.0
    assert walls(RoomPlan("Hall", L_SHAPE), opened=True).vertices[:, 1].max() == 2.7


def test_boards_of_chevron_doors_do_not_stick_through_one_another():
    """Boards and rim have a line between them, and none is beyond the outline."""
    panel, *boards = (solid.vertices[:, :2] for solid in leaf(0.8, 2.0, "chevron"))
    assert all((panel.min(axis=0) - 1e-6 < b).all() and (b < panel.max(axis=0) + 1e-6).all() for b in boards)
    assert len(boards) > 20
    assert all(separated(a, b) for a, b in combinations(boards, 2))


def separated(a: np.ndarray, b: np.ndarray) -> bool:
    """Return whether a line separates two convex figures, by the directions between all of their corners."""
    edges = np.concatenate([(p[:, None] - p[None]).reshape(-1, 2) for p in (a, b)])
    edges = edges[np.linalg.norm(edges, axis=1) > 1e-6]
    normals = np.stack([-edges[:, 1], edges[:, 0]], axis=1) / np.linalg.norm(edges, axis=1, keepdims=True)
    u, v = a @ normals.T, b @ normals.T
    return bool(((u.max(axis=0) < v.min(axis=0) + 1e-6) | (v.max(axis=0) < u.min(axis=0) + 1e-6)).any())
