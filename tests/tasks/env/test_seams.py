"""Tasks and sensors of a user's own, and specs: what is registered reaches every way to make an environment."""

import dataclasses
import functools
import sys
import textwrap

import gymnasium
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from gymnasium.envs import registration
from handmade import shoebox

import home_mjx
from home_mjx import EnvSpec, HouseBank, HouseFilter
from home_mjx.core.checks import check_frozen_dataclass
from home_mjx.errors import ConfigError
from home_mjx.raycast_render import Lens, LitShader
from home_mjx.registry import find_spec, load_entry_point
from home_mjx.tasks import AgentCamera, ArraySpec, Task, make_config
from home_mjx.tasks.base import sensor as sensor_seam
from home_mjx.tasks.suite import PointNav

OWN = '''
"""A user's own file: a task that counts rooms, and a sensor that remembers the last action's turn."""

from dataclasses import dataclass

import jax.numpy as jnp

from home_mjx import Sensor, Task, register, register_sensor
from home_mjx.tasks import ArraySpec


@dataclass(frozen=True)
class SpinAround(Task):
    """Turn by `angle`."""

    angle: float = 1.0  # [rad]

    @property
    def observation_spec(self):
        return {"turned": ArraySpec((1,), "float32", -1e3, 1e3, "angle turned since the start [rad]")}

    def init(self, snapshot, key, columns):
        return {"start": snapshot.pose.yaw, "now": snapshot.pose.yaw}

    def update(self, snapshot, state):
        return {"start": state["start"], "now": snapshot.pose.yaw}

    def observe(self, snapshot, state):
        return {"turned": (state["now"] - state["start"])[:, None]}

    def reward(self, snapshot, before, state):
        return jnp.abs(state["now"] - before["now"])

    def terminated(self, snapshot, state):
        return jnp.all(jnp.abs(state["now"] - state["start"]) >= jnp.float32(self.angle))

    def metrics(self, snapshot, state):
        return {"turned": jnp.mean(jnp.abs(state["now"] - state["start"]))}


class Odometer(Sensor):
    """Length of the way walked so far [m]."""

    name = "odometer"

    def spec(self, config):
        return {"odometer": ArraySpec((1,), "float32", 0.0, 1e6, "way walked [m]")}

    def init(self, config):
        return {"way": jnp.zeros(config.physics.num_agents, jnp.float32),
                "last": jnp.zeros((config.physics.num_agents, 3), jnp.float32)}

    def update(self, config, snapshot, state):
        step = jnp.linalg.norm(snapshot.pose.pos - state["last"], axis=-1)
        way = jnp.where(snapshot.step == 0, 0.0, state["way"] + step)
        return {"way": way, "last": snapshot.pose.pos}

    def observe(self, config, snapshot, state):
        return {"odometer": state["way"][:, None]}


register("SpinAround-v0", SpinAround, {"episode_length": 50})
register_sensor(Odometer())
'''


@pytest.fixture(scope="module")
def bank() -> HouseBank:
    return HouseBank.from_compiled([shoebox()])


@pytest.fixture(scope="module", autouse=True)
def own(tmp_path_factory):
    """The file is imported long after `home_mjx`."""
    folder = tmp_path_factory.mktemp("own")
    (folder / "my_spin_task.py").write_text(textwrap.dedent(OWN))
    sys.path.insert(0, str(folder))
    import my_spin_task  # pyright: ignore[reportMissingImports]

    yield my_spin_task
    sys.path.remove(str(folder))


def test_a_task_and_a_sensor_of_a_users_own_file_reach_gymnasium(bank):
    sensors = ("turned", "odometer", "state")
    options = {"houses": bank, "angle": 0.4, "sensors": sensors, "disable_env_checker": True}
    env = gymnasium.make("home_mjx/SpinAround-v0", **options)
    core = env.unwrapped.env
    assert core.task.angle == 0.4
    assert core.config.episode_length == 50
    obs, _ = env.reset(seed=0)
    assert set(obs) == set(core.observation_spec) == set(sensors)
    walked, before = 0.0, obs["state"][:3]
    for _ in range(10):
        obs, reward, terminated, _, info = env.step(np.array([0.5, 0.0, 1.0, 0.0], np.float32))
        assert env.observation_space.contains(obs)
        walked, before = walked + np.linalg.norm(obs["state"][:3] - before), obs["state"][:3]
        assert obs["odometer"][0] == pytest.approx(walked, abs=1e-5)
        assert not any(value for name, value in info.items() if name.startswith("status/"))
        if terminated:
            break
    assert terminated
    assert info["turned"] >= 0.4
    assert obs["turned"][0] == pytest.approx(info["turned"])
    assert 0 < reward <= info["turned"]
    batch = gymnasium.make_vec("home_mjx/SpinAround-v0", num_envs=2, houses=bank, sensors=("turned",))
    assert batch.reset(seed=0)[0]["turned"].shape == (2, 1)


