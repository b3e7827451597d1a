"""`cast.cu` in warps of 32 lanes, without a GPU: all come to what they do together, however far their rays go."""

import ctypes
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import pytest
import trimesh
from compiled_kernels import shared_library
from soup import Placed, Soup, f32, i32, random_cut_outs, random_pose, random_rays, random_soup

from home_mjx.raycast_render.backends import cuda
from home_mjx.raycast_render.backends.registry import find_backend
from home_mjx.raycast_render.scene.types import CLOSEST_HIT, RayQuery, Rays

STEPS = 7
THROUGH = RayQuery(num_hits=STEPS, hit_epsilon=1e-4)
TYPES = (np.float32, np.int32, np.int32, np.float32, np.float32, np.bool_)


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    """The kernels as functions for the CPU."""
    shim = Path(__file__).parents[2] / "helpers" / "warp_shim.h"
    text = (
        f'#include "{shim}"\n'
        + cuda.SOURCE.read_text().replace("constexpr int BLOCK = 64;", "constexpr int BLOCK = 32;")
        + """
static void** p;
#define CALL(kernel) kernel((const float4*)p[0], (const float4*)p[1], (const int*)p[2], (const float*)p[3], \\
    (const unsigned*)p[4], (const float4*)p[5], (const float4*)p[6], (const float2*)p[7], (const int*)p[8], \\
    (const int*)p[9], (const float*)p[10], (const float*)p[11], (const float*)p[12], (const float*)p[13], \\
    (const int*)p[14], (const int*)p[15], (const int*)p[16], (float*)p[17], (int*)p[18], (int*)p[19], (float*)p[20], \\
    (float*)p[21], (bool*)p[22])
static void closest() { CALL(cast_closest); }
static void through() { CALL(cast_through); }

extern "C" void run(void** arrays, int warps, int environments, bool steps) {
  p = arrays, gridDim = {unsigned(warps), unsigned(environments), 1};
  for (int e = 0; e < environments; ++e)
    for (int w = 0; w < warps; ++w) run_warp(w, e, steps ? through : closest);
}
"""
    )
    return shared_library(tmp_path_factory.mktemp("warps"), text, "-ffp-contract=off")


def assert_same(library, scene, rays, query):
    """The bits of the `cpu` backend, of rays (e r) in environments that are alike."""
    environments, count = rays.shape
    house, moving = jax.tree.map(lambda x: jnp.stack([x] * environments), (scene.house, scene.moving))
    inputs = [np.ascontiguousarray(x) for x in cuda.kernel_operands(scene.geometry, house, moving, rays, query)]
    shape = (*rays.shape, query.num_hits) if query.num_hits else rays.shape
    results = [np.full(shape, 77, kind) for kind in TYPES]
    pointers = [x.ctypes.data for x in inputs + results]
    warps = (1 + count // 32) if rays.width == 0 else cuda.launch_grid(environments, count, rays.width)[0] * 2
    library.run((ctypes.c_void_p * len(pointers))(*pointers), warps, environments, query.num_hits > 0)
    with jax.default_device(jax.devices("cpu")[0]):
        expected = jax.jit(lambda *x: find_backend("cpu")(*x, query))(scene.geometry, house, moving, rays)
    for name, x, y in zip(expected._fields, results, expected, strict=True):
        np.testing.assert_array_equal(x, y, err_msg=name)
    return expected


def some_rays(rng, environments, count, width=0):
    origin, direction = (f32(x.reshape(environments, count, 3)) for x in random_rays(rng, environments * count))
    shape = environments, count
    values = {"t_min": f32(rng.uniform(0, 0.1, shape)), "t_max": f32(rng.uniform(0.3, 3, shape))}
    values |= {"exclude": i32(rng.integers(-1, 8, shape)), "mask": i32(rng.choice([1, 2, 7], shape))}
    return Rays(origin, direction, **values, width=width)


@pytest.mark.parametrize(("count", "width"), [(1, 0), (90, 0), (12 * 10, 12)])
def test_rays_of_a_warp_that_go_through_more_and_less(library, count, width):
    """Alone in their warp, as sound's are; more than a warp and in tiles, with threads that have no ray."""
    rng = np.random.default_rng(count)
    scene, rays = random_soup(rng).scene(), some_rays(rng, 5, count, width)
    assert_same(library, scene, rays, CLOSEST_HIT)
    met = np.sum(assert_same(library, scene, rays, THROUGH).instance >= 0, axis=2)
    if count > 1:
        assert set(met.ravel().tolist()) == set(range(STEPS + 1))


def test_rays_of_a_warp_that_pass_cut_out_texels(library):
    rng = np.random.default_rng(91)
    scene, rays = random_cut_outs(rng)[0].scene(), some_rays(rng, 2, 90)
    for query in (CLOSEST_HIT, THROUGH):
        assert_same(library, scene, rays, query)


def test_more_moving_instances_than_a_group_holds(library):
    rng = np.random.default_rng(5)
    box = trimesh.creation.box(extents=(0.4, 0.5, 0.6)).triangles.astype(np.float32)
    soup = Soup([box], [Placed(0, random_pose(rng), i, moves=i > 0) for i in range(80)])
    found = assert_same(library, soup.scene(), some_rays(rng, 2, 200), THROUGH)
    assert len(np.unique(found.instance)) > 40


def test_an_instance_that_moves_goes_by_its_own_object(library):
    """Not by what the house says of its number; the one of an object that is no object's is walked through."""
    rng = np.random.default_rng(6)
    scene, rays = random_soup(rng).scene(), some_rays(rng, 2, 300)
    before = assert_same(library, scene, rays, THROUGH)
    moving = scene.moving.replace(object_id=scene.moving.object_id.at[0].set(-1).at[1].set(70))
    after = assert_same(library, scene.replace(moving=moving), rays, THROUGH)
    assert np.any(before.instance != after.instance)
