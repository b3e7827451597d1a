"""Materials of USD prims: `UsdPreviewSurface` with its images, else the display colour."""

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float, Int

from home_mjx.core.color import encode_srgb
from home_mjx.core.files import is_file
from home_mjx.core.images import open_texture
from home_mjx.datasets.gltf.decode.primitives import round_colors
from home_mjx.datasets.suncg.formats.json_value import printable
from home_mjx.datasets.usd.layers import UsdScene, as_rows, at_start, below, pxr, start
from home_mjx.errors import DatasetError
from home_mjx.schema.house import Fallback, Material
from home_mjx.schema.lighting import SurfaceMaps

MAX_EMISSION = 1000.0  # maximum emission, of a white display
MAP_INPUTS = {"emissiveColor": 3, "normal": 3, "occlusion": 1}  # inputs that images may feed, and their lengths
PURPOSES = ("preview", "full")  # of bindings; USD takes those of all purposes where it finds none
DISPLAY = "display"  # name of materials that are a display colour
GREY = Material("default", (0.6, 0.6, 0.6), None, 1.0)


@dataclass
class UsdMaterials:
    """Reader of the materials of a scene, each read once.

    Attributes:
        scene: The scene.
        fallbacks: Textures that materials do without.
        notes: Shaders of images that only exports use, and that are lost.
    """

    scene: UsdScene
    fallbacks: list[Fallback] = field(default_factory=list)
    notes: dict[str, str] = field(default_factory=dict)
    _read: dict[str, Material] = field(default_factory=dict)
    _faults: dict[Path, str] = field(default_factory=dict)

    def material(self, prim: Any) -> Material:
        """Return the diffuse colour, opacity and texture of a prim's `UsdPreviewSurface`, else its display colour."""
        binding = pxr("UsdShade").MaterialBindingAPI(prim)
        found = (binding.ComputeBoundMaterial(purpose)[0] for purpose in PURPOSES)
        bound: Any = next((material for material in found if material), None)
        shader = bound.ComputeSurfaceSource()[0] if bound else None
        if not shader or shader.GetIdAttr().Get() != "UsdPreviewSurface":
            if bound:
                self.notes[str(bound.GetPath())] = "shader is no UsdPreviewSurface: display colours replace it"
            color = pxr("UsdGeom").PrimvarsAPI(prim).FindPrimvarWithInheritance("displayColor")
            shown = as_rows(color.GetAttr(), at_start(color.GetAttr()), 3) if color else np.zeros((0, 3))
            return Material(DISPLAY, _color(shown[0]), None, 1.0) if len(shown) else GREY
        key = str(bound.GetPath())
        if key not in self._read:
            self._read[key] = self._preview(shader, printable(bound.GetPrim().GetName()[:100]))
        return self._read[key]

    def _preview(self, shader: Any, name: str) -> Material:
        """Return the material of a `UsdPreviewSurface`."""
        color, image = _input(shader, "diffuseColor", 3)
        path = self._texture(image, name) if image else None
        white = (1.0, 1.0, 1.0) if image else GREY.diffuse
        paint = _color(color) if color is not None else white
        return Material(name, paint, path, _share(shader, "opacity", 1.0), maps=self._maps(shader, name))

    def _maps(self, shader: Any, name: str) -> SurfaceMaps | None:
        """Return the emission, metallic part and images of a `UsdPreviewSurface`; None without any."""
        sources = ((key, _input(shader, key, width)[1]) for key, width in MAP_INPUTS.items())
        images = [self._map_image(key, source, name) if source else None for key, source in sources]
        emitted, metallic = _input(shader, "emissiveColor", 3)[0], _share(shader, "metallic", 0.0)
        light = np.clip(np.nan_to_num(emitted if emitted is not None else np.zeros(3)), 0, MAX_EMISSION)
        light = np.ones(3) if images[0] is not None else light
        if not (any(images) or light.any() or metallic):
            return None
        return SurfaceMaps(
            emission=(float(light[0]), float(light[1]), float(light[2])),
            metallic=metallic,
            roughness=_share(shader, "roughness", 0.5),
            images=(images[0], images[1], None, images[2]),
        )

    def _map_image(self, key: str, prim: Any, name: str) -> Path | None:
        """Return the image of a map; None, with a note if only exports use it, else a fallback, if it is lost."""
        if key == "emissiveColor":
            return self._texture(prim, name, "no emission")
        _, path, reason = self._image(prim)
        if reason:
            self.notes[str(prim.GetPath())] = f"{key} of `{name}` is not kept: {reason}"
        return None if reason else path

    def _texture(self, prim: Any, name: str, replacement: str = "the material's colour") -> Path | None:
        """Return the image of a `UsdUVTexture`; None, with a fallback, if it is missing or broken."""
        text, path, reason = self._image(prim)
        if reason:
            self.fallbacks.append(Fallback("texture", text[:100] or name, name, replacement, reason))
        return None if reason else path

    def _image(self, prim: Any) -> tuple[str, Path | None, str]:
        """Return the name of the image of a `UsdUVTexture`, its path, and the reason why it is lost, else ""."""
        source = _source(pxr("UsdShade").Shader(prim), "file")
        value = at_start(source) if source else None
        text = str(getattr(value, "path", ""))
        if not text:
            return text, None, "colour is not of an image"
        file = source.GetPropertyStack()[0].layer.realPath  # paths are relative to the layer that states them
        path = below(self.scene.root, Path(file), text)
        if not is_file(path) or path.suffix.lower() not in (".png", ".jpg", ".jpeg"):
            return text, None, "image is missing, or neither PNG nor JPEG"
        if path not in self._faults:
            self._faults[path] = _fault(path)
        return text, path, self._faults[path]


