"""Appearance of a surface: dominant colours and materials by area."""

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path

import numpy as np
from jaxtyping import Float, Int

from home_mjx.core.checks import check_known, check_number
from home_mjx.core.color import decode_srgb, linear_to_lab
from home_mjx.core.images import MIN_OPAQUE_ALPHA, read_texture
from home_mjx.errors import ConfigError
from home_mjx.geometry.cells import unique_cells
from home_mjx.scene_compile.materials.surface import SurfaceMaterial
from home_mjx.schema.categories import texture_family
from home_mjx.schema.color_names import COLOR_LEVELS, nearest_names
from home_mjx.schema.material_kinds import TEXTURE_KINDS

MATERIAL_RULES = ("largest", "share")
NUM_SAMPLES = 256  # number of sample points per textured slot
IMAGE_SIDE = 32  # [px], size of downsampled textures, as seen from a distance: wood is brown, not a pattern of browns
MAX_SHADE_DISTANCE = 20.0  # CIELAB units, maximum distance of shades that are grouped into one colour
MIN_WEIGHT = 1e-9  # minimum opacity weight, so that fully transparent surfaces still have a colour


@dataclass(frozen=True)
class SemanticOptions:
    """Rules for colours and materials; part of the cache key.

    Colours are the dominant ones of a surface as rendered: texture times diffuse colour, by area and opacity, with the
    nearest name by CIEDE2000. Sizes compare the volume as placed, on a logarithmic scale, with the fine category, or
    with the coarse one if the fine one has too few models.

    Attributes:
        material: `largest`: the texture of the largest area, as in HoME's paper. `share`: every texture of at least
            `share`, as in HoME's code.
        share: Minimum share of the area of a colour or, by the rule `share`, of a material.

    Raises:
        ConfigError: A rule is unknown, or the share is not in (0, 1].
    """

    material: str = "largest"
    share: float = 0.2

    def __post_init__(self) -> None:
        check_known("material rule", (self.material,), MATERIAL_RULES)
        check_number("share", self.share, 0, 1)
        if not self.share:
            raise ConfigError("`share` must be more than 0", hint="It is the minimum share of the area, such as 0.2.")


@dataclass(frozen=True)
class TexturedTriangles:
    """Triangles and their surfaces."""

    area: Float[np.ndarray, " t"]  # [m^2], world
    uv: Float[np.ndarray, "t 3 2"]
    slot: Int[np.ndarray, " t"]  # index into surfaces
    surfaces: tuple[SurfaceMaterial, ...]


@dataclass(frozen=True)
class Appearance:
    """Names of a surface's colours and materials, largest area first."""

    colors: Mapping[str, tuple[str, ...]]  # by level of `COLOR_LEVELS`
    materials: tuple[str, ...]  # of MATERIAL_KINDS
    is_textured: bool  # materials are from textures; otherwise they are the defaults of the category


def compute_appearance(skin: TexturedTriangles, options: SemanticOptions) -> Appearance:
    """Compute the names of a surface's dominant colours and of its materials; without area, triangles count equally."""
    if skin.area.sum() <= 0:
        # A mesh of lines and points has zero area, so all triangles get equal weights.
        skin = replace(skin, area=np.ones_like(skin.area))
    lab, weight = surface_colors(skin)
    colors, weights = dominant_colors(lab, weight)
    materials, textured = surface_materials(skin, options)
    names = {level: _names(colors, weights, level, options.share) for level in COLOR_LEVELS}
    return Appearance(names, materials, textured)


def surface_colors(skin: TexturedTriangles) -> tuple[Float[np.ndarray, "n 3"], Float[np.ndarray, " n"]]:
    """Return CIELAB colours of a surface's material slots, and weights; rows do not match triangles.

    A plain slot has one colour, a textured one `NUM_SAMPLES`, one without area none.
    Weights are area times opacity, so that clear glass barely counts.
    """
    slot_area = np.bincount(skin.slot, skin.area, minlength=len(skin.surfaces))
    colors, weights = [np.zeros((0, 3))], [np.zeros(0)]
    for i in np.flatnonzero(slot_area > 0):
        color, alpha = _slot_colors(skin, int(i))
        colors.append(color)
        weights.append(np.maximum(alpha, MIN_WEIGHT) * slot_area[i] / len(alpha))
    return linear_to_lab(np.concatenate(colors)), np.concatenate(weights)


def _slot_colors(skin: TexturedTriangles, slot: int) -> tuple[Float[np.ndarray, "n 3"], Float[np.ndarray, " n"]]:
    """Return linear RGB colours and opacities of a slot: one if plain, `NUM_SAMPLES` spread by area if textured.

    The opacity is 0 at texels that are cut out (`MIN_OPAQUE_ALPHA`).
    """
    surface = skin.surfaces[slot]
    diffuse = decode_srgb(np.array([surface.color], float))
    if not surface.texture:
        return diffuse, np.array([surface.opacity])
    mine = skin.slot == slot
    texel = _texels(surface.texture, _sample(skin.area[mine], skin.uv[mine]))
    return diffuse * decode_srgb(texel[:, :3]), surface.opacity * (texel[:, 3] >= MIN_OPAQUE_ALPHA / 255)


