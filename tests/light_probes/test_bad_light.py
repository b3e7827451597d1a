"""Bakes of houses whose light is impossible or extreme: an error that names it, or finite light."""

from dataclasses import replace

import numpy as np
import pytest
from handmade import shoebox
from lit_scenes import table

from home_mjx.bank.bank import HouseBank
from home_mjx.bank.records.lights import LIGHT_PROBES, OWN_LAMPS, ZENITH
from home_mjx.errors import ConfigError, DatasetError
from home_mjx.houses import add_bakes
from home_mjx.light_probes import LightProbeBake, ProbeOptions, solve
from home_mjx.light_probes.field import stack_fields
from home_mjx.raycast_render.lighting.probes import unpack_colors
from home_mjx.raycast_render.shaders.base import check_shader_bakes, resolve_shader

FEW = ProbeOptions(spacing=1.5, rays=32, texels=1.0)
LAMP = {"pos": (0.3, 0.2, 1.2)}
CEILING = 5  # row of its material


def house_of(*lamps, color=0.5, mask=None):
    """A closed room of one colour (sRGB) with lamps."""
    house = shoebox()
    rows = replace(house.materials, albedo=house.materials.albedo.copy(), mask=house.materials.mask.copy())
    rows.albedo[:, :3] = color
    if mask is not None:
        rows.mask[CEILING] = mask
    return replace(house, materials=rows, lights=table(*lamps, rooms=1))


def solve_all(house):
    """Light of probes and texels of a house."""
    record = stack_fields([solve.solve_house(HouseBank.from_compiled([house]), 0, house, FEW)])
    return np.asarray(unpack_colors(record.light)), np.asarray(unpack_colors(record.texel))


@pytest.mark.parametrize(
    ("house", "named"),
    [
        (house_of(LAMP, color=np.nan), "reflectance of material 0"),
        (house_of(LAMP, color=-0.1), "reflectance of material 0"),
        (house_of(LAMP, LAMP | {"intensity": (1, np.nan, 1)}), "intensity .* of light 1"),
        (house_of(LAMP | {"intensity": (1, -2, 1)}), "intensity .* of light 0"),
        (house_of(LAMP | {"pos": (0, np.inf, 1)}), "position .* of light 0"),
    ],
)
def test_light_that_is_no_number_is_refused_by_name(house, named):
    with pytest.raises(DatasetError, match=named) as caught:
        add_bakes(HouseBank.from_compiled([shoebox()]), [house], LightProbeBake(FEW))
    assert "shoebox" in str(caught.value)


def test_surfaces_whiter_than_white_count_as_white_and_their_light_is_finite():
    white, hotter = (solve_all(house_of(LAMP, color=color)) for color in (1.0, 3.0))
    for a, b in zip(white, hotter, strict=True):
        np.testing.assert_array_equal(a, b)
        assert np.isfinite(a).all()
        assert a.max() > 0


def test_black_surfaces_reflect_nothing_and_a_lamp_outside_lights_nothing():
    outside = {"pos": (0.0, 0.0, 3.6)}
    for house in (house_of(LAMP, color=0.0), house_of(outside)):
        probes, _ = solve_all(house)
        assert (probes[:, :, OWN_LAMPS] == 0).all()


def test_a_lamp_in_a_wall_gives_finite_light():
    for depth in (0.0, 0.02, 0.05):
        for light in solve_all(house_of({"pos": (3.0 + depth, 0.0, 1.5)})):
            assert np.isfinite(light).all()
            assert (light >= 0).all()


def test_an_open_shell_gets_the_light_of_the_sky_and_no_more_than_outdoors():
    """Without its ceiling, the sky of radiance 1 gives at most pi; by reflections up to 1 / (1 - 0.22) times that."""
    closed, opened = (solve_all(house_of(mask=mask))[0] for mask in (None, 0))
    assert (closed == 0).all()
    sky = opened[:, :, ZENITH : ZENITH + 2].sum(axis=2)
    assert np.isfinite(opened).all()
    assert 1.0 < sky.max() < np.pi / (1 - 0.22)


def test_a_bank_without_the_bake_is_refused_by_baked_and_drawn_by_lit():
    house = house_of(LAMP)
    plain = HouseBank.from_compiled([house])
    with pytest.raises(ConfigError, match=LIGHT_PROBES):
        check_shader_bakes(resolve_shader("baked"), plain)
    check_shader_bakes(resolve_shader("lit"), plain)
    with pytest.raises(ConfigError, match="holds houses"):
        add_bakes(plain, [replace(house, id="other")], LightProbeBake(FEW))
