"""Writes a tiny, valid SUNCG v1 dataset by hand: one room, a table, a mirrored closed door, a box and a ground.

It shares no code with the package, so that the reader is tested against the format and not against a writer.
"""

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
from PIL import Image

HOUSE_ID = "00000000000000000000000000000001"
TABLE, DOOR = "9001", "9002"
WIDTH, DEPTH, HEIGHT = 4.0, 3.0, 2.7  # [m], of the room between wall centre-lines, from the scene's origin
CUBOID_FACES = ((1, 4, 3, 2), (5, 6, 7, 8), (1, 2, 6, 5), (2, 3, 7, 6), (3, 4, 8, 7), (4, 1, 5, 8))

# (o-line or "", material, low corner, high corner)
Cuboid = tuple[str, str, tuple[float, float, float], tuple[float, float, float]]
TABLE_PARTS: list[Cuboid] = [
    ("", "material_0", (-0.6, 0.7, -0.4), (0.6, 0.75, 0.4)),
    ("", "material_1", (-0.05, 0.0, -0.05), (0.05, 0.7, 0.05)),
]
FRAME: Cuboid = ("", "material_0", (-0.4, 2.0, -0.07), (0.4, 2.1, 0.07))
OPEN_LEAF: Cuboid = ("", "material_1", (-0.37, 0.05, -0.6), (-0.33, 2.0, 0.05))
CLOSED_LEAF: Cuboid = ("", "material_1", (-0.37, 0.05, -0.02), (0.37, 2.0, 0.02))
ROOM_PARTS: dict[str, list[Cuboid]] = {
    "f": [("Floor#0_0", "material_0", (0, 0, 0), (WIDTH, 0.05, DEPTH))],
    "c": [("Ceiling#0_0", "material_0", (0, 2.69, 0), (WIDTH, 2.74, DEPTH))],
    "w": [
        ("WallInside#0_0_0", "material_0", (0, 0, 0), (WIDTH, HEIGHT, 0.05)),
        ("WallInside#0_0_1", "material_0", (WIDTH - 0.05, 0, 0), (WIDTH, HEIGHT, DEPTH)),
        ("WallInside#0_0_2", "material_0", (0, 0, DEPTH - 0.05), (WIDTH, HEIGHT, DEPTH)),
        ("WallInside#0_0_3", "material_0", (0, 0, 0), (0.05, HEIGHT, DEPTH)),
    ],
}
GROUND: list[Cuboid] = [("", "material_0", (-2, -0.04, -2), (6, 0.04, -0.5))]
TABLE_AT = (1.5, 0.05, 1.2)  # turned by 90 degrees about y
DOOR_AT = (3.0, 0.02, 3.0)  # mirrored in x


def write_tiny_dataset(root: Path, house_id: str = HOUSE_ID) -> Path:
    """Writes the dataset below `root` and returns `root`; its mark has it read strictly, as generated ones are."""
    root.mkdir(parents=True, exist_ok=True)
    (root / "generated.json").write_text("{}")
    write_textures(root / "texture")
    wood, metal = "map_Kd ../../texture//wood_1.png", "d 0.5"
    write_mesh(root / "object" / TABLE, TABLE, TABLE_PARTS, [("0.8 0.6 0.4", wood), ("0.2 0.2 0.2", metal)])
    door = [("0.5 0.5 0.5", ""), ("0.3 0.2 0.1", wood)]
    write_mesh(root / "object" / DOOR, DOOR, [FRAME, OPEN_LEAF], door)
    write_mesh(root / "object" / DOOR, f"{DOOR}_0", [FRAME, CLOSED_LEAF], door, mtl=DOOR)
    paper = [("1 0.9 0.8", "map_Kd ../../texture/wallp_0.jpg")]
    for part, cuboids in ROOM_PARTS.items():
        write_mesh(root / "room" / house_id, f"fr_0rm_0{part}", cuboids, paper)
    write_mesh(root / "room" / house_id, "fr_0gd_1f", GROUND, paper)
    write_json(root / "house" / house_id / "house.json", house_document(house_id))
    write_metadata(root / "metadata")
    return root


def edit_house(root: Path, change: Callable[[dict], object], house_id: str = HOUSE_ID) -> Path:
    """Applies `change` to the parsed house.json and writes it back; returns its path."""
    path = root / "house" / house_id / "house.json"
    document = json.loads(path.read_text())
    change(document)
    return write_json(path, document)


def house_document(house_id: str = HOUSE_ID) -> dict:
    turn = np.array([[0, 0, 1], [0, 1, 0], [-1, 0, 0]])
    mirror = np.diag([-1, 1, 1])
    box = np.eye(3)
    nodes = [
        room_node(),
        {"id": "0_1", "type": "Ground", "valid": 1, "modelId": "fr_0gd_1", "bbox": box_of(GROUND)},
        object_node("0_2", TABLE, turn, TABLE_AT, TABLE_PARTS)
        | {"materials": [{"name": "wood", "texture": "123", "diffuse": "#ff8000"}]},
        object_node("0_3", DOOR, mirror, DOOR_AT, [FRAME, OPEN_LEAF])
        | {"state": 1, "isMirrored": 1, "materials": [{"name": "color"}]},
        object_node("0_4", "", box, (3.5, 0.55, 0.5), [("", "", (-0.25, -0.5, -0.25), (0.25, 0.5, 0.25))])
        | {"type": "Box", "dimensions": [0.5, 1.0, 0.5], "materials": [{"name": "a", "diffuse": "#ffffff"}] * 6},
    ]
    nodes[4].pop("modelId")
    return {
        "version": "suncg@1.0.0",
        "id": house_id,
        "up": [0, 1, 0],
        "front": [0, 0, 1],
        "scaleToMeters": 1,
        "levels": [{"id": "0", "bbox": union(nodes), "nodes": nodes}],
        "bbox": union(nodes),
    }


