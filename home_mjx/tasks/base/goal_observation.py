"""The observation `goal`: place of a goal point relative to an agent."""

import jax.numpy as jnp
from jaxtyping import Array, Float

from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.base.specs import ArraySpec

MAX_GOAL_DISTANCE = 1000.0  # [m], bound of distances and heights; larger than any house
GOAL_SPEC = ArraySpec(
    (4,),
    "float32",
    (0.0, -1.0, -1.0, -MAX_GOAL_DISTANCE),
    (MAX_GOAL_DISTANCE, 1.0, 1.0, MAX_GOAL_DISTANCE),
    "distance in the plane [m], cosine and sine of the bearing in the agent's frame, left positive, "
    "height above the agent's feet [m]",
)


def observe_goal(snapshot: Snapshot, goal: Float[Array, "3"]) -> Float[Array, "a 4"]:
    """Return a goal point on a floor, in world coordinates [m] and finite, relative to each agent, see `GOAL_SPEC`.

    It is the distance in the plane [m], cosine and sine of the bearing (left positive), and height above the feet [m]:
    0 on the agent's own storey, about 2.8 m one storey up.
    """
    pose, offset = snapshot.pose, goal - snapshot.feet
    bearing = jnp.arctan2(offset[:, 1], offset[:, 0]) - pose.yaw
    plane = jnp.linalg.norm(offset[:, :2], axis=-1)
    return jnp.stack([plane, jnp.cos(bearing), jnp.sin(bearing), offset[:, 2]], axis=-1)
