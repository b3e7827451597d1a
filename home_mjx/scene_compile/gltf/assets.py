"""Meshes, materials and images of a compiled house in a glTF document; each is stored once."""

from pathlib import Path
from typing import Any

import numpy as np

from home_mjx.core.color import decode_srgb
from home_mjx.core.files import read_bytes
from home_mjx.core.images import has_cut_outs
from home_mjx.geometry.meshes import Z_UP
from home_mjx.scene_compile.gltf.document import DocumentWriter
from home_mjx.scene_compile.mjcf.assets import png_bytes
from home_mjx.schema.compiled import CompiledHouse, Model

MIME_TYPES = {b"\x89PNG": "image/png", b"\xff\xd8\xff": "image/jpeg"}
FROM_Z_UP = Z_UP.T  # glTF has y up


class GltfAssets:
    """Collector of the meshes, materials and images of a house.

    Args:
        house: The house.
        document: Receives them.
    """

    def __init__(self, house: CompiledHouse, document: DocumentWriter) -> None:
        self._house, self._document = house, document
        self._meshes: dict[tuple[str, int], int] = {}
        self._materials: dict[int, int] = {}
        self._textures: dict[str, int] = {}
        self._attributes: dict[tuple[str, int], dict[str, Any]] = {}

    def mesh(self, model: Model, first: int) -> int:
        """Return the mesh of a model whose slot 0 has row `first` of the materials; slots are primitives."""
        key = model.key, first
        if key not in self._meshes:
            slots = np.unique(model.slot).tolist()
            parts = [self._primitive(model, slot) | {"material": self.material(first + slot)} for slot in slots]
            self._meshes[key] = self._document.add("meshes", {"name": model.key.split(":")[0], "primitives": parts})
        return self._meshes[key]

    def _primitive(self, model: Model, slot: int) -> dict[str, Any]:
        """Return the triangles of a slot, with equal corners merged; materials do not matter."""
        key = model.key, slot
        if key not in self._attributes:
            mine = model.slot == slot
            point, normal = (a[mine].reshape(-1, 3) @ FROM_Z_UP.T for a in (model.triangle, model.normal))
            uv = model.uv[mine].reshape(-1, 2) * [1, -1] + [0, 1]
            corners, index = np.unique(np.hstack([point, normal, uv]).astype(np.float32), axis=0, return_inverse=True)
            names = {"POSITION": corners[:, :3], "NORMAL": corners[:, 3:6], "TEXCOORD_0": corners[:, 6:]}
            self._attributes[key] = {
                "attributes": {name: self._document.add_accessor(a, name == "POSITION") for name, a in names.items()},
                "indices": self._document.add_accessor(index.reshape(-1).astype(np.uint32)),
            }
        return dict(self._attributes[key])

    def material(self, row: int) -> int:
        """Return the material of a row of the house's table.

        Raises:
            DatasetError: Its texture cannot be read.
        """
        if row not in self._materials:
            self._materials[row] = self._document.add("materials", self._material(row))
        return self._materials[row]

    def _material(self, row: int) -> dict[str, Any]:
        """Return a material: colours in linear light, both sides visible, roughness from the Blinn-Phong exponent."""
        table, gloss = self._house.materials, self._house.gloss
        shininess = float(gloss.shininess[row]) if row < len(gloss.shininess) else 1.0
        color = [*decode_srgb(table.albedo[row, :3]).tolist(), float(table.albedo[row, 3])]
        shade: dict[str, Any] = {"baseColorFactor": color, "metallicFactor": 0.0}
        shade["roughnessFactor"] = float(np.clip((2 / (shininess + 2)) ** 0.25, 0, 1))
        found = {"name": table.kind[row] or f"material{row}", "pbrMetallicRoughness": shade, "doubleSided": True}
        path = table.texture[row]
        if path:
            shade["baseColorTexture"] = {"index": self._texture(path)}
        if color[3] < 1:
            found["alphaMode"] = "BLEND"
        elif path and has_cut_outs(Path(path)):
            found["alphaMode"] = "MASK"
        return found

    def _texture(self, path: str) -> int:
        """Return the texture of an image file, whose bytes are unchanged if it is a PNG or JPEG."""
        if path not in self._textures:
            data = read_bytes(Path(path))
            kind = next((kind for start, kind in MIME_TYPES.items() if data.startswith(start)), None)
            image: dict[str, Any] = {"name": Path(path).stem, "mimeType": kind or "image/png"}
            image["bufferView"] = self._document.add_view(data if kind else png_bytes(Path(path)))
            self._textures[path] = self._document.add("textures", {"source": self._document.add("images", image)})
        return self._textures[path]
