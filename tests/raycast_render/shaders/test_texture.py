"""Texels, mip levels and the colours between them."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from home_mjx.bank.packing.texture_layers import load_textures, mip_levels, mip_sizes
from home_mjx.errors import ConfigError
from home_mjx.raycast_render.lighting import texture

SIZE = 8


@pytest.fixture
def texels(rng):
    return rng.integers(0, 256, (3, SIZE, SIZE, 4), dtype=np.uint8)


@pytest.fixture
def layers(texels):
    return words([mip_levels(image) for image in texels])


def words(images):
    return jnp.asarray(np.stack(images).view(np.uint32)[..., 0])


def level_of(layers, layer, level):
    """One mip level as an image in linear light, row 0 at the top."""
    sizes = mip_sizes(SIZE)
    start, edge = sum(sizes[:level]), SIZE >> level
    rows = np.asarray(layers).view(np.uint8).reshape(len(layers), -1, 4)[layer, start : start + sizes[level], :3]
    return texture.SRGB_TO_LINEAR[rows.astype(int)].reshape(edge, edge, 3)


def sampled(layers, layer, uv, level):
    uv = jnp.asarray(uv, jnp.float32)
    with jax.numpy_dtype_promotion("strict"), jax.numpy_rank_promotion("raise"):
        rows = jnp.full(uv.shape[:-1], layer, jnp.int32)
        level = jnp.full(uv.shape[:-1], level, jnp.float32)
        return np.asarray(texture.sample_trilinear(layers, rows, uv[..., 0], uv[..., 1], level).pack())


def centers(edge):
    """u and v of texel centres, row 0 at the top."""
    at = (np.arange(edge) + 0.5) / edge
    return np.stack(np.meshgrid(at, 1 - at), axis=-1)


@pytest.mark.parametrize("level", range(4))
@pytest.mark.parametrize("turns", [0, -3, 7])
def test_at_texel_centres_every_level_gives_its_texels(layers, level, turns):
    found = sampled(layers, 1, centers(SIZE >> level) + turns, float(level))
    np.testing.assert_allclose(found, level_of(layers, 1, level), atol=2e-5)


def test_the_nearest_texel_is_the_one_that_the_point_lies_in(layers, texels):
    at = centers(SIZE) + np.array([0.4, -0.4]) / SIZE
    found = texture.sample_nearest(
        layers, jnp.full((SIZE, SIZE), 2), *jnp.moveaxis(jnp.asarray(at, jnp.float32), -1, 0)
    )
    np.testing.assert_array_equal(jnp.stack([texture.texel_channel(found, i) for i in range(4)], axis=-1), texels[2])


def test_between_texels_and_levels_colours_are_mixed(layers):
    image = level_of(layers, 0, 0)
    step = np.array([0.25, -0.5]) / SIZE
    right, below = np.roll(image, -1, axis=1), np.roll(image, -1, axis=0)
    corner = np.roll(right, -1, axis=0)
    expected = (image * 0.75 + right * 0.25 + below * 0.75 + corner * 0.25) / 2
    np.testing.assert_allclose(sampled(layers, 0, centers(SIZE) + step, 0.0), expected, atol=2e-5)
    uv = centers(SIZE) * 0.37
    fine, coarse = (sampled(layers, 0, uv, level) for level in (1.0, 2.0))
    np.testing.assert_allclose(sampled(layers, 0, uv, 1.25), 0.75 * fine + 0.25 * coarse, atol=1e-5)


def test_beyond_the_levels_the_last_one_is_taken(layers):
    uv = centers(SIZE) * 0.61
    np.testing.assert_array_equal(sampled(layers, 0, uv, -3.0), sampled(layers, 0, uv, 0.0))
    np.testing.assert_array_equal(sampled(layers, 0, uv, 9.0), sampled(layers, 0, uv, 3.0))
    assert np.ptp(sampled(layers, 0, uv, 9.0), axis=(0, 1)).max() < 1e-6


def test_each_level_is_the_mean_of_the_finer_one_in_linear_light(rng):
    image = rng.integers(0, 256, (SIZE, SIZE, 4), dtype=np.uint8)
    image[..., 3] = 255
    levels = words([mip_levels(image)])
    for level in range(1, 4):
        fine = level_of(levels, 0, level - 1)
        mean = (fine[::2, ::2] + fine[1::2, ::2] + fine[::2, 1::2] + fine[1::2, 1::2]) / 4
        # Half a byte in sRGB is up to 0.0035 of linear light, in both levels.
        np.testing.assert_allclose(level_of(levels, 0, level), mean, atol=0.006)


def test_what_is_cut_away_does_not_bleed(rng):
    image = np.zeros((4, 4, 4), np.uint8)
    image[:, :2] = (0, 200, 0, 255)
    image[:, 2:] = (255, 0, 255, 0)
    last = mip_levels(image)[-1]
    assert last.tolist() == [0, 200, 0, 128]


@pytest.mark.parametrize(("texels_per_pixel", "level"), [(1.0, 0.0), (2.0, 1.0), (8.0, 3.0), (0.5, -1.0)])
def test_a_level_s_texels_are_as_large_as_the_footprint(texels_per_pixel, level):
    assert texture.mip_level(jnp.float32(texels_per_pixel**2)) == pytest.approx(level, abs=1e-6)


def test_every_byte_is_decoded():
    every = np.arange(256, dtype=np.uint32)
    texel = jnp.asarray(every | every[::-1] << 8 | 7 << 16)
    found = np.asarray(texture.linear_approx(texel).pack())
    expected = np.stack(
        [texture.SRGB_TO_LINEAR, texture.SRGB_TO_LINEAR[::-1], np.full(256, texture.SRGB_TO_LINEAR[7])], axis=-1
    )
    np.testing.assert_allclose(found, expected, atol=1e-5)
    np.testing.assert_array_equal(texture.decode_linear(texel).pack(), expected)
    assert (np.diff(found[:, 0]) > 0).all()


@pytest.mark.parametrize("size", [1, 2, 128])
def test_the_edge_of_a_layer_follows_from_its_texels(size):
    assert texture.texture_edge(jnp.zeros((2, sum(mip_sizes(size))), jnp.uint32)) == size


def test_textures_of_one_pixel_and_of_8k(tmp_path):
    from PIL import Image

    paths = [tmp_path / name for name in ("one.png", "large.png")]
    Image.new("RGB", (1, 1), (10, 200, 30)).save(paths[0])
    Image.new("L", (8192, 4096), 77).save(paths[1])
    layers = load_textures([str(p) for p in paths], 16)
    assert (layers[0] == [10, 200, 30, 255]).all()
    assert (layers[1] == [77, 77, 77, 255]).all()
    with pytest.raises(ConfigError, match="power of two"):
        load_textures([], 100)
