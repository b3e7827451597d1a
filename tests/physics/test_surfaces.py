"""Friction and restitution of movable bodies, against closed forms."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from numpy.testing import assert_allclose
from tiny_houses import Box, TinyHouse, make_bank

from home_mjx import physics
from home_mjx.physics import PhysicsSetup, Template
from home_mjx.schema import Timing

GRAVITY, DT = 9.81, 0.01
FRICTION = (0.2, 0.4, 0.7)
SPEEDS = (1.5, 2.0, 3.0)
RESTITUTION = (0.0, 0.3, 0.6, 0.8)
CLEAR = 2e-3  # [m]: what hops lower does so within a physics step or two
HEIGHTS = np.linspace(0.4, 0.5, 16)  # [m], of falls: 16 phases of the physics step in which the floor is met


class Run:
    """Poses and speeds of the bodies of all houses after each physics step."""

    def __init__(self, houses, steps, velocity=None, **options):
        bank = make_bank(houses)
        template = Template(PhysicsSetup(timing=Timing(ctrl_dt=DT, sim_dt=DT), **options), bank.spec)
        layout, house = template.layout, jnp.arange(len(houses), dtype=jnp.int32)
        away = jnp.array([[50.0, 50.0, 0.0]])
        state = jax.vmap(lambda h: physics.reset(template, bank, h, away, jnp.zeros(1)))(house)
        if velocity is not None:
            given = jnp.asarray(velocity, jnp.float32).reshape(len(houses), -1)
            state = state.replace(qvel=state.qvel.at[:, layout.body_qvel].set(given))
        one = jax.vmap(lambda h, s: physics.step(template, bank, h, s, jnp.zeros((1, 3))))
        _, states = jax.lax.scan(lambda s, _: (one(house, s),) * 2, state, None, length=steps)
        self.pose, self.speed = (
            np.asarray(x, float)[..., at].reshape(steps, len(houses), -1, size)
            for x, at, size in ((states.qpos, layout.body_qpos, 7), (states.qvel, layout.body_qvel, 6))
        )


def test_a_box_slides_as_far_as_its_friction_lets_it():
    """v^2 / (2 mu g): the work of friction is the energy at the start."""
    rows = [
        Box((0, y, 0.0995), (0.2, 0.2, 0.1), mass=3, friction=mu) for y, mu in zip((0, 2, 4), FRICTION, strict=True)
    ]
    velocity = np.zeros((len(SPEEDS), 4, 6))
    velocity[..., 0] = np.array(SPEEDS)[:, None]
    run = Run([TinyHouse(movable=rows)] * len(SPEEDS), 250, velocity)
    distance = run.pose[-1, :, :3, 0]
    assert_allclose(distance, np.square(SPEEDS)[:, None] / (2 * np.array(FRICTION) * GRAVITY), rtol=0.1)
    assert (run.speed[-1, :, :3] == 0).all()  # and sleeps


def test_a_slope_holds_what_is_rough_enough():
    """Steeper than mu it slides with g (sin - mu cos); otherwise it stays."""
    slope = np.deg2rad(20)
    at = [(x, -0.3 * np.sin(slope), 0.8 + 0.3 * np.cos(slope)) for x in (-1, 0, 1)]
    boxes = [Box(p, (0.1,) * 3, mass=2, roll=slope, friction=mu) for p, mu in zip(at, (0.2, 0.5, 0.7), strict=True)]
    run = Run([TinyHouse(static=[Box((0, 0, 0.8), (2, 2, 0.2), roll=slope)], movable=boxes)], 60)
    moved = np.linalg.norm(run.pose[-1, 0, :3, :3] - np.array(at), axis=-1)
    time = 60 * DT
    assert_allclose(moved[0], GRAVITY * (np.sin(slope) - 0.2 * np.cos(slope)) * time**2 / 2, rtol=0.1)
    assert (moved[1:] < 0.01).all()


@pytest.fixture(scope="module")
def falls():
    """Boxes of all restitutions, from all heights, flat."""
    houses = [
        TinyHouse(
            movable=[Box((2 * k, 0, h + 0.1), (0.1,) * 3, mass=2, restitution=e) for k, e in enumerate(RESTITUTION)]
        )
        for h in HEIGHTS
    ]
    return Run(houses, 700)


def peaks(height) -> list[float]:
    """The highest points after each bounce [m]."""
    up = np.diff(height) > 0
    return height[1:-1][up[:-1] & ~up[1:]].tolist()


def test_boxes_bounce_by_their_restitution(falls):
    """It is a ratio of speeds, so its square is one of heights; the phase of the physics step decides the rest."""
    height = falls.pose[..., 2] - 0.1
    for k, e in enumerate(RESTITUTION):
        first = [max([p for p in peaks(height[:, i, k]) if p > CLEAR], default=0.0) for i in range(len(HEIGHTS))]
        found = np.sqrt(np.array(first) / HEIGHTS)
        assert_allclose(found.mean(), e, atol=0.05 if e else 0.15)
        assert_allclose(found, e, atol=0.2 if e else 0.3)


def test_bouncing_never_gains_energy(falls):
    """Each bounce is lower than the one before, and all come to rest and sleep."""
    height = falls.pose[..., 2] - 0.1
    for i, start in enumerate(HEIGHTS):
        for k in range(len(RESTITUTION)):
            tops = [start, *(top for top in peaks(height[:, i, k]) if top > CLEAR)]
            assert (np.diff(tops) < 1e-3).all()
    assert (falls.speed[-1] == 0).all()
    assert_allclose(height[-1], 0, atol=5e-3)


def test_tumbling_never_gains_energy():
    """Cubes that fall askew and spin, as bouncy as can be.

    Semi-implicit steps keep g z + v^2 / 2 - g dt v / 2 in flight, and cubes their spin.
    """
    rng = np.random.default_rng(3)
    houses = [
        TinyHouse(
            movable=[
                Box((2 * k, 0, 0.6), (0.1,) * 3, rng.uniform(-3, 3), 2, rng.uniform(-1, 1), restitution=0.9)
                for k in range(4)
            ]
        )
        for _ in range(8)
    ]
    spin = np.zeros((8, 4, 6))
    spin[..., 3:] = rng.uniform(-3, 3, (8, 4, 3))
    run = Run(houses, 400, spin)
    energy = GRAVITY * run.pose[..., 2] + (run.speed[..., :3] ** 2).sum(-1) / 2 - GRAVITY * DT * run.speed[..., 2] / 2
    energy += 2 / 3 * 0.1**2 * (run.speed[..., 3:] ** 2).sum(-1) / 2
    assert (energy.max(axis=0) < 1.0001 * energy[0]).all()
    assert (energy[-1] < 0.8 * energy[0]).all()


def test_of_two_bodies_the_rougher_and_the_duller_decide():
    """A bouncy box falls on a dull one, and on a bouncy one; a slippery one slides on a rough one."""
    ball, low = {"mass": 0.5, "restitution": 0.6}, (0.3, 0.3, 0.1)
    fall = [
        Box((0, 0, 0.1), low, mass=80), Box((0, 0, 0.7), (0.1,) * 3, **ball),
        Box((3, 0, 0.1), low, mass=80, restitution=0.6), Box((3, 0, 0.7), (0.1,) * 3, **ball),
    ]  # fmt: skip
    slide = [
        Box((0, 0, 0.1), (2, 0.5, 0.1), mass=200, friction=0.7),
        Box((-1, 0, 0.2995), (0.1,) * 3, mass=1, friction=0.1),
    ]
    velocity = np.zeros((2, 4, 6))
    velocity[1, 1, 0] = 2.0
    run = Run([TinyHouse(movable=fall), TinyHouse(movable=slide)], 120, velocity)
    tops = [max(peaks(run.pose[:, 0, k, 2] - 0.3), default=0.0) for k in (1, 3)]
    assert tops[0] < 0.03
    assert 0.4 * 0.45**2 < tops[1] < 0.4 * 0.75**2
    assert_allclose(run.pose[-1, 1, 1, 0] + 1, 2.0**2 / (2 * 0.7 * GRAVITY), rtol=0.15)


def test_options_override_materials():
    box = Box((0, 0, 0.0995), (0.2, 0.2, 0.1), mass=3, friction=0.7)
    ball = Box((2, 0, 0.6), (0.1,) * 3, mass=3, restitution=0.0)
    velocity = np.zeros((1, 4, 6))
    velocity[0, 0, 0] = 1.5
    run = Run([TinyHouse(movable=[box, ball])], 200, velocity, friction=0.2, restitution=0.3)
    assert_allclose(run.pose[-1, 0, 0, 0], 1.5**2 / (2 * 0.2 * GRAVITY), rtol=0.1)
    assert_allclose(np.sqrt(max(peaks(run.pose[:, 0, 1, 2] - 0.1)) / 0.5), 0.3, atol=0.15)
