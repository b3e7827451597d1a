"""`cast` and `occluded` against brute force in float64, both backends, and what their arguments mean."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from soup import (
    BACKENDS,
    CUDA,
    Placed,
    Soup,
    brute_force,
    f32,
    i32,
    in_jit,
    random_rays,
    random_soup,
    random_triangles,
)

from home_mjx.errors import BackendError, ConfigError
from home_mjx.raycast_render.casting.cast import cast, occluded

N = 2000


@pytest.fixture(scope="module")
def case():
    rng = np.random.default_rng(3)
    soup = random_soup(rng)
    scene = soup.scene()  # sorts the instances: before anything asks for their numbers
    return soup, scene, *random_rays(rng, N)


def run(scene, origin, direction, backend, t_min=0.0, t_max=np.inf, exclude=-1, mask=7):
    """Hits of N rays, options always one per ray, so that every test shares one compiled program."""
    options = [np.broadcast_to(x, len(origin)) for x in (t_min, t_max, exclude, mask)]
    args = scene, f32(origin), f32(direction), f32(options[0]), f32(options[1]), i32(options[2]), i32(options[3])
    return in_jit(cast, *args, backend=backend), in_jit(occluded, *args, backend=backend)


def assert_equals_brute_force(soup, scene, origin, direction, backend, **options):
    hit, hidden = run(scene, origin, direction, backend, **options)
    truth = brute_force(soup, origin, direction, **options)
    row, nearest = np.arange(len(origin)), truth.t.argmin(axis=1)
    expected, clear = truth.t[row, nearest], ~truth.doubtful
    assert clear.mean() > 0.9
    found = np.isfinite(expected)
    np.testing.assert_array_equal((hit.instance >= 0)[clear], found[clear])
    np.testing.assert_array_equal(hidden[clear], found[clear])
    sure = clear & found
    _, instance, triangle, _, _ = soup.world_triangles()
    np.testing.assert_array_equal(hit.instance[sure], instance[nearest][sure])
    np.testing.assert_array_equal(hit.triangle[sure], triangle[nearest][sure])
    np.testing.assert_allclose(hit.t[sure], expected[sure], rtol=2e-4, atol=2e-5)
    np.testing.assert_allclose(hit.u[sure], truth.u[row, nearest][sure], atol=3e-3)
    np.testing.assert_allclose(hit.v[sure], truth.v[row, nearest][sure], atol=3e-3)
    # Front is told in the model's frame: mirroring does not turn a model inside out.
    mirrored = np.array([np.linalg.det(p.pose[:, :3]) < 0 for p in soup.placed])[instance[nearest]]
    np.testing.assert_array_equal(hit.front[sure], (truth.front[row, nearest] != mirrored)[sure])
    missed = clear & ~found
    assert np.isinf(hit.t[missed]).all()
    assert (hit.triangle[missed] == -1).all()
    return found.mean()


@pytest.mark.parametrize("backend", BACKENDS)
def test_closest_hits_equal_brute_force(case, backend):
    assert 0.3 < assert_equals_brute_force(*case, backend) < 0.98


@pytest.mark.parametrize("backend", BACKENDS)
def test_range_exclusion_and_mask_of_each_ray(case, backend):
    rng = np.random.default_rng(1)
    options = {
        "t_min": rng.uniform(0, 0.5, N).astype(np.float32),
        "t_max": rng.uniform(0.3, 1.5, N).astype(np.float32),
        "exclude": rng.integers(-1, 8, N),
        "mask": rng.choice([1, 2, 4], N),
    }
    found = assert_equals_brute_force(*case, backend, **options)
    assert 0.1 < found < 0.6


@pytest.mark.parametrize("backend", ["cpu", CUDA])
def test_executors_agree(case, backend):
    _, scene, origin, direction = case
    a, b = (run(scene, origin, direction, name)[0] for name in ("xla", backend))
    same = a.triangle == b.triangle
    assert same.mean() > 0.999
    np.testing.assert_array_equal(a.instance[same], b.instance[same])
    np.testing.assert_allclose(a.t[same & (a.instance >= 0)], b.t[same & (a.instance >= 0)], rtol=1e-5, atol=1e-4)


@pytest.mark.parametrize("backend", BACKENDS)
def test_rays_without_extent_hit_nothing(case, backend):
    _, scene, origin, direction = case
    hit, hidden = run(scene, origin, direction, backend, t_min=1.0, t_max=0.999)
    assert (hit.instance == -1).all()
    assert not hidden.any()
    hit, _ = run(scene, origin, direction, backend, t_min=np.nan)
    assert (hit.instance == -1).all()


@pytest.mark.parametrize("backend", BACKENDS)
def test_ties_go_to_the_lower_instance_and_triangle(rng, backend):
    triangles = np.repeat(random_triangles(rng, 40), 3, axis=0)  # each one three times
    soup = Soup([triangles], [Placed(0, np.eye(3, 4), i, moves=i == 2) for i in range(3)])
    origin, direction = random_rays(rng, N)
    hit, _ = run(soup.scene(), origin * 0.5, direction, backend)
    assert (hit.instance <= 0).all()
    assert (hit.instance == 0).mean() > 0.2
    stored = triangles[soup.order[0]]
    first = {corners.tobytes(): len(stored) - 1 - i for i, corners in enumerate(stored[::-1])}
    for triangle in np.unique(hit.triangle[hit.triangle >= 0]):
        assert triangle == first[stored[triangle].tobytes()]


@pytest.mark.parametrize("backend", BACKENDS)
def test_64_bit_mode_changes_nothing(case, backend):
    _, scene, origin, direction = case
    expected, _ = run(scene, origin, direction, backend)
    with jax.enable_x64(True):
        hit = in_jit(cast, scene, f32(origin), f32(direction), mask=7, backend=backend)
        double = [jnp.asarray(x, jnp.float64) for x in (origin, direction)]
        wide = in_jit(cast, scene, *double, mask=7, backend=backend)
    for a, b, c in zip(*map(jax.tree.leaves, (hit, wide, expected)), strict=True):
        assert a.dtype == b.dtype == c.dtype
        np.testing.assert_array_equal(a, c)
        np.testing.assert_array_equal(b, c)


@pytest.mark.cpu
@pytest.mark.parametrize("backend", BACKENDS)
def test_without_jit_nothing_changes(case, backend):
    """As users look for their own mistakes."""
    _, scene, origin, direction = case
    expected = in_jit(cast, scene, f32(origin[:2]), f32(direction[:2]), mask=7, backend=backend)
    with jax.disable_jit():
        hit = cast(scene, f32(origin[:2]), f32(direction[:2]), mask=7, backend=backend)
    np.testing.assert_array_equal(hit.instance, expected.instance)
    np.testing.assert_array_equal(hit.triangle, expected.triangle)
    np.testing.assert_allclose(hit.t, expected.t, rtol=1e-5)


def test_any_leading_shape_and_scalars(case):
    _, scene, origin, direction = case
    flat = in_jit(cast, scene, f32(origin[:24]), f32(direction[:24]), mask=7)
    cube = in_jit(cast, scene, f32(origin[:24].reshape(2, 3, 4, 3)), f32(direction[:24].reshape(2, 3, 4, 3)), mask=7)
    one = in_jit(cast, scene, f32(origin[0]), f32(direction[0]), mask=7)
    none = in_jit(cast, scene, f32(origin[:0]), f32(direction[:0]), mask=7)
    for a, b, c, d in zip(*map(jax.tree.leaves, (flat, cube, one, none)), strict=True):
        np.testing.assert_array_equal(a.reshape(2, 3, 4), b)
        np.testing.assert_array_equal(a[0], c)
        assert c.shape == ()
        assert d.shape == (0,)
    here = in_jit(cast, scene, f32(origin[0]), f32(direction[:24]), mask=7)
    there = in_jit(cast, scene, f32(np.tile(origin[:1], (24, 1))), f32(direction[:24]), mask=7)
    for a, b in zip(*map(jax.tree.leaves, (here, there)), strict=True):
        np.testing.assert_array_equal(a, b)
    each = jax.vmap(lambda d: cast(scene, f32(origin[0]), d, mask=7).t)(f32(direction[:24]))
    np.testing.assert_array_equal(each, here.t)
    many = jax.vmap(lambda o, s: cast(s, o, o).t, (0, None))(jnp.zeros((3, 0, 3)), scene)
    assert many.shape == (3, 0)


@pytest.mark.parametrize("backend", BACKENDS)
def test_triangles_without_area_are_never_hit(backend):
    point, line = np.zeros((3, 3)), np.eye(3)[[0, 1, 1]]
    soup = Soup([np.stack([point, line]).astype(np.float32)], [Placed(0, np.eye(3, 4), 0)])
    hit = in_jit(cast, soup.scene(), f32(-np.ones((4, 3))), f32(np.eye(4, 3) * 0.5 + 1), backend=backend)
    assert (hit.instance == -1).all()
    assert np.isinf(hit.t).all()


def test_unknown_executor_names_the_known_ones(case):
    with pytest.raises(ConfigError, match=r"Did you mean `cpu`"):
        cast(case[1], jnp.zeros(3), jnp.ones(3), backend="cpuu")


@pytest.mark.cpu
def test_cuda_says_that_there_is_no_gpu(case):
    with pytest.raises(BackendError, match="no NVIDIA GPU"):
        cast(case[1], jnp.zeros(3), jnp.ones(3), backend="cuda")
