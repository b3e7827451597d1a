"""Material rows of a house: optics from MTL files and overrides, acoustics from the kind of material."""

import os
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float

from home_mjx.core.color import decode_srgb
from home_mjx.core.images import read_texture
from home_mjx.scene_compile.materials.acoustic import acoustic_properties
from home_mjx.schema.categories import texture_family
from home_mjx.schema.compiled import NUM_BANDS, MaterialTable, RayKind
from home_mjx.schema.house import Material
from home_mjx.schema.lighting import MaterialMaps, SurfaceMaps
from home_mjx.schema.material_kinds import material_kind

WHITE = (1.0, 1.0, 1.0)
MEAN_EDGE = 16  # [px], to which an image is reduced before the mean of its colours is taken
MIN_VISIBLE_OPACITY = 0.05  # surfaces with a lower opacity are invisible


@dataclass(frozen=True)
class SurfaceMaterial:
    """One resolved material slot."""

    color: tuple[float, float, float] = WHITE  # sRGB, 0..1; multiplies the texture
    opacity: float = 1.0
    texture: str = ""  # absolute path
    kind: str = ""  # one of MATERIAL_KINDS
    family: str = ""  # texture family, for acoustics; falls back to the kind
    category: str = ""  # fine category, or "wall", "outer_wall", "floor", "ceiling", "ground"
    name: str = ""  # name of the slot
    maps: SurfaceMaps | None = None


def apply_override(base: Material, change: Material | None) -> Material:
    """Return an MTL slot, without gloss, as changed by its override in house.json; `base` itself if that is None."""
    if change is None:
        return base
    return Material(
        name=change.name or base.name,
        diffuse=base.diffuse if change.diffuse is None else change.diffuse,
        texture=change.texture or base.texture,
        opacity=base.opacity if change.opacity is None else change.opacity,
        missing_file="" if change.texture or base.texture else change.missing_file or base.missing_file,
        maps=change.maps or base.maps,
    )


def surface_material(material: Material, fine: str, coarse: str) -> SurfaceMaterial:
    """Resolve a material slot of an object with the specified categories; white and opaque if it does not say.

    Args:
        material: The slot after overrides.
        fine: Fine category, or "wall", "outer_wall", "floor", "ceiling", "ground".
        coarse: Coarse category, or "wall", "floor", "ceiling".
    """
    kind = material_kind(material, coarse)
    return SurfaceMaterial(
        color=material.diffuse or WHITE,
        opacity=1.0 if material.opacity is None else float(material.opacity),
        texture="" if material.texture is None else os.path.abspath(material.texture),
        kind=kind,
        family=texture_family(material.texture_name) if material.texture_name else kind,
        category=fine,
        name=material.name,
        maps=material.maps,
    )


def ray_mask(item: SurfaceMaterial) -> RayKind:
    """Return the ray types that a surface intersects.

    Opaque surfaces intersect all rays. Translucent ones, such as glass, intersect camera and sound rays but transmit
    light. Invisible ones intersect only sound rays. Visible plants intersect no sound rays.
    """
    if item.opacity < MIN_VISIBLE_OPACITY:
        return RayKind.SOUND
    mask = RayKind.CAMERA | RayKind.SOUND if item.opacity < 1 else RayKind.ALL
    return mask & ~RayKind.SOUND if item.kind == "plant" else mask


def material_table(surfaces: Sequence[SurfaceMaterial]) -> MaterialTable:
    """Return a table with one row per surface: albedo, opacity, texture, kind, ray mask and acoustic properties."""
    sound = [acoustic_properties(s.family, s.category, s.name) for s in surfaces]
    absorption, scattering, transmission = np.array(sound).reshape(-1, 3, NUM_BANDS).transpose(1, 0, 2)
    return MaterialTable(
        albedo=np.array([(*s.color, s.opacity) for s in surfaces]).reshape(-1, 4),
        texture=tuple(s.texture for s in surfaces),
        kind=tuple(s.kind for s in surfaces),
        mask=np.array([ray_mask(s) for s in surfaces], np.int32),
        absorption=absorption,
        scattering=scattering,
        transmission=transmission,
        maps=maps_table([s.maps for s in surfaces]),
    )


def maps_table(maps: Sequence[SurfaceMaps | None]) -> MaterialMaps:
    """Return the rows that have maps, with the mean of their images of emission."""
    rows = [row for row, own in enumerate(maps) if own is not None]
    found = [own for own in maps if own is not None]
    return MaterialMaps(
        row=np.array(rows, np.int32),
        emission=np.array([own.emission for own in found], float).reshape(-1, 3),
        glow=np.array([_glow(own) for own in found], float).reshape(-1, 3),
        factors=np.array(
            [(own.metallic, own.roughness, own.normal_scale, own.alpha_cutoff) for own in found], float
        ).reshape(-1, 4),
        images=tuple("" if path is None else os.path.abspath(path) for own in found for path in own.images),
    )


def _glow(own: SurfaceMaps) -> Float[np.ndarray, "3"]:
    """Return the emission of a material times the mean of its image, in linear light."""
    path = own.images[0]
    if path is None or not any(own.emission):
        return np.array(own.emission)
    return np.array(own.emission) * decode_srgb(read_texture(path, MEAN_EDGE)[..., :3] / 255).mean(axis=(0, 1))


@dataclass
class SurfaceRows:
    """Collector of a house's material rows; instances with equal slots share rows."""

    surfaces: list[SurfaceMaterial] = field(default_factory=list)
    _first: dict[tuple[SurfaceMaterial, ...], int] = field(default_factory=dict)

    def add(self, slots: Sequence[SurfaceMaterial]) -> int:
        """Append one row per slot, unless the same slots were added before, and return the first of their rows."""
        key = tuple(slots)
        if key not in self._first:
            self._first[key] = len(self.surfaces)
            self.surfaces.extend(key)
        return self._first[key]
