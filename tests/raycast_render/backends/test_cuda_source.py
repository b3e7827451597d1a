"""`cast.cu` without a GPU: compiled as C++ for the CPU it casts as `xla` does; NVRTC, if it is here, compiles it."""

import ctypes
import itertools
import re
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import pytest
import trimesh
from compiled_kernels import nvrtc_ptx, shared_library
from odd_numbers import garbled
from sanitized import Program
from soup import Placed, Soup, f32, i32, in_jit, random_cut_outs, random_pose, random_rays, random_soup

from home_mjx.bank.records.geometry import CUTOUT_SHIFT
from home_mjx.bank.records.gpu_geometry import gpu_geometry
from home_mjx.raycast_render.backends import cuda
from home_mjx.raycast_render.casting.cast import cast, occluded
from home_mjx.raycast_render.scene import types as scene_types
from home_mjx.raycast_render.scene.types import RayQuery, Rays
from home_mjx.schema import compiled

N = 1500
CALLS = 450  # with garbage; call 412 has found what the first three hundred had not
STEPS = 5  # of rays that are followed through what they meet
TYPES = (np.float32, np.int32, np.int32, np.float32, np.float32, np.bool_)


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    """The kernels as functions for the CPU; each call casts one ray, as blocks have one thread."""
    shim = Path(__file__).parents[2] / "helpers" / "cuda_shim.h"
    text = (
        f'#include "{shim}"\n'
        + cuda.SOURCE.read_text().replace("constexpr int BLOCK = 64;", "constexpr int BLOCK = 1;")
        + """
extern "C" void run(void** p, int count, int environments, int kind) {
  gridDim = {unsigned(count), unsigned(environments), 1};
  for (unsigned e = 0; e < unsigned(environments); ++e)
    for (unsigned r = 0; r < unsigned(count); ++r) {
      blockIdx = {r, e, 0};
#define IN (const float4*)p[0], (const float4*)p[1], (const int*)p[2], (const float*)p[3], (const unsigned*)p[4], \\
    (const float4*)p[5], (const float4*)p[6], (const float2*)p[7], (const int*)p[8], (const int*)p[9], \\
    (const float*)p[10], (const float*)p[11], (const float*)p[12], (const float*)p[13], (const int*)p[14], \\
    (const int*)p[15], (const int*)p[16]
#define OUT (float*)p[17], (int*)p[18], (int*)p[19], (float*)p[20], (float*)p[21], (bool*)p[22]
      if (kind == 0) cast_closest(IN, OUT);
      else if (kind == 1) cast_any(IN, (int*)p[17]);
      else cast_through(IN, OUT);
    }
}
"""
    )
    return shared_library(tmp_path_factory.mktemp("cuda"), text, "-ffp-contract=off")


def run(library, scene, origin, direction, t_min=0.0, t_max=np.inf, exclude=-1, mask=7, any_hit=False, shared=()):
    """What the kernel says of rays in one environment, or in two that are alike; all have the first one's `shared`."""
    count = len(origin)
    rays = Rays(
        f32(origin),
        f32(direction),
        *(f32(np.broadcast_to(x, count)) for x in (t_min, t_max)),
        *(i32(np.broadcast_to(x, count)) for x in (exclude, mask)),
    )
    rays = rays.replace(**{name: getattr(rays, name)[:1] for name in shared})
    twice = jax.tree.map(lambda x: jnp.stack([x] * 2), (scene.house, scene.moving, rays))
    inputs = [np.ascontiguousarray(x) for x in cuda.kernel_operands(scene.geometry, *twice)]
    outputs = [np.full((2, count), 77, kind) for kind in TYPES]
    results = outputs[1:2] if any_hit else outputs
    pointers = [x.ctypes.data for x in inputs + results]
    library.run((ctypes.c_void_p * len(pointers))(*pointers), count, 2, int(any_hit))
    for x in results:
        np.testing.assert_array_equal(x[0], x[1])
    return outputs[1][0] >= 0 if any_hit else [x[0] for x in outputs]


