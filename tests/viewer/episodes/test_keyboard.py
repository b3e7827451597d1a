"""Keys become actions; pictures become text."""

import io

import numpy as np
import pytest

from home_mjx.tasks import EnvConfig, make_config
from home_mjx.tasks.env.actions import action_names
from home_mjx.viewer.episodes.keyboard import KeyboardPlayer, image_to_text, key_actions, key_help, read_keys


def typed(config: EnvConfig, text: str, num: int) -> list:
    player = KeyboardPlayer(config, io.StringIO(text))
    return [player.act(None) for _ in range(num)]


def test_every_discrete_action_has_a_key_of_its_own():
    for hands in (False, True):
        config = EnvConfig(actions="discrete", hands=hands)
        actions = key_actions(config)
        assert sorted(actions.values()) == list(range(len(action_names(config))))
        assert "q" not in actions
        assert all(name in key_help(config) for name in action_names(config))


def test_lines_are_played_until_q_and_until_their_end():
    config = EnvConfig(actions="discrete")
    names = action_names(config)
    wanted = [names.index(name) for name in ("move_forward", "turn_left", "turn_right", "stop")]
    assert typed(config, "W?a\nd \n", 5) == [*wanted, None]
    assert typed(config, "wqw", 2) == [names.index("move_forward"), None]


def test_continuous_keys_move_one_number():
    forward, turn, wait = typed(EnvConfig(), "wd ", 3)
    assert (forward.tolist(), turn.tolist(), wait.tolist()) == ([1, 0, 0, 0], [0, 0, -1, 0], [0, 0, 0, 0])


def test_other_agents_do_nothing():
    (action,) = typed(make_config(actions="discrete", num_agents=3), "w", 1)
    assert action.tolist() == [1, -1, -1]
    (action,) = typed(make_config(num_agents=2), "w", 1)
    assert action.tolist() == [[1, 0, 0, 0], [0, 0, 0, 0]]


def test_a_terminal_gives_single_keys_and_is_left_as_it_was():
    pty, termios = pytest.importorskip("pty"), pytest.importorskip("termios")
    outside, inside = pty.openpty()
    with open(inside) as terminal, open(outside, "wb", buffering=0) as person:
        before = termios.tcgetattr(terminal)
        keys = read_keys(terminal)
        for key in "wd ":
            person.write(key.encode())  # no end of a line
            assert next(keys) == key
            assert termios.tcgetattr(terminal) == before
        person.write(b"ab")
        assert [next(keys), next(keys)] == ["a", "b"]


def test_a_picture_has_two_pixels_in_each_character():
    image = np.zeros((40, 80, 3), np.uint8)
    image[20:] = (255, 0, 0)
    lines = image_to_text(image, 20).splitlines()
    assert len(lines) == 5
    assert [line.count("▀") for line in lines] == [20] * 5
    assert "48;2;255;0;0" in lines[-1]
    assert "255" not in lines[0]
