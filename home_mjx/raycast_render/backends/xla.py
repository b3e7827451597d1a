"""The reference backend: two-level traversal in plain JAX, on any platform.

All rays of a chunk step together: they descend until no ray is at a node, then all test triangles and enter or leave
instances. A ray keeps a stack of BVH codes. Inside an instance it is stored in that instance's frame. It leaves the
instance when the stack has the same size as on entry.

Sources: S. Woop, C. Benthin, I. Wald, "Watertight ray/triangle intersection", JCGT 2(1), 2013; T. Ize, "Robust BVH ray
traversal", JCGT 2(2), 2013.
"""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
from jax import lax
from jaxtyping import Array, Bool, Float, Int

from home_mjx.bank.records import Geometry
from home_mjx.bank.records.geometry import CUTOUT_SHIFT
from home_mjx.core.native.partition import varying_false
from home_mjx.raycast_render.backends.multi_hit_loop import cast_multi_hit_by_loop
from home_mjx.raycast_render.scene.types import FAR_SLACK, MISS, TINY, DynamicInstances, RawHit, RayQuery, Rays
from home_mjx.schema.compiled import EMPTY_LEAF, MAX_DEPTH, RayKind

TRIANGLES_PER_TEST = 4  # triangles tested at once
WORD_BITS = 32  # texels per word of `Geometry.cutout`
MAX_CPU_CHUNK = 1 << 12  # rays in lock step on CPUs, whose state fits into the cache
MAX_CHUNK = 1 << 20  # rays in lock step on accelerators, enough to fill them; about 1 kB each


class _Best(NamedTuple):
    """Best hits up to now; before a hit, t is the end of the ray and ids are -1."""

    t: Float[Array, " n"]
    instance: Int[Array, " n"]
    triangle: Int[Array, " n"]
    u: Float[Array, " n"]
    v: Float[Array, " n"]
    front: Bool[Array, " n"]


class _State(NamedTuple):
    """State of the traversal, one entry per ray."""

    code: Int[Array, " n"]  # tree code at which the ray is, EMPTY when it is done
    stack: Int[Array, "n s"]
    size: Int[Array, " n"]
    base: Int[Array, " n"]  # size of the stack on entering the current instance
    instance: Int[Array, " n"]  # -1 while in the top tree
    material: Int[Array, " n"]  # first material row of the instance
    origin: Float[Array, "n 3"]  # in the current frame
    direction: Float[Array, "n 3"]
    best: _Best


class _Operands(NamedTuple):
    """Constant inputs of the traversal."""

    geometry: Geometry
    house: Int[Array, " e"]
    moving: DynamicInstances
    any_hit: bool
    env: Int[Array, " n"]
    rays: Rays