def checked(library, folder):
    """The kernels under AddressSanitizer; each call casts 16 rays in each of `a` environments."""
    return Program(folder, Path(library._name).with_name("main.cpp").read_text(), "run(p, 16, a, b)")


def six_scenes(rng):
    """A bank and six scenes, each with 16 rays; and where results go."""
    scene = random_cut_outs(rng)[0].scene()
    origin, direction = (f32(x.reshape(6, 16, 3)) for x in random_rays(rng, 96))
    values = {"t_min": f32(np.zeros((6, 16))), "t_max": f32(np.full((6, 16), np.inf))}
    values |= {"exclude": i32(np.full((6, 16), -1)), "mask": i32(np.full((6, 16), 7))}
    geometry = scene.geometry.replace(gpu=gpu_geometry(scene.geometry))
    own = jax.tree.map(lambda x: jnp.stack([x] * 6), (scene.house, scene.moving))
    return (geometry, *own, Rays(origin, direction, **values)), [np.zeros((6, 16), kind) for kind in TYPES]


def test_garbage_in_every_array_stays_within_the_arrays(library, tmp_path):
    """A bank and six scenes in each call; see tests/soak/garbage.py."""
    program, (given, results) = checked(library, tmp_path), six_scenes(np.random.default_rng(11))
    read = jax.jit(lambda *x: cuda.kernel_operands(*x, RayQuery(num_hits=STEPS, hit_epsilon=1e-4)))
    many = [np.zeros((*x.shape, STEPS), x.dtype) for x in results]
    for number in range(CALLS):
        inputs = jax.device_get(read(*(garbled(f"cuda:{number}", *given) if number else given)))
        any_hit = number % 2
        program.add([*inputs, *(results[1:2] if any_hit else results)], 6, any_hit)
        program.add([*inputs, *many], 6, 2)
    program.run()


def test_trees_that_fill_the_stack_stay_within_it(library, tmp_path):
    """Chains of nodes whose second child waits on the stack, four times as many as it holds; every ray meets all boxes.

    What waits are leaves or empty ones, of houses or of models; at the chain's end lies a leaf, or an empty one.
    """
    program, (given, results) = checked(library, tmp_path), six_scenes(np.random.default_rng(12))
    read = jax.jit(lambda *x: cuda.kernel_operands(*x, RayQuery(num_hits=1)))
    inputs = [np.array(x) for x in jax.device_get(read(*given))]
    leaf, num_nodes = ~(0 << 4 | 2), 4 * (2 * compiled.MAX_DEPTH + 4)
    whole, size = np.float32([0, 0, 0, 1e6, 1e6, 1e6]), inputs[16]
    size[11] = num_nodes
    for waits, last, house_root, model_root in itertools.product(
        (leaf, compiled.EMPTY_LEAF),
        (leaf, compiled.EMPTY_LEAF),
        (0, leaf, compiled.EMPTY_LEAF),
        (0, leaf, compiled.EMPTY_LEAF, num_nodes - 1),
    ):
        code = np.stack([np.arange(num_nodes) + 1, np.full(num_nodes, waits)], axis=1).astype(np.int32)
        code[-1] = last
        node = np.hstack([np.tile(whole, (num_nodes, 2)), code.view(np.float32), np.zeros((num_nodes, 2), np.float32)])
        call = [node, *inputs[1:8], np.full_like(inputs[8], house_root), *inputs[9:]]
        for number in (5, 6):
            call[number] = inputs[number].copy()
            call[number][..., 12] = np.int32(model_root).view(np.float32)
        program.add([*call, *results], 6, 0)
        program.add([*call, results[1]], 6, 1)
        program.add([*call, *results], 6, 2)  # of one step
    program.run()


