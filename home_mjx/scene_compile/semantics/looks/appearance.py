"""Appearance of a surface: dominant colours and materials by area."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np
from jaxtyping import Float, Int
from PIL import Image

from home_mjx.core.color import decode_srgb, linear_to_lab
from home_mjx.core.images import open_texture
from home_mjx.scene_compile.materials.surface import SurfaceMaterial
from home_mjx.scene_compile.semantics.looks.color_names import LEVELS, names_by_look
from home_mjx.scene_compile.semantics.looks.options import SemanticOptions
from home_mjx.schema.categories import texture_family
from home_mjx.schema.material_kinds import TEXTURE_KINDS

SAMPLES = 256  # points of each textured slot
IMAGE_SIDE = 32  # [px]: textures are seen from a distance: wood is brown, not a pattern of browns
LIKENESS = 20.0  # CIELAB units: closer colours are shades of one
FAINTEST = 1e-9  # surfaces of less weight are invisible


@dataclass(frozen=True)
class Skin:
    """Triangles and the surfaces that cover them."""

    area: Float[np.ndarray, " t"]  # [m^2], in the world
    uv: Float[np.ndarray, "t 3 2"]
    slot: Int[np.ndarray, " t"]  # index into surfaces
    surfaces: tuple[SurfaceMaterial, ...]


@dataclass(frozen=True)
class Appearance:
    """Names of a surface's colours and materials, largest area first."""

    colors: Mapping[str, tuple[str, ...]]  # by level of `LEVELS`
    materials: tuple[str, ...]  # of MATERIAL_KINDS
    textured: bool  # materials are known from textures; else they are the usual ones of the category


def appearance(skin: Skin, options: SemanticOptions) -> Appearance:
    """Colours as drawn, and materials by the rule of the options.

    Args:
        skin: The surface.
        options: `share` and `material` count here.
    """
    lab, weight = surface_colors(skin)
    colors, weights = dominant_colors(lab, weight)
    materials, textured = surface_materials(skin, options)
    names = {level: _names(colors, weights, level, options.share) for level in LEVELS}
    return Appearance(names, materials, textured)


def surface_colors(skin: Skin) -> tuple[Float[np.ndarray, "n 3"], Float[np.ndarray, " n"]]:
    """CIELAB colours over a surface and their weights: area times opacity, so that clear glass hardly counts."""
    slot_area = np.bincount(skin.slot, skin.area, minlength=len(skin.surfaces))
    colors, weights = [np.zeros((0, 3))], [np.zeros(0)]
    for i in np.flatnonzero(slot_area > 0):
        color, alpha = _slot_colors(skin, int(i))
        colors.append(color)
        weights.append(np.maximum(alpha, FAINTEST) * slot_area[i] / len(alpha))
    return linear_to_lab(np.concatenate(colors)), np.concatenate(weights)


def _slot_colors(skin: Skin, slot: int) -> tuple[Float[np.ndarray, "n 3"], Float[np.ndarray, " n"]]:
    """Colours in linear light and opacities: one of a plain slot, `SAMPLES` spread evenly by area of a textured one."""
    surface = skin.surfaces[slot]
    diffuse = decode_srgb(np.array([surface.color], float))
    if not surface.texture:
        return diffuse, np.array([surface.opacity])
    mine = skin.slot == slot
    texel = _texels(surface.texture, _sample(skin.area[mine], skin.uv[mine]))
    return diffuse * decode_srgb(texel[:, :3]), surface.opacity * texel[:, 3]


def _sample(area: Float[np.ndarray, " t"], uv: Float[np.ndarray, "t 3 2"]) -> Float[np.ndarray, "n 2"]:
    """Texture coordinates at points that cover triangles evenly.

    Triangles by systematic sampling, places in them by the R2 sequence (Roberts 2018) folded into the triangle.
    """
    ends = np.cumsum(area)
    k = np.arange(SAMPLES) + 0.5
    triangle = np.minimum(np.searchsorted(ends, k / SAMPLES * ends[-1]), len(area) - 1)
    a, b = (k * 0.7548776662466927) % 1, (k * 0.5698402909980532) % 1
    a, b = np.where(a + b > 1, (1 - a, 1 - b), (a, b))
    weight = np.stack([1 - a - b, a, b], axis=-1)
    return np.einsum("nc,ncd->nd", weight, uv[triangle])


