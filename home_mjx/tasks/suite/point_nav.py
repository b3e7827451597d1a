"""PointNav: go to a point of the house; the reward is progress along the shortest path.

Anderson et al., "On Evaluation of Embodied Navigation Agents", 2018 (arXiv:1807.06757).
"""

from dataclasses import dataclass

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from home_mjx.bank.bank import HouseBank
from home_mjx.navigation.grid import geodesic_distance
from home_mjx.tasks.base.pose import AgentPose


@dataclass(frozen=True)
class PointNav:
    """Reach the goal's `success_radius`.

    Attributes:
        success_radius: Distance that counts as arrived [m].
        min_distance: Goals nearer than this at the start are avoided [m].
        success_reward: Added on arrival.
        step_cost: Taken every step.
        contact_cost: Taken while touching anything but the floor.
    """

    success_radius: float = 0.36
    min_distance: float = 1.0
    success_reward: float = 2.5
    step_cost: float = 0.01
    contact_cost: float = 0.01

    def choose_goal(self, bank: HouseBank, house: Int[Array, ""], start: Int[Array, ""], key: Array) -> Int[Array, ""]:
        """A random goal of the house at least `min_distance` from the start, if there is one."""
        distance = geodesic_distance(bank, house, None, bank.navigation.start[house, start])
        fit = jnp.isfinite(distance) & (distance >= jnp.float32(self.min_distance))
        fit = fit | ~jnp.any(fit)
        return jax.random.categorical(key, jnp.where(fit, 0.0, -jnp.inf)).astype(jnp.int32)

    def goal_observation(self, goal: Float[Array, "3"], pose: AgentPose) -> Float[Array, "a 3"]:
        """Distance [m] in the plane, cosine and sine of the bearing in each agent's own frame (left positive)."""
        offset = goal[None, :2] - pose.pos[:, :2]
        distance = jnp.linalg.norm(offset, axis=-1)
        bearing = jnp.arctan2(offset[:, 1], offset[:, 0]) - pose.yaw
        return jnp.stack([distance, jnp.cos(bearing), jnp.sin(bearing)], axis=-1)

    def score(
        self, before: Float[Array, " a"], after: Float[Array, " a"], contact: Bool[Array, " a"]
    ) -> tuple[Float[Array, " a"], Bool[Array, " a"], dict[str, Array]]:
        """Reward and success per agent from the geodesic distance before and after the step [m]."""
        success = after <= jnp.float32(self.success_radius)
        reward = before - after - jnp.float32(self.step_cost)
        reward = reward - jnp.float32(self.contact_cost) * contact.astype(jnp.float32)
        reward = reward + jnp.float32(self.success_reward) * success.astype(jnp.float32)
        metrics = {
            "success": jnp.mean(success.astype(jnp.float32)),
            "distance": jnp.mean(after),
            "contact": jnp.mean(contact.astype(jnp.float32)),
        }
        return reward, success, metrics
