"""Scene graph of a glTF document: meshes with their transforms, in metres and Y up."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

from home_mjx.datasets.gltf.decode.container import GltfDocument
from home_mjx.datasets.gltf.decode.instancing import read_instances
from home_mjx.datasets.gltf.decode.node_matrix import Matrix, is_hidden, is_usable, node_matrix
from home_mjx.datasets.gltf.decode.primitives import MeshReader
from home_mjx.datasets.suncg.formats.json_value import JsonValue, printable
from home_mjx.schema.house import Mesh

MAX_NODES = 100_000  # maximum number of visited nodes
MAX_DEPTH = 500  # maximum number of nested nodes
MAX_SHOWN = 30_000_000  # maximum number of triangles, those of each instance counted


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
    for value, chain in visit_nodes(document, meshes.notes, frame):
        for placed in _placed(document, meshes, value, chain):
            count += len(placed.mesh.faces)
            if count > MAX_SHOWN:
                raise document.root.error(f"scene shows more than {MAX_SHOWN} triangles", "Remove instances.")
            yield placed


def visit_nodes(
    document: GltfDocument, notes: dict[str, str], frame: Matrix
) -> Iterator[tuple[JsonValue, tuple[SceneNode, ...]]]:
    """Yield the visible nodes of the default scene, each with the nodes from the scene's root to itself.

    Args:
        document: The document.
        notes: Receives the nodes that are left out.
        frame: House from the document's frame.

    Raises:
        DatasetError: An index or a transform is invalid, nodes are their own ancestors, or nodes are too many.
    """
    stack = [(node, (), (SceneNode("", "", frame),)) for node in reversed(_roots(document))]
    for _ in range(MAX_NODES):
        if not stack:
            return
        index, ancestors, chain = stack.pop()
        value, number = document.item("nodes", index), index.integer()
        if number in ancestors or len(ancestors) >= MAX_DEPTH:
            raise index.error(f"node {number} is its own ancestor, or more than {MAX_DEPTH} levels deep")
        matrix = chain[-1].matrix @ node_matrix(value)
        if not is_usable(matrix):
            notes[value.element] = "transform without volume, or beyond all limits: node left out"
            continue
        if is_hidden(value):
            notes[value.element] = "node is not visible: left out"
            continue
        chain = (*chain, SceneNode(_name(value), value.element, matrix, value.member("extras").data))
        children = value.member("children")
        if children.has_value:
            stack += [(child, (*ancestors, number), chain) for child in reversed(children.entries())]
        yield value, chain
    raise document.root.error(f"scene has more than {MAX_NODES} nodes", "Join its meshes.")


def _placed(
    document: GltfDocument, meshes: MeshReader, value: JsonValue, chain: tuple[SceneNode, ...]
) -> Iterator[PlacedMesh]:
    """Yield the mesh of a node, if it has one with triangles, once for each of its instances."""
    index = value.member("mesh")
    if not index.has_value:
        return
    mesh, skin = meshes.mesh(index), value.member("skin")
    if value.member("weights").has_value:
        meshes.notes[value.element] = "morph targets have the weights of the mesh, not those of the node"
    if mesh is not None and len(mesh.faces) and skin.has_value:
        yield _posed(document, meshes, value, chain, mesh)
    elif mesh is not None and len(mesh.faces):
        found = document.item("meshes", index)
        for matrix in read_instances(document, value):
            node = replace(chain[-1], matrix=chain[-1].matrix @ matrix)
            if is_usable(node.matrix):
                yield PlacedMesh(mesh, _name(found), (*chain[1:-1], node), found.element)
            else:
                meshes.notes[value.element] = "instances without volume, or beyond all limits, are left out"


def _posed(
    document: GltfDocument, meshes: MeshReader, value: JsonValue, chain: tuple[SceneNode, ...], mesh: Mesh
) -> PlacedMesh:
    """Return the mesh of a node with a skin in the pose of its joints, which the node's own transform does not move."""
    index = value.member("mesh")
    name = _name(document.item("meshes", index))
    binding = meshes.bindings.get(index.integer())
    if binding is None:
        meshes.notes[value.element] = "skin is not applied: vertices have no joints that are decoded"
        return PlacedMesh(mesh, name, chain[1:], value.element)
    meshes.notes[value.element] = "skin is in the pose of its nodes, and does not move"
    posed = meshes.skins.posed(value.member("skin"), mesh, binding)
    return PlacedMesh(posed, name, (*chain[1:-1], replace(chain[-1], matrix=chain[0].matrix)), value.element)


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


def _name(value: JsonValue) -> str:
    """Return the name of an object, cut to 100 characters; "" if it has none."""
    name = value.member("name").data
    return printable(name[:100]) if isinstance(name, str) else ""
