"""`home-mjx look`: a saved state in words and as a picture."""

from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from generated import generate_flats
from PIL import Image

import home_mjx
from home_mjx.cli import main
from home_mjx.schema.categories import ROOM_TYPES
from home_mjx.tasks import save_states
from home_mjx.tasks.env.state_io import dump_flagged, load_states, read_origin
from home_mjx.viewer.episodes.goal_markers import GoalMarkers
from home_mjx.viewer.episodes.overlay import AGENT_COLOURS, GOAL_COLOUR
from home_mjx.viewer.episodes.state_report import describe_state, shortest_path
from home_mjx.viewer.episodes.video import PANEL_GAP, TEXT_HEIGHT

SIZE = (320, 240)


@pytest.fixture(scope="module")
def env(tmp_path_factory: pytest.TempPathFactory):
    root = tmp_path_factory.mktemp("look")
    generate_flats(root, range(2))
    return home_mjx.make("PointNav-v0", root, num_houses=2, sensors=("goal",), impl="kinematic")


@pytest.fixture(scope="module")
def states(env):
    """Three environments after some steps forward, the last of them with an action out of range."""
    states = jax.jit(jax.vmap(env.reset))(jax.random.split(jax.random.key(2), 3))
    step = jax.jit(jax.vmap(env.step))
    forward = jnp.zeros((3, env.action_size)).at[:, 0].set(1.0)
    for _ in range(30):
        states = step(states, forward)
    return step(states, forward.at[2, 1].set(7.0))


