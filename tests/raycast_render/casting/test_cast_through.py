"""Hits one after the other are those of one cast after the other, however they are batched."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from handmade import Furniture, shoebox, two_rooms
from jax.sharding import Mesh, NamedSharding, PartitionSpec
from soup import BACKENDS, f32, i32, in_jit, random_rays, random_soup

from home_mjx.bank.bank import HouseBank
from home_mjx.raycast_render.casting.cast import cast, cast_multi_hit
from home_mjx.raycast_render.scene.scene import make_scene
from home_mjx.raycast_render.scene.surface import object_ids
from home_mjx.raycast_render.scene.types import Scene

N, E, R, STEPS, SKIN = 400, 4, 24, 6, 1e-4
WHOLE, BY_ENV = PartitionSpec(), PartitionSpec("envs")


def one_by_one(scene, origin, direction, backend, steps=STEPS, t_min=0.0, t_max=np.inf, exclude=-1, mask=7):
    """The same by `cast` alone."""
    count = origin.shape[0]

    def step(carry, _):
        start, skipped, goes_on = carry
        end = jnp.where(goes_on, t_max, -1)
        hit = cast(scene, origin, direction, start, end, exclude=skipped, mask=mask, backend=backend)
        met, own = hit.instance >= 0, object_ids(scene, hit)
        start = jax.lax.stop_gradient(jnp.where(met, hit.t + jnp.float32(SKIN), start))
        return (start, jnp.where(met & (own >= 0), own, skipped), met), hit

    fill = lambda x, kind: jnp.broadcast_to(jnp.asarray(x, kind), count)  # noqa: E731
    start = fill(t_min, jnp.float32), fill(exclude, jnp.int32), jnp.ones(count, bool)
    _, hits = jax.lax.scan(step, start, length=steps)
    return jax.tree.map(lambda x: jnp.moveaxis(x, 0, 1), hits)


def through(scene, origin, direction, backend=None, steps=STEPS, **options):
    return cast_multi_hit(scene, origin, direction, steps, SKIN, **{"mask": 7} | options, backend=backend)


def assert_same(a, b):
    for x, y in zip(jax.tree.leaves(a), jax.tree.leaves(b), strict=True):
        np.testing.assert_array_equal(np.asarray(x).reshape(np.shape(y)), y)


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("steps", [1, STEPS])
def test_one_cast_after_the_other(backend, steps):
    rng = np.random.default_rng(steps)
    scene, (origin, direction) = random_soup(rng).scene(), random_rays(rng, N)
    options = {
        "t_min": f32(rng.uniform(0, 0.3, N)),
        "t_max": f32(rng.uniform(0.2, 3, N)),
        "exclude": i32(rng.integers(-1, 8, N)),
        "mask": i32(rng.choice([1, 2, 7], N)),
    }
    for given in ({}, options):
        args = scene, f32(origin), f32(direction), given
        expected, found = (
            in_jit(lambda s, o, d, g, run, **more: run(s, o, d, **g, **more), *args, run=run, **static)
            for run in (one_by_one, through)
            for static in [{"backend": backend, "steps": steps}]
        )
        assert found.t.shape == (N, steps)
        assert_same(found, expected)
        met = found.instance >= 0
        assert (np.isfinite(found.t) == met).all()
        assert set(met.sum(axis=1).tolist()) == set(range(steps + 1))


def test_any_shape_of_rays_one_origin_and_none():
    rng = np.random.default_rng(1)
    scene, (origin, direction) = random_soup(rng).scene(), random_rays(rng, 12)
    origin, direction = f32(origin[0]), f32(direction)
    each = jnp.broadcast_to(origin, direction.shape)
    expected = jax.jit(lambda scene: one_by_one(scene, each, direction, None))(scene)
    found = through(scene, origin, direction.reshape(3, 4, 3))
    assert found.t.shape == (3, 4, STEPS)
    assert_same(found, expected)
    assert through(scene, origin, direction[0]).t.shape == (STEPS,)
    assert through(scene, each[:0], direction[:0]).t.shape == (0, STEPS)
    with jax.disable_jit():
        np.testing.assert_array_equal(through(scene, origin, direction[:2], "xla").triangle, found.triangle[0, :2])
        assert_same(through(scene, origin, direction), expected)


def test_gradients_are_those_of_the_casts():
    rng = np.random.default_rng(2)
    scene, (origin, direction) = random_soup(rng).scene(), random_rays(rng, N)

    def total(look, shift, turn, moved):
        moving = scene.moving.replace(pose=scene.moving.pose.at[:, :, 3].add(moved))
        hit = look(scene.replace(moving=moving), f32(origin) + shift, f32(direction) + turn, None)
        return jnp.sum(jnp.where(hit.instance >= 0, hit.t + 2 * hit.u - hit.v, 0)) / N

    given = f32(np.zeros((N, 3))), f32(np.zeros((N, 3))), f32(np.zeros((scene.moving.instance.shape[0], 3)))
    expected, found = (
        jax.jit(jax.grad(lambda *x, look=look: total(look, *x), argnums=(0, 1, 2)))(*given)
        for look in (one_by_one, through)
    )
    for a, b in zip(found, expected, strict=True):
        assert np.any(b != 0)
        np.testing.assert_allclose(a, b, rtol=1e-4, atol=1e-5)


@pytest.fixture(scope="module")
def batch():
    """A bank, and houses, moving instances, origins and directions of E environments."""
    furniture = [Furniture((1.0, 1.0), mass=5.0), Furniture((-1.0, 1.0), (0.4, 0.8, 1.0))]
    bank = HouseBank.from_compiled([shoebox(furniture=furniture), two_rooms()])
    rng = np.random.default_rng(0)
    house, physics = i32(rng.integers(0, 2, E)), bank.physics
    agents, upright = f32(rng.uniform((-1, -1, 0), (1, 1, 2), size=(E, 2, 3))), f32([[1, 0, 0, 0]] * 2)
    place = lambda h, a: make_scene(bank, h, physics.body_pos[h], physics.body_quat[h], a, upright).moving  # noqa: E731
    origin = f32(rng.uniform(-1, 1, size=(E, R, 3)) * [2, 2, 1] + [0, 0, 1.5])
    return bank, (house, jax.jit(jax.vmap(place))(house, agents), origin, f32(rng.normal(size=(E, R, 3))))


def rows(bank, house, moving, origin, direction):
    return through(Scene(bank, house, moving), origin, direction, exclude=house)


per_env = jax.vmap(rows, (None, 0, 0, 0, 0))


@pytest.fixture(scope="module")
def expected(batch):
    """One environment after the other, by casts."""
    bank, args = batch
    look = jax.jit(lambda h, m, o, d: one_by_one(Scene(bank, h, m), o, d, None, exclude=h))
    hits = [look(*jax.tree.map(lambda x, i=i: x[i], args)) for i in range(E)]
    return jax.tree.map(lambda *x: np.stack([np.asarray(y) for y in x]), *hits)


def test_any_nesting_gives_the_same_bits(batch, expected):
    bank, args = batch
    assert_same(jax.jit(per_env)(bank, *args), expected)
    each = jax.vmap(jax.vmap(rows, (None, None, None, 0, 0)), (None, 0, 0, 0, 0))
    assert_same(jax.jit(each)(bank, *args), expected)
    outer = jax.vmap(jax.vmap(rows, (None, 0, 0, 0, 0)), (None, None, None, 1, 1), out_axes=1)
    assert_same(jax.jit(outer)(bank, *args), expected)
    scanned = jax.jit(lambda b, a: jax.lax.scan(lambda c, x: (c, rows(b, *x)), 0, a)[1])
    assert_same(scanned(bank, args), expected)
    banks = jax.tree.map(lambda x: jnp.stack([x] * E), bank)
    assert_same(jax.jit(jax.vmap(rows))(banks, *args), expected)


def test_over_devices(batch, expected):
    bank, args = batch
    devices = jax.devices()[:E]
    mesh = Mesh(np.array(devices), ("envs",))
    mapped = jax.shard_map(per_env, mesh=mesh, in_specs=(WHOLE, *[BY_ENV] * 4), out_specs=BY_ENV)
    assert_same(jax.jit(mapped)(bank, *args), expected)
    everywhere, by_env = (NamedSharding(mesh, spec) for spec in (WHOLE, BY_ENV))
    placed = jax.device_put(bank, everywhere), *jax.device_put(args, by_env)
    program = jax.jit(per_env).lower(*placed).compile()
    assert not [word for word in ("all-gather", "all-reduce", "all-to-all") if word in program.as_text()]
    assert_same(program(*placed), expected)
