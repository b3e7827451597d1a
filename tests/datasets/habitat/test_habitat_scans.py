"""Scans of HM3D and Matterport3D: files of the same form, made here from a flat of two rooms, with z up."""

import struct
from pathlib import Path

import numpy as np
import pytest
from gltf_files import BOXES, CUBE, GltfFile
from PIL import Image
from png_files import encoded

from home_mjx.datasets import open_dataset
from home_mjx.errors import DatasetError
from home_mjx.schema.house import House

COLORS = {"wall": (255, 0, 0), "chair": (0, 128, 255), "Dining_Table.001": (1, 2, 3)}
CORNERS = {
    name: (np.array(low) + CUBE * (np.array(high) - low)) @ [[1, 0, 0], [0, 0, 1], [0, -1, 0]]
    for name, (low, high) in BOXES.items()
}  # z up


@pytest.fixture(autouse=True)
def cache(tmp_path, monkeypatch):
    monkeypatch.setenv("HOME_MJX_CACHE", str(tmp_path / "cache"))


def scan(path: Path, texture: bool = False) -> Path:
    """Write all boxes as one mesh; with a texture of one texel for each of `COLORS`."""
    file, corners = GltfFile(), np.concatenate(list(CORNERS.values()))
    primitive = {}
    if texture:
        pixels = np.array([list(COLORS.values())], np.uint8)
        file.add("images", bufferView=file.view(encoded(Image.fromarray(pixels))), mimeType="image/png")
        file.add("textures", source=0)
        file.add("materials", pbrMetallicRoughness={"baseColorTexture": {"index": 0}})
        column = [list(COLORS).index(name) if name in COLORS else 0 for name in CORNERS]
        uv = np.repeat((np.array(column) + 0.5) / len(COLORS), 36)
        primitive = {"attributes": {"TEXCOORD_0": file.accessor(np.stack([uv, uv * 0 + 0.5], axis=1))}, "material": 0}
    file.node(mesh=file.mesh(corners, **primitive))
    return file.write(path)


def read(path: Path) -> House:
    dataset = open_dataset(f"habitat:{path}")
    return dataset.load_house(dataset.house_ids[0])


def furniture(house: House) -> list[tuple[str, str, int]]:
    nodes = [o for level in house.levels for o in level.objects if o.model_id != "structure"]
    return sorted((o.model_id, o.extra["category"], len(house.models[o.model_key].faces)) for o in nodes)


def test_instances_of_hm3d_are_told_by_the_colours_of_a_second_mesh(tmp_path):
    path = scan(tmp_path / "flat.basis.glb")
    scan(tmp_path / "flat.semantic.glb", texture=True)
    rows = ["HM3D Semantic Annotations", '1,FF0000,"wall",0', '2,0080FF,"armchair",0', '3,010203,"dinner, table",1']
    (tmp_path / "flat.semantic.txt").write_text("\n".join(rows))
    house = read(path)
    assert len(house.levels[0].rooms) == 2
    assert furniture(house) == [("armchair", "armchair", 12), ("table", "dinner, table", 12)]
    (tmp_path / "flat.semantic.txt").write_text("\n".join([*rows, "4;red"]))
    with pytest.raises(DatasetError, match=r"expected `id,RRGGBB.*line 5"):
        read(path)


def write_ply(path: Path) -> None:
    """Write the boxes with the object of each face, as Habitat's files of Matterport3D have it."""
    objects = {"chair": 4, "Dining_Table.001": 5}
    points = np.concatenate(list(CORNERS.values())).reshape(-1, 3)
    label = np.repeat([objects.get(name, 0) for name in CORNERS], 12)
    head = f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\n"
    head += "property float x\nproperty float y\nproperty float z\n"
    head += f"element face {len(label)}\nproperty list uchar int vertex_indices\nproperty int object_id\nend_header\n"
    faces = b"".join(struct.pack("<B4i", 3, 3 * i, 3 * i + 1, 3 * i + 2, n) for i, n in enumerate(label.tolist()))
    path.write_bytes(head.encode() + points.astype("<f4").tobytes() + faces)


def test_regions_and_objects_of_matterport_are_those_of_its_house_file(tmp_path):
    """Fewer lines follow than the header counts; both kinds of `P` are skipped."""
    path = scan(tmp_path / "flat.glb")
    write_ply(tmp_path / "flat_semantic.ply")
    box = "0 0 0 8 -4 2.6"
    lines = [
        "ASCII 1.1", f"H flat flat 9 9 9 9 9 9 9 9 9 9 9 {box} 0 0 0 0 0", f"L 0 2 a 0 0 0 {box} 0 0 0 0 0",
        f"R 0 0 0 0 k 2 -2 0 {box} 2.5 0 0 0 0", f"R 1 0 0 0 b 6 -2 0 {box} 2.5 0 0 0 0",
        f"P 0 0 1 d {box} 0 0 0 0", f"P a 0 0 1 {box} 0", f"S 0 0 0 f 2 -2 0 0 0 1 {box}",
        f"S 1 1 0 f 6 -2 0 0 0 1 {box}",
    ]  # fmt: skip
    corners = [(surface, 4 * surface + x, y) for surface in (0, 1) for x, y in ((0, 0), (4, 0), (4, -4), (0, -4))]
    lines += [f"V {number} {surface} f {x} {y} 0 0 0 1" for number, (surface, x, y) in enumerate(corners)]
    lines += ["C 0 1 wall 1 wall", "C 1 7 dining#chair 3 chair", "C 2 9 dining#table 5 table"]
    lines += [f"O {i} 0 {c} 1 -1 0 1 0 0 0 1 0 1 1 1 0" for i, c in ((0, 0), (4, 1), (5, 2))]
    (tmp_path / "flat.house").write_text("\n".join(lines))
    house = read(path)
    assert [room.types for room in house.levels[0].rooms] == [("Kitchen",), ("Bedroom",)]
    assert [room.shape.ceiling for room in house.levels[0].rooms] == pytest.approx([2.5, 2.5])
    assert furniture(house) == [("chair", "dining chair", 12), ("dining_table", "dining table", 12)]
    (tmp_path / "flat.house").write_text("\n".join([*lines, "R 2 0"]))
    with pytest.raises(DatasetError, match=f"at least 6 fields.*line {len(lines) + 1}"):
        read(path)
