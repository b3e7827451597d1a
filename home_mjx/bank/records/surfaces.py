"""How surfaces take light and sound."""

import numpy as np
from jaxtyping import Array, Bool, Float, Int, UInt32

from home_mjx.bank.records.owners import HouseAt
from home_mjx.core.color import decode_srgb
from home_mjx.core.pytree import Pytree, array
from home_mjx.schema.material_kinds import MATERIAL_KINDS

KIND_INDEX = {"": -1} | {name: i for i, name in enumerate(MATERIAL_KINDS)}


def linear_albedo(at: HouseAt) -> Float[np.ndarray, "r 4"]:
    """Linear light from sRGB; opacity stays."""
    albedo = at.record.materials.albedo
    return np.concatenate([decode_srgb(albedo[:, :3]), albedo[:, 3:]], axis=1)


def texture_layer(at: HouseAt) -> list[int]:
    """Layer of each material's texture."""
    return [at.layer[path] for path in at.record.materials.texture]


def material_kind(at: HouseAt) -> list[int]:
    """Number of each material's kind."""
    return [KIND_INDEX[name] for name in at.record.materials.kind]


def specular(at: HouseAt) -> Float[np.ndarray, "r 3"]:
    """Gloss of every material; those that the table of gloss lacks are matt."""
    return np.pad(at.record.gloss.specular, ((0, _missing(at)), (0, 0)))


def shininess(at: HouseAt) -> Float[np.ndarray, " r"]:
    """Exponent of every material."""
    return np.pad(at.record.gloss.shininess, (0, _missing(at)), constant_values=1)


def mirror(at: HouseAt) -> Bool[np.ndarray, " r"]:
    """Which materials are mirrors."""
    return np.pad(at.record.gloss.mirror, (0, _missing(at)))


def _missing(at: HouseAt) -> int:
    return len(at.record.materials.mask) - len(at.record.gloss.mirror)


class Materials(Pytree):
    """The bank's one material table."""

    albedo: Float[Array, "material 4"] = array("linear-light diffuse 0..1, and opacity", source=linear_albedo, fill=1)
    texture: Int[Array, " material"] = array("layer in `textures`; -1 none", source=texture_layer, fill=-1)
    kind: Int[Array, " material"] = array("index into MATERIAL_KINDS; -1 unknown", source=material_kind, fill=-1)
    absorption: Float[Array, "material bands"] = array(
        "energy fractions, octaves 125 .. 8000 Hz", source="materials.absorption", fill=1
    )
    scattering: Float[Array, "material bands"] = array("energy fractions", source="materials.scattering")
    transmission: Float[Array, "material bands"] = array("energy fractions", source="materials.transmission")
    textures: UInt32[Array, "layers texels"] = array(
        "sRGB, alpha highest; mip levels after one another, row 0 is the top (v = 1)", source="textures"
    )


class Finish(Pytree):
    """How surfaces take light besides their diffuse colour."""

    normal: Float[Array, "triangle 3 3"] = array(
        "unit, of the corners of `Geometry.triangle`, model frame", source="normal"
    )
    specular: Float[Array, "material 3"] = array("linear light", source=specular)
    shininess: Float[Array, " material"] = array("Blinn-Phong exponent", source=shininess, fill=1)
    mirror: Bool[Array, " material"] = array("flat mirrors", source=mirror, fill=False)
