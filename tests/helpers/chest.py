"""A room with chests of drawers and a cup, for tests of drawers and of what is in them."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from home_mjx.datasets.outlines import RoomOutline, outline_house
from home_mjx.geometry.meshes import box_triangles
from home_mjx.scene_compile.objects.leaves import CLEARANCE
from home_mjx.schema.house import Joint, Material, Mesh, Metadata, ModelInfo, ObjectNode

WIDTH, HEIGHT, DEPTH, TRAVEL = 0.8, 0.8, 0.45, 0.36  # [m], of the chest; of its drawers
SHORT_TRAVEL = 0.1  # [m], of the drawer before which a pillar stands
YAW = np.deg2rad(90.0)
CHEST, CUP = np.array([2.5, 0.0, 2.0]), 0.06  # [m], middle of its back on the floor, Y up; edge of the cup
PLACES = 1.5, 0.5  # [m], across the room: of the chest, and of another one with a pillar before it


def mesh(name, boxes):
    """Boxes, minimum and maximum each, as one mesh."""
    triangles = np.concatenate([box_triangles((a + b) / 2, (b - a) / 2) for a, b in np.array(boxes, float)])
    faces = np.arange(3 * len(triangles)).reshape(-1, 3)
    flat = np.zeros(len(faces), int)
    return Mesh(
        Path(name), triangles.reshape(-1, 3), faces, np.zeros((len(faces), 3, 2)), flat, flat - 1, (Material("m"),)
    )


def chest():
    """A closed body, front towards +z, with three drawers; behind the lowest, which is too low, nothing fits."""
    w = WIDTH / 2
    fronts = [
        [(-w + 0.01, low, DEPTH), (w - 0.01, high, DEPTH + 0.02)]
        for low, high in ((0.43, 0.79), (0.11, 0.42), (0.02, 0.1))
    ]
    boxes = [[(-w, 0, 0), (w, HEIGHT, DEPTH)], *fronts]
    joints = tuple(
        Joint("chest", f"drawer_{i}", "slide", (0.0, 0.0, 1.0), (0.0, 0.0, 0.0), 0.0, TRAVEL, ((12 * i, 12 * i + 11),))
        for i in (1, 2, 3)
    )
    return mesh("chest", boxes), joints


def node(index, model, joints=(), at=(0.0, 0.0, 0.0), yaw=0.0):
    pose = np.eye(4)
    pose[:3, :3] = [[np.cos(yaw), 0, np.sin(yaw)], [0, 1, 0], [-np.sin(yaw), 0, np.cos(yaw)]]
    pose[:3, 3] = at
    return ObjectNode(f"0_{index}", index, f"levels[0].nodes[{index}]", None, model, model, pose, joints=joints)


def home(blocked=True, cups=1):
    """A room with the chest against a wall and cups on it; with `blocked`, the same chest with a pillar before it."""
    plain = outline_house("drawers", (RoomOutline("Bedroom", [(0, 0), (5, 0), (5, 4), (0, 4)]),))
    body, joints = chest()
    models = {
        "chest": body,
        "cup": mesh("cup", [[(-CUP / 2, 0, -CUP / 2), (CUP / 2, CUP, CUP / 2)]]),
        "column": mesh("column", [[(-0.1, 0, -0.1), (0.1, 2, 0.1)]]),
    }
    first = len(plain.levels[0].rooms)
    away = DEPTH + 0.02 + 0.1 + CLEARANCE + SHORT_TRAVEL + 0.005
    objects = (
        node(first, "chest", joints, (0.15, 0.0, 2.8), YAW),
        *(node(first + 4 + i, "cup", (), (0.4, HEIGHT, 2.8 + 0.15 * i)) for i in range(cups)),
        node(first + 2, "chest", joints, (0.15, 0.0, 1.0), YAW),
        node(first + 3, "column", (), (0.15 + away, 0.0, 1.0)),
    )
    (level,) = plain.levels
    objects = objects if blocked else objects[: 1 + cups]
    infos = [
        ModelInfo("chest", "dresser", "dresser"),
        ModelInfo("cup", "cup", "kitchenware"),
        ModelInfo("column", "column", "column"),
    ]
    return replace(plain, models=models, levels=(replace(level, objects=objects),)), Metadata(
        {i.model_id: i for i in infos}
    )
