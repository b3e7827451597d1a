"""Visible prims of a USD stage as placed meshes: polygon meshes and simple solids, with their materials."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float, Int

from home_mjx.core.color import encode_srgb
from home_mjx.core.files import is_file
from home_mjx.core.images import open_texture
from home_mjx.datasets.gltf.decode.scene import PlacedMesh, SceneNode
from home_mjx.datasets.shapes import capsule_triangles, cone_triangles, cylinder_triangles, sphere_triangles
from home_mjx.datasets.suncg.formats.json_value import MAX_COORDINATE, Location, printable
from home_mjx.datasets.usd.joints import FIXED, KINDS, UsdJoint, read_joint, unit_of
from home_mjx.datasets.usd.layers import UsdScene, below, layer_unit, pxr
from home_mjx.errors import DatasetError
from home_mjx.geometry.meshes import Z_UP, box_triangles
from home_mjx.schema.house import Fallback, Material, Mesh
from home_mjx.schema.lighting import SurfaceMaps

MAX_PRIMS = 100_000  # maximum number of visited prims
MAX_DEPTH = 200  # maximum number of nested prims
MAX_CORNERS = 30_000_000  # maximum number of corners of faces of a mesh
MAX_EMISSION = 1000.0  # maximum emission, of a white display
MAP_INPUTS = ("emissiveColor", "normal", "occlusion")  # inputs of `UsdPreviewSurface` that images may feed
GREY = Material("default", (0.6, 0.6, 0.6), None, 1.0)
AXES = {"X": np.array([[0, 0, 1], [0, 1, 0], [-1, 0, 0]]), "Y": Z_UP.T, "Z": np.eye(3)}  # from z


@dataclass
class PrimReader:
    """Reader of the prims of a scene.

    Attributes:
        scene: The scene.
        fallbacks: Textures that materials do without.
        notes: Materials with their images that only exports use, and that are lost.
        places: House from prim of the prims that were read, by path; that of the world is "".
        lights: Prims that are lights, and house from prim.
    """

    scene: UsdScene
    fallbacks: list[Fallback] = field(default_factory=list)
    notes: dict[str, str] = field(default_factory=dict)
    places: dict[str, Float[np.ndarray, "4 4"]] = field(default_factory=dict)
    lights: list[tuple[Any, Float[np.ndarray, "4 4"]]] = field(default_factory=list)
    _joints: list[Any] = field(default_factory=list)
    _materials: dict[str, Material] = field(default_factory=dict)
    _checked: dict[Path, str] = field(default_factory=dict)

    @property
    def joints(self) -> list[UsdJoint]:
        """Joints of the prims that were read."""
        unit = unit_of(self.scene.frame)
        found = (read_joint(prim, self.places, unit) for prim in self._joints)
        return [joint for joint in found if joint is not None]

    def read(self) -> Iterator[PlacedMesh]:
        """Yield the visible meshes with the prims above them; instances are shown once each.

        Raises:
            DatasetError: A mesh is broken, or prims are too many or too deep.
        """
        root, self.places[""] = self.scene.stage.GetPseudoRoot(), self.scene.frame
        unit = layer_unit(self.scene.stage.GetRootLayer())
        stack = [(root, self.scene.frame, (), unit)]
        for _ in range(MAX_PRIMS):
            if not stack:
                return
            prim, above, chain, unit = stack.pop()
            if len(chain) > MAX_DEPTH:
                raise self._place(prim).error(f"prims are more than {MAX_DEPTH} levels deep")
            matrix, own_unit = self._matrix(prim, above, unit)
            node = SceneNode(printable(prim.GetName()[:100]), str(prim.GetPath()), matrix)
            chain = (*chain, node)
            self.places[node.element] = matrix
            if prim.GetTypeName() in (*KINDS, FIXED):
                self._joints.append(prim)
            if not self._is_shown(prim):
                continue
            has_volume = abs(np.linalg.det(matrix[:3, :3])) > 1e-15
            if has_volume and prim.HasAPI(pxr("UsdLux").LightAPI):
                self.lights.append((prim, matrix))
            mesh = self._mesh(prim) if has_volume else None
            if mesh is not None and len(mesh.faces):
                yield PlacedMesh(mesh, node.name, chain[1:], node.element)
            usd = pxr("Usd")
            children = list(prim.GetFilteredChildren(usd.TraverseInstanceProxies(usd.PrimDefaultPredicate)))
            stack += [(child, matrix, chain, own_unit) for child in reversed(children)]
        raise self._place(root).error(f"scene has more than {MAX_PRIMS} prims")

    def _place(self, prim: Any) -> Location:
        """Return the location of a prim."""
        return Location(self.scene.path, str(prim.GetPath()))

    def _is_shown(self, prim: Any) -> bool:
        """Return whether a prim and all below may be visible: neither hidden nor a guide or proxy."""
        geometry = pxr("UsdGeom")
        if not prim.IsA(geometry.Imageable):
            return True
        shape = geometry.Imageable(prim)
        hidden = shape.GetVisibilityAttr().Get() == geometry.Tokens.invisible
        return not hidden and shape.GetPurposeAttr().Get() not in (geometry.Tokens.guide, geometry.Tokens.proxy)

    def _matrix(
        self, prim: Any, above: Float[np.ndarray, "4 4"], unit: float
    ) -> tuple[Float[np.ndarray, "4 4"], float]:
        """Return house from prim, and the unit of its layer, to which referenced geometry is scaled."""
        geometry = pxr("UsdGeom")
        matrix = above
        if prim.IsA(geometry.Xformable):
            shape = geometry.Xformable(prim)
            local = np.array(shape.GetLocalTransformation(), float).T
            if not (abs(local) <= MAX_COORDINATE).all():
                raise self._place(prim).error("transform is not finite")
            matrix = (self.scene.frame if shape.GetResetXformStack() else above) @ local
        specs = prim.GetPrimStack()
        own = layer_unit(specs[-1].layer) if specs else unit
        if own != unit:  # USD does not convert the units of references
            matrix = matrix @ np.diag([own / unit, own / unit, own / unit, 1.0])
        return matrix, own

    def _mesh(self, prim: Any) -> Mesh | None:
        """Return the mesh of a prim; None for other kinds of prims."""
        geometry = pxr("UsdGeom")
        if prim.IsA(geometry.Mesh):
            return self._polygons(prim)
        solid = self._solid(prim)
        if solid is None:
            return None
        slot = np.zeros(len(solid), int)
        return self._joined(solid, np.zeros((len(solid), 3, 2)), slot, (self._material(prim),))

    def _solid(self, prim: Any) -> Float[np.ndarray, "t 3 3"] | None:
        """Return the triangles of a cube, sphere, cylinder, cone or capsule; None for other prims."""
        geometry = pxr("UsdGeom")
        if prim.IsA(geometry.Cube):
            return box_triangles(np.zeros(3), np.full(3, self._number(prim, "size") / 2))
        if prim.IsA(geometry.Sphere):
            return sphere_triangles(self._number(prim, "radius"))
        shapes = ((geometry.Cylinder, cylinder_triangles), (geometry.Cone, cone_triangles))
        for kind, shape in (*shapes, (geometry.Capsule, capsule_triangles)):
            if prim.IsA(kind):
                found = shape(self._number(prim, "radius"), self._number(prim, "height") / 2)
                return found @ AXES.get(str(prim.GetAttribute("axis").Get()), np.eye(3)).T
        return None

    def _number(self, prim: Any, name: str) -> float:
        """Return a positive number of a prim."""
        value = float(prim.GetAttribute(name).Get())
        if not 0 < value <= MAX_COORDINATE:
            raise self._place(prim).error(f"`{name}` is not a positive, finite number")
        return value

    def _polygons(self, prim: Any) -> Mesh | None:
        """Return a polygon mesh as triangles, the cage of subdivision surfaces; None without faces."""
        names = ("points", "faceVertexCounts", "faceVertexIndices")
        values = [prim.GetAttribute(name).Get() for name in names]
        points, counts, index = (np.array(v if v is not None else []) for v in values)
        points, counts, index = points.reshape(-1, 3).astype(float), counts.astype(int), index.astype(int)
        place = self._place(prim)
        if not len(counts):
            return None
        if not (abs(points) <= MAX_COORDINATE).all() or len(index) > MAX_CORNERS:
            raise place.error("points are not finite, or too many")
        if counts.min() < 0 or counts.sum() != len(index) or index.min(initial=0) < 0:
            raise place.error("counts of faces do not fit their indices")
        if index.max(initial=-1) >= len(points):
            raise place.error(f"expected indices of the {len(points)} points")
        corner = _fans(counts)
        if str(prim.GetAttribute("orientation").Get()) == "leftHanded":
            corner = corner[:, [0, 2, 1]]
        owner = np.repeat(np.arange(len(counts)), np.maximum(counts - 2, 0))
        slot, materials = self._slots(prim, len(counts))
        return self._joined(points[index[corner]], self._coordinates(prim, index, corner), slot[owner], materials)

    def _slots(self, prim: Any, count: int) -> tuple[Int[np.ndarray, " f"], tuple[Material, ...]]:
        """Return the slot of each face of a mesh, and its materials: its own, then those of its subsets."""
        slot, materials = np.zeros(count, int), [self._material(prim)]
        for subset in pxr("UsdShade").MaterialBindingAPI(prim).GetMaterialBindSubsets():
            rows = np.array(subset.GetIndicesAttr().Get() or [], int)
            if len(rows) and not 0 <= rows.min() <= rows.max() < count:
                raise self._place(subset.GetPrim()).error(f"expected indices of the {count} faces")
            slot[rows] = len(materials)
            materials.append(self._material(subset.GetPrim()))
        return slot, tuple(materials)

    def _coordinates(self, prim: Any, index: Int[np.ndarray, " c"], corner: Int[np.ndarray, "t 3"]) -> np.ndarray:
        """Return the texture coordinates of the corners of triangles; 0 without any."""
        geometry = pxr("UsdGeom")
        primvar = geometry.PrimvarsAPI(prim).FindPrimvarWithInheritance("st")
        found = primvar.ComputeFlattened() if primvar and primvar.HasValue() else None
        values = np.array(found, float).reshape(-1, 2) if found is not None else np.zeros((0, 2))
        rows = {"faceVarying": corner, "vertex": index[corner], "varying": index[corner]}
        chosen = rows.get(str(primvar.GetInterpolation())) if len(values) else None
        if chosen is None or chosen.max(initial=-1) >= len(values) or not np.isfinite(values).all():
            return np.zeros((len(corner), 3, 2))
        return values[chosen]

    def _joined(
        self,
        triangles: Float[np.ndarray, "t 3 3"],
        uv: Float[np.ndarray, "t 3 2"],
        slot: Int[np.ndarray, " t"],
        materials: tuple[Material, ...],
    ) -> Mesh:
        """Return triangles with their materials as a mesh."""
        count = len(triangles)
        return Mesh(
            path=self.scene.path,
            vertices=triangles.reshape(-1, 3),
            faces=np.arange(3 * count).reshape(-1, 3),
            uv=uv,
            slot=slot,
            group=np.full(count, -1),
            materials=materials,
        )

    def _material(self, prim: Any) -> Material:
        """Return the diffuse colour, opacity and texture of a prim's `UsdPreviewSurface`, else its display colour."""
        shade = pxr("UsdShade")
        bound = shade.MaterialBindingAPI(prim).ComputeBoundMaterial()[0]
        shader = bound.ComputeSurfaceSource()[0] if bound else None
        if not shader or shader.GetIdAttr().Get() != "UsdPreviewSurface":
            color = prim.GetAttribute("primvars:displayColor")
            shown = color.Get() if color else None
            return GREY if not shown else Material("display", _color(shown[0]), None, 1.0)
        key = str(bound.GetPath())
        if key not in self._materials:
            self._materials[key] = self._preview(shader, printable(bound.GetPrim().GetName()[:100]))
        return self._materials[key]

    def _preview(self, shader: Any, name: str) -> Material:
        """Return the material of a `UsdPreviewSurface`."""
        diffuse, opacity = shader.GetInput("diffuseColor"), shader.GetInput("opacity")
        source = diffuse.GetConnectedSource() if diffuse else None
        color = diffuse.Get() if diffuse and not source else None
        alpha = opacity.Get() if opacity and not opacity.HasConnectedSource() else None
        path = self._texture(source[0].GetPrim(), name) if source else None
        white = (1.0, 1.0, 1.0) if source else GREY.diffuse
        opaque = float(np.clip(alpha, 0, 1)) if alpha is not None else 1.0
        paint = _color(color) if color is not None else white
        return Material(name, paint, path, opaque, maps=self._maps(shader, name))

    def _maps(self, shader: Any, name: str) -> SurfaceMaps | None:
        """Return the emission, metallic part and images of a `UsdPreviewSurface`; None without any."""
        images: list[Path | None] = []
        for key in MAP_INPUTS:
            value = shader.GetInput(key)
            source = value.GetConnectedSource() if value else None
            images.append(self._map_image(key, source[0].GetPrim(), name) if source else None)
        emitted, metallic = (_stated(shader, key) for key in ("emissiveColor", "metallic"))
        light = np.clip(np.nan_to_num(np.array(emitted if emitted is not None else [0, 0, 0], float)), 0, MAX_EMISSION)
        light = np.ones(3) if images[0] is not None else light
        if not (any(images) or light.any() or metallic):
            return None
        roughness = _stated(shader, "roughness")
        return SurfaceMaps(
            emission=(float(light[0]), float(light[1]), float(light[2])),
            metallic=float(np.clip(metallic or 0.0, 0, 1)),
            roughness=float(np.clip(0.5 if roughness is None else roughness, 0, 1)),
            images=(images[0], images[1], None, images[2]),
        )

    def _map_image(self, key: str, prim: Any, name: str) -> Path | None:
        """Return the image of a map; None, with a note if only exports use it, else a fallback, if it is lost."""
        if key == "emissiveColor":
            return self._texture(prim, name, "no emission")
        _, path, reason = self._image(prim)
        if reason:
            self.notes[f"{prim.GetPath()}"] = f"{key} of `{name}` is not kept: {reason}"
        return None if reason else path

    def _texture(self, prim: Any, name: str, replacement: str = "the material's colour") -> Path | None:
        """Return the image of a `UsdUVTexture`; None, with a fallback, if it is missing or broken."""
        text, path, reason = self._image(prim)
        if reason:
            self.fallbacks.append(Fallback("texture", text[:100] or name, name, replacement, reason))
        return None if reason else path

    def _image(self, prim: Any) -> tuple[str, Path | None, str]:
        """Return the name of the image of a `UsdUVTexture`, its path, and the reason why it is lost, else ""."""
        value = pxr("UsdShade").Shader(prim).GetInput("file")
        text = str(value.Get().path) if value and value.Get() else ""
        path = below(self.scene.root, self.scene.path, text) if text else None
        if path is None or not is_file(path) or path.suffix.lower() not in (".png", ".jpg", ".jpeg"):
            return text, None, "image is missing, or neither PNG nor JPEG"
        if path not in self._checked:
            self._checked[path] = _fault(path)
        return text, path, self._checked[path]


def _fault(path: Path) -> str:
    """Return the reason why an image cannot be decoded; "" if it can."""
    try:
        open_texture(path)
    except DatasetError as error:
        return error.message
    return ""


def _stated(shader: Any, name: str) -> Any:
    """Return the value of an input of a shader; None if it is absent or connected."""
    value = shader.GetInput(name)
    return value.Get() if value and not value.HasConnectedSource() else None


def _fans(counts: Int[np.ndarray, " f"]) -> Int[np.ndarray, "t 3"]:
    """Return the corners, among all corners of faces, of the fan of triangles of each face."""
    first = np.concatenate([[0], np.cumsum(counts)[:-1]])
    sides = np.maximum(counts - 2, 0)
    face = np.repeat(np.arange(len(counts)), sides)
    step = np.arange(len(face)) - np.repeat(np.cumsum(sides) - sides, sides)
    return first[face][:, None] + np.stack([0 * step, step + 1, step + 2], axis=1)


def _color(linear: Any) -> tuple[float, float, float]:
    """Return a linear colour as sRGB."""
    values = np.clip(np.nan_to_num(np.array(linear, float)), 0, 1)
    red, green, blue = np.round(encode_srgb(values), 6).tolist()
    return red, green, blue
