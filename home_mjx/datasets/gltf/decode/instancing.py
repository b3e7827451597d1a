"""Instances of a node's mesh, by `EXT_mesh_gpu_instancing`."""

import numpy as np
from jaxtyping import Float

from home_mjx.datasets.gltf.decode.accessors import read_accessor
from home_mjx.datasets.gltf.decode.container import GltfDocument
from home_mjx.datasets.suncg.formats.json_value import JsonValue
from home_mjx.geometry.rotations import quat_matrix

EXTENSION = "EXT_mesh_gpu_instancing"
MAX_INSTANCES = 20_000  # maximum number of instances of a node
WIDTHS = {"TRANSLATION": 3, "ROTATION": 4, "SCALE": 3}


def read_instances(document: GltfDocument, node: JsonValue) -> Float[np.ndarray, "n 4 4"]:
    """Return node from instance for each instance of a node's mesh; the identity alone without the extension.

    Raises:
        DatasetError: An accessor is invalid, or they have other lengths or types, or more than `MAX_INSTANCES` rows.
    """
    extensions = node.member("extensions")
    stated = extensions.member(EXTENSION) if extensions.has_value else extensions
    if not stated.has_value:
        return np.eye(4)[None]
    named = stated.member("attributes")
    found = {k: read_accessor(document, named.member(k)) for k in WIDTHS if named.member(k).has_value}
    counts = {len(rows) for rows in found.values()}
    if len(counts) != 1 or max(counts) > MAX_INSTANCES or any(r.shape[1] != WIDTHS[k] for k, r in found.items()):
        raise stated.error(f"expected attributes of one length, at most {MAX_INSTANCES}")
    matrix = np.tile(np.eye(4), (counts.pop(), 1, 1))
    if "ROTATION" in found:
        turn = found["ROTATION"].astype(float)
        length = np.linalg.norm(turn, axis=1, keepdims=True)
        if length.min() < 1e-6:
            raise named.member("ROTATION").error("quaternion has no length")
        matrix[:, :3, :3] = quat_matrix((turn / length)[:, [3, 0, 1, 2]])
    matrix[:, :3, :3] *= found.get("SCALE", np.ones((1, 3)))[:, None]
    matrix[:, :3, 3] = found.get("TRANSLATION", np.zeros((1, 3)))
    return matrix
