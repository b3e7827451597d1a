"""What hands mean: exactly the middle of the view, or what is nearest to it."""

import functools
import math

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from handmade import Furniture, shoebox

import home_mjx
from home_mjx import HouseBank
from home_mjx.tasks import EnvConfig
from home_mjx.tasks.base.snapshot import AgentPose
from home_mjx.tasks.env.hand_actions import aim_directions, decode_hand_commands
from home_mjx.tasks.experts.hand_rays import nearest_hand_rays, round_to_steps, view_angles
from home_mjx.tasks.sensors.cameras import eye_position

CRATE = Furniture((0.7, 0.0), size=(0.2, 0.2, 1.7), mass=5.0)
HEAVY = Furniture((1.2, 0.0), size=(0.3, 3.0, 1.7), mass=50.0)  # a wall of a thing behind it


@pytest.fixture(scope="module")
def bank():
    return HouseBank.from_compiled([shoebox(furniture=[CRATE, HEAVY])])


@pytest.fixture(scope="module")
def picked(bank):
    """The body that `pick` means for an agent at the origin that looks along a yaw [degrees]."""

    @functools.cache
    def commands_of(max_aim_angle: float):
        env = home_mjx.make(
            "PointNav-v0", bank, hands=True, max_aim_angle=max_aim_angle, impl="kinematic", sensors=("state",)
        )
        state = jax.jit(env.reset)(jax.random.key(0))

        @jax.jit
        def commands(yaw):
            pose = jnp.stack([0.0, 0.0, env.config.body.height / 2, yaw])
            there = state.replace(physics=state.physics.replace(qpos=state.physics.qpos.at[:4].set(pose)))
            return decode_hand_commands(env.config, env.core.snapshot(env.params, there), jnp.array([[1.0, 0.0, 0.0]]))

        return commands

    return lambda max_aim_angle, degrees: int(commands_of(max_aim_angle)(jnp.float32(np.radians(degrees))).pick[0])


def test_the_middle_of_the_view_is_exact_by_default(picked):
    """The crate covers 9.5 degrees to both sides; beyond it the heavy thing is meant, which nobody can lift."""
    assert picked(0.0, 7.0) == 0
    assert picked(0.0, 14.0) == 1
    assert picked(0.0, -14.0) == 1


def test_with_an_angle_it_is_the_nearest_that_can_be_lifted(picked):
    assert picked(10.0, 14.0) == 0
    assert picked(10.0, -14.0) == 0
    assert picked(10.0, 25.0) == 1  # farther away than that


def test_rays_are_ordered_from_the_middle(bank):
    env = home_mjx.make("PointNav-v0", bank, hands=True, max_aim_angle=10.0, impl="kinematic", sensors=("state",))
    state = jax.jit(env.reset)(jax.random.key(0))
    pose = env.core.snapshot(env.params, state).pose
    rays = np.asarray(aim_directions(env.config, pose))[0]
    assert rays.shape == (81, 3)
    np.testing.assert_allclose(np.linalg.norm(rays, axis=1), 1, atol=1e-6)
    away = np.degrees(np.arccos(np.clip(rays @ rays[0], -1, 1)))
    assert (np.diff(away) > -0.3).all()
    assert 9.9 < away.max() < 14.3


@pytest.mark.parametrize("angle", [0.0, 10.0])
@pytest.mark.parametrize("actions", ["discrete", "continuous"])
def test_experts_know_the_rays_of_hands_after_a_turn(angle, actions, rng):
    """By a search of all rays of the view that is turned: the rays returned are among these, and nearest to points."""
    config = EnvConfig(hands=True, max_aim_angle=angle, actions=actions)
    pose = AgentPose(pos=jnp.zeros((1, 3)), yaw=jnp.ones(1), pitch=jnp.zeros(1))
    points = eye_position(config, pose) + jnp.asarray(rng.normal(size=(40, 3)) * (1, 1, 0.3), jnp.float32)
    found = np.asarray(nearest_hand_rays(config, pose, points[None], math.radians(angle)))[0]
    turns = round_to_steps(config, *view_angles(config, pose, points[None]), pose.pitch)
    for at, (turn, tilt) in enumerate(zip(*(np.asarray(x)[0] for x in turns), strict=True)):
        view = AgentPose(pos=pose.pos, yaw=pose.yaw + turn, pitch=pose.pitch + tilt)
        rays = np.asarray(aim_directions(config, view), np.float64)[0]
        way = np.asarray(points[at] - eye_position(config, pose)[0], np.float64)
        x, y, z = np.concatenate([rays, way[None] / np.linalg.norm(way)]).T
        angles = np.stack([np.unwrap(np.arctan2(y, x)), np.arcsin(z)])
        nearest = np.argmin(np.hypot(*(angles[:, :-1] - angles[:, -1:])))
        np.testing.assert_allclose(found[at], rays[nearest], atol=2e-5)
