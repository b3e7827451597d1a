"""Gymnasium's own checkers judge the adapter."""

import pickle
import subprocess
import sys

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import home_mjx  # noqa: F401, registers the ids
from home_mjx.adapters.gymnasium import GymEnv, GymVectorEnv
from home_mjx.errors import ConfigError
from home_mjx.tasks import Status, sample_episodes, save_episodes

SMALL = {"width": 16, "height": 16, "impl": "kinematic", "episode_length": 5, "late": "none", "num_edges": 0}


def test_check_env(generated_bank):
    env = gymnasium.make("home_mjx/PointNav-v0", houses=generated_bank, render_mode="rgb_array", **SMALL)
    check_env(env.unwrapped)
    obs, _ = env.reset(seed=1)
    again, _ = env.reset(seed=1)
    for name in obs:
        np.testing.assert_array_equal(obs[name], again[name])
    assert env.render().shape == (256, 256, 3)


def test_check_env_where_the_task_leads_the_other_agents(generated_bank):
    """There is one agent for whoever learns: no axis of agents, no reward per agent."""
    options = {"impl": "kinematic", "num_tasks": 2, "sensors": ("state",), "episode_length": 5, "follow_steps": 3}
    env = GymEnv("PiedPiper-v0", houses=generated_bank, **options)
    assert env.action_space == gymnasium.spaces.Discrete(6)
    assert env.observation_space["state"].shape == (10,)
    check_env(env, skip_render_check=True)
    env.reset(seed=0)
    assert "agent_reward" not in env.step(1)[4]


def test_the_house_can_be_chosen(generated_bank):
    env = GymEnv(houses=generated_bank, sensors=("state",))
    assert [env.reset(options={"house": i})[1]["house"] for i in (1, 0)] == [1, 0]


def test_gymnasium_counts_episodes_itself(generated_bank):
    """Its wrapper refuses an environment whose infos have `episode` already."""
    env = GymEnv(houses=generated_bank, sensors=("state",), episode_length=2)
    env = gymnasium.wrappers.RecordEpisodeStatistics(env)
    env.reset(seed=0)
    infos = [env.step(np.zeros(4, np.float32))[4] for _ in range(2)]
    assert [info.get("episode", {}).get("l") for info in infos] == [None, 2]


@pytest.mark.parametrize("options", [{"house": 2}, {"house": -1}, {"house": 1.0}, {"house": "a"}, {"hous": 1}])
def test_other_options_of_reset_are_refused(generated_bank, options):
    env = GymEnv(houses=generated_bank, sensors=("state",))
    with pytest.raises(ConfigError, match="hous"):
        env.reset(options=options)


def test_actions_outside_of_the_space_are_refused(generated_bank):
    env = GymEnv(houses=generated_bank, sensors=("state",))
    env.reset(seed=0)
    with pytest.raises(ConfigError, match="NaN"):
        env.step(np.full(4, np.nan))
    with pytest.raises(ConfigError, match="shape"):
        env.step(np.zeros((2, 2)))


def test_what_cannot_be_made_is_refused(generated_bank):
    with pytest.raises(ConfigError, match="render_mode must be None or 'rgb_array'"):
        GymEnv(houses=generated_bank, sensors=("depth",), render_mode="ansi")
    with pytest.raises(ConfigError, match="num_envs"):
        GymVectorEnv(0, houses=generated_bank)


def test_stepping_before_reset_is_refused(generated_bank):
    env = GymEnv(houses=generated_bank, sensors=("state",))
    with pytest.raises(gymnasium.error.ResetNeeded):
        env.step(np.zeros(4))


def test_pictures_are_of_any_size_whatever_is_observed(generated_bank):
    """With the camera's own size the picture is the observed image; without vision there is one as well."""
    options = {"houses": generated_bank, "width": 16, "height": 12, "render_mode": "rgb_array", "render_size": (16, 12)}
    env = GymEnv(sensors=("rgb",), **options)
    assert env.render() is None
    obs, _ = env.reset(seed=3)
    np.testing.assert_array_equal(env.render(), obs["pixels/head_rgb"])
    blind = GymEnv(sensors=("state",), **options)
    blind.reset(seed=3)
    np.testing.assert_array_equal(blind.render(), env.render())


