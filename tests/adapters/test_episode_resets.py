"""Every way to reset with every source of episodes: none repeats an episode, skips one, or drops what was asked."""

import multiprocessing
import os

import gymnasium
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode
from storey_homes import homes_bank

import home_mjx
from home_mjx.adapters.gymnasium import GymEnv, GymVectorEnv
from home_mjx.adapters.gymnasium_tools import make_env
from home_mjx.adapters.gymnax import GymnaxEnv
from home_mjx.errors import BackendError, ConfigError
from home_mjx.tasks import AutoReset, sample_episodes, save_episodes, save_tasks
from home_mjx.tasks.suite import RoomNav

NUM, ROWS = 3, 7
ALL = np.arange(NUM)
CHEAP = {"impl": "kinematic", "sensors": ("state",), "episode_length": 1}
SOURCES = ["drawn", "file", "episodes", "task bank", "task file", "weights"]
SEQUENTIAL = SOURCES[1:-1]
ROOMS = SOURCES[3:]  # of a task whose program takes long to compile


@pytest.fixture(scope="module")
def bank():
    return homes_bank(("one storey", "straight"))


@pytest.fixture(scope="module")
def make(bank, tmp_path_factory):
    """Options of an environment of a source, and a function that is called with what the adapter has made."""
    root = tmp_path_factory.mktemp("episodes")
    rows = sample_episodes(bank, ROWS, min_length=1.0)
    save_episodes(root / "e.jsonl", bank, rows)
    tasks = RoomNav(num_tasks=4).task_bank(bank).pick(jnp.arange(ROWS))
    save_tasks(root / "t.jsonl", bank, tasks)

    def options(source):
        points, rooms = ({"env_id": name, "houses": bank, **CHEAP} for name in ("PointNav-v0", "RoomNav-v0"))
        return {
            "drawn": points,
            "file": points | {"episodes": root / "e.jsonl"},
            "episodes": points | {"episodes": rows},
            "task bank": rooms | {"episodes": tasks},
            "task file": rooms | {"episodes": root / "t.jsonl"},
            "weights": rooms | {"episodes": tasks.with_weights(jnp.arange(ROWS) < 2)},
        }[source]

    return options


@pytest.fixture(scope="module")
def made(make):
    """One environment per adapter and id, whose compiled programs take the episodes of any source."""
    return {}


def with_source(made, cls, options, *args):
    """The environment with the episodes of a source, loaded as the adapter loads them."""
    env = made.setdefault((cls, options["env_id"]), None) or cls(*args, **options)
    made[cls, options["env_id"]] = env
    others = {name: value for name, value in options.items() if name not in ("env_id", "episodes")}
    env.env = make_env(options["env_id"], options.get("episodes"), others)
    env._state, env._next_episode = None, 0
    return env


slow_rooms = pytest.mark.parametrize(
    "source", [pytest.param(name, marks=[pytest.mark.slow] * (name in ROOMS)) for name in SOURCES]
)


@pytest.fixture
def single(make, made, source):
    return with_source(made, GymEnv, make(source))


@pytest.fixture
def batch(make, made, source):
    return with_source(made, GymVectorEnv, make(source), NUM)


def idle(env):
    return np.zeros(env.action_space.shape, env.action_space.dtype)


def only(*envs):
    return {"reset_mask": np.isin(ALL, envs)}


def numbers(result):
    return np.asarray(result[1]["episode_index"]).tolist()


def starts(env):
    return np.asarray(env._state.physics.qpos)[..., :3]


@slow_rooms
def test_one_environment_goes_on(single, source):
    found = [numbers(single.reset(seed=0 if i == 0 else None)) for i in range(ROWS + 1)]
    places = []
    for _ in range(3):
        single.reset()
        places.append(starts(single))
    assert len(np.unique(places, axis=0)) == 3 or source == "weights"
    if source in SEQUENTIAL:
        assert found == list(range(ROWS + 1))
        single.reset(options={"episode": 4})
        assert numbers(single.reset()) == 5
        assert numbers(single.reset(seed=3)) == 0
    else:
        assert set(found) == {-1} if source == "drawn" else set(found) <= {0, 1}


