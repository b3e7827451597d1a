"""Who sounds, and who listens."""

from jaxtyping import Array, Float, Int

from home_mjx.core.pytree import Pytree


class Source(Pytree):
    """A point source."""

    pos: Float[Array, "3"]  # [m], world
    body: Int[Array, ""] | int = -1  # object id of the body that sounds, which does not muffle itself; -1 none


class Listener(Pytree):
    """A head with two ears."""

    pos: Float[Array, "3"]  # [m], world, middle of the head
    quat: Float[Array, "4"]  # wxyz, in MuJoCo's camera frame: +x right, +y up, looking along -z
    body: Int[Array, ""] | int = -1  # object id of the listener's own body, transparent to its ears; -1 none
