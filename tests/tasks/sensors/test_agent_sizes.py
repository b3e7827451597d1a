"""Agents of different bodies are seen, and see, as large as they are."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from handmade import shoebox

import home_mjx
from home_mjx import HouseBank
from home_mjx.bank.packing.library import HEIGHT, RADIUS, agent_model
from home_mjx.physics import PhysicsConfig
from home_mjx.raycast_render import Lens
from home_mjx.raycast_render.scene.scene import agent_sizes
from home_mjx.schema import AgentBody
from home_mjx.tasks import AgentCamera

PIXELS, SPAN = 120, 2.4  # of a picture without perspective, and its edge [m]
BODIES = (
    AgentBody(),
    AgentBody(radius=0.25, height=1.1, eye_height=0.9),
    AgentBody(radius=0.15, height=2.0, eye_height=1.9),
)
YAW = (0.0, 2.5, -1.0)
PLACES = ((-2.0, 0.0), (0.5, -0.7), (0.5, 0.7))  # the first looks at the others


@pytest.fixture(scope="module")
def seen():
    """What the agents see from where they stand, the first one's eyes at 1.2 m above the floor."""
    flat = AgentCamera("flat", ("depth", "instance"), Lens(PIXELS, PIXELS, "orthographic"), SPAN, (0.0, 0.0, -0.3))
    physics = PhysicsConfig(impl="kinematic", num_agents=3, bodies=BODIES)
    bank = HouseBank.from_compiled([shoebox()])
    env = home_mjx.make("PointNav-v0", bank, physics=physics, sensors=("pose",), cameras=(flat,))
    state = jax.jit(env.reset)(jax.random.key(0))
    rows = [(x, y, body.height / 2, yaw) for (x, y), body, yaw in zip(PLACES, BODIES, YAW, strict=True)]
    qpos = state.physics.qpos.at[:12].set(jnp.array(rows, jnp.float32).reshape(-1))
    state = jax.jit(env.observe)(state.replace(physics=state.physics.replace(qpos=qpos)))
    return {name: np.asarray(value) for name, value in state.obs.items()} | {"first": bank.spec.num_instances}


def cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def distances(corners: np.ndarray, origin: np.ndarray, way: np.ndarray) -> np.ndarray:
    """Of every parallel ray to the nearest of some triangles [m]; inf beside them. By signed areas, in float64."""
    side = np.stack([np.cross(way, [0, 0, 1.0]), [0, 0, 1.0]])
    flat, eye, ahead = corners @ side.T, origin @ side.T, corners @ way - (origin @ way)[0]
    found = np.full(len(origin), np.inf)
    for (a, b, c), depth in zip(flat, ahead, strict=True):
        area = cross(b - a, c - a)
        if abs(area) < 1e-12:
            continue
        u, v = cross(eye - a, c - a) / area, cross(b - a, eye - a) / area
        inside = (u >= 0) & (v >= 0) & (u + v <= 1)
        t = depth[0] + u * (depth[1] - depth[0]) + v * (depth[2] - depth[0])
        found = np.where(inside & (t > 0), np.minimum(found, t), found)
    return found


def test_silhouettes_are_as_high_and_as_wide_as_bodies(seen):
    ids, pixel = seen["ids/flat_instance"][0], SPAN / PIXELS
    for agent in (1, 2):
        mask, body = ids == seen["first"] + agent, BODIES[agent]
        assert abs(mask.any(axis=1).sum() * pixel - body.height) <= pixel
        middle = mask[np.flatnonzero(mask.any(axis=1))[-1] - round(body.height / 2 / pixel)]
        assert abs(middle.sum() * pixel - 2 * body.radius) <= 1.5 * pixel
        lowest = (PIXELS / 2 - np.flatnonzero(mask.any(axis=1))[-1] - 1) * pixel + 1.2
        assert abs(lowest) <= pixel  # it stands on the floor


def test_depth_is_that_of_scaled_triangles(seen):
    """Against every triangle of the library's model, scaled, turned and placed in float64."""
    world = []
    for (x, y), body, yaw in zip(PLACES[1:], BODIES[1:], YAW[1:], strict=True):
        turn = np.array([[np.cos(yaw), -np.sin(yaw), 0], [np.sin(yaw), np.cos(yaw), 0], [0, 0, 1]])
        scaled = agent_model().triangle * [body.radius / RADIUS, body.radius / RADIUS, body.height / HEIGHT]
        world.append(scaled @ turn.T + [x, y, body.height / 2])
    at = (np.arange(PIXELS) + 0.5 - PIXELS / 2) * SPAN / PIXELS
    across, up = np.meshgrid(at, -at)
    origin = np.stack([np.full(PIXELS**2, PLACES[0][0]), -across.ravel(), 1.2 + up.ravel()], axis=-1)
    wanted = distances(np.concatenate(world), origin, np.array([1.0, 0, 0])).reshape(PIXELS, PIXELS)
    agents = seen["ids/flat_instance"][0] >= seen["first"]
    assert (agents != np.isfinite(wanted)).mean() < 1e-3  # rays that just graze a triangle
    both = agents & np.isfinite(wanted)
    np.testing.assert_allclose(seen["pixels/flat_depth"][0][both, 0], wanted[both], atol=1e-4)


def test_eyes_are_at_the_height_of_the_bodys(seen):
    np.testing.assert_allclose(seen["camera/head_pose"][:, 2, 3], [1.5, 0.9, 1.9], atol=1e-6)


def test_default_bodies_are_not_scaled():
    """Then there is nothing to compute."""
    assert agent_sizes([AgentBody(), AgentBody(mass=30.0, eye_height=1.4)]) is None
    np.testing.assert_allclose(agent_sizes(BODIES), [(0.1, 1.6), (0.25, 1.1), (0.15, 2.0)])
