"""Models of a bank as binary glTF at viewing size: triangles, materials, and textures as JPEG (host only)."""

import functools
import io
from typing import Any

import numpy as np
import trimesh
from jaxtyping import Float, Int, UInt8, UInt32
from PIL import Image
from trimesh.visual.material import PBRMaterial
from trimesh.visual.texture import TextureVisuals

from home_mjx.bank.bank import HouseBank
from home_mjx.bank.records.geometry import CUTOUT_SHIFT, LEAF_BITS
from home_mjx.raycast_render.lighting.texture import texture_edge

VIEW_TEXTURE_EDGE = 128  # [px], largest edge of textures that are sent
JPEG_QUALITY = 85
OPAQUE_ALPHA = 0.99  # opacity from which a material counts as opaque
DIGITS = 5  # decimals to which corners are rounded before equal ones are merged


class ModelLibrary:
    """Models of a bank, from its own arrays; every texture is encoded once.

    Args:
        bank: The houses.
        texture_edge: Largest edge of textures [px], a power of two.
    """

    def __init__(self, bank: HouseBank, texture_edge: int = VIEW_TEXTURE_EDGE) -> None:
        geometry, materials, self._bank = bank.geometry, bank.materials, bank
        names = ("triangle", "triangle_uv", "triangle_slot", "triangle_part")
        self._arrays = {name: np.asarray(getattr(geometry, name)) for name in names}
        self._normal = np.asarray(bank.finish.normal)
        self._albedo, self._texture = np.asarray(materials.albedo), np.asarray(materials.texture)
        self._cutout = np.asarray(geometry.material_mask) >> CUTOUT_SHIFT > 0
        looks = np.column_stack([self._albedo, self._texture, self._cutout])
        _, first, alike = np.unique(looks, axis=0, return_index=True, return_inverse=True)
        self._looks = first[alike]  # first row of the bank's materials that looks the same
        self._textures, self._edge = np.asarray(materials.textures), texture_edge
        self._image = functools.cache(self._encode_texture)
        self.triangles = functools.cache(self._find_triangles)

    def part(self, triangle: Int[np.ndarray, " t"]) -> Int[np.ndarray, " t"]:
        """Return the semantic part of triangles."""
        return self._arrays["triangle_part"][triangle]

    def corners(self, triangle: Int[np.ndarray, " t"]) -> Float[np.ndarray, "t 3 3"]:
        """Return the corners of triangles in the model's frame [m]."""
        return self._arrays["triangle"][triangle]

    def split_by_look(self, triangle: Int[np.ndarray, " t"], material: int) -> list[tuple[int, Int[np.ndarray, " n"]]]:
        """Return the triangles of each look, with the first row of the bank's materials that has this look.

        Args:
            triangle: Triangles of one model.
            material: Row in the bank's materials of the model's slot 0.
        """
        row = self._looks[material + self._arrays["triangle_slot"][triangle]]
        return [(int(number), triangle[row == number]) for number in np.unique(row)]

    def to_glb(
        self, triangle: Int[np.ndarray, " t"], material: int, stretch: Float[np.ndarray, "3 3"] | None = None
    ) -> bytes:
        """Return triangles as binary glTF in the model's own axes, one mesh per look.

        Args:
            triangle: Triangles of one model.
            material: Row in the bank's materials of the model's slot 0.
            stretch: Linear map of corners and normals in the model's frame; a mirrored one turns triangles over. None:
                none.
        """
        scene = trimesh.Scene()
        for row, part in self.split_by_look(triangle, material):
            scene.add_geometry(self._mesh(part, row, stretch), geom_name=f"material{row}")
        data = scene.export(file_type="glb", include_normals=True)
        assert isinstance(data, bytes)
        return data

    def _find_triangles(self, model: int) -> Int[np.ndarray, " t"]:
        """Return the bank's triangles of a library model, in order, from the leaves of its tree."""
        return find_triangles(self._bank, model)

    def _mesh(
        self, triangle: Int[np.ndarray, " t"], material: int, stretch: Float[np.ndarray, "3 3"] | None
    ) -> trimesh.Trimesh:
        """Return triangles of one material as a mesh whose equal corners are merged."""
        corners, normal = self._arrays["triangle"][triangle], self._normal[triangle]
        uv = self._arrays["triangle_uv"][triangle]
        if stretch is not None:
            corners, normal = corners @ stretch.T, normal @ np.linalg.inv(stretch)
            if np.linalg.det(stretch) < 0:
                corners, normal, uv = (x[:, ::-1] for x in (corners, normal, uv))
        rows = np.concatenate([corners, normal, uv], axis=-1).reshape(-1, 8)
        rows, index = np.unique(rows.round(DIGITS), axis=0, return_inverse=True)
        visual = TextureVisuals(uv=rows[:, 6:], material=self._material(material))
        faces = index.reshape(-1, 3)
        return trimesh.Trimesh(rows[:, :3], faces, vertex_normals=_unit(rows[:, 3:6]), visual=visual, process=False)

    def _material(self, row: int) -> PBRMaterial:
        """Return a material of the bank: colour in linear light, texture, opacity, cut-outs."""
        layer, albedo = int(self._texture[row]), self._albedo[row]
        is_cut, is_clear = bool(self._cutout[row]), albedo[3] < OPAQUE_ALPHA
        image: dict[str, Any] = {"baseColorTexture": self._image(layer, is_cut)} if layer >= 0 else {}
        return PBRMaterial(
            name=f"material{row}",
            baseColorFactor=np.round(255 * np.clip(albedo, 0, 1)).astype(np.uint8),
            metallicFactor=0.0,
            roughnessFactor=0.9,
            doubleSided=True,
            alphaMode="MASK" if is_cut else "BLEND" if is_clear else "OPAQUE",
            **image,
        )

    def _encode_texture(self, layer: int, has_alpha: bool) -> Image.Image:
        """Return a texture layer as an image in the format in which it is sent: PNG with alpha, else JPEG."""
        pixels, data = texture_pixels(self._textures, layer, self._edge), io.BytesIO()
        if has_alpha:
            Image.fromarray(pixels).save(data, "PNG")
        else:
            Image.fromarray(pixels[..., :3]).save(data, "JPEG", quality=JPEG_QUALITY)
        return Image.open(data)


def find_triangles(bank: HouseBank, model: int) -> Int[np.ndarray, " t"]:
    """Return the bank's triangles of a model, in order, from the leaves of its tree."""
    child = np.asarray(bank.geometry.node_child)
    node, found = np.asarray(bank.geometry.model_root)[[model]], [np.zeros(0, np.int64)]
    while len(node):
        code = child[node].reshape(-1)
        leaf = ~code[code < 0].astype(np.int64)
        first, count = leaf >> LEAF_BITS, leaf & ((1 << LEAF_BITS) - 1)
        found.append(np.repeat(first - np.cumsum(count) + count, count) + np.arange(count.sum()))
        node = code[code >= 0]
    return np.unique(np.concatenate(found))


def texture_pixels(textures: UInt32[np.ndarray, "l p"], layer: int, edge: int) -> UInt8[np.ndarray, "e e 4"]:
    """Return sRGB and alpha of a texture layer, of its largest mip level with at most `edge` pixels per side."""
    largest = texture_edge(textures)
    size = min(edge, largest)
    start = (largest * largest - size * size) * 4 // 3
    return textures[layer, start : start + size * size].astype("<u4").view(np.uint8).reshape(size, size, 4)


def _unit(normal: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "n 3"]:
    """Return vectors of unit length; zero vectors stay."""
    return normal / np.maximum(np.linalg.norm(normal, axis=-1, keepdims=True), 1e-12)
