"""What there is to know of bodies between two steps."""

import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from home_mjx.core.pytree import Pytree

AWAKE = 1e-6  # [m/s^2], [rad/s^2]: least acceleration of what does not sleep


class Scale(Pytree):
    """Factors of an environment's movable bodies against what the house says; None: 1."""

    friction: Float[Array, "*batch"] | None = None
    mass: Float[Array, "*batch"] | None = None  # and of their inertia: they keep their size

    @property
    def factors(self) -> Float[Array, "2"]:
        """Of friction and mass."""
        one = jnp.ones((), jnp.float32)
        return jnp.stack([one if x is None else x for x in (self.friction, self.mass)])


class PhysicsState(Pytree):
    """Poses and speeds of an environment's agents, movable bodies and doors; see `layout.Layout`.

    The names are MuJoCo's. Mobiles are the agents, then the bodies, then the doors.
    """

    qpos: Float[
        Array, "*batch nq"
    ]  # of an agent x, y, z [m] and yaw [rad]; of a body x, y, z and quaternion wxyz; of a door [rad] or [m]
    qvel: Float[Array, "*batch nv"]  # [m/s], [rad/s]; a body turns about its own axes
    qacc: Float[Array, "*batch nv"]  # of the last physics step; the next one's solver begins there
    held: Int[Array, "*batch a"]  # movable body in each agent's hand; -1 none
    grip: Float[Array, "*batch a 7"]  # where it shall be in the agent's frame: position [m], quaternion
    spot: Float[Array, "*batch a 3"]  # [m], where a hand puts down what it holds; inf: nowhere
    tries: Int[Array, "*batch a"]  # control steps since it began to take or to put down
    goal: Float[Array, "*batch h"]  # [rad] or [m], where a door is driven to; `servo.FREE`: nowhere
    touched: Int[Array, "*batch a"]  # contact points of each agent with anything but the floor, the most in a step
    impulse: Float[Array, "*batch m"]  # [N s], of all contacts of each mobile in the last control step
    place: Float[Array, "*batch m 3"]  # [m], of the strongest of them
    other: Int[Array, "*batch m"]  # what that was with: a mobile; -1 nothing, -2 the floor, -3 - c static box c
    scale: Scale | None = None  # of friction and mass, for the whole episode
