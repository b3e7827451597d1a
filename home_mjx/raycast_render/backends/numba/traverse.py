"""Two-level traversal as a compiled loop over packets of rays: the inner part of the `cpu` backend.

The algorithm is that of `xla`, which names its sources. The rays of a packet, a tile of the image, traverse the BVHs
together, one in each lane of a vector. A node is opened if any ray hits it; the stack stores each ray's entry distance.
Each ray therefore tests the same triangles as it would alone.

All memory is accessed through bare pointers, since Numba's reference counting of arrays costs several times the work
itself. Every index read from an array is therefore clipped to its rows, and a traversal visits at most as many nodes as
exist. Invalid BVHs may be cut short, but cannot cause reads outside of the arrays or endless loops.

Source: I. Wald, P. Slusallek, C. Benthin, M. Wagner, "Interactive rendering with coherent ray tracing",
Eurographics 2001.
"""
# ruff: noqa: ANN001, ANN202  (Numba infers the types)

from typing import Any, NamedTuple, no_type_check

import numpy as np
from numba import types

from home_mjx.core.native.inner import compile_inner
from home_mjx.core.native.memory import pointer_to, stack_of
from home_mjx.core.native.simd import FLOATS, any_lane, broadcast, count_lanes, select
from home_mjx.raycast_render.backends.numba.intersect import (
    INF,
    ZERO,
    BestHits,
    ModelInstance,
    intersect_box,
    prepare_packet,
    shear_rays,
    test_triangle,
    transform_rays,
)
from home_mjx.raycast_render.backends.numba.packet import (
    RowCounts,
    assign_lanes,
    clip_row,
    lane_rows,
    read_packet,
    write_hits,
)
from home_mjx.schema.compiled import EMPTY_LEAF, MAX_DEPTH

Pointer = Any  # a C pointer, which Numba indexes like an array
float_pointer, int_pointer, word_pointer = map(pointer_to, (types.float32, types.int32, types.uint32))
# The top tree uses the lower half of the stacks, the tree of the instance being visited the upper one.
code_stack, enter_stack = stack_of(types.int32, 2 * MAX_DEPTH), stack_of(FLOATS, 2 * MAX_DEPTH)
compiled = compile_inner(forceinline=True)


class SceneArrays(NamedTuple):
    """Arrays of `Geometry` that rays need, then the houses of the environments and arrays of `DynamicInstances`."""

    node_box: Pointer  # (n, 2, 6) float32
    node_child: Pointer  # (n, 2) int32
    triangle: Pointer  # (t, 3, 3) float32
    triangle_slot: Pointer  # (t,) int32
    model_root: Pointer  # (m,) int32
    house_root: Pointer  # (h,) int32
    instance_model: Pointer  # (h, i) int32
    instance_inverse: Pointer  # (h, i, 3, 4) float32
    instance_object: Pointer  # (h, i) int32
    instance_material: Pointer  # (h, i) int32
    material_mask: Pointer  # (r,) int32
    triangle_uv: Pointer  # (t, 3, 2) float32
    cutout: Pointer  # (l, s, w) uint32
    house: Pointer  # (e,) int32
    moving_instance: Pointer  # (e, d) int32
    moving_model: Pointer  # (e, d) int32
    moving_inverse: Pointer  # (e, d, 3, 4) float32
    moving_box: Pointer  # (e, d, 2, 3) float32
    moving_object: Pointer  # (e, d) int32
    moving_material: Pointer  # (e, d) int32
    sizes: RowCounts


@compile_inner()
@no_type_check
def cast_packet(operands, counts, results, sizes, tiles, any_hit, packet) -> None:
    """Cast one packet and write its hits into `results`.

    Args:
        operands: Addresses of the arrays of `SceneArrays` in its order, then of `types.Rays`.
        counts: Number of values per environment of each field of the rays: the number of rays, or one.
        results: Addresses of t, instance, triangle, u, v and front.
        sizes: Numbers of rows of the arrays.
        tiles: Tiling of each environment.
        any_hit: True if a ray may stop at any hit.
        packet: Index of the packet, counted over all environments.
    """
    world = _world(operands, sizes)
    env = packet // tiles.packets
    rows = lane_rows()
    assign_lanes(tiles, packet % tiles.packets, rows)
    rays = read_packet(operands, counts, env, rows)
    alive, none = rays.t_min <= rays.t_max, broadcast(np.int32(-1))
    best = BestHits(select(alive, rays.t_max, -INF), none, none, broadcast(ZERO), broadcast(ZERO), broadcast(False))
    if any_lane(alive):
        best = _cast(world, env, prepare_packet(rays, alive, any_hit), rays.exclude, best, code_stack(), enter_stack())
    write_hits(results, env * tiles.count, rows, best)


