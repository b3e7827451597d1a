"""Options and arguments that cannot be used: a typed error that names them, before anything is compiled."""

import subprocess
import sys

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import home_mjx
from home_mjx.core.checks import check_names
from home_mjx.errors import ConfigError, DatasetError
from home_mjx.raycast_render.cameras.camera import Lens
from home_mjx.raycast_render.shaders.lit import LitShader
from home_mjx.scene_compile.collision.colliders import ColliderOptions
from home_mjx.scene_compile.collision.movables import MovableOptions
from home_mjx.scene_compile.lighting.lights import LightOptions
from home_mjx.scene_compile.navigation.free_space import NavigationOptions
from home_mjx.scene_compile.semantics.appearance import SemanticOptions
from home_mjx.tasks.base.config import AgentCamera
from home_mjx.tasks.base.options import make_config
from home_mjx.tasks.base.status import Status
from home_mjx.tasks.env.household import HouseholdEnv
from home_mjx.tasks.questions.communication import Communication
from home_mjx.tasks.questions.house_qa import HouseQA

NAN, INF = float("nan"), float("inf")


def test_a_step_that_was_asked_for_stays_or_is_refused():
    """Without moves that fit, a default step becomes longer; 0.1 s that somebody wants does not."""
    assert make_config(actions="discrete").timing.ctrl_dt == 0.3
    assert make_config(actions="discrete", ctrl_dt=0.4).timing.ctrl_dt == 0.4
    for name in ("ctrl_dt", "timing.ctrl_dt"):
        with pytest.raises(ConfigError, match=r"no move of `actions` fits into a step of 0\.1 s"):
            make_config(**{"actions": "discrete", name: 0.1})


REFUSED = {
    make_config: [
        ("width", 0), ("episode_length", 0), ("episode_length", 2**31), ("max_depth", -1.0), ("max_depth", NAN),
        ("eye_height", NAN), ("source_height", INF), ("max_pitch", 10.0), ("backend", "gpu"), ("fovy", 180.0),
        ("num_agents", 0), ("num_agents", 10**6), ("num_sources", 10**6),
        ("agent_mass", NAN), ("num_rays", 0), ("humidity", NAN),
        ("response_seconds", 1e308), ("bin_seconds", 1e308), ("ctrl_dt", 1e308),
    ],
    ColliderOptions: [
        ("max_bottom_height", NAN), ("min_top_height", -1.0), ("max_wall_length", 0.0),
        ("max_boxes_per_object", 0), ("max_boxes_per_object", 10**6),
    ],
    LightOptions: [("room_power", -1.0), ("room_power", NAN)],
    HouseQA: [("kinds", ())],
    SemanticOptions: [("share", 0.0), ("share", -1.0), ("share", NAN), ("share", 1e308)],
    NavigationOptions: [
        ("cell", 0.0), ("cell", -0.1), ("max_step_height", NAN), ("agent_height", NAN), ("agent_height", -2.0),
        ("agent_radius", -1.0), ("margin", -1.0), ("num_goals", 0), ("num_starts", 0),
    ],
    MovableOptions: [
        ("max_bodies", -1), ("max_support_gap", NAN), ("max_support_gap", -0.1), ("max_shrink", -0.1),
        ("min_lowered_height", INF), ("max_edge", -1.0),
    ],
    LitShader: [
        ("exposure", NAN), ("sun_elevation", NAN), ("sky", INF), ("sun", NAN), ("num_lights", -1),
        ("max_specular_depth", -1),
    ],
}  # fmt: skip


@pytest.mark.parametrize(("make", "name", "value"), [(make, *row) for make, rows in REFUSED.items() for row in rows])
def test_options_are_refused_by_name(make, name, value):
    with pytest.raises(ConfigError, match=name):
        make(**{name: value})


def test_a_text_with_commas_is_no_list_of_names():
    """As `--env kinds=color,size` has it: the hint says how to write it there."""
    with pytest.raises(ConfigError) as caught:
        check_names("kind of question", "color,size", ("color", "size"))
    assert 'NAME=["color", "size"]' in caught.value.hint


def test_words_that_are_sounds_need_ears():
    options = {"actions": "discrete", "num_agents": 2}
    task = Communication(channel="audible")
    with pytest.raises(ConfigError, match="none of the sensors hears: state"):
        HouseholdEnv(make_config(sensors=("state",), **options), task)
    assert HouseholdEnv(make_config(sensors=("log_mel",), **options), task).num_agents == 2
    assert HouseholdEnv(make_config(sensors=("state",), **options), Communication()).num_agents == 2


