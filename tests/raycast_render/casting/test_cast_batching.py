"""However rays and environments are batched, mapped or spread over devices, the hits are the same bits."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from handmade import Furniture, shoebox, two_rooms
from jax.sharding import Mesh, NamedSharding, PartitionSpec

from home_mjx.bank.bank import HouseBank
from home_mjx.raycast_render.casting.cast import cast, occluded
from home_mjx.raycast_render.scene.scene import make_scene
from home_mjx.raycast_render.scene.types import Scene

E, R = 8, 64


@pytest.fixture(scope="module")
def bank():
    furniture = [
        Furniture((1.0, 1.0), mass=5.0),
        Furniture((-1.0, 1.0), (0.4, 0.8, 1.0)),
        Furniture((-1.0, -1.0), mass=9.0),
    ]
    return HouseBank.from_compiled([shoebox(furniture=furniture), two_rooms()])


@pytest.fixture(scope="module")
def batch(bank):
    """House, moving instances, ray origins and directions of E environments."""
    rng = np.random.default_rng(0)
    house = jnp.asarray(rng.integers(0, 2, E), jnp.int32)
    agents = jnp.asarray(rng.uniform((-1, -1, 0), (1, 1, 2), size=(E, 2, 3)), jnp.float32)
    upright = jnp.tile(jnp.array([[1.0, 0, 0, 0]], jnp.float32), (2, 1))
    shift = jnp.asarray(rng.normal(size=(E, 1, 3)) * 0.1, jnp.float32)

    def place(house, agents, shift):
        physics = bank.physics
        return make_scene(
            bank, house, physics.body_pos[house] + shift, physics.body_quat[house], agents, upright
        ).moving

    moving = jax.jit(jax.vmap(place))(house, agents, shift)
    origin = rng.uniform(-1, 1, size=(E, R, 3)) * [2, 2, 1] + [0, 0, 1.5]
    direction = rng.normal(size=(E, R, 3))
    return house, moving, jnp.asarray(origin, jnp.float32), jnp.asarray(direction, jnp.float32)


def rows(bank, house, moving, origin, direction):
    """All rays of one environment in one call."""
    return cast(Scene(bank, house, moving), origin, direction)


@pytest.fixture(scope="module")
def expected(bank, batch):
    """One environment after the other, one call each."""
    one = jax.jit(rows)
    hits = [one(bank, *jax.tree.map(lambda x, i=i: x[i], batch)) for i in range(E)]
    stacked = jax.tree.map(lambda *x: np.stack([np.asarray(y) for y in x]), *hits)
    assert len(np.unique(stacked.instance)) == 6, "rays must meet the house, its furniture and both agents"
    return stacked


def assert_same(a, b):
    for x, y in zip(jax.tree.leaves(a), jax.tree.leaves(b), strict=True):
        np.testing.assert_array_equal(np.asarray(x).reshape(np.shape(y)), y)


per_env = jax.vmap(rows, (None, 0, 0, 0, 0))


def test_vmap_over_environments(bank, batch, expected):
    assert_same(jax.jit(per_env)(bank, *batch), expected)


def test_vmap_over_rays_within_vmap_over_environments(bank, batch, expected):
    each_ray = jax.vmap(jax.vmap(rows, (None, None, None, 0, 0)), (None, 0, 0, 0, 0))
    assert_same(jax.jit(each_ray)(bank, *batch), expected)


def test_vmap_over_environments_within_vmap_over_rays(bank, batch, expected):
    each_ray = jax.vmap(jax.vmap(rows, (None, 0, 0, 0, 0)), (None, None, None, 1, 1), out_axes=1)
    assert_same(jax.jit(each_ray)(bank, *batch), expected)


def test_vmap_in_three_levels_with_axes_elsewhere(bank, batch, expected):
    house, moving, origin, direction = batch
    split = jax.tree.map(lambda x: x.reshape(2, E // 2, *x.shape[1:]), (house, moving))
    rays = [jnp.moveaxis(x.reshape(2, E // 2, R, 3), 1, 3) for x in (origin, direction)]  # (2, R, 3, E / 2)
    inner = jax.vmap(jax.vmap(rows, (None, None, None, 0, 0)), (None, 0, 0, 2, 2))
    assert_same(jax.jit(jax.vmap(inner, (None, 0, 0, 0, 0)))(bank, *split, *rays), expected)


def test_one_pose_for_all_and_one_ray_for_all(bank, batch):
    house, moving, origin, direction = batch
    first = jax.tree.map(lambda x: x[0], (house, moving))
    rays = origin[0], direction[0]
    by_house = jax.jit(jax.vmap(rows, (None, 0, None, None, None)))(bank, house, first[1], *rays)
    by_pose = jax.jit(jax.vmap(rows, (None, None, 0, None, None)))(bank, first[0], moving, *rays)
    for i in range(E):
        own_house, own_moving = jax.tree.map(lambda x, i=i: x[i], (house, moving))
        assert_same(jax.tree.map(lambda x, i=i: x[i], by_house), rows(bank, own_house, first[1], *rays))
        assert_same(jax.tree.map(lambda x, i=i: x[i], by_pose), rows(bank, first[0], own_moving, *rays))


def test_a_permuted_batch_gives_permuted_hits_whatever_the_neighbours_do(bank, batch, expected):
    order = np.random.default_rng(1).permutation(E)
    order[0] = order[1]  # and one environment is replaced by another
    got = jax.jit(per_env)(bank, *jax.tree.map(lambda x: x[order], batch))
    assert_same(got, jax.tree.map(lambda x: x[order], expected))


def test_batches_of_none(bank, batch):
    house, moving, origin, direction = batch
    none = jax.tree.map(lambda x: x[:0], (house, moving, origin, direction))
    hits = jax.jit(jax.vmap(rows, (None, 0, 0, 0, 0)))(bank, *none)
    assert hits.t.shape == hits.instance.shape == (0, R)
    scene = Scene(bank, house[0], jax.tree.map(lambda x: x[0], moving))
    hidden = jax.vmap(lambda o, d: occluded(scene, o, d))(origin[0, :0], direction[0, :0])
    assert hidden.shape == (0,)
    assert cast(scene, origin[0, :0], direction[0, :0]).t.shape == (0,)


def test_scan(bank, batch, expected):
    def step(carry, args):
        hit = rows(bank, *args)
        return carry + jnp.sum(hit.triangle), hit

    assert_same(jax.jit(lambda b: jax.lax.scan(step, 0, b)[1])(batch), expected)


def test_banks_of_their_own_go_one_by_one(bank, batch, expected):
    banks = jax.tree.map(lambda x: jnp.stack([x] * 2), bank)
    few = jax.tree.map(lambda x: x[:2], batch)
    hits = jax.jit(jax.vmap(rows))(banks, *few)
    assert_same(hits, jax.tree.map(lambda x: x[:2], expected))


@pytest.mark.parametrize("backend", ["xla", "cpu"])
def test_shard_map(bank, batch, expected, backend):
    mesh = Mesh(np.array(jax.devices("cpu")[:2]), ("envs",))
    spread, whole = PartitionSpec("envs"), PartitionSpec()
    env = lambda b, h, m, o, d: cast(Scene(b, h, m), o, d, backend=backend)  # noqa: E731
    mapped = jax.shard_map(
        jax.vmap(env, (None, 0, 0, 0, 0)), mesh=mesh, in_specs=(whole, *[spread] * 4), out_specs=spread
    )
    hits = jax.jit(mapped)(bank, *batch)
    np.testing.assert_allclose(hits.t, expected.t, rtol=1e-5)
    if backend == "cpu":
        assert_same(hits, expected)


@pytest.mark.parametrize("backend", ["xla", "cpu"])
def test_jit_on_sharded_inputs_gathers_nothing(bank, batch, expected, backend):
    mesh = Mesh(np.array(jax.devices("cpu")[:2]), ("envs",))
    spread, whole = NamedSharding(mesh, PartitionSpec("envs")), NamedSharding(mesh, PartitionSpec())
    args = jax.device_put(bank, whole), *jax.device_put(batch, spread)
    env = lambda b, h, m, o, d: cast(Scene(b, h, m), o, d, backend=backend)  # noqa: E731
    program = jax.jit(jax.vmap(env, (None, 0, 0, 0, 0))).lower(*args).compile()
    text = program.as_text()
    assert not [word for word in ("all-gather", "all-reduce", "all-to-all", "collective") if word in text]
    hits = program(*args)
    assert hits.t.sharding.is_equivalent_to(spread, 2)
    np.testing.assert_allclose(hits.t, expected.t, rtol=1e-5)
