"""What an episode draws is seen, heard and felt as closed forms say; with nothing drawn nothing is different."""

import dataclasses
import functools

import gymnasium
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from counted_jit import CountedJit
from handmade import Furniture, shoebox
from lit_scenes import lit_bank
from numpy.testing import assert_allclose, assert_array_equal

import home_mjx
from home_mjx.adapters.gymnasium import GymEnv, GymVectorEnv
from home_mjx.audio_jax.auralization.clips import CLIPS
from home_mjx.errors import ConfigError, UnknownNameError
from home_mjx.raycast_render.shaders.lit import LitShader
from home_mjx.registry import EnvSpec, find_spec
from home_mjx.tasks import AutoReset, HouseholdEnv, Variation, load_states, make_config, save_states
from home_mjx.tasks.suite import PointNav

NUM = 6
LIT = LitShader(num_lights=1, max_specular_depth=0)
# With these nothing is other than without variation.
NEUTRAL = {
    "lamps": 1.0,
    "lamp_gain": 1.0,
    "daylight": 1.0,
    "sun_azimuth": LIT.sun_azimuth,
    "sun_elevation": LIT.sun_elevation,
    "exposure": 1.0,
    "colors": 0.0,
    "textures": 0.0,
    "camera_height": 0.0,
    "camera_pitch": 0.0,
    "camera_fovy": 0.0,
    "friction": 1.0,
    "mass": 1.0,
    "volume": 1.0,
    "clips": ("radio",),
    "move_noise": 0.0,
    "depth_noise": 0.0,
    "color_noise": 0.0,
    "stereo_noise": 0.0,
}
OPTIONS = {
    "sensors": ("rgb", "depth", "pose", "intrinsics", "audio", "state"),
    "width": 12,
    "height": 12,
    "shader": LIT,
    "actions": "discrete",
    "clips": ("bell",),
    "late": "none",  # `test_varied_sound` has reverberation
}


class Moves:
    """A reset and a move forward, and how often what is seen and heard was traced."""

    def __init__(self, core):
        self.looks = CountedJit(jax.vmap(functools.partial(core.observe, update=True), (None, 0)))
        self.begin = jax.jit(jax.vmap(functools.partial(core.reset, observe=False), (None, 0)))
        self.advance = CountedJit(jax.vmap(functools.partial(core.step, observe=False), (None, 0, 0)))

    @property
    def traces(self):
        return self.looks.traces + self.advance.traces

    def __call__(self, params, keys):
        first = self.looks(params, self.begin(params, keys))
        forward = jnp.full(len(keys), 1, jnp.int32)
        return first, self.looks(params, self.advance(params, first, forward))


@pytest.fixture(scope="module")
def bank():
    window = {"daylight": True, "pos": (-2.9, 0, 1.5), "direction": (1, 0, 0), "area": 1.0, "axis_v": (0, 0, 0.5)}
    things = Furniture((1.5, 1.0), (0.4, 0.4, 0.4), mass=2.0), Furniture((-1.5, -1.0), (0.8, 0.4, 1.2))
    return lit_bank({"intensity": (20, 20, 20)}, window, house=shoebox(furniture=things))


@pytest.fixture(scope="module")
def env(bank):
    return HouseholdEnv(make_config(**OPTIONS), PointNav()).bind(bank)


@pytest.fixture(scope="module")
def program(env):
    """A reset and a move forward."""
    return Moves(env.core)


@pytest.fixture(scope="module")
def played(env, program):
    """States at the start and after a step, with some ranges."""
    keys = jax.random.split(jax.random.key(4), NUM)
    return lambda **ranges: program(env.with_variation(NEUTRAL | ranges).params, keys)


@pytest.fixture(scope="module")
def neutral(played):
    return played()


def obs(states, name):
    return np.asarray(states.obs[name])


def test_none_is_the_same_as_ranges_that_change_nothing(env, program, neutral):
    plain = program(env.params, jax.random.split(jax.random.key(4), NUM))
    for state, other in zip(plain, neutral, strict=True):
        assert_array_equal(state.physics.qpos, other.physics.qpos)
        for name, value in state.obs.items():
            assert_allclose(value.astype(float), other.obs[name].astype(float), atol=1e-4, err_msg=name)
        assert state.world.variation is None
        assert state.physics.scale is None


def test_no_ranges_need_another_program(program, played, neutral):
    before = program.traces
    played(lamps=0.5, colors=(0.1, 0.5), friction=(0.5, 2.0))
    assert program.traces == before


