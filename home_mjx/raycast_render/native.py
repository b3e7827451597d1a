"""Two-level traversal as a compiled scalar loop over rays: the inner part of the `cpu` executor.

It does what `xla` does, ray by ray, and names the same sources there. All memory is reached through bare pointers:
Numba counts references to arrays at every step, which costs several times the work itself.
"""
# ruff: noqa: ANN001, ANN202  (Numba infers the types)

from typing import Any, NamedTuple, no_type_check

import numpy as np
from numba import njit, types

from home_mjx.raycast_render import limits
from home_mjx.raycast_render.native_memory import pointer_to, stack_of
from home_mjx.scene_compile.bvh import EMPTY, MAX_DEPTH

# As float32, since Numba would otherwise compute in float64.
MISS, FAR_SLACK, TINY = np.float32(limits.MISS), np.float32(limits.FAR_SLACK), np.float32(limits.TINY)
ZERO, ONE = np.float32(0), np.float32(1)

Pointer = Any  # a C pointer, which Numba indexes like an array
float_pointer, int_pointer, byte_pointer = map(pointer_to, (types.float32, types.int32, types.uint8))
float_stack, int_stack = stack_of(types.float32, 2 * MAX_DEPTH), stack_of(types.int32, 2 * MAX_DEPTH)
compiled = njit(error_model="numpy", forceinline=True)


class World(NamedTuple):
    """What rays need of `bank.Geometry`, then the environments' houses and what they need of `types.Moving`."""

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
    house: Pointer  # (e,) int32
    moving_instance: Pointer  # (e, d) int32
    moving_model: Pointer  # (e, d) int32
    moving_inverse: Pointer  # (e, d, 3, 4) float32
    moving_box: Pointer  # (e, d, 2, 3) float32
    moving_object: Pointer  # (e, d) int32
    moving_material: Pointer  # (e, d) int32
    num_instances: int
    num_moving: int


class Ray(NamedTuple):
    """A ray in one frame, with the inverse of its direction for boxes, and what it may hit."""

    ox: np.float32
    oy: np.float32
    oz: np.float32
    dx: np.float32
    dy: np.float32
    dz: np.float32
    ix: np.float32
    iy: np.float32
    iz: np.float32
    t_min: np.float32
    mask: np.int32
    any_hit: np.bool_


class Instance(NamedTuple):
    """One placed model."""

    number: np.int32
    model: np.int32
    material: np.int32


class Best(NamedTuple):
    """The best hit so far."""

    t: np.float32
    instance: np.int32
    triangle: np.int32
    u: np.float32
    v: np.float32
    front: np.bool_


