"""The batched template against C MuJoCo, which steps the same houses with its own collision code, converged."""

import jax.numpy as jnp
import mujoco
import numpy as np
import pytest
from numpy.testing import assert_allclose
from rollouts import ACTIONS, LENGTH, SCENES
from test_physics_model import host_spec
from tiny_houses import TinyHouse

from home_mjx.physics.mjx.contact_slots import MIN_HEIGHT_ABOVE_FLOOR, OrientedBoxes


def _control(config, yaw_inertia, action, data):
    """Motor forces of agent 0, from the documentation of `motor_forces`."""
    yaw, velocity = data.qpos[3], data.qvel[:4]
    target = np.array(action, float) * [config.body.forward_speed, config.body.strafe_speed, config.body.turn_rate]
    turn = np.array([[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]])
    force = config.body.mass * (turn @ target[:2] - velocity[:2]) / config.response_time
    force *= min(1.0, config.body.max_push_force / max(np.linalg.norm(force), 1e-9))
    return [*force, yaw_inertia * (target[2] - velocity[3]) / config.response_time]


def _all_static(template, house: TinyHouse) -> OrientedBoxes:
    """Every owner's slots with the same static boxes: those nearest to the middle."""
    layout = template.layout
    static = sorted(house.static, key=lambda b: np.hypot(*b.pos[:2]))
    static = [b for b in static if b.pos[2] + b.size[2] > house.floor + MIN_HEIGHT_ABOVE_FLOOR]
    rows = []
    for num in [layout.agent_slots] * layout.num_agents + [layout.body_slots] * layout.num_bodies:
        for s in range(num):
            far = ((0, 0, -500), (1, 0, 0, 0), (0.1, 0.1, 0.1))
            rows.append((static[s].pos, static[s].quat, static[s].size) if s < len(static) else far)
    return OrientedBoxes(*(jnp.array(column, jnp.float32) for column in zip(*rows, strict=True)))


def _simulate(template, name):
    house, config = SCENES[name], template.config
    spec = host_spec(template, house, _all_static(template, house))
    spec.option.iterations, spec.option.ls_iterations = 100, 50
    model = spec.compile()
    data = mujoco.MjData(model)
    data.qpos[2] = house.floor + config.body.height / 2
    layout = template.layout
    agents, bodies = [], []
    for _ in range(LENGTH):
        for _ in range(config.timing.substeps):
            data.ctrl[:] = _control(config, model.dof_M0[3], ACTIONS.get(name, (1, 0, 0)), data)
            mujoco.mj_step(model, data)
        agents.append(data.qpos[:4].copy())
        bodies.append(data.qpos[layout.body_qpos].reshape(-1, 7).copy())
    return np.array(agents), np.array(bodies)


@pytest.mark.parametrize("name", ["wall", "slide", "light", "wardrobe", "sofa"])
def test_agent_and_what_it_pushes_move_as_in_c(world, name):
    agents, bodies = _simulate(world.template, name)
    scene, used = world.scene(name), len(SCENES[name].movable)
    assert_allclose(scene.agent_pos[:, 0], agents[:, :3], atol=2e-3)
    assert_allclose(scene.agent_yaw[:, 0], agents[:, 3], atol=1e-3)
    assert_allclose(scene.body_pos[:, :used], bodies[:, :used, :3], atol=3e-3)


def test_falling_boxes_follow_c_and_rest_where_they_do(world):
    _, bodies = _simulate(world.template, "fall")
    scene = world.scene("fall")
    assert_allclose(scene.body_pos, bodies[:, :, :3], atol=3e-3)
    assert_allclose(scene.body_pos[-1], bodies[-1, :, :3], atol=1e-4)
    assert_allclose(np.abs(np.sum(scene.body_quat[-1] * bodies[-1, :, 3:], axis=-1)), 1.0, atol=1e-4)


def test_boxes_of_all_surfaces_slide_and_bounce_as_in_c(world):
    _, bodies = _simulate(world.template, "surfaces")
    scene = world.scene("surfaces")
    assert_allclose(scene.body_pos[:, 1:], bodies[:, 1:, :3], atol=3e-3)
    # After 0.6 s MJX's contacts of the box that slides down the slope are others than C's, and it jams.
    assert_allclose(scene.body_pos[:6, 0], bodies[:6, 0, :3], atol=3e-3)
    assert scene.body_pos[9:, 3, 2].max() > 0.4  # it has bounced


def test_tilted_boxes_come_to_rest_as_in_c(world):
    _, bodies = _simulate(world.template, "free")
    assert_allclose(world.scene("free").body_pos[-1, :2], bodies[-1, :2, :3], atol=0.01)
