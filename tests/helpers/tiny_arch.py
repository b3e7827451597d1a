"""Writes the SUNCG v2 twin of the tiny dataset by hand: an architecture file instead of meshes of rooms."""

import json
import shutil
from collections.abc import Callable
from pathlib import Path

from tiny_dataset import (
    DEPTH,
    HEIGHT,
    HOUSE_ID,
    WIDTH,
    edit_house,
    union,
    write_json,
    write_tiny_dataset,
)

DOOR_HOLE = {"id": "0_3", "modelId": "9002", "type": "Door", "box": {"min": [0.62, 0.04], "max": [1.38, 2.1]}}
OUTER = 0.1 / 19  # [m], by which the outer half of a wall overlaps the inner one
CORNERS = ((0.0, 0.0), (WIDTH, 0.0), (WIDTH, DEPTH), (0.0, DEPTH))  # (x, z), interior to the right of the way


def write_tiny_v2(root: Path, house_id: str = HOUSE_ID) -> Path:
    """Writes the dataset below `root` and returns `root`."""
    write_tiny_dataset(root, house_id)
    shutil.rmtree(root / "room")
    edit_house(root, _to_v2, house_id)
    write_json(arch_path(root, house_id), arch_document(house_id))
    return root


def _to_v2(document: dict) -> None:
    """The version, and boxes of the meshes that SUNCG builds: walls to both sides of their line, wider floors."""
    document["version"] = "suncg@1.0.2"
    level = document["levels"][0]
    out = OUTER - 0.1 / 2
    level["nodes"][0]["bbox"] = {"min": [out, 0, out], "max": [WIDTH - out, 2.74, DEPTH - out]}
    level["nodes"][1]["bbox"] = {"min": [-2.02, -0.04, -2.02], "max": [6.02, 0.04, -0.48]}
    document["bbox"] = level["bbox"] = union(level["nodes"])


def arch_path(root: Path, house_id: str = HOUSE_ID) -> Path:
    return root / "wall" / house_id / f"{house_id}.arch.json"


def edit_arch(root: Path, change: Callable[[dict], object]) -> Path:
    """Applies `change` to the parsed architecture file and writes it back; returns its path."""
    document = json.loads(arch_path(root).read_text())
    change(document)
    return write_json(arch_path(root), document)


def arch_document(house_id: str = HOUSE_ID) -> dict:
    polygon = [[x, 0, z] for x, z in CORNERS]
    paper, brick = {"name": "inside", "texture": "wallp_0", "diffuse": "#ff0000"}, {"name": "outside"}
    walls = [
        {
            "id": f"0_0_{k}",
            "type": "Wall",
            "roomId": "0_0",
            "height": HEIGHT,
            "points": [[*start[:1], 0, start[1]], [*end[:1], 0, end[1]]],
            "holes": [DOOR_HOLE] if k == 2 else [],
            "materials": [paper, brick],
        }
        for k, (start, end) in enumerate(zip(CORNERS, CORNERS[1:] + CORNERS[:1], strict=True))
    ]
    surface = [{"name": "surface", "texture": "wood_1", "diffuse": "#ffffff"}]
    floor = {"id": "0_0f", "type": "Floor", "roomId": "0_0", "offset": [0, 0.05, 0]}
    ceiling = {"id": "0_0c", "type": "Ceiling", "roomId": "0_0", "offset": [0, 2.74, 0]}
    ground = {"id": "0_1", "type": "Ground", "offset": [-2, 0.04, -2]}
    lawn = [[[0, 0, 0], [8, 0, 0], [8, 0, 1.5], [0, 0, 1.5]]]
    return {
        "version": "suncg-arch@1.0.2",
        "id": house_id,
        "up": [0, 1, 0],
        "front": [0, 0, 1],
        "scaleToMeters": 1,
        "defaults": {
            "Wall": {"depth": 0.1, "extraHeight": 0.035},
            "Ceiling": {"depth": 0.05},
            "Floor": {"depth": 0.05},
            "Ground": {"depth": 0.08},
        },
        "elements": [
            *walls,
            floor | {"points": [polygon], "materials": surface},
            ceiling | {"points": [polygon], "materials": surface},
            ground | {"points": lawn, "materials": surface},
        ],
    }