def test_default_sensors_follow_the_task(bank):
    made = [home_mjx.make(name, bank, late="traced").config.sensors for name in ("SpinAround-v0", "PointNav-v0")]
    assert "turned" in made[0]
    assert ["goal" in sensors for sensors in made] == [False, True]
    with pytest.raises(ConfigError, match="unknown sensor `goal`"):
        home_mjx.make("SpinAround-v0", bank, sensors=("goal",))


def test_it_reaches_brax(bank):
    pytest.importorskip("brax")
    from home_mjx.adapters.brax import BraxEnv

    env = BraxEnv(home_mjx.make("SpinAround-v0", bank, sensors=("turned", "odometer", "state")))
    assert env.observation_size == {"state": (12,)}


COSTLY = ("rgb", "depth", "instance", "audio")
MANY = "PiedPiper-v0"  # three agents, two of which the task leads
# Their parts are those of RoomNav, HouseQA and Fetch.
ALIKE = ("ObjectNav-v0", "VQA-v0", "Rearrange-v0")


@pytest.mark.parametrize("every_way", [False, pytest.param(True, marks=pytest.mark.slow)])
def test_every_environment_keeps_one_tree(generated_bank, articulated_bank, every_way):
    """Shapes, dtypes and structure are the same out of every function, for every id that there is.

    What is seen and heard takes the same way in all of them, and so do resets and steps that observe, which are those
    that do not, and `observe`. In the fast suite one id has all sensors, the others have fast physics, and ids whose
    parts all belong to others as well are left out.
    """
    small = {"sensors": None, "width": 8, "height": 8, "late": "traced", "num_rays": 8, "num_bounces": 2}
    ids = home_mjx.list_envs()
    assert {MANY, *ALIKE} < set(ids)
    for env_id in ids if every_way else set(ids).difference(ALIKE):
        whole = every_way or env_id == MANY
        task = load_entry_point(find_spec(env_id).entry_point)
        few = {"num_tasks": 2} if hasattr(task, "num_tasks") else {}
        bank = articulated_bank if "max_fronts" in find_spec(env_id).options else generated_bank
        env = home_mjx.make(env_id, bank, **small, **few, **{} if whole else {"impl": "kinematic"})
        if not whole:
            cheap = tuple(name for name in env.config.sensors if name not in COSTLY)
            core = home_mjx.HouseholdEnv(dataclasses.replace(env.config, sensors=cheap), env.task)
            env = core.bind(env.params)
        key, spec = jax.ShapeDtypeStruct((2,), jnp.uint32), env.action_spec
        action = jax.ShapeDtypeStruct(spec.shape, spec.dtype)
        begun = jax.eval_shape(functools.partial(env.core.reset, observe=False), env.params, key)
        step = functools.partial(env.core.step, observe=not whole)
        trees = [begun, jax.eval_shape(step, env.params, begun, action)]
        if whole:
            trees.append(jax.eval_shape(functools.partial(env.core.observe, update=True), env.params, begun))
        if every_way:
            trees += [jax.eval_shape(env.reset, key), jax.eval_shape(env.step, begun, action)]
            trees += [jax.eval_shape(env.observe, begun)]
        for tree in trees[1:]:
            assert jax.tree.structure(tree) == jax.tree.structure(begun)
            for a, b in zip(jax.tree.leaves(begun), jax.tree.leaves(tree), strict=True):
                assert (a.shape, a.dtype, a.weak_type) == (b.shape, b.dtype, b.weak_type)
        specs = {name: (spec.shape, np.dtype(spec.dtype)) for name, spec in env.observation_spec.items()}
        assert specs == {name: (x.shape, x.dtype) for name, x in begun.obs.items()}


