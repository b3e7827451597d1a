"""The `cpu` backend's packets: hits do not depend on which rays are cast together, and lanes compute as NumPy does."""

from typing import Any, no_type_check

import jax
import numpy as np
import pytest
from numba import njit, types
from soup import f32, i32, in_jit, random_rays, random_soup

from home_mjx.core.native import simd as lanes
from home_mjx.core.native.memory import pointer_to
from home_mjx.raycast_render.casting.cast import cast, occluded

pointer = pointer_to(types.float32)


@pytest.fixture(scope="module", autouse=True)
def on_cpu():
    with jax.default_device(jax.devices("cpu")[0]):
        yield


@pytest.fixture(scope="module")
def case():
    rng = np.random.default_rng(8)
    return random_soup(rng).scene(), *random_rays(rng, 17 * 19)


def assert_equal_bits(a, b):
    for x, y in zip(jax.tree.leaves(a), jax.tree.leaves(b), strict=True):
        np.testing.assert_array_equal(x.reshape(-1), y.reshape(-1))


@pytest.mark.parametrize("shape", [(17, 19), (19, 17), (1, 323), (323, 1)])
def test_images_of_any_size_show_what_each_ray_alone_hits(case, shape):
    """Sides that tiles do not divide, and images narrower than a tile; alone: one ray to an environment."""
    scene, origin, direction = case
    options = {"mask": 7, "backend": "cpu"}
    rays = [f32(x.reshape(*shape, 3)) for x in (origin, direction)]
    one_by_one = jax.vmap(lambda o, d: cast(scene, o, d, **options))
    alone = jax.jit(one_by_one)(f32(origin), f32(direction))
    assert 0.3 < (alone.instance >= 0).mean() < 0.98
    assert_equal_bits(in_jit(cast, scene, *rays, **options), alone)
    np.testing.assert_array_equal(in_jit(occluded, scene, *rays, **options).reshape(-1), alone.instance >= 0)


def test_values_that_rays_share_are_read_once_for_every_environment(case):
    """Origin, range, exclusion and mask of each of five environments, given once or with every ray."""
    scene, origin, direction = case
    rng = np.random.default_rng(2)
    shared = (
        f32(origin[:5]),
        f32(rng.uniform(0, 0.4, 5)),
        f32(rng.uniform(0.6, 2, 5)),
        i32(rng.integers(-1, 8, 5)),
        i32([1, 7, 2, 4, 3]),
    )

    def look(o, t_min, t_max, exclude, mask):
        once = cast(scene, o, f32(direction[:40]), t_min, t_max, exclude, mask, backend="cpu")
        fields = (jax.numpy.broadcast_to(x[None], (40,)) for x in (t_min, t_max, exclude, mask))
        each = cast(scene, jax.numpy.broadcast_to(o[None], (40, 3)), f32(direction[:40]), *fields, backend="cpu")
        return once, each

    once, each = jax.jit(jax.vmap(look))(*shared)
    assert 0.02 < (once.instance >= 0).mean() < 0.9
    assert_equal_bits(once, each)


@no_type_check
def compute(a, b, out):
    """Every operation on lanes, a row of `out` each; a and b by their addresses."""
    first, second = lanes.load(pointer(a), 0), lanes.load(pointer(b), 0)
    one = np.float32(1)
    results = (
        first + second,
        first - one,
        one * second,
        first / second,
        lanes.minimum(first, second),
        lanes.maximum(first, second),
        lanes.absolute(first),
        lanes.select(~(first < second) & (first >= one), first, one),
        lanes.select((first == second) | (first > second) | (first <= one), second, first),
    )
    for row, result in enumerate(results):
        lanes.store(pointer(out), lanes.LANES * row, result)
    return (
        lanes.count_lanes(first < second),
        lanes.any_lane(first < second),
        lanes.any_lane(first < -np.float32(np.inf)),
    )


def test_lanes_compute_as_numpy_does():
    rng = np.random.default_rng(4)
    a, b = rng.normal(size=(2, lanes.LANES)).astype(np.float32)
    a[:6], b[:6] = [np.nan, 1, np.inf, -np.inf, -0.0, 2], [1, np.nan, -np.inf, 2, 0.0, 2]
    out = np.full((9, lanes.LANES), 7, np.float32)
    run: Any = njit(compute)
    number, some, none = run(a.ctypes.data, b.ctypes.data, out.ctypes.data)
    with np.errstate(invalid="ignore", divide="ignore"):
        expected = [
            a + b,
            a - 1,
            b,
            a / b,
            np.where(b < a, b, a),
            np.where(b > a, b, a),
            abs(a),
            np.where(~(a < b) & (a >= 1), a, 1),
            np.where((a == b) | (a > b) | (a <= 1), b, a),
        ]
    np.testing.assert_array_equal(out, np.array(expected, np.float32))
    assert (number, some, none) == ((a < b).sum(), True, False)
