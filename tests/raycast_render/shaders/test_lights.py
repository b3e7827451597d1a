"""Irradiance by points, spots, lines and rectangles, and what stands between."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from handmade import Furniture, shoebox, two_rooms
from lit_scenes import NIGHT, floor_points, lit_bank, scene_of, table

from home_mjx.bank.bank import HouseBank
from home_mjx.raycast_render.lighting import lights

XY = np.stack(np.meshgrid(np.linspace(-2.5, 2.5, 11), np.linspace(-2, 2, 9)), axis=-1).reshape(-1, 2)
STRATA = (np.stack(np.meshgrid(np.arange(16), np.arange(16)), axis=-1).reshape(-1, 2) + 0.5) / 8 - 1


def received(bank, xy=XY, spreads=((0.0, 0.0),), count=4, body_pos=None, **point):
    """Irradiance at floor points, the mean over places of the lights that light comes from."""
    with jax.numpy_dtype_promotion("strict"), jax.numpy_rank_promotion("raise"):
        scene = scene_of(bank, body_pos)
        placed = lights.place_lights(scene, 1.0)
        at = floor_points(xy, **point)

        def one(spread):
            chosen = lights.brightest_lights(placed, at, count)
            return lights.lamp_light(scene, placed, at, jnp.broadcast_to(spread, (len(xy), 2)), chosen).diffuse.pack()

        found = jax.jit(lambda s: jnp.mean(jax.lax.map(one, s), axis=0))(jnp.asarray(spreads, jnp.float32))
    return np.asarray(found, float)


def test_a_point_light_follows_the_inverse_square_and_the_cosine():
    found = received(lit_bank({"pos": (0.5, -0.3, 2.0), "intensity": (3, 2, 1)}))
    offset = np.concatenate([XY - [0.5, -0.3], np.full((len(XY), 1), -2.0)], axis=1)
    expected = 2.0 / np.linalg.norm(offset, axis=1) ** 3
    np.testing.assert_allclose(found, expected[:, None] * [3, 2, 1], rtol=1e-5)


def test_a_spot_light_ends_at_its_cutoff_and_falls_with_its_exponent():
    aim = np.array([0.3, 0.0, -1.0]) / np.hypot(0.3, 1)
    spot = {"pos": (0, 0, 2.5), "direction": aim, "exponent": 3.0, "cutoff": np.cos(0.6)}
    found = received(lit_bank(spot))[:, 0]
    offset = np.concatenate([XY, np.full((len(XY), 1), -2.5)], axis=1)
    distance = np.linalg.norm(offset, axis=1)
    cosine = offset @ aim / distance
    expected = np.where(cosine >= np.cos(0.6), cosine**3, 0) * 2.5 / distance**3
    assert (expected > 0).sum() > 5
    assert (expected == 0).sum() > 20
    np.testing.assert_allclose(found, expected, rtol=1e-4)


def test_a_line_light_has_the_integral_along_it():
    """Irradiance of a line of uniform intensity per metre: I h / (L r^2) [s / sqrt(s^2 + r^2)] between its ends."""
    half, height = 0.8, 1.5
    found = received(lit_bank({"pos": (0, 0, height), "axis_u": (half, 0, 0)}), spreads=STRATA)[:, 0]
    radius2 = height**2 + XY[:, 1] ** 2

    def primitive(s):
        return s / np.sqrt(s**2 + radius2)

    expected = height / (2 * half * radius2) * (primitive(XY[:, 0] + half) - primitive(XY[:, 0] - half))
    np.testing.assert_allclose(found, expected, rtol=2e-3)


def test_a_rectangle_has_the_form_factor_of_a_rectangle():
    """A window overhead: irradiance = pi L F with the form factor of a parallel rectangle (J. R. Howell, B-3)."""
    a, b, height = 0.5, 0.7, 2.0
    rectangle = {
        "pos": (0, 0, height),
        "axis_u": (a, 0, 0),
        "axis_v": (0, b, 0),
        "intensity": (4 * a * b,) * 3,  # radiance 1
        "exponent": 1.0,
        "cutoff": 0.0,
        "area": 4 * a * b,
        "daylight": True,
    }
    found = received(lit_bank(rectangle), spreads=STRATA)[:, 2]  # the sky's colour is (.., .., 1)

    def corner(x, y):
        p, q = x / np.sqrt(x**2 + height**2), y / np.sqrt(y**2 + height**2)
        return p * np.arctan(y / np.sqrt(x**2 + height**2)) + q * np.arctan(x / np.sqrt(y**2 + height**2))

    x, y = XY.T
    sides = corner(x + a, y + b) - corner(x - a, y + b) - corner(x + a, y - b) + corner(x - a, y - b)
    expected = sides / 2
    # Counting every part as a disc of the whole area softens the light close by.
    np.testing.assert_allclose(found, expected, rtol=0.12)
    away = np.linalg.norm(XY, axis=1) > 2.5
    np.testing.assert_allclose(found[away], expected[away], rtol=0.06)


def test_walls_stop_all_light():
    """Lights in one of two closed rooms: the other stays black, and the lit one is as if it were alone."""
    bank = lit_bank({"pos": (-1.0, 0.0, 2.0)}, {"pos": (-0.1, 0.0, 1.5)}, house=two_rooms())
    other = received(bank, XY * [0.7, 1] + np.array([2.1, 0]), room=1)
    assert (other == 0).all()
    here = received(bank, XY * [0.7, 1] - np.array([2.1, 0]), room=0)
    assert (here > 0).all()


def test_the_shadow_of_a_box_is_its_projection():
    """A post of 0.4 x 0.4 x 1 m below a light 2 m high: its top casts a shadow twice its size."""
    bank = lit_bank({"pos": (0, 0, 2.0)}, furniture=(Furniture((0.8, 0.6), (0.4, 0.4, 1.0), mass=5.0),))
    xy = np.stack(np.meshgrid(np.linspace(-2.9, 2.9, 117), np.linspace(-2.4, 2.4, 97)), axis=-1).reshape(-1, 2) + 1e-3
    dark = received(bank, xy)[:, 0] == 0
    # Project the segment from each point to the light against the box by slabs.
    way = np.concatenate([-xy, np.full((len(xy), 1), 2.0)], axis=1)
    start = np.concatenate([xy, np.zeros((len(xy), 1))], axis=1)

    def shaded(grow):
        with np.errstate(divide="ignore", invalid="ignore"):
            low = (np.array([0.6, 0.4, 0]) - grow - start) / way
            high = (np.array([1.0, 0.8, 1]) + grow - start) / way
        first, last = np.minimum(low, high).max(axis=1), np.maximum(low, high).min(axis=1)
        return np.maximum(first, 0) <= last

    sure = shaded(0.002) == shaded(-0.002)
    assert sure.mean() > 0.97
    assert dark.sum() > 300
    np.testing.assert_array_equal(dark[sure], shaded(0.0)[sure])
    moved = bank.physics.body_pos[0].at[0].set(jnp.array([-1.0, -0.6, 0.5]))
    there = received(bank, xy, body_pos=moved)[:, 0] == 0
    assert not (there & dark).any(), "the shadow moves with the box"
    assert there.sum() > 300


def test_a_lamp_takes_its_light_along_and_does_not_shade_it():
    """A light in the middle of a closed movable box."""
    lamp = Furniture((1.0, 0.5), (0.3, 0.3, 1.0), mass=5.0)
    house = shoebox(furniture=(lamp,))
    bank = lit_bank({"pos": (0, 0, 0.5), "instance": 1}, house=house)

    def expected(x, y, z):
        offset = np.concatenate([XY - [x, y], np.full((len(XY), 1), -z)], axis=1)
        return z / np.linalg.norm(offset, axis=1) ** 3

    np.testing.assert_allclose(received(bank)[:, 0], expected(1.0, 0.5, 0.5), rtol=1e-4)
    moved = bank.physics.body_pos[0].at[0].set(jnp.array([-1.5, 0.2, 0.9]))
    np.testing.assert_allclose(received(bank, body_pos=moved)[:, 0], expected(-1.5, 0.2, 0.9), rtol=1e-4)


@pytest.mark.parametrize("count", [1, 3, 40])
def test_the_most_important_lights_are_chosen(rng, count):
    rows = [
        {
            "pos": rng.uniform([-2, -2, 1], [2, 2, 2.9]),
            "intensity": (rng.uniform(0.1, 3),) * 3,
            "room": int(i % 3 == 0) - 1,
        }
        for i in range(20)
    ]
    bank = lit_bank(*rows)
    placed = lights.place_lights(scene_of(bank), NIGHT.sky)
    keys = np.asarray(jax.jit(lambda p: lights.select_lights(placed, p, count))(floor_points(XY))).T
    pos, power = np.array([r["pos"] for r in rows]), np.array([r["intensity"][0] for r in rows])
    offset = np.concatenate([XY, np.zeros((len(XY), 1))], axis=1)[:, None] - pos[None]
    strength = power * pos[:, 2] / np.linalg.norm(offset, axis=-1) ** 3
    strength = strength * np.where(np.array([r["room"] for r in rows]) == 0, 1, 0.1)
    best = np.sort(strength, axis=1)[:, ::-1][:, :count]
    chosen = keys & 1023
    real = keys >> 10 > 0
    assert real.sum(axis=1).tolist() == [min(count, 20)] * len(XY)
    found = np.take_along_axis(strength, np.where(real, chosen, 0), axis=1)[:, : min(count, 20)]
    np.testing.assert_allclose(found, best[:, : min(count, 20)], rtol=2e-4)


def test_the_sun_lights_what_sees_it_alone():
    bank = lit_bank({})
    sun = 10.0, 0.0, 30.0  # irradiance, azimuth, elevation
    outside = floor_points(XY + np.array([20.0, 0.0]))
    outside = outside.replace(pos=outside.pos.replace(z=jnp.full(len(XY), 5.0)))
    with jax.numpy_dtype_promotion("strict"), jax.numpy_rank_promotion("raise"):
        spread = jnp.zeros((len(XY), 2), jnp.float32)
        got = jax.jit(lambda p: lights.sun_light(scene_of(bank), p, spread, *sun).diffuse.pack())
        np.testing.assert_allclose(got(outside), np.outer(np.full(len(XY), 5.0), lights.SUN_COLOR), rtol=1e-5)
        assert (np.asarray(got(floor_points(XY))) == 0).all(), "the room is closed"
        # West of the house at half the roof's height, its shadow is 5.2 m long.
        near = floor_points(np.array([[-3.2, 0.0], [-20.0, 0.0]]))
        got = jax.jit(lambda p: lights.sun_light(scene_of(bank), p, spread[:2], *sun).diffuse.pack())
        np.testing.assert_array_equal(np.asarray(got(near))[:, 0] > 0, [False, True])


def test_no_lights_give_no_light():
    bank = HouseBank.from_compiled([shoebox()])
    assert (received(bank) == 0).all()
    assert table().pos.shape[0] == 0
