"""Look-ups in the navigation grids on the device, against the compiled houses on the host."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from handmade import Furniture, shoebox, two_rooms

from home_mjx.bank.bank import HouseBank
from home_mjx.navigation.grid import geodesic_distance, random_position, room_below
from home_mjx.schema.compiled import FIELD_UNIT

CHEST = Furniture((1.0, 0.5), size=(2.0, 1.0, 1.0))


@pytest.fixture(scope="module")
def houses():
    return [two_rooms(), shoebox(furniture=[CHEST])]


@pytest.fixture(scope="module")
def bank(houses) -> HouseBank:
    return HouseBank.from_compiled(houses)


def strictly(function, *args):
    with jax.numpy_dtype_promotion("strict"), jax.numpy_rank_promotion("raise"):
        return jax.jit(function)(*args)


def test_distances_at_cell_centres_are_those_of_the_field(bank, houses):
    for h, house in enumerate(houses):
        n = house.navigation
        places = n.cell_coords[:: len(n.cell_coords) // 50]
        points = np.c_[(places[:, :0:-1] + 0.5) * n.cell + n.origin, n.height[:: len(n.cell_coords) // 50]].astype(
            np.float32
        )
        found = strictly(jax.vmap(lambda p, h=h: geodesic_distance(bank, jnp.int32(h), None, p)), points)
        wanted = np.stack([n.distance(g)[tuple(places.T)] for g in range(len(n.goal))], axis=1)
        # The way over a neighbour's centre is as long, or longer by what rounding to FIELD_UNIT takes.
        np.testing.assert_allclose(found[:, : len(n.goal)], wanted, atol=2 * FIELD_UNIT)
        one = strictly(jax.vmap(lambda p, h=h: geodesic_distance(bank, jnp.int32(h), jnp.int32(3), p)), points)
        np.testing.assert_array_equal(one, found[:, 3])


def test_rooms_of_points(bank):
    points = np.array([[-2, 0, 0], [2, 0, 0.8], [0.0, 9, 0]], np.float32)
    assert strictly(jax.vmap(lambda p: room_below(bank, jnp.int32(0), p)), points).tolist() == [0, 1, -1]


def test_random_positions_are_free_and_uniform(bank, houses):
    """The chest stops agents, and either side of the room gets its share by area (binomial, 5 sigma)."""
    n, count = houses[1].navigation, 4000
    keys = jax.random.split(jax.random.key(0), count)
    points = np.asarray(strictly(jax.vmap(lambda k: random_position(bank, jnp.int32(1), k)), keys))
    gap = np.maximum(abs(points[:, :2] - CHEST.position) - np.array(CHEST.size[:2]) / 2, 0)
    assert np.linalg.norm(gap, axis=1).min() >= 0.1
    assert (abs(points[:, :2]) <= np.array([3.0, 2.5]) - 0.1).all()
    centres = (n.cell_coords[:, :0:-1] + 0.5) * n.cell + n.origin
    for axis in (0, 1):
        for at in (-1.0, 0.0, 1.0):
            share = (centres[:, axis] > at).mean()
            sigma = np.sqrt(share * (1 - share) / count)
            edge = (abs(centres[:, axis] - at) < n.cell / 2).mean()
            assert abs((points[:, axis] > at).mean() - share) < 5 * sigma + edge
    assert len(np.unique(points[:, :2], axis=0)) > 0.99 * count