def _texels(path: str, uv: Float[np.ndarray, "n 2"]) -> Float[np.ndarray, "n 4"]:
    """Colour in sRGB and alpha, 0..1, of a repeated image; v = 0 is its bottom."""
    changed = Path(path).stat().st_mtime_ns if Path(path).is_file() else 0
    column, row = ((uv % 1) * IMAGE_SIDE).astype(int).clip(0, IMAGE_SIDE - 1).T
    return _image(path, changed)[IMAGE_SIDE - 1 - row, column] / 255


@lru_cache(maxsize=1 << 12)
def _image(path: str, changed: int) -> np.ndarray:
    """A small copy; `changed` makes the cache read a changed file again."""
    image = open_texture(Path(path)).resize((IMAGE_SIDE, IMAGE_SIDE), Image.Resampling.BOX)
    return np.asarray(image)


def dominant_colors(
    lab: Float[np.ndarray, "n 3"], weight: Float[np.ndarray, " n"]
) -> tuple[Float[np.ndarray, "c 3"], Float[np.ndarray, " c"]]:
    """Means of groups of like colours and their shares of all weight, largest first.

    The colour with most weight within `LIKENESS` and everything that near make a group; the rest follows in the same
    way. A pattern of red and white gives red and white, not pink; wood grain gives one colour.

    Args:
        lab: CIELAB colours.
        weight: Of each; not all 0.
    """
    cell, index = np.unique(np.round(lab / (LIKENESS / 4)).astype(int), axis=0, return_inverse=True)
    mass = np.bincount(index.reshape(-1), weight)
    place = np.stack([np.bincount(index.reshape(-1), weight * x) for x in lab.T], axis=-1) / mass[:, None]
    near = np.linalg.norm(place[:, None] - place, axis=-1) < LIKENESS
    left = np.ones(len(cell), bool)
    found = []
    while left.any():
        group = near[int(np.where(left, near @ (mass * left), -1).argmax())] & left
        found.append((mass[group].sum(), np.average(place[group], axis=0, weights=mass[group])))
        left &= ~group
    found.sort(key=lambda item: -item[0])
    return np.array([color for _, color in found]), np.array([m for m, _ in found]) / mass.sum()


def _names(
    colors: Float[np.ndarray, "c 3"], weights: Float[np.ndarray, " c"], level: str, least: float
) -> tuple[str, ...]:
    """Names of the colours that cover enough, else of the main one; colours of one name add up."""
    share = shares(names_by_look(colors, level), weights)
    return at_least(share, least) or at_least(share, 0)[:1]


def surface_materials(skin: Skin, options: SemanticOptions) -> tuple[tuple[str, ...], bool]:
    """Kinds by area, and whether they are known from textures.

    Kinds known from textures come before those that only the category suggests.
    """
    area = np.bincount(skin.slot, skin.area, minlength=len(skin.surfaces))
    shown = shares([s.texture for s in skin.surfaces], area)
    told = {texture: kind for texture in shown if (kind := texture_kind(texture))}
    if options.material == "share":
        found = at_least({texture: shown[texture] for texture in told}, options.share)
        return tuple(dict.fromkeys(told[texture] for texture in found)), bool(told)
    if told:
        return (told[max(told, key=lambda texture: shown[texture])],), True
    usual = shares([s.kind for s in skin.surfaces], area)
    return at_least(usual, 0)[:1], False


def texture_kind(texture: str) -> str:
    """Kind of a texture by its name, one of `MATERIAL_KINDS`; "" if it has none."""
    return TEXTURE_KINDS.get(texture_family(Path(texture).stem), "")


def shares(names: Sequence[str], area: Float[np.ndarray, " n"]) -> dict[str, float]:
    """Share of the area by name; surfaces without a name count only in the total."""
    covered: dict[str, float] = {}
    for name, part in zip(names, (area / area.sum()).tolist(), strict=True):
        if name and part > 0:
            covered[name] = covered.get(name, 0.0) + part
    return covered


def at_least(share: Mapping[str, float], least: float) -> tuple[str, ...]:
    """Names that have at least a share, largest first."""
    return tuple(name for name in sorted(share, key=lambda name: -share[name]) if share[name] >= least)
