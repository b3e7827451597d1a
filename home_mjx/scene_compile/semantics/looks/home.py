"""Colours and materials by the rules of HoME's code (2017), to reproduce its published descriptions."""

from collections.abc import Hashable
from functools import lru_cache
from pathlib import Path

import numpy as np
from jaxtyping import Float

from home_mjx.core.images import read_texture
from home_mjx.scene_compile.materials.surface import SurfaceMaterial
from home_mjx.scene_compile.semantics.looks.appearance import Appearance, TexturedTriangles, surface_materials
from home_mjx.scene_compile.semantics.looks.color_names import COLOR_LEVELS, nearest_names_srgb
from home_mjx.scene_compile.semantics.looks.options import SemanticOptions


def compute_home_appearance(skin: TexturedTriangles, options: SemanticOptions) -> Appearance:
    """Compute an `Appearance` in which each texture or plain colour of sufficient area gets the nearest name in sRGB.

    Args:
        skin: The surface with the model's own materials, since HoME did not read those of house.json.
        options: `share` and `material` are used.
    """
    area = np.bincount(skin.slot, skin.area, minlength=len(skin.surfaces))
    share: dict[Hashable, float] = {}
    color: dict[Hashable, Float[np.ndarray, " 3"]] = {}
    for surface, part in zip(skin.surfaces, area / area.sum(), strict=True):
        key = surface.texture or (surface.color, surface.opacity)
        share[key] = share.get(key, 0.0) + float(part)
        color[key] = _color(surface)
    order = sorted((key for key in share if share[key] >= options.share), key=lambda key: -share[key])
    found = np.array([color[key] for key in order]).reshape(-1, 3)
    materials, textured = surface_materials(skin, options)
    colors = {level: tuple(dict.fromkeys(nearest_names_srgb(found, level))) for level in COLOR_LEVELS}
    return Appearance(colors, materials, textured)


def _color(surface: SurfaceMaterial) -> Float[np.ndarray, " 3"]:
    """Return the mean of the whole image, else the diffuse colour; never their product."""
    return _mean(surface.texture) if surface.texture else np.array(surface.color, float)


@lru_cache(maxsize=1 << 12)
def _mean(path: str) -> Float[np.ndarray, " 3"]:
    return read_texture(Path(path))[..., :3].mean(axis=(0, 1)) / 255
