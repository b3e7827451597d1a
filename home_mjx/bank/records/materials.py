"""Surface records of a bank: optical and acoustic material properties."""

import numpy as np
from jaxtyping import Array, Bool, Float, Int, UInt32

from home_mjx.bank.records.owners import HouseOwner
from home_mjx.core.color import decode_srgb
from home_mjx.core.pytree import Pytree, array
from home_mjx.schema.material_kinds import MATERIAL_KINDS

KIND_INDEX = {"": -1} | {name: i for i, name in enumerate(MATERIAL_KINDS)}


def linear_albedo(at: HouseOwner) -> Float[np.ndarray, "r 4"]:
    """Return the materials' albedo in linear light (from sRGB), with opacity in the last column."""
    albedo = at.record.materials.albedo
    return np.concatenate([decode_srgb(albedo[:, :3]), albedo[:, 3:]], axis=1)


def texture_layer(at: HouseOwner) -> list[int]:
    """Return the bank's texture layer of each material; -1 if it has none."""
    return [at.texture_layer[path] for path in at.record.materials.texture]


def material_kind(at: HouseOwner) -> list[int]:
    """Return the index of each material's kind in `MATERIAL_KINDS`; -1 for "", unknown. Raise `KeyError` for others."""
    return [KIND_INDEX[name] for name in at.record.materials.kind]


def specular(at: HouseOwner) -> Float[np.ndarray, "r 3"]:
    """Return the specular colour of every material in linear light; 0 for rows missing in the gloss table."""
    return np.pad(at.record.gloss.specular, ((0, _missing(at)), (0, 0)))


def shininess(at: HouseOwner) -> Float[np.ndarray, " r"]:
    """Return the Blinn-Phong exponent of every material; 1 for rows missing in the gloss table."""
    return np.pad(at.record.gloss.shininess, (0, _missing(at)), constant_values=1)


def mirror(at: HouseOwner) -> Bool[np.ndarray, " r"]:
    """Return the mask of materials that are flat mirrors; False for rows missing in the gloss table."""
    return np.pad(at.record.gloss.mirror, (0, _missing(at)))


def _missing(at: HouseOwner) -> int:
    """Return the number of material rows beyond those of the gloss table."""
    return len(at.record.materials.mask) - len(at.record.gloss.mirror)


class Materials(Pytree):
    """The bank's material table, shared by all houses."""

    albedo: Float[Array, "material 4"] = array("linear-light diffuse 0..1, and opacity", source=linear_albedo, fill=1)
    texture: Int[Array, " material"] = array("layer in `textures`; -1 none", source=texture_layer, fill=-1)
    kind: Int[Array, " material"] = array("index into MATERIAL_KINDS; -1 unknown", source=material_kind, fill=-1)
    absorption: Float[Array, "material bands"] = array(
        "energy fractions, octaves 125 .. 8000 Hz", source="materials.absorption", fill=1
    )
    scattering: Float[Array, "material bands"] = array("energy fractions", source="materials.scattering")
    transmission: Float[Array, "material bands"] = array("energy fractions", source="materials.transmission")
    textures: UInt32[Array, "layers texels"] = array(
        "sRGB, alpha in the highest byte; concatenated mip levels, row 0 is the top (v = 1)", source="textures"
    )


class Finish(Pytree):
    """Optical properties of surfaces besides their diffuse colour."""

    normal: Float[Array, "triangle 3 3"] = array(
        "unit, per corner of `Geometry.triangle`, model frame", source="normal"
    )
    specular: Float[Array, "material 3"] = array("linear light", source=specular)
    shininess: Float[Array, " material"] = array("Blinn-Phong exponent", source=shininess, fill=1)
    mirror: Bool[Array, " material"] = array("True for flat mirrors", source=mirror, fill=False)
