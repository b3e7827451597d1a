"""Objects of an MJCF scene: bodies at its root with all that hangs on them; walls and floors are architecture."""

import hashlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from jaxtyping import Float, Int

from home_mjx.datasets.gltf.categories import ARCHITECTURE
from home_mjx.datasets.gltf.layout.triangle_set import TriangleSet
from home_mjx.datasets.gltf.objects import MAX_OBJECT_SIZE
from home_mjx.datasets.mjcf.categories import body_category, is_backing
from home_mjx.datasets.mjcf.joints import PartFinder
from home_mjx.datasets.mjcf.materials import MjcfMaterials
from home_mjx.datasets.mjcf.model import LEVEL_LINEAR, MjcfScene
from home_mjx.datasets.mjcf.shapes import geom_triangles
from home_mjx.datasets.taxonomy import UNKNOWN
from home_mjx.schema.house import Joint, Mesh

EXPORTED_ARCHITECTURE = "architecture"  # body of all walls, floors and ceilings in the package's own export
SHELL = ("wall", "floor", "ceiling")  # categories that are architecture even where a room file states them
LEAF = "_leaf"  # door leaves of the package's own export are bodies `<door>_leaf<i>` beside their doors
PLANE_MARGIN = 1.0  # [m], of infinite planes around all other geoms
MAX_PLANE_REACH = 100.0  # [m]


def _extent(triangles: TriangleSet) -> float:
    """Return the largest extent of triangles along an axis [m]; 0 without triangles."""
    points = triangles.corners.reshape(-1, 3)
    return float(np.ptp(points, axis=0).max()) if len(points) else 0.0


@dataclass(frozen=True)
class MjcfObject:
    """One object: a root body with the geoms on it and below.

    Attributes:
        name: Name of the root body.
        fine: Fine category.
        matrix: House from object, both Y up.
        triangles: Triangles in the house.
        bodies: Body of each triangle.
        finder: Finder of its movable parts.
        extra: Name, mass and whether it floats on a free joint.
    """

    name: str
    fine: str
    matrix: Float[np.ndarray, "4 4"]
    triangles: TriangleSet
    bodies: Int[np.ndarray, " t"]
    finder: PartFinder
    extra: Mapping[str, Any]

    @property
    def points(self) -> Float[np.ndarray, "p 3"]:
        """Corners of its triangles in the house [m]."""
        return self.triangles.corners.reshape(-1, 3)

    @cached_property
    def own(self) -> TriangleSet:
        """Its triangles in its own frame."""
        return replace(self.triangles, corners=(self.triangles.corners - self.matrix[:3, 3]) @ self.matrix[:3, :3])

    @property
    def key(self) -> str:
        """Name of its mesh, equal for copies: a digest of its triangles and looks."""
        return self._key

    @cached_property
    def _key(self) -> str:
        """The digest, computed once."""
        look = [self.own.materials[slot] for slot in np.unique(self.own.slot)]
        arrays = np.round(self.own.corners, 5) + 0.0, np.round(self.own.uv, 5) + 0.0
        digest = hashlib.sha256(repr(look).encode() + b"".join(a.tobytes() for a in arrays))
        return f"{self.fine}_{digest.hexdigest()[:12]}"

    @property
    def joints(self) -> tuple[Joint, ...]:
        """Its movable parts."""
        return self._joints

    @cached_property
    def _joints(self) -> tuple[Joint, ...]:
        """The parts, found once."""
        return self.finder.parts(self.fine)

    def mesh(self) -> Mesh:
        """Return its mesh in its own frame."""
        return self.own.mesh(self.finder.scene.path)


