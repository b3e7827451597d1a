"""Options by name: nested, dotted, flat; and what helps who got one wrong."""

import dataclasses

import pytest

import home_mjx
from home_mjx.audio_jax import AudioConfig
from home_mjx.errors import ConfigError
from home_mjx.physics import PhysicsConfig, PhysicsSetup
from home_mjx.scene_compile import CompileOptions
from home_mjx.schema import AgentBody, Timing
from home_mjx.tasks import AgentCamera, DiscreteActions, EnvConfig, Task, make_config
from home_mjx.tasks.base.options import override_options
from home_mjx.tasks.suite import PointNav


@dataclasses.dataclass(frozen=True)
class Roomy(Task):
    """A task with an option that is named like one of the body's."""

    radius: float = 1.0


RECORDS = {"": EnvConfig(), "task": PointNav(), "compile": CompileOptions()}


@pytest.mark.parametrize("value", ["x", True, None, 1j, (0.5,)])
def test_a_tasks_option_has_the_type_of_its_default(value):
    with pytest.raises(ConfigError, match=r"`task.success_distance` must be a float, got"):
        override_options(RECORDS, {"success_distance": value})
    assert override_options(RECORDS, {"success_distance": 1})["task"].success_distance == 1


def test_a_hint_names_no_option_that_could_be_several():
    with pytest.raises(ConfigError, match=r"Did you mean `(?!radius`)"):
        override_options({"": EnvConfig(), "task": Roomy()}, {"radiu": 0.5})


def test_a_field_is_found_at_any_depth():
    chosen = override_options(
        RECORDS, {"width": 32, "num_agents": 2, "success_distance": 0.5, "cell": 0.05, "mass": 70.0, "sim_dt": 0.05}
    )
    config = chosen[""]
    assert (config.width, config.physics.num_agents, config.body.mass, config.timing.sim_dt) == (32, 2, 70.0, 0.05)
    assert chosen["task"] == PointNav(success_distance=0.5)
    assert chosen["compile"].navigation.cell == 0.05


def test_paths_and_whole_records_say_the_same():
    flat = override_options(RECORDS, {"friction": 0.5})
    assert override_options(RECORDS, {"physics.friction": 0.5}) == flat
    assert override_options(RECORDS, {"physics": PhysicsConfig(friction=0.5)}) == flat
    both = override_options(RECORDS, {"physics": PhysicsConfig(friction=0.5), "physics.num_agents": 3})
    assert (both[""].physics.friction, both[""].physics.num_agents) == (0.5, 3)
    assert override_options(RECORDS, {"task.success_distance": 0.5})["task"].success_distance == 0.5


def test_fields_that_only_fit_together_are_changed_together():
    config = make_config(ctrl_dt=0.03, sim_dt=0.03, sample_rate=8000)
    assert (config.timing.substeps, config.timing.frame) == (1, 240)
    tall = override_options({"": config}, {"radius": 0.9, "body.height": 2.5, "ctrl_dt": 0.06})[""]
    setup = tall.physics_setup
    assert (setup.body.radius, setup.timing.ctrl_dt, tall.audio.timing.frame) == (0.9, 0.06, 480)


def test_body_and_clock_have_one_source():
    config = EnvConfig(body=AgentBody(radius=0.2), timing=Timing(ctrl_dt=0.2))
    assert not {"body", "timing"} & {field.name for field in dataclasses.fields(config.physics)}
    setup = config.physics_setup
    assert setup == PhysicsSetup(body=AgentBody(radius=0.2), timing=Timing(ctrl_dt=0.2))
    assert setup.body is config.body
    assert setup.timing is config.audio.timing is config.timing
    assert config.replace(timing=Timing()).physics_setup.timing == Timing()
    for wrong in (PhysicsSetup(), setup):
        with pytest.raises(ConfigError, match=r"PhysicsSetup.*PhysicsConfig\(\.\.\.\).*`timing` of the environment"):
            EnvConfig(physics=wrong)
    with pytest.raises(ConfigError, match=r"`audio\.timing`.*`timing`"):
        EnvConfig(audio=AudioConfig(timing=Timing(ctrl_dt=0.2)))


