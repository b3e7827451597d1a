"""Texels against closed forms, and their lookup against positions that a linear function marks."""

from dataclasses import fields, replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from handmade import shoebox, two_rooms
from lit_scenes import scene_of
from test_light_bake import FEW, NIGHT, bake, grey

from home_mjx.bank.bank import HouseBank
from home_mjx.bank.records.lights import KEY_LAMPS, NUM_GROUPS, OTHER_LAMPS
from home_mjx.light_probes import solve
from home_mjx.light_probes.charts import place_charts
from home_mjx.light_probes.field import pack_colors, stack_fields
from home_mjx.light_probes.lattice import place_probes
from home_mjx.raycast_render import LitShader
from home_mjx.raycast_render.casting.cast import cast
from home_mjx.raycast_render.lighting.lights import ShadingPoint
from home_mjx.raycast_render.lighting.probes import unpack_colors
from home_mjx.raycast_render.lighting.texels import find_chart, mix_texels, texel_irradiance
from home_mjx.raycast_render.scene.appearance import AppearanceOverrides
from home_mjx.raycast_render.scene.surface import face_normals
from home_mjx.raycast_render.scene.vec import Vec
from home_mjx.raycast_render.shaders.baked import BakedShader
from home_mjx.schema.semantic import Semantic

LAMP = np.array([0.3, 0.2, 1.2])


def seen(scene, count=400):
    """Hits of random rays from the middle of a room: hits, positions and normals."""
    way = np.random.default_rng(0).normal(size=(count, 3)).astype(np.float32)
    way, origin = jnp.asarray(way / np.linalg.norm(way, axis=1, keepdims=True)), jnp.asarray([[0.1, 0.0, 1.4]])
    hit = cast(scene, jnp.broadcast_to(origin, way.shape), way)
    return hit, origin + way * hit.t[:, None], face_normals(scene, way, hit)


def baked_scene(house, record):
    """The scene of a house with its baked light."""
    bank = HouseBank.from_compiled([house])
    return scene_of(bank.replace(bakes={"light_probes": stack_fields([record])}))


def incident(shader, scene, hit, pos, normal):
    """Irradiance at hits by a shader."""
    up, ones = Vec.unpack(normal), jnp.ones(len(pos))
    point = ShadingPoint(Vec.unpack(pos), up, up, up, ones, hit.instance, jnp.zeros(len(pos), jnp.int32))
    return np.asarray(jax.jit(lambda s: shader.incident(s, hit, point, None)[0].pack())(scene))


@pytest.fixture(scope="module")
def box():
    """A closed grey box with one lamp, its record and its scene."""
    house = grey(shoebox((4.0, 3.0, 2.5)), 0.6, {"pos": LAMP, "intensity": (1.0, 0.5, 0.0)})
    record = bake(house)
    return house, record, baked_scene(house, record)


def test_texels_have_the_light_of_the_lamp_and_its_reflections(box):
    """The lamp is 5 cm wide, 1 m away at least; reflections have the mean F / A p / (1 - p) of the geometric series."""
    hit, pos, normal = seen(box[2])
    probes = box[2].bank.bakes["light_probes"]
    chart = find_chart(box[2], probes, hit)
    assert (np.asarray(chart) >= 0).all()
    place = jnp.int32(0), Vec.unpack(pos), chart
    with_lamp, without = (
        np.asarray(texel_irradiance(probes, mix_texels(probes, place[0], None, NIGHT, lamps), *place).pack())
        for lamps in (True, False)
    )
    way = LAMP - np.asarray(pos)
    exact = np.sum(way * np.asarray(normal), axis=1) / np.linalg.norm(way, axis=1) ** 3
    off = (with_lamp - without)[:, 0] / exact - 1
    assert np.median(np.abs(off)) < 0.02
    assert np.quantile(np.abs(off), 0.95) < 0.08
    np.testing.assert_allclose(with_lamp[:, 1], 0.5 * with_lamp[:, 0], rtol=0.01)
    area = 2 * (4 * 3 + 4 * 2.5 + 3 * 2.5)
    texels = np.asarray(unpack_colors(probes.texel[0, : len(box[1].texel)]))[:, :NUM_GROUPS].sum(axis=1)[:, 0]
    count, frame = box[1].chart_count.astype(int), box[1].chart_frame
    cell = np.prod((count - 1) / count, axis=1) / np.linalg.norm(np.cross(frame[:, 1], frame[:, 2]), axis=1)
    weight = np.repeat(cell, np.prod(count, axis=1))
    series = 0.6 / 0.4 * 4 * np.pi / area
    assert np.average(texels, weights=weight) == pytest.approx(series, rel=0.02)


