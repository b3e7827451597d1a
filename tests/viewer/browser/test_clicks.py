"""Lamps and appliances that a click switches, contacts on cards, and overlays of lamps and distances."""

from dataclasses import replace

import jax
import numpy as np
import pytest
from handmade import Furniture, shoebox
from lit_scenes import table

import home_mjx
from home_mjx.bank.bank import HouseBank
from home_mjx.schema.categories import fine_index
from home_mjx.schema.semantic import Semantic
from home_mjx.tasks.base.state import State
from home_mjx.viewer.browser.clicks import ObjectConditions, find_switch, toggle_switch
from home_mjx.viewer.browser.live_overlays import DARK_COLOUR, LAMP_REACH, LIT_COLOUR, LiveLines
from home_mjx.viewer.browser.object_card import format_card
from home_mjx.viewer.browser.scene.house_layers import distance_points
from home_mjx.viewer.browser.scene.house_scene import HouseScene, InstanceGroup
from home_mjx.viewer.episodes.goal_markers import GoalMarkers

LAMP, RADIO, STOOL = 0, 1, 2  # objects of the room, in their order


@pytest.fixture(scope="module")
def env():
    """A room with a box that carries a lamp, a loudspeaker, and a movable stool."""
    lamp, radio = (Furniture((1.5, y), (0.3, 0.3, 1.2)) for y in (1.5, -1.5))
    house = shoebox((6.0, 5.0, 3.0), furniture=(lamp, radio, Furniture((-1.5, -1.5), (0.4, 0.4, 0.5), mass=3.0)))
    rows = house.semantics.copy()
    rows[house.instances.semantic[2], Semantic.FINE] = fine_index("loudspeaker")
    light = table({"instance": 1, "intensity": (1.0,) * 3, "pos": (0, 0, 0.5)})
    bank = HouseBank.from_compiled([replace(house, lights=light, semantics=rows)])
    return home_mjx.make("PointNav-v0", bank, sensors=("state",), impl="kinematic", ctrl_dt=0.1, switches="initial")


@pytest.fixture(scope="module")
def state(env) -> State:
    return jax.jit(env.core.reset)(env.params, jax.random.key(0))


def cards(env, state: State) -> dict[int, str]:
    """Return the cards of all objects by id."""
    moving = jax.tree.map(np.asarray, env.core.snapshot(env.params, state).scene.moving)
    conditions = ObjectConditions(env)

    def card(group: InstanceGroup, n: int) -> str:
        return format_card(env.bank, 0, group, n, conditions.describe(state, group, n))

    groups = HouseScene(env.bank, 0, moving).groups
    return {int(group.objects[n]): card(group, n) for group in groups for n in range(len(group.entries))}


def test_a_click_switches_a_lamp_and_its_cross_gets_dark(env, state: State):
    assert [find_switch(env.bank, 0, number) for number in (-1, LAMP, RADIO, STOOL)] == [None, 0, 1, None]
    dark, loud = toggle_switch(state, 0), toggle_switch(state, 1)
    before, after = cards(env, state), cards(env, dark)
    assert "| lamp | on; click to change |" in before[LAMP]
    assert "| lamp | off; click to change |" in after[LAMP]
    assert "| radio | off; click to change |" in before[RADIO]
    assert "| radio | on; click to change |" in cards(env, loud)[RADIO]
    lines, colours = LiveLines(env).lamps(state)
    assert lines.mean(axis=1) == pytest.approx(np.array([[1.5, 1.5, lines.mean(axis=(0, 1))[2]]] * 3), abs=1e-5)
    assert np.linalg.norm(lines[:, 1] - lines[:, 0], axis=1) == pytest.approx(2 * LAMP_REACH)
    assert np.array_equal(np.unique(colours.reshape(-1, 3), axis=0), [LIT_COLOUR])
    assert np.array_equal(np.unique(LiveLines(env).lamps(dark)[1].reshape(-1, 3), axis=0), [DARK_COLOUR])
    assert np.array_equal(LiveLines(env).lamps(loud)[1], colours)


def test_the_card_says_what_an_object_touches_and_absorbs(env, state: State):
    row = 1  # after the agent
    physics = state.physics
    touched = state.replace(
        physics=physics.replace(
            contact_impulse=physics.contact_impulse.at[row].set(10.0),  # 100 N in a step of 0.1 s
            contact_partner=physics.contact_partner.at[row].set(-2),
        )
    )
    assert "touches" not in cards(env, state)[STOOL]
    card = cards(env, touched)[STOOL]
    assert "| touches | the floor, 100 N |" in card
    material = int(env.bank.geometry.instance_material[0, 1 + STOOL])
    share = 100 * np.asarray(env.bank.materials.absorption)[material][[0, 3, 6]]
    assert f"| absorption | {' / '.join(f'{x:.0f}' for x in share)} % at 125 / 1000 / 8000 Hz |" in card


def test_distances_to_the_goal_grow_with_the_octile_metric(env):
    goal = np.array([-2.0, 1.5, 0.0])
    points, distance = distance_points(env.bank, 0, GoalMarkers(goal[None], np.zeros(1, bool)))
    away = np.abs(points[:, :2] - goal[:2])
    free = points[:, 0] < -1.0  # no furniture on the way
    octile = away.max(axis=1) + (np.sqrt(2) - 1) * away.min(axis=1)
    assert free.sum() > 50
    assert np.abs(distance - octile)[free & (points[:, 1] > -0.5)].max() < 0.15
    assert not len(distance_points(env.bank, 0, GoalMarkers(np.zeros((0, 3)), np.zeros(1, bool)))[0])