def test_the_same_key_draws_the_same_and_environments_differ(played):
    ranges = {"lamps": 0.5, "exposure": (0.5, 2.0), "camera_height": (-0.3, 0.3), "volume": (0.5, 2.0)}
    one, other = (played(**ranges)[0] for _ in range(2))
    assert jax.tree.all(jax.tree.map(lambda a, b: bool(jnp.array_equal(a, b, equal_nan=True)), one, other))
    drawn = one.world.variation
    for values in (drawn.appearance.exposure, drawn.camera_offsets.height, drawn.volume, drawn.appearance.seed):
        assert len(np.unique(values)) == NUM
    assert drawn.camera_offsets.height.min() >= -0.3
    assert drawn.camera_offsets.height.max() <= 0.3


def test_what_was_drawn_holds_for_the_episode(played):
    first, second = played(lamps=0.5, friction=(0.5, 2.0), exposure=(0.5, 2.0))
    assert jax.tree.all(jax.tree.map(lambda a, b: bool((a == b).all()), first.world.variation, second.world.variation))
    assert_array_equal(first.physics.scale.friction, first.world.variation.body_scale.friction)


def test_a_dark_house_is_dark_and_as_deep(played, neutral):
    dark = played(lamps=0.0, daylight=0.0)[0]
    assert obs(neutral[0], "pixels/head_rgb").max() > 50
    assert obs(dark, "pixels/head_rgb").max() == 0
    assert_array_equal(obs(dark, "pixels/head_depth"), obs(neutral[0], "pixels/head_depth"))


def test_colours_leave_depth_as_it_is(played, neutral):
    coloured = played(colors=1.0, textures=1.0)[0]
    assert_array_equal(obs(coloured, "pixels/head_depth"), obs(neutral[0], "pixels/head_depth"))
    off = obs(coloured, "pixels/head_rgb").astype(int) - obs(neutral[0], "pixels/head_rgb")
    assert (np.abs(off).reshape(NUM, -1).max(axis=1) > 10).all()
    assert len({tuple(image.mean((0, 1))) for image in obs(coloured, "pixels/head_rgb")}) == NUM


def test_cameras_are_mounted_as_drawn_and_ears_are_not(played, neutral):
    plain, moved = neutral[0], played(camera_height=-0.4, camera_pitch=20.0, camera_fovy=-30.0)[0]
    poses = obs(plain, "camera/head_pose"), obs(moved, "camera/head_pose")
    assert_allclose(poses[1][:, :3, 3] - poses[0][:, :3, 3], np.tile([0, 0, -0.4], (NUM, 1)), atol=1e-6)
    ahead = [-pose[:, :3, 2] for pose in poses]
    assert_allclose(ahead[0][:, 2], 0, atol=1e-6)
    assert_allclose(np.degrees(np.arcsin(ahead[1][:, 2])), 20, atol=1e-3)
    assert_allclose(np.arctan2(*ahead[1][:, :2].T), np.arctan2(*ahead[0][:, :2].T), atol=1e-5)
    assert_allclose(obs(moved, "camera/head_intrinsics")[:, 0, 0], 6 / np.tan(np.radians(30)), rtol=1e-5)
    assert_array_equal(obs(moved, "audio"), obs(plain, "audio"))


def test_sounds_are_as_loud_and_others_as_drawn(played, neutral):
    loud, bell = played(volume=4.0), played(clips=("bell",))
    for state, other in zip(loud, neutral, strict=True):
        assert np.abs(obs(other, "audio")).max() > 1e-4
        assert_allclose(obs(state, "audio"), 4 * obs(other, "audio"), rtol=1e-5, atol=1e-9)
    assert (np.asarray(bell[0].world.sounds.clip)[:, 0] == CLIPS.index("bell")).all()
    assert (np.asarray(neutral[0].world.sounds.clip)[:, 0] == CLIPS.index("radio")).all()


def test_moves_have_errors_and_starts_have_none(played, neutral):
    noisy = played(move_noise=1.0)
    assert_array_equal(noisy[0].physics.qpos, neutral[0].physics.qpos)
    way = [np.asarray(s[1].physics.qpos - s[0].physics.qpos)[:, :2] for s in (neutral, noisy)]
    assert (np.linalg.norm(way[0], axis=1) < 0.2501).all()
    assert (np.linalg.norm(way[1] - way[0], axis=1) > 1e-3).all()
    assert_array_equal(noisy[1].world.action, neutral[1].world.action)


