"""Meshes, textures and materials of a compiled house as files and MJCF assets."""

import io
import re
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
from jaxtyping import Float

from home_mjx.core.color import decode_srgb
from home_mjx.core.images import open_texture
from home_mjx.scene_compile.mjcf.convex import convex_pieces
from home_mjx.schema.compiled import CompiledHouse, Model
from home_mjx.schema.lighting import MAP_NAMES
from home_mjx.schema.mjcf import numbers

MIN_TRIANGLE_AREA = 1e-12  # [m^2], smaller triangles are dropped; MuJoCo rejects meshes of only such triangles


class MjcfAssets:
    """Collector of the meshes, textures and materials of a house's geoms; each is stored once.

    Attributes:
        files: Content by path relative to the MJCF file.
    """

    def __init__(self, house: CompiledHouse) -> None:
        self.files: dict[str, bytes] = {}
        self._house = house
        self._element = ET.Element("asset")
        self._meshes: dict[tuple, str | None] = {}
        self._pieces: dict[tuple, list[str]] = {}
        self._textures: dict[str, str] = {}
        self._materials: dict[int, str] = {}

    @property
    def element(self) -> ET.Element:
        """MJCF `asset` element; it always has a material, since MJX's ray caster fails without one."""
        self.material(0)
        return self._element

    def material(self, row: int) -> str:
        """Return the MJCF name of the material of a row of the house's table; the first call for a row adds it.

        Raises:
            DatasetError: Its texture cannot be read.
        """
        if row not in self._materials:
            table = self._house.materials
            name = self._materials[row] = f"material{row}"
            attributes = {"rgba": numbers(table.albedo[row]), "specular": "0", "shininess": "0"}
            attributes |= self._emission(row)
            if table.texture[row]:
                attributes["texture"] = self._texture(table.texture[row])
            ET.SubElement(self._element, "material", attributes, name=name)
        return self._materials[row]

    def _emission(self, row: int) -> dict[str, str]:
        """Return the emission of a material as a share of its colour; empty if it does not emit."""
        table = self._house.materials
        number = np.flatnonzero(table.maps.row == row)
        if not len(number) or not table.maps.glow[number].any():
            return {}
        has_own_image = table.maps.images[len(MAP_NAMES) * int(number[0])] not in ("", table.texture[row])
        light = (table.maps.glow if has_own_image else table.maps.emission)[number].max()
        return {"emission": f"{min(light / max(float(decode_srgb(table.albedo[row, :3]).max()), 1e-3), 1.0):.9g}"}

    def mesh(self, model: Model, slot: int, stretch: Float[np.ndarray, "3 3"]) -> str | None:
        """Return the name of the mesh of one material slot of a model after a stretch; None if it has no area.

        The stretch scales, mirrors or shears the mesh. Triangles without area are dropped, and mirrored ones still face
        outwards. The first call for equal arguments adds it.
        """
        key = (model.key, slot, tuple(np.round(stretch, 6).ravel() + 0.0))
        if key not in self._meshes:
            self._meshes[key] = self._add_mesh(model, slot, stretch)
        return self._meshes[key]

    def _add_mesh(self, model: Model, slot: int, stretch: Float[np.ndarray, "3 3"]) -> str | None:
        """Add the stretched mesh of one slot as an OBJ and return its name; None if it has no area."""
        chosen = model.slot == slot
        triangle, uv = model.triangle[chosen].astype(float) @ stretch.T, model.uv[chosen]
        if np.linalg.det(stretch) < 0:
            triangle, uv = triangle[:, ::-1], uv[:, ::-1]
        edge = triangle[:, 1:] - triangle[:, :1]
        solid = np.linalg.norm(np.cross(edge[:, 0], edge[:, 1]), axis=1) > 2 * MIN_TRIANGLE_AREA
        if not solid.any():
            return None
        name = f"{safe_name(model.key)}_{slot}_{len(self._meshes)}"
        file = f"meshes/{name}.obj"
        self.files[file] = obj_bytes(triangle[solid], uv[solid])
        # A shell has a valid inertia even if the mesh is open or flat; the geoms have no mass.
        ET.SubElement(self._element, "mesh", name=name, file=file, inertia="shell")
        return name

    def pieces(self, model: Model, stretch: Float[np.ndarray, "3 3"]) -> list[str]:
        """Return the names of the convex pieces of a model after a stretch, which scales, mirrors or shears it.

        The first call for equal arguments adds them.

        Raises:
            ConfigError: As `convex_pieces`.
        """
        key = (model.key, tuple(np.round(stretch, 6).ravel() + 0.0))
        if key not in self._pieces:
            pieces = [piece @ stretch.T for piece in convex_pieces(model)]
            self._pieces[key] = [self._add_piece(f"{safe_name(model.key)}_piece{i}", p) for i, p in enumerate(pieces)]
        return self._pieces[key]

    def _add_piece(self, name: str, piece: Float[np.ndarray, "f 3 3"]) -> str:
        """Add a convex piece as an OBJ and return its name."""
        name = f"{name}_{len(self.files)}"
        file = f"meshes/{name}.obj"
        self.files[file] = obj_bytes(piece, np.zeros((len(piece), 3, 2)))
        ET.SubElement(self._element, "mesh", name=name, file=file, inertia="convex")
        return name

    def _texture(self, path: str) -> str:
        """Return the MJCF name of an image; the first call for a path adds it as PNG."""
        if path not in self._textures:
            name = self._textures[path] = f"texture{len(self._textures)}"
            file = f"textures/{name}.png"
            self.files[file] = png_bytes(Path(path))
            ET.SubElement(self._element, "texture", name=name, type="2d", file=file)
        return self._textures[path]


def obj_bytes(triangle: Float[np.ndarray, "t 3 3"], uv: Float[np.ndarray, "t 3 2"]) -> bytes:
    """Return the content of an OBJ file of separate triangles, with equal corners merged and at least four vertices."""
    vertex, corner = np.unique(triangle.reshape(-1, 3).astype(np.float32), axis=0, return_inverse=True)
    coordinate, corner_uv = np.unique(uv.reshape(-1, 2).astype(np.float32), axis=0, return_inverse=True)
    if len(vertex) < 4:  # MuJoCo requires at least four vertices
        vertex = np.concatenate([vertex, np.repeat(vertex[:1], 4 - len(vertex), axis=0)])
    face = np.stack([corner.reshape(-1, 3), corner_uv.reshape(-1, 3)], axis=-1).reshape(-1, 6) + 1
    out = io.BytesIO()
    np.savetxt(out, vertex, "v %.7g %.7g %.7g")
    np.savetxt(out, coordinate, "vt %.7g %.7g")
    np.savetxt(out, face, "f %d/%d %d/%d %d/%d")
    return out.getvalue()


def png_bytes(path: Path) -> bytes:
    """Return an image file as the content of a PNG file, with alpha unless it is opaque.

    Raises:
        DatasetError: As in `open_texture`.
    """
    image = open_texture(path)
    opaque = image.getchannel("A").getextrema() == (255, 255)
    out = io.BytesIO()
    (image.convert("RGB") if opaque else image).save(out, "PNG")
    return out.getvalue()


def safe_name(text: str) -> str:
    """Replace characters other than ASCII letters, digits and hyphens by underscores, which makes a valid file name."""
    return re.sub(r"[^A-Za-z0-9_-]", "_", text)
