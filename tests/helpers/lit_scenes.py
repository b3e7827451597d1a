"""Rooms with lights by hand."""

from dataclasses import replace

import jax.numpy as jnp
import numpy as np
from handmade import shoebox

from home_mjx.bank.bank import HouseBank
from home_mjx.raycast_render.lighting import lights
from home_mjx.raycast_render.scene.scene import make_scene
from home_mjx.raycast_render.scene.vec import Vec
from home_mjx.raycast_render.shaders.lit import LitShader
from home_mjx.schema.lighting import LightTable

DOWN = (0.0, 0.0, -1.0)
NIGHT = LitShader(sun=0.0, sky=0.0)


def table(*rows, rooms=1):
    """A light table of dictionaries; a point of 1 W/sr in the architecture's frame unless they say otherwise."""
    plain = {
        "pos": (0, 0, 2),
        "axis_u": (0, 0, 0),
        "axis_v": (0, 0, 0),
        "direction": DOWN,
        "intensity": (1, 1, 1),
        "exponent": 0.0,
        "cutoff": -2.0,
        "area": 0.0,
        "daylight": False,
        "instance": 0,
        "room": 0,
    }
    rows = [plain | row for row in rows]
    kinds = {"daylight": bool, "instance": np.int32, "room": np.int32}
    columns = {
        name: np.array([row[name] for row in rows], kinds.get(name, float)).reshape(-1, *np.shape(value))
        for name, value in plain.items()
    }
    return LightTable(**columns, ambient=np.zeros((rooms + 1, 2, 3)))


def lit_bank(*rows, house=None, **options):
    """A room of 6 x 5 x 3 m, or another house, with lights."""
    house = house or shoebox(**options)
    return HouseBank.from_compiled([replace(house, lights=table(*rows, rooms=len(house.rooms.type)))])


def scene_of(bank, body_pos=None):
    nobody = jnp.zeros((0, 3), jnp.float32), jnp.zeros((0, 4), jnp.float32)
    pos = bank.physics.body_pos[0] if body_pos is None else body_pos
    return make_scene(bank, jnp.int32(0), pos, bank.physics.body_quat[0], *nobody)


def floor_points(xy, room=0, shininess=1.0):
    """Points of a floor at z = 0, seen from above."""
    count = len(xy)
    up = Vec.unpack(jnp.tile(jnp.array([[0.0, 0.0, 1.0]], jnp.float32), (count, 1)))
    pos = Vec.unpack(jnp.asarray(np.concatenate([xy, np.zeros((count, 1))], axis=1), jnp.float32))
    return lights.ShadingPoint(
        pos=pos,
        normal=up,
        shading=up,
        view=up,
        shininess=jnp.full(count, shininess, jnp.float32),
        instance=jnp.zeros(count, jnp.int32),
        room=jnp.full(count, room, jnp.int32),
    )
