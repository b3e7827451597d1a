"""Materials of an MJCF scene as records, and the texture coordinates of its geoms."""

import hashlib
import io
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from jaxtyping import Float, UInt8

from home_mjx.core.color import decode_srgb
from home_mjx.core.files import write_atomically
from home_mjx.datasets.gltf.decode.images import NUM_DIGITS, texture_family_of
from home_mjx.datasets.mjcf.model import MjcfScene
from home_mjx.datasets.mjcf.shapes import MESH, Triangles
from home_mjx.errors import ConfigError
from home_mjx.schema.house import Material
from home_mjx.schema.lighting import SurfaceMaps

PLANE_TEXTURE = 0  # `mujoco.mjtTexture` of textures with coordinates
COLOR_ROLES = (1, 8, 0)  # `mujoco.mjtTextureRole` of colours: rgb, rgba, user
SHININESS_SCALE = 128.0  # Blinn-Phong exponent of shininess 1, as in MuJoCo's renderer


@dataclass
class MjcfMaterials:
    """Materials of a scene; each look is one slot.

    Attributes:
        scene: The scene.
        folder: Folder of the images; created when the first one is written.
        notes: Elements with their properties that are not kept.
    """

    scene: MjcfScene
    folder: Path
    notes: dict[str, str] = field(default_factory=dict)
    _slots: dict[Material, int] = field(default_factory=dict)
    _images: dict[tuple[int, str], Path] = field(default_factory=dict)

    @property
    def materials(self) -> tuple[Material, ...]:
        """All slots so far."""
        return tuple(self._slots)

    def slot(self, geom: int) -> int:
        """Return the slot of a geom's look.

        Raises:
            ConfigError: An image cannot be written to the cache.
        """
        return self._slots.setdefault(self._material(geom), len(self._slots))

    def _material(self, geom: int) -> Material:
        """Return the material of a geom."""
        model, row = self.scene.model, int(self.scene.model.geom_matid[geom])
        rgba = np.clip(self.scene.rgba(geom).astype(float), 0, 1)
        if row < 0:
            return Material("default", _color(rgba), None, float(rgba[3]))
        name = model.mat(row).name[:100] or f"material_{row}"
        texture = self._texture(row)
        path = None
        if texture >= 0 and model.tex_type[texture] == PLANE_TEXTURE:
            path = self._image(texture, name)
        elif texture >= 0:
            rgba[:3] *= self._pixels(texture)[..., :3].mean(axis=(0, 1)) / 255
            self.notes[f"texture[{model.tex(texture).name}]"] = "cube texture: its mean colour is kept"
        gloss = float(np.clip(model.mat_specular[row], 0, 1))
        exponent = max(1.0, SHININESS_SCALE * float(model.mat_shininess[row]))
        maps = self._maps(row, rgba, path)
        return Material(name, _color(rgba), path, float(rgba[3]), (gloss, gloss, gloss), exponent, maps=maps)

    def _maps(self, row: int, rgba: Float[np.ndarray, "4"], texture: Path | None) -> SurfaceMaps | None:
        """Return the emission of a material, which is that share of its colour; None without."""
        share = float(np.clip(self.scene.model.mat_emission[row], 0, 1))
        if not share:
            return None
        red, green, blue = np.round(share * decode_srgb(rgba[:3]), 6).tolist()
        return SurfaceMaps((red, green, blue), images=(texture, None, None, None))

    def _texture(self, material: int) -> int:
        """Return the texture of a material's colour; -1 without one."""
        rows = self.scene.model.mat_texid[material]
        return next((int(rows[role]) for role in COLOR_ROLES if rows[role] >= 0), -1)

    def _pixels(self, texture: int) -> UInt8[np.ndarray, "h w c"]:
        """Return the pixels of a texture, from the top row."""
        model = self.scene.model
        height, width, channels = (int(a[texture]) for a in (model.tex_height, model.tex_width, model.tex_nchannel))
        first = int(model.tex_adr[texture])
        return model.tex_data[first : first + height * width * channels].reshape(height, width, channels)

    def _image(self, texture: int, name: str) -> Path:
        """Write a texture to the cache unless its file exists, and return its path."""
        family = texture_family_of(f"{name} {self.scene.model.tex(texture).name}")
        if (texture, family) not in self._images:
            pixels = np.ascontiguousarray(self._pixels(texture))
            digest = hashlib.sha256(repr(pixels.shape).encode() + pixels.tobytes()).hexdigest()
            path = self.folder / f"{family}_{int(digest, 16) % 10**NUM_DIGITS:0{NUM_DIGITS}d}.png"
            if not path.is_file():
                _write_image(path, pixels)
            self._images[texture, family] = path
        return self._images[texture, family]

    def coordinates(self, geom: int, triangles: Triangles) -> Float[np.ndarray, "t 3 2"]:
        """Return the texture coordinates of a geom's triangles: of its mesh, else projected along the main axes."""
        model, row, mesh = self.scene.model, int(self.scene.model.geom_matid[geom]), self._mesh(geom)
        texture = self._texture(row) if row >= 0 else -1
        if texture < 0 or model.tex_type[texture] != PLANE_TEXTURE:
            return np.zeros((len(triangles), 3, 2))
        if mesh >= 0 and model.mesh_texcoordadr[mesh] >= 0:
            first, count = int(model.mesh_faceadr[mesh]), int(model.mesh_facenum[mesh])
            corner = model.mesh_facetexcoord[first : first + count] + model.mesh_texcoordadr[mesh]
            u, v = np.moveaxis(model.mesh_texcoord[corner].astype(float), -1, 0)
            return np.stack([u, 1 - v], axis=-1)
        half = (
            np.ones(3) if model.mat_texuniform[row] else np.where(model.geom_size[geom] > 0, model.geom_size[geom], 1)
        )
        return _projected(triangles / half, model.mat_texrepeat[row].astype(float))

    def _mesh(self, geom: int) -> int:
        """Return the mesh of a geom; -1 for other shapes."""
        return int(self.scene.model.geom_dataid[geom]) if self.scene.model.geom_type[geom] == MESH else -1


def _projected(triangles: Triangles, repeat: Float[np.ndarray, "2"]) -> Float[np.ndarray, "t 3 2"]:
    """Return coordinates along the two axes that each triangle faces least, from -1 to 1 for one image."""
    normal = abs(np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]))
    axes = np.array([[1, 2], [0, 2], [0, 1]])[normal.argmax(axis=1)]
    return (np.take_along_axis(triangles, axes[:, None].repeat(3, axis=1), axis=2) * repeat + 1) / 2


def _color(rgba: Float[np.ndarray, "4"]) -> tuple[float, float, float]:
    """Return the colour of an RGBA value, rounded to 6 digits."""
    red, green, blue = np.round(rgba[:3], 6).tolist()
    return red, green, blue


def _write_image(path: Path, pixels: UInt8[np.ndarray, "h w c"]) -> None:
    """Write an image as PNG."""
    from PIL import Image

    out = io.BytesIO()
    Image.fromarray(pixels[..., 0] if pixels.shape[2] == 1 else pixels).save(out, "PNG")
    try:
        with write_atomically(path) as file:
            file.write(out.getvalue())
    except OSError as error:
        raise ConfigError(f"image cannot be written: {error}", file=path, hint="Set HOME_MJX_CACHE.") from None
