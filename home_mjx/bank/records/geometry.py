"""Geometry records for ray casting."""

from typing import Any

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int, UInt32

from home_mjx.bank.records.gpu_geometry import GpuGeometry
from home_mjx.bank.records.owners import HouseOwner, ModelOwner, TreeOwner
from home_mjx.core.pytree import Pytree, array
from home_mjx.geometry.meshes import invert
from home_mjx.schema.compiled import ARCHITECTURE

LEAF_BITS = 4  # a leaf code is `~(first << LEAF_BITS | count)`
CUTOUT_SHIFT = 8  # bits of `Geometry.material_mask` below the number of the cut-out layer
EMPTY_BOX = np.array([[np.inf] * 3 + [-np.inf] * 3])  # an empty box that no ray hits
IDENTITY_POSE = np.eye(3, 4)


def offset_codes(at: TreeOwner) -> Int[np.ndarray, "n 2"]:
    """Return a BVH's child codes in rows of the bank: nodes plus `node`, leaf primitives plus `first`; -1 if empty."""
    child = at.record.child
    leaf = np.where(child == -1, -1, ~(~child.astype(np.int64) + (at.first << LEAF_BITS)))
    return np.where(child >= 0, child + at.node, leaf).astype(np.int32)


def model_root(at: ModelOwner) -> Any:
    """Return the bank's row of the root node of a model's BVH, as a list of one."""
    return [at.node]


def model_triangle(at: ModelOwner) -> Any:
    """Return the bank's row of the first triangle of a model, as a list of one."""
    return [at.triangle]


def model_box(at: ModelOwner) -> Any:
    """Return the bounds (min, max) of a model in its frame [m], with a leading axis of one."""
    return at.record.box[None]


def top_root(at: HouseOwner) -> int:
    """Return the bank's row of the root of a house's top-level BVH, which follows the BVH of its architecture."""
    own = at.house.models[at.house.instances.model[ARCHITECTURE]]
    return at.start["node"] + len(own.tree.child)


def instance_models(at: HouseOwner) -> list[int]:
    """Return the instances' rows in the bank's models; the first, the architecture, has one private to the house."""
    return [at.start["model"], *(at.model_index[key] for key in at.house.instances.model[ARCHITECTURE + 1 :])]


def inverse_pose(at: HouseOwner) -> Float[np.ndarray, "i 3 4"]:
    """Return model-from-world maps of the instances, in float64: inverses of the poses rounded to float32."""
    return invert(at.house.instances.pose.astype(np.float32).astype(np.float64))


def first_material(at: HouseOwner) -> Int[np.ndarray, " i"]:
    """Return the row in the bank's materials of each instance's slot 0."""
    return at.house.instances.material + at.start["material"]


def first_semantic(at: HouseOwner) -> Int[np.ndarray, " i"]:
    """Return the row in the bank's semantic table of each instance's part 0."""
    return at.house.instances.semantic + at.start["semantic"]


def ray_mask(at: HouseOwner) -> Int[np.ndarray, " r"]:
    """Return each material's `RayKind` bits and, from bit `CUTOUT_SHIFT` on, its texture's cut-out layer + 1 or 0."""
    table = at.record.materials
    layer = [1 + at.texture_layer[path] if path in at.cutouts else 0 for path in table.texture]
    return table.mask | np.array(layer, np.int32) << CUTOUT_SHIFT


def semantic_by_object(at: HouseOwner) -> Int[np.ndarray, " o"]:
    """Return the row in the bank's semantic table of each object id, from 0 to the largest; -1 for unused ids.

    The architecture is left out. Of instances with one id, the last counts.
    """
    ids = at.house.instances.object_id[ARCHITECTURE + 1 :]
    rows = np.full(1 + ids.max(initial=-1), -1, np.int32)
    rows[ids] = first_semantic(at)[ARCHITECTURE + 1 :]
    return rows


class Geometry(Pytree):
    """The shared model library and each house's instances.

    Triangle and node indices are absolute. Instance indices run over [0, I) per house; row 0 is
    the architecture, and agent a follows as I + a. BVH codes are those of `compiled.BVH`, but absolute.
    """

    node_box: Float[Array, "node 2 6"] = array("per child: min xyz, max xyz", source="box", fill=EMPTY_BOX)
    node_child: Int[Array, "node 2"] = array(
        ">= 0 node; < 0 leaf: ~code = first << 4 | count", source=offset_codes, fill=-1
    )
    triangle: Float[Array, "triangle 3 3"] = array("[m], model frame", source="triangle")
    triangle_uv: Float[Array, "triangle 3 2"] = array("texture coordinates of the corners", source="uv")
    triangle_slot: Int[Array, " triangle"] = array("material slot", source="slot")
    triangle_part: Int[Array, " triangle"] = array("semantic part", source="part")
    model_root: Int[Array, " model"] = array("root node of the model's tree", source=model_root)
    model_triangle: Int[Array, " model"] = array("first row of the model's triangles", source=model_triangle)
    model_box: Float[Array, "model 2 3"] = array("[m], min and max", source=model_box)
    house_root: Int[Array, " h"] = array(
        "root node of the top tree over static instances (leaves hold instance indices)", source=top_root
    )
    instance_model: Int[Array, "h instances"] = array("-1 padding", source=instance_models, fill=-1)
    instance_pose: Float[Array, "h instances 3 4"] = array(
        "world from model", source="instances.pose", fill=IDENTITY_POSE
    )
    instance_inverse: Float[Array, "h instances 3 4"] = array(
        "model from world", source=inverse_pose, fill=invert(IDENTITY_POSE)
    )
    instance_object: Int[Array, "h instances"] = array(
        "object id (node index); -1 architecture and padding", source="instances.object_id", fill=-1
    )
    instance_material: Int[Array, "h instances"] = array("first material row, absolute", source=first_material)
    instance_semantic: Int[Array, "h instances"] = array("first semantic row, absolute", source=first_semantic)
    instance_body: Int[Array, "h instances"] = array(
        "index of the movable body; -1 static", source="instances.body", fill=-1
    )
    object_semantic: Int[Array, "h instances"] = array(
        "semantic row of each object id, absolute; -1 none", source=semantic_by_object, fill=-1
    )
    material_mask: Int[Array, " material"] = array(
        "Ray bits that each material blocks; from bit 8 on: layer in `cutout` + 1; 0 none", source=ray_mask
    )
    cutout: UInt32[Array, "layers edge words"] = array(
        "bit per texel of `materials.textures`, 1: cut out; row 0 is the top (v = 1), lowest bit first",
        source="cutout",
    )
    agent_model: Int[Array, ""] = array("library model of an agent, in its real size", source="agent")
    agent_material: Int[Array, ""] = array("first material row of an agent", source="agent")
    agent_semantic: Int[Array, ""] = array("semantic row of agents", source="agent")
    gpu: GpuGeometry | None = None  # layout for the `cuda` ray backend; None: computed at each cast

    def clip_house_index(self, house: Int[Array, "*n"] | int) -> Int[Array, "*n"]:
        """Clip house indices to the bank, negative ones to 0; JAX's own indexing would count these from the end."""
        return jnp.clip(house, 0, self.house_root.shape[0] - 1)
