"""What an environment carries from step to step."""

from typing import Any

from jaxtyping import Array, Float, Int, UInt32

from home_mjx.core.pytree import Pytree


class World(Pytree):
    """One environment besides its bodies; A agents, sound responses of L samples."""

    key: UInt32[Array, "2"]
    house: Int[Array, ""]  # index into the bank
    pitch: Float[Array, " a"]  # [rad], look up is positive
    goal: Int[Array, ""]  # index into the house's goals
    distance: Float[Array, " a"]  # [m], geodesic distance to the goal
    source: Float[Array, "3"]  # [m], where the sound comes from
    phase: Int[Array, ""]  # [samples], position in the sound clip
    response: Float[Array, "a 2 l"]  # impulse response per ear of the last frame
    step: Int[Array, ""]  # steps since reset


class State(Pytree):
    """A MuJoCo Playground style state; for one agent the agent axis of obs and reward is squeezed.

    Attributes:
        data: `mjx.Data` of the bodies.
        obs: Observations by name, see `home_mjx.tasks.sensors`.
        reward: Float, per agent.
        done: Float, 1 at the end of the episode (terminated, or truncated).
        metrics: Float scalars by name.
        info: `world` (a `World`), `truncation` (Float) and what wrappers add.
    """

    data: Any
    obs: dict[str, Array]
    reward: Float[Array, "..."]
    done: Float[Array, ""]
    metrics: dict[str, Array]
    info: dict[str, Any]
