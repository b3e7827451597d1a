"""Textures of the second generator: enough, seamless in size, the same each time, of families that are known."""

import numpy as np

from home_mjx.schema.categories import texture_family
from home_mjx.schema.material_kinds import TEXTURE_KINDS
from home_procgen.primitives import textures as before
from home_procgen.textures import patterns
from home_procgen.textures.recipes import ALL_NAMES, RECIPES, texture, texture_names
from home_procgen.things.finishes import FINISHES


def test_there_are_enough():
    pictures = [name for name in ALL_NAMES if name.startswith("picture_")]
    assert len(ALL_NAMES) - len(pictures) >= 150
    assert len(pictures) >= 40
    assert len(set(ALL_NAMES)) == len(ALL_NAMES)


def test_those_of_the_first_generator_are_kept():
    np.testing.assert_array_equal(texture("wood_1"), before.base_texture("wood_1"))


def test_images_differ_and_are_the_same_twice():
    images = {name: texture(name) for name in RECIPES}
    assert {image.shape for image in images.values()} == {(128, 128, 3)}
    assert len({image.tobytes() for image in images.values()}) == len(images)
    assert min(image.std() for image in images.values()) > 1.0
    for name in list(RECIPES)[::17]:
        np.testing.assert_array_equal(texture.__wrapped__(name), images[name])


def test_families_are_known():
    known = {*TEXTURE_KINDS, "picture"}
    assert {texture_family(name) for name in RECIPES} <= known


def test_finishes_name_textures_that_exist():
    used = {m.texture.stem for options in FINISHES.values() for m in options if m.texture is not None}
    assert used <= set(ALL_NAMES)
    assert set(texture_names("picture")) <= used


def test_tiles_have_grout_between_them():
    image = patterns.subway(np.random.default_rng(0), (0.2, 0.2, 0.2), (0.4, 0.4, 0.4), rows=4, columns=2)
    assert np.isclose(image.max(), 0.9)
    assert 0.02 < (image[..., 0] > 0.85).mean() < 0.2
