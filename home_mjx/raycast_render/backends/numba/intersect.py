"""Intersection of ray packets with boxes and triangles, one ray per lane, rounded as in `xla` and `cuda`."""
# ruff: noqa: ANN001, ANN201, ANN202  (Numba infers the types)

from typing import Any, NamedTuple, no_type_check

import numpy as np

from home_mjx.core.native.inner import compile_inner
from home_mjx.core.native.memory import unlikely
from home_mjx.core.native.simd import absolute, any_lane, broadcast, maximum, minimum, select
from home_mjx.raycast_render.backends.numba.cutouts import ALL_KINDS, drop_cut_outs
from home_mjx.raycast_render.scene import types as scene_types

# As float32, since Numba would otherwise compute in float64.
FAR_SLACK, TINY = np.float32(scene_types.FAR_SLACK), np.float32(scene_types.TINY)
ZERO, ONE, INF = np.float32(0), np.float32(1), np.float32(np.inf)

Lane = Any  # a SIMD vector of `LANES` items
compiled = compile_inner(forceinline=True)


class PacketRays(NamedTuple):
    """Rays of a packet in one frame, with inverse directions for box tests, masks and the kind of query."""

    ox: Lane
    oy: Lane
    oz: Lane
    dx: Lane
    dy: Lane
    dz: Lane
    ix: Lane
    iy: Lane
    iz: Lane
    t_min: Lane  # infinity in lanes without a ray
    mask: Lane
    any_hit: np.bool_


class ModelInstance(NamedTuple):
    """One placed model: its instance index, model index and first material row."""

    number: np.int32
    model: np.int32
    material: np.int32


class BestHits(NamedTuple):
    """Best hits up to now: t, ids (-1: none), weights of corners 1, 2, and whether the front was hit."""

    t: Lane
    instance: Lane
    triangle: Lane
    u: Lane
    v: Lane
    front: Lane


@compiled
@no_type_check
def intersect_box(box, index, ray):
    """Return t, at least t_min, at which rays enter box `index` (6 numbers: minimum, maximum); infinity on a miss.

    A box that is only touched is hit; `t_max` is not tested.
    """
    at = 6 * index
    x0, x1 = (box[at] - ray.ox) * ray.ix, (box[at + 3] - ray.ox) * ray.ix
    y0, y1 = (box[at + 1] - ray.oy) * ray.iy, (box[at + 4] - ray.oy) * ray.iy
    z0, z1 = (box[at + 2] - ray.oz) * ray.iz, (box[at + 5] - ray.oz) * ray.iz
    near = maximum(maximum(minimum(x0, x1), minimum(y0, y1)), maximum(minimum(z0, z1), ray.t_min))
    far = minimum(minimum(maximum(x0, x1), maximum(y0, y1)), maximum(z0, z1)) * FAR_SLACK
    return select(near <= far, near, INF)


@compiled
@no_type_check
def prepare_packet(rays, alive, any_hit):
    """Return a packet's rays (`packet.Packet`) as `PacketRays`; lanes not in the mask `alive` get t_min = infinity."""
    origin, direction = (rays.ox, rays.oy, rays.oz), (rays.dx, rays.dy, rays.dz)
    return _ray(origin, direction, select(alive, rays.t_min, INF), rays.mask, any_hit)


@compiled
@no_type_check
def _ray(origin, direction, t_min, mask, any_hit):
    """Return `PacketRays` from (x, y, z) tuples, with inverse directions."""
    inverse = (_inverse(direction[0]), _inverse(direction[1]), _inverse(direction[2]))
    return PacketRays(*origin, *direction, *inverse, t_min, mask, any_hit)


@compiled
@no_type_check
def _inverse(x):
    """Return 1 / x, with the magnitude of x at least `TINY`."""
    return ONE / select(absolute(x) >= TINY, x, select(x >= ZERO, broadcast(TINY), -TINY))


@compiled
@no_type_check
def transform_rays(inverse, index, ray, sees):
    """Transform rays by matrix `index` of the flat (n, 3, 4) `inverse`; lanes not in `sees` get t_min = inf.

    Directions are not normalised, so that t keeps its unit.
    """
    at = 12 * index
    ox = inverse[at] * ray.ox + inverse[at + 1] * ray.oy + inverse[at + 2] * ray.oz + inverse[at + 3]
    oy = inverse[at + 4] * ray.ox + inverse[at + 5] * ray.oy + inverse[at + 6] * ray.oz + inverse[at + 7]
    oz = inverse[at + 8] * ray.ox + inverse[at + 9] * ray.oy + inverse[at + 10] * ray.oz + inverse[at + 11]
    dx = inverse[at] * ray.dx + inverse[at + 1] * ray.dy + inverse[at + 2] * ray.dz
    dy = inverse[at + 4] * ray.dx + inverse[at + 5] * ray.dy + inverse[at + 6] * ray.dz
    dz = inverse[at + 8] * ray.dx + inverse[at + 9] * ray.dy + inverse[at + 10] * ray.dz
    return _ray((ox, oy, oz), (dx, dy, dz), select(sees, ray.t_min, INF), ray.mask, ray.any_hit)


