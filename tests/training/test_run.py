"""A run from options to files, with a learner that only counts: what is written, and what is left where it fails."""

import contextlib
import dataclasses
import json
import shutil
import threading
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import pytest

pytest.importorskip("tensorboardX", reason="needs the extra `train`")

from full_disk import full_disk

import home_mjx
from home_mjx.errors import ConfigError, DatasetError, HomeMjxError, MissingFileError, UnknownNameError
from home_mjx.registry import find_spec
from home_mjx.sharding import REPLICATED, EnvSharding, make_mesh
from home_mjx.tasks.base.state import State
from home_mjx.tasks.env.observers import Observer, ObserverGroup, RunStart
from home_mjx.training import run
from home_mjx.training.checkpoint import load_net, read_updates, save_checkpoint, save_net
from home_mjx.training.config import PPOConfig, RunConfig
from home_mjx.training.metrics_log import TensorBoardLog, read_lines
from home_mjx.training.networks import NetworkConfig
from home_mjx.training.ppo import PPO, TrainState
from home_mjx.training.rollout import RolloutState

SMALL = PPOConfig(num_envs=8, unroll_length=8, num_timesteps=640, network=NetworkConfig(8, 8, (4,)))
CONFIG = RunConfig(find_spec("PointNav-v0"), SMALL)
UPDATES = 10
STATE_FIELDS = ("physics", "world", "task", "obs", "reward", "metrics", "status", "info")
LIMIT = 60  # [s], far more than any of this takes


class Counter(PPO):
    """Counts its updates, in its network too, which is broken after `broken_after`."""

    broken_after = 1000

    def __init__(self, core: object, config: PPOConfig, devices: Sequence[object]) -> None:
        self.config, self.sharding = config, EnvSharding(make_mesh(list(devices)[:1]))
        self.update = jax.jit(self._counted)

    def lower(self, params: object) -> tuple[object, object]:
        state = self.to_devices(self.init(params, None))
        return jax.jit(lambda: 0).lower(), self.update.lower(params, state)

    def init(self, params: object, key: object, reset: object = None) -> TrainState:
        net, ended = {"count": jnp.zeros(3)}, jnp.zeros(SMALL.num_envs, bool)
        env = State.build_unchecked(**dict.fromkeys(STATE_FIELDS, ()) | {"terminated": ended, "truncated": ended})
        actor = RolloutState.build_unchecked(env=env, memory=(), is_first=(), keys=(), totals=())
        return TrainState.build_unchecked(
            net=net, opt=(), actor=actor, key=jnp.zeros(2, jnp.uint32), updates=jnp.int32(0)
        )

    def to_devices(self, state: TrainState) -> TrainState:
        return self.sharding.put(state, REPLICATED)

    def _counted(self, params: object, state: TrainState) -> tuple[TrainState, dict]:
        updates = state.updates + 1
        count = jnp.where(updates > self.broken_after, jnp.nan, state.net["count"] + 1)
        metrics = {"episode/episodes": 2.0, "episode/success": 1.0, "loss/value": 1.0 / updates}
        return state.replace(net={"count": count}, updates=updates), metrics


@pytest.fixture(scope="module", autouse=True)
def counting(generated_bank):
    """Runs that count, and write after each update."""
    env = home_mjx.make("PointNav-v0", generated_bank)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(run, "make_env", lambda spec, progress: env)
        patch.setattr(run, "LEARNERS", dict.fromkeys(run.LEARNERS, Counter))
        patch.setattr(run, "MIN_CHECKPOINT_INTERVAL", 0.0)
        yield


