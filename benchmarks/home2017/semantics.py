"""Colours, materials and sizes of objects by the rules of HoME's code (2017), which reproduce its descriptions.

Rooms, surfaces, supports and relations are those of `house_semantics`.
"""

import math
from collections.abc import Hashable
from dataclasses import replace
from functools import lru_cache
from pathlib import Path

import numpy as np
from jaxtyping import Float

from home_mjx.core.images import read_texture
from home_mjx.geometry.meshes import surface_areas
from home_mjx.scene_compile.architecture.rooms import find_frame
from home_mjx.scene_compile.architecture.shell import build_shell
from home_mjx.scene_compile.materials.surface import SurfaceMaterial, surface_material
from home_mjx.scene_compile.objects.placed_objects import PlacedObject, place_objects
from home_mjx.scene_compile.semantics.appearance import (
    Appearance,
    SemanticOptions,
    TexturedTriangles,
    surface_materials,
)
from home_mjx.scene_compile.semantics.describe import short_text
from home_mjx.scene_compile.semantics.engine import describe_house
from home_mjx.scene_compile.semantics.sizes import NORMAL, SIZE_LIMITS
from home_mjx.scene_compile.semantics.types import HouseSemantics, ObjectSemantics
from home_mjx.schema.color_names import COLOR_LEVELS, palettes
from home_mjx.schema.house import House, Metadata, ModelInfo, ObjectNode
from home_mjx.schema.semantic import SIZES

HOME2017 = SemanticOptions(material="share")  # HoME's rule of materials
FRONT = (0.0, 0.0, 1.0)  # front of the models whose sizes HoME compared


def home2017_semantics(house: House, metadata: Metadata, options: SemanticOptions = HOME2017) -> HouseSemantics:
    """Compute the semantics of a house, with colours, materials and sizes of its objects by HoME's rules.

    Args:
        house: House as read from the dataset.
        metadata: Categories and sizes of its models.
        options: Rule and minimum share of materials; the share is also that of colours.

    Raises:
        DatasetError: The house has no room with a mesh, or a texture cannot be read.

    Example:
        >>> meaning = home2017_semantics(dataset.load_house("0004d52d"), dataset.metadata)  # doctest: +SKIP
        >>> meaning.objects[0].description  # doctest: +SKIP
        'small linen coffee table made of wood'
    """
    frame = find_frame(house)
    placed = place_objects(frame, metadata)
    found = describe_house(frame, build_shell(frame), placed, metadata, options)
    volumes = front_volumes(metadata)
    items = zip(found.objects, placed, strict=True)
    return replace(found, objects=tuple(_describe(item, at, house, volumes, options) for item, at in items))


def _describe(
    item: ObjectSemantics,
    placed: PlacedObject,
    house: House,
    volumes: dict[str, Float[np.ndarray, " _"]],
    options: SemanticOptions,
) -> ObjectSemantics:
    look = home2017_appearance(_skin(placed, house), options)
    size = home2017_size(volumes, placed.info)
    return replace(item, appearance=look, size=size, description=short_text(size, look, placed.info.fine))


def _skin(item: PlacedObject, house: House) -> TexturedTriangles:
    """Return the surface of an object with the model's own materials: HoME did not read those of house.json."""
    surfaces, area = item.surfaces, surface_areas(item.triangles)
    if isinstance(item.node, ObjectNode):
        own = house.models[item.node.model_key].materials
        surfaces = tuple(surface_material(slot, item.info.fine, item.info.coarse) for slot in own)
    # A mesh of lines and points has zero area, so all triangles get equal weights.
    area = area if area.sum() > 0 else np.ones_like(area)
    return TexturedTriangles(area, item.model.uv, item.model.slot, surfaces)


def home2017_appearance(skin: TexturedTriangles, options: SemanticOptions) -> Appearance:
    """Compute an `Appearance` in which each texture or plain colour of sufficient area gets the nearest name in sRGB.

    Args:
        skin: The surface.
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


def nearest_names_srgb(srgb: Float[np.ndarray, "n 3"], level: str) -> list[str]:
    """Return the colour names with the smallest Euclidean distances of sRGB values.

    Args:
        srgb: Colours, 0..1.
        level: One of `COLOR_LEVELS`.
    """
    palette = palettes()[level]
    nearest = np.linalg.norm(srgb[:, None] - palette.srgb, axis=-1).argmin(axis=1)
    return [palette.names[i] for i in nearest]


def front_volumes(metadata: Metadata) -> dict[str, Float[np.ndarray, " _"]]:
    """Return the volumes [m^3] of all models that face `FRONT`, by coarse category.

    Args:
        metadata: The dataset's tables; models without a box are ignored.
    """
    groups: dict[str, list[float]] = {}
    for info in metadata.models.values():
        if info.dims is not None and info.front == FRONT:
            groups.setdefault(info.coarse, []).append(math.prod(info.dims))
    return {category: np.array(volumes) for category, volumes in groups.items()}


def home2017_size(volumes: dict[str, Float[np.ndarray, " _"]], info: ModelInfo) -> str:
    """Return the size class of a model in its coarse category, never "tiny"; "" for models that HoME did not compare.

    Args:
        volumes: Result of `front_volumes`.
        info: The model's row.
    """
    peers = volumes.get(info.coarse)
    if peers is None or info.dims is None or info.front != FRONT:
        return ""
    above, spread = math.prod(info.dims) - float(peers.mean()), float(peers.std())
    if above < SIZE_LIMITS[1] * spread:
        return "small"
    return SIZES[NORMAL + (above > SIZE_LIMITS[2] * spread) + (above > SIZE_LIMITS[3] * spread)]
