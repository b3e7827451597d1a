"""Visible prims of a USD stage as placed meshes: polygon meshes and simple solids, with their materials."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from jaxtyping import Float, Int

from home_mjx.datasets.gltf.decode.scene import PlacedMesh, SceneNode
from home_mjx.datasets.shapes import capsule_triangles, cone_triangles, cylinder_triangles, sphere_triangles
from home_mjx.datasets.suncg.formats.json_value import MAX_COORDINATE, Location, printable
from home_mjx.datasets.usd.joints import FIXED, KINDS, UsdJoint, read_joint, unit_of
from home_mjx.datasets.usd.layers import UsdScene, as_rows, at_start, layer_unit, located_errors, pxr, start
from home_mjx.datasets.usd.materials import UsdMaterials, split_display_colors
from home_mjx.geometry.meshes import Z_UP, box_triangles
from home_mjx.schema.house import Material, Mesh

MAX_PRIMS = 100_000  # maximum number of visited prims
MAX_DEPTH = 200  # maximum number of nested prims
MAX_CORNERS = 30_000_000  # maximum number of corners of faces of a mesh
MAX_SHOWN = 30_000_000  # maximum number of triangles, those of each instance counted
AXES = {"X": np.array([[0, 0, 1], [0, 1, 0], [-1, 0, 0]]), "Y": Z_UP.T, "Z": np.eye(3)}  # from z
PLANES = {"X": (2, 1), "Y": (0, 2), "Z": (0, 1)}  # axes of the width and length of a plane with this normal


@dataclass
class PrimReader:
    """Reader of the prims of a scene.

    Attributes:
        scene: The scene.
        materials: Reader of their materials.
        places: House from prim of the prims that were read, by path; that of the world is "".
        lights: Prims that are lights, and house from prim.
    """

    scene: UsdScene
    materials: UsdMaterials = field(init=False)
    places: dict[str, Float[np.ndarray, "4 4"]] = field(default_factory=dict)
    lights: list[tuple[Any, Float[np.ndarray, "4 4"]]] = field(default_factory=list)
    _joints: list[Any] = field(default_factory=list)
    _meshes: dict[str, Mesh | None] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.materials = UsdMaterials(self.scene)

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
        stack, shown = [(root, self.scene.frame, (), unit)], 0
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
                shown += len(mesh.faces)
                if shown > MAX_SHOWN:
                    raise self._place(root).error(f"scene shows more than {MAX_SHOWN} triangles", "Remove instances.")
                yield PlacedMesh(mesh, node.name, chain[1:], node.element)
            stack += [(*below, own_unit) for below in self._below(prim, matrix, chain)]
        raise self._place(root).error(f"scene has more than {MAX_PRIMS} prims")

    def _below(
        self, prim: Any, matrix: Float[np.ndarray, "4 4"], chain: tuple[SceneNode, ...]
    ) -> Iterator[tuple[Any, Float[np.ndarray, "4 4"], tuple[SceneNode, ...]]]:
        """Yield the prims below one, the last first, each with house from its parent, and the nodes above."""
        usd, geometry = pxr("Usd"), pxr("UsdGeom")
        if prim.IsA(geometry.PointInstancer):
            yield from self._instances(geometry.PointInstancer(prim), matrix, chain)
            return
        children = prim.GetFilteredChildren(usd.TraverseInstanceProxies(usd.PrimDefaultPredicate))
        yield from ((child, matrix, chain) for child in reversed(list(children)))

    def _instances(
        self, instancer: Any, matrix: Float[np.ndarray, "4 4"], chain: tuple[SceneNode, ...]
    ) -> Iterator[tuple[Any, Float[np.ndarray, "4 4"], tuple[SceneNode, ...]]]:
        """Yield the prototype of each visible instance of a point instancer."""
        with located_errors(self.scene.path, str(instancer.GetPath())):
            paths = instancer.GetPrototypesRel().GetForwardedTargets()
        rows = at_start(instancer.GetProtoIndicesAttr()) or []
        prims = [self.scene.stage.GetPrimAtPath(path) for path in paths]
        time, geometry, place = start(), pxr("UsdGeom").PointInstancer, self._place(instancer.GetPrim())
        mask = instancer.ComputeMaskAtTime(time) or [True] * len(rows)
        poses = instancer.ComputeInstanceTransformsAtTime(time, time, geometry.ExcludeProtoXform, geometry.IgnoreMask)
        if len(poses) != len(rows) or not all(0 <= row < len(prims) and prims[row] for row in rows):
            raise place.error("instances do not fit their positions and prototypes")
        if len(rows) > MAX_PRIMS:
            raise place.error(f"scene has more than {MAX_PRIMS} prims")
        for number in reversed(range(len(rows))):
            pose = matrix @ np.array(poses[number], float).T
            if mask[number] and (abs(pose) <= MAX_COORDINATE).all():
                node = SceneNode(f"{chain[-1].name}_{number}", f"{place.element}[{number}]", pose)
                yield prims[rows[number]], pose, (*chain, node)

    def _place(self, prim: Any) -> Location:
        """Return the location of a prim."""
        return Location(self.scene.path, str(prim.GetPath()))

    def _is_shown(self, prim: Any) -> bool:
        """Return whether a prim and all below may be visible: neither hidden nor a guide or proxy."""
        geometry = pxr("UsdGeom")
        if not prim.IsA(geometry.Imageable):
            return True
        shape = geometry.Imageable(prim)
        hidden = at_start(shape.GetVisibilityAttr()) == geometry.Tokens.invisible
        return not hidden and at_start(shape.GetPurposeAttr()) not in (geometry.Tokens.guide, geometry.Tokens.proxy)

    def _matrix(
        self, prim: Any, above: Float[np.ndarray, "4 4"], unit: float
    ) -> tuple[Float[np.ndarray, "4 4"], float]:
        """Return house from prim, and the unit of its layer, to which referenced geometry is scaled."""
        geometry = pxr("UsdGeom")
        matrix = above
        if prim.IsA(geometry.Xformable):
            shape = geometry.Xformable(prim)
            with located_errors(self.scene.path, str(prim.GetPath())):
                local = np.array(shape.GetLocalTransformation(start()), float).T
            if not (abs(local) <= MAX_COORDINATE).all():
                raise self._place(prim).error("transform is not finite")
            matrix = (self.scene.frame if shape.GetResetXformStack() else above) @ local
        specs = prim.GetPrimStack()
        own = layer_unit(specs[-1].layer) if specs else unit
        if own != unit:  # USD does not convert the units of references
            matrix = matrix @ np.diag([own / unit, own / unit, own / unit, 1.0])
        return matrix, own

    def _mesh(self, prim: Any) -> Mesh | None:
        """Return the mesh of a prim, read once for all instances; None for other kinds of prims."""
        key = str(prim.GetPath())
        if key not in self._meshes:
            with located_errors(self.scene.path, key):
                self._meshes[key] = self._read_mesh(prim)
        return self._meshes[key]

    def _read_mesh(self, prim: Any) -> Mesh | None:
        """Return the mesh of a prim; None for other kinds of prims."""
        geometry = pxr("UsdGeom")
        if prim.IsA(geometry.Mesh):
            return self._polygons(prim)
        solid = self._solid(prim)
        if solid is None:
            if prim.IsA(geometry.Gprim):
                self.materials.notes[str(prim.GetPath())] = f"{prim.GetTypeName()} is not shown"
            return None
        slot = np.zeros(len(solid), int)
        return self._joined(solid, np.zeros((len(solid), 3, 2)), slot, (self.materials.material(prim),))

    def _solid(self, prim: Any) -> Float[np.ndarray, "t 3 3"] | None:
        """Return the triangles of a cube, sphere, cylinder, cone or capsule; None for other prims."""
        geometry = pxr("UsdGeom")
        if prim.IsA(geometry.Cube):
            return box_triangles(np.zeros(3), np.full(3, self._number(prim, "size") / 2))
        if prim.IsA(geometry.Sphere):
            return sphere_triangles(self._number(prim, "radius"))
        if prim.IsA(geometry.Plane):
            return self._plane(prim)
        shapes = ((geometry.Cylinder, cylinder_triangles), (geometry.Cone, cone_triangles))
        for kind, shape in (*shapes, (geometry.Capsule, capsule_triangles)):
            if prim.IsA(kind):
                found = shape(self._number(prim, "radius"), self._number(prim, "height") / 2)
                return found @ AXES.get(str(at_start(prim.GetAttribute("axis"))), np.eye(3)).T
        return None

    def _plane(self, prim: Any) -> Float[np.ndarray, "2 3 3"]:
        """Return a plane around the origin; its width is along x, on the axis X along z, its length along the third."""
        width, length = (self._number(prim, name) / 2 for name in ("width", "length"))
        axis = str(at_start(prim.GetAttribute("axis")))
        across, along = PLANES.get(axis, PLANES["Z"])
        first, second = np.eye(3)[across] * width, np.eye(3)[along] * length
        first, second = (first, second) if axis == "Z" else (second, first)  # wound around the axis
        corners = np.stack([-first - second, first - second, first + second, second - first])
        return corners[[[0, 1, 2], [0, 2, 3]]]

    def _number(self, prim: Any, name: str) -> float:
        """Return a positive number of a prim."""
        value = at_start(prim.GetAttribute(name))
        if value is None or not 0 < value <= MAX_COORDINATE:
            raise self._place(prim).error(f"`{name}` is not a positive, finite number")
        return float(value)

    def _polygons(self, prim: Any) -> Mesh | None:
        """Return a polygon mesh as triangles, the cage of subdivision surfaces; None without faces."""
        names = ("points", "faceVertexCounts", "faceVertexIndices")
        values = [at_start(prim.GetAttribute(name)) for name in names]
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
        if str(at_start(prim.GetAttribute("orientation"))) == "leftHanded":
            corner = corner[:, [0, 2, 1]]
        owner = np.repeat(np.arange(len(counts)), np.maximum(counts - 2, 0))
        is_whole = ~np.isin(owner, np.array(at_start(prim.GetAttribute("holeIndices")) or [], int))
        corner, owner = corner[is_whole], owner[is_whole]
        slot, materials = self._slots(prim, len(counts))
        slot, materials = split_display_colors(prim, slot[owner], materials, owner, corner, index)
        return self._joined(points[index[corner]], self._coordinates(prim, index, corner), slot, materials)

    def _slots(self, prim: Any, count: int) -> tuple[Int[np.ndarray, " f"], tuple[Material, ...]]:
        """Return the slot of each face of a mesh, and its materials: its own, then those of its subsets."""
        slot, materials = np.zeros(count, int), [self.materials.material(prim)]
        for subset in pxr("UsdShade").MaterialBindingAPI(prim).GetMaterialBindSubsets():
            rows = np.array(at_start(subset.GetIndicesAttr()) or [], int)
            if len(rows) and not 0 <= rows.min() <= rows.max() < count:
                raise self._place(subset.GetPrim()).error(f"expected indices of the {count} faces")
            slot[rows] = len(materials)
            materials.append(self.materials.material(subset.GetPrim()))
        return slot, tuple(materials)

    def _coordinates(self, prim: Any, index: Int[np.ndarray, " c"], corner: Int[np.ndarray, "t 3"]) -> np.ndarray:
        """Return the texture coordinates of the corners of triangles; 0 without any."""
        geometry = pxr("UsdGeom")
        interface = geometry.PrimvarsAPI(prim)
        others = (p for p in interface.FindPrimvarsWithInheritance() if str(p.GetTypeName()) == "texCoord2f[]")
        primvar: Any = interface.FindPrimvarWithInheritance("st") or next(others, None)
        found = primvar.ComputeFlattened(start()) if primvar and primvar.HasValue() else None
        values = as_rows(primvar.GetAttr(), found, 2) if primvar else np.zeros((0, 2))
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


def _fans(counts: Int[np.ndarray, " f"]) -> Int[np.ndarray, "t 3"]:
    """Return the corners, among all corners of faces, of the fan of triangles of each face."""
    first = np.concatenate([[0], np.cumsum(counts)[:-1]])
    sides = np.maximum(counts - 2, 0)
    face = np.repeat(np.arange(len(counts)), sides)
    step = np.arange(len(face)) - np.repeat(np.cumsum(sides) - sides, sides)
    return first[face][:, None] + np.stack([0 * step, step + 1, step + 2], axis=1)
