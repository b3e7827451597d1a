"""Light groups of episodes: mixtures against bakes of the same lamps, dark rooms, and what automatic resets renew."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from handmade import shoebox, two_rooms
from lit_scenes import table
from numpy.testing import assert_allclose, assert_array_equal
from test_light_bake import FEW, NIGHT, bake, grey, received
from test_texels import LAMP, baked_scene, incident, seen

from home_mjx.bank.bank import HouseBank
from home_mjx.light_probes import field
from home_mjx.light_probes.field import stack_fields
from home_mjx.raycast_render import LitShader
from home_mjx.raycast_render.lighting.probes import mix_groups, pack_colors, probe_irradiance
from home_mjx.raycast_render.scene.appearance import AppearanceOverrides
from home_mjx.raycast_render.scene.vec import Vec
from home_mjx.raycast_render.shaders.baked import BakedShader
from home_mjx.raycast_render.shaders.base import prepare_shaders
from home_mjx.tasks import AutoReset, EnvParams, HouseholdEnv, Variation, make_config
from home_mjx.tasks.env import autoreset

PLACES = {"pos": (-2.0, 0.5, 2.0), "room": 0}, {"pos": (2.5, -0.5, 1.5), "room": 1, "intensity": (2.0, 2.0, 2.0)}
NIGHT_OPTIONS = {"sun": 0.0, "sky": 0.0}


def lamps(*factors):
    """Overrides with factors of the lamps outside of rooms and of each room."""
    return AppearanceOverrides(jnp.uint32(0), lamps=jnp.array([1.0, *factors]))


@pytest.fixture(scope="module")
def open_rooms():
    """Two rooms with a wide gap between and a lamp in each, and their light."""
    house = grey(two_rooms(opening=2.0), 0.6, *PLACES)
    return house, stack_fields([bake(house)])


def test_colours_are_packed_on_the_device_as_in_the_bake():
    color = np.exp(np.random.default_rng(0).uniform(-12, 12, (4000, 3))).astype(np.float32)
    color[:3] = [[0, 0, 0], [511.9 / 512] * 3, [1e6, 0, 1]]
    assert_array_equal(np.asarray(pack_colors(jnp.asarray(color))), field.pack_colors(color))


@pytest.mark.parametrize("factors", [(0.0, 1.0), (0.5, 3.0)])
def test_a_mixture_equals_a_bake_of_the_dimmed_lamps(open_rooms, factors):
    """Two rooms with a wide gap between: means of the light in each room differ by less than one percent."""
    house, probes = open_rooms
    dimmed = [
        row | {"intensity": np.multiply(row.get("intensity", np.ones(3)), f)}
        for row, f in zip(PLACES, factors, strict=True)
    ]
    fresh = replace(house, lights=table(*dimmed, rooms=2))
    record = bake(fresh)
    rng, normal = np.random.default_rng(0), np.tile([0.0, 0.0, 1.0], (60, 1))
    for room, middle in enumerate((-2.05, 2.05)):
        pos = rng.uniform((middle - 1.8, -2.2, 0.1), (middle + 1.8, 2.2, 2.8), (60, 3))
        want = received(fresh, record, pos, normal, room)
        at, up = (Vec.unpack(jnp.asarray(x, jnp.float32)) for x in (pos, normal))
        mixed = mix_groups(probes, jnp.int32(0), lamps(*factors), NIGHT)
        found = probe_irradiance(probes, mixed, jnp.int32(0), at, up, jnp.full(60, room)).x
        assert np.mean(found) == pytest.approx(want[:, 0].mean(), rel=0.01)
        assert_allclose(found, want[:, 0], rtol=0.05, atol=0.01 * want[:, 0].mean())


@pytest.mark.parametrize("shader", [LitShader, BakedShader])
def test_prepared_light_is_that_of_the_same_overrides_and_without_lamps_all_is_dark(shader):
    """Prepared once, it differs by rounding to nine bits alone."""
    options = shader(**NIGHT_OPTIONS)
    scene = baked_scene(house := grey(shoebox((4.0, 3.0, 2.5)), 0.6, {"pos": LAMP}), bake(house))
    hit, pos, normal = seen(scene, 100)
    for factor, dark in ((0.5, False), (0.0, True)):
        varied = scene.replace(appearance=lamps(factor))
        prepared = prepare_shaders([options], scene.bank, jnp.int32(0), varied.appearance)
        once, anew = (incident(options, s, hit, pos, normal) for s in (varied.replace(prepared=prepared), varied))
        assert_allclose(once, anew, rtol=3e-3)
        assert (once == 0).all() == dark
    assert prepare_shaders([options], scene.bank, jnp.int32(0), None) is None


def test_automatic_resets_renew_the_light_of_the_episodes_that_begin(monkeypatch):
    """It is what the first reset would have made of the lamps that each environment has now."""
    monkeypatch.setattr(autoreset, "MAX_SEPARATE_RENDERS", 1)
    house = grey(shoebox((4.0, 3.0, 2.5)), 0.6, {"pos": LAMP, "intensity": (9.0, 9.0, 9.0)})
    bank = HouseBank.from_compiled([house]).replace(
        bakes={"light_probes": stack_fields([bake(house, replace(FEW, texels=1.0))])}
    )
    sizes = {"sensors": ("rgb",), "width": 4, "height": 4, "shader": BakedShader(**NIGHT_OPTIONS)}
    core = HouseholdEnv(make_config(**sizes, impl="kinematic", episode_length=2, actions="discrete"))
    batch, params = AutoReset(core), EnvParams(bank, variation=Variation.of(lamp_gain=(0.2, 2.0)))
    states = jax.jit(batch.reset)(params, jax.random.split(jax.random.key(0), 3))
    states = states.replace(world=states.world.replace(step=jnp.array([0, 1, 0], jnp.int32)))

    after = jax.jit(batch.step)(params, states, jnp.ones(3, jnp.int32))
    (old, new), gain = (
        [next(iter(s.world.prepared.values())) for s in (states, after)],
        after.world.variation.appearance,
    )
    assert [bool((old.probes[i] == new.probes[i]).all()) for i in range(3)] == [True, False, True]
    for i in range(3):
        own = jax.tree.map(lambda x, i=i: x[i], gain)
        want = next(iter(prepare_shaders(core.config.shaders, bank, jnp.int32(0), own).values()))
        assert_array_equal(new.texels[i], want.texels)
        assert_array_equal(new.probes[i], want.probes)
