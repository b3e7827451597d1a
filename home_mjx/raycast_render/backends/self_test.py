"""Self-test of backends on a scene of two triangles, one of them moving."""

from collections.abc import Callable
from typing import TypeVar

import jax
import jax.numpy as jnp
import numpy as np

from home_mjx.bank.records import Geometry
from home_mjx.raycast_render.scene.types import CLOSEST_HIT, DynamicInstances, Rays

T = TypeVar("T")


def find_fault(backend: Callable) -> str | None:
    """Return a description of the error in the result of a `registry.RayBackend`; None if the result is correct.

    Four rays run along +z. They hit the static triangle at z = 1, hit the moving one at z = 2, miss both, and end
    before the static one.
    """
    hits = jax.jit(lambda *args: backend(*args, CLOSEST_HIT))(_geometry(), jnp.zeros(1, jnp.int32), _moving(), _rays())
    t, instance, triangle, u, v, front = (np.asarray(x)[0] for x in hits)
    right = (
        np.allclose(t[:2], [1, 2], atol=1e-5)
        and instance.tolist() == [0, 1, -1, -1]
        and triangle.tolist() == [0, 0, -1, -1]
        and np.allclose(u[:2], 0.25, atol=1e-5)
        and np.allclose(v[:2], 0.5, atol=1e-5)
        and front.tolist() == [False, False, False, False]
    )
    return None if right else f"wrong hits in the self-test: t {t}, instance {instance}, triangle {triangle}"


def _geometry() -> Geometry:
    """Return a house of one triangle, in the plane z = 1, as instance 0."""
    none = np.zeros(1, np.int32)
    corner = np.array([[[0, 0, 1], [1, 0, 1], [0, 1, 1]]], np.float32)
    box = np.array([[0, 0, 1, 1, 1, 1], [np.inf] * 3 + [-np.inf] * 3], np.float32)
    pose = np.eye(3, 4, dtype=np.float32)[None, None]
    leaf = np.array([[~1, -1]], np.int32)  # first 0, count 1
    return Geometry(
        node_box=jnp.asarray(box[None]),
        node_child=jnp.asarray(leaf),
        triangle=jnp.asarray(corner),
        triangle_uv=jnp.zeros((1, 3, 2), jnp.float32),
        triangle_slot=jnp.asarray(none),
        triangle_part=jnp.asarray(none),
        model_root=jnp.asarray(none),
        model_triangle=jnp.asarray(none),
        model_box=jnp.asarray(box[:1].reshape(1, 2, 3)),
        house_root=jnp.asarray(none),
        instance_model=jnp.zeros((1, 1), jnp.int32),
        instance_pose=jnp.asarray(pose),
        instance_inverse=jnp.asarray(pose),
        instance_object=jnp.zeros((1, 1), jnp.int32),
        instance_material=jnp.zeros((1, 1), jnp.int32),
        instance_semantic=jnp.zeros((1, 1), jnp.int32),
        instance_body=jnp.full((1, 1), -1, jnp.int32),
        object_semantic=jnp.full((1, 1), -1, jnp.int32),
        material_mask=jnp.ones(1, jnp.int32),
        cutout=jnp.zeros((1, 1, 1), jnp.uint32),
        agent_model=jnp.zeros((), jnp.int32),
        agent_material=jnp.zeros((), jnp.int32),
        agent_semantic=jnp.zeros((), jnp.int32),
    )


def _moving() -> DynamicInstances:
    """Return the same triangle as moving instance 1, shifted by (5, 0, 1) [m]."""
    pose = np.eye(3, 4, dtype=np.float32)
    pose[:, 3] = 5, 0, 1
    inverse = np.eye(3, 4, dtype=np.float32)
    inverse[:, 3] = -pose[:, 3]
    return _batched(
        DynamicInstances(
            instance=jnp.ones(1, jnp.int32),
            model=jnp.zeros(1, jnp.int32),
            pose=jnp.asarray(pose[None]),
            inverse=jnp.asarray(inverse[None]),
            box=jnp.asarray([[[5.0, 0, 2], [6, 1, 2]]], jnp.float32),
            object_id=jnp.ones(1, jnp.int32),
            material=jnp.zeros(1, jnp.int32),
            semantic=jnp.zeros(1, jnp.int32),
        )
    )


def _rays() -> Rays:
    """Return the four rays of `find_fault`."""
    origin = [[0.25, 0.5, 0], [5.25, 0.5, 0], [0.9, 0.9, 0], [0.25, 0.5, 0]]
    return _batched(
        Rays(
            origin=jnp.asarray(origin, jnp.float32),
            direction=jnp.tile(jnp.array([[0.0, 0, 1]], jnp.float32), (4, 1)),
            t_min=jnp.zeros(4, jnp.float32),
            t_max=jnp.array([9, 9, 9, 0.5], jnp.float32),
            exclude=jnp.full(4, -1, jnp.int32),
            mask=jnp.ones(4, jnp.int32),
        )
    )


def _batched(record: T) -> T:
    """Return a record of one environment as a batch of one: every array with a new first axis."""
    return jax.tree.map(lambda x: x[None], record)
