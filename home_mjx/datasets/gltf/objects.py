"""Objects of a scene: nodes whose names tell a category; all other meshes are architecture."""

import hashlib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from jaxtyping import Float

from home_mjx.datasets.gltf.categories import ARCHITECTURE, find_category
from home_mjx.datasets.gltf.decode.scene import PlacedMesh, SceneNode
from home_mjx.schema.house import Joint, Mesh

MIN_UPRIGHT = 0.999  # minimum vertical component of the unit axis of a node that points up
MAX_OBJECT_SIZE = 6.0  # [m], maximum extent of an object; larger ones are architecture


@dataclass
class FoundObject:
    """One object: a node with a category, and the meshes below it.

    Attributes:
        node: The node.
        fine: Its fine category.
        meshes: Meshes below the node.
        extra: Empty.
    """

    node: SceneNode
    fine: str
    meshes: list[PlacedMesh] = field(default_factory=list)
    extra: Mapping[str, Any] = field(default_factory=dict)

    @property
    def joints(self) -> tuple[Joint, ...]:
        """Movable parts of its mesh; empty, see `JointedObject`."""
        return ()

    @property
    def matrix(self) -> np.ndarray:
        """House from object: that of its node, with the y axis up where the node has another one up."""
        return upright(self.node.matrix)

    @property
    def points(self) -> np.ndarray:
        """Vertices in the house [m], (v, 3)."""
        return np.concatenate([m.mesh.vertices @ m.matrix[:3, :3].T + m.matrix[:3, 3] for m in self.meshes])

    def mesh(self) -> Mesh:
        """Return the meshes joined in the object's frame; normals are dropped unless all meshes have them."""
        back = np.linalg.inv(self.matrix)
        return join_meshes([move_mesh(m.mesh, back @ m.matrix) for m in self.meshes])

    @property
    def key(self) -> str:
        """Name of the joined mesh, equal for copies: a digest of its parts and their places."""
        back = np.linalg.inv(self.matrix)
        places = [(m.source, np.round(back @ m.matrix, 6).tolist()) for m in self.meshes]
        return f"{self.fine}_{hashlib.sha256(repr(places).encode()).hexdigest()[:12]}"


@dataclass(frozen=True)
class MeshObject:
    """An object with one mesh.

    Attributes:
        fine: Fine category.
        key: Name of its mesh, equal for copies.
        matrix: House from mesh.
        body: Its mesh.
        joints: Movable parts.
        extra: Name, the dataset's word for its category, and further entries of the file.
    """

    fine: str
    key: str
    matrix: Float[np.ndarray, "4 4"]
    body: Mesh
    joints: tuple[Joint, ...] = ()
    extra: Mapping[str, Any] = field(default_factory=dict)

    @property
    def points(self) -> Float[np.ndarray, "p 3"]:
        """Vertices in the house [m]."""
        return self.body.vertices @ self.matrix[:3, :3].T + self.matrix[:3, 3]

    def mesh(self) -> Mesh:
        """Return its mesh."""
        return self.body


def split_objects(
    placed: Iterable[PlacedMesh], stated: Mapping[str, str]
) -> tuple[list[FoundObject], list[PlacedMesh]]:
    """Return the objects of a scene, and the meshes of its architecture.

    The node nearest to a mesh that has a category decides. Objects over `MAX_OBJECT_SIZE` are architecture.

    Args:
        placed: Meshes of the scene.
        stated: Fine category by name of a node or mesh, which names take precedence over words.
    """
    found: dict[str, FoundObject] = {}
    architecture = []
    for item in placed:
        node, fine = _category(item, stated)
        if not fine or fine in ARCHITECTURE:
            architecture.append(item)
        else:
            found.setdefault(node.element + repr(node.matrix.tolist()), FoundObject(node, fine)).meshes.append(item)
    large = [o for o in found.values() if np.ptp(o.points, axis=0).max() > MAX_OBJECT_SIZE]
    architecture += [mesh for one in large for mesh in one.meshes]
    return [one for one in found.values() if not any(one is other for other in large)], architecture


def upright(matrix: np.ndarray) -> np.ndarray:
    """Return a transform after a turn by which its y axis points up; unchanged if no axis points up or down.

    Example:
        >>> upright(np.array([[1.0, 0, 0, 5], [0, 0, 1, 6], [0, -1, 0, 7], [0, 0, 0, 1]])).tolist()
        [[1.0, 0.0, 0.0, 5.0], [0.0, 1.0, 0.0, 6.0], [0.0, 0.0, 1.0, 7.0], [0.0, 0.0, 0.0, 1.0]]
    """
    up = matrix[1, :3] / np.maximum(np.linalg.norm(matrix[:3, :3], axis=0), 1e-12)
    axis = int(abs(up).argmax())
    if abs(up[axis]) < MIN_UPRIGHT or (axis == 1 and up[1] > 0):
        return matrix
    turn = np.eye(4)
    turn[:3, 1] = np.sign(up[axis]) * np.eye(3)[axis]
    turn[:3, 0] = np.eye(3)[1 if axis == 0 else 0]
    turn[:3, 2] = np.cross(turn[:3, 0], turn[:3, 1])
    return matrix @ turn + 0.0


def _category(item: PlacedMesh, stated: Mapping[str, str]) -> tuple[SceneNode, str]:
    """Return the node that tells a mesh's category, and the fine category; "" if none does."""
    for node in reversed(item.chain):
        names = (node.name, item.name) if node is item.chain[-1] else (node.name,)
        for name in names:
            fine = stated.get(name) or find_category(name)
            if fine:
                return node, fine
    return item.chain[-1], ""


def move_mesh(mesh: Mesh, matrix: np.ndarray) -> Mesh:
    """Return a mesh in another frame, wound outwards and with unit normals."""
    if np.allclose(matrix, np.eye(4), rtol=0, atol=1e-9):
        return mesh
    linear = matrix[:3, :3]
    order = [0, 2, 1] if np.linalg.det(linear) < 0 else [0, 1, 2]
    normal = None if mesh.normal is None else mesh.normal[:, order] @ np.linalg.inv(linear)
    if normal is not None:
        normal = normal / np.maximum(np.linalg.norm(normal, axis=-1, keepdims=True), 1e-12)
    vertices = mesh.vertices @ linear.T + matrix[:3, 3]
    return replace(
        mesh,
        vertices=vertices,
        faces=mesh.faces[:, order],
        uv=mesh.uv[:, order],
        normal=normal,
    )


def join_meshes(meshes: list[Mesh]) -> Mesh:
    """Return at least one mesh joined to one, with the slots of each in order."""
    if len(meshes) == 1:
        return meshes[0]
    vertices = np.cumsum([0, *(len(m.vertices) for m in meshes)])
    slots = np.cumsum([0, *(len(m.materials) for m in meshes)])
    normals = [m.normal for m in meshes if m.normal is not None]
    return Mesh(
        path=meshes[0].path,
        vertices=np.concatenate([m.vertices for m in meshes]),
        faces=np.concatenate([m.faces + start for m, start in zip(meshes, vertices, strict=False)]),
        uv=np.concatenate([m.uv for m in meshes]),
        slot=np.concatenate([m.slot + start for m, start in zip(meshes, slots, strict=False)]),
        group=np.concatenate([m.group for m in meshes]),
        materials=tuple(material for m in meshes for material in m.materials),
        normal=np.concatenate(normals) if len(normals) == len(meshes) else None,
    )
