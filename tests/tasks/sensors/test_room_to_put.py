"""Where hands put things down: where these stay."""

import jax.numpy as jnp
import numpy as np

from home_mjx.physics.kinematic.footprints import Footprints
from home_mjx.tasks.sensors.reachability import check_placement

HALF, TOP, TURN = (0.17, 0.6), 1.35, 0.5  # a narrow shelf [m], turned [rad]
RADIUS = 0.1  # [m]
NARROW = 0.03  # [m]


def spots_of(half):
    """Points along the shelf's short axis, and on which of them it bears something."""
    shelf = (0.0, 0.0, np.cos(TURN), np.sin(TURN), *half, 0.05, TOP)
    boxes = Footprints(*(jnp.array([x], jnp.float32) for x in shelf))
    across = np.linspace(-0.2, 0.2, 401)
    plan = jnp.asarray(np.stack([across * np.cos(TURN), across * np.sin(TURN)], axis=1), jnp.float32)
    bears, apart = check_placement(boxes, plan, jnp.full(len(across), TOP, jnp.float32), jnp.float32(RADIUS))
    assert np.asarray(apart).all()
    return across, np.asarray(bears)


def test_nothing_is_put_over_an_edge():
    across, bears = spots_of(HALF)
    rim = abs(across) + RADIUS - HALF[0]  # [m], how far it would reach over the edge
    assert bears[rim < -0.001].all()
    assert not bears[rim > 0.001].any()


def test_what_is_narrower_bears_things_in_its_middle():
    across, bears = spots_of((NARROW, HALF[1]))
    assert bears[abs(across) < 0.2 * NARROW].all()
    assert not bears[abs(across) > 0.3 * NARROW].any()
