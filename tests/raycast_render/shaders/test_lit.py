"""The lit preset as a whole: panes, mirrors, smooth normals, filtered textures, and what it does to images."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest
import trimesh
from handmade import Furniture, shoebox
from lit_scenes import NIGHT, lit_bank, scene_of

from home_mjx.bank.bank import HouseBank
from home_mjx.bank.packing.texture_layers import mip_levels
from home_mjx.errors import ConfigError
from home_mjx.geometry.meshes import build_instance_tree, make_model
from home_mjx.raycast_render.cameras.camera import Camera, Lens, camera_rays, pixel_footprint
from home_mjx.raycast_render.casting.cast import cast
from home_mjx.raycast_render.images.render import render
from home_mjx.raycast_render.images.view import View
from home_mjx.raycast_render.lighting import specular, texture, tone_curves
from home_mjx.raycast_render.scene.scene import make_scene
from home_mjx.raycast_render.scene.vec import Vec
from home_mjx.raycast_render.shaders import lit
from home_mjx.raycast_render.shaders.base import resolve_shader
from home_mjx.raycast_render.shaders.lit import LitShader
from home_mjx.schema.lighting import Gloss

AHEAD = jnp.array([0.5**0.5, 0.5**0.5, 0, 0])  # looks along +y
SIZE = 24
LENS = Lens(SIZE, SIZE)
PANE = Furniture((0.0, 0.5), (3.0, 0.1, 3.0), color=(0.2, 0.8, 0.5))
POST = Furniture((0.6, 1.5), (0.4, 0.4, 3.0), color=(0.9, 0.1, 0.1))


def camera_at(x=0.0, y=-1.5, z=1.5, quat=AHEAD, fovy=1.2):
    return Camera(jnp.array([x, y, z], jnp.float32), jnp.asarray(quat, jnp.float32), jnp.float32(fovy))


def seen(bank, camera, options=NIGHT, lens=LENS):
    """What the camera's rays end on, under JAX's strictest rules."""

    def look(scene, camera):
        view = View(scene, camera, lens, options, -1)
        growth = pixel_footprint(camera, lens)[1]
        end = specular.trace_specular(
            scene, specular.start_path(view.center_rays), growth, options.max_specular_depth, -1
        )
        return end.replace(**{name: getattr(end, name).pack() for name in ("origin", "direction", "throughput")})

    with jax.numpy_dtype_promotion("strict"), jax.numpy_rank_promotion("raise"):
        return jax.tree.map(np.asarray, jax.jit(look)(scene_of(bank), camera))


def glazed(opacity=0.5, furniture=(PANE, POST)):
    """A house whose first piece of furniture is a pane of glass."""
    house = shoebox(furniture=furniture)
    albedo, mask = house.materials.albedo.copy(), house.materials.mask.copy()
    albedo[6, 3], mask[6] = opacity, 5
    kind = tuple("glass" if i == 6 else k for i, k in enumerate(house.materials.kind))
    return replace(house, materials=replace(house.materials, albedo=albedo, mask=mask, kind=kind))


def mirrored_house(furniture=(PANE, POST)):
    """The same with a mirror instead."""
    house = shoebox(furniture=furniture)
    gloss = Gloss.matt(len(house.materials.mask))
    gloss.mirror[6] = True
    return replace(house, gloss=gloss)


def test_glass_shows_what_is_behind_it_tinted():
    with_pane, without = HouseBank.from_compiled([glazed()]), HouseBank.from_compiled([shoebox(furniture=(POST,))])
    camera = camera_at(y=-2.4)
    there, bare = seen(with_pane, camera), seen(without, camera)
    first = render(scene_of(with_pane), camera, Lens(SIZE, SIZE), kinds=("instance",))["instance"]
    pane = np.asarray(first) == 0
    assert 100 < pane.sum() < SIZE * SIZE
    ends, plain = (s.origin + s.hit.t[..., None] * s.direction for s in (there, bare))
    np.testing.assert_allclose(ends, plain, atol=1e-4)
    linear = ((np.array([0.2, 0.8, 0.5]) + 0.055) / 1.055) ** 2.4
    np.testing.assert_allclose(
        there.throughput[pane], np.broadcast_to(1 - 0.5 * (1 - linear), (pane.sum(), 3)), rtol=1e-5
    )
    assert (there.throughput[~pane] == 1).all()
    # The footprint has grown as if there were no pane.
    _, growth = pixel_footprint(camera, Lens(SIZE, SIZE))
    width = there.footprint + growth * there.hit.t
    np.testing.assert_allclose(width, growth * bare.hit.t, rtol=1e-4)


def test_a_mirror_shows_the_mirrored_room():
    """The mirror is the plane y = 0.45: its image is that of a camera behind it that sees the room reflected."""
    behind = Furniture((0.8, -2.0), (0.4, 0.4, 3.0), color=(0.9, 0.1, 0.1))
    bank = HouseBank.from_compiled([mirrored_house((PANE, behind))])
    camera = camera_at()
    there = seen(bank, camera)
    _, direction = (np.asarray(x) for x in camera_rays(camera, Lens(SIZE, SIZE)))
    t = (0.45 + 1.5) / direction[..., 1]
    meets = np.abs(direction[..., 0] * t) < 1.5
    points = np.array([0, -1.5, 1.5]) + t[..., None] * direction
    meets &= (points[..., 2] > 0) & (points[..., 2] < 3)
    flipped = direction * [1, -1, 1]
    np.testing.assert_allclose(there.direction[meets], flipped[meets], atol=1e-5)
    # Post 1 stands 1.45 m before the mirror; brute force: does the reflected ray meet its box?
    with np.errstate(divide="ignore", invalid="ignore"):
        near = (np.array([0.6, -2.2, 0]) - points) / flipped
        far = (np.array([1.0, -1.8, 3]) - points) / flipped
    first, last = np.minimum(near, far).max(axis=-1), np.maximum(near, far).min(axis=-1)
    expected = (first <= last) & meets
    assert expected.sum() > 20
    np.testing.assert_array_equal((there.hit.instance == 2) & meets, expected)
    linear = ((np.array([0.2, 0.8, 0.5]) + 0.055) / 1.055) ** 2.4
    np.testing.assert_allclose(there.throughput[meets], np.broadcast_to(linear, (meets.sum(), 3)), rtol=1e-4)


def test_a_mirror_shows_the_agent_that_looks_into_it():
    bank = HouseBank.from_compiled([mirrored_house((replace(PANE, color=(1.0, 1.0, 1.0)),))])
    number = bank.spec.num_instances
    agent = jnp.array([[0.0, -1.5, 0.8]]), jnp.array([[0.5**0.5, 0.0, 0.0, 0.5**0.5]])
    scene = make_scene(bank, jnp.int32(0), bank.physics.body_pos[0], bank.physics.body_quat[0], *agent)
    images = {}
    for bounces in (0, 1):
        options = replace(LitShader(), max_specular_depth=bounces, ambient=1.0, sun=0.0)
        dark = bank.replace(lights=bank.lights.replace(ambient=jnp.ones_like(bank.lights.ambient)))
        look = jax.jit(
            lambda s, c, o=options: render(s, c, Lens(SIZE, SIZE), kinds=("rgb", "instance"), shader=o, exclude=number)
        )
        images[bounces] = jax.tree.map(np.asarray, look(scene.replace(bank=dark), camera_at(x=0.1)))
    assert not (images[0]["instance"] == number).any()
    blue = images[1]["rgb"][12:, 10:14].astype(int)
    plain = images[0]["rgb"][12:, 10:14].astype(int)
    assert (blue[..., 2] - blue[..., 0]).max() > (plain[..., 2] - plain[..., 0]).max() + 10, "the agent's body is blue"


@pytest.mark.parametrize("mirror", [False, True])
def test_a_ball_is_shaded_as_a_ball(mirror):
    """An icosphere of 320 faces, also mirrored and stretched: normals within the error of interpolation."""
    ball = trimesh.creation.icosphere(subdivisions=2, radius=0.5)
    house = shoebox(furniture=(Furniture((0.0, 1.0)),))
    model = make_model("ball", np.asarray(ball.triangles))
    pose = house.instances.pose.copy()
    scale = np.diag([-1.0 if mirror else 1.0, 1.5, 1.0])
    pose[1, :, :3], pose[1, :, 3] = scale, (0, 1.0, 1.5)
    instances = replace(house.instances, model=(house.instances.model[0], model.key), pose=pose)
    models = {**house.models, model.key: model}
    house = replace(house, instances=instances, models=models, top_bvh=build_instance_tree(instances, models))
    bank = HouseBank.from_compiled([house])
    rng = np.random.default_rng(0)
    start = np.array([0, -1.0, 1.5], np.float32)
    aim = rng.uniform([-0.3, 0.0, 1.2], [0.3, 0.0, 1.8], (200, 3)).astype(np.float32) - start
    hit = cast(scene_of(bank), jnp.broadcast_to(start, aim.shape), jnp.asarray(aim))
    hits = np.asarray(hit.instance) == 1
    assert hits.sum() > 50
    with jax.numpy_dtype_promotion("strict"), jax.numpy_rank_promotion("raise"):
        none, way = Vec.unpack(jnp.zeros_like(aim)), Vec.unpack(jnp.asarray(aim))
        corner = lit._hit_frame(scene_of(bank), specular.PathState(none, way, hit, none.x, none))
        corner = jax.tree.map(lambda v: v.pack(), corner, is_leaf=lambda v: isinstance(v, Vec))
    points = start + np.asarray(hit.t)[:, None] * aim
    outward = (points - [0, 1.0, 1.5]) / np.diag(scale) ** 2
    outward /= np.linalg.norm(outward, axis=1, keepdims=True)
    smooth = np.sum(np.asarray(corner.shading) * outward, axis=1)[hits]
    unit = np.asarray(corner.area) / np.linalg.norm(corner.area, axis=1, keepdims=True)
    rough = np.sum(unit * outward, axis=1)[hits]
    assert smooth.min() > 0.995
    assert np.arccos(np.clip(smooth, -1, 1)).mean() < 0.4 * np.arccos(np.clip(rough, -1, 1)).mean()


def test_far_textures_are_filtered():
    """A fine checkerboard on the floor becomes grey far away, and stays black and white close by."""
    board = np.full((64, 64, 4), 255, np.uint8)
    board[(np.add.outer(np.arange(64), np.arange(64)) % 2) == 0, :3] = 0
    bank = lit_bank({})
    corner = np.asarray(bank.geometry.triangle)
    rows = bank.materials.texture.shape[0]
    bank = bank.replace(
        geometry=bank.geometry.replace(triangle_uv=jnp.asarray(corner[..., :2] * 0.5)),
        materials=bank.materials.replace(
            textures=jnp.asarray(mip_levels(board)[None].view(np.uint32)[..., 0]),
            texture=jnp.zeros(rows, jnp.int32),
            albedo=jnp.ones((rows, 4)),
        ),
    )
    spread = {}
    for height, name in ((0.1, "near"), (2.9, "far")):
        camera = camera_at(0.3, 0.2, height, quat=[1, 0, 0, 0], fovy=1.0)
        lens = Lens(16, 16)
        view = View(scene_of(bank), camera, lens, NIGHT, -1)
        sight = specular.start_path(view.center_rays)
        corner_ = lit._hit_frame(view.scene, sight)
        color = lit._diffuse_reflectance(
            view.scene, sight, corner_, jnp.zeros(lens.shape, jnp.int32), pixel_footprint(camera, lens)[1]
        )
        spread[name] = np.ptp(np.asarray(color.pack()))
    assert spread["near"] > 0.8
    assert spread["far"] < 0.25


def test_an_image_is_what_the_formulas_say():
    """The floor from above under one light: tone-mapped albedo / pi times irradiance, to a byte."""
    bank = lit_bank({"pos": (0.4, 0.2, 2.5), "intensity": (2, 2, 2)})
    lens = Lens(16, 12, "orthographic")
    camera = camera_at(0.0, 0.0, 1.0, quat=[1, 0, 0, 0], fovy=3.0)
    options = replace(NIGHT, exposure=3.0)
    image = np.asarray(
        jax.jit(lambda b: render(scene_of(b), camera, lens, kinds=("rgb",), shader=options)["rgb"])(bank)
    )
    origin, _ = (np.asarray(x) for x in camera_rays(camera, lens))
    offset = origin * [1, 1, 0] - [0.4, 0.2, 2.5]
    irradiance = 2 * 2.5 / np.linalg.norm(offset, axis=-1) ** 3
    floor = np.asarray(bank.materials.albedo)[2 + 4, :3]  # after the agent's two rows and the four walls
    light = floor * irradiance[..., None] / np.pi
    expected = np.asarray(
        texture.encode_srgb(tone_curves.tone_map(Vec.unpack(jnp.asarray(light, jnp.float32)), 3.0).pack())
    )
    assert abs(image.astype(int) - expected.astype(int)).max() <= 1


def test_tone_mapping_keeps_order_and_ends():
    light = jnp.broadcast_to(jnp.linspace(0, 2 * tone_curves.WHITE_LUMINANCE, 100)[:, None], (100, 3))
    shown = np.asarray(tone_curves.tone_map(Vec.unpack(light), 1.0).pack())
    assert shown[0].tolist() == [0, 0, 0]
    assert (np.diff(shown[:, 0]) >= 0).all()
    np.testing.assert_allclose(
        np.asarray(tone_curves.tone_map(Vec.unpack(jnp.full((1, 3), tone_curves.WHITE_LUMINANCE)), 1.0).pack()),
        1,
        rtol=1e-6,
    )


@pytest.mark.slow  # two programs give the same bits only as users compile them
def test_more_samples_smooth_edges_and_leave_other_images_alone():
    bank = HouseBank.from_compiled([shoebox(furniture=(POST,))])
    bank = bank.replace(lights=bank.lights.replace(ambient=jnp.ones_like(bank.lights.ambient)))
    quat = np.array([0.65, 0.7, 0.1, 0.05])
    camera = camera_at(quat=(quat / np.linalg.norm(quat)).tolist())
    kinds = ("rgb", "depth", "instance")

    def look(preset, samples):
        lens = Lens(SIZE, SIZE, samples=samples)
        return jax.jit(lambda b: render(scene_of(b), camera, lens, kinds=kinds, shader=preset))(bank)

    for preset in ("fast", "lit"):
        one, many = look(preset, 1), look(preset, 12)
        for kind in ("depth", "instance"):
            np.testing.assert_array_equal(one[kind], many[kind])
        difference = abs(np.asarray(one["rgb"], int) - np.asarray(many["rgb"], int)).max(axis=-1)
        post = np.asarray(one["instance"]) == 0
        edge = post ^ np.roll(post, 1, axis=1)
        assert difference[edge].mean() > 5 * np.median(difference)


def test_no_lights_at_all_show_what_is_reflected_and_nothing_breaks():
    bank = HouseBank.from_compiled([shoebox()])

    def looker(preset):
        look = jax.jit(lambda b, camera: render(scene_of(b), camera, Lens(8, 8), kinds=("rgb",), shader=preset)["rgb"])
        return lambda camera: np.asarray(look(bank, camera))

    look = looker("lit")
    assert (look(camera_at()) == 0).all(), "a closed room without lights is dark"
    assert (looker(LitShader(num_lights=0))(camera_at()) == 0).all()
    sky = look(camera_at(0.0, 0.0, 10.0, quat=[0.0, 1, 0, 0]))
    assert (sky[..., 2] >= sky[..., 0]).all()
    assert sky.min() > 100


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: resolve_shader("lid"), "Did you mean `lit`"),
        (lambda: LitShader(sky=-1.0), "`sky`"),
        (lambda: LitShader(num_lights=-1), "`num_lights`"),
    ],
)
def test_wrong_presets_are_refused(make, words):
    with pytest.raises(ConfigError, match=words):
        make()
