"""The energy balance of rooms: against matrix exponentials, and what leaves of doors do in a house with doors."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.linalg import expm

from home_mjx.audio_jax.late_reverb.bake.room_exchange import _route_exchange
from home_mjx.audio_jax.late_reverb.lookup.coupled_decay import decay_in_rooms
from home_mjx.audio_jax.late_reverb.lookup.energy_balance import _open_share, _rate_matrix


def test_energies_over_time_are_those_of_the_matrix_exponential():
    rng = np.random.default_rng(0)
    volume, loss = rng.uniform(20, 60, 4), rng.uniform(0.02, 0.2, (4, 1))
    exchange = rng.uniform(0, 0.6, (4, 4, 1))
    exchange = exchange + exchange.swapaxes(0, 1)
    for room in range(4):
        exchange[room, room] = 0
    f32 = [jnp.asarray(x, jnp.float32) for x in (volume, loss, exchange)]
    matrix = _rate_matrix(*f32)
    start = jnp.float32([0, 1, 0, 0])
    found = decay_in_rooms((matrix * 1.37)[None], start, jnp.float32([0, 0, 1, 0]), 100)
    own = np.diag(loss[:, 0]) + (np.diag(exchange[..., 0].sum(1)) - exchange[..., 0]) / volume[:, None]
    exact = [expm(-own * 1.37 * k)[2, 1] for k in range(100)]
    np.testing.assert_allclose(found[0, :, 0], exact, rtol=1e-4, atol=1e-7)


def test_what_no_wall_takes_is_kept():
    volume = jnp.float32([30, 50, 20])
    exchange = jnp.float32([[0, 0.5, 0], [0.5, 0, 0.2], [0, 0.2, 0]])[..., None]
    rates = (_rate_matrix(volume, jnp.zeros((3, 1)), exchange) * 1.37)[None]
    held = sum(
        volume[r] * decay_in_rooms(rates, jnp.float32([1, 0, 0]) / volume, jax.nn.one_hot(r, 3), 400)[0, :, 0]
        for r in range(3)
    )
    np.testing.assert_allclose(held, 1, rtol=1e-3)
    late = decay_in_rooms(rates, jnp.float32([1, 0, 0]) / volume, jnp.float32([0, 0, 1]), 4000)[0, -1, 0]
    assert float(late) == pytest.approx(1 / 100, rel=5e-3)  # evenly spread over 100 m³


@pytest.mark.parametrize("degrees", [20, 45, 70, 90])
def test_a_gap_lets_through_what_rays_say(degrees):
    """Rays that enter the triangle of leaf, gap and doorway evenly, the leaf scattering all that meets it."""
    rng = np.random.default_rng(degrees)
    angle = np.radians(degrees)
    hinge, jamb, tip = np.zeros(2), np.array([1.0, 0.0]), np.array([np.cos(angle), np.sin(angle)])
    sides = [(hinge, jamb), (jamb, tip), (tip, hinge)]  # doorway, gap, leaf
    through, rays = 0, 20_000
    for _ in range(rays):
        side = 1
        while True:
            side = _next_side(sides, side, rng)
            if side != 2:
                break
        through += side == 0
    gap = np.linalg.norm(jamb - tip)
    assert gap * through / rays == pytest.approx(float(_open_share(jnp.float32(angle))), rel=0.04)


def _next_side(sides: list, side: int, rng: np.random.Generator) -> int:
    """Which other side of a triangle a ray meets that leaves one by Lambert's law."""
    a, b = sides[side]
    along = (b - a) / np.linalg.norm(b - a)
    inward = np.array([-along[1], along[0]])
    sine = rng.uniform(-1, 1)
    way = sine * along + np.sqrt(1 - sine**2) * inward
    point = a + rng.random() * (b - a)
    for other in {0, 1, 2} - {side}:
        c, d = sides[other]
        share, _ = np.linalg.solve(np.stack([d - c, -way], axis=1), point - c)
        if 0 <= share <= 1:
            return other
    return side


def test_flow_through_a_third_room_goes_over_it():
    exchange = np.zeros((3, 3, 1))
    exchange[0, 1] = exchange[1, 0] = exchange[1, 2] = exchange[2, 1] = 0.5
    exchange[0, 2] = exchange[2, 0] = 0.1
    out = _route_exchange(exchange, np.array([[0, 1], [1, 2]]))
    np.testing.assert_allclose(out[..., 0], [[0, 0.6, 0], [0.6, 0, 0.6], [0, 0.6, 0]])
    assert np.array_equal(_route_exchange(exchange, np.zeros((0, 2), int)), exchange)
