"""The kernel of surface light against the same computation by operations of JAX, in a flat with baked light."""

import types

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from home_mjx.bank.bank import HouseBank
from home_mjx.houses import HouseSet
from home_mjx.light_probes import ProbeOptions, solve
from home_mjx.light_probes.field import stack_fields
from home_mjx.raycast_render import LitShader
from home_mjx.raycast_render.cameras.camera import Camera, Lens
from home_mjx.raycast_render.images.render import render
from home_mjx.raycast_render.scene.appearance import AppearanceOverrides
from home_mjx.raycast_render.scene.scene import make_scene
from home_mjx.raycast_render.shaders import lit
from home_mjx.raycast_render.shaders.baked import BakedShader
from home_mjx.raycast_render.shaders.base import prepare_shaders

LENS = Lens(32, 24)
OFF = types.SimpleNamespace(KERNEL=types.SimpleNamespace(is_usable=lambda platform: False))


@pytest.fixture(scope="module")
def bank():
    """A flat with its light, coarsely baked."""
    house = HouseSet("procedural:1?preset=flat&seed=4").load()[0]
    bank = HouseBank.from_compiled([house])
    record = solve.solve_house(bank, 0, house, ProbeOptions(spacing=0.7, rays=32))
    return bank.replace(bakes={"light_probes": stack_fields([record])})


@pytest.fixture(scope="module")
def cameras(bank):
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


@pytest.mark.parametrize(("shader", "look"), [(BakedShader(), None), (LitShader(num_lights=1), VARIED)])
def test_the_kernel_computes_the_light_of_the_shaders(bank, cameras, shader, look, monkeypatch):
    """Floats differ in the last digits; a texel, a mip level or a shadow's edge, in few pixels."""
    fused, objects = radiance(bank, cameras, shader, look)
    monkeypatch.setattr(lit, "native", OFF)
    composed, _ = radiance(bank, cameras, shader, look)
    assert (objects >= 0).mean() > 0.1
    assert composed.std() > 0.05
    apart = np.abs(fused - composed).max(-1) > 1e-3 * (0.1 + composed.max(-1))
    assert apart.mean() < 2e-3


def mean_light(bank, shift):
    """Mean light of a small picture whose camera is moved along x."""
    agent = jnp.array([[0.0, 0.0, -50.0]]), jnp.array([[1.0, 0.0, 0.0, 0.0]])
    scene = make_scene(bank, jnp.int32(0), bank.physics.body_pos[0], bank.physics.body_quat[0], *agent)
    pos, quat = jnp.array([0.1, 0.2, 1.4]) + jnp.array([1.0, 0.0, 0.0]) * shift, jnp.array([0.7, 0.7, 0.1, 0.1])
    camera = Camera(pos, quat / jnp.linalg.norm(quat), jnp.float32(1.4))
    return render(scene, camera, Lens(8, 8), kinds=("radiance",), shader=BakedShader())["radiance"].mean()


@pytest.mark.slow  # another kernel's gradient by its fallback has a fast test
def test_the_gradient_is_that_of_the_operations(bank, monkeypatch):
    def slope():
        return jax.jit(lambda x: jax.jvp(lambda y: mean_light(bank, y), (x,), (jnp.float32(1),))[1])(jnp.float32(0))

    fused = slope()
    monkeypatch.setattr(lit, "native", OFF)
    assert float(fused) != 0
    np.testing.assert_allclose(fused, slope(), rtol=1e-4)
