"""Objects of which just enough points are visible can be picked up, by the compiler of tasks as by experts."""

import jax
import jax.numpy as jnp
import numpy as np
from handmade import Furniture, shoebox

from home_mjx.bank.bank import HouseBank
from home_mjx.raycast_render import cast
from home_mjx.raycast_render.scene.scene import make_open_scene
from home_mjx.tasks.sensors.reachability import MIN_VISIBLE_POINTS, can_pick_from, is_reachable, pick_points

BOX = np.array([[-0.2, -0.2, 0.0], [0.2, 0.2, 0.4]], np.float32)
REACH = jnp.float32(1.2)


def test_the_minimum_number_of_visible_points_is_enough():
    """Eyes behind two screens of different heights, above which they see rows of points."""
    screens = [Furniture((0.6, 0.5), size=(0.02, 1.0, 0.36)), Furniture((0.6, -0.5), size=(0.02, 1.0, 0.39))]
    bank = HouseBank.from_compiled([shoebox(furniture=[Furniture((0.0, 0.0), size=(0.4, 0.4, 0.4)), *screens])])
    scene = make_open_scene(bank, jnp.int32(0))
    height, across = np.meshgrid(np.linspace(0.3, 0.7, 30), np.linspace(-0.3, 0.3, 60))
    eyes = np.stack([np.full(height.size, 0.9), across.ravel(), height.ravel()], axis=1).astype(np.float32)
    instance = cast(scene, jnp.float32([0, 0, 2]), jnp.float32([0, 0, -1])).instance

    def count(eye):
        way = pick_points(eye, jnp.asarray(BOX)) - eye
        way = way / jnp.linalg.norm(way, axis=1, keepdims=True)
        hit = cast(scene, jnp.broadcast_to(eye, way.shape), way)
        return jnp.sum((hit.instance == instance) & is_reachable(eye, eye + way * hit.t[:, None], REACH))

    counts = np.asarray(jax.jit(jax.vmap(count))(jnp.asarray(eyes)))
    found = can_pick_from(bank, jnp.int32(0), jnp.asarray(eyes), instance, jnp.asarray(BOX), REACH)
    assert {0, MIN_VISIBLE_POINTS - 1, MIN_VISIBLE_POINTS, 25} <= set(counts.tolist()), np.bincount(counts)
    np.testing.assert_array_equal(found, counts >= MIN_VISIBLE_POINTS)
