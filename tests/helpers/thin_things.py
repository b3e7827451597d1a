"""A room with one thing of any shape, among them things without thickness."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from home_mjx.datasets import RoomOutline, outline_house, write_house, write_library
from home_mjx.datasets.suncg.write.metadata import LibraryModel
from home_mjx.schema.house import House, Material, Mesh, Metadata, ModelInfo, ObjectNode

QUAD = [[0, 1, 2], [0, 2, 3]]
THIN = {
    "sheet": ([[-0.3, 0, 0], [0.3, 0, 0], [0.3, 0.6, 0], [-0.3, 0.6, 0]], QUAD),
    "plate": ([[-0.3, 0, -0.3], [0.3, 0, -0.3], [0.3, 0, 0.3], [-0.3, 0, 0.3]], QUAD),
    "sheet across": ([[0, 0, 0], [0.3, 0, 0.3], [0.3, 0.6, 0.3], [0, 0.6, 0]], QUAD),
    "line": ([[0, 0, 0], [0.3, 0, 0], [0.15, 0, 0]], [[0, 1, 2]]),
    "upright line": ([[0, 0, 0], [0, 0.3, 0], [0, 0.15, 0]], [[0, 1, 2]]),
    "slanted line": ([[0, 0, 0], [0.3, 0.3, 0.3], [0.15, 0.15, 0.15]], [[0, 1, 2]]),
    "point": ([[0, 0, 0]] * 3, [[0, 1, 2]]),
    "card": (
        [[x, y, z] for x in (-0.3, 0.3) for y in (0, 0.6) for z in (-5e-4, 5e-4)],
        [[0, 1, 2], [1, 3, 2], [4, 5, 6], [5, 7, 6], [0, 4, 1], [2, 6, 3]],
    ),
}


def mesh_of(vertices, faces) -> Mesh:
    faces = np.asarray(faces, np.int32)
    none = np.zeros(len(faces), np.int32)
    uv, material = np.zeros((len(faces), 3, 2), np.float32), Material("m", (1.0, 1.0, 1.0), None, 1.0)
    return Mesh(Path("object/x/x.obj"), np.asarray(vertices, float), faces, uv, none, none - 1, (material,))


def room_with(shape: Mesh, category="trash_can", coarse=None, yaw=0.0, height=0.05) -> tuple[House, Metadata]:
    """A room of 4 x 5 m with one thing, and the categories."""
    place = np.eye(4)
    place[:3, 3] = 2, height, 2
    place[0, 0] = place[2, 2] = np.cos(yaw)
    place[0, 2], place[2, 0] = np.sin(yaw), -np.sin(yaw)
    thing = ObjectNode("0_1", 1, "levels[0].nodes[1]", None, model_id="x", model_key="x", transform=place)
    house = outline_house("h", [RoomOutline("Living_Room", [(0, 0), (4, 0), (4, 5), (0, 5)])])
    level = house.levels[0]
    level = replace(level, objects=(thing,), rooms=(replace(level.rooms[0], members=(1,)),))
    info = ModelInfo("x", category, coarse or category, "prop")
    return replace(house, levels=(level,), models={"x": shape}), Metadata({"x": info})


def write_room(root: Path, house: House, metadata: Metadata) -> Path:
    """Writes the room as a dataset."""
    models = [LibraryModel(metadata.info("x"), house.models["x"], ("n0", "x.n.01"))]
    write_library(root, models, {})
    write_house(root, house)
    return root
