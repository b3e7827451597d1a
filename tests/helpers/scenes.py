"""Scenes of the hand-made houses for tests of sound."""

import functools

import jax.numpy as jnp
import numpy as np
from handmade import shoebox

from home_mjx.bank.bank import HouseBank
from home_mjx.raycast_render.scene.scene import make_scene
from home_mjx.raycast_render.scene.types import Scene
from home_mjx.schema.compiled import CompiledHouse

HEAD = jnp.float32([0.5, 0.5, -0.5, -0.5])  # camera frame of an agent at yaw 0: looks along +x, up is +z, left is +y


def scene_of(*houses: CompiledHouse, house: int = 0, agents: tuple = ()) -> Scene:
    """The scene of one of some houses, every body where it was compiled."""
    bank = HouseBank.from_compiled(houses)
    pos = jnp.asarray(np.array(agents, np.float32).reshape(-1, 3))
    quat = jnp.tile(jnp.float32([[1, 0, 0, 0]]), (len(agents), 1))
    index = jnp.int32(house)
    return make_scene(bank, index, bank.physics.body_pos[index], bank.physics.body_quat[index], pos, quat)


@functools.cache
def open_air() -> Scene:
    """A room 20 m high whose walls take everything.

    On the floor of the usual room, so that its arrays have the same shapes and programs are compiled once for both.
    """
    return scene_of(shoebox((6.0, 5.0, 20.0), absorption=1.0, scattering=0.0))
