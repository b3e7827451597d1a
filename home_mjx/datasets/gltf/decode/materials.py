"""Materials of a glTF document as records: metallic and roughness become a diffuse and a specular part."""

from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from home_mjx.core.color import decode_srgb, encode_srgb
from home_mjx.datasets.gltf.decode.container import GltfDocument
from home_mjx.datasets.gltf.decode.images import ImageStore
from home_mjx.datasets.suncg.formats.json_value import JsonValue, printable
from home_mjx.schema.house import Material
from home_mjx.schema.lighting import MAP_NAMES, SurfaceMaps

DIELECTRIC = 0.04  # specular reflectance of materials that are not metal, at normal incidence
MAX_EMISSION = 1000.0  # maximum emission, of a white display
MAX_SHININESS = 1000.0  # maximum Blinn-Phong exponent
DEFAULT_MATERIAL = Material("default", (1.0, 1.0, 1.0), None, 1.0)
Color = tuple[float, float, float]


@dataclass(frozen=True)
class TexturedMaterial:
    """A material with the texture coordinates that it uses.

    Attributes:
        material: The record.
        uv_set: Number of the set of texture coordinates.
        uv_matrix: Maps (u, v, 1) in the file's convention to the coordinates in the image.
    """

    material: Material
    uv_set: int = 0
    uv_matrix: np.ndarray = field(default_factory=lambda: np.eye(3))


@dataclass
class MaterialReader:
    """Reader of a document's materials, each read once.

    Attributes:
        document: The document.
        images: Store of its images.
        notes: Elements with their properties that are not kept.
    """

    document: GltfDocument
    images: ImageStore
    notes: dict[str, str] = field(default_factory=dict)
    _read: dict[int, TexturedMaterial] = field(default_factory=dict)

    def material(self, index: JsonValue) -> TexturedMaterial:
        """Return the material that a primitive names; the default one, white and rough, if it names none.

        Raises:
            DatasetError: An index is out of range, a value has another type, or an image is missing and the store
                strict.
        """
        if not index.has_value:
            return TexturedMaterial(DEFAULT_MATERIAL)
        value, number = self.document.item("materials", index), index.integer()
        if number not in self._read:
            self._read[number] = self._material(value, number)
        return self._read[number]

    def _material(self, value: JsonValue, number: int) -> TexturedMaterial:
        """Read one material."""
        name = value.member("name").data
        name = printable(name[:100]) if isinstance(name, str) and name else f"material_{number}"
        gloss = _extension(value, "KHR_materials_pbrSpecularGlossiness")
        shade = _glossy(gloss) if gloss.has_value else _metallic(value.member("pbrMetallicRoughness"))
        texture = shade.texture
        path = self.images.path(texture, name) if texture.has_value else None
        uv_set, matrix = _texture_place(texture)
        opacity = self._opacity(value, shade.alpha)
        material = Material(name, _srgb(shade.diffuse), path, opacity, shade.specular, shade.shininess)
        if _extension(value, "KHR_materials_unlit").has_value:
            material = replace(material, specular=(0.0, 0.0, 0.0), shininess=1.0)
        maps, place = self._maps(value, name, (uv_set, matrix) if texture.has_value else None)
        uv_set, matrix = place or (uv_set, matrix)
        return TexturedMaterial(replace(material, maps=maps), uv_set, matrix)

    def _maps(self, value: JsonValue, name: str, place: "_Place | None") -> "tuple[SurfaceMaps | None, _Place | None]":
        """Return the further properties of a material, None if it states none, and the place of its textures.

        Textures at other places than that of the colour, or else of the first one, are noted and left out.
        """
        images: dict[str, Path] = {}
        for kind, texture in _map_textures(value).items():
            own = _texture_place(texture)
            if place is not None and (own[0] != place[0] or not np.allclose(own[1], place[1])):
                self.notes[texture.element] = "not kept: its texture coordinates are not those of the colour"
            elif (path := self._map_image(kind, texture, name)) is not None:
                place, images[kind] = own, path
        return _surface_maps(value, images), place

    def _map_image(self, kind: str, texture: JsonValue, name: str) -> Path | None:
        """Return the image of a map; None, with a note if only exports use it, else a fallback, if it is lost."""
        if kind == "emission":
            return self.images.path(texture, name, "no emission")
        found = self.images.find(texture, name)
        if isinstance(found, Path):
            return found
        self.notes[texture.element] = f"not kept: {found.error.message}"
        return None

    def _opacity(self, value: JsonValue, alpha: float) -> float:
        """Return the opacity: alpha if blended, less what the material transmits; 1 for other modes."""
        mode, glass = value.member("alphaMode"), _extension(value, "KHR_materials_transmission")
        if mode.has_value and mode.text() not in ("OPAQUE", "MASK", "BLEND"):
            raise mode.error(f"expected OPAQUE, MASK or BLEND, got `{mode.text()[:20]}`")
        opacity = alpha if mode.data == "BLEND" else 1.0
        return opacity * (1 - _factor(glass, "transmissionFactor", 0.0)) if glass.has_value else opacity