@compiled
@no_type_check
def _world(at, sizes):
    """Cast operand addresses to the pointers of `SceneArrays`."""
    return SceneArrays(
        float_pointer(at[0]),
        int_pointer(at[1]),
        float_pointer(at[2]),
        int_pointer(at[3]),
        int_pointer(at[4]),
        int_pointer(at[5]),
        int_pointer(at[6]),
        float_pointer(at[7]),
        int_pointer(at[8]),
        int_pointer(at[9]),
        int_pointer(at[10]),
        float_pointer(at[11]),
        word_pointer(at[12]),
        int_pointer(at[13]),
        int_pointer(at[14]),
        int_pointer(at[15]),
        float_pointer(at[16]),
        float_pointer(at[17]),
        int_pointer(at[18]),
        int_pointer(at[19]),
        sizes,
    )


@compiled
@no_type_check
def _cast(world, env, ray, exclude, best, codes, enters):
    """Return `best` updated with static instances, by the top-level BVH, then moving ones; ignore object `exclude`."""
    house, num_instances, left = (
        clip_row(world.house[env], world.sizes.houses),
        world.sizes.instances,
        world.sizes.nodes,
    )
    code, enter, size = world.house_root[house], ray.t_min, 0
    while code != EMPTY_LEAF:
        if code >= 0:
            if left <= 0:
                break
            left -= 1
            code, enter, size = _open_node(world, code, ray, best.t, codes, enters, size)
        else:
            for i in range(~code >> 4, min((~code >> 4) + (~code & 15), num_instances)):
                at = house * num_instances + i
                sees = _is_visible(world.instance_object[at], exclude) & (enter <= best.t)
                if any_lane(sees):
                    instance = ModelInstance(np.int32(i), world.instance_model[at], world.instance_material[at])
                    inside = transform_rays(world.instance_inverse, at, ray, sees)
                    best = _cast_model(world, instance, inside, best, codes, enters)
            code = np.int32(EMPTY_LEAF)
        if code == EMPTY_LEAF:
            code, enter, size = _pop(codes, enters, size, 0, best.t)
    for at in range(env * world.sizes.moving, (env + 1) * world.sizes.moving):
        if world.moving_instance[at] >= 0:
            sees = _is_visible(world.moving_object[at], exclude) & (intersect_box(world.moving_box, at, ray) <= best.t)
            if any_lane(sees):
                instance = ModelInstance(world.moving_instance[at], world.moving_model[at], world.moving_material[at])
                inside = transform_rays(world.moving_inverse, at, ray, sees)
                best = _cast_model(world, instance, inside, best, codes, enters)
    return best


@compiled
@no_type_check
def _is_visible(object_id, exclude):
    """Return the lanes whose `exclude` is negative, none, or another object id."""
    return (exclude < np.int32(0)) | ~(exclude == object_id)


@compile_inner()  # called from two places, too large to inline
@no_type_check
def _cast_model(world, instance, ray, best, codes, enters):
    """Return `best` updated with one instance, by the BVH of its model; the rays are in its frame."""
    shear = shear_rays(ray)
    left = world.sizes.nodes
    code, enter, size = world.model_root[clip_row(instance.model, world.sizes.models)], ray.t_min, MAX_DEPTH
    while code != EMPTY_LEAF:
        if code >= 0:
            if left <= 0:
                break
            left -= 1
            code, enter, size = _open_node(world, code, ray, best.t, codes, enters, size)
        else:
            for triangle in range(~code >> 4, min((~code >> 4) + (~code & 15), world.sizes.triangles)):
                best = test_triangle(world, instance, np.int32(triangle), ray, shear, enter <= best.t, best)
            code = np.int32(EMPTY_LEAF)
        if code == EMPTY_LEAF:
            code, enter, size = _pop(codes, enters, size, MAX_DEPTH, best.t)
    return best


@compiled
@no_type_check
def _open_node(world, node, ray, limit, codes, enters, size):
    """Visit a BVH node: push the child that most rays enter later; return the other's code and entry t, and stack size.

    In a tie the second child is pushed. A child that no ray enters at t <= `limit` (t of its best hit) is not pushed,
    or returned as `EMPTY_LEAF`. A full stack drops the child.
    """
    at = 2 * clip_row(node, world.sizes.nodes)
    near, far = world.node_child[at], world.node_child[at + 1]
    near_t, far_t = intersect_box(world.node_box, at, ray), intersect_box(world.node_box, at + 1, ray)
    if count_lanes(far_t < near_t) > count_lanes(near_t < far_t):
        near, far, near_t, far_t = far, near, far_t, near_t
    if far != EMPTY_LEAF and size < 2 * MAX_DEPTH and any_lane(far_t <= limit):
        codes[size], enters[size] = far, far_t
        size += 1
    return near if any_lane(near_t <= limit) else np.int32(EMPTY_LEAF), near_t, size


@compiled
@no_type_check
def _pop(codes, enters, size, base, limit):
    """Pop codes until a ray enters one at t <= `limit`; return it (`EMPTY_LEAF` at size `base`), its t and new size."""
    enter = limit
    while size > base:
        size -= 1
        enter = enters[size]
        if any_lane(enter <= limit):
            return codes[size], enter, size
    return np.int32(EMPTY_LEAF), enter, size