@pytest.fixture(scope="module")
def whole(counting, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a run that ended by itself; nobody changes it."""
    train(folder := tmp_path_factory.mktemp("whole"))
    return folder


def train(out: Path, config: RunConfig = CONFIG, **options: object) -> PPO:
    return run.train(config, out, progress=False, **options)


def count_of(path: Path) -> list[float]:
    return load_net(path, {"count": jnp.zeros(3)})["count"].tolist()


def files(out: Path) -> set[str]:
    return {path.name for path in out.rglob("*") if path.is_file()}


def plain(out: Path) -> list[dict]:
    timed = ("seconds", "compile_seconds", "steps_per_second")
    return [{k: v for k, v in line.items() if k not in timed} for line in read_lines(out / "metrics.jsonl")]


def raised_in_time(function: Callable[[], object]) -> BaseException | None:
    """What a function raises; it must end."""
    raised: list[BaseException | None] = []

    def call() -> None:
        try:
            function()
            raised.append(None)
        except BaseException as error:
            raised.append(error)

    thread = threading.Thread(target=call, daemon=True)
    thread.start()
    thread.join(LIMIT)
    assert raised, "it hangs"
    return raised[0]


def test_a_run_takes_its_turn_once_all_is_compiled(tmp_path: Path):
    found = []

    @contextlib.contextmanager
    def turn() -> Iterator[None]:
        found.append(files(tmp_path))
        yield
        found.append(files(tmp_path))

    train(tmp_path, device_lock=turn())
    assert "checkpoint.npz" not in found[0]
    assert "checkpoint.npz" in found[1]
    assert len(read_lines(tmp_path / "metrics.jsonl")) == UPDATES
    assert count_of(tmp_path / "agent.npz") == [UPDATES] * 3


@pytest.mark.parametrize("size", [100, 700, 2000])
def test_a_full_disk_ends_the_run_with_its_reason_and_it_can_go_on(whole: Path, tmp_path: Path, size: int):
    """tensorboardX's writer died of it in a thread of its own, and the run waited for that thread for ever."""
    out = tmp_path / "full"
    out.mkdir()
    assert (whole / "metrics.jsonl").stat().st_size > max(700, size) / 2
    with full_disk(size):
        error = raised_in_time(lambda: train(out))
    assert isinstance(error, ConfigError)
    assert "cannot be written: File too large" in str(error)
    assert "--resume" in str(error)
    assert [name for name in files(out) if name.endswith(".new")] == []
    train(out, resume=True)
    assert plain(out) == plain(whole)
    assert count_of(out / "agent.npz") == [UPDATES] * 3


def test_tensorboard_alone_fills_the_disk(tmp_path: Path):
    """The records of many figures, until nothing more can be written."""
    line = {f"loss/{i}": 1.5 * i for i in range(18)}

    def add() -> None:
        with ObserverGroup([TensorBoardLog(tmp_path)]) as records:
            records.on_run_start(RunStart("ppo", None, "steps", 4000))
            for steps in range(4000):
                records.on_log({"steps": steps, **line})

    with full_disk(200_000):
        assert isinstance(raised_in_time(add), ConfigError)


@pytest.mark.parametrize("size", [3000, 100_000])
def test_what_cannot_be_written_leaves_no_file(tmp_path: Path, size: int):
    net = {"dense": jnp.asarray(np.random.default_rng(0).normal(size=(400, 400)), jnp.float32)}
    with full_disk(size), pytest.raises(ConfigError, match="checkpoint cannot be written"):
        save_net(tmp_path / "agent.npz", net, CONFIG)
    assert list(tmp_path.iterdir()) == []


def test_a_refused_start_leaves_nothing(tmp_path: Path):
    out, other = tmp_path / "out", tmp_path / "other.npz"
    out.mkdir()
    save_net(other, {"count": jnp.zeros(5)}, CONFIG)
    (tmp_path / "half.npz").write_bytes(other.read_bytes()[:200])
    for name, kind in (("none", MissingFileError), ("other", DatasetError), ("half", DatasetError)):
        config = dataclasses.replace(CONFIG, start=str(tmp_path / f"{name}.npz"))
        with pytest.raises(kind):
            train(out, config)
        assert list(out.iterdir()) == []


def test_a_run_that_ends_by_time_has_made_an_update(tmp_path: Path):
    train(tmp_path, dataclasses.replace(CONFIG, max_seconds=0.001))
    done = read_updates(tmp_path / "checkpoint.npz")
    assert 1 <= done < UPDATES
    assert count_of(tmp_path / "agent.npz") == [done] * 3
    with pytest.raises(ConfigError, match="max_seconds"):
        dataclasses.replace(CONFIG, max_seconds=0.0)


def test_stages_are_one_run(tmp_path: Path):
    train(tmp_path, dataclasses.replace(CONFIG, clone_timesteps=256))
    assert read_updates(tmp_path / "checkpoint.npz") == UPDATES + 4
    assert count_of(tmp_path / "cloned.npz") == [4] * 3
    assert count_of(tmp_path / "agent.npz") == [UPDATES + 4] * 3


def test_a_training_that_diverges_keeps_what_was_good(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(Counter, "broken_after", 4)
    with pytest.raises(ConfigError, match=r"after 320 steps .* not finite.*learning_rate"):
        train(tmp_path)
    assert count_of(tmp_path / "checkpoint.npz") == [4.0] * 3
    assert "agent.npz" not in files(tmp_path)


@pytest.mark.parametrize(
    "updates",
    [np.int32(-5), np.int32(10**9), np.array("a"), np.zeros(3, np.int32), np.float32(np.nan), np.array(True)],
    ids=str,
)
def test_a_checkpoint_of_odd_updates_is_refused(whole: Path, tmp_path: Path, updates: np.ndarray):
    shutil.copytree(whole, tmp_path, dirs_exist_ok=True)
    path = tmp_path / "checkpoint.npz"
    with np.load(path) as file:
        arrays = dict(file)
    np.savez(path, **{**arrays, ".updates": updates})
    before = path.read_bytes()
    with pytest.raises(DatasetError, match="updates"):
        train(tmp_path, resume=True)
    assert path.read_bytes() == before


@pytest.mark.parametrize(
    "bad",
    ["5", "{}", '{"steps":"a"}', '{"steps":1,"seconds":"x"}', '{"steps":null}', "null", "[1]", "[" * 10_000,
     '{"steps":64,"seconds":NaN}', '{"steps":1,"x":' + "9" * 400 + "}", '{"steps": 1'],
    ids=lambda text: text[:20],
)  # fmt: skip
def test_an_odd_line_of_metrics_is_refused_by_number(tmp_path: Path, bad: str):
    path = tmp_path / "metrics.jsonl"
    path.write_text('{"steps": 64}\n' + bad + "\n")
    before = path.read_text()
    with pytest.raises(DatasetError, match=r"at line 2\).*Delete the line"):
        train(tmp_path)
    assert (path.read_text(), files(tmp_path)) == (before, {"metrics.jsonl"})


def test_metrics_that_are_no_text_are_refused(tmp_path: Path):
    (tmp_path / "metrics.jsonl").write_bytes(b"\xff\xfe\n")
    with pytest.raises(HomeMjxError, match="UTF-8"):
        train(tmp_path)


def test_a_finished_run_goes_on_to_nothing(whole: Path, tmp_path: Path):
    shutil.copytree(whole, tmp_path, dirs_exist_ok=True)
    before = {name: (tmp_path / name).read_bytes() for name in ("checkpoint.npz", "metrics.jsonl", "agent.npz")}
    train(tmp_path, resume=True)
    assert {name: (tmp_path / name).read_bytes() for name in before} == before
    assert [json.loads(line)["steps"] for line in before["metrics.jsonl"].splitlines()] == list(range(64, 641, 64))


def test_a_state_of_other_parts_is_not_gone_on_with(whole: Path, tmp_path: Path):
    shutil.copytree(whole, tmp_path, dirs_exist_ok=True)
    state = Counter(None, SMALL, jax.devices()).init(None, None)
    save_checkpoint(tmp_path / "checkpoint.npz", state.replace(net={"count": jnp.zeros(5)}, updates=3), CONFIG)
    with pytest.raises(DatasetError, match="expected float32"):
        train(tmp_path, resume=True)


def test_numbers_that_do_not_divide_are_refused_before_any_house_is_made(tmp_path: Path, monkeypatch):
    def made(spec, progress):
        raise AssertionError("houses were made")

    monkeypatch.setattr(run, "make_env", made)
    for changes, said in (({"num_envs": 9}, "multiple of the 2 devices"), ({"num_minibatches": 3}, "must divide 4")):
        config = dataclasses.replace(CONFIG, ppo=dataclasses.replace(SMALL, **changes))
        with pytest.raises(ConfigError, match=said):
            train(tmp_path, config)
    two = dataclasses.replace(CONFIG.env, options={**CONFIG.env.options, "num_agents": 2})
    with pytest.raises(AssertionError, match="houses were made"):  # 8 environments of 2 agents on 2 devices
        train(tmp_path, RunConfig(two, dataclasses.replace(SMALL, num_minibatches=8)))
    assert files(tmp_path) == set()


class Recorder(Observer):
    """Appends the name of each event, and whether the line of it is on disk."""

    def __init__(self, out: Path, events: list[str]) -> None:
        self.out, self.events, self.num_batches = out, events, 0

    def on_run_start(self, start) -> None:
        self.events.append(f"run {start.name} {start.done}/{start.total} {start.unit}")

    def on_states(self, states) -> None:
        assert states.done.shape == (SMALL.num_envs,)
        self.num_batches += 1

    def on_log(self, line) -> None:
        assert read_lines(self.out / "metrics.jsonl")[-1]["steps"] == line["steps"]
        self.events.append(f"log {line['steps']}")

    def on_checkpoint(self, path, steps) -> None:
        assert int(read_updates(path)) * SMALL.batch_size == steps
        self.events.append(f"checkpoint {steps}")

    def close(self) -> None:
        self.events.append("close")


def test_an_observer_follows_a_run(tmp_path: Path):
    """Lines are on disk before the checkpoint after them, because a resumed run drops those that are later."""
    events: list[str] = []
    recorder = Recorder(tmp_path, events)
    train(tmp_path, observers=[recorder])
    assert recorder.num_batches == UPDATES
    size = SMALL.batch_size
    told = [f"{name} {n * size}" for n in range(1, UPDATES + 1) for name in ("log", "checkpoint")]
    assert events == [f"run ppo 0/{UPDATES * size} steps", *told, "close"]


def test_an_observer_that_fails_ends_the_run_and_all_are_closed(tmp_path: Path):
    events: list[str] = []

    class Fails(Observer):
        def on_log(self, line) -> None:
            raise KeyError("mine")

    with pytest.raises(KeyError, match="mine"):
        train(tmp_path, observers=[Recorder(tmp_path, events), Fails()])
    assert events[-2:] == [f"log {SMALL.batch_size}", "close"]
    with pytest.raises(UnknownNameError, match="unknown observer"):
        train(tmp_path / "other", observers=["nobody"])
