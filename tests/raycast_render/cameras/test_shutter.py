"""Rolling shutters, motion blur and vignettes: rows are those of still cameras at their instants."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from handmade import Furniture, shoebox
from lit_scenes import scene_of
from scipy.spatial.transform import Rotation, Slerp

from home_mjx.bank.bank import HouseBank
from home_mjx.core.color import decode_srgb
from home_mjx.core.transforms import camera_quat
from home_mjx.errors import ConfigError
from home_mjx.raycast_render.cameras.camera import Camera, Lens, camera_rays
from home_mjx.raycast_render.cameras.sampling import sample_point
from home_mjx.raycast_render.cameras.shutter import interpolate_quats, moving_rays, row_times
from home_mjx.raycast_render.images.render import render

SIZE = 12
BEFORE, AFTER = ((0.0, -1.5, 1.4), 1.3, 0.0), ((0.3, -1.2, 1.5), 1.9, 0.1)


def camera_at(pos, yaw, pitch):
    return Camera(jnp.array(pos), camera_quat(jnp.float32(yaw), jnp.float32(pitch)), jnp.float32(1.2))


@pytest.fixture(scope="module")
def bank():
    post = Furniture((0.3, 1.0), (0.4, 0.4, 2.0), color=(0.9, 0.1, 0.1))
    return HouseBank.from_compiled([shoebox(furniture=(post,))])


def test_turns_are_those_of_scipy(rng):
    quats = rng.normal(size=(2, 4))
    quats /= np.linalg.norm(quats, axis=1, keepdims=True)
    shares = np.linspace(0, 1, 7)
    expected = Slerp([0, 1], Rotation.from_quat(quats, scalar_first=True))(shares).as_matrix()
    found = jax.vmap(lambda t: interpolate_quats(*jnp.asarray(quats, jnp.float32), t))(jnp.asarray(shares, jnp.float32))
    np.testing.assert_allclose(
        Rotation.from_quat(np.asarray(found), scalar_first=True).as_matrix(), expected, atol=1e-5
    )
    same = interpolate_quats(jnp.asarray(quats[0], jnp.float32), jnp.asarray(-quats[0], jnp.float32), jnp.float32(0.3))
    np.testing.assert_allclose(abs(same @ quats[0]), 1, atol=1e-6)


@pytest.mark.parametrize("model", ["pinhole", "fisheye", "orthographic", "cube"])
def test_rays_of_a_row_are_those_of_a_camera_at_its_instant(model):
    before, after = camera_at(*BEFORE), camera_at(*AFTER)
    lens = Lens(5, 5, model, samples=4, shutter=0.3, readout=0.6)
    for sample in (0, 2):
        found = moving_rays(before, after, lens, sample)
        for row, time in enumerate(row_times(lens, sample)):
            pos = before.pos + (after.pos - before.pos) * time
            still = Camera(pos, interpolate_quats(before.quat, after.quat, time), after.fovy)
            for moving, fixed in zip(found, camera_rays(still, lens, sample_point(sample)), strict=True):
                np.testing.assert_allclose(moving[..., row, :, :], fixed[..., row, :, :], atol=1e-5)


def test_a_rolling_shutter_changes_colours_alone_and_ends_at_the_camera(bank):
    before, after, kinds = camera_at(*BEFORE), camera_at(*AFTER), ("rgb", "depth", "instance")
    scene = scene_of(bank)

    @jax.jit
    def shots(before, after):
        still = render(scene, after, Lens(SIZE, SIZE), kinds=kinds)
        rolling = render(scene, after, Lens(SIZE, SIZE, readout=1.0), kinds=kinds, before=before)
        return still, rolling, render(scene, before, Lens(SIZE, SIZE), kinds=("rgb",))

    still, rolling, first = shots(before, after)
    for kind in ("depth", "instance"):
        np.testing.assert_array_equal(rolling[kind], still[kind])
    np.testing.assert_array_equal(rolling["rgb"][-1], still["rgb"][-1])
    np.testing.assert_array_equal(rolling["rgb"][0], first["rgb"][0])
    assert (rolling["rgb"] != still["rgb"]).any()
    at_rest = jax.jit(lambda c: render(scene, c, Lens(SIZE, SIZE, readout=1.0), kinds=kinds, before=c))(after)
    jax.tree.map(lambda a, b: np.testing.assert_allclose(a, b, atol=1), at_rest, still)


def test_motion_blur_is_the_mean_of_still_pictures(bank):
    before, after, count = camera_at(*BEFORE), camera_at(*AFTER), 6
    lens, scene = Lens(SIZE, SIZE, samples=count, shutter=0.5), scene_of(bank)
    blurred = jax.jit(lambda a, b: render(scene, b, lens, kinds=("radiance",), before=a)["radiance"])(before, after)
    sharp = jax.jit(lambda c: render(scene, c, Lens(SIZE, SIZE), kinds=("radiance",))["radiance"])
    times = 0.5 + 0.5 * ((0.5 + 0.6180339887498949 * np.arange(count)) % 1)
    turns = [interpolate_quats(before.quat, after.quat, jnp.float32(t)) for t in times]
    still = [
        sharp(Camera(before.pos + (after.pos - before.pos) * t, q, after.fovy))
        for t, q in zip(times, turns, strict=True)
    ]
    # Samples of the still pictures are in the middle of pixels; those of the blurred one are all over them.
    assert abs(np.mean(still, axis=0) - blurred).mean() < 0.3 * abs(still[0] - still[1]).mean()
    assert np.std(blurred[SIZE // 2, :, 0]) < np.std(sharp(after)[SIZE // 2, :, 0])


def test_a_bad_camera_before_is_invalid_and_shows_nothing(bank):
    lens, scene = Lens(8, 8, readout=0.5), scene_of(bank)
    before = camera_at(*BEFORE)
    look = jax.jit(lambda a, b: render(scene, b, lens, kinds=("rgb", "valid"), before=a))
    for bad in (before.replace(pos=before.pos * jnp.nan), before.replace(quat=2 * before.quat)):
        images = look(bad, camera_at(*AFTER))
        assert not images["valid"]
        assert (images["rgb"] == images["rgb"][0, 0]).all(), "all rays miss"


def test_options_that_are_off_leave_the_program_as_it_is(bank):
    scene = scene_of(bank)

    def text(lens, **options):
        return (
            jax.jit(lambda a, b: render(scene, b, lens, before=a if options else None))
            .lower(camera_at(*BEFORE), camera_at(*AFTER))
            .as_text()
        )

    assert text(Lens(8, 8)) == text(Lens(8, 8), before=True)
    assert text(Lens(8, 8)) != text(Lens(8, 8, vignette=1.0))
    assert text(Lens(8, 8)) != text(Lens(8, 8, readout=1.0), before=True)


def test_a_vignette_is_the_fourth_power_of_the_cosine(bank):
    camera, scene = camera_at(*BEFORE), scene_of(bank)
    look = jax.jit(lambda c: [render(scene, c, Lens(9, 9, vignette=v), kinds=("rgb", "radiance")) for v in (0.0, 1.0)])
    plain, dark = look(camera)
    np.testing.assert_array_equal(plain["radiance"], dark["radiance"])
    place = (np.arange(9) + 0.5 - 4.5) / 4.5 * np.tan(0.6)
    cosine = 1 / np.sqrt(1 + place[:, None] ** 2 + place[None] ** 2)
    a, b = (decode_srgb(np.asarray(x["rgb"]) / 255) for x in (plain, dark))
    np.testing.assert_allclose(b, a * cosine[..., None] ** 4, atol=0.006)


@pytest.mark.parametrize(
    ("options", "named"),
    [
        ({"vignette": -1.0}, "vignette"),
        ({"vignette": 1.0, "model": "panorama"}, "vignette"),
        ({"shutter": 0.5}, "samples"),
        ({"shutter": 0.7, "readout": 0.5, "samples": 2}, "readout"),
    ],
)
def test_impossible_exposures_are_refused(options, named):
    with pytest.raises(ConfigError, match=named):
        Lens(8, 8, **options)
