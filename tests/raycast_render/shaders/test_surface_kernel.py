"""The kernel of surface light against the same computation by operations of JAX, in a flat with baked light."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from lit_flat import OFF, VARIED, composed_radiance, lit_bank, places, radiance

from home_mjx.raycast_render import LitShader
from home_mjx.raycast_render.cameras.camera import Camera, Lens
from home_mjx.raycast_render.images.render import render
from home_mjx.raycast_render.scene.scene import make_scene
from home_mjx.raycast_render.shaders import lit
from home_mjx.raycast_render.shaders.baked import BakedShader


@pytest.fixture(scope="module")
def bank():
    """A flat with its light."""
    return lit_bank()


@pytest.fixture(scope="module")
def cameras(bank):
    """Positions and orientations."""
    return places(bank)


@pytest.mark.parametrize(("shader", "look"), [(BakedShader(), None), (LitShader(num_lights=1), VARIED)])
def test_the_kernel_computes_the_light_of_the_shaders(bank, cameras, shader, look):
    """Floats differ in the last digits; a texel, a mip level or a shadow's edge, in few pixels."""
    fused, objects = radiance(bank, cameras, shader, look)
    composed = composed_radiance(shader, look is VARIED)
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