_Place = tuple[int, np.ndarray]
_MAP_KEYS = {
    "emission": "emissiveTexture",
    "normal": "normalTexture",
    "roughness": "metallicRoughnessTexture",
    "occlusion": "occlusionTexture",
}


def _map_textures(value: JsonValue) -> dict[str, JsonValue]:
    """Return the textures of a material besides its colour, by name of the map; glossiness has no roughness."""
    shade = value.member("pbrMetallicRoughness")
    is_glossy = _extension(value, "KHR_materials_pbrSpecularGlossiness").has_value
    roughness = shade if shade.has_value and not is_glossy else replace(shade, data={})
    found = {kind: (roughness if kind == "roughness" else value).member(key) for kind, key in _MAP_KEYS.items()}
    return {kind: texture for kind, texture in found.items() if texture.has_value}


def _surface_maps(value: JsonValue, images: dict[str, Path]) -> SurfaceMaps | None:
    """Return the properties of a material besides its colour, with the images that are kept; None if it has none."""
    masked = value.member("alphaMode").data == "MASK"
    is_dark = value.member("emissiveTexture").has_value and images.get("emission") is None
    emission = (0.0, 0.0, 0.0) if is_dark else _emission(value)
    metallic, roughness, is_metal = _metal(value, "roughness" in images)
    if not (images or any(emission) or masked or is_metal):
        return None
    paths = [images.get(kind) for kind in MAP_NAMES]
    return SurfaceMaps(
        emission=emission,
        metallic=metallic,
        roughness=roughness,
        normal_scale=_number(value.member("normalTexture"), "scale", 1.0),
        alpha_cutoff=_number(value, "alphaCutoff", 0.5) if masked else -1.0,
        images=(paths[0], paths[1], paths[2], paths[3]),
    )


def _metal(value: JsonValue, has_image: bool) -> tuple[float, float, bool]:
    """Return the metallic part and roughness of a material, and whether it states that it is a metal.

    A texture that is not kept, by which the factors are multiplied, usually has surfaces that are not metal.
    """
    gloss = _extension(value, "KHR_materials_pbrSpecularGlossiness")
    if gloss.has_value:
        return 0.0, 1 - _factor(gloss, "glossinessFactor", 1.0), False
    shade = value.member("pbrMetallicRoughness")
    shade = shade if shade.has_value else replace(shade, data={})
    metallic, roughness = _factor(shade, "metallicFactor", 1.0), _factor(shade, "roughnessFactor", 1.0)
    if shade.member("metallicRoughnessTexture").has_value and not has_image:
        return 0.0, roughness, False
    return metallic, roughness, shade.member("metallicFactor").has_value and metallic > 0


def _emission(value: JsonValue) -> Color:
    """Return the emission of a material, times its strength, up to `MAX_EMISSION`."""
    factor = np.array(_vector(value, "emissiveFactor", (0.0, 0.0, 0.0)))
    strength = _number(_extension(value, "KHR_materials_emissive_strength"), "emissiveStrength", 1.0)
    return _color(np.clip(factor * strength, 0, MAX_EMISSION))


def _number(value: JsonValue, key: str, default: float) -> float:
    """Return a number of an object; the default if it, or the object, is absent."""
    found = value.member(key) if value.has_value else value
    return found.number() if found.has_value else default


@dataclass(frozen=True)
class _Shade:
    """Reflection of a material: linear diffuse colour, alpha, `Ks`, `Ns`, and the texture of its colour."""

    diffuse: np.ndarray
    alpha: float
    specular: Color
    shininess: float
    texture: JsonValue


