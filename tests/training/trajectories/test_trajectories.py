"""Data sets are read by Minari itself, and survive a process that was killed."""

import json
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from full_disk import full_disk

pytest.importorskip("pyarrow", reason="needs the extra `data`")

from generated import generate_flats

import home_mjx
from home_mjx.cli import main
from home_mjx.errors import ConfigError, DatasetError, MissingFileError
from home_mjx.tasks.env.env import Env
from home_mjx.training.rollout import Policy
from home_mjx.training.trajectories import Trajectories, recording
from home_mjx.training.trajectories.minari_format import count_complete_episodes
from home_mjx.training.trajectories.writer import TrajectoryWriter

SENSORS = ("rgb", "depth", "audio", "instruction", "goal")


@pytest.fixture(scope="module")
def env(generated_bank) -> Env:
    return home_mjx.make("RoomNav-v0", generated_bank, sensors=SENSORS, width=40, height=32, num_tasks=2)


def drawn(env: Env, rng: np.random.Generator, length: int) -> dict:
    """An episode of noise."""
    seen = {
        name: rng.integers(0, 99, (length + 1, *spec.shape)).astype(spec.dtype)
        for name, spec in env.observation_spec.items()
    }
    rewards, ends = rng.normal(size=length).astype(np.float32), np.arange(length) == length - 1
    actions = rng.integers(0, 6, length).astype(np.int32)
    return {"observations": seen, "actions": actions, "rewards": rewards, "terminations": ends, "truncations": ~ends}


@pytest.fixture
def written(env: Env, rng: np.random.Generator, tmp_path: Path) -> tuple[Path, list[dict]]:
    episodes = [drawn(env, rng, length) for length in (3, 1, 7)]
    with TrajectoryWriter(tmp_path / "set", env, "expert") as writer:
        for number, episode in enumerate(episodes):
            writer.add(episode, {"instruction": f"task {number}"})
    return tmp_path / "set", episodes


def same(read, episode: dict) -> None:
    assert read.observations.keys() == episode["observations"].keys()
    for name, values in episode["observations"].items():
        assert read.observations[name].dtype == values.dtype
        np.testing.assert_array_equal(read.observations[name], values)
    for name in ("actions", "rewards", "terminations", "truncations"):
        np.testing.assert_array_equal(getattr(read, name), episode[name])


def test_what_was_written_is_read(written):
    folder, episodes = written
    data = Trajectories(folder)
    assert len(data) == 3
    for read, episode in zip(data, episodes, strict=True):
        same(read, episode)
    assert [episode.notes["instruction"] for episode in data] == ["task 0", "task 1", "task 2"]
    same(data[-1], episodes[2])
    with pytest.raises(IndexError, match="got 3"):
        data[3]


def test_minari_reads_it(written):
    minari = pytest.importorskip("minari", reason="Minari is not installed")
    folder, episodes = written
    data = minari.MinariDataset(folder / "data")
    assert (len(data), data.total_steps, data.id) == (3, 11, "home_mjx/RoomNav/expert-v0")
    for read, episode in zip(data, episodes, strict=True):
        same(read, episode)
        assert data.observation_space["pixels/head_rgb"].contains(read.observations["pixels/head_rgb"][0])
        assert data.action_space.contains(np.int64(read.actions[0]))


def test_a_killed_process_loses_only_what_was_not_whole(env: Env, rng: np.random.Generator, written):
    folder, episodes = written
    path = folder / "data" / "metadata.json"
    old = json.loads(path.read_text())
    path.write_text(json.dumps(old | {"total_episodes": 1, "total_steps": 3}))  # killed before it was counted
    shutil.copytree(folder / "data" / "2", folder / "data" / ".3.new")  # killed while it was written
    shutil.copytree(folder / "data" / "2", folder / "data" / "4")  # by another thread, before 3 was whole
    assert len(Trajectories(folder)) == 1
    more = drawn(env, rng, 2)
    with TrajectoryWriter(folder, env, "expert", resume=True) as writer:
        assert (writer.episodes, writer.steps) == (3, 11)
        writer.add(more, {})
    data = Trajectories(folder)
    assert [len(episode.actions) for episode in data] == [3, 1, 7, 2]
    same(data[3], more)
    same(data[2], episodes[2])
    assert not list((folder / "data").glob(".*"))
    assert count_complete_episodes(folder / "data") == 4


def test_a_full_disk_is_said_and_writing_goes_on_later(env: Env, rng: np.random.Generator, tmp_path: Path):
    short, long = (drawn(env, rng, length) for length in (1, 40))

    def write(episode: dict, resume: bool) -> None:
        with TrajectoryWriter(tmp_path, env, "expert", resume=resume) as writer:
            writer.add(episode, {})

    write(short, False)
    with (
        full_disk(400_000),
        pytest.raises(ConfigError, match="an episode cannot be written") as raised,
    ):
        write(long, True)
    assert "--resume" in raised.value.hint
    assert len(Trajectories(tmp_path)) == 1
    write(long, True)
    for read, episode in zip(Trajectories(tmp_path), (short, long), strict=True):
        same(read, episode)
    with full_disk(100), pytest.raises(ConfigError, match="metadata cannot be written"):
        write(short, True)
    assert len(Trajectories(tmp_path)) == 2