@dataclass
class ObjectReader:
    """Reader of the objects of a scene.

    Attributes:
        scene: The scene.
        table: Its materials.
        stated: Fine category by name of a body or geom, which takes precedence over words.
        words: MolmoSpaces' words by name of a body.
        dropped: Bodies that are not read, with their reasons.
    """

    scene: MjcfScene
    table: MjcfMaterials
    stated: Mapping[str, str]
    words: Mapping[str, str]
    dropped: dict[str, str] = field(default_factory=dict)

    def read(self) -> tuple[list[MjcfObject], TriangleSet]:
        """Return the objects, and the triangles of the architecture in the house."""
        objects, walls = [], [self.scene.geoms([0])]
        for bodies in self._groups():
            found = self._object(bodies)
            if found is None:
                walls.append(self.scene.geoms(bodies))
            elif len(found.bodies):
                objects.append(found)
        architecture, _ = self._triangles(np.concatenate(walls))
        materials = self.table.materials  # complete now
        return [replace(o, triangles=replace(o.triangles, materials=materials)) for o in objects], architecture

    def _groups(self) -> Iterator[list[int]]:
        """Yield the bodies of each object: a root body with all below it, and the leaves of its door."""
        names = {body: self.scene.model.body(body).name for body in self._roots(0)}
        by_name = {name: body for body, name in names.items()}
        leaves: dict[int, list[int]] = {}
        for body, name in names.items():
            owner = by_name.get(name.partition(LEAF)[0], body) if LEAF in name else body
            leaves.setdefault(owner, []).append(body)
        for owner, members in leaves.items():
            if is_backing(names[owner]):
                self.dropped[f"body[{names[owner]}]"] = "second layer of a wall or floor: left out"
            else:
                yield [body for member in members for body in self.scene.subtree(member)]

    def _roots(self, body: int) -> Iterator[int]:
        """Yield the root bodies below a body; bodies that only group others are replaced by these."""
        for child in self.scene.children[body]:
            inner = self.scene.children[child]
            owns = len(self.scene.geoms([child])) or self.scene.model.body_jntnum[child]
            if len(inner) > 1 and not owns and not self._category(child):
                yield from self._roots(child)
            else:
                yield child

    def _category(self, body: int) -> str:
        """Return the fine category of a body; "" if it is unknown."""
        name = self.scene.model.body(body).name
        return self.stated.get(name) or body_category(name, self.words.get(name, ""))

    def _object(self, bodies: list[int]) -> MjcfObject | None:
        """Return the object of some bodies; None if it is architecture, by its category or its size."""
        fine = self._category(bodies[0])
        model, name = self.scene.model, self.scene.model.body(bodies[0]).name
        is_stated = name in self.stated
        if name == EXPORTED_ARCHITECTURE or fine in (SHELL if is_stated else ARCHITECTURE):
            return None
        triangles, owner = self._triangles(self.scene.geoms(bodies))
        if not is_stated and _extent(triangles) > MAX_OBJECT_SIZE:
            return None
        matrix = self.scene.matrix(bodies[0])
        finder = PartFinder(self.scene, bodies, owner, np.linalg.inv(matrix))
        extra = {"name": name, "mass": float(model.body_subtreemass[bodies[0]]), "free": finder.is_free()}
        if name in self.words:
            extra["category"] = self.words[name]
        return MjcfObject(name, fine or UNKNOWN, matrix, triangles, owner, finder, extra)

    def _triangles(self, geoms: Int[np.ndarray, " n"]) -> tuple[TriangleSet, Int[np.ndarray, " t"]]:
        """Return the triangles of geoms in the house, and the body of each."""
        parts = [self._placed(geom) for geom in geoms.tolist()]
        corners = np.concatenate([np.zeros((0, 3, 3)), *(corners for corners, _ in parts)])
        uv = np.concatenate([np.zeros((0, 3, 2)), *(uv for _, uv in parts)])
        counts = [len(corners) for corners, _ in parts]
        slot = np.repeat(np.array([self.table.slot(geom) for geom in geoms.tolist()], int), counts)
        body = np.repeat(self.scene.model.geom_bodyid[geoms].astype(int), counts)
        return TriangleSet(corners, uv, slot, self.table.materials), body

    def _placed(self, geom: int) -> tuple[Float[np.ndarray, "t 3 3"], Float[np.ndarray, "t 3 2"]]:
        """Return the triangles of a geom in the house, and their texture coordinates."""
        triangles = geom_triangles(self.scene, geom, self._reach(geom))
        data = self.scene.data
        world = triangles @ data.geom_xmat[geom].reshape(3, 3).T + data.geom_xpos[geom]
        return world @ LEVEL_LINEAR.T, self.table.coordinates(geom, triangles)

    def _reach(self, geom: int) -> float:
        """Return half the edge of an infinite plane [m]: beyond all other geoms."""
        away = np.linalg.norm(self._middles - self.scene.data.geom_xpos[geom], axis=1) + self._radii
        return min(float(away.max(initial=0)) + PLANE_MARGIN, MAX_PLANE_REACH)

    @cached_property
    def _solid(self) -> Int[np.ndarray, " n"]:
        """Visible geoms with a finite size."""
        return np.flatnonzero(self.scene.shown & (self.scene.model.geom_rbound > 0))

    @property
    def _middles(self) -> Float[np.ndarray, "n 3"]:
        """Positions of these geoms [m], Z up."""
        return self.scene.data.geom_xpos[self._solid]

    @property
    def _radii(self) -> Float[np.ndarray, " n"]:
        """Radii of spheres around these geoms [m]."""
        return self.scene.model.geom_rbound[self._solid]
