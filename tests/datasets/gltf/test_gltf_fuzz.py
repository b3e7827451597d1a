"""Damaged scenes: each is read as a house or refused by a typed error with its file, within seconds."""

import copy
import json
import random
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gltf_files import GltfFile, two_rooms
from test_gltf_decoder import SQUARE, one_pixel

from home_mjx.datasets.gltf.dataset import GltfDataset
from home_mjx.errors import HomeMjxError

COUNT = 90
ODD: tuple[Any, ...] = (
    *(None, True, -1, 0, 1, 2**31, 2**63, 1e308, -0.5, float("nan"), float("inf")),
    *("", "..", "data:,", "\0", [], {}, [[]], {"uri": "x"}, [0] * 17, "a" * 1000, 65535, 5123, 5126),
)


def rich_scene() -> GltfFile:
    """Return two rooms with textures, sparse and quantized accessors, strips, vertex colours and nested nodes."""
    file = two_rooms()
    file.add("images", bufferView=file.view(one_pixel()), mimeType="image/png")
    file.add("textures", source=0)
    moved = {"KHR_texture_transform": {"offset": [0.1, 0], "rotation": 1, "scale": [2, 2], "texCoord": 0}}
    color = {"baseColorTexture": {"index": 0, "extensions": moved}, "baseColorFactor": [1, 0.5, 0, 1]}
    material = file.add("materials", name="oak", pbrMetallicRoughness=color, alphaMode="BLEND")
    attributes = {"COLOR_0": file.accessor([[1, 0, 0, 1]] * 4), "TEXCOORD_0": file.accessor([[0, 0]] * 4)}
    mesh = file.mesh(
        SQUARE, attributes=attributes, material=material, mode=5, indices=file.accessor([0, 1, 2, 3], "uint8")
    )
    rows, values = file.view(np.array([1], "u1").tobytes()), file.view(np.ones(3, "<f4").tobytes())
    file.json["accessors"][file.json["meshes"][mesh]["primitives"][0]["attributes"]["POSITION"]]["sparse"] = {
        "count": 1,
        "indices": {"bufferView": rows, "componentType": 5121},
        "values": {"bufferView": values},
    }
    child = file.node(root=False, name="lamp", mesh=mesh, rotation=[0, 0, 0, 1])
    file.node(name="shelf", children=[child], translation=[2, 1, 2], scale=[0.3, 0.3, 0.3])
    return file


def leaves(value: Any) -> list[tuple[Any, Any]]:
    """Return all (container, key) pairs of a JSON value."""
    keys = value if isinstance(value, dict) else range(len(value)) if isinstance(value, list) else ()
    return [pair for key in keys for pair in ((value, key), *leaves(value[key]))]


def damaged(number: int) -> bytes:
    """Return a scene with one to three faults in its document or its bytes."""
    rng, file = random.Random(number), rich_scene()
    file.json = copy.deepcopy(file.json)
    if rng.random() < 0.7:
        for _ in range(rng.randint(1, 3)):
            container, key = rng.choice(leaves(file.json))
            if rng.random() < 0.2:
                del container[key]
            elif rng.random() < 0.3:
                other, place = rng.choice(leaves(file.json))
                container[key] = copy.deepcopy(other[place])
            else:
                container[key] = copy.deepcopy(rng.choice(ODD))  # a shared list could contain itself
        return whole(file)
    data = bytearray(whole(file))
    for _ in range(rng.choice((1, 4, 40))):
        data[rng.randrange(len(data))] = rng.randrange(256)
    return bytes(data[: rng.randrange(len(data))] if rng.random() < 0.3 else data)


def whole(file: GltfFile) -> bytes:
    """Return the GLB of a document that may no longer be an object."""
    return file.glb() if isinstance(file.json, dict) else json.dumps(file.json).encode()


def outcome(path: Path) -> str:
    """Return how a scene is read: as a house, or by which error; `no file` if the error names none."""
    try:
        house = GltfDataset(str(path)).load_house(path.stem)
    except HomeMjxError as error:
        return type(error).__name__ if error.file else "no file"
    return type(house).__name__


@pytest.mark.parametrize("part", range(3))
def test_damaged_scenes_are_read_or_refused_by_typed_errors(tmp_path, monkeypatch, part):
    monkeypatch.setenv("HOME_MJX_CACHE", str(tmp_path / "cache"))
    found = set()
    for number in range(part * COUNT // 3, (part + 1) * COUNT // 3):
        path = tmp_path / "scene.glb"
        path.write_bytes(damaged(number))
        found.add(outcome(path))
    assert {"House", "DatasetError"} <= found <= {"House", "DatasetError", "MissingFileError"}
