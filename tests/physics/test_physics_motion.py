"""What agents and bodies do within two seconds."""

import numpy as np
from numpy.testing import assert_allclose
from rollouts import SCENES

from home_mjx.schema.timing import Timing

RADIUS, HEIGHT = 0.1, 1.6


def test_agent_stands_on_the_floor_and_turns_while_walking(world):
    free = world.scene("free")
    assert_allclose(free.agent_pos[:, 0, 2], HEIGHT / 2, atol=2e-3)
    assert not free.contact.any()
    # Steady after a few response times of 0.1 s; the frame turns, so forward speed trails a little behind.
    assert_allclose(free.agent_velocity[10:, 0, 2], np.pi / 2, rtol=1e-3)
    assert_allclose(free.agent_velocity[10:, 0, 0], 1.0, atol=0.05)
    # A circle of radius v / w around (0, v / w), as left is +y.
    yaw = free.agent_yaw[-1, 0]
    center = free.agent_pos[-1, 0, :2] + np.array([-np.sin(yaw), np.cos(yaw)]) * 2 / np.pi
    assert_allclose(center, [0.05, 0.6], atol=0.12)


def test_light_box_is_pushed_far_and_wardrobe_hardly(world):
    light, wardrobe, sofa = (world.scene(name).body_pos[:, 0, 0] for name in ("light", "wardrobe", "sofa"))
    assert light[-1] - 0.5 >= 0.2
    assert wardrobe[-1] - 0.65 < 0.02
    assert wardrobe[-1] - 0.65 < sofa[-1] - 0.6 < light[-1] - 0.5
    assert_allclose(world.scene("wardrobe").body_quat[-1, 0], [1, 0, 0, 0], atol=5e-3)


def test_agent_is_stopped_by_a_wall(world):
    wall = world.scene("wall")
    surface = 1.5 - RADIUS
    assert wall.agent_pos[:, 0, 0].max() < surface + 5e-3
    assert wall.agent_pos[-1, 0, 0] > surface - 5e-3
    touches = wall.agent_pos[:, 0, 0] > surface - 1e-3
    assert (wall.contact[:, 0] == touches).all()
    assert touches.any()
    assert not touches.all()


def test_agent_slides_along_the_seams_of_a_wall(world):
    slide = world.scene("slide")
    expected = 0.7 * 0.1 * np.arange(1, 21)  # strafe speed
    assert slide.agent_pos[-1, 0, 1] > expected[-1] - 0.1
    assert slide.agent_velocity[8:, 0, 1].min() > 0.65
    assert slide.agent_pos[:, 0, 0].max() < 1.5 - RADIUS + 5e-3


def test_bodies_fall_come_to_rest_and_stack(world):
    fall = world.scene("fall")
    assert_allclose(fall.body_pos[-1, :, 2], [0.1, 0.5, 0.2, 0.5], atol=2e-3)  # the last on the one before
    assert_allclose(fall.body_pos[-1, 1:, :2], [b.pos[:2] for b in SCENES["fall"].movable[1:]], atol=2e-3)
    assert np.abs(fall.body_pos[-1] - fall.body_pos[-4]).max() < 1e-4


def test_tilted_boxes_stop_rocking(world):
    free = world.scene("free")
    assert np.abs(free.body_pos[-1, :2] - free.body_pos[-4, :2]).max() < 1e-4
    assert_allclose(free.body_pos[-1, :2, 2], [0.1, 0.5], atol=2e-3)


def test_free_fall_is_that_of_gravity(world):
    # Semi-implicit Euler: after n steps the fall is g dt^2 n (n + 1) / 2.
    drop = 1.0 - world.scene("fall").body_pos[:3, 0, 2]
    timing = Timing()
    n = timing.substeps * np.arange(1, 4)
    assert_allclose(drop, 9.81 * timing.sim_dt**2 * n * (n + 1) / 2, rtol=1e-4)


def test_what_lies_flat_on_the_floor_is_no_contact(world):
    fall = world.scene("fall")  # the agent stands on a rug of 8 mm
    assert not fall.contact.any()
    assert_allclose(fall.agent_pos[:, 0, 2], HEIGHT / 2, atol=2e-3)


def test_nothing_passes_through_anything_in_a_crowd(world):
    crowd, house = world.scene("crowded"), SCENES["crowded"]
    wall = house.static[0]
    normal = np.array([np.cos(wall.yaw), np.sin(wall.yaw)])
    side = (crowd.agent_pos[:, 0, :2] - np.array(wall.pos[:2])) @ normal
    assert side.max() < -wall.size[0] - RADIUS + 5e-3
    # A fall of a metre presses a box a few centimetres into the floor for a moment; half its least edge is 0.15 m.
    assert (crowd.body_pos[..., 2] > house.floor + 0.09).all()
    assert (crowd.body_pos[-8:, :, 2] > house.floor + 0.14).all()
    assert np.isfinite(crowd.body_quat).all()