def test_names_of_sensors_and_ids_are_kept_apart(own):
    same = {"episode_length": 50}  # the same again, as when a cell of a notebook runs twice
    home_mjx.register("SpinAround-v0", own.SpinAround, same)
    with pytest.raises(ConfigError, match="is taken"):
        home_mjx.register("SpinAround-v0", own.SpinAround, {"episode_length": 7})
    with pytest.raises(ConfigError, match="is taken"):
        home_mjx.register("PointNav-v0", own.SpinAround)
    with pytest.raises(ConfigError, match="has no name"):
        home_mjx.register_sensor(home_mjx.Sensor())

    class Other(home_mjx.Sensor):
        name = "odometer"

    with pytest.raises(ConfigError, match="`odometer` of a sensor is taken"):
        home_mjx.register_sensor(Other())


def test_a_spec_makes_the_same_environment_again(tmp_path, bank):
    from generated import generate_flats

    generate_flats(tmp_path, [0])
    options = {
        "sensors": ("depth", "goal"),
        "shader": LitShader(num_lights=2),
        "cameras": (AgentCamera("scan", ("depth",), Lens(8, 4, "lidar"), follow_pitch=False),),
        "task.success_distance": 0.5,
        "body.radius": 0.12,
    }
    env = home_mjx.make("PointNav-v0", tmp_path, num_houses=1, filter=HouseFilter(levels=(1, 3)), **options)
    again = home_mjx.make(EnvSpec.from_json(env.spec.to_json()))
    assert again.spec == env.spec
    assert again.config == env.config
    assert again.task == env.task == PointNav(success_distance=0.5)
    jax.tree.map(np.testing.assert_array_equal, again.bank, env.bank)
    with pytest.raises(ConfigError, match="in memory"):
        home_mjx.make("PointNav-v0", bank, sensors=("goal",)).spec.to_json()


@pytest.mark.parametrize("text", ["", "{", "[1]", '{"__type__": "os:system"}', '{"__type__": "no.such:Thing"}'])
def test_broken_specs_are_refused(text):
    with pytest.raises(ConfigError):
        EnvSpec.from_json(text)


def test_entry_points_that_do_not_exist_are_named():
    home_mjx.register("Nowhere-v0", "no_such_module:Task")
    try:
        with pytest.raises(ConfigError, match="no_such_module:Task"):
            home_mjx.make("Nowhere-v0")
    finally:
        home_mjx.registry._REGISTRY.pop("Nowhere-v0")
        gymnasium.registry.pop("home_mjx/Nowhere-v0")


def changed(own, **methods):
    """The user's task with some of its methods replaced."""
    return type("Changed", (own.SpinAround,), methods)()


@pytest.mark.parametrize(
    ("methods", "words"),
    [
        (
            {"reward": lambda self, snapshot, before, state: 1.0},
            r"Changed\.reward: .* \(1,\), got \(\)",
        ),
        ({"terminated": lambda self, snapshot, state: jnp.ones(1, bool)}, r"Changed\.terminated: .* \(\), got \(1,\)"),
        ({"metrics": lambda self, snapshot, state: {"turned": jnp.ones(1)}}, r"Changed\.metrics, `turned`"),
        ({"observe": lambda self, snapshot, state: {"tuned": jnp.ones((1, 1))}}, r"\['tuned'\].*\['turned'\]"),
        ({"observe": lambda self, snapshot, state: {"turned": jnp.ones(1)}}, r"\(1,\).*declares float32 \(1, 1\)"),
        ({"observe": lambda self, snapshot, state: {"turned": jnp.ones((1, 1), int)}}, "int32.*declares float32"),
    ],
)
def test_tasks_that_break_their_promise_are_told_which(own, bank, methods, words):
    core = home_mjx.HouseholdEnv(make_config(sensors=("turned",)), changed(own, **methods))
    env = core.bind(bank)

    def once(key):
        return env.step(env.reset(key), jnp.zeros(4))

    with pytest.raises((ConfigError, KeyError), match=words):
        jax.eval_shape(once, jax.random.key(0))


def test_sensors_that_cannot_be_registered(own):
    class Picture(home_mjx.Sensor):
        name = "rgb"

    with pytest.raises(ConfigError, match="`rgb` of a sensor is taken by a kind of image"):
        home_mjx.register_sensor(Picture())


def sensor(name, *observations):
    """A class of sensors that promises some observations of zeros."""

    class Zeros(home_mjx.Sensor):
        def spec(self, config):
            return {key: ArraySpec((1,)) for key in observations}

        def observe(self, config, snapshot, state):
            return {key: jnp.zeros((config.num_agents, 1)) for key in observations}

    Zeros.name, Zeros.__name__ = name, name.title()
    return Zeros


