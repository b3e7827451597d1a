"""Skins of a glTF document in the pose that its nodes have."""

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from jaxtyping import Float, Int

from home_mjx.datasets.gltf.decode.accessors import read_accessor
from home_mjx.datasets.gltf.decode.container import GltfDocument
from home_mjx.datasets.gltf.decode.node_matrix import Matrix, node_matrix
from home_mjx.datasets.suncg.formats.json_value import MAX_COORDINATE, JsonValue
from home_mjx.schema.house import Mesh

MIN_WEIGHT = 1e-6  # minimum sum of the weights of a vertex that joints move


@dataclass(frozen=True)
class Binding:
    """Joints of the vertices of a mesh.

    Attributes:
        joint: Indices into the joints of a skin.
        weight: Their weights.
    """

    joint: Int[np.ndarray, "v k"]
    weight: Float[np.ndarray, "v k"]


@dataclass
class SkinReader:
    """Reader of a document's skins.

    Attributes:
        document: The document.
    """

    document: GltfDocument
    _globals: dict[int, Matrix] = field(default_factory=dict)
    _read: dict[int, Float[np.ndarray, "j 3 4"]] = field(default_factory=dict)

    def posed(self, skin: JsonValue, mesh: Mesh, binding: Binding) -> Mesh:
        """Return a mesh in the document's frame, moved by the joints of a skin; normals are dropped.

        Raises:
            DatasetError: The skin is broken, or its joints do not fit the mesh.
        """
        value, number = self.document.item("skins", skin), skin.integer()
        if number not in self._read:
            self._read[number] = self._moves(value)
        moves = self._read[number]
        if binding.joint.max(initial=0) >= len(moves) or binding.joint.min(initial=0) < 0:
            raise value.error(f"vertices have joints beyond the {len(moves)} of the skin")
        weight = binding.weight / np.maximum(binding.weight.sum(axis=1, keepdims=True), MIN_WEIGHT)
        points = np.c_[mesh.vertices, np.ones(len(mesh.vertices))]
        found = np.zeros((len(points), 3))
        for joint, share in zip(binding.joint.T, weight.T, strict=True):
            found += share[:, None] * np.einsum("vij,vj->vi", moves[joint], points)
        if not (abs(found) <= MAX_COORDINATE).all():
            raise value.error("skin moves vertices beyond all limits")
        return replace(mesh, vertices=found, normal=None)

    def _moves(self, value: JsonValue) -> Float[np.ndarray, "j 3 4"]:
        """Return the document from the mesh by joint: the joint's place times its inverse bind matrix."""
        joints, stated = value.member("joints").entries(), value.member("inverseBindMatrices")
        bind = np.tile(np.eye(4), (len(joints), 1, 1))
        if stated.has_value:
            rows = read_accessor(self.document, stated)
            if rows.shape[1:] != (16,) or len(rows) < len(joints):
                raise stated.error(f"expected a matrix for each of the {len(joints)} joints, got {rows.shape}")
            bind = rows[: len(joints)].reshape(-1, 4, 4).transpose(0, 2, 1)
        return np.stack([self._global(j) @ m for j, m in zip(joints, bind, strict=True)])[:, :3] if joints else bind

    @cached_property
    def _parents(self) -> dict[int, int]:
        """Parents of nodes; of several ones the last."""
        lists = ((number, node.member("children")) for number, node in enumerate(self.document.items("nodes")))
        return {child.integer(): number for number, below in lists if below.has_value for child in below.entries()}

    def _global(self, index: JsonValue) -> Matrix:
        """Return the document from a node; the way to the root ends at a node that is its own ancestor."""
        self.document.item("nodes", index)
        number, way = index.integer(), dict[int, None]()
        while number not in way and number not in self._globals:
            way[number] = None
            if number not in self._parents:
                break
            number = self._parents[number]
        nodes = self.document.items("nodes")
        matrix = self._globals.get(number, np.eye(4))
        for one in reversed(way):
            matrix = self._globals[one] = matrix @ node_matrix(nodes[one])
        return matrix