@pytest.fixture(scope="module")
def path(env, states, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("states") / "states.npz"
    assert save_states(path, states, env) == 3
    return path


def row(states, index: int):
    return jax.tree.map(lambda x: x[index], states)


def coloured(picture: np.ndarray, colour: tuple[int, int, int]) -> np.ndarray:
    """Pixels of a marker's hue, also where the smaller picture mixes it with the floor."""
    red, green, blue = np.moveaxis(picture.astype(int), -1, 0)
    if colour == GOAL_COLOUR:  # yellow
        return (red > 180) & (green > 140) & (green - blue > 70)
    return (green - red > 60) & (green - blue > 40)


def test_it_prints_and_draws_one_state_of_the_file(
    env, states, path: Path, tmp_path: Path, capsys: pytest.CaptureFixture
):
    size = ["--size", str(SIZE[0]), str(SIZE[1])]
    assert main(["look", str(path), "--env", "2", "--out", str(tmp_path), *size]) == 0
    first, *lines, written = capsys.readouterr().out.splitlines()
    assert first == f"environment 2 of 3 in {path}"
    assert Path(written) == tmp_path / "states_2.png"
    told = {line[:10].strip(): line[10:] for line in lines if line[:10].strip()}
    one = row(states, 2)
    house, goal = int(one.world.house), env.bank.navigation.goal[int(one.world.house), int(one.task.goal)]
    assert told["house"] == f"{env.bank.house_ids[house]} (number {house} of 2)"
    assert told["goal"] == f"at ({', '.join(f'{float(x):.2f}' for x in goal)}) m"
    assert told["status"] == "ACTION"
    assert "step 31 of 500, running" in told["task"]
    assert f"distance {float(one.metrics['distance']):.4g}" in told["metrics"]
    feet = env.core.snapshot(env.params, one).feet[0]
    assert f"({float(feet[0]):.2f}, {float(feet[1]):.2f}, {float(feet[2]):.2f}) m" in told["agent 0"]
    assert any(name in "\n".join(lines) for name in ROOM_TYPES)

    with Image.open(written) as image:
        picture = np.asarray(image.convert("RGB"))
    top = TEXT_HEIGHT + PANEL_GAP
    view = picture[top : top + SIZE[1], PANEL_GAP : PANEL_GAP + SIZE[0]]
    plan = picture[top : top + SIZE[1], SIZE[0] + 2 * PANEL_GAP :]
    assert view.std() > 5
    ring, agent = coloured(plan, GOAL_COLOUR), coloured(plan, AGENT_COLOURS[0])
    assert ring.sum() > 20  # the goal, and the path to it
    assert agent.sum() > 5
    assert picture[:TEXT_HEIGHT].max() > 150  # the title


def test_contacts_have_names(env, states):
    """Those of a step of the fused physics, which kinematic states have no numbers for."""
    one = row(states, 0)
    house, physics = int(one.world.house), env.bank.physics
    box = int(np.flatnonzero(np.asarray(physics.collider_object[house]) >= 0)[0])
    told = "\n".join(describe_state(env, touching(env, one, -3 - box)))
    from home_mjx.scene_compile import decode_row

    item = int(physics.collider_object[house, box])
    meaning = decode_row(np.asarray(env.bank.semantics[int(env.bank.geometry.object_semantic[house, item])]))
    assert f"touches {meaning['fine']} (" in told
    assert "with 318 N s at (1.00, 2.00, 0.15) m" in told
    assert "its strongest contact is the floor with 318 N s" in "\n".join(describe_state(env, touching(env, one, -2)))
    bare = describe_state(env, one.replace(reward=one.reward * jnp.nan))
    assert bare[-1].split() == ["NaN", "in", ".reward"]


def touching(env, state, partner: int):
    """The state, with a contact of the agent."""
    physics = state.physics
    contact = {
        "contact_partner": physics.contact_partner.at[0].set(partner),
        "contact_impulse": physics.contact_impulse.at[0].set(318.0),
        "contact_pos": physics.contact_pos.at[0].set(jnp.array([1.0, 2.0, 0.15])),
        "num_contacts": jnp.ones_like(physics.num_contacts),
    }
    return state.replace(physics=physics.replace(**contact))


def test_the_shortest_path_is_as_long_as_the_distance(env, states):
    for index in range(3):
        one = row(states, index)
        house = int(one.world.house)
        goal = np.asarray(env.bank.navigation.goal[house, int(one.task.goal)])
        feet = np.asarray(env.core.snapshot(env.params, one).feet[0])
        nowhere = np.zeros(env.bank.navigation.room_type.shape[1], bool)
        points = shortest_path(env.bank, house, feet, GoalMarkers(goal[None], nowhere))
        assert np.linalg.norm(points[0] - feet) < 0.3
        assert np.linalg.norm(points[-1] - goal) < 0.3
        length = np.linalg.norm(np.diff(points, axis=0), axis=1).sum()
        assert length == pytest.approx(float(one.metrics["distance"]), rel=0.1, abs=0.4)
        assert shortest_path(env.bank, house, feet, GoalMarkers(goal[None][:0], nowhere)).shape == (0, 3)


def test_a_file_says_which_environment_it_is_of(env, states, path: Path, tmp_path: Path):
    origin = read_origin(path)
    assert origin.house_ids == env.bank.house_ids
    assert origin.num_envs == 3
    spec = home_mjx.EnvSpec.from_json(origin.spec)
    assert (spec.id, spec.options) == ("PointNav-v0", env.spec.options)
    jax.tree.map(np.testing.assert_array_equal, load_states(path, env).physics, states.physics)
    assert dump_flagged(tmp_path / "a.npz", states, np.zeros((3, 4)), states, home_mjx.tasks.Status.ACTION, env) == 1
    assert read_origin(tmp_path / "a.npz")[1:] == (env.bank.house_ids, 1)


def test_what_it_cannot_show_is_refused(states, path: Path, tmp_path: Path, capsys: pytest.CaptureFixture):
    save_states(tmp_path / "bare.npz", states)
    (tmp_path / "a.jsonl").write_text('{"a": 1}\n')
    np.savez(tmp_path / "other.npz", x=np.zeros(3))
    for arguments, words in (
        ([path, "--env", "3"], "--env 3: the file has 3 environments"),
        ([tmp_path / "bare.npz"], "--task TASK"),
        ([path, "--houses", "2"], "--houses needs --task"),
        ([tmp_path / "a.jsonl"], "JSON lines"),
        ([tmp_path / "other.npz"], "save_states"),
        ([tmp_path / "none.npz"], "there is no file of states"),
    ):
        assert main(["look", *map(str, arguments), "--no-picture"]) == 2
        assert words in capsys.readouterr().err
