"""What there is to know of bodies between two steps."""

from jaxtyping import Array, Float, Int

from home_mjx.core.pytree import Pytree


class PhysicsState(Pytree):
    """Poses and speeds of an environment's agents, then of its movable bodies; see `layout.Layout`.

    The names are MuJoCo's.
    """

    qpos: Float[Array, "*batch nq"]  # of an agent x, y, z [m] and yaw [rad]; of a body x, y, z and quaternion wxyz
    qvel: Float[Array, "*batch nv"]  # [m/s], [rad/s]; a body turns about its own axes
    qacc: Float[Array, "*batch nv"]  # of the last physics step; the next one's solver begins there
    touched: Int[Array, "*batch a"]  # contact points of each agent with anything but the floor, the most in a step