def test_mistakes_are_refused(env: Env, written, tmp_path: Path):
    folder, _ = written
    with pytest.raises(ConfigError, match="contains a dataset"):
        TrajectoryWriter(folder, env, "expert")
    with pytest.raises(ConfigError, match="another `observation_space`"):
        TrajectoryWriter(folder, env, "expert", omit=("goal",), resume=True)
    with pytest.raises(MissingFileError, match="there is no dataset"):
        Trajectories(tmp_path)
    (folder / "data" / "1" / "part-0.arrow").write_bytes(b"ARROW1")
    with pytest.raises(DatasetError, match="cannot be read"):
        Trajectories(folder)[1]


def play(monkeypatch: pytest.MonkeyPatch, env: Env, rng: np.random.Generator, succeeds: Callable[[int], bool]) -> None:
    """Replace batches by one environment with episodes of 3 steps; `succeeds` maps numbers, from 1, to success."""

    class Scripted:
        num_running_steps = 3

        def __init__(self, *_: object, **__: object) -> None:
            self.running, self.count = np.ones(1, bool), 0

        def stop_resets(self) -> None:
            self.running = ~self.running

        def step(self) -> list[tuple[dict, dict]]:
            self.count += 1
            return [(drawn(env, rng, 3), {"success": float(succeeds(self.count))})]

    monkeypatch.setattr(recording, "_RecordingBatch", Scripted)


def test_enough_successful_steps_are_recorded(
    env: Env, rng: np.random.Generator, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    """Episodes that run when the last ones begin may still fail, so their steps do not count."""
    play(monkeypatch, env, rng, lambda number: number % 2 == 0)
    assert recording.record(env, tmp_path, Policy(lambda *_: _), num_steps=6, only_success=True) == 6


def test_recording_of_a_policy_without_success_ends(
    env: Env, rng: np.random.Generator, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    play(monkeypatch, env, rng, lambda _: False)
    with pytest.raises(ConfigError, match="of 6 episodes tried, 0 succeeded") as raised:
        recording.record(env, tmp_path, Policy(lambda *_: _), num_steps=6, only_success=True, max_failures=5)
    assert "--max-failures" in raised.value.hint


def test_rare_success_is_recorded_until_it_is_too_rare(
    env: Env, rng: np.random.Generator, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    play(monkeypatch, env, rng, lambda number: number % 5 == 0)
    options = {"only_success": True, "max_failures": 5}
    assert recording.record(env, tmp_path / "a", Policy(lambda *_: _), num_steps=60, **options) == 60
    play(monkeypatch, env, rng, lambda number: number <= 2)
    with pytest.raises(ConfigError, match="of 18 episodes tried, 2 succeeded"):
        recording.record(env, tmp_path / "b", Policy(lambda *_: _), num_steps=60, **options)
    assert len(Trajectories(tmp_path / "b")) == 2


@pytest.mark.slow
def test_an_expert_is_recorded(tmp_path: Path, capsys: pytest.CaptureFixture):
    houses = tmp_path / "houses"
    generate_flats(houses, range(6))
    command = [
        "record", "RoomNav", "--dataset", str(houses), "--houses", "1", "--frames", "200", "--num-envs", "4",
        "--sensors", "rgb,state", "--env", "width=16", "--env", "height=16", "--env", "impl=kinematic",
        "--out", str(tmp_path / "set"),
    ]  # fmt: skip
    assert main(command) == 0
    data = Trajectories(tmp_path / "set")
    said = capsys.readouterr().out
    steps = sum(len(episode.actions) for episode in data)
    assert said.startswith(f"{steps} steps of {len(data)} episodes")
    assert steps >= 200
    assert np.mean([episode.notes["success"] for episode in data]) >= 0.9
    for episode in data:
        assert set(episode.observations) == {"pixels/head_rgb", "state"}
        ends = episode.terminations | episode.truncations
        assert ends[-1]
        assert not ends[:-1].any()
        assert episode.notes["instruction"].startswith("RoomNav: the ")
        moved = np.abs(np.diff(episode.observations["state"], axis=0)).sum(-1)
        turns = np.isin(episode.actions, (1, 2, 3))  # forward and turns change what is seen, also in the last step
        assert np.all(moved[turns & (moved > 0)] < 30)
        assert (moved[turns] > 0).mean() > 0.9
    assert main(command) == 2
    assert "--resume" in capsys.readouterr().err
    assert main([*command, "--resume"]) == 0  # there are enough
    assert len(Trajectories(tmp_path / "set")) == len(data)
