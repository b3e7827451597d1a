"""What gates forget: how much of it is believed of rays that no gate ends."""

import numpy as np
import pytest

from home_mjx.audio_jax.late_reverb.bake.portal_correction import (
    INTERVAL_EDGES,
    NUM_BATCHES,
    RECORDED_BINS,
    portal_ratio,
)

ROOM = np.array([0, 0, 0, 1, 1])
NOWHERE = np.array([-1, -1])  # no room is that of a gate
OCTAVES, GATES, BINS = 7, 2, 200


def decays() -> np.ndarray:
    """What five cells hear of two gates in all octaves (7, 2, 5, 200)."""
    rate = np.linspace(0.02, 0.08, OCTAVES)[:, None, None, None]
    return np.exp(-rate * np.arange(BINS)) * np.linspace(1, 2, GATES * 5).reshape(GATES, 5, 1)


def told(ours: np.ndarray, factor: np.ndarray, noise: float = 0.0) -> np.ndarray:
    """What batches of rays tell: by so much more (gates, rooms), each batch with noise of its own in all octaves."""
    drawn = np.random.default_rng(0).normal(1, noise, (NUM_BATCHES, 1, GATES, 5, 1))
    return (ours * factor[:, ROOM][None, ..., None] * drawn)[..., :RECORDED_BINS]


def test_what_rays_say_exactly_is_believed():
    """In each room and of each gate, at all times, also later than they tell."""
    factor = np.array([[0.8, 1.1], [1.0, 0.7]])
    found = portal_ratio(decays(), told(decays(), factor), ROOM, NOWHERE)
    np.testing.assert_allclose(found, np.broadcast_to(factor[:, ROOM, None], (GATES, 5, BINS)), rtol=1e-6)


def test_it_may_change_over_time():
    ours = decays()
    late = np.where(np.arange(BINS) < INTERVAL_EDGES[3], 0.5, 1.2)
    found = portal_ratio(ours, told(ours * late, np.ones((GATES, 2))), ROOM, NOWHERE)
    np.testing.assert_allclose(found[..., 1:4], 0.5, atol=1e-6)
    np.testing.assert_allclose(found[..., INTERVAL_EDGES[4] :], 1.2, atol=1e-6)


def test_noise_is_not_believed():
    """Rays that are right on average but differ by half from batch to batch change little."""
    ours = decays()
    found = portal_ratio(ours, told(ours, np.ones((GATES, 2)), noise=0.5), ROOM, NOWHERE)
    assert np.abs(found - 1).max() < 0.3
    assert (
        np.abs(found - 1).max()
        < np.abs(told(ours, np.ones((GATES, 2)), noise=0.5) / ours[..., :RECORDED_BINS] - 1).max() / 2
    )


def test_in_the_room_of_a_gate_noise_is_believed_less():
    """Rays that are 5 % off on average: a bare room's EDT varied by 2.4 % from seed to seed."""
    ours = decays()
    rays = told(ours, np.full((GATES, 2), 1.05), noise=0.1)
    found = portal_ratio(ours, rays, ROOM, np.array([0, 0]))
    assert np.all(np.abs(found[:, :3] - 1) < np.abs(found[:, 3:].mean() - 1))


@pytest.mark.parametrize("batches", [0, 1])
def test_where_hardly_a_ray_came_nothing_is_known(batches):
    """No ray in a room, or in one batch of seven, says little; of a gate from which none flew nothing is said."""
    ours = decays()
    rays = told(ours, np.ones((GATES, 2)))
    rays[batches:, :, 0, 3:] = 0
    rays[:, :, 1] = 0
    found = portal_ratio(ours, rays, ROOM, NOWHERE)
    assert np.all(np.abs(found[0, 3:] - 1) < 0.05)
    np.testing.assert_array_equal(found[0, :3], np.ones((3, BINS)))
    np.testing.assert_array_equal(found[1], np.ones((5, BINS)))