class ShearedRays(NamedTuple):
    """Rays prepared for triangle tests: the longest axis of each direction becomes its z."""

    along_x: Lane
    along_y: Lane
    ox: Lane
    oy: Lane
    oz: Lane
    dx: Lane
    dy: Lane
    iz: Lane


@compiled
@no_type_check
def shear_rays(ray):
    """Return the rays with axes permuted for `test_triangle`, in the same frame; see `ShearedRays`.

    Of equally long axes, the first counts.
    """
    x, y, z = absolute(ray.dx), absolute(ray.dy), absolute(ray.dz)
    along_x = (x >= y) & (x >= z)
    along_y = ~along_x & (y >= z)
    ox, oy, oz = _turn(along_x, along_y, ray.ox, ray.oy, ray.oz)
    dx, dy, dz = _turn(along_x, along_y, ray.dx, ray.dy, ray.dz)
    return ShearedRays(along_x, along_y, ox, oy, oz, dx, dy, ONE / dz)


@compiled
@no_type_check
def _turn(along_x, along_y, x, y, z):
    """Return x, y, z permuted cyclically so that x becomes z in lanes of `along_x`, y in those of `along_y`, z else."""
    return (
        select(along_x, y, select(along_y, z, x)),
        select(along_x, z, select(along_y, x, y)),
        select(along_x, x, select(along_y, y, z)),
    )


@compiled
@no_type_check
def _corner(triangle, at, shear):
    """Return the corner at `triangle[at]`, sheared so that rays run along z from the origin; its z is in units of t."""
    px, py, pz = _turn(
        shear.along_x, shear.along_y, broadcast(triangle[at]), broadcast(triangle[at + 1]), broadcast(triangle[at + 2])
    )
    z = (pz - shear.oz) * shear.iz
    x = (px - shear.ox) - shear.dx * z
    return x, (py - shear.oy) - shear.dy * z, z


@compiled
@no_type_check
def test_triangle(world, instance, triangle, ray, shear, reaches, best):
    """Return `best`, replaced by triangle `triangle` in lanes of `reaches` that hit it nearer.

    Both sides and all edges of a triangle count, at t >= t_min. One that is masked, cut out or parallel to the ray does
    not. At equal t, the lower instance and then the lower triangle counts. Any-hits get t = -inf, which ends their ray.
    """
    at = 9 * np.int64(triangle)
    ax, ay, az = _corner(world.triangle, at, shear)
    bx, by, bz = _corner(world.triangle, at + 3, shear)
    cx, cy, cz = _corner(world.triangle, at + 6, shear)
    # Edge functions; their signs come from a comparison of the products, which a fused multiply-add cannot change.
    u0, u1, v0, v1, w0, w1 = cx * by, cy * bx, ax * cy, ay * cx, bx * ay, by * ax
    positive = (u0 >= u1) & (v0 >= v1) & (w0 >= w1)
    meets = reaches & (positive | ((u0 <= u1) & (v0 <= v1) & (w0 <= w1)))
    if not any_lane(meets):
        return best
    u, v, w = u0 - u1, v0 - v1, w0 - w1
    total = u + v + w
    t = (u * az + v * bz + w * cz) / total
    # Ties go to the lower instance and triangle, so that the order of traversal does not matter.
    number = instance.number
    same = best.instance == number
    lower = (same & (best.triangle > triangle)) | (best.instance > number) | (best.instance < np.int32(0))
    row = np.int64(instance.material) + np.int64(world.triangle_slot[triangle])
    stops = world.material_mask[min(max(row, np.int64(0)), world.sizes.materials - 1)]
    wins = meets & ~(total == ZERO) & (t >= ray.t_min) & ((t < best.t) | ((t == best.t) & lower))
    wins = wins & ~((ray.mask & (stops & ALL_KINDS)) == np.int32(0))
    if not any_lane(wins):
        return best
    if unlikely(stops > ALL_KINDS):
        wins = drop_cut_outs(world, triangle, stops, ray.mask, v / total, w / total, wins)
    front = positive == (shear.iz > ZERO)
    return BestHits(
        select(wins, broadcast(-INF) if ray.any_hit else t, best.t),
        select(wins, number, best.instance),
        select(wins, triangle, best.triangle),
        select(wins, v / total, best.u),
        select(wins, w / total, best.v),
        select(wins, front, best.front),
    )