@njit(error_model="numpy")
@no_type_check
def cast_range(operands, results, num_instances, num_moving, per_env, any_hit, first, last) -> None:
    """Casts the rays `first` to `last`, of which each environment has `per_env` in a row.

    Args:
        operands: Addresses of the arrays of `World` in its order, then of `types.Rays`.
        results: Addresses of t, instance, triangle, u, v and front.
        num_instances: Instances per house.
        num_moving: Moving slots per environment.
        per_env: Rays per environment.
        any_hit: Whether a ray may stop at the first triangle that it meets.
        first: Ray.
        last: One beyond the last ray.
    """
    world = _world(operands, num_instances, num_moving)
    origin, direction = float_pointer(operands[18]), float_pointer(operands[19])
    t_min, t_max = float_pointer(operands[20]), float_pointer(operands[21])
    exclude, mask = int_pointer(operands[22]), int_pointer(operands[23])
    t, instance, triangle = float_pointer(results[0]), int_pointer(results[1]), int_pointer(results[2])
    u, v, front = float_pointer(results[3]), float_pointer(results[4]), byte_pointer(results[5])
    # The top tree uses the lower half of the stack, the tree of the instance being visited the upper one.
    stack, stack_t = int_stack(), float_stack()
    for row in range(first, last):
        best = Best(min(t_max[row], MISS), np.int32(-1), np.int32(-1), ZERO, ZERO, False)
        if t_min[row] <= best.t:
            o, d = _vector(origin, row), _vector(direction, row)
            ray = _ray(o[0], o[1], o[2], d[0], d[1], d[2], t_min[row], mask[row], any_hit)
            best = _cast(world, row // per_env, ray, exclude[row], best, stack, stack_t)
        t[row] = best.t if best.instance >= 0 else MISS
        instance[row], triangle[row] = best.instance, best.triangle
        u[row], v[row], front[row] = best.u, best.v, best.front


@compiled
@no_type_check
def _world(at, num_instances, num_moving):
    return World(
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
        int_pointer(at[11]),
        int_pointer(at[12]),
        int_pointer(at[13]),
        float_pointer(at[14]),
        float_pointer(at[15]),
        int_pointer(at[16]),
        int_pointer(at[17]),
        num_instances,
        num_moving,
    )


@compiled
@no_type_check
def _vector(values, row):
    return values[3 * row], values[3 * row + 1], values[3 * row + 2]


@compiled
@no_type_check
def _cast(world, env, ray, exclude, best, stack, stack_t):
    """Static instances through the house's top tree, then the moving ones in turn."""
    first = np.int64(world.house[env]) * world.num_instances
    code, size = world.house_root[world.house[env]], 0
    while code != EMPTY:
        if code >= 0:
            code, size = _open(world, code, ray, best.t, stack, stack_t, size)
        else:
            for i in range(~code >> 4, (~code >> 4) + (~code & 15)):
                at = first + i
                if exclude < 0 or world.instance_object[at] != exclude:
                    instance = Instance(np.int32(i), world.instance_model[at], world.instance_material[at])
                    best = _cast_model(world, instance, _into(world.instance_inverse, at, ray), best, stack, stack_t)
            code = np.int32(EMPTY)
        if ray.any_hit and best.instance >= 0:
            return best
        if code == EMPTY:
            code, size = _pop(stack, stack_t, size, 0, best.t)
    for at in range(env * world.num_moving, (env + 1) * world.num_moving):
        seen = world.moving_instance[at] >= 0 and (exclude < 0 or world.moving_object[at] != exclude)
        if seen and _slab(world.moving_box, at, ray) <= best.t:
            instance = Instance(world.moving_instance[at], world.moving_model[at], world.moving_material[at])
            best = _cast_model(world, instance, _into(world.moving_inverse, at, ray), best, stack, stack_t)
            if ray.any_hit and best.instance >= 0:
                return best
    return best


@njit(error_model="numpy")  # called from two places, too large to be put in both
@no_type_check
def _cast_model(world, instance, ray, best, stack, stack_t):
    """The best hit after one instance, whose frame the ray is in."""
    shear = _shear(ray)
    code, size = world.model_root[instance.model], MAX_DEPTH
    while code != EMPTY:
        if code >= 0:
            code, size = _open(world, code, ray, best.t, stack, stack_t, size)
        else:
            for triangle in range(~code >> 4, (~code >> 4) + (~code & 15)):
                best = _test(world, instance, np.int32(triangle), ray, shear, best)
            code = np.int32(EMPTY)
        if ray.any_hit and best.instance >= 0:
            return best
        if code == EMPTY:
            code, size = _pop(stack, stack_t, size, MAX_DEPTH, best.t)
    return best


@compiled
@no_type_check
def _open(world, node, ray, limit, stack, stack_t, size):
    """Puts the farther of a node's children that the ray meets on the stack and returns the nearer, or EMPTY."""
    at = 2 * np.int64(node)
    near, far = world.node_child[at], world.node_child[at + 1]
    near_t, far_t = _slab(world.node_box, at, ray), _slab(world.node_box, at + 1, ray)
    if far_t < near_t:
        near, far, near_t, far_t = far, near, far_t, near_t
    if far_t <= limit and far != EMPTY:
        stack[size], stack_t[size] = far, far_t
        size += 1
    return near if near_t <= limit else np.int32(EMPTY), size


@compiled
@no_type_check
def _pop(stack, stack_t, size, base, limit):
    """The topmost code that still lies before the best hit, or EMPTY."""
    while size > base:
        size -= 1
        if stack_t[size] <= limit:
            return stack[size], size
    return np.int32(EMPTY), size


@compiled
@no_type_check
def _slab(box, index, ray):
    """Where the ray enters a box, at least t_min; infinity if it does not."""
    at = 6 * index
    x0, x1 = (box[at] - ray.ox) * ray.ix, (box[at + 3] - ray.ox) * ray.ix
    y0, y1 = (box[at + 1] - ray.oy) * ray.iy, (box[at + 4] - ray.oy) * ray.iy
    z0, z1 = (box[at + 2] - ray.oz) * ray.iz, (box[at + 5] - ray.oz) * ray.iz
    near = max(max(min(x0, x1), min(y0, y1)), max(min(z0, z1), ray.t_min))
    far = min(min(max(x0, x1), max(y0, y1)), max(z0, z1)) * FAR_SLACK
    return near if near <= far else np.float32(np.inf)


@compiled
@no_type_check
def _ray(ox, oy, oz, dx, dy, dz, t_min, mask, any_hit):
    return Ray(ox, oy, oz, dx, dy, dz, _inverse(dx), _inverse(dy), _inverse(dz), t_min, mask, any_hit)


@compiled
@no_type_check
def _inverse(x):
    return ONE / (x if abs(x) >= TINY else (TINY if x >= 0 else -TINY))


@compiled
@no_type_check
def _into(inverse, index, ray):
    """The ray in the frame of an instance."""
    at = 12 * index
    ox = inverse[at] * ray.ox + inverse[at + 1] * ray.oy + inverse[at + 2] * ray.oz + inverse[at + 3]
    oy = inverse[at + 4] * ray.ox + inverse[at + 5] * ray.oy + inverse[at + 6] * ray.oz + inverse[at + 7]
    oz = inverse[at + 8] * ray.ox + inverse[at + 9] * ray.oy + inverse[at + 10] * ray.oz + inverse[at + 11]
    dx = inverse[at] * ray.dx + inverse[at + 1] * ray.dy + inverse[at + 2] * ray.dz
    dy = inverse[at + 4] * ray.dx + inverse[at + 5] * ray.dy + inverse[at + 6] * ray.dz
    dz = inverse[at + 8] * ray.dx + inverse[at + 9] * ray.dy + inverse[at + 10] * ray.dz
    return _ray(ox, oy, oz, dx, dy, dz, ray.t_min, ray.mask, ray.any_hit)


class Shear(NamedTuple):
    """A ray prepared for triangles: the axis along which it is longest becomes z."""

    kx: np.int64
    ky: np.int64
    kz: np.int64
    ox: np.float32
    oy: np.float32
    oz: np.float32
    dx: np.float32
    dy: np.float32
    iz: np.float32


@compiled
@no_type_check
def _shear(ray):
    x, y, z = abs(ray.dx), abs(ray.dy), abs(ray.dz)
    if x >= y and x >= z:
        return Shear(1, 2, 0, ray.oy, ray.oz, ray.ox, ray.dy, ray.dz, ONE / ray.dx)
    if y >= z:
        return Shear(2, 0, 1, ray.oz, ray.ox, ray.oy, ray.dz, ray.dx, ONE / ray.dy)
    return Shear(0, 1, 2, ray.ox, ray.oy, ray.oz, ray.dx, ray.dy, ONE / ray.dz)


@compiled
@no_type_check
def _corner(triangle, at, shear):
    """A corner, sheared so that the ray runs along z through the origin; z counts in units of t."""
    z = (triangle[at + shear.kz] - shear.oz) * shear.iz
    x = (triangle[at + shear.kx] - shear.ox) - shear.dx * z
    return x, (triangle[at + shear.ky] - shear.oy) - shear.dy * z, z


@compiled
@no_type_check
def _test(world, instance, triangle, ray, shear, best):
    """The best hit after one triangle."""
    at = 9 * np.int64(triangle)
    ax, ay, az = _corner(world.triangle, at, shear)
    bx, by, bz = _corner(world.triangle, at + 3, shear)
    cx, cy, cz = _corner(world.triangle, at + 6, shear)
    # Edge functions; their signs come from comparing the products, which no multiply-add can spoil.
    u0, u1, v0, v1, w0, w1 = cx * by, cy * bx, ax * cy, ay * cx, bx * ay, by * ax
    positive = u0 >= u1 and v0 >= v1 and w0 >= w1
    if not positive and not (u0 <= u1 and v0 <= v1 and w0 <= w1):
        return best
    u, v, w = u0 - u1, v0 - v1, w0 - w1
    total = u + v + w
    if total == ZERO:
        return best
    t = (u * az + v * bz + w * cz) / total
    if not (t >= ray.t_min and t <= best.t):
        return best
    # Equal distances go to the lower instance and triangle, so that the order of traversal does not matter.
    if t == best.t and best.instance >= 0:
        lower = triangle < best.triangle if instance.number == best.instance else instance.number < best.instance
        if not lower:
            return best
    if world.material_mask[instance.material + world.triangle_slot[triangle]] & ray.mask == 0:
        return best
    front = positive == (shear.iz > ZERO)
    return Best(t, instance.number, triangle, v / total, w / total, front)
