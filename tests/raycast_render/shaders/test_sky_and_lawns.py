"""Clouds, haze, grass and the night, as cameras see them."""

import functools
from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from lit_scenes import lit_bank, scene_of

from home_mjx.bank.records.materials import KIND_INDEX
from home_mjx.errors import ConfigError
from home_mjx.raycast_render.cameras.camera import Camera, Lens
from home_mjx.raycast_render.images.render import render
from home_mjx.raycast_render.lighting import outside
from home_mjx.raycast_render.lighting.outside import cloud_density
from home_mjx.raycast_render.scene.vec import Vec
from home_mjx.raycast_render.shaders import lit
from home_mjx.raycast_render.shaders.base import resolve_shader
from home_mjx.raycast_render.shaders.lit import LitShader, NightShader

LEVEL = np.array([0.5**0.5, 0.5**0.5, 0, 0], np.float32)  # looks along +y
DAY = LitShader(num_lights=0, max_specular_depth=0)
LAMP = LitShader(num_lights=1, max_specular_depth=0, sun=0.0)


def sky_directions(count=20_000):
    rng = np.random.default_rng(0)
    way = rng.normal(size=(count, 3)).astype(np.float32)
    way[:, 2] = abs(way[:, 2])
    return way / np.linalg.norm(way, axis=1, keepdims=True)


def test_cover_is_the_share_of_cloudy_sky_and_the_horizon_stays_clear():
    way = sky_directions()
    high = way[:, 2] > 0.2
    share = [
        np.asarray(cloud_density(Vec.unpack(jnp.asarray(way)), cover))[high].mean() for cover in (0.0, 0.3, 0.6, 1.0)
    ]
    assert share[0] == 0
    assert share[3] > 0.97
    np.testing.assert_allclose(share[1:3], (0.3, 0.6), atol=0.15)
    long = np.asarray(cloud_density(Vec.unpack(jnp.asarray(7 * way)), 0.5))
    np.testing.assert_allclose(long, cloud_density(Vec.unpack(jnp.asarray(way)), 0.5), atol=2e-3)
    low = cloud_density(Vec.unpack(jnp.array([[1.0, 0, 0], [1.0, 0, -0.5], [0, 0, 1.0]])), 1.0)
    assert np.isfinite(low).all()
    assert low[:2].max() == 0
    nothing = cloud_density(Vec.unpack(jnp.array([[np.nan, 0, 1.0]])), 0.5)
    assert nothing.shape == (1,)


def test_clouds_are_in_the_sky_alone_and_scale_with_it():
    way = Vec.unpack(jnp.asarray(sky_directions(500)))
    plain, cloudy = (np.asarray(lit.sky_radiance(way, LitShader(clouds=c)).pack()) for c in (0.0, 0.5))
    changed = abs(plain - cloudy).max(axis=1) > 0.05
    assert 0.2 < changed.mean() < 0.9
    half = np.asarray(lit.sky_radiance(way, LitShader(clouds=0.5, sky=1.5)).pack())
    np.testing.assert_allclose(half, cloudy / 2, rtol=1e-5)
    below = Vec.unpack(jnp.array([[0.3, 0.2, -0.6]]))
    np.testing.assert_array_equal(
        lit.sky_radiance(below, LitShader(clouds=1.0)).pack(), lit.sky_radiance(below, LitShader()).pack()
    )


@functools.cache
def program(options, size):
    return jax.jit(
        lambda b, c: render(scene_of(b), c, Lens(size, size), kinds=("radiance", "distance"), shader=options)
    )


def light(bank, options, pos=(0.0, 0.0, 1.5), quat=LEVEL, size=8, fovy=1.0):
    camera = Camera(jnp.array(pos, jnp.float32), jnp.asarray(quat), jnp.float32(fovy))
    return {k: np.asarray(v) for k, v in program(options, size)(bank, camera).items()}


def test_haze_fades_what_is_far_by_koschmieder_and_softens_the_horizon():
    bank, far = lit_bank({}), {"pos": (0.0, 100.0, 2.0), "fovy": 0.1}
    hazy, plain = replace(LAMP, haze=0.05), LAMP
    share = np.exp(-0.05 * light(bank, plain)["distance"])
    horizon = np.multiply(lit.HORIZON_COLOR, LitShader.sky)
    expected = light(bank, plain)["radiance"] * share + horizon * (1 - share)
    np.testing.assert_allclose(light(bank, hazy)["radiance"], expected, rtol=1e-4)
    seen, clear = light(bank, hazy, **far)["radiance"][:, 0], light(bank, plain, **far)["radiance"][:, 0]
    np.testing.assert_array_equal(seen[:4], clear[:4])  # above the horizon
    assert (np.diff(abs(seen[4:] - horizon).max(axis=1)) > 0).all(), "the nearer to the horizon the hazier"


def test_grass_has_detail_of_mean_one_that_fades_with_distance_and_nothing_else_has():
    bank, down = lit_bank({"intensity": (9, 9, 9)}), np.array([1.0, 0, 0, 0], np.float32)
    kinds = jnp.full_like(bank.materials.kind, KIND_INDEX["grass"])
    lawn, grass = bank.replace(materials=bank.materials.replace(kind=kinds)), replace(LAMP, grass=True)
    options = {"quat": down, "size": 64, "fovy": 0.3}
    plain = light(bank, LAMP, **options)["radiance"]
    np.testing.assert_array_equal(light(bank, grass, **options)["radiance"], plain)
    near = light(lawn, grass, **options)["radiance"] / plain
    assert near.std() > 0.15
    assert near.mean() == pytest.approx(1, abs=0.06)
    assert near.min() > 0.1
    wide = [light(b, o, **options | {"fovy": 3.1})["radiance"][31:33, 31:33] for b, o in ((lawn, grass), (bank, LAMP))]
    np.testing.assert_allclose(*wide, rtol=1e-5)


def test_options_that_are_off_are_not_in_the_program(monkeypatch):
    scene, camera = scene_of(lit_bank({})), Camera(jnp.zeros(3), jnp.asarray(LEVEL), jnp.float32(1.0))

    def text(options):
        return jax.jit(lambda c: render(scene, c, Lens(4, 4), kinds=("rgb",), shader=options)).lower(camera).as_text()

    plain = text(DAY)
    for other in ({"clouds": 0.5}, {"haze": 0.01}, {"grass": True}):
        assert text(replace(DAY, **other)) != plain
    for name in ("add_clouds", "add_haze", "grass_detail"):
        monkeypatch.setattr(outside, name, None)
    assert text(DAY) == plain


def test_night_is_a_preset_of_lamplight():
    night = resolve_shader("night")
    assert night == NightShader()
    assert (night.sun, night.num_lights, night.max_specular_depth) == (0.0, LitShader.num_lights, 2)
    assert 0 < night.sky < LitShader.sky / 100
    with pytest.raises(ConfigError, match="clouds"):
        LitShader(clouds=1.5)
