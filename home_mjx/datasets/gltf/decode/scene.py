"""Scene graph of a glTF document: meshes with their transforms, in metres and Y up."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from jaxtyping import Float

from home_mjx.datasets.gltf.decode.container import GltfDocument
from home_mjx.datasets.gltf.decode.instancing import read_instances
from home_mjx.datasets.gltf.decode.primitives import MeshReader
from home_mjx.datasets.suncg.formats.json_value import MAX_COORDINATE, JsonValue, printable
from home_mjx.geometry.rotations import quat_matrix
from home_mjx.schema.house import Mesh

MAX_NODES = 100_000  # maximum number of visited nodes
MAX_DEPTH = 500  # maximum number of nested nodes
MAX_SHOWN = 30_000_000  # maximum number of triangles, those of each instance counted
Matrix = Float[np.ndarray, "4 4"]


@dataclass(frozen=True)
class SceneNode:
    """A node on the way from the scene's root to a mesh.

    Attributes:
        name: Its name; "" without one.
        element: Its element path.
        matrix: House from node.
        extras: Its application-specific data as in the file, of any type.
    """

    name: str
    element: str
    matrix: Matrix
    extras: Any = None


@dataclass(frozen=True)
class PlacedMesh:
    """A mesh at a node.

    Attributes:
        mesh: The mesh in its own frame.
        name: Its name; "" without one.
        chain: Nodes from the root to that of the mesh.
        source: Element path of the mesh; instances of a mesh have the same.
    """

    mesh: Mesh
    name: str
    chain: tuple[SceneNode, ...]
    source: str = ""

    @property
    def matrix(self) -> Matrix:
        """House from mesh."""
        return self.chain[-1].matrix


def place_meshes(document: GltfDocument, meshes: MeshReader, frame: Matrix) -> Iterator[PlacedMesh]:
    """Yield the meshes of the default scene in depth-first order; nodes below several parents are shown once each.

    Nodes with a transform without volume are left out, with a note in `meshes.notes`.

    Args:
        document: The document.
        meshes: Reader of its meshes.
        frame: House from the document's frame.

    Raises:
        DatasetError: An index, a transform or a mesh is invalid, nodes are their own ancestors, or nodes or triangles
            are too many.
    """
    count = 0
    for placed in _walk(document, meshes, frame):
        count += len(placed.mesh.faces)
        if count > MAX_SHOWN:
            raise document.root.error(f"scene shows more than {MAX_SHOWN} triangles", "Remove instances.")
        yield placed


def _walk(document: GltfDocument, meshes: MeshReader, frame: Matrix) -> Iterator[PlacedMesh]:
    """Yield the meshes of the default scene; arguments and errors as of `place_meshes`."""
    stack = [(node, (), (SceneNode("", "", frame),)) for node in reversed(_roots(document))]
    for _ in range(MAX_NODES):
        if not stack:
            return
        index, ancestors, chain = stack.pop()
        value, number = document.item("nodes", index), index.integer()
        if number in ancestors or len(ancestors) >= MAX_DEPTH:
            raise index.error(f"node {number} is its own ancestor, or more than {MAX_DEPTH} levels deep")
        matrix = chain[-1].matrix @ _matrix(value)
        if not _is_usable(matrix):
            meshes.notes[value.element] = "transform without volume, or beyond all limits: node left out"
            continue
        if _is_hidden(value):
            meshes.notes[value.element] = "node is not visible: left out"
            continue
        chain = (*chain, SceneNode(_name(value), value.element, matrix, value.member("extras").data))
        children = value.member("children")
        if children.has_value:
            stack += [(child, (*ancestors, number), chain) for child in reversed(children.entries())]
        yield from _placed(document, meshes, value, chain)
    raise document.root.error(f"scene has more than {MAX_NODES} nodes", "Join its meshes.")


def _placed(
    document: GltfDocument, meshes: MeshReader, value: JsonValue, chain: tuple[SceneNode, ...]
) -> Iterator[PlacedMesh]:
    """Yield the mesh of a node, if it has one with triangles, once for each of its instances."""
    index = value.member("mesh")
    if not index.has_value:
        return
    if value.member("skin").has_value:
        meshes.notes[value.element] = "skin is not applied"
    mesh = meshes.mesh(index)
    if mesh is not None and len(mesh.faces):
        found = document.item("meshes", index)
        for matrix in read_instances(document, value):
            node = replace(chain[-1], matrix=chain[-1].matrix @ matrix)
            if _is_usable(node.matrix):
                yield PlacedMesh(mesh, _name(found), (*chain[1:-1], node), found.element)
            else:
                meshes.notes[value.element] = "instances without volume, or beyond all limits, are left out"


def _is_usable(matrix: Matrix) -> bool:
    """Return whether a transform has a volume and moves nothing beyond all limits."""
    return bool(abs(np.linalg.det(matrix[:3, :3])) > 1e-15 and abs(matrix).max() <= MAX_COORDINATE)


def _is_hidden(value: JsonValue) -> bool:
    """Return whether a node and all below it are hidden by `KHR_node_visibility`."""
    extensions = value.member("extensions")
    shown = extensions.member("KHR_node_visibility") if extensions.has_value else extensions
    return shown.has_value and shown.member("visible").data is False


def _roots(document: GltfDocument) -> list[JsonValue]:
    """Return the indices of the root nodes of the default scene; of all nodes without parents if there is no scene."""
    scenes, default = document.items("scenes"), document.root.member("scene")
    if scenes:
        scene = document.item("scenes", default) if default.has_value else scenes[0]
        nodes = scene.member("nodes")
        return nodes.entries() if nodes.has_value else []
    nodes = document.items("nodes")
    lists = [node.member("children") for node in nodes]
    below = {child.integer() for children in lists if children.has_value for child in children.entries()}
    return [JsonValue(document.path, node.element, i) for i, node in enumerate(nodes) if i not in below]


def read_rotation(turn: JsonValue) -> Float[np.ndarray, "3 3"]:
    """Return the matrix of a quaternion x y z w; raise the value's error if it has no length."""
    x, y, z, w = turn.vector(4).tolist()
    if x * x + y * y + z * z + w * w < 1e-12:
        raise turn.error("quaternion has no length")
    return quat_matrix(np.array([[w, x, y, z]]))[0]


def _matrix(value: JsonValue) -> Matrix:
    """Return parent from node: the matrix (column-major), else translation, rotation (x y z w) and scale."""
    whole = value.member("matrix")
    if whole.has_value:
        matrix = whole.vector(16).reshape(4, 4).T
        if not np.allclose(matrix[3], (0, 0, 0, 1), rtol=0, atol=1e-6):
            raise whole.error(f"expected an affine matrix, its last row is {matrix[3].tolist()}")
        return matrix
    place, turn, scale = (value.member(key) for key in ("translation", "rotation", "scale"))
    matrix = np.eye(4)
    if turn.has_value:
        matrix[:3, :3] = read_rotation(turn)
    if scale.has_value:
        matrix[:3, :3] *= scale.vector(3)
    if place.has_value:
        matrix[:3, 3] = place.vector(3)
    return matrix


def _name(value: JsonValue) -> str:
    """Return the name of an object, cut to 100 characters; "" if it has none."""
    name = value.member("name").data
    return printable(name[:100]) if isinstance(name, str) else ""
