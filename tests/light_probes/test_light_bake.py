"""Baked light against closed forms: an integrating box, dark rooms, sums of lamps, and equal bits."""

from dataclasses import fields, replace

import jax.numpy as jnp
import numpy as np
import pytest
from handmade import shoebox, two_rooms
from lit_scenes import table

from home_mjx.bank.bank import HouseBank
from home_mjx.bank.records.lights import NUM_GROUPS, OTHER_LAMPS, OWN_LAMPS, SUNS
from home_mjx.core.color import encode_srgb
from home_mjx.light_probes import ProbeOptions, solve
from home_mjx.light_probes.field import pack_colors, stack_fields
from home_mjx.raycast_render.lighting.probes import Daylight, mix_groups, probe_irradiance, unpack_colors
from home_mjx.raycast_render.scene.vec import Vec

FEW = ProbeOptions(spacing=0.7, rays=64)
NIGHT = Daylight(sky=0.0, horizon=Vec(1.0, 1.0, 1.0), sun=Vec(0.0, 0.0, 0.0), azimuth=0.0)


def grey(house, reflectance, *lamps):
    """A house whose surfaces all have one reflectance, with lamps."""
    rows = replace(house.materials, albedo=house.materials.albedo.copy(), texture=("",) * len(house.materials.mask))
    rows.albedo[:, :3] = encode_srgb(np.full(3, reflectance))
    return replace(house, materials=rows, lights=table(*lamps, rooms=len(house.rooms.type)))


def bake(house, options=FEW):
    return solve.solve_house(HouseBank.from_compiled([house]), 0, house, options)


def unpacked(record):
    """Irradiance of a record (probes, groups, 6, 3)."""
    return np.asarray(unpack_colors(jnp.asarray(record.light)))


def face_points(size, count=9):
    """Points of the six inner faces of a box around the origin, their normals, and the areas that they stand for."""
    low, high = np.array([-size[0] / 2, -size[1] / 2, 0]), np.array([size[0] / 2, size[1] / 2, size[2]])
    share = (np.arange(count) + 0.5) / count
    pos, normal, area = [], [], []
    for axis in range(3):
        others = [a for a in range(3) if a != axis]
        for side in (0, 1):
            plan = np.stack(np.meshgrid(share, share), -1).reshape(-1, 2)
            p = np.empty((len(plan), 3))
            p[:, others] = low[others] + plan * (high - low)[others]
            p[:, axis] = (low, high)[side][axis]
            pos.append(p)
            normal.append(np.tile(np.eye(3)[axis] * (1 - 2 * side), (len(p), 1)))
            area.append(np.full(len(p), np.prod((high - low)[others]) / len(p)))
    return np.concatenate(pos), np.concatenate(normal), np.concatenate(area)


def received(house, record, pos, normal, room=0):
    """Irradiance at points by the probes, at night."""
    probes = stack_fields([record])
    mixed = mix_groups(probes, jnp.int32(0), None, NIGHT)
    at, facing = (Vec.unpack(jnp.asarray(x, jnp.float32)) for x in (pos, normal))
    return np.asarray(probe_irradiance(probes, mixed, jnp.int32(0), at, facing, jnp.full(len(pos), room)).pack())


@pytest.mark.parametrize("reflectance", [0.5, 0.8])
def test_a_closed_box_reflects_the_geometric_series(reflectance):
    """All flux arrives, and its share `reflectance` again and again: the mean of the rest is F / A p / (1 - p)."""
    size = (4.0, 3.0, 2.5)
    house = grey(shoebox(size), reflectance, {"pos": (0.3, 0.2, 1.2), "intensity": (1.0, 0.5, 0.0)})
    pos, normal, area = face_points(size)
    found = np.average(received(house, bake(house), pos, normal), axis=0, weights=area)
    series = reflectance / (1 - reflectance) * 4 * np.pi / area.sum()
    np.testing.assert_allclose(found / series, [1.0, 0.5, 0.0], rtol=0.02)


def test_a_closed_box_without_lamps_is_black():
    """No ray leaves it: neither lamps, nor sky, nor suns have light in it."""
    assert (unpacked(bake(grey(shoebox(), 0.7))) == 0).all()


def test_no_light_passes_a_wall():
    """Room 1 is dark while room 0 is lit, also at the wall between them."""
    house = grey(two_rooms(), 0.7, {"pos": (-2.0, 0.0, 2.0), "room": 0})
    record, normal = bake(house), np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    near = received(house, record, np.array([[0.05, 0.0, 1.5], [0.1, 0.0, 0.0]]), normal, room=1)
    lit = received(house, record, np.array([[-4.05, 0.0, 1.5], [-0.1, 0.0, 0.0]]), normal, room=0)
    assert (near == 0).all()
    assert lit.min() > 0.1
    assert (unpacked(record)[record.room == 1, OWN_LAMPS : OTHER_LAMPS + 1] == 0).all()


def test_lights_add():
    """Four lamps together give the sum of each alone; two of them are in the probes with their direct light."""
    places = [(-2.0, -1.0, 2.0), (-1.0, 1.5, 1.0), (1.5, 1.0, 2.5), (2.0, -2.0, 0.5)]
    rows = [{"pos": place, "intensity": np.full(3, 1.0 + i)} for i, place in enumerate(places)]
    pos, normal, _ = face_points((6.0, 5.0, 3.0), 4)
    whole = grey(shoebox(), 0.6, *rows)
    keys = bake(whole).keys[0]
    total, parts = received(whole, bake(whole), pos, normal), 0.0
    for i in range(4):
        dark = [row | {"intensity": np.where(i == k, row["intensity"], 0.0)} for k, row in enumerate(rows)]
        one = grey(shoebox(), 0.6, *dark)
        if i in keys:
            parts = parts + received(one, bake(one), pos, normal)
    alone = [row | {"intensity": row["intensity"] * (k in keys)} for k, row in enumerate(rows)]
    both = grey(shoebox(), 0.6, *alone)
    np.testing.assert_allclose(received(both, bake(both), pos, normal), parts, rtol=0.01, atol=1e-3)
    assert (total > parts).all()


def test_records_have_equal_bits_for_any_number_of_threads(monkeypatch):
    house = grey(shoebox(), 0.6, {"pos": (1.0, 0.0, 2.0)})
    first = bake(house)
    monkeypatch.setattr(solve, "map_threads", lambda function, items: [function(item) for item in items])
    second = bake(house)
    for field in fields(first):
        assert getattr(first, field.name).tobytes() == getattr(second, field.name).tobytes(), field.name
    assert first.light.shape[1:] == (NUM_GROUPS, 6)
    assert (unpacked(first)[:, SUNS:] == 0).all()


def test_probes_below_a_surface_do_not_darken_it():
    """Where the lower half of a room is dark, what faces up between both is bright, and what faces down dark."""
    house = grey(shoebox((4.0, 3.0, 2.5)), 0.5, {"pos": (0.3, 0.2, 1.2)})
    record = bake(house)
    low, step, count = record.origin[0, 2], record.step[0, 2], record.count[0, 2]
    layer = np.arange(len(record.light)) % count
    bright = np.zeros((len(layer), NUM_GROUPS, 6, 3))
    bright[layer > 1, OWN_LAMPS] = 1.0
    halved = replace(record, light=pack_colors(bright))
    pos = np.tile([0.2, 0.3, low + 1.5 * step], (2, 1))
    up, down = received(house, halved, pos, np.array([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]))[:, 0]
    assert up > 0.95
    assert down < 0.05