def room_node() -> dict:
    parts = [cuboid for cuboids in ROOM_PARTS.values() for cuboid in cuboids]
    return {
        "id": "0_0",
        "type": "Room",
        "valid": 1,
        "modelId": "fr_0rm_0",
        "nodeIndices": [2, 3, 4],
        "roomTypes": ["Living_Room", "Kitchen"],
        "bbox": box_of(parts),
    }


def object_node(node_id: str, model_id: str, linear: np.ndarray, at: tuple, parts: list[Cuboid]) -> dict:
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = linear, at
    corners = np.concatenate([cuboid_vertices(low, high) for _, _, low, high in parts]) @ linear.T + at
    return {
        "id": node_id,
        "type": "Object",
        "valid": 1,
        "modelId": model_id,
        "transform": matrix.T.reshape(-1).tolist(),  # column-major
        "bbox": {"min": corners.min(0).tolist(), "max": corners.max(0).tolist()},
    }


def box_of(parts: list[Cuboid]) -> dict:
    low, high = np.array([p[2] for p in parts]).min(0), np.array([p[3] for p in parts]).max(0)
    return {"min": low.tolist(), "max": high.tolist()}


def union(nodes: list[dict]) -> dict:
    boxes = [node["bbox"] for node in nodes]
    low, high = np.min([b["min"] for b in boxes], 0), np.max([b["max"] for b in boxes], 0)
    return {"min": low.tolist(), "max": high.tolist()}


def cuboid_vertices(low: tuple, high: tuple) -> np.ndarray:
    (x0, y0, z0), (x1, y1, z1) = low, high
    ring = ((x1, z1), (x1, z0), (x0, z0), (x0, z1))
    return np.array([(x, y, z) for y in (y0, y1) for x, z in ring], float)


def write_mesh(
    folder: Path, stem: str, cuboids: list[Cuboid], materials: list[tuple[str, str]], mtl: str | None = None
) -> None:
    """An OBJ of quads, outward counter-clockwise, and the MTL of its slots."""
    folder.mkdir(parents=True, exist_ok=True)
    lines = [f"mtllib {mtl or stem}.mtl", *(f"vt {u} {v}" for u, v in ((0, 0), (1, 0), (1, 1), (0, 1)))]
    for i, (group, material, low, high) in enumerate(cuboids):
        lines += [f"o {group}"] * bool(group)
        lines += [f"v {x!r} {y!r} {z!r}" for x, y, z in cuboid_vertices(low, high).tolist()]
        lines += [f"usemtl {material}"]
        lines += [f"f  {' '.join(f'{8 * i + v}/{k}' for k, v in enumerate(face, 1))}" for face in CUBOID_FACES]
    (folder / f"{stem}.obj").write_text("\n".join(lines) + "\n")
    if mtl is None:
        text = "".join(f"newmtl material_{i}\nKd {kd}\n{more}\n\n" for i, (kd, more) in enumerate(materials))
        (folder / f"{stem}.mtl").write_text(text)


def write_textures(folder: Path) -> None:
    (folder / "s").mkdir(parents=True)
    for name, color in (("wood_1.png", (160, 110, 60)), ("wallp_0.jpg", (255, 255, 255)), ("s/123.jpg", (20, 90, 200))):
        Image.new("RGB", (2, 2), color).save(folder / name)


def write_json(path: Path, document: object) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(document))
    return path


def write_metadata(folder: Path) -> None:
    folder.mkdir(parents=True)
    (folder / "ModelCategoryMapping.csv").write_text(
        "index,model_id,fine_grained_class,coarse_grained_class,empty_struct_obj,nyuv2_40class,wnsynsetid,wnsynsetkey\n"
        "0,Empty,empty,empty,0,void,n03284308,empty.n.01\n"
        f"5,{TABLE},dining_table,table,2,table,n03201208,dining_table.n.01\n"
        f"6,{DOOR},door,door,2,door,n03221720,door.n.01"
    )
    (folder / "models.csv").write_text(
        "id,front,nmaterials,minPoint,maxPoint,aligned.dims,index,variantIds\n"
        f'{TABLE},"0,0,1",2,"-0.6, 0.0, -0.4","0.6, 0.75, 0.4","120.0, 75.0, 80.0",5,\n'
        f'{DOOR},"0,0,1",2,"-0.4, 0.05, -0.6","0.4, 2.1, 0.07","80.0, 205.0, 67.0",6,"{DOOR},{DOOR}_0"\n'
        f'{DOOR}_0,"0,0,1",2,"-0.4, 0.05, -0.07","0.4, 2.1, 0.07","80.0, 205.0, 14.0",6,"{DOOR},{DOOR}_0"\n'
    )
    light = {"modelId": TABLE, "color": "#ff8000", "attenuation": [0, 0, 1], "position": [0, 1, 0]}
    spot = {"direction": [0, -1, 0], "cutoffAngle": 1.57, "dropoffRate": 2}
    write_json(
        folder / "suncgModelLights.json",
        {
            TABLE: [
                light | {"type": "PointLight", "power": 60},
                light | spot | {"type": "SpotLight", "power": 30},
                light | spot | {"type": "LineLight", "power": 5.5, "position2": [1, 1, 0]},
            ]
        },
    )
