"""Agents climb stairs with landings and curved ones, stand on them, and walk down again, in compiled houses."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from numpy.testing import assert_allclose
from storeys import FLOOR, UP, Stairs, Storey, metadata_of, stacked

from home_mjx import HouseBank, physics
from home_mjx.datasets.outlines import RoomOutline
from home_mjx.physics import PhysicsConfig, Template
from home_mjx.scene_compile.pipeline.compile import compile_house

PLAN = Storey([RoomOutline("Living_Room", [(0, 0), (8, 0), (8, 6), (0, 6)])])
SHAPES = {"corner": (2.0, 4.0), "back": (2.0, 4.0), "curve": (4.0, 5.0)}
STEPS, BESIDE = 240, 0.12  # control steps of a walk; [m] from a point of the way at which the next one is headed for
HALF = 0.8  # [m], from an agent's lowest point to its middle


def compiled(shape: str):
    house = stacked([PLAN, PLAN], [Stairs(SHAPES[shape], shape=shape)], house_id=shape)
    return compile_house(house, metadata_of(house))


def stops_of(house, count: int) -> np.ndarray:
    """Before the foot, the middle of each slope, beyond the head; the last one again until there are `count`."""
    ramps = house.ramps
    half = ramps.size[:, 0] * np.cos(ramps.slope)
    top = ramps.pos[:, :2] - ramps.size[:, 2:] * np.sin(ramps.slope)[:, None] * ramps.up
    ends = [top[0] - (half[0] + 0.4) * ramps.up[0]], [top[-1] + (half[-1] + 0.6) * ramps.up[-1]]
    stops = np.concatenate([ends[0], top, ends[1]])
    return np.concatenate([stops, np.repeat(stops[-1:], count - len(stops), axis=0)])


@pytest.fixture(scope="module", params=["fused", "kinematic"])
def walker(request):
    """Walks in all houses at once along points, and then stands."""
    houses = [compiled(shape) for shape in SHAPES]
    bank = HouseBank.from_compiled(houses)
    template = Template(PhysicsConfig(impl=request.param), bank.spec)
    most = max(len(h.ramps.slope) for h in houses) + 2
    stops = np.stack([stops_of(h, most) for h in houses])
    index = jnp.arange(len(houses), dtype=jnp.int32)

    def one(house, state, at, stops):
        place = state.qpos[:2]
        near = jnp.linalg.norm(stops[at] - place) < BESIDE
        at = jnp.minimum(at + near, stops.shape[0] - 1).astype(jnp.int32)
        way = stops[at] - place
        speed = way / jnp.maximum(jnp.linalg.norm(way), 0.3) * 0.6  # yaw stays 0: forward is x, left is y
        action = jnp.stack([speed[0], speed[1] / 0.7, jnp.zeros(())])[None]
        return physics.step(template, bank, house, state, action.astype(jnp.float32)), at

    @jax.jit
    def run(stops, start):
        state = jax.vmap(lambda h, p: physics.reset(template, bank, h, p[None], jnp.zeros(1)))(index, start)

        def step(carry, _):
            state, at = jax.vmap(one)(index, *carry, stops)
            return (state, at), state.qpos[:, :3]

        return jax.lax.scan(step, (state, jnp.zeros(len(houses), jnp.int32)), None, length=STEPS)[1]

    def walk(stops, height):
        start = np.concatenate([stops[:, 0], np.broadcast_to(height, (len(houses), 1))], axis=1)
        return np.asarray(run(jnp.asarray(stops, jnp.float32), jnp.asarray(start, jnp.float32)))

    return walk, stops, houses


def backwards(stops: np.ndarray, houses) -> np.ndarray:
    """From the head down to the foot."""
    found = []
    for way, house in zip(stops, houses, strict=True):
        count = len(house.ramps.slope) + 2
        down = way[:count][::-1]
        found.append(np.concatenate([down, np.repeat(down[-1:], len(way) - count, axis=0)]))
    return np.stack(found)


def test_agents_climb_stairs_that_turn_and_walk_down_again(walker):
    walk, stops, houses = walker
    up = walk(stops, FLOOR)
    assert_allclose(up[-1, :, 2], FLOOR + UP + HALF, atol=0.02)
    assert (np.diff(up[..., 2], axis=0) > -0.05).all()
    down = walk(backwards(stops, houses), FLOOR + UP)
    assert_allclose(down[-1, :, 2], FLOOR + HALF, atol=0.02)
    assert (np.diff(down[..., 2], axis=0) < 0.05).all()
    for found in (up, down):
        assert_allclose(found[-1, :, :2], found[-5, :, :2], atol=0.02)


def test_agents_stand_on_slopes_and_landings(walker):
    """On the middle of each slope they hardly move while they are told to stand."""
    walk, stops, houses = walker
    for i in (1, 2, 3):
        here = np.repeat(stops[:, i : i + 1], stops.shape[1], axis=1)
        ramps = [h.ramps for h in houses]
        height = [r.pos[i - 1, 2] + r.size[i - 1, 2] / np.cos(r.slope[i - 1]) for r in ramps]
        poses = walk_from(walk, here, np.array(height))
        assert np.linalg.norm(poses[100, :, :2] - here[:, 0], axis=1).max() < 0.1
        assert_allclose(poses[100], poses[140], atol=5e-3)
        assert (abs(poses[100, :, 2] - height - HALF) < 0.15).all()


def walk_from(walk, stops, height):
    """`walk` from heights of each house."""
    return walk(stops, height[:, None] + 0.02)