def test_images_have_noise_of_each_step(env, played, neutral):
    noisy, stereo = played(depth_noise=3.0, color_noise=3.0), played(stereo_noise=3.0)
    assert_array_equal(obs(stereo[0], "pixels/head_rgb"), obs(neutral[0], "pixels/head_rgb"))
    errors = [obs(a, "pixels/head_depth") - obs(b, "pixels/head_depth") for a, b in zip(stereo, neutral, strict=True)]
    assert all(0 < np.abs(x).mean() < 3 for x in errors)
    assert not np.array_equal(*errors)
    for name in ("pixels/head_depth", "pixels/head_rgb"):
        off = [obs(a, name).astype(float) - obs(b, name) for a, b in zip(noisy, neutral, strict=True)]
        assert all(0 < np.abs(x).mean() < 30 for x in off)
        assert not np.array_equal(off[0], off[1])
    assert obs(noisy[0], "pixels/head_depth").max() <= env.config.max_depth
    again = jax.jit(jax.vmap(env.core.observe, (None, 0)))(env.with_variation(NEUTRAL).params, noisy[0])
    assert_array_equal(again.obs["pixels/head_depth"], noisy[0].obs["pixels/head_depth"])


def test_what_was_drawn_is_saved_with_the_state(env, played, tmp_path):
    states = played(exposure=(0.5, 2.0))[0]
    path = tmp_path / "states.npz"
    assert save_states(path, states) == NUM
    loaded = load_states(path, env.with_variation(NEUTRAL))
    assert_array_equal(loaded.world.variation.appearance.exposure, states.world.variation.appearance.exposure)


def test_resets_draw_anew():
    """And within what the ranges are by then."""
    bank = lit_bank({}, house=shoebox())
    core = HouseholdEnv(make_config(sensors=("state",), impl="kinematic", episode_length=2), PointNav())
    batch, ranges = AutoReset(core), {"volume": (1.0, 2.0)}
    params = core.bind(bank).with_variation(ranges).params
    states = jax.jit(batch.reset)(params, jax.random.split(jax.random.key(0), 16))
    step, seen = CountedJit(batch.step), [np.asarray(states.world.variation.volume)]
    louder = params.replace(variation=Variation.of(volume=(5.0, 6.0)))
    for now in (params, params, params, louder):
        states = step(now, states, jnp.zeros((16, 4)))
        seen.append(np.asarray(states.world.variation.volume))
    assert step.traces == 1
    assert_array_equal(seen[0], seen[1])
    assert (seen[2] != seen[1]).all()
    assert (seen[2] <= 2).all()
    assert_array_equal(seen[2], seen[3])
    assert (seen[4] >= 5).all()


def test_make_and_adapters_hand_ranges_on(bank):
    ranges = {"volume": [0.5, 2.0], "camera_height": (-0.2, 0.2)}
    made = home_mjx.make("PointNav-v0", bank, sensors=("state",), variation=ranges)
    assert made.spec.options["variation"] == {"camera_height": [-0.2, 0.2], "volume": [0.5, 2.0]}
    gym = gymnasium.make("home_mjx/PointNav-v0", houses=bank, sensors=("state",), variation=ranges).unwrapped
    assert isinstance(gym, GymEnv)
    vector = GymVectorEnv(2, houses=bank, sensors=("state",), variation=Variation.of(**ranges))
    for env in (made, gym.env, vector.env):
        assert_allclose(env.params.variation.volume, [0.5, 2.0])
        assert env.params.variation.lamps is None
    assert home_mjx.make("PointNav-v0", bank, sensors=("state",)).params.variation is None


def test_ranges_are_part_of_what_a_run_is_made_of():
    ranges = Variation.of(lamps=0.5, clips=("radio",)).to_dict()
    spec = dataclasses.replace(find_spec("PointNav-v0"), options={"variation": ranges})
    assert EnvSpec.from_json(spec.to_json()) == spec


def test_wrong_ranges_are_refused_before_a_house_is_made(tmp_path):
    with pytest.raises(UnknownNameError, match="exposure"):
        home_mjx.make("PointNav-v0", tmp_path / "nowhere", variation={"exposition": 1})


def test_what_has_no_effect_is_refused_when_it_is_bound(env):
    with pytest.raises(ConfigError, match="lacks the sounds"):
        env.with_variation({"clips": ("noise",)})
    slow = HouseholdEnv(make_config(sensors=("state",), impl="kinematic"), PointNav()).bind(env.bank)
    with pytest.raises(ConfigError, match="Nothing slides"):
        slow.with_variation({"friction": (0.5, 1.0)})
