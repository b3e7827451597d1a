"""Where an agent is and which way it looks."""

from jaxtyping import Array, Float

from home_mjx.core.pytree import Pytree


class AgentPose(Pytree):
    """Pose of every agent: capsule centre [m], yaw [rad] about +z from +x, pitch [rad], up is positive."""

    pos: Float[Array, "a 3"]
    yaw: Float[Array, " a"]
    pitch: Float[Array, " a"]
