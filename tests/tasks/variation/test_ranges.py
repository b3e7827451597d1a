"""Ranges are checked when they are made, and drawn from evenly."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from counted_jit import CountedJit
from scipy import stats

from home_mjx.audio_jax.auralization.clips import CLIPS
from home_mjx.errors import ConfigError, UnknownNameError
from home_mjx.tasks import EnvConfig, Variation
from home_mjx.tasks.env.checks import check_variation
from home_mjx.tasks.variation.noise import ERROR_MEAN, ERROR_VARIANCE, add_depth_noise, add_move_noise, add_rgb_noise
from home_mjx.tasks.variation.ranges import to_variation
from home_mjx.tasks.variation.sample import sample_variation

NUM, LAMPS = 20_000, 3
RANGES = {
    "lamps": 0.25,
    "lamp_gain": (0.5, 2.0),
    "daylight": (0.0, 1.5),
    "sun_azimuth": (0.0, 360.0),
    "exposure": (0.5, 1.5),
    "colors": (0.0, 0.4),
    "camera_height": (-0.3, 0.1),
    "camera_pitch": (-10.0, 20.0),
    "friction": (0.5, 2.0),
    "mass": (1.0, 3.0),
    "volume": (0.1, 1.0),
    "clips": {"radio": 1.0, "bell": 3.0},
    "contact_sound_volume": (0.5, 2.0),
    "footstep_distance": (0.5, 0.8),
}


@pytest.fixture(scope="module")
def program():
    return CountedJit(lambda ranges, keys: jax.vmap(lambda key: sample_variation(ranges, key, LAMPS))(keys))


@pytest.fixture(scope="module")
def keys():
    return jax.random.split(jax.random.key(0), NUM)


@pytest.fixture(scope="module")
def drawn(program, keys):
    return program(Variation.of(**RANGES), keys)


def numbers(drawn):
    """In the units of the ranges."""
    look, mount = drawn.appearance, drawn.camera_offsets
    return {
        "daylight": look.daylight,
        "sun_azimuth": jnp.rad2deg(look.sun_azimuth),
        "exposure": look.exposure,
        "colors": look.tint,
        "camera_height": mount.height,
        "camera_pitch": jnp.rad2deg(mount.pitch),
        "friction": drawn.body_scale.friction,
        "mass": drawn.body_scale.mass,
        "volume": drawn.volume,
        "contact_sound_volume": drawn.contact_sound_volume,
        "footstep_distance": drawn.footstep_distance,
    }


def test_numbers_are_drawn_evenly_from_their_ranges(drawn):
    for name, values in numbers(drawn).items():
        low, high = RANGES[name]
        within = (np.asarray(values) - low) / (high - low)
        assert within.min() >= -1e-6, name
        assert within.max() <= 1 + 1e-6, name
        assert stats.kstest(within, "uniform").pvalue > 0.005, name


def test_lamps_of_rooms_are_on_by_chance_and_alike_in_an_episode(drawn):
    lamps = np.asarray(drawn.appearance.lamps)
    on = lamps > 0
    assert stats.binomtest(int(on.sum()), on.size, RANGES["lamps"]).pvalue > 0.01
    assert (lamps[on] >= 0.5).all() and (lamps[on] <= 2.0).all()  # noqa: PT018
    brightest = lamps.max(axis=1, keepdims=True)
    assert (on == (lamps == brightest))[brightest[:, 0] > 0].all()


def test_sounds_are_drawn_by_weight(drawn):
    counts = np.bincount(drawn.clip, minlength=len(CLIPS))
    assert counts.sum() == counts[CLIPS.index("radio")] + counts[CLIPS.index("bell")]
    assert stats.binomtest(int(counts[CLIPS.index("bell")]), NUM, 0.75).pvalue > 0.01


def test_draws_do_not_depend_on_each_other(drawn, keys):
    values = np.stack([np.asarray(x) for x in numbers(drawn).values()])
    between = np.corrcoef(values) - np.eye(len(values))
    assert np.abs(between).max() < 0.035
    alone = jax.jit(lambda r: jax.vmap(lambda key: sample_variation(r, key, LAMPS))(keys))(
        Variation.of(volume=RANGES["volume"])
    )
    np.testing.assert_array_equal(alone.volume, drawn.volume)
    assert alone.camera_offsets is None
    assert alone.body_scale is None
    assert alone.appearance.lamps is None


def test_other_ranges_need_no_other_program_and_the_same_key_draws_the_same(program, drawn, keys):
    again = program(Variation.of(**RANGES), keys)
    assert jax.tree.all(jax.tree.map(jnp.array_equal, again, drawn))
    before = program.traces
    other = program(Variation.of(**RANGES | {"volume": (5.0, 6.0)}), keys)
    assert program.traces == before
    assert other.volume.min() >= 5
    np.testing.assert_array_equal(other.camera_offsets.height, drawn.camera_offsets.height)


def test_nothing_is_drawn_from_none():
    assert sample_variation(None, jax.random.key(0), LAMPS) is None


def test_ranges_go_to_names_and_back():
    variation = Variation.of(**RANGES)
    assert to_variation(variation.to_dict()).to_dict() == variation.to_dict()
    assert jax.tree.all(jax.tree.map(jnp.allclose, to_variation(variation), variation))
    assert to_variation(None) is None
    assert Variation.of(exposure=2).exposure.tolist() == [2, 2]
    assert Variation.of(exposure=None).exposure is None


@pytest.mark.parametrize(
    ("ranges", "said"),
    [
        ({"lights": 0.5}, "unknown variation `lights`"),
        ({"lamps": 1.5}, "`lamps` must be a finite number of at least 0 and at most 1"),
        ({"lamps": (0, 1)}, "`lamps` must be"),
        ({"exposure": (2, 1)}, r"`exposure` is empty: from 2 to 1.*exposure=\(1, 2\)"),
        ({"exposure": (0.5, 1, 2)}, "`exposure` must be .minimum, maximum."),
        ({"exposure": "bright"}, "`exposure`"),
        ({"colors": (0, 2)}, "`colors` must be a finite number of at least 0 and at most 1"),
        ({"friction": (0, 1)}, "`friction`"),
        ({"mass": (1, float("nan"))}, "`mass`"),
        ({"footstep_distance": (0, 1)}, "`footstep_distance` must be a finite number of at least 0.1 and at most 2"),
        ({"clips": ("radoi",)}, "radio"),
        ({"clips": ()}, "`clips` has no sound"),
        ({"clips": 5}, "`clips` must be names of sounds, got 5"),
        ({"clips": (1, 2)}, "`clips` must be names of sounds"),
        ({"clips": {"radio": "loud"}}, "clips.radio"),
        ({"clips": {"radio": -1}}, "clips.radio"),
    ],
)
def test_wrong_ranges_are_refused(ranges, said):
    with pytest.raises(ConfigError, match=said):
        Variation.of(**ranges)


def test_what_is_no_variation_is_refused():
    with pytest.raises(UnknownNameError, match="lamps"):
        to_variation({"lamp": 0.5})
    with pytest.raises(ConfigError, match="ranges by name"):
        to_variation(0.5)


@pytest.mark.parametrize(
    ("options", "ranges", "said"),
    [
        ({}, {"lamps": 0.5}, "shader `fast` does not use it"),
        ({"shader": "lit"}, {"move_noise": (0, 1)}, 'actions="discrete"'),
        ({}, {"contact_sound_volume": (0.5, 2)}, "Bodies make no sounds: give contact_sounds="),
        ({}, {"footstep_distance": (0.5, 0.8)}, "Bodies make no sounds: give contact_sounds="),
        ({}, {"clips": ("radio", "bell")}, 'lacks the sounds "bell"'),
        ({"sensors": ("rgb",)}, {"camera_fovy": (-95, 0)}, "field of view of camera `head` would be -5 to 90 degrees"),
    ],
)
def test_what_would_have_no_effect_is_refused(options, ranges, said):
    with pytest.raises(ConfigError, match=said):
        check_variation(EnvConfig(**options), Variation.of(**ranges))


def test_moves_have_the_errors_of_the_robot():
    """Means and deviations of truncated Gaussians, as SciPy has them."""
    full = jnp.array([[10.0, 10.0, 10.0]])
    keys = jax.random.split(jax.random.key(5), 40_000)
    for row, (drive, amount) in enumerate([((0.025, 0.0, 0.0), 0.25), ((0.0, 0.0, -0.0175), 0.175)]):
        given = jnp.array([drive], jnp.float32)
        many = jax.jit(jax.vmap(lambda key, given=given: add_move_noise(jnp.float32(1.0), key, given, full)))(keys)
        error = np.asarray((many - given)[:, 0] * full[0]) * [1, -1, -1 if row else 1]
        for axis in range(3):
            mean, deviation = ERROR_MEAN[row, axis], np.sqrt(ERROR_VARIANCE[row, axis])
            low = (-0.95 * amount - mean) / deviation if axis == 2 * row else -3.0
            model = stats.truncnorm(max(low, -3.0), 3.0, mean, deviation)
            assert abs(error[:, axis].mean() - model.mean()) < 5 * model.std() / np.sqrt(len(keys))
            assert abs(error[:, axis].std() / model.std() - 1) < 0.02
            assert error[:, axis].min() >= model.support()[0] - 1e-5


def test_who_stands_still_and_noise_of_level_0_change_nothing():
    key, full = jax.random.key(0), jnp.ones((2, 3))
    drive = jnp.array([[0.0, 0.0, 0.0], [0.5, 0.0, 0.0]])
    noisy = add_move_noise(jnp.float32(2.0), key, drive, full)
    assert noisy[0].tolist() == [0, 0, 0]
    assert (noisy[1] != drive[1]).all()
    assert (np.abs(noisy) <= 1).all()
    np.testing.assert_array_equal(add_move_noise(jnp.float32(0.0), key, drive, full), drive)
    depth, rgb = jnp.full((8, 8, 1), 3.0), jnp.full((8, 8, 3), 90, jnp.uint8)
    np.testing.assert_array_equal(add_depth_noise(jnp.float32(0.0), key, depth, 10.0), depth)
    np.testing.assert_array_equal(add_rgb_noise(jnp.float32(0.0), key, rgb), rgb)


def test_depth_noise_grows_with_its_level_and_the_square_of_the_distance():
    key = jax.random.key(1)

    def deviation(level, distance):
        depth = jnp.full((64, 64, 1), distance)
        return float(jnp.std(add_depth_noise(jnp.float32(level), key, depth, 20.0)))

    assert 3.4 < deviation(3.0, 8.0) / deviation(3.0, 4.0) < 4.6
    assert 1.7 < deviation(6.0, 8.0) / deviation(3.0, 8.0) < 2.3
    far = jnp.full((8, 8, 1), 10.0)
    np.testing.assert_array_equal(add_depth_noise(jnp.float32(1.0), key, far, 10.0), far)
