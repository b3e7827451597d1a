"""Who carries something turns one way round or the other, not to and fro."""

import jax.numpy as jnp
import numpy as np
import pytest

from home_mjx.tasks.experts.carry_clearance import resolve_turns

STEP = np.radians(10)


def turned(yaw: float, goal: float, blocked_left, blocked_right) -> list[float]:
    """Headings [rad] of who turns in steps from one to another; ways round are blocked from some headings."""
    seen, turning = [yaw], 0.0
    for _ in range(60):
        left = (goal - yaw + np.pi) % (2 * np.pi) - np.pi
        if abs(left) < STEP / 2 + 1e-6:
            return seen
        blocked = (blocked_left if left > 0 else blocked_right)(yaw)
        turn = resolve_turns(jnp.array([left], jnp.float32), jnp.array([blocked]), jnp.array([turning], jnp.float32))
        turning = float(np.sign(turn[0]))
        yaw += turning * STEP
        seen.append(yaw)
    return seen


@pytest.mark.parametrize("start", [330, 340])
def test_a_turn_that_has_begun_is_ended(start):
    """To the right it is blocked at 330 degrees, to the left at 340, as where a shelf stands beside a wall."""
    seen = np.degrees(turned(np.radians(start), np.radians(155), lambda _: True, lambda _: True))
    assert abs((seen[-1] - 155 + 180) % 360 - 180) < 5.1
    assert len(seen) < 21
    assert np.all(np.diff(seen) > 0) or np.all(np.diff(seen) < 0)


def test_the_free_way_round_is_gone():
    short = turned(0.0, np.radians(90), lambda _: False, lambda _: False)
    assert len(short) == 10
    long = turned(0.0, np.radians(90), lambda _: True, lambda _: False)
    assert long[-1] == pytest.approx(np.radians(-270))
    assert len(long) == 28