def _sample(area: Float[np.ndarray, " t"], uv: Float[np.ndarray, "t 3 2"]) -> Float[np.ndarray, "n 2"]:
    """Return texture coordinates at `NUM_SAMPLES` points that cover triangles evenly by area.

    Triangles are selected by systematic sampling, points in them by the R2 sequence (Roberts 2018), folded into the
    triangle.
    """
    ends = np.cumsum(area)
    k = np.arange(NUM_SAMPLES) + 0.5
    triangle = np.minimum(np.searchsorted(ends, k / NUM_SAMPLES * ends[-1]), len(area) - 1)
    a, b = (k * 0.7548776662466927) % 1, (k * 0.5698402909980532) % 1
    a, b = np.where(a + b > 1, (1 - a, 1 - b), (a, b))
    weight = np.stack([1 - a - b, a, b], axis=-1)
    return np.einsum("nc,ncd->nd", weight, uv[triangle])


def _texels(path: str, uv: Float[np.ndarray, "n 2"]) -> Float[np.ndarray, "n 4"]:
    """Return nearest sRGB colours and alpha, 0..1, of a repeated, downsampled image; v = 0 is its bottom.

    Raises:
        DatasetError: The image cannot be read.
    """
    changed = Path(path).stat().st_mtime_ns if Path(path).is_file() else 0
    column, row = ((uv % 1) * IMAGE_SIDE).astype(int).clip(0, IMAGE_SIDE - 1).T
    return _image(path, changed)[IMAGE_SIDE - 1 - row, column] / 255


def texture_digest(path: str) -> bytes:
    """Return the SHA-256 digest of an image file, cached by modification time; empty if it does not exist."""
    return _file_digest(path, Path(path).stat().st_mtime_ns) if Path(path).is_file() else b""


@lru_cache(maxsize=1 << 12)
def _file_digest(path: str, changed: int) -> bytes:
    """Return the SHA-256 digest of a file; `changed` is only a part of the cache key."""
    return hashlib.sha256(Path(path).read_bytes()).digest()


@lru_cache(maxsize=1 << 12)
def _image(path: str, changed: int) -> np.ndarray:
    """Return an image as (`IMAGE_SIDE`, `IMAGE_SIDE`, 4) bytes; `changed` is only a part of the cache key."""
    return read_texture(Path(path), IMAGE_SIDE, "box")


def dominant_colors(
    lab: Float[np.ndarray, "n 3"], weight: Float[np.ndarray, " n"]
) -> tuple[Float[np.ndarray, "c 3"], Float[np.ndarray, " c"]]:
    """Return the means (CIELAB) of groups of similar colours and their shares of the total weight, largest first.

    The colour with the largest weight within `MAX_SHADE_DISTANCE` forms a group with its neighbours; then the rest is
    grouped in the same way. A pattern of red and white results in red and white, not pink; wood grain results in one
    colour. Weights must not all be 0.
    """
    cell = unique_cells(np.round(lab / (MAX_SHADE_DISTANCE / 4)).astype(np.int64))[1]
    mass = np.bincount(cell, weight)
    place = np.stack([np.bincount(cell, weight * x) for x in lab.T], axis=-1) / mass[:, None]
    near = np.linalg.norm(place[:, None] - place, axis=-1) < MAX_SHADE_DISTANCE
    left = np.ones(len(mass), bool)
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
    """Return names with a share of at least `least`, largest first, else the main one; shares of equal names add up."""
    share = area_shares(nearest_names(colors, level), weights)
    return select_by_share(share, least) or select_by_share(share, 0)[:1]


def surface_materials(skin: TexturedTriangles, options: SemanticOptions) -> tuple[tuple[str, ...], bool]:
    """Return kinds of material, largest area first, and a flag that is True if any texture has a known kind.

    By the rule `largest`, one kind: that of the largest such texture, else the category's default.
    By `share`, those of such textures with at least `options.share` of the area, maybe none.
    """
    area = np.bincount(skin.slot, skin.area, minlength=len(skin.surfaces))
    shown = area_shares([s.texture for s in skin.surfaces], area)
    kinds = {texture: kind for texture in shown if (kind := texture_kind(texture))}
    if options.material == "share":
        found = select_by_share({texture: shown[texture] for texture in kinds}, options.share)
        return tuple(dict.fromkeys(kinds[texture] for texture in found)), bool(kinds)
    if kinds:
        return (kinds[max(kinds, key=lambda texture: shown[texture])],), True
    usual = area_shares([s.kind for s in skin.surfaces], area)
    return select_by_share(usual, 0)[:1], False


def texture_kind(texture: str) -> str:
    """Return the kind of a texture by the file name in its path, one of `MATERIAL_KINDS`; "" if none."""
    return TEXTURE_KINDS.get(texture_family(Path(texture).stem), "")


def area_shares(names: Sequence[str], area: Float[np.ndarray, " n"]) -> dict[str, float]:
    """Return each name's share of the total area, equal names added up; surfaces named "" count only in the total.

    Names without area are left out. The total must not be 0.
    """
    covered: dict[str, float] = {}
    for name, part in zip(names, (area / area.sum()).tolist(), strict=True):
        if name and part > 0:
            covered[name] = covered.get(name, 0.0) + part
    return covered


def select_by_share(share: Mapping[str, float], min_share: float) -> tuple[str, ...]:
    """Return the names with at least a minimum share, largest first."""
    return tuple(name for name in sorted(share, key=lambda name: -share[name]) if share[name] >= min_share)