def test_cameras_that_cannot_give_what_they_should_are_refused():
    with pytest.raises(ConfigError, match="intrinsic matrix"):
        AgentCamera("scanner", ("intrinsics",), Lens(8, 8, "lidar"))
    with pytest.raises(ConfigError, match="samples"):
        Lens(samples=10**9)


WRONG_TYPES = """
import tempfile
from pathlib import Path
from home_mjx import AutoReset, Env, HouseBank, HouseFilter, HouseholdEnv, HouseStream, make
from home_mjx.audio_jax import AudioConfig
from home_mjx.errors import ConfigError
from home_mjx.raycast_render import Lens, LitShader
from home_mjx.scene_compile import CompileOptions
from home_mjx.scene_compile import MovableOptions
from home_mjx.scene_compile import NavigationOptions
from home_mjx.datasets import ReadOptions
from home_mjx.tasks import AgentCamera, Episodes, TaskBank, make_config
from home_mjx.tasks import load_episodes, load_tasks, save_episodes, save_tasks

options = [
    ("width", 3.5), ("width", "64"), ("width", True), ("height", float("nan")), ("samples", 1.5),
    ("max_pitch_rate", "x"),
    ("fovy", "a"), ("num_agents", 1.5), ("body.mass", "heavy"), ("num_rays", 2.5), ("sensors", 5),
    ("sensors", "rgb"), ("cameras", None), ("cameras", ["x"]), ("shader", 5), ("shader", LitShader), ("clip", None),
    ("physics", {}), ("audio", "x"), ("actions", 3), ("actions", None),
]
calls = {f"{name}={value!r}": lambda name=name, value=value: make_config(**{name: value}) for name, value in options}
calls |= {
    "camera without name": lambda: AgentCamera(""),
    "heights in words": lambda: make("PointNav-v0", **{"compile.colliders.max_bottom_height": "low"}),
    "light in words": lambda: make("PointNav-v0", **{"compile.lights.room_power": "bright"}),
    "late in words": lambda: AudioConfig(late="baked"),
    "air in words": lambda: AudioConfig(air="cold"),
    "places in words": lambda: make_config(receiver="array", positions="left"),
    "kinds with commas": lambda: make("HouseQA-v0", kinds="color,size"),
    "no kinds": lambda: make("HouseQA-v0", kinds=[]),
    "one kind": lambda: AgentCamera("scanner", "depth"),
    "place": lambda: AgentCamera("scanner", offset=(0.0, "up", 0.0)),
    "pixels": lambda: Lens(10**20, 2.5),
    "no elevation": lambda: Lens(elevation=()),
    "one elevation": lambda: Lens(elevation=(5.0,)),
    "half a light": lambda: LitShader(num_lights=2.5),
    "half a bounce": lambda: LitShader(max_specular_depth=1.5),
    "options": lambda: CompileOptions(read=3),
    "rooms of letters": lambda: HouseFilter(rooms=("a", "b")),
    "half open rooms": lambda: HouseFilter(rooms=(None, 3)),
    "half a slot": lambda: HouseStream("nowhere", num_slots=2.5),
    "no room": lambda: HouseStream("nowhere", capacity_factor=0.0),
    "seed": lambda: HouseStream("nowhere", seed=-1),
    "lens": lambda: AgentCamera("scanner", lens="lidar"),
    "no shader": lambda: AgentCamera("scanner", shader=None),
    "two numbers": lambda: AgentCamera("scanner", offset=(1.0, 2.0)),
    "looks": lambda: AgentCamera("scanner", follow_pitch="no"),
    "stairs": lambda: NavigationOptions(use_stairs="no"),
    "half a body": lambda: MovableOptions(max_bodies=2.5),
    "all bodies": lambda: MovableOptions(max_bodies="all"),
    "half a goal": lambda: NavigationOptions(num_goals=2.5),
    "half a body": lambda: MovableOptions(max_bodies=2.5),
    "a length in words": lambda: MovableOptions(max_support_gap="near"),
    "people": lambda: ReadOptions(people="no"),
    "id": lambda: make(None),
    "split": lambda: make("PointNav-v0", split=5),
    "houses": lambda: make("PointNav-v0", houses=5),
    "num_houses": lambda: make("PointNav-v0", num_houses="8"),
    "half a house": lambda: make("PointNav-v0", num_houses=1.5),
    "rooms": lambda: HouseFilter(rooms=5),
    "category": lambda: HouseFilter(categories="bed"),
    "a bank as options": lambda: HouseholdEnv(HouseBank.__new__(HouseBank)),
    "a part in words": lambda: make("PointNav-v0", **{"compile.semantics.share": "half"}),
    "a bound environment": lambda: AutoReset(Env.__new__(Env)),
}
bank, path = HouseBank.__new__(HouseBank), Path(tempfile.mkdtemp()) / "tasks.jsonl"
for name, call in {
    "save_tasks": lambda path, bank: save_tasks(path, bank, TaskBank.__new__(TaskBank)), "load_tasks": load_tasks,
    "save_episodes": lambda path, bank: save_episodes(path, bank, Episodes.__new__(Episodes)),
    "load_episodes": load_episodes,
}.items():
    calls |= {
        f"{name} of no file": lambda call=call: call(None, bank),
        f"{name} of no houses": lambda call=call: call(path, None),
    }
calls |= {
    "no tasks": lambda: save_tasks(path, bank, None),
    "no episodes": lambda: save_episodes(path, bank, 5),
}
for name, call in calls.items():
    try:
        call()
    except ConfigError:
        continue
    raise SystemExit(f"{name} was taken")
"""