def test_agents_have_the_common_body_or_their_own():
    bodies = (AgentBody(radius=0.2), AgentBody(radius=0.3))
    assert EnvConfig(body=bodies[0], physics=PhysicsConfig(num_agents=2)).agents == (bodies[0],) * 2
    config = EnvConfig(physics=PhysicsConfig(num_agents=2, bodies=bodies))
    assert config.agents == config.physics_setup.agents == bodies
    assert config.select_agents(1).agents == bodies[:1]


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("sucess_distance", "Did you mean `success_distance`"),
        ("celll", "Did you mean `cell`"),
        ("physics.frictoin", r"Did you mean `physics\.friction`"),
        ("agent_radius", r"is now `body\.radius`"),
        ("agent_mass", r"is now `body\.mass`"),
        ("num_envs", "vmap"),
        ("seed", "key"),
        ("image_size", "`width` and `height`"),
        ("max_episode_steps", "`episode_length`"),
        ("gps", "gps_compass"),
        ("compass", "gps_compass"),
        ("success_radius", "`success_distance`"),
        ("turn_angle", "DiscreteActions"),
        ("render_mode", "Gymnasium"),
    ],
)
def test_wrong_names_are_answered_with_the_right_ones(name, words):
    with pytest.raises(ConfigError, match=words):
        override_options(RECORDS, {name: 1})


def test_moves_are_given_as_json_has_them():
    """On the command line there is no other way."""
    found = make_config(actions={"forward_step_size": 0.5, "turn_angle": 30}, ctrl_dt=0.6)
    assert found.actions == DiscreteActions(forward_step_size=0.5, turn_angle=30)
    with pytest.raises(ConfigError, match="Did you mean `turn_angle`"):
        make_config(actions={"turn_angel": 30})


@pytest.mark.parametrize(("name", "words"), [("gps", "gps_compass"), ("semantic", "instance"), ("pointgoal", "goal")])
def test_words_of_the_field_for_sensors_are_answered(name, words):
    with pytest.raises(ConfigError, match=rf"unknown sensor `{name}`.*{words}"):
        home_mjx.make("PointNav-v0", sensors=(name,))


def test_wrong_records_are_refused():
    with pytest.raises(ConfigError, match="`physics` must be a PhysicsConfig"):
        make_config(physics={})
    with pytest.raises(ConfigError, match="`task` must be a PointNav"):
        override_options(RECORDS, {"task": 3})


def test_make_refuses_before_it_compiles(monkeypatch):
    monkeypatch.setattr("home_mjx.env_factory._load", None)  # would fail if it were called
    with pytest.raises(ConfigError, match="success_distance"):
        home_mjx.make("PointNav-v0", sucess_distance=1.0)
    with pytest.raises(ConfigError, match="Did you mean `num_houses`"):
        home_mjx.make("PointNav-v0", num_hoses=2)
    with pytest.raises(ConfigError, match="success_distance"):
        home_mjx.make("PointNav-v0", success_distance=-1.0)
    with pytest.raises(ConfigError, match="Did you mean `goal`"):
        home_mjx.make("PointNav-v0", sensors=("gaol",))


def test_a_bank_takes_no_choice_of_houses(generated_bank):
    with pytest.raises(ConfigError, match="`num_houses` chooses houses of a dataset"):
        home_mjx.make("PointNav-v0", generated_bank, num_houses=2)


def test_an_option_of_a_task_is_never_lost():
    """A task's field may be named like another option; then only the full name will do."""

    @dataclasses.dataclass(frozen=True)
    class Sledge(Task):
        friction: float = 3.0
        width: int = 2

    records = {"": EnvConfig(), "task": Sledge(), "compile": CompileOptions()}
    for name in ("friction", "width"):
        with pytest.raises(ConfigError, match=rf"`{name}` could be any of .*task\.{name}"):
            override_options(records, {name: 1})
    chosen = override_options(records, {"task.friction": 1.0, "task.width": 5, "physics.friction": 0.5})
    assert chosen["task"] == Sledge(1.0, 5)
    assert (chosen[""].physics.friction, chosen[""].width) == (0.5, 64)


def test_a_list_is_as_good_as_a_tuple():
    assert make_config(sensors=["rgb", "goal"]) == make_config(sensors=("rgb", "goal"))
    assert hash(make_config(cameras=[AgentCamera(name="left")])) == hash(
        make_config(cameras=(AgentCamera(name="left"),))
    )
