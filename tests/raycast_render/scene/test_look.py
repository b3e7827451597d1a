"""Looks of an episode: lights as the preset's own options have them, colours and textures by material."""

import dataclasses

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from handmade import Furniture, shoebox
from lit_scenes import floor_points, lit_bank, scene_of
from numpy.testing import assert_allclose, assert_array_equal
from scipy import stats

from home_mjx.raycast_render.cameras.camera import Camera, Lens
from home_mjx.raycast_render.images.render import render
from home_mjx.raycast_render.lighting import lights
from home_mjx.raycast_render.scene.appearance import LAYER, RED, SWAP, AppearanceOverrides, hash_uniform, swap_textures
from home_mjx.raycast_render.scene.vec import Vec
from home_mjx.raycast_render.shaders.lit import LitShader

SEED = jnp.uint32(12345)
LIT = LitShader(max_specular_depth=0)
DARK = AppearanceOverrides(SEED, lamps=jnp.zeros(2), daylight=jnp.float32(0.0))
POINTS = np.array([[0.0, 0.0], [1.0, 0.5], [-2.0, 1.0]])


@pytest.fixture(scope="module")
def bank():
    """A lamp in the room, one of none, a window's light, and a thing on the floor."""
    house = shoebox(furniture=(Furniture((1.0, 0.0), (0.4, 0.4, 0.8)),))
    lamp, outside = {"intensity": (8, 8, 8)}, {"room": -1, "pos": (1, 1, 2), "intensity": (5, 4, 3)}
    window = {"daylight": True, "pos": (-2, 0, 1.5), "direction": (1, 0, -0.3), "area": 0.5, "axis_v": (0, 0, 0.5)}
    return lit_bank(lamp, outside, window, house=house)


@pytest.fixture(scope="module")
def draw(bank):
    def images(look, preset, kinds):
        camera = Camera(jnp.array([-2.0, 0.2, 1.5]), jnp.array([0.5, 0.5, -0.5, -0.5]), jnp.deg2rad(90.0))
        scene = scene_of(bank).replace(appearance=look)
        return render(scene, camera, Lens(16, 16), kinds=kinds, shader=preset, depth_max=None)

    return jax.jit(images, static_argnums=(1, 2))


def lamp_light(bank, look, options=LIT):
    scene = scene_of(bank).replace(appearance=look)
    placed, at = lights.place_lights(scene, options.sky), floor_points(POINTS)
    return np.asarray(lights.lamp_light(scene, placed, at, None, lights.brightest_lights(placed, at, 3)).diffuse.pack())


def test_without_lamps_and_daylight_it_is_dark(draw):
    images = {look is None: draw(look, LIT, ("rgb", "depth", "material")) for look in (None, DARK)}
    assert images[True]["rgb"].max() > 100
    assert images[False]["rgb"].max() == 0
    for name in ("depth", "material"):
        assert_array_equal(images[True][name], images[False][name])


def test_lamps_are_as_bright_as_their_room_says(bank):
    each = [
        lamp_light(bank, AppearanceOverrides(SEED, lamps=jnp.array(on), daylight=jnp.float32(0.0)))
        for on in ((1.0, 0), (0, 1.0))
    ]
    both = lamp_light(bank, AppearanceOverrides(SEED, lamps=jnp.array([0.5, 3.0]), daylight=jnp.float32(0.0)))
    assert all(light.min() > 0 for light in each)
    assert_allclose(both, 0.5 * each[0] + 3 * each[1], rtol=1e-5)
    whole = lamp_light(bank, None)
    by_day = lamp_light(bank, AppearanceOverrides(SEED, lamps=jnp.zeros(2)))
    assert_allclose(whole, each[0] + each[1] + by_day, rtol=1e-5)


@pytest.mark.parametrize(
    ("look", "options"),
    [
        (AppearanceOverrides(SEED, daylight=jnp.float32(0.25)), {"sun": LIT.sun / 4, "sky": LIT.sky / 4}),
        pytest.param(
            AppearanceOverrides(SEED, exposure=jnp.float32(3.0)),
            {"exposure": LIT.exposure * 3},
            marks=pytest.mark.slow,
        ),
        pytest.param(
            AppearanceOverrides(SEED, sun_azimuth=jnp.float32(1.0)),
            {"sun_azimuth": float(np.rad2deg(1.0))},
            marks=pytest.mark.slow,
        ),
        (AppearanceOverrides(SEED, sun_elevation=jnp.float32(0.7)), {"sun_elevation": float(np.rad2deg(0.7))}),
    ],
    ids=["daylight", "exposure", "azimuth", "elevation"],
)
def test_light_is_as_the_options_of_the_preset_would_have_it(bank, draw, look, options):
    there = dataclasses.replace(LIT, **options)
    assert_allclose(lamp_light(bank, look), lamp_light(bank, None, there), rtol=1e-5, atol=1e-7)
    drawn_by = draw(look, LIT, ("rgb",))["rgb"], draw(None, there, ("rgb",))["rgb"]
    assert np.abs(drawn_by[0].astype(int) - drawn_by[1]).max() <= 1
    outside = sun(bank, look, LIT), sun(bank, None, there)
    assert_allclose(*outside, rtol=1e-4, atol=1e-6)


