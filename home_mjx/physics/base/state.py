"""State of the dynamic bodies between two control steps, and codes of contact partners."""

import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from home_mjx.core.pytree import Pytree

MIN_AWAKE_ACCELERATION = 1e-6  # [m/s^2], [rad/s^2], minimum acceleration of an awake body
NOTHING, FLOOR, STATIC = -1, -2, -3  # static box c is STATIC - c
# Minimum upward component of the normal of a contact with a static box that carries an agent: upper floors, ramps, and
# edges of steps up to half the radius of a foot.
MIN_SUPPORT_NORMAL = 0.5


class BodyScale(Pytree):
    """Factors for the friction and mass of an environment's movable bodies; None is 1."""

    friction: Float[Array, "*batch"] | None = None
    mass: Float[Array, "*batch"] | None = None  # also scales inertia, since sizes do not change

    @property
    def factors(self) -> Float[Array, "2"]:
        """Friction factor, then mass factor, of one environment; None counts as 1."""
        one = jnp.ones((), jnp.float32)
        return jnp.stack([one if x is None else x for x in (self.friction, self.mass)])


class PhysicsState(Pytree):
    """Poses and speeds of an environment's agents, movable bodies and doors; see `layout.Layout`.

    Field names follow MuJoCo. Dynamic bodies are the agents, then the movable bodies, then the doors. `num_contacts` is
    the maximum over physics steps of the last control step; impulses are sums. Sleeping bodies keep their last contact,
    and kinematic physics has no impulses.
    """

    # agent: x, y, z [m] and yaw [rad]; body: x, y, z [m] and quaternion wxyz; door: [rad] or [m]
    qpos: Float[Array, "*batch nq"]
    qvel: Float[Array, "*batch nv"]  # [m/s], [rad/s]; angular velocity of bodies is about their own axes
    qacc: Float[Array, "*batch nv"]  # of the last physics step; warm start of the next one's solver
    held: Int[Array, "*batch a"]  # movable body in each agent's hand; -1 none
    grip: Float[Array, "*batch a 7"]  # target pose of the held body in the agent's frame: position [m], quaternion
    place_target: Float[Array, "*batch a 3"]  # [m], surface point on which the hand places its body; inf: none
    hand_steps: Int[Array, "*batch a"]  # control steps since it began to pick or place; MAX_PLACE_STEPS + 1 once near
    door_goal: Float[Array, "*batch h"]  # [rad] or [m], target of each door drive; `servo.NOT_DRIVEN`: not driven
    num_contacts: Int[Array, "*batch a"]  # contact points per agent; floors do not count, see `MIN_SUPPORT_NORMAL`
    contact_impulse: Float[Array, "*batch m"]  # [N s], of all contacts of each dynamic body in the last control step
    contact_pos: Float[Array, "*batch m 3"]  # [m], position of its strongest contact
    # other side of that contact: a dynamic body; -1 none, -2 floor, -3 - c static box c
    contact_partner: Int[Array, "*batch m"]
    scale: BodyScale | None = None  # factors of friction and mass, constant in an episode