def assert_same(library, scene, origin, direction, **options):
    """The bits of the `cpu` backend, and what `xla` sees."""
    found = run(library, scene, origin, direction, **options)
    kinds = {"t_min": f32, "t_max": f32, "exclude": i32, "mask": i32}
    given = {name: kinds[name](np.broadcast_to(x, len(origin))) for name, x in ({"mask": 7} | options).items()}
    args = scene, f32(origin), f32(direction)

    def expected(function, backend):
        def look(s, o, d, options, backend):
            return function(s, o, d, **options, backend=backend)

        return in_jit(look, *args, given, backend=backend)

    exact, reference = (expected(cast, name) for name in ("cpu", "xla"))
    found[0] = np.where(found[1] < 0, np.inf, found[0])
    for name, value in zip(("t", "instance", "triangle", "u", "v", "front"), found, strict=True):
        np.testing.assert_array_equal(value, getattr(exact, name), err_msg=name)
    assert np.mean(found[2] == reference.triangle) > 0.999
    hidden = run(library, scene, origin, direction, any_hit=True, **options)
    np.testing.assert_array_equal(hidden, expected(occluded, "cpu"))
    return found


def test_it_casts_as_the_other_executors(library):
    rng = np.random.default_rng(3)
    scene, (origin, direction) = random_soup(rng).scene(), random_rays(rng, N)
    found = assert_same(library, scene, origin, direction)
    assert set(found[1]) > {-1, 0, 6, 7}, "rays must miss, and meet static and moving instances"


@pytest.mark.parametrize("mask", [1, 2, 5, -1])
def test_rays_pass_cut_out_texels(library, mask):
    rng = np.random.default_rng(22)
    (soup, _), (origin, direction) = random_cut_outs(rng), random_rays(rng, N)
    scene = soup.scene()
    found = assert_same(library, scene, origin, direction, mask=mask)
    solid = scene.replace(bank=scene.bank.replace(geometry=scene.geometry.replace(cutout=scene.geometry.cutout * 0)))
    assert 0.002 < (run(library, solid, origin, direction, mask=mask)[2] != found[2]).mean() < 0.8


def test_range_exclusion_and_mask(library):
    rng = np.random.default_rng(1)
    scene, (origin, direction) = random_soup(rng).scene(), random_rays(rng, N)
    options = {
        "t_min": rng.uniform(0, 0.5, N).astype(np.float32),
        "t_max": rng.uniform(0.3, 1.5, N).astype(np.float32),
        "exclude": rng.integers(-1, 8, N),
        "mask": rng.choice([1, 2, 4], N),
    }
    found = assert_same(library, scene, origin, direction, **options)
    assert 0.1 < np.mean(found[1] >= 0) < 0.6


def test_values_that_all_rays_of_an_environment_share(library):
    rng = np.random.default_rng(4)
    scene, (origin, direction) = random_soup(rng).scene(), random_rays(rng, 300)
    origin[:] = origin[0]
    options = {"t_min": 0.1, "t_max": 1.2, "exclude": 2, "mask": 5}
    expected = run(library, scene, origin, direction, **options)
    assert 0.1 < np.mean(expected[1] >= 0) < 0.9
    for shared in (("origin",), ("t_min", "mask"), ("t_max", "exclude"), ("origin", *options)):
        found = run(library, scene, origin, direction, **options, shared=shared)
        for x, y in zip(found, expected, strict=True):
            np.testing.assert_array_equal(x, y)


def test_more_moving_instances_than_a_group_holds(library):
    rng = np.random.default_rng(5)
    box = trimesh.creation.box(extents=(0.4, 0.5, 0.6)).triangles.astype(np.float32)
    soup = Soup([box], [Placed(0, random_pose(rng), i, moves=i > 0) for i in range(80)])
    found = assert_same(library, soup.scene(), *random_rays(rng, N))
    assert len(set(found[1])) > 60


