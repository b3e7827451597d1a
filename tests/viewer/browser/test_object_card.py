"""Cards of clicked objects, doors, overlays and keys, against the bank and the environment."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from handmade import Furniture, shoebox, two_rooms

import home_mjx
from home_mjx import physics
from home_mjx.bank.bank import HouseBank
from home_mjx.navigation.grid import cell_position
from home_mjx.raycast_render.scene.scene import make_open_scene
from home_mjx.tasks.base.config import EnvConfig
from home_mjx.viewer.browser.clicks import find_door, toggle_door
from home_mjx.viewer.browser.object_card import format_card
from home_mjx.viewer.browser.overlays import LIFT, grid_points
from home_mjx.viewer.browser.scene.house_scene import MOVING, HouseScene
from home_mjx.viewer.episodes.held_keys import HeldKeys, HeldKeysPlayer


def test_the_card_has_the_object_s_own_figures():
    chair = Furniture((1.0, 0.5), (0.5, 0.4, 0.9), yaw=0.7, mass=5.25, category="chair")
    table = Furniture((-1.0, 0.0), (1.0, 0.6, 0.7), category="ottoman")
    bank = HouseBank.from_compiled([shoebox(furniture=(chair, table))])
    house = HouseScene(bank, 0, make_open_scene(bank, 0).moving)
    cards = [
        format_card(bank, 0, group, n)
        for group in house.groups
        for n in range(len(group.entries))
        if group.objects[n] >= 0
    ]
    assert len(cards) == 2
    by_name = {card.split("**")[1]: card for card in cards}
    assert "0.50 × 0.40 × 0.90 m" in by_name["chair"]
    assert "| mass | 5.25 kg |" in by_name["chair"]
    assert "1.00 × 0.60 × 0.70 m" in by_name["ottoman"]
    assert "| mass | fixed |" in by_name["ottoman"]


def test_grid_points_are_the_cells_of_the_navigation_grid():
    bank = HouseBank.from_compiled([two_rooms()])
    points = grid_points(bank, 0)
    assert len(points) == int(bank.navigation.num_cells[0]) > 10
    for number in (0, 7, len(points) - 1):
        expected = np.asarray(cell_position(bank, jnp.int32(0), jnp.int32(number)))
        np.testing.assert_allclose(points[number], expected + LIFT, atol=1e-5)


def test_held_keys_add_up_and_short_presses_count():
    keys = HeldKeys()
    player = HeldKeysPlayer(EnvConfig(), (keys,))
    assert player.act(None).tolist() == [0, 0, 0, 0]
    for key in "wa":
        keys.handle({"type": "keydown", "key": key})
    assert player.act(None).tolist() == player.act(None).tolist() == [1, 0, 1, 0]
    keys.handle({"type": "keyup", "key": "w"})
    keys.handle({"type": "keydown", "key": "d"})
    assert player.act(None).tolist() == [0, 0, 0, 0]  # left and right
    keys.handle({"type": "release"})
    keys.handle({"type": "keydown", "key": "w"})
    keys.handle({"type": "keyup", "key": "w"})
    assert player.act(None).tolist() == [1, 0, 0, 0]
    assert player.act(None).tolist() == [0, 0, 0, 0]
    for message in ({}, {"type": "keydown"}, {"type": "keydown", "key": 3}, {"type": "x", "key": "w"}):
        keys.handle(message)
    assert keys.held() == ()


def test_discrete_actions_wait_for_a_press():
    keys = HeldKeys()
    player = HeldKeysPlayer(EnvConfig(actions="discrete"), (keys,))
    assert player.act(None) is None
    keys.handle({"type": "keydown", "key": "w"})
    keys.handle({"type": "keyup", "key": "w"})
    assert (player.act(None), player.act(None)) == (1, None)


@pytest.mark.slow
def test_a_click_opens_and_closes_a_door(tmp_path):
    from generated import flat_id, generate_flats

    generate_flats(tmp_path, [0])
    bank = home_mjx.load_bank(str(tmp_path), ids=[flat_id(0)])
    env = home_mjx.make("PointNav-v0", bank, sensors=("state",), impl="kinematic", doors="closed")
    state = env.core.reset(env.params, jax.random.key(0), observe=False)
    moving = jax.tree.map(np.asarray, env.core.snapshot(env.params, state).scene.moving)
    groups = [group for group in HouseScene(bank, 0, moving).groups if group.layer == MOVING]
    doors = {find_door(bank, 0, group, n) for group in groups for n in range(len(group.entries))} - {None}
    assert doors == set(np.flatnonzero(bank.physics.door_valid[0]).tolist())
    door = min(doors)
    template = env.core.template(bank)
    wide = toggle_door(env, state, door)
    before, after = (np.asarray(physics.door_angle(template, s.physics)) for s in (state, wide))
    assert after[door] == pytest.approx(float(bank.physics.door_fully_open[0, door]))
    np.testing.assert_array_equal(np.delete(after, door), np.delete(before, door))
    again = toggle_door(env, wide, door)
    assert float(physics.door_angle(template, again.physics)[door]) == pytest.approx(before[door], abs=1e-6)