def test_the_lookup_interpolates_between_texels(box):
    """A function that is linear in space has its value at every hit but for the last 2 cm to edges."""
    house, record, _ = box
    texel = np.zeros((*record.texel.shape, 3))
    for first, count, frame in zip(record.chart_first, record.chart_count, record.chart_frame, strict=True):
        i, j = np.meshgrid(*(np.arange(n) for n in count), indexing="ij")
        axes = [v / (v @ v) for v in frame[1:]]
        pos = frame[0] + i[..., None] * axes[0] + j[..., None] * axes[1]
        texel[first : first + i.size, KEY_LAMPS, 0] = (5 + pos @ [0.5, 0.3, 0.2]).ravel()
    marked = baked_scene(house, replace(record, texel=pack_colors(texel)))
    hit, pos, _ = seen(marked)
    probes, house_index = marked.bank.bakes["light_probes"], jnp.int32(0)
    mixed = mix_texels(probes, house_index, None, NIGHT, True)
    found = texel_irradiance(probes, mixed, house_index, Vec.unpack(pos), find_chart(marked, probes, hit)).x
    np.testing.assert_allclose(found, 5 + np.asarray(pos) @ [0.5, 0.3, 0.2], atol=0.02)


def test_baked_equals_lit_where_nothing_moves(box):
    """Rays and texels give the same light; backs of triangles take probes and rays."""
    hit, pos, normal = seen(box[2])
    night = {"sun": 0.0, "sky": 0.0}
    lit, baked = (incident(shader(**night), box[2], hit, pos, normal) for shader in (LitShader, BakedShader))
    assert np.quantile(np.abs(baked[:, 0] / lit[:, 0] - 1), 0.95) < 0.08
    behind = hit.replace(front=jnp.zeros_like(hit.front))
    assert (np.asarray(find_chart(box[2], box[2].bank.bakes["light_probes"], behind)) == -1).all()


def test_no_light_passes_a_wall_to_texels():
    """Every texel of the dark room is black, and those of the other room are not."""
    record = bake(grey(two_rooms(), 0.7, {"pos": (-2.0, 0.0, 2.0), "room": 0}))
    lamps = np.asarray(unpack_colors(jnp.asarray(record.texel)))[:, [0, OTHER_LAMPS, KEY_LAMPS], 0].sum(axis=1)
    assert (lamps[record.texel_room == 1] == 0).all()
    assert np.median(lamps[record.texel_room == 0]) > 0.1


def test_without_texels_faces_take_probes():
    house = grey(shoebox(), 0.6, {"pos": LAMP})
    record = bake(house, replace(FEW, texels=0.0))
    scene = baked_scene(house, record)
    hit, pos, normal = seen(scene, 50)
    assert scene.bank.bakes["light_probes"].texel.shape[1] == 0
    assert (np.asarray(find_chart(scene, scene.bank.bakes["light_probes"], hit)) == -1).all()
    assert (incident(LitShader(sun=0.0, sky=0.0), scene, hit, pos, normal)[:, 0] > 0).all()


def test_a_house_without_rooms_has_neither_probes_nor_texels():
    house = grey(shoebox(), 0.6)
    none = type(house.rooms)(**{f.name: getattr(house.rooms, f.name)[:0] for f in fields(house.rooms)})
    semantics = house.semantics.copy()
    semantics[:, Semantic.ROOM] = -1
    record = solve.solve_house(
        HouseBank.from_compiled([house]), 0, replace(house, rooms=none, semantics=semantics), FEW
    )
    assert (len(record.light), len(record.texel), (record.chart_start >= 0).sum()) == (0, 0, 0)


def test_lamps_of_an_episode_scale_texels(box):
    """Factors of lamps by room + 1, as of domain randomisation; at night all light is theirs."""
    hit, pos, _ = seen(box[2], 50)
    probes, house = box[2].bank.bakes["light_probes"], jnp.int32(0)
    chart = find_chart(box[2], probes, hit)
    full, dim = (
        texel_irradiance(probes, mix_texels(probes, house, look, NIGHT, True), house, Vec.unpack(pos), chart).x
        for look in (None, AppearanceOverrides(jnp.uint32(0), lamps=jnp.array([1.0, 0.25])))
    )
    np.testing.assert_allclose(dim, 0.25 * full, rtol=1e-5)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_texels_of_mirrored_objects_are_in_front_of_them(side):
    """Corners of a mirrored pose turn the other way in the world; faces of a room around the middle still face it."""
    house = grey(shoebox((4.0, 4.0, 2.5)), 0.6)
    pose = house.instances.pose.copy()
    pose[0, 0, 0] = side
    turned = replace(house, instances=replace(house.instances, pose=pose))
    charts = place_charts(turned, place_probes(house.rooms, 1.0), 2.0)
    assert len(charts.pos) > 0
    assert (np.sum(charts.normal * (charts.pos - [0.0, 0.0, 1.25]), axis=1) < -1.0).all()