def sun(bank, look, options):
    """On the roof, where it shines."""
    point = floor_points(POINTS)
    high = point.replace(pos=Vec(point.pos.x, point.pos.y, point.pos.z + 50.0))
    light = lights.sun_light(
        scene_of(bank).replace(appearance=look), high, None, options.sun, options.sun_azimuth, options.sun_elevation
    ).diffuse.pack()
    assert light.min() > 0
    return light


def test_colours_change_by_material_and_never_by_more_than_said(draw):
    kinds = "albedo", "depth", "material"
    plain, other = (draw(look, "fast", kinds) for look in (None, AppearanceOverrides(SEED, tint=jnp.float32(0.3))))
    assert_array_equal(plain["depth"], other["depth"])
    ratio = np.asarray(other["albedo"] / plain["albedo"])
    clipped = np.asarray(other["albedo"]) >= 1
    assert (np.abs(ratio - 1) <= 0.3 + 1e-6)[~clipped].all()
    rows = np.asarray(plain["material"])
    assert len(np.unique(rows)) > 1
    for row in np.unique(rows):
        here = ratio[rows == row]
        assert_allclose(here, np.broadcast_to(here[0], here.shape), rtol=1e-5)
    means = [ratio[rows == row].mean() for row in np.unique(rows)]
    assert len(np.unique(np.round(means, 4))) > 1
    assert_array_equal(plain["albedo"], draw(AppearanceOverrides(SEED, tint=jnp.float32(0.0)), "fast", kinds)["albedo"])


def test_the_preset_fast_shows_exposure_alone(draw):
    plain, dark = (draw(look, "fast", ("rgb",))["rgb"] for look in (None, DARK))
    assert_array_equal(plain, dark)
    dim = draw(AppearanceOverrides(SEED, exposure=jnp.float32(0.5)), "fast", ("rgb",))["rgb"]
    linear = [np.where(x > 10, ((x / 255 + 0.055) / 1.055) ** 2.4, x / 255 / 12.92) for x in (plain, dim)]
    assert_allclose(linear[1], linear[0] / 2, atol=0.004)


def test_what_materials_draw_is_even_and_independent():
    rows = jnp.arange(100_000)
    each = {what: np.asarray(hash_uniform(SEED, rows, what)) for what in (RED, SWAP, LAYER)}
    for numbers in each.values():
        assert stats.kstest(numbers, "uniform").pvalue > 0.01
        assert abs(np.corrcoef(numbers[1:], numbers[:-1])[0, 1]) < 0.01
    assert abs(np.corrcoef(each[RED], each[LAYER])[0, 1]) < 0.01
    assert abs(np.corrcoef(each[RED], np.asarray(hash_uniform(SEED + 1, rows, RED)))[0, 1]) < 0.01
    assert_array_equal(each[RED], hash_uniform(SEED, rows, RED))


def test_textures_are_exchanged_as_often_as_said_for_any_of_the_bank():
    rows = jnp.arange(20_000)
    layer = jnp.where(rows % 4 == 0, -1, rows % 7)  # textures 0 to 6
    share = 0.3
    new = np.asarray(swap_textures(AppearanceOverrides(SEED, swap=jnp.float32(share)), layer, rows, layer))
    assert (new[np.asarray(layer) < 0] == -1).all()
    textured = np.asarray(layer) >= 0
    kept = (new == layer)[textured].mean()
    assert abs(kept - (1 - share * 6 / 7)) < 0.015  # one in seven gets its own again
    every = np.asarray(swap_textures(AppearanceOverrides(SEED, swap=jnp.float32(1.0)), layer, rows, layer))[textured]
    assert stats.chisquare(np.bincount(every, minlength=7)).pvalue > 0.01
    assert_array_equal(swap_textures(AppearanceOverrides(SEED, swap=jnp.float32(0.0)), layer, rows, layer), layer)
    assert swap_textures(None, layer, rows, layer) is layer
    none = jnp.full(3, -1)
    assert_array_equal(swap_textures(AppearanceOverrides(SEED, swap=jnp.float32(1.0)), none, rows[:3], none), none)
