"""Objects in the acoustics of HoME (2017): boxes around their models, which reflect and occlude sound."""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from home_mjx.audio_jax.base.endpoints import Listener, SoundSource
from home_mjx.audio_jax.geometry.image_sources import Mirrors
from home_mjx.core.pytree import Pytree
from home_mjx.raycast_render.scene.types import Scene
from home_mjx.schema.categories import coarse_index
from home_mjx.schema.semantic import Semantic

LEG_END_MARGIN = 1e-3  # [m], parts at both ends of a leg that are not tested for occlusion
MIN_LEG_COMPONENT = 1e-12  # [m], minimum component of a leg along an axis, for legs parallel to a face


class ModelBoxes(Pytree):
    """Bounding boxes of models in their own frames, and the poses of these frames."""

    pose: Float[Array, "n 3 4"]  # world from model
    inverse: Float[Array, "n 3 4"]  # model from world
    box: Float[Array, "n 2 3"]  # [m], model frame
    material: Int[Array, " n"]  # first material row
    valid: Bool[Array, " n"]


def model_boxes(scene: Scene, source: SoundSource, listener: Listener) -> ModelBoxes:
    """Return the boxes of all objects except doors, which are open in HoME, agents, and the endpoints' own bodies."""
    geometry, house, moving = scene.geometry, scene.house, scene.moving
    static = geometry.instance_object[house]
    still = (static >= 0) & (geometry.instance_body[house] < 0)
    object_id = jnp.concatenate([static, moving.object_id])
    first = jnp.concatenate([geometry.instance_semantic[house], moving.semantic])
    door = scene.bank.semantics[first, Semantic.COARSE] == coarse_index("door")
    there = (moving.instance >= 0) & (moving.instance < static.shape[0])
    own = (object_id == jnp.int32(source.body)) | (object_id == jnp.int32(listener.body))
    model = jnp.concatenate([geometry.instance_model[house], moving.model])
    return ModelBoxes(
        pose=jnp.concatenate([geometry.instance_pose[house], moving.pose]),
        inverse=jnp.concatenate([geometry.instance_inverse[house], moving.inverse]),
        box=geometry.model_box[jnp.maximum(model, 0)],
        material=jnp.concatenate([geometry.instance_material[house], moving.material]),
        valid=jnp.concatenate([still, there]) & (object_id >= 0) & ~own & ~door,
    )


def box_mirrors(boxes: ModelBoxes) -> Mirrors:
    """Return all faces of boxes as mirrors facing outwards."""
    half = (boxes.box[:, 1] - boxes.box[:, 0]) / 2
    middle = jnp.mean(boxes.box, axis=1)
    center = jnp.einsum("nij,nj->ni", boxes.pose[:, :, :3], middle, precision="highest") + boxes.pose[:, :, 3]
    edge = jnp.swapaxes(boxes.pose[:, :, :3], 1, 2) * half[:, :, None]  # (n, axis, xyz), half extents
    order = np.array([[(a + i) % 3 for i in range(3)] for a in range(3) for _ in (0, 1)])
    side = jnp.asarray(np.tile([-1.0, 1.0], 3), jnp.float32)[None, :, None]
    out, u, v = (edge[:, order[:, i]] for i in range(3))
    across = jnp.cross(u, v)  # 0 on the narrow sides of flat boxes, which do not reflect
    across = across * jnp.where(jnp.sum(across * out, axis=2, keepdims=True) < 0, -1.0, 1.0)
    normal = across / jnp.maximum(jnp.linalg.norm(across, axis=2, keepdims=True), MIN_LEG_COMPONENT) * side
    faces = Mirrors.build_unchecked(
        center=center[:, None] + out * side,
        normal=normal,
        u=u,
        v=v,
        valid=jnp.broadcast_to(boxes.valid[:, None], out.shape[:2]),
        material=jnp.broadcast_to(boxes.material[:, None], out.shape[:2]),
    )
    return jax.tree.map(lambda x: x.reshape(-1, *x.shape[2:]), faces)


def is_occluded_by_boxes(boxes: ModelBoxes, start: Float[Array, "m 3"], end: Float[Array, "m 3"]) -> Bool[Array, " m"]:
    """Return whether straight legs cross a face of a box, except within `LEG_END_MARGIN` of their ends."""
    origin = _to_model(boxes, start) + boxes.inverse[None, :, :, 3]
    way = _to_model(boxes, end - start)
    way = jnp.where(jnp.abs(way) < MIN_LEG_COMPONENT, MIN_LEG_COMPONENT, way)
    meets = [(boxes.box[None, :, i] - origin) / way for i in (0, 1)]
    enter = jnp.max(jnp.minimum(*meets), axis=2)
    leave = jnp.min(jnp.maximum(*meets), axis=2)
    skin = (LEG_END_MARGIN / jnp.maximum(jnp.linalg.norm(end - start, axis=1), LEG_END_MARGIN))[:, None]
    passes = [(at > skin) & (at < 1 - skin) for at in (enter, leave)]
    return jnp.any(boxes.valid[None] & (enter <= leave) & (passes[0] | passes[1]), axis=1)


def _to_model(boxes: ModelBoxes, vector: Float[Array, "m 3"]) -> Float[Array, "m n 3"]:
    return jnp.einsum("nij,mj->mni", boxes.inverse[:, :, :3], vector, precision="highest")