def _metallic(value: JsonValue) -> _Shade:
    """Return the shade of the metallic-roughness model: metals reflect their colour, others `DIELECTRIC`."""
    value = value if value.has_value else replace(value, data={})
    red, green, blue, alpha = _factors(value, "baseColorFactor", 4)
    texture = value.member("baseColorTexture")
    base, metallic = np.array([red, green, blue]), _factor(value, "metallicFactor", 1.0)
    roughness = _factor(value, "roughnessFactor", 1.0)
    if value.member("metallicRoughnessTexture").has_value:
        metallic = 0.0  # factors multiply the texture, which the renderer does not use, and are usually 1
    specular = DIELECTRIC * (1 - metallic) + base * metallic
    # Metals without a diffuse part would be black in the package's renderer, which reflects lights alone.
    return _Shade(base, alpha, _color(specular), _shininess(roughness), texture)


def _glossy(value: JsonValue) -> _Shade:
    """Return the shade of the specular-glossiness model."""
    *diffuse, alpha = _factors(value, "diffuseFactor", 4)
    specular = _factors(value, "specularFactor", 3)
    roughness = 1 - _factor(value, "glossinessFactor", 1.0)
    texture = value.member("diffuseTexture")
    return _Shade(np.array(diffuse), alpha, _color(specular), _shininess(roughness), texture)


def _shininess(roughness: float) -> float:
    """Return the Blinn-Phong exponent 2/roughness^4 - 2, clipped to 1..`MAX_SHININESS`."""
    return float(np.clip(2 / max(roughness, 1e-3) ** 4 - 2, 1.0, MAX_SHININESS))


def _texture_place(texture: JsonValue) -> tuple[int, np.ndarray]:
    """Return the set of texture coordinates and the map of `KHR_texture_transform`: offset, rotation and scale."""
    place = texture if texture.has_value else replace(texture, data={})
    moved = _extension(place, "KHR_texture_transform")
    own = moved.member("texCoord") if moved.has_value else place
    own = own if moved.has_value and own.has_value else place.member("texCoord")
    uv_set = own.integer() if own.has_value else 0
    if not moved.has_value:
        return uv_set, np.eye(3)
    (x, y), (sx, sy) = _vector(moved, "offset", (0, 0)), _vector(moved, "scale", (1, 1))
    angle = moved.member("rotation").number() if moved.member("rotation").has_value else 0.0
    cosine, sine = np.cos(angle), np.sin(angle)
    return uv_set, np.array([[cosine * sx, sine * sy, x], [-sine * sx, cosine * sy, y], [0, 0, 1]])


def _extension(value: JsonValue, name: str) -> JsonValue:
    """Return an extension of an object; null if it has none."""
    extensions = value.member("extensions")
    return extensions.member(name) if extensions.has_value else replace(extensions, data=None)


def _vector(value: JsonValue, key: str, default: tuple[float, ...]) -> tuple[float, ...]:
    """Return a list of numbers of the default's length; the default if it is absent."""
    found = value.member(key)
    return tuple(found.vector(len(default)).tolist()) if found.has_value else default


def _factors(value: JsonValue, key: str, length: int) -> tuple[float, ...]:
    """Return factors clipped to 0..1; ones if they are absent."""
    return tuple(min(max(v, 0.0), 1.0) for v in _vector(value, key, (1.0,) * length))


def _factor(value: JsonValue, key: str, default: float) -> float:
    """Return one factor clipped to 0..1."""
    found = value.member(key)
    return min(max(found.number(), 0.0), 1.0) if found.has_value else default


def _color(values: object) -> Color:
    """Return three values as a tuple of floats."""
    red, green, blue = np.asarray(values, float).tolist()
    return red, green, blue


def _srgb(linear: np.ndarray) -> Color:
    """Convert a linear colour to sRGB, rounded to 6 digits."""
    return _color(np.round(encode_srgb(linear), 6))


def tinted(material: Material, linear: np.ndarray) -> Material:
    """Return a material whose colour is multiplied by a linear one, as by vertex colours."""
    own = decode_srgb(np.array(material.diffuse or (1.0, 1.0, 1.0)))
    return replace(material, diffuse=_srgb(np.clip(own * linear, 0, 1)))