def test_rays_and_poses_that_are_no_numbers_hit_nothing_and_harm_nobody(library):
    rng = np.random.default_rng(3)
    scene, (origin, direction) = random_soup(rng).scene(), random_rays(rng, N)
    good = run(library, scene, origin, direction)
    bad = origin.copy(), direction.copy()
    bad[0][::3, 1], bad[1][1::3, 2] = np.nan, np.inf
    found = run(library, scene, *bad)
    for x, y in zip(found, good, strict=True):
        np.testing.assert_array_equal(x[2::3], y[2::3])
    spoilt = np.arange(N) % 3 != 2
    assert (found[1][spoilt] == -1).all()
    moving = scene.moving
    nan = {name: getattr(moving, name).at[0].set(np.nan) for name in ("pose", "inverse", "box")}
    found = run(library, scene.replace(moving=moving.replace(**nan)), origin, direction)
    gone = int(moving.instance[0])
    others = good[1] != gone
    assert not (found[1] == gone).any()
    np.testing.assert_array_equal(found[2][others], good[2][others])
    assert (run(library, scene, origin, direction, t_max=np.nan)[1] == -1).all()
    assert (run(library, scene, origin, direction, t_min=np.nan)[1] == -1).all()


def test_rays_at_edges_and_corners_do_not_escape(library):
    rng = np.random.default_rng(7)
    mesh = trimesh.creation.icosphere(subdivisions=3)
    pose = random_pose(rng, scale=np.array([0.01, 7.0, 1.0]))
    soup = Soup([mesh.triangles.astype(np.float32)], [Placed(0, pose, 0)])
    corners = mesh.vertices.astype(np.float32).astype(float)
    edges = corners[mesh.edges_unique]
    targets = np.concatenate([corners, edges.mean(axis=1)]) @ pose[:, :3].T + pose[:, 3]
    origin = np.broadcast_to(pose[:, 3], targets.shape)
    found = run(library, soup.scene(), origin.astype(np.float32), (targets - origin).astype(np.float32))
    assert (found[1] == 0).all()
    assert not found[5].any()


def test_gpu_geometry_holds_every_box():
    geometry = random_soup(np.random.default_rng(0)).scene().geometry
    node = np.asarray(gpu_geometry(geometry).node)
    box = np.asarray(geometry.node_box, float)
    child = node[:, :12].reshape(-1, 2, 6).astype(float)
    used = (box[..., :3] <= box[..., 3:]).all(axis=-1)
    (low, high), (center, half) = (np.split(x[used], 2, axis=1) for x in (box, child))
    assert (center - half <= low).all()
    assert (center + half >= high).all()
    np.testing.assert_allclose(center - half, low, atol=1e-5)
    assert (child[~used, 3:] == -np.inf).all()
    np.testing.assert_array_equal(node[:, 12:14].view(np.int32), geometry.node_child)


def test_constants_are_those_of_the_other_executors():
    source = cuda.SOURCE.read_text()
    told = dict(re.findall(r"constexpr \w+ (\w+) = ([^;]+);", source))
    assert int(told["BLOCK"]) == cuda.BLOCK
    assert (int(told["TILE_WIDTH"]), int(told["TILE_HEIGHT"])) == cuda.TILE
    assert int(told["MAX_DEPTH"]) == compiled.MAX_DEPTH
    assert int(told["EMPTY"]) == compiled.EMPTY_LEAF
    assert int(told["ALL_KINDS"]) == compiled.RayKind.ALL
    assert int(told["SOUND"]) == compiled.RayKind.SOUND
    assert int(told["CUTOUT_SHIFT"]) == CUTOUT_SHIFT
    for name in ("MISS", "TINY", "FAR_SLACK"):
        assert sum(float(part.rstrip("f")) for part in told[name].split("+")) == getattr(scene_types, name)


@pytest.mark.parametrize("capability", [80, 90, 120])
def test_nvrtc_compiles_it(tmp_path, monkeypatch, capability):
    monkeypatch.setenv("HOME_MJX_CACHE", str(tmp_path))
    ptx = nvrtc_ptx(cuda.SOURCE, capability)
    assert ".entry cast_closest" in ptx
    assert ".entry cast_any" in ptx
    assert ".entry cast_through" in ptx
    assert f".target sm_{capability}" in ptx
