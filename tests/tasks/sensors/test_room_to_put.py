"""Where hands put things down: where these stay."""

import jax.numpy as jnp
import numpy as np

from home_mjx.physics.kinematic.footprints import Footprints
from home_mjx.tasks.sensors.reaching import room_at

PLACED = 0.03  # [m], from the spot at which hands let go
HALF, TOP, TURN = (0.17, 0.6), 1.35, 0.5  # a narrow shelf [m], turned [rad]
NARROW = 0.03  # [m]


def spots_of(half):
    """Points along the shelf's short axis, and on how many of them it bears something."""
    shelf = (0.0, 0.0, np.cos(TURN), np.sin(TURN), *half, 0.05, TOP)
    boxes = Footprints(*(jnp.array([x], jnp.float32) for x in shelf))
    across = np.linspace(-0.2, 0.2, 401)
    plan = jnp.asarray(np.stack([across * np.cos(TURN), across * np.sin(TURN)], axis=1), jnp.float32)
    bears, apart = room_at(boxes, plan, jnp.full(len(across), TOP, jnp.float32), jnp.float32(0.1))
    assert np.asarray(apart).all()
    return across, np.asarray(bears)


def test_nothing_is_put_so_near_an_edge_that_it_may_fall():
    across, bears = spots_of(HALF)
    assert bears[abs(across) < HALF[0] - 0.06].all()
    assert not bears[abs(across) > HALF[0] - PLACED - 0.01].any()


def test_what_is_narrow_bears_things_in_its_middle():
    across, bears = spots_of((NARROW, HALF[1]))
    assert bears[abs(across) < NARROW / 4].all()
    assert not bears[abs(across) > 0.6 * NARROW].any()