@slow_rooms
def test_a_batch_goes_on(batch, source):
    """Masked, seedless and automatic resets: environment i takes i, i + n, ..., and a seed begins with i again."""
    first = batch.reset(seed=0)
    begun = starts(batch)
    found = [numbers(first), numbers(batch.reset(options=only(0))), numbers(batch.reset(options=only(0)))]
    third = starts(batch)
    found += [numbers(batch.reset()), batch.step(idle(batch))[4]["final_info"]["episode_index"].tolist()]
    found += [np.asarray(batch._state.world.episode).tolist(), numbers(batch.reset(options=only(1, 2)))]
    found += [numbers(batch.reset(seed=[5, None, 5])), numbers(batch.reset(seed=1))]
    np.testing.assert_array_equal(third[1:], begun[1:])
    assert not np.array_equal(third[0], begun[0]) or source == "weights"
    if source in SEQUENTIAL:
        wanted = [[0, 1, 2], [3, 1, 2], [6, 1, 2], [9, 4, 5], [9, 4, 5], [12, 7, 8], [12, 10, 11]]
        assert found == [*wanted, [0, 13, 2], [0, 1, 2]]
        rows = batch.env.params.tasks
        place = np.asarray(getattr(rows, "rows", rows).start)
        batch.reset(options={"episode": [4, 2, 6]})
        batch.reset(options=only(0, 2))
        np.testing.assert_allclose(starts(batch)[:, :2], place[[(4 + NUM) % ROWS, 2, (6 + NUM) % ROWS], :2], atol=1e-5)
    else:
        assert {n for some in found for n in some} <= ({-1} if source == "drawn" else {0, 1})


@pytest.mark.parametrize("source", SOURCES[1:])
def test_a_house_is_refused_where_rows_have_one(single, batch, source):
    """It would be dropped in silence; the message names the rows of that house."""
    for env in (single, batch):
        with pytest.raises(ConfigError, match=r"`house` cannot be chosen.*rows in house 1 are") as caught:
            env.reset(options={"house": 1})
        row = int(caught.value.hint.split(" are ")[1].split(",")[0].rstrip("."))
        rows = env.env.params.tasks
        assert int(getattr(rows, "rows", rows).house[row]) == 1
    params, core = single.env.params, single.env.core
    key = jax.random.key(0)
    with pytest.raises(ConfigError, match="rows of `tasks` have their own houses"):
        jax.eval_shape(lambda: core.reset(params, key, 1))
    with pytest.raises(ConfigError, match="rows of `tasks` have their own houses"):
        jax.eval_shape(lambda: AutoReset(core).reset(params, jax.random.split(key, 2), jnp.ones(2, jnp.int32)))


def test_rows_that_a_later_step_would_show_are_not_skipped(make, made):
    """With `NextStep` an environment has begun its next row before it shows it: a reset in between shows that one."""
    env = with_source(made, GymVectorEnv, make("file"), NUM)
    env._mode = AutoresetMode.NEXT_STEP
    env.reset(seed=0)
    assert env.step(idle(env))[3].all()
    assert numbers(env.reset(options=only(0))) == [3, 4, 5]
    assert numbers(env.reset(options=only(0))) == [6, 4, 5]
    env.step(idle(env))  # ends the first, shows the first step of the others
    assert np.asarray(env._state.world.episode).tolist() == [9, 4, 5]
    env._mode = AutoresetMode.SAME_STEP


def test_interfaces_without_memory_begin_again_and_go_on_by_themselves(make):
    """`AutoReset`, as PyTorch loops and gymnax use it: a reset is a function, automatic resets take the next rows."""
    env = GymEnv(**make("file")).env
    auto = AutoReset(env.core).bind(env.params)
    reset, step = jax.jit(auto.reset), jax.jit(auto.step)
    keys = jax.random.split(jax.random.key(0), NUM)
    states = reset(keys)
    seen = [states.world.episode, reset(keys).world.episode]
    for _ in range(2):
        states = step(states, jnp.zeros((NUM, 4)))
        seen.append(states.world.episode)
    seen.append(reset(keys, None, states.world.episode + NUM).world.episode)
    assert [x.tolist() for x in seen] == [[0, 1, 2], [0, 1, 2], [3, 4, 5], [6, 7, 8], [9, 10, 11]]
    gymnax = GymnaxEnv(env)
    _, first = jax.vmap(gymnax.reset, in_axes=(0, None))(keys, env.params)
    _, second, *_ = jax.vmap(gymnax.step, in_axes=(0, 0, 0, None))(keys, first, jnp.zeros((NUM, 4)), env.params)
    assert [first.world.episode.tolist(), second.world.episode.tolist()] == [[0, 1, 2], [3, 4, 5]]


@pytest.mark.slow
def test_other_libraries_go_on(make):
    brax = pytest.importorskip("home_mjx.adapters.brax")
    zoo = pytest.importorskip("home_mjx.adapters.pettingzoo").PettingZooEnv(**make("file"))
    assert [zoo.reset(seed=0 if i == 0 else None)[1]["agent_0"]["episode_index"] for i in range(3)] == [0, 1, 2]
    with pytest.raises(ConfigError, match="`house` cannot be chosen"):
        zoo.reset(options={"house": 0})
    wrapped = brax.wrap_for_training(brax.BraxEnv(zoo.gym.env), episode_length=1)
    state = jax.jit(wrapped.reset)(jax.random.split(jax.random.key(0), NUM))
    after = jax.jit(wrapped.step)(state, jnp.zeros((NUM, 4)))
    assert [s.pipeline_state.world.episode.tolist() for s in (state, after)] == [[0, 1, 2], [3, 4, 5]]


