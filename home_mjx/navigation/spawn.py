"""Sampling of start positions, sound sources, arrangements and headings."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from home_mjx.bank.bank import HouseBank
from home_mjx.core.transforms import quat_matrix

MIN_SPAWN_CLEARANCE = 0.005  # [m], minimum clearance between a spawned agent and bodies


def sample_starts(
    bank: HouseBank, house: Int[Array, ""], num: int, min_distance: float, key: Array
) -> tuple[Int[Array, " a"], Float[Array, "a 3"]]:
    """Sample `num`, at least 1, start points of a house uniformly, each at least `min_distance` [m] from earlier ones.

    Distances are straight lines. If no such point is left, it is any start point, possibly one chosen before.

    Returns:
        Indices into `navigation.start` of `house`, which is not clipped, and the points on the floor [m].
    """
    points = bank.navigation.start[house]
    gumbel = jax.random.gumbel(key, (num, points.shape[0]))
    clearance = jnp.full(points.shape[:1], jnp.inf, jnp.float32)
    chosen = []
    for a in range(num):
        # Points too close to an earlier agent rank below all others, but are still chosen if no others are left.
        ranked = jnp.where(clearance < jnp.float32(min_distance), gumbel[a] - 1e6, gumbel[a])
        index = jnp.argmax(ranked).astype(jnp.int32)
        chosen.append(index)
        clearance = jnp.minimum(clearance, jnp.linalg.norm(points - points[index][None], axis=-1))
    indices = jnp.stack(chosen)
    return indices, points[indices]


def random_source(bank: HouseBank, house: Int[Array, ""], height: float, key: Array) -> Float[Array, "3"]:
    """Sample uniformly one of a house's start points, on the floor, raised by `height` [m]; `house` is not clipped."""
    points = bank.navigation.start[house]
    index = jax.random.randint(key, (), 0, points.shape[0])
    return points[index].at[2].add(jnp.float32(height))


def random_arrangement(
    bank: HouseBank, house: Int[Array, ""], points: Float[Array, "n 3"], key: Array
) -> Int[Array, ""]:
    """Sample uniformly one of a house's arrangements whose bodies keep clear of agents at all floor points [m].

    Clear is at least an agent's radius plus `MIN_SPAWN_CLEARANCE` from its axis, over the bank's agent height.

    Returns:
        Index of the arrangement; -1 (initial poses) if none is free, or the house has no arrangements or bodies.
    """
    house = bank.clip_house_index(house)
    poses = bank.physics.arrangement_pose[house]
    if not poses.shape[0] or not poses.shape[1]:
        return jnp.full((), -1, jnp.int32)
    over_bodies = jax.vmap(_distance_to_box, (None, None, 0, 0))
    over_points = jax.vmap(over_bodies, (None, 0, None, None))
    size, height = bank.physics.body_size[house], jnp.float32(bank.spec.agent_height)
    away = jax.vmap(over_points, (None, None, 0, None))(height, points, poses, size)
    near = away < jnp.float32(bank.spec.agent_radius + MIN_SPAWN_CLEARANCE)
    near &= bank.physics.body_valid[house][None, None]
    free = ~jnp.any(near, axis=(1, 2))
    drawn = jnp.argmax(jnp.where(free, jax.random.uniform(key, free.shape), jnp.float32(-1.0)))
    return jnp.where(jnp.any(free), drawn, -1).astype(jnp.int32)


def _distance_to_box(
    height: Float[Array, ""], point: Float[Array, "3"], pose: Float[Array, "7"], half: Float[Array, "3"]
) -> Float[Array, ""]:
    """Return the distance [m] from the vertical segment of length `height` above a point to a box; 0 if they meet.

    The box has the `pose` (xyz, quaternion wxyz) and the half extents `half` [m].

    The squared distance is convex along the segment. Its slope is linear between the planes of the box's faces, so the
    minimum is interpolated between the two ends or crossings around the slope's zero.
    """
    rotation = quat_matrix(pose[3:])
    start, way = jnp.matmul(point - pose[:3], rotation, precision="highest"), height * rotation[2]
    sides = jnp.concatenate([-half - start, half - start]) / jnp.tile(jnp.where(jnp.abs(way) < 1e-9, 1.0, way), 2)
    share = jnp.clip(jnp.concatenate([jnp.array([0.0, 1.0], jnp.float32), sides]), 0.0, 1.0)
    local = start + share[:, None] * way
    slope = jnp.sum((local - jnp.clip(local, -half, half)) * way, axis=1)
    low = jnp.max(jnp.where(slope <= 0, share, 0.0))
    high = jnp.min(jnp.where(slope >= 0, share, 1.0))
    fall, rise = (jnp.sum((x - jnp.clip(x, -half, half)) * way) for x in (start + low * way, start + high * way))
    nearest = start + (low - (high - low) * fall / jnp.maximum(rise - fall, 1e-12)) * way
    return jnp.linalg.norm(nearest - jnp.clip(nearest, -half, half))


def random_yaw(key: Array, shape: tuple[int, ...] = ()) -> Float[Array, "*n"]:
    """Sample headings uniformly in [-pi, pi) [rad], in an array of `shape`."""
    return jax.random.uniform(key, shape, jnp.float32, -jnp.pi, jnp.pi)