def test_the_clock_gives_the_frame_rate(generated_bank):
    assert GymEnv(houses=generated_bank, sensors=("state",), ctrl_dt=0.2).metadata["render_fps"] == 5
    assert GymEnv.metadata["render_fps"] == 10


def test_vector_env_resets_in_the_same_step(generated_bank):
    """Metrics as arrays with masks; of those that ended, the last ones, in `final_info` as well."""
    options = {"houses": generated_bank, "sensors": ("state", "goal"), "episode_length": 2}
    env = gymnasium.make_vec("home_mjx/PointNav-v0", num_envs=4, **options)
    assert isinstance(env.unwrapped, GymVectorEnv)
    obs, info = env.reset(seed=0)
    assert env.observation_space.contains(obs)
    assert info["house"].shape == info["distance"].shape == (4,)
    assert (info["distance"] > 0).all()  # SPL divides by it
    assert info["_distance"].all()
    before = info["house"]
    obs, *_, info = env.step(env.action_space.sample())
    assert "final_info" not in info
    goals = obs["goal"]
    obs, reward, terminated, truncated, info = env.step(np.zeros((4, 4), np.float32))
    assert reward.shape == (4,)
    assert (terminated | truncated).all()
    assert info["_final_obs"].all()
    assert not np.allclose(info["final_obs"]["state"], obs["state"])
    np.testing.assert_array_equal(info["final_info"]["house"], before)
    np.testing.assert_allclose(info["final_info"]["distance"], info["distance"])
    np.testing.assert_allclose(info["final_obs"]["goal"], goals, atol=0.2)
    assert info["_final_info"].all()
    assert {name: value.any() for name, value in info.items() if name.startswith("status/")} == {
        f"status/{str(flag.name).lower()}": False for flag in Status
    }


def test_seeds_and_masks_of_single_environments(generated_bank):
    env = GymVectorEnv(3, houses=generated_bank, sensors=("state",))
    first, _ = env.reset(seed=[1, 2, 3])
    again, _ = env.reset(seed=[3, 2, 1])
    np.testing.assert_array_equal(first["state"], again["state"][::-1])
    some, info = env.reset(seed=[7, 8, 9], options={"reset_mask": np.array([False, True, False])})
    np.testing.assert_array_equal(some["state"][[0, 2]], again["state"][[0, 2]])
    assert (some["state"][1] != again["state"][1]).any()
    np.testing.assert_array_equal(info["_house"], [False, True, False])
    assert env.reset(options={"house": [1, 0, 1]})[1]["house"].tolist() == [1, 0, 1]
    for options in ({"reset_mask": [1, 0, 1]}, {"house": [0, 1]}, {"house": [0, 1, 2]}, {"episode": 0}):
        with pytest.raises(ConfigError):
            env.reset(options=options)
    with pytest.raises(ConfigError, match="one seed, or 3"):
        env.reset(seed=[1, 2])


@pytest.mark.parametrize(("num", "first", "then"), [(1, 4, None), (2, 4, None), (2, [4, 6], [None, 5])])
def test_resets_without_a_seed_go_on_as_seeded(generated_bank, num, first, then):
    """They repeat after the same seeds, but never the episodes of the seeded reset."""
    env = GymVectorEnv(num, houses=generated_bank, sensors=("state",))
    before = env.reset(seed=first)[0]["state"]
    one, other = (env.reset(seed=then)[0]["state"] for _ in range(2) if env.reset(seed=first))
    np.testing.assert_array_equal(one, other)
    assert (one != before).any(axis=1).all()