def test_wrong_types_are_refused_as_users_give_them():
    """In a process of its own, without the type checks that pytest turns on."""
    done = subprocess.run([sys.executable, "-c", WRONG_TYPES], capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.parametrize("size", [(0, 8), (10**9, 8), (10**5, 10**5)])
def test_images_of_impossible_size_are_refused(size):
    with pytest.raises(ConfigError, match=r"pixels|width"):
        Lens(*size)
    with pytest.raises(ConfigError, match=r"pixels|width"):
        make_config(width=size[0], height=size[1])


def test_cameras_are_refused_by_name():
    with pytest.raises(ConfigError, match="needs a name"):
        AgentCamera("")
    with pytest.raises(ConfigError, match="offset of camera scanner"):
        AgentCamera("scanner", offset=(0.0, NAN, 0.0))


@pytest.mark.parametrize("num", [-1, 0])
def test_counts_of_houses_are_refused(num):
    with pytest.raises(ConfigError, match="num_houses"):
        home_mjx.make("PointNav-v0", num_houses=num)


def test_what_is_no_dataset_is_refused(monkeypatch, tmp_path):
    with pytest.raises(ConfigError, match="unknown split"):
        home_mjx.make("PointNav-v0", split="all")
    monkeypatch.setenv("SUNCG_DATA_DIR", str(tmp_path / "absent"))
    with pytest.raises(DatasetError, match="absent"):
        home_mjx.make("PointNav-v0", num_houses=1)


@pytest.fixture(scope="module")
def env(generated_bank):
    return home_mjx.make("PointNav-v0", generated_bank, sensors=("depth", "state"), width=16, height=16)


@pytest.mark.parametrize("house", [-1, 2, 10**6])
def test_a_house_out_of_range_is_the_nearest_one(env, house):
    """Native code must never read past its arrays, whatever a jitted caller gives."""
    reset = jax.jit(env.core.reset)
    state, near = (reset(env.params, jax.random.key(0), jnp.int32(i)) for i in (house, min(max(house, 0), 1)))
    np.testing.assert_array_equal(state.obs["pixels/head_depth"], near.obs["pixels/head_depth"])


@pytest.mark.parametrize(
    ("given", "meant"), [((np.nan, 0, np.nan, 0), (0, 0, 0, 0)), ((2, -np.inf, 0.5, 1e30), (1, -1, 0.5, 1))]
)
def test_numbers_of_actions_that_cannot_be_are_clipped_and_told(env, given, meant):
    step, state = jax.jit(env.step), jax.jit(env.reset)(jax.random.key(0))
    bad, good = (step(state, jnp.array(action, jnp.float32)) for action in (given, meant))
    assert Status(int(bad.status)) == Status.ACTION
    assert Status(int(good.status)) == 0
    jax.tree.map(np.testing.assert_array_equal, bad.replace(status=good.status), good)


def test_actions_of_other_shapes_are_refused(env):
    state = jax.eval_shape(env.reset, jax.ShapeDtypeStruct((2,), jnp.uint32))
    with pytest.raises(ConfigError, match=r"shape \(4,\), got \(2, 2\)"):
        jax.eval_shape(env.step, state, jax.ShapeDtypeStruct((2, 2), jnp.float32))
