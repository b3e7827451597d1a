"""Meshes, materials and images of a compiled house in a glTF document; each is stored once."""

from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from home_mjx.core.color import decode_srgb
from home_mjx.core.files import read_bytes
from home_mjx.core.images import has_cut_outs
from home_mjx.geometry.meshes import Z_UP
from home_mjx.scene_compile.gltf.document import DocumentWriter
from home_mjx.scene_compile.mjcf.assets import png_bytes
from home_mjx.schema.compiled import CompiledHouse, Model
from home_mjx.schema.lighting import MAP_NAMES

MIME_TYPES = {b"\x89PNG": "image/png", b"\xff\xd8\xff": "image/jpeg"}
PREFIXES = {"emission": "emissive", "occlusion": "occlusion"}  # of the names of textures of glTF
STRENGTH = "KHR_materials_emissive_strength"
MIN_NORMAL = 1e-3  # minimum length of a normal that has a direction
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
        self._attributes: dict[tuple[str, int, bool], dict[str, Any]] = {}

    def mesh(self, model: Model, first: int) -> int:
        """Return the mesh of a model whose slot 0 has row `first` of the materials; slots are primitives."""
        key = model.key, first
        if key not in self._meshes:
            slots = np.unique(model.slot).tolist()
            parts = [self._primitive(model, slot, first + slot) for slot in slots]
            self._meshes[key] = self._document.add("meshes", {"name": model.key.split(":")[0], "primitives": parts})
        return self._meshes[key]

    def _primitive(self, model: Model, slot: int, row: int) -> dict[str, Any]:
        """Return the triangles of a slot with the material of a row."""
        is_textured = bool(self._house.materials.texture[row]) or any(self._images(row).values())
        key = model.key, slot, is_textured
        if key not in self._attributes:
            self._attributes[key] = self._triangles(model, slot, is_textured)
        return self._attributes[key] | {"material": self.material(row)}

    def _triangles(self, model: Model, slot: int, is_textured: bool) -> dict[str, Any]:
        """Return the accessors of the triangles of a slot, with equal corners merged.

        Triangles with two equal corners are left out, but for one if there are no others.
        """
        mine = model.slot == slot
        points = (model.triangle[mine].astype(float) @ FROM_Z_UP.T).astype(np.float32)
        normals = _unit_normals(points, model.normal[mine] @ FROM_Z_UP.T)
        rows = [points.reshape(-1, 3), normals.reshape(-1, 3)]
        rows += [model.uv[mine].reshape(-1, 2) * [1, -1] + [0, 1]] if is_textured else []
        corners, index = np.unique(np.hstack(rows).astype(np.float32), axis=0, return_inverse=True)
        index = index.reshape(-1, 3)
        a, b, c = corners[index, :3].transpose(1, 0, 2)
        has_sides = (a != b).any(axis=1) & (b != c).any(axis=1) & (c != a).any(axis=1)
        index = index[has_sides] if has_sides.any() else index[:1]
        used, index = np.unique(index, return_inverse=True)
        corners = corners[used]
        names = {"POSITION": corners[:, :3], "NORMAL": corners[:, 3:6], "TEXCOORD_0": corners[:, 6:]}
        return {
            "attributes": {
                name: self._document.add_accessor(a, name == "POSITION") for name, a in names.items() if a.size
            },
            "indices": self._document.add_accessor(index.reshape(-1).astype(np.uint32)),
        }

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
        self._add_maps(row, found)
        return found

    def _images(self, row: int) -> dict[str, str]:
        """Return the images of a material besides that of its colour, by name; empty without `SurfaceMaps`."""
        maps = self._house.materials.maps
        found = np.flatnonzero(maps.row == row)
        first = len(MAP_NAMES) * int(found[0]) if len(found) else 0
        return dict(zip(MAP_NAMES, maps.images[first : first + len(MAP_NAMES)], strict=True)) if len(found) else {}

    def _add_maps(self, row: int, found: dict[str, Any]) -> None:
        """Add the `SurfaceMaps` of a row to a material, if it has any."""
        images, maps = self._images(row), self._house.materials.maps
        if not images:
            return
        number = int(np.flatnonzero(maps.row == row)[0])
        metallic, roughness, scale, cutoff = maps.factors[number].tolist()
        shade = found["pbrMetallicRoughness"]
        shade |= {"metallicFactor": metallic, "roughnessFactor": roughness}
        textures = {name: {"index": self._texture(path)} for name, path in images.items() if path}
        if "roughness" in textures:
            shade["metallicRoughnessTexture"] = textures["roughness"]
        if "normal" in textures:
            found["normalTexture"] = textures["normal"] | {"scale": scale}
        found |= {f"{prefix}Texture": textures[name] for name, prefix in PREFIXES.items() if name in textures}
        if found.get("alphaMode") == "MASK" and cutoff >= 0:
            found["alphaCutoff"] = cutoff
        self._add_emission(maps.emission[number], found)

    def _add_emission(self, emission: Float[np.ndarray, "3"], found: dict[str, Any]) -> None:
        """Add an emission to a material; one above 1 needs `KHR_materials_emissive_strength`."""
        strength = max(float(emission.max()), 1.0)
        if emission.any():
            found["emissiveFactor"] = (emission / strength).tolist()
        if strength > 1:
            found["extensions"] = {STRENGTH: {"emissiveStrength": strength}}
            self._document.use_extension(STRENGTH)

    def _texture(self, path: str) -> int:
        """Return the texture of an image file, whose bytes are unchanged if it is a PNG or JPEG."""
        if path not in self._textures:
            data = read_bytes(Path(path))
            kind = next((kind for start, kind in MIME_TYPES.items() if data.startswith(start)), None)
            image: dict[str, Any] = {"name": Path(path).stem, "mimeType": kind or "image/png"}
            image["bufferView"] = self._document.add_view(data if kind else png_bytes(Path(path)))
            self._textures[path] = self._document.add("textures", {"source": self._document.add("images", image)})
        return self._textures[path]


def _unit_normals(triangles: Float[np.ndarray, "t 3 3"], normal: Float[np.ndarray, "t 3 3"]) -> np.ndarray:
    """Return normals of unit length; those without length become that of their triangle, or +y if it has no area."""
    face = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]).astype(float)
    face = np.where((abs(face).max(axis=1) > 0)[:, None], face, [0.0, 1.0, 0.0])
    lacks = np.linalg.norm(normal, axis=-1, keepdims=True) < MIN_NORMAL
    found = np.where(lacks, face[:, None], normal)
    return found / np.linalg.norm(found, axis=-1, keepdims=True)
