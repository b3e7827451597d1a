"""Leaves that open: what they would sweep over, and what who carries something does about it."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import home_mjx
from home_mjx.physics.base.doors import DoorLeaves
from home_mjx.tasks.experts.door_avoidance import is_shut, is_swept, plan_opening


@pytest.fixture(scope="module")
def snapshot(generated_bank):
    env = home_mjx.make("Fetch-v0", generated_bank, sensors=("state",), num_tasks=2, impl="kinematic")
    state = jax.jit(lambda key: env.core.reset(env.params, key, None, 0, observe=False))(jax.random.key(0))
    return env.core.snapshot(env.params, state)


def half_shut(snapshot, part):
    """The same with all doors closed by a part of the way."""
    physics, house = snapshot.bank.physics, snapshot.house
    wide, closed = physics.door_fully_open[house], physics.door_closed[house]
    return snapshot.replace(door_angle=wide + part * (closed - wide))


def gaps_while_opening(snapshot, door, place, steps=400):
    """Brute force: the least distance of places from a leaf at every angle until it is wide, leaves being thin."""
    leaf = jax.tree.map(
        lambda x: np.asarray(x[snapshot.house, door], float), DoorLeaves.from_physics(snapshot.bank.physics)
    )
    wide = float(snapshot.bank.physics.door_fully_open[snapshot.house, door])
    found = np.full(len(place), np.inf)
    for angle in np.linspace(float(snapshot.door_angle[door]), wide, steps):
        cos, sin = np.cos(angle), np.sin(angle)
        end = 2 * (np.array([[cos, -sin], [sin, cos]]) @ leaf.arm)
        part = np.clip((place - leaf.pivot) @ end / (end @ end), 0, 1)
        found = np.minimum(found, np.linalg.norm(place - leaf.pivot - part[:, None] * end, axis=-1))
    return found


@pytest.mark.parametrize("part", [0.6, 0.8, 1.0])
def test_leaves_sweep_over_what_they_meet_at_any_angle(snapshot, rng, part):
    snapshot = half_shut(snapshot, part)
    doors = np.flatnonzero(np.asarray(is_shut(snapshot)))
    assert doors.size
    for door in doors:
        pivot = np.asarray(snapshot.bank.physics.door_pivot[snapshot.house, door])
        place = pivot + rng.uniform(-1.5, 1.5, (500, 2))
        radius = rng.uniform(0.05, 0.3, 500)
        height = np.full((500, 1), float(snapshot.pose.pos[0, 2]))
        given = jnp.asarray(np.hstack([place, height]), jnp.float32), jnp.asarray(radius, jnp.float32)
        found, gap = np.asarray(jax.jit(is_swept)(snapshot, *given))[:, door], gaps_while_opening(snapshot, door, place)
        assert found[gap < radius - 0.03].all()  # leaves are 4 cm thick
        assert (gap[found] < np.sqrt(2) * radius[found] + 0.03).all()  # beside the free edge a little more


def test_open_doors_and_empty_hands_are_in_nobodys_way(snapshot):
    busy, right, _ = plan_opening(half_shut(snapshot, 0.0).replace(held=jnp.zeros(1, jnp.int32)))
    assert not busy.any()
    assert not right.any()
    busy, _, _ = plan_opening(half_shut(snapshot, 0.7).replace(held=jnp.full(1, -1, jnp.int32)))
    assert not busy.any()


def test_who_carries_something_gets_out_of_the_way_of_a_leaf_and_opens_it_from_there(snapshot):
    """Walked by hand, without walls: from beside the middle of a half shut leaf to where it may be opened."""
    snapshot = half_shut(snapshot, 0.6).replace(held=jnp.zeros(1, jnp.int32))
    door = int(np.flatnonzero(np.asarray(is_shut(snapshot)))[0])
    leaf = jax.tree.map(
        lambda x: np.asarray(x[snapshot.house, door], float), DoorLeaves.from_physics(snapshot.bank.physics)
    )
    wide = float(snapshot.bank.physics.door_fully_open[snapshot.house, door])
    angle = (float(snapshot.door_angle[door]) + wide) / 2
    cos, sin = np.cos(angle), np.sin(angle)
    place = leaf.pivot + np.array([[cos, -sin], [sin, cos]]) @ leaf.arm  # halfway of what it will sweep over
    look = jax.jit(plan_opening)
    for _ in range(40):
        pos = jnp.asarray([[*place, float(snapshot.pose.pos[0, 2])]], jnp.float32)
        busy, right, face = look(snapshot.replace(pose=snapshot.pose.replace(pos=pos)))
        assert busy[0]
        if right[0]:
            break
        place = place + 0.1 * np.array([np.cos(float(face[0])), np.sin(float(face[0]))])
    assert right[0]
    assert gaps_while_opening(snapshot, door, place[None])[0] > snapshot.bank.spec.agent_radius