def cast_xla(
    geometry: Geometry, house: Int[Array, " e"], moving: DynamicInstances, rays: Rays, query: RayQuery
) -> RawHit:
    """Cast rays (e r ...) in plain JAX; return hits (e r), or (e r steps) for `num_hits`. Misses: t `MISS`, ids -1."""
    if query.num_hits:
        return cast_multi_hit_by_loop(cast_xla, geometry, house, moving, rays, query)
    rays, shape = rays.expanded(), rays.shape
    total = rays.t_min.size
    chunk = min(MAX_CPU_CHUNK if jax.default_backend() == "cpu" else MAX_CHUNK, max(total, 1))
    count = -(-total // chunk)

    def split(x: Array, fill: float = 0) -> Array:
        """Reshape rays (e r ...) to whole chunks (chunk ray ...), padded with `fill`."""
        flat = x.reshape(total, *x.shape[2:])
        widths = [(0, count * chunk - total)] + [(0, 0)] * (flat.ndim - 1)
        return jnp.pad(flat, widths, constant_values=fill).reshape(count, chunk, *flat.shape[1:])

    # The loops' carry is derived from this value, so that it is device-varying under `shard_map`.
    zero = varying_false(house, moving, rays).astype(jnp.int32)
    env = lax.broadcasted_iota(jnp.int32, shape, 0) + zero
    # Padding rays end before they begin: t_min 1, t_max 0.
    chunks = jax.tree.map(split, rays).replace(t_min=split(rays.t_min, 1))
    hits = lax.map(lambda c: _cast_chunk(_Operands(geometry, house, moving, query.any_hit, *c)), (split(env), chunks))
    return RawHit(*(x.reshape(count * chunk)[:total].reshape(shape) for x in hits))


def _cast_chunk(world: _Operands) -> RawHit:
    """Traverse until every ray is done; return the hits of one chunk of rays."""
    state = lax.while_loop(
        lambda s: jnp.any(s.code != EMPTY_LEAF), lambda s: _visit_leaves(world, _descend(world, s)), _start(world)
    )
    best = state.best
    missed = best.instance < 0
    return RawHit(jnp.where(missed, MISS, best.t), *best[1:])


def _start(world: _Operands) -> _State:
    """Return the first state: rays at their house's top-level BVH; stacks hold moving instances whose box they hit."""
    n, slots, rays = world.env.shape[0], world.moving.instance.shape[1], world.rays
    zero = jnp.zeros_like(world.env)
    none, weight = zero - 1, zero.astype(jnp.float32)
    alive = rays.t_min <= rays.t_max

    def add(slot: Any, carry: tuple[Array, Array]) -> tuple[Array, Array]:
        """Push a moving instance onto the stacks of the rays that hit its box."""
        slot = jnp.asarray(slot, jnp.int32)  # a Python number if jit is disabled
        near = _slab(world.moving.box[world.env, slot].reshape(n, 6), rays.origin, rays.direction, rays.t_min)
        meets = alive & (near <= rays.t_max) & (world.moving.instance[world.env, slot] >= 0)
        return _push(*carry, jnp.where(meets, _leaf_code(world.geometry.instance_model.shape[1] + slot, 1), EMPTY_LEAF))

    stack = jnp.broadcast_to(none[:, None], (n, slots + 2 * MAX_DEPTH + 2))
    stack, size = lax.fori_loop(0, slots, add, (stack, zero))
    code = jnp.where(alive, world.geometry.house_root[world.house[world.env]], EMPTY_LEAF)
    best = _Best(jnp.minimum(rays.t_max, MISS) + weight, none, none, weight, weight, zero > 0)
    frame = rays.origin + weight[:, None], rays.direction + weight[:, None]
    return _State(code, stack, size, zero, none, zero, *frame, best)


def _descend(world: _Operands, state: _State) -> _State:
    """Descend until no ray is at a node: each moves to the nearer child that it hits, pushing the other, or pops."""

    def step(state: _State) -> _State:
        """Move the rays that are at a node to a child or up their stack."""
        is_node = state.code >= 0
        near, far = _children(world, state, jnp.where(is_node, state.code, 0))
        stack, size = _push(state.stack, state.size, jnp.where(is_node, far, EMPTY_LEAF))
        state = state._replace(stack=stack, size=size, code=jnp.where(is_node, near, state.code))
        return _pop(state, is_node & (near == EMPTY_LEAF))

    return lax.while_loop(lambda s: jnp.any(s.code >= 0), step, state)


def _visit_leaves(world: _Operands, state: _State) -> _State:
    """Test up to four triangles per ray at a leaf, leave finished instances, enter new ones; any-hits end their ray."""
    first, count = ~state.code >> 4, ~state.code & 15
    at_triangles = (state.instance >= 0) & (state.code != EMPTY_LEAF)
    best = _test_triangles(world, state, jnp.where(at_triangles, first, 0), jnp.where(at_triangles, count, 0))
    rest = jnp.where(
        count > TRIANGLES_PER_TEST, _leaf_code(first + TRIANGLES_PER_TEST, count - TRIANGLES_PER_TEST), EMPTY_LEAF
    )
    state = state._replace(best=best, code=jnp.where(at_triangles, rest, state.code))
    state = _leave(world, _pop(state, at_triangles & (rest == EMPTY_LEAF)))
    if world.any_hit:
        state = state._replace(code=jnp.where(best.instance >= 0, EMPTY_LEAF, state.code))
    return _enter(world, state)


def _leaf_code(first: Int[Array, "..."], count: Int[Array, "..."] | int) -> Int[Array, "..."]:
    """Return the code of a leaf with `count`, at most 15, primitives from `first` on."""
    return ~(first << 4 | count)


def _push(
    stack: Int[Array, "n s"], size: Int[Array, " n"], code: Int[Array, " n"]
) -> tuple[Int[Array, "n s"], Int[Array, " n"]]:
    """Return stacks and sizes after each ray pushed its code; `EMPTY_LEAF` is not pushed.

    A code beyond the end of its stack is lost, but counts in its size.
    """
    n, depth = stack.shape
    place = jnp.where(code == EMPTY_LEAF, depth, size)
    return stack.at[jnp.arange(n), place].set(code, mode="drop"), size + (code != EMPTY_LEAF).astype(jnp.int32)


def _pop(state: _State, wanted: Bool[Array, " n"]) -> _State:
    """Pop the stack of `wanted` rays, down to `base`; they get `EMPTY_LEAF` if nothing is left in their frame."""
    there = wanted & (state.size > state.base)
    size = jnp.where(there, state.size - 1, state.size)
    code = jnp.where(there, jnp.take_along_axis(state.stack, size[:, None], axis=1)[:, 0], EMPTY_LEAF)
    return state._replace(size=size, code=jnp.where(wanted, code, state.code))


def _leave(world: _Operands, state: _State) -> _State:
    """Bring rays that have finished their instance back to the world frame, where they pop their stack."""
    done = (state.instance >= 0) & (state.code == EMPTY_LEAF)
    state = state._replace(
        instance=jnp.where(done, -1, state.instance),
        base=jnp.where(done, 0, state.base),
        origin=jnp.where(done[:, None], world.rays.origin, state.origin),
        direction=jnp.where(done[:, None], world.rays.direction, state.direction),
    )
    return _pop(state, done)


def _enter(world: _Operands, state: _State) -> _State:
    """Transform rays at a leaf of the top-level BVH into the frame of its first instance.

    Codes count a house's instances, then the moving ones. Other instances of the leaf are pushed. Rays that
    exclude the instance's object pop their stack instead.
    """
    geometry, moving, house = world.geometry, world.moving, world.house[world.env]
    index, count = ~state.code >> 4, ~state.code & 15
    arrives = (state.instance < 0) & (state.code < 0) & (state.code != EMPTY_LEAF)
    rest = jnp.where(arrives & (count > 1), _leaf_code(index + 1, count - 1), EMPTY_LEAF)
    stack, size = _push(state.stack, state.size, rest)
    fixed = jnp.clip(index, 0, geometry.instance_model.shape[1] - 1)
    slot = jnp.clip(index - geometry.instance_model.shape[1], 0, moving.instance.shape[1] - 1)
    moves = index >= geometry.instance_model.shape[1]

    def pick(moved: Array, static: Array) -> Array:
        """Return each ray's row of `moved` or `static`, by the kind of its instance."""
        chosen = moves.reshape(-1, *[1] * (moved.ndim - 2))
        return jnp.where(chosen, moved[world.env, slot], static[house, fixed])

    number = jnp.where(moves, moving.instance[world.env, slot], fixed)
    object_id = pick(moving.object_id, geometry.instance_object)
    enters = arrives & ((world.rays.exclude < 0) | (object_id != world.rays.exclude))
    inverse = pick(moving.inverse, geometry.instance_inverse)
    origin = _apply(inverse, state.origin) + inverse[:, :, 3]
    direction = _apply(inverse, state.direction)
    root = geometry.model_root[pick(moving.model, geometry.instance_model)]
    state = state._replace(
        code=jnp.where(enters, root, state.code),
        stack=stack,
        size=size,
        base=jnp.where(enters, size, state.base),
        instance=jnp.where(enters, number, state.instance),
        material=jnp.where(enters, pick(moving.material, geometry.instance_material), state.material),
        origin=jnp.where(enters[:, None], origin, state.origin),
        direction=jnp.where(enters[:, None], direction, state.direction),
    )
    return _pop(state, arrives & ~enters)


def _apply(matrix: Float[Array, "n 3 4"], vector: Float[Array, "n 3"]) -> Float[Array, "n 3"]:
    """Apply the linear part of one matrix per ray, in full float32 precision on accelerators."""
    # Not a matrix product: accelerators may compute those with reduced precision.
    return jnp.sum(matrix[:, :, :3] * vector[:, None, :], axis=2)


def _children(world: _Operands, state: _State, node: Int[Array, " n"]) -> tuple[Int[Array, " n"], Int[Array, " n"]]:
    """Return the codes of both children of each ray's node, nearer first, in a tie child 0.

    Children that are missed or behind the ray's hit, and nodes that do not come after their parent, are `EMPTY_LEAF`.
    """
    box, child = world.geometry.node_box[node], world.geometry.node_child[node]
    limits = world.rays.t_min, state.best.t
    a, b = (_slab(box[:, side], state.origin, state.direction, limits[0]) for side in range(2))
    behind = (child < 0) | (child > node[:, None])  # holds in every built tree; prevents endless loops in invalid ones
    code_a = jnp.where((a <= limits[1]) & behind[:, 0], child[:, 0], EMPTY_LEAF)
    code_b = jnp.where((b <= limits[1]) & behind[:, 1], child[:, 1], EMPTY_LEAF)
    return jnp.where(a <= b, code_a, code_b), jnp.where(a <= b, code_b, code_a)


def _slab(
    box: Float[Array, "n 6"], origin: Float[Array, "n 3"], direction: Float[Array, "n 3"], t_min: Float[Array, " n"]
) -> Float[Array, " n"]:
    """Return t at which rays enter boxes (minimum, maximum), one box per ray, at least t_min; infinity on a miss.

    A box that is only touched is hit.
    """
    safe = jnp.where(jnp.abs(direction) < TINY, jnp.where(direction < 0, -TINY, TINY), direction)
    low, high = (box[:, :3] - origin) / safe, (box[:, 3:] - origin) / safe
    near = jnp.maximum(jnp.max(jnp.minimum(low, high), axis=1), t_min)
    far = jnp.min(jnp.maximum(low, high), axis=1) * FAR_SLACK
    return jnp.where(near <= far, near, jnp.inf)


def _test_triangles(world: _Operands, state: _State, first: Int[Array, " n"], count: Int[Array, " n"]) -> _Best:
    """Return the best hits updated with `count` triangles from `first`, four at most, unless masked or cut out.

    Of a higher `count`, the others are left out. Hits count from t_min on. At equal t, the lower instance and then the
    lower triangle counts.
    """
    geometry, rays, best = world.geometry, world.rays, state.best
    step = jnp.arange(TRIANGLES_PER_TEST, dtype=jnp.int32)[None]
    triangle = jnp.minimum(first[:, None] + step, geometry.triangle.shape[0] - 1)
    t, u, v, front = _intersect(geometry.triangle[triangle], state.origin, state.direction)
    material = geometry.material_mask[state.material[:, None] + geometry.triangle_slot[triangle]]
    stops = material & rays.mask[:, None] & int(RayKind.ALL)
    valid = (step < count[:, None]) & (t >= rays.t_min[:, None]) & (t <= best.t[:, None]) & (stops != 0)
    may_pass = valid & (material >> CUTOUT_SHIFT > 0) & (stops & int(RayKind.SOUND) == 0)
    valid = lax.cond(  # most leaves have no cut-outs
        jnp.any(may_pass),
        lambda: valid & ~(may_pass & _is_cut_out(geometry, triangle, u, v, material >> CUTOUT_SHIFT)),
        lambda: valid,
    )
    nearest = jnp.argmin(jnp.where(valid, t, jnp.inf), axis=1, keepdims=True)

    def take(x: Array) -> Array:
        """Return each ray's value for its nearest triangle."""
        return jnp.take_along_axis(x, nearest, axis=1)[:, 0]

    found = _Best(take(t), state.instance, take(triangle), take(u), take(v), take(front))
    # Ties go to the lower instance and triangle, so that the order of traversal does not matter.
    same = found.instance == best.instance
    lower = jnp.where(same, found.triangle < best.triangle, found.instance < best.instance)
    wins = take(valid) & ((found.t < best.t) | (best.instance < 0) | lower)
    return _Best(*(jnp.where(wins, new, old) for new, old in zip(found, best, strict=True)))


def _is_cut_out(
    geometry: Geometry,
    triangle: Int[Array, "n k"],
    u: Float[Array, "n k"],
    v: Float[Array, "n k"],
    layer: Int[Array, "n k"],
) -> Bool[Array, "n k"]:
    """Return whether the texel around weights u, v of corners 1, 2 is cut out; `layer` counts from 1, clipped.

    Texture coordinates outside [0, 1) repeat.
    """
    uv, edge = geometry.triangle_uv[triangle], geometry.cutout.shape[1]
    weight = jnp.stack([1 - u - v, u, v], axis=-1)

    def texel(axis: int) -> Int[Array, "n k"]:
        """Return the texel index, 0 .. edge - 1, along u (axis 0) or v (1)."""
        x = jnp.sum(weight * uv[..., axis], axis=-1)
        place = (x - jnp.floor(x)) * edge
        return jnp.where(place >= 0, jnp.minimum(place.astype(jnp.int32), edge - 1), 0)  # NaN is texel 0

    column, row = texel(0), edge - 1 - texel(1)
    word = geometry.cutout[jnp.clip(layer - 1, 0, geometry.cutout.shape[0] - 1), row, column // WORD_BITS]
    return (word >> (column % WORD_BITS).astype(jnp.uint32)) & 1 == 1


def _intersect(
    triangle: Float[Array, "n k 3 3"], origin: Float[Array, "n 3"], direction: Float[Array, "n 3"]
) -> tuple[Float[Array, "n k"], Float[Array, "n k"], Float[Array, "n k"], Bool[Array, "n k"]]:
    """Intersect k triangles per ray, from both sides; edges count, triangles parallel to the ray do not.

    Returns:
        t (infinity on a miss, maybe negative); weights of corners 1, 2 and whether the front was hit (miss: undefined).
    """
    axis = jnp.argmax(jnp.abs(direction), axis=1)[:, None, None, None]
    ray = _along_z(direction[:, None, None, :], axis)
    corner = _along_z(triangle - origin[:, None, None, :], axis)
    z = corner[..., 2] / ray[..., 2]
    x, y = corner[..., 0] - ray[..., 0] * z, corner[..., 1] - ray[..., 1] * z
    # Edge functions, each the difference of two products. Their signs come from a comparison of the products.
    # Compilers fuse the difference into a multiply-add, which can have the same sign on both sides of a shared edge.
    plus = jnp.roll(x, 1, axis=2) * jnp.roll(y, -1, axis=2)
    minus = jnp.roll(y, 1, axis=2) * jnp.roll(x, -1, axis=2)
    positive, negative = jnp.all(plus >= minus, axis=2), jnp.all(plus <= minus, axis=2)
    edge = jnp.where(plus == minus, 0, plus - minus)
    edge = jnp.where(positive[..., None], jnp.maximum(edge, 0), jnp.minimum(edge, 0))
    total = jnp.sum(edge, axis=2)
    meets = (positive | negative) & (total != 0)
    weight = edge / jnp.where(meets, total, 1)[..., None]
    t = jnp.where(meets, jnp.sum(weight * z, axis=2), jnp.inf)
    return t, weight[..., 1], weight[..., 2], positive == (ray[..., 0, 2] > 0)


def _along_z(vector: Float[Array, "n k c 3"], axis: Int[Array, "n 1 1 1"]) -> Float[Array, "n k c 3"]:
    """Permute the last axis (x, y, z) cyclically so that component `axis` (0, 1 or 2) of each ray becomes z."""
    return jnp.where(axis == 2, vector, jnp.where(axis == 0, jnp.roll(vector, -1, axis=-1), jnp.roll(vector, 1, -1)))
