"""Lights and glossy surfaces of one house as arrays, created by `scene_compile.lighting`."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float, Int

MEAN_REFLECTANCE = 0.4  # mean diffuse reflectance of a room's surfaces
LUMENS_PER_WATT = 683.0  # of lights in files, as of green light and as importers and exporters of glTF have it


AMBIENT_SOURCES = ("lamps", "daylight")  # sources of ambient light


@dataclass(frozen=True)
class LightTable:
    """Lights in the frames of the instances that carry them, so that a light moves with its lamp.

    A light is a point, a line (`axis_u` alone) or a rectangle. Its radiant intensity is
    `intensity * max(cos, 0)**exponent` around `direction` for `cos >= cutoff`. A point light has exponent 0 and cutoff
    -2, a window exponent 1.
    """

    pos: Float[np.ndarray, "n 3"]  # [m], centre in the model's frame
    axis_u: Float[np.ndarray, "n 3"]  # [m], half extents
    axis_v: Float[np.ndarray, "n 3"]
    direction: Float[np.ndarray, "n 3"]  # unit
    intensity: Float[np.ndarray, "n 3"]  # linear light [W/sr]; for daylight [m^2], times the sky's radiance
    exponent: Float[np.ndarray, " n"]
    cutoff: Float[np.ndarray, " n"]  # cosine
    area: Float[np.ndarray, " n"]  # [m^2], of rectangles
    daylight: Bool[np.ndarray, " n"]
    instance: Int[np.ndarray, " n"]  # instance that carries it and casts no shadow of it
    room: Int[np.ndarray, " n"]  # illuminated room; -1 none
    ambient: Float[np.ndarray, "r 2 3"]  # irradiance [W/m^2] by room + 1 (0: no room) and source (`AMBIENT_SOURCES`)

    @staticmethod
    def empty() -> "LightTable":
        """Return a table without lights, and with zero ambient light in its only row, which is that of no room."""
        vectors = dict.fromkeys(("pos", "axis_u", "axis_v", "direction", "intensity"), np.zeros((0, 3)))
        numbers = dict.fromkeys(("exponent", "cutoff", "area"), np.zeros(0))
        rows = dict.fromkeys(("instance", "room"), np.zeros(0, np.int32))
        ambient = np.zeros((1, len(AMBIENT_SOURCES), 3))
        return LightTable(**vectors, **numbers, **rows, daylight=np.zeros(0, bool), ambient=ambient)


@dataclass(frozen=True)
class Gloss:
    """Specular reflection of the material rows of a house."""

    specular: Float[np.ndarray, "r 3"]  # linear light, `Ks` of the MTL
    shininess: Float[np.ndarray, " r"]  # Blinn-Phong exponent, `Ns`
    mirror: Bool[np.ndarray, " r"]  # a flat mirror

    @staticmethod
    def matt(count: int) -> "Gloss":
        """Return `count` rows without specular reflection, of shininess 1."""
        return Gloss(np.zeros((count, 3)), np.ones(count), np.zeros(count, bool))


MAP_NAMES = ("emission", "normal", "roughness", "occlusion")  # of the images of a `SurfaceMaps`


@dataclass(frozen=True)
class SurfaceMaps:
    """Properties of a physically based material besides its colour, kept for renderers and exports.

    Images have the texture coordinates of the colour.
    """

    emission: tuple[float, float, float] = (0.0, 0.0, 0.0)  # linear light, 1: as bright as a white display
    metallic: float = 0.0
    roughness: float = 1.0
    normal_scale: float = 1.0
    alpha_cutoff: float = -1.0  # minimum alpha of what is visible; negative: alpha is no mask
    # Existing image files, in the order of `MAP_NAMES`. Emission is sRGB, times `emission`. Roughness is in green and
    # metallic in blue, times the factors. Occlusion is in red.
    images: tuple[Path | None, Path | None, Path | None, Path | None] = (None, None, None, None)


@dataclass(frozen=True)
class MaterialMaps:
    """Rows of a house's material table that have `SurfaceMaps`."""

    row: Int[np.ndarray, " m"]  # in the table, ascending
    emission: Float[np.ndarray, "m 3"]  # linear light, without the image
    glow: Float[np.ndarray, "m 3"]  # linear light, times the mean of the image
    factors: Float[np.ndarray, "m 4"]  # metallic, roughness, scale of normals, cutoff of alpha
    images: tuple[str, ...]  # absolute paths, one of each of `MAP_NAMES` per row; "" none

    @staticmethod
    def empty() -> "MaterialMaps":
        """Return no rows."""
        return MaterialMaps(np.zeros(0, np.int32), np.zeros((0, 3)), np.zeros((0, 3)), np.zeros((0, 4)), ())