@pytest.fixture
def only_here(monkeypatch):
    """Sensors that are registered in a test are forgotten after it."""
    monkeypatch.setattr(sensor_seam, "_REGISTRY", sensor_seam.registered_sensors())


@pytest.mark.parametrize(
    ("sensors", "names", "words"),
    [
        (
            [("nose", "smell"), ("snout", "smell")],
            ("nose", "snout"),
            "`smell` is an observation of the sensor Nose and an observation of the sensor Snout. "
            "Rename it in `Snout.spec` and `Snout.observe`",
        ),
        (
            [("nose", "smell"), ("smell", "odour")],
            ("nose", "smell"),
            "`smell` is an observation of the sensor Nose and the name of the sensor Smell. Rename it in `Smell.name`",
        ),
        (
            [("nose", "state")],
            ("state", "nose"),
            "`state` is the name of the sensor OwnState and an observation of the sensor Nose. "
            "Rename it in `Nose.spec` and `Nose.observe`",
        ),
        (
            [("nose", "goal")],
            ("nose", "goal"),
            "`goal` is an observation of the sensor Nose and an observation of the task PointNav. "
            "Rename it in `Nose.spec` and `Nose.observe`",
        ),
        (
            [("cameras", "smell")],
            ("rgb", "cameras"),
            "`cameras` is the name of the sensor Cameras and the name of the sensor Cameras. "
            "Rename it in `Cameras.name`",
        ),
    ],
    ids=["two observations", "observation and name", "a sensor of ours", "the task", "two names"],
)
def test_names_that_two_sensors_or_the_task_use_are_refused(only_here, sensors, names, words):
    """The later one used to overwrite the earlier in silence."""
    for args in sensors:
        home_mjx.register_sensor(sensor(*args)())
    with pytest.raises(ConfigError) as caught:
        home_mjx.HouseholdEnv(make_config(sensors=names))
    assert str(caught.value) == f"{words}, or leave one of the two out of `sensors`."
    home_mjx.HouseholdEnv(make_config(sensors=names[:1]))  # one of them alone may use it


@pytest.mark.parametrize(("name", "role"), [("rgb", "an image of the sensor Cameras"), ("state", "OwnState")])
def test_a_task_must_not_promise_what_a_sensor_is_called(own, name, role):
    task = changed(own, observation_spec=property(lambda self: {name: ArraySpec((1,))}))
    with pytest.raises(ConfigError, match=f"`{name}` is .*{role} .*task Changed.*`Changed.observation_spec`"):
        home_mjx.HouseholdEnv(task=task)
    home_mjx.HouseholdEnv(make_config(sensors=("depth",)), task)


def test_a_sensor_that_is_named_twice_is_there_once():
    core = home_mjx.HouseholdEnv(make_config(sensors=("state", "goal", "state")))
    assert core.config.sensors == ("state", "goal")
    assert len(core.sensors) == 1


class Bare(Task):
    """No dataclass at all."""


@dataclasses.dataclass
class Thawed(Task):
    """Not frozen."""


class Added(PointNav):
    """Derives from a frozen dataclass; its own field would be no option."""

    bonus: float = 1.0


class Same(PointNav):
    """Adds no field: PointNav's options are its own."""


@pytest.mark.parametrize("task", [Bare, Thawed, Added])
def test_tasks_that_are_no_frozen_dataclasses_are_refused_when_they_are_registered(bank, task, monkeypatch):
    words = f"task {task.__name__} is not a frozen dataclass.*frozen=True"
    with pytest.raises(ConfigError, match=words):
        home_mjx.register("Refused-v0", task)
    assert "Refused-v0" not in home_mjx.list_envs()
    monkeypatch.setattr(home_mjx.registry, "_REGISTRY", dict(home_mjx.registry._REGISTRY))
    monkeypatch.setattr(registration, "registry", dict(gymnasium.registry))
    home_mjx.register("Refused-v0", f"{__name__}:{task.__name__}")  # a name is looked up by `make`
    with pytest.raises(ConfigError, match=words):
        home_mjx.make("Refused-v0", bank)


def test_a_task_that_only_changes_methods_need_not_be_a_dataclass_again():
    check_frozen_dataclass("task", Same)