def test_a_step_after_the_end_is_refused(make, made):
    """An environment alone asks for a reset; in the core the state says so; a batch resets by itself."""
    env = with_source(made, GymEnv, make("drawn"))
    env.reset(seed=0)
    assert env.step(idle(env))[3]
    with pytest.raises(gymnasium.error.ResetNeeded, match="the episode is over"):
        env.step(idle(env))
    env.reset()
    env.step(idle(env))


def test_environments_of_a_sync_batch_share_the_rows(make):
    """Each begins at its own row, as in `GymVectorEnv`; all began at row 0."""
    options = make("episodes")
    envs = gymnasium.vector.SyncVectorEnv([lambda: GymEnv(**options)] * 2)
    for reset, wanted in (({}, [0, 1]), ({}, [2, 3]), ({"seed": 4}, [0, 1]), ({}, [2, 3])):
        assert envs.reset(**reset)[1]["episode_index"].tolist() == wanted
    envs.step(envs.action_space.sample())  # ends the episodes
    assert envs.step(envs.action_space.sample())[4]["episode_index"].tolist() == [4, 5]
    assert envs.reset(options={"episode": 5})[1]["episode_index"].tolist() == [5, 5]
    assert GymEnv(**options).reset()[1]["episode_index"] == 0


@pytest.mark.parametrize("seed", [[-1, 0, 1], [True, 0, 1]])
def test_seeds_of_a_batch_that_are_no_seeds_are_refused(make, made, seed):
    with pytest.raises(ConfigError, match="seed of environment 0"):
        with_source(made, GymVectorEnv, make("drawn"), NUM).reset(seed=seed)


class _OtherBatch:
    """A batch in one process, as Stable-Baselines3's `DummyVecEnv` makes it."""

    def __init__(self, env_fns):
        self.envs = [_unpack(fn)() for fn in env_fns]


def _unpack(function):
    return function


def test_environments_of_other_batches_share_the_rows(make):
    options = make("episodes")
    envs = _OtherBatch([lambda: GymEnv(**options)] * 2).envs
    assert [[env.reset()[1]["episode_index"] for env in envs] for _ in range(2)] == [[0, 1], [2, 3]]


def test_asynchronous_workers_are_refused_rows_before_they_start(make):
    """Each worker would begin at row 0, because no worker knows how many there are."""
    options = make("episodes")
    with pytest.raises(ConfigError, match=r"begin at the same episode.*vectorization_mode"):
        gymnasium.vector.AsyncVectorEnv([lambda: GymEnv(**options)] * 2, context="spawn")


def _worker(env_fn_wrapper):
    """A worker process of a batch, as those of Stable-Baselines3's `SubprocVecEnv`."""
    return env_fn_wrapper()


def test_other_worker_processes_are_refused_rows(make, monkeypatch):
    options = make("episodes")
    assert _worker(lambda: GymEnv(**options)).reset()[1]["episode_index"] == 0
    monkeypatch.setattr(multiprocessing, "parent_process", object)
    with pytest.raises(ConfigError, match="begin at the same episode"):
        _worker(lambda: GymEnv(**options))


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")  # JAX's, of every fork
@pytest.mark.filterwarnings("ignore:os.fork")
@pytest.mark.skipif(not hasattr(os, "fork"), reason="this system does not fork")
def test_forking_workers_are_refused_before_they_hang(make):
    """Gymnasium forks its asynchronous workers by default; what they raise arrives as `EOFError` only."""
    options = {name: value for name, value in make("drawn").items() if name != "env_id"}
    with pytest.raises(BackendError, match="would fork this process"):
        gymnasium.make_vec(
            "home_mjx/PointNav-v0",
            num_envs=2,
            vectorization_mode="async",
            vector_kwargs={"context": "fork"},
            **options,
        )
    found = multiprocessing.get_context("fork").SimpleQueue()
    child = multiprocessing.get_context("fork").Process(target=_make_in_child, args=(options, found))
    child.start()
    child.join(60)
    assert not child.is_alive()
    assert "cannot make an environment in a forked child" in found.get()


def _make_in_child(options, found):
    try:
        home_mjx.make("PointNav-v0", **options)
    except BackendError as error:
        found.put(str(error))
