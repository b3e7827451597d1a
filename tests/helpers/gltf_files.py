"""Small glTF files, written by hand with `struct` and `json`, and their content as this package reads it."""

import json
import struct
from pathlib import Path
from typing import Any

import numpy as np

from home_mjx.datasets.gltf.decode.container import read_document
from home_mjx.datasets.gltf.decode.images import ImageStore
from home_mjx.datasets.gltf.decode.materials import MaterialReader
from home_mjx.datasets.gltf.decode.primitives import MeshReader
from home_mjx.datasets.gltf.decode.scene import PlacedMesh, place_meshes

COMPONENT = {"int8": 5120, "uint8": 5121, "int16": 5122, "uint16": 5123, "uint32": 5125, "float32": 5126}
TYPE = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4", 16: "MAT4"}
CUBE = np.array(  # unit cube around the origin, outwards
    [
        [[0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]],
        [[1, 0, 0], [0, 0, 0], [0, 1, 0], [1, 1, 0]],
        [[0, 0, 0], [0, 0, 1], [0, 1, 1], [0, 1, 0]],
        [[1, 0, 1], [1, 0, 0], [1, 1, 0], [1, 1, 1]],
        [[0, 1, 1], [1, 1, 1], [1, 1, 0], [0, 1, 0]],
        [[0, 0, 0], [1, 0, 0], [1, 0, 1], [0, 0, 1]],
    ],
    float,
)[:, [0, 1, 2, 0, 2, 3]].reshape(12, 3, 3)


class GltfFile:
    """A glTF document under construction; `json` is the document, to be changed at will."""

    def __init__(self) -> None:
        self.data = bytearray()
        self.json: dict[str, Any] = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": []}]}

    def add(self, key: str, **value: Any) -> int:
        """Append an entry to a top-level list, and return its index."""
        self.json.setdefault(key, []).append(value)
        return len(self.json[key]) - 1

    def view(self, data: bytes, **extra: Any) -> int:
        self.data += bytes(-len(self.data) % 4)
        start = len(self.data)
        self.data += data
        return self.add("bufferViews", buffer=0, byteOffset=start, byteLength=len(data), **extra)

    def accessor(self, values: Any, dtype: str = "float32", **extra: Any) -> int:
        rows = np.asarray(values, dtype)
        width = rows.shape[1] if rows.ndim == 2 else 1
        view = self.view(rows.tobytes())
        return self.add(
            "accessors", bufferView=view, componentType=COMPONENT[dtype], count=len(rows), type=TYPE[width], **extra
        )

    def mesh(self, corners: Any, name: str = "", **primitive: Any) -> int:
        """Append a mesh of one primitive with these vertices; further attributes in `attributes`."""
        named = {"POSITION": self.accessor(np.reshape(corners, (-1, 3))), **primitive.pop("attributes", {})}
        return self.add("meshes", name=name, primitives=[{"attributes": named, **primitive}])

    def node(self, root: bool = True, **value: Any) -> int:
        """Append a node; to the scene as well if it is a root."""
        index = self.add("nodes", **value)
        if root:
            self.json["scenes"][0]["nodes"].append(index)
        return index

    def box(self, name: str, low: Any, high: Any, **primitive: Any) -> int:
        """Append a node with a box between two corners [m]."""
        low, high = np.array(low, float), np.array(high, float)
        return self.node(name=name, mesh=self.mesh(low + CUBE * (high - low), **primitive))

    def glb(self) -> bytes:
        document = {**self.json}
        if self.data:
            document.setdefault("buffers", [{"byteLength": len(self.data)}])
        text = json.dumps(document).encode()
        text += b" " * (-len(text) % 4)
        data = bytes(self.data) + bytes(-len(self.data) % 4)
        chunks = struct.pack("<II", len(text), 0x4E4F534A) + text
        if data:
            chunks += struct.pack("<II", len(data), 0x004E4942) + data
        return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks

    def write(self, path: Path) -> Path:
        path.write_bytes(self.glb())
        return path


BOXES = {
    "slab": ((-0.1, -0.1, -0.1), (8.1, 0, 4.1)),
    "north": ((-0.1, 0, -0.1), (8.1, 2.6, 0)),
    "south": ((-0.1, 0, 4), (8.1, 2.6, 4.1)),
    "west": ((-0.1, 0, 0), (0, 2.6, 4)),
    "east": ((8, 0, 0), (8.1, 2.6, 4)),
    "left": ((3.95, 0, 0), (4.05, 2.6, 1.5)),
    "right": ((3.95, 0, 2.4), (4.05, 2.6, 4)),
    "above": ((3.95, 2.1, 1.5), (4.05, 2.6, 2.4)),
    "top": ((-0.1, 2.6, -0.1), (8.1, 2.7, 4.1)),
    "Dining_Table.001": ((5, 0.02, 1), (6.5, 0.75, 2)),
    "chair": ((1, 0.02, 1), (1.5, 0.9, 1.5)),
}


def two_rooms() -> GltfFile:
    """A flat of 8 x 4 m in two rooms, joined by a doorway of 0.9 m, with a table and a chair."""
    file = GltfFile()
    for name, (low, high) in BOXES.items():
        file.box(name, low, high)
    return file


def scan_of_two_rooms(edge: float, noise: float) -> GltfFile:
    """The same flat as one mesh of small triangles, whose vertices are moved by normal noise [m]."""
    sheets = []
    for low, high in BOXES.values():
        for a, b, _, _, _, c in CUBE.reshape(6, 6, 3):
            first, right, up = (np.array(low) + p * (np.array(high) - low) for p in (a, b, c))
            n, m = (max(1, round(np.linalg.norm(p - first) / edge)) for p in (right, up))
            x, y = np.meshgrid(np.arange(n + 1) / n, np.arange(m + 1) / m)
            grid = first + x[..., None] * (right - first) + y[..., None] * (up - first)
            p, q, r, s = grid[:-1, :-1], grid[:-1, 1:], grid[1:, 1:], grid[1:, :-1]
            sheets += [np.stack(t, axis=2).reshape(-1, 3, 3) for t in ((p, q, r), (p, r, s))]
    corners = np.concatenate(sheets).reshape(-1, 3)
    places, index = np.unique(np.round(corners, 5), axis=0, return_inverse=True)
    places += np.random.default_rng(0).normal(scale=noise, size=places.shape)
    file = GltfFile()
    file.node(mesh=file.mesh(places, indices=file.accessor(index.reshape(-1), "uint32")))
    return file


def read_scene(path: Path, folder: Path, strict: bool = True) -> tuple[list[PlacedMesh], MeshReader]:
    """Return the placed meshes of a scene in its own frame, and the reader with its notes; images go to `folder`."""
    document = read_document(path)
    meshes = MeshReader(document, MaterialReader(document, ImageStore(document, folder, strict)))
    return list(place_meshes(document, meshes, np.eye(4))), meshes


def triangles_of(placed: list[PlacedMesh]) -> np.ndarray:
    """Return the triangles (t, 3, 3) of placed meshes, wound as their transforms leave them."""
    found = [(m.mesh.vertices @ m.matrix[:3, :3].T + m.matrix[:3, 3])[m.mesh.faces] for m in placed]
    return np.concatenate(found) if found else np.zeros((0, 3, 3))
