"""Rays pass through cut-out texels in every executor: closest and any hits, camera and light, but not sound."""

import numpy as np
import pytest
from soup import BACKENDS, brute_force, f32, i32, in_jit, random_cut_outs, random_rays

from home_mjx.bank.records.geometry import CUTOUT_SHIFT
from home_mjx.raycast_render.casting.cast import cast, cast_multi_hit, occluded

N = 1500
MARGIN = 1e-3  # [texel], hits as close to a texel's border are in doubt


@pytest.fixture(scope="module")
def case():
    rng = np.random.default_rng(21)
    soup, holes = random_cut_outs(rng)
    scene = soup.scene()
    return soup, holes, scene, *random_rays(rng, N)


def truth(soup, holes, origin, direction, mask):
    """Distances to every triangle in float64, infinite at cut-outs; and rays in doubt."""
    found = brute_force(soup, origin, direction, mask=mask)
    uv, layer = [], []
    for p in soup.placed:
        order = soup.order[p.model]
        uv.append(soup.uvs[p.model][order])
        layer.append((soup.material_mask[p.material + soup.slots[p.model][order]] >> CUTOUT_SHIFT) - 1)
    uv, layer, stops = np.concatenate(uv).astype(float), np.concatenate(layer), soup.world_triangles()[4] & mask & 7
    edge = holes.shape[1]
    weight = np.stack([1 - found.u - found.v, found.u, found.v], axis=-1)
    place = np.einsum("rtc,tck->rtk", weight, uv) % 1 * edge
    column, row = np.moveaxis(np.minimum(np.nan_to_num(place).astype(int), edge - 1), -1, 0)
    may_pass = (layer >= 0) & (stops & 4 == 0)
    hole = may_pass & holes[np.maximum(layer, 0)[None], edge - 1 - row, column]
    at_border = may_pass & (abs(place - np.round(place)) < MARGIN).any(axis=-1) & np.isfinite(found.t)
    return np.where(hole, np.inf, found.t), found.doubtful | at_border.any(axis=1), hole & np.isfinite(found.t)


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("mask", [3, 4, *(pytest.param(m, marks=pytest.mark.slow) for m in (1, 2, 7))])
def test_hits_equal_brute_force(case, backend, mask):
    soup, holes, scene, origin, direction = case
    t, doubtful, hole = truth(soup, holes, origin, direction, mask)
    nearest = t.argmin(axis=1)
    expected, clear = t.min(axis=1), ~doubtful
    assert clear.mean() > 0.3
    assert hole.any() == (mask != 4)
    args = scene, f32(origin), f32(direction)
    hit = in_jit(cast, *args, mask=mask, backend=backend)
    np.testing.assert_array_equal(hit.instance[clear] >= 0, np.isfinite(expected)[clear])
    sure = clear & np.isfinite(expected)
    index = soup.world_triangles()[2]
    np.testing.assert_array_equal(hit.triangle[sure], index[nearest][sure])
    np.testing.assert_allclose(hit.t[sure], expected[sure], rtol=2e-4, atol=2e-5)
    hidden = in_jit(occluded, *args, mask=mask, backend=backend)
    np.testing.assert_array_equal(hidden, hit.instance >= 0)


@pytest.mark.parametrize("backend", BACKENDS)
def test_all_bits_of_a_mask_are_all_kinds(case, backend):
    *_, scene, origin, direction = case
    a, b = (in_jit(cast, scene, f32(origin), f32(direction), mask=mask, backend=backend) for mask in (7, -1))
    np.testing.assert_array_equal(a.triangle, b.triangle)


@pytest.mark.parametrize("backend", BACKENDS)
def test_successive_hits_pass_cut_outs(case, backend):
    *_, scene, origin, direction = case
    args = scene, f32(origin), f32(direction)
    first = in_jit(cast, *args, backend=backend)
    hits = in_jit(cast_multi_hit, *args, num_hits=3, hit_epsilon=1e-4, backend=backend)
    np.testing.assert_array_equal(hits.triangle[:, 0], first.triangle)
    assert (hits.t[:, 1] > hits.t[:, 0]).mean() > 0.2


@pytest.mark.parametrize("backend", BACKENDS)
def test_odd_texture_coordinates_and_layers_hit_or_miss(case, backend):
    """NaN, infinite and huge coordinates, and layers beyond the last: no crash, and a mask of sound is not affected."""
    *_, scene, origin, direction = case
    geometry = scene.geometry
    uv = np.array(geometry.triangle_uv)
    uv[::4], uv[1::4], uv[2::4] = np.nan, np.inf, 1e30
    mask = np.asarray(geometry.material_mask) & 7 | (1 << 22) << CUTOUT_SHIFT
    odd = scene.replace(
        bank=scene.bank.replace(geometry=geometry.replace(triangle_uv=f32(uv), material_mask=i32(mask)))
    )
    for kinds in (1, 4):
        hit = in_jit(cast, odd, f32(origin), f32(direction), mask=kinds, backend=backend)
        plain = in_jit(cast, scene, f32(origin), f32(direction), mask=kinds, backend=backend)
        assert kinds == 1 or (hit.triangle == plain.triangle).all()
        assert np.isfinite(hit.t[hit.instance >= 0]).all()
