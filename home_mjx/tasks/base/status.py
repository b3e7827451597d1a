"""Errors inside a jitted step: one integer of flags per environment."""

from enum import IntFlag
from typing import Any

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Int

from home_mjx.errors import HomeMjxError


class Status(IntFlag):
    """Flags of `State.status`; 0: the last step lost nothing.

    Example:
        >>> Status(5)
        <Status.NOT_A_NUMBER|CONTACT_PAIRS: 5>
    """

    NOT_A_NUMBER = 1  # a pose or velocity was not finite; the step was undone and the episode ended
    STATIC_BOXES = 2  # more static boxes touched an agent or a body than it has contact slots
    CONTACT_PAIRS = 4  # bodies touched whose pair the broad phase had not selected
    CONTACT_POINTS = 8  # there were more contact points than the solver's maximum
    RESPONSE_CUT = 16  # sound decays so slowly that the impulse response ends before it has fallen by 30 dB

    OUTSIDE = 32  # an agent or a movable body is beyond the fence around the lot, or under the ground floor

    ACTION = 64  # an action element was NaN (used as 0) or out of range (clipped), or not a discrete action

    WEIGHTS = 128  # no task had a finite weight above 0: the reset sampled all with the same probability

    # More contact sounds than slots, or more appliances on than `num_switch_sounds`: one was dropped or cut off.
    NOISES = 256

    UNHEARD = 512  # a clip reaches no agent: its source is outside, sealed off, in a wall, or too far away

    OVER = 1024  # the episode was over before this step: the state must be reset first, see `AutoReset`

    OTHER_HOUSE = 2048  # the state is of another house than the bank has at its index; the step ended the episode

    @classmethod
    def names(cls, status: int | np.integer | Int[Array, ""]) -> list[str]:
        """Return the names of the flags that are set, lowest bit first; bits of no flag are ignored.

        Example:
            >>> Status.names(3)
            ['NOT_A_NUMBER', 'STATIC_BOXES']
        """
        return [flag.name for flag in cls if flag & int(status) and flag.name is not None]


class StatusError(HomeMjxError, RuntimeError):
    """A jitted step of at least one environment has lost data."""


def status_flags(**conditions: Bool[Array, "..."]) -> Int[Array, ""]:
    """Return the flags, as one integer, whose condition (by flag name) holds anywhere in its array.

    At least one condition is required; a name that is no flag raises `KeyError`.

    Example:
        >>> int(status_flags(CONTACT_POINTS=jnp.array([False, True]), STATIC_BOXES=jnp.array(False)))
        8
    """
    bits = [jnp.where(jnp.any(on), jnp.int32(Status[name]), jnp.int32(0)) for name, on in conditions.items()]
    return jnp.sum(jnp.stack(bits), dtype=jnp.int32)


def add_flags(status: Int[Array, ""], more: Int[Array, ""] | None) -> Int[Array, ""]:
    """Return a status with further flags; unchanged, without any operation, for None.

    Example:
        >>> int(add_flags(jnp.int32(1), jnp.int32(4)))
        5
    """
    return status if more is None else status | more


def check_status(state: Any, ignore: int = 0) -> None:
    """Raise `StatusError` if a state or batch has a flag of `Status` outside of the mask `ignore`; on the host.

    Example:
        >>> check_status(env.step(state, action))  # doctest: +SKIP
    """
    status = np.atleast_1d(np.asarray(state.status)) & ~int(ignore)
    wrong = np.flatnonzero(status)
    if len(wrong):
        first = f"environment {wrong[0]}: {', '.join(Status.names(status.flat[wrong[0]]))}"
        raise StatusError(
            f"{len(wrong)} of {status.size} environments lost something in the last step; {first}",
            hint="`home_mjx.tasks.Status` explains the flags; `dump_flagged` saves the step for a replay.",
        )


def status_report(status: np.ndarray) -> dict[str, np.ndarray]:
    """Return for every flag of `Status`, by lower-case name, a mask (n,) of the batch of flags `status` (n,)."""
    return {str(flag.name).lower(): np.asarray((np.asarray(status) & int(flag)) != 0) for flag in Status}