def test_one_seed_means_as_many_as_in_gymnasium(generated_bank):
    """Environment i of a batch begins as the environment alone does with seed + i, as in `SyncVectorEnv`."""
    env, alone = (
        GymVectorEnv(2, houses=generated_bank, sensors=("state",)),
        GymEnv(houses=generated_bank, sensors=("state",)),
    )
    first, _ = env.reset(seed=np.int64(4))
    np.testing.assert_array_equal(first["state"], env.reset(seed=[4, 5])[0]["state"])
    np.testing.assert_array_equal(first["state"][1], alone.reset(seed=5)[0]["state"])
    later = [env.reset()[0]["state"] for _ in range(2) if env.reset(seed=4)]
    np.testing.assert_array_equal(*later)
    assert not np.array_equal(later[0], first["state"])


def test_resets_in_the_next_step_are_those_of_the_same_step_told_later(generated_bank):
    """The same episodes in both modes, which Gymnasium's wrappers of observations ask for."""
    options = {"houses": generated_bank, "sensors": ("state",), "episode_length": 2, "num_envs": 2, "impl": "kinematic"}
    same, later = (GymVectorEnv(autoreset_mode=mode, **options) for mode in ("SameStep", "NextStep"))
    assert later.metadata["autoreset_mode"] is gymnasium.vector.AutoresetMode.NEXT_STEP
    np.testing.assert_array_equal(same.reset(seed=0)[0]["state"], later.reset(seed=0)[0]["state"])
    action = np.full((2, 4), 0.5, np.float32)
    for _ in range(2):
        wanted, found = same.step(action), later.step(action)
    np.testing.assert_array_equal(found[0]["state"], wanted[4]["final_obs"]["state"])
    assert found[3].all()
    assert "final_obs" not in found[4]
    np.testing.assert_array_equal(found[4]["distance"], wanted[4]["final_info"]["distance"])
    obs, reward, terminated, truncated, info = later.step(action)
    np.testing.assert_array_equal(obs["state"], wanted[0]["state"])
    assert [np.any(x) for x in (reward, terminated, truncated, info["_distance"])] == [False] * 4
    np.testing.assert_array_equal(later.step(action)[0]["state"], same.step(action)[0]["state"])
    flat = gymnasium.wrappers.vector.FlattenObservation(later)
    assert flat.reset(seed=0)[0].shape == (2, 10)
    with pytest.raises(ConfigError, match="NextStep"):
        GymVectorEnv(autoreset_mode="Disabled", **options)


def test_saved_episodes_are_evaluated(generated_bank, tmp_path):
    episodes = sample_episodes(generated_bank, 5, min_length=1.5)
    save_episodes(tmp_path / "e.jsonl", generated_bank, episodes)
    options = {"houses": generated_bank, "sensors": ("state",), "episodes": tmp_path / "e.jsonl", "episode_length": 1}
    env = GymEnv(**options)
    seen = [env.reset()[1] for _ in range(6)]
    assert [info["episode_index"] % 5 for info in seen] == [0, 1, 2, 3, 4, 0]
    np.testing.assert_allclose([i["distance"] for i in seen[:5]], episodes.columns["length"], rtol=1e-5)
    assert env.reset(options={"episode": 3})[1]["house"] == int(episodes.house[3])
    batch = GymVectorEnv(2, **options)
    assert batch.reset(seed=0)[1]["episode_index"].tolist() == [0, 1]
    assert batch.reset(options={"episode": [4, 2]})[1]["house"].tolist() == np.asarray(episodes.house)[[4, 2]].tolist()


def test_environments_pickle(generated_bank):
    env = GymEnv(houses=generated_bank, sensors=("state",), episode_length=7)
    twin = pickle.loads(pickle.dumps(env))
    np.testing.assert_array_equal(twin.reset(seed=1)[0]["state"], env.reset(seed=1)[0]["state"])
    assert twin.env.config.episode_length == 7


def test_a_search_for_gymnasium_does_not_use_up_the_registration():
    """Many packages first ask `importlib.util.find_spec` whether Gymnasium is installed."""
    program = (
        "import importlib.util, home_mjx; assert importlib.util.find_spec('gymnasium'); import gymnasium;"
        "assert 'home_mjx/PointNav-v0' in gymnasium.registry"
    )
    subprocess.run([sys.executable, "-c", program], check=True)