def split_display_colors(
    prim: Any,
    slot: Int[np.ndarray, " t"],
    materials: tuple[Material, ...],
    owner: Int[np.ndarray, " t"],
    corner: Int[np.ndarray, "t 3"],
    index: Int[np.ndarray, " c"],
) -> tuple[Int[np.ndarray, " t"], tuple[Material, ...]]:
    """Return slots and materials of triangles, with more of them where the mesh has several display colours.

    Args:
        prim: The mesh.
        slot: Slots of its triangles; 0 is that of the mesh, others are of its subsets.
        materials: Materials of the slots.
        owner: Faces of the triangles.
        corner: Corners of the triangles, among those of all faces.
        index: Points of all corners.
    """
    primvar = pxr("UsdGeom").PrimvarsAPI(prim).FindPrimvarWithInheritance("displayColor")
    found = primvar.ComputeFlattened(start()) if materials[0].name == DISPLAY and primvar else None
    values = as_rows(primvar.GetAttr(), found, 3) if primvar else np.zeros((0, 3))
    rows = {"uniform": owner[:, None], "faceVarying": corner, "vertex": index[corner], "varying": index[corner]}
    chosen = rows.get(str(primvar.GetInterpolation())) if len(values) > 1 else None
    own = slot == 0
    if chosen is None or not own.any() or chosen.max() >= len(values):
        return slot, materials
    part, shades = round_colors(np.nan_to_num(values[chosen[own]].mean(axis=1)))
    split = slot - 1 + len(shades)
    split[own] = part
    return split, (*(replace(materials[0], diffuse=_color(shade)) for shade in shades), *materials[1:])


def _fault(path: Path) -> str:
    """Return the reason why an image cannot be decoded; "" if it can."""
    try:
        open_texture(path)
    except DatasetError as error:
        return error.message
    return ""


def _source(shader: Any, name: str) -> Any:
    """Return the attribute that has the value of an input, through inputs of materials and graphs; None without."""
    value = shader.GetInput(name)
    found = value.GetValueProducingAttributes() if value else []
    return found[0] if found else None


def _input(shader: Any, name: str, width: int) -> tuple[Float[np.ndarray, " w"] | None, Any]:
    """Return the numbers of an input, or else the prim whose output feeds it; None for either if absent."""
    source = _source(shader, name)
    if source is None:
        return None, None
    if pxr("UsdShade").Output.IsOutput(source):
        return None, source.GetPrim()
    value = at_start(source)
    rows = as_rows(source, None if value is None else np.atleast_1d(value), width)
    return rows[0] if len(rows) else None, None


def _share(shader: Any, name: str, default: float) -> float:
    """Return the number of an input, from 0 to 1; the default if it is absent, or if an image feeds it."""
    value = _input(shader, name, 1)[0]
    return float(np.clip(np.nan_to_num(default if value is None else value[0]), 0, 1))


def _color(linear: Any) -> tuple[float, float, float]:
    """Return a linear colour as sRGB."""
    values = np.clip(np.nan_to_num(np.array(linear, float)), 0, 1)
    red, green, blue = np.round(encode_srgb(values), 6).tolist()
    return red, green, blue
