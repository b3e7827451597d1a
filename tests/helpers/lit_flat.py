"""A flat with baked light, cameras in it, and its light by a shader."""

import functools
import types

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from home_mjx.bank.bank import HouseBank
from home_mjx.houses import HouseSet
from home_mjx.light_probes import ProbeOptions, solve
from home_mjx.light_probes.field import stack_fields
from home_mjx.raycast_render.cameras.camera import Camera, Lens
from home_mjx.raycast_render.images.render import render
from home_mjx.raycast_render.scene.appearance import AppearanceOverrides
from home_mjx.raycast_render.scene.scene import make_scene
from home_mjx.raycast_render.shaders import lit
from home_mjx.raycast_render.shaders.base import prepare_shaders

LENS = Lens(32, 24)
OFF = types.SimpleNamespace(KERNEL=types.SimpleNamespace(is_usable=lambda platform: False))


@functools.cache
def lit_bank():
    """A flat with its light, coarsely baked."""
    house = HouseSet("procedural:1?preset=flat&seed=4").load()[0]
    bank = HouseBank.from_compiled([house])
    record = solve.solve_house(bank, 0, house, ProbeOptions(spacing=0.7, rays=32))
    return bank.replace(bakes={"light_probes": stack_fields([record])})


def glowing_bank():
    """The flat with every third material emitting, each differently."""
    bank = lit_bank()
    rows = jnp.arange(0, bank.materials.texture.shape[0], 3, dtype=jnp.int32)[None]
    glow = jnp.stack([rows % 5, rows % 7, rows % 3], axis=-1) / 7.0
    return bank.replace(lights=bank.lights.replace(glowing=rows, glow=glow.astype(jnp.float32)))


def places(bank):
    """Positions and orientations at places of the agent, and at one outdoors."""
    rng, cells = np.random.default_rng(3), np.asarray(bank.navigation.cell_coords)
    free = cells[rng.choice(int(bank.navigation.num_cells[0]), 3)]
    corner, cell = np.asarray(bank.navigation.origin[0]), bank.spec.cell
    inside = [[*(corner + cell * (place[[2, 1]] + 0.5)), 1.4] for place in free]
    pos = np.array([*inside, [corner[0] - 4, corner[1] - 4, 1.7]])
    yaw = np.array([0.3, 2.0, 4.1, np.pi / 4])
    down = np.array([[np.cos(np.pi / 4 - 0.1), np.sin(np.pi / 4 - 0.1), 0, 0]] * 4)
    half, zero = yaw / 2 - np.pi / 4, np.zeros(4)
    turn = np.stack([np.cos(half), zero, zero, np.sin(half)], -1)
    quat = np.stack(
        [
            turn[:, 0] * down[:, 0],
            turn[:, 0] * down[:, 1],
            turn[:, 3] * down[:, 1],
            turn[:, 3] * down[:, 0],
        ],
        -1,
    )
    return jnp.asarray(pos, jnp.float32), jnp.asarray(quat, jnp.float32)


def radiance(bank, cameras, shader, look):
    """Light of a shader, (cameras, H, W, 3), and the object in each pixel; all environments have one look."""

    def one(bank, pos, quat):
        house = jnp.int32(0)
        body = bank.physics.body_pos[0] + jnp.array([0.05, 0.1, 0.0]), bank.physics.body_quat[0]
        agent = jnp.array([[0.0, 0.0, -50.0]]), jnp.array([[1.0, 0.0, 0.0, 0.0]])
        scene = make_scene(bank, house, *body, *agent)
        scene = scene.replace(appearance=look, prepared=prepare_shaders((shader,), bank, house, look))
        camera = Camera(pos, quat, jnp.float32(1.4))
        return render(scene, camera, LENS, kinds=("radiance", "instance"), shader=shader)

    found = jax.jit(jax.vmap(one, (None, 0, 0)))(bank, *cameras)
    return np.asarray(found["radiance"]), np.asarray(found["instance"])


VARIED = AppearanceOverrides(
    jnp.uint32(9),
    lamps=jnp.linspace(0.2, 1.5, 12),
    daylight=jnp.float32(0.6),
    sun_azimuth=jnp.float32(1.0),
    tint=jnp.float32(0.4),
    swap=jnp.float32(0.5),
)


@functools.cache
def composed_radiance(shader, varied, make_bank=lit_bank):
    """Light of a shader by operations of JAX, with the look `VARIED` or without one: once for all kernels."""
    bank = make_bank()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(lit, "native", OFF)
        return radiance(bank, places(bank), shader, VARIED if varied else None)[0]
