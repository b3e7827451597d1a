"""PointNav: go to a point of the house; the reward is progress along the shortest path.

Anderson et al., "On Evaluation of Embodied Navigation Agents", 2018 (arXiv:1807.06757).
"""

from dataclasses import dataclass, fields
from typing import Any

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from home_mjx.bank.bank import HouseBank
from home_mjx.core.checks import check_flag, check_number
from home_mjx.core.pytree import Pytree
from home_mjx.navigation.grid import geodesic_distance
from home_mjx.tasks.base.goal_observation import GOAL_SPEC, observe_goal
from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.base.specs import Specs
from home_mjx.tasks.base.state import Episodes
from home_mjx.tasks.base.task import Task, path_scores
from home_mjx.tasks.suite import point_goals


class PointNavState(Pytree):
    """Goal and progress of A agents."""

    goal: Int[Array, ""]  # index into the house's goals
    distance: Float[Array, " a"]  # [m], geodesic
    reached: Bool[Array, " a"]  # has been within `success_distance` since the start; with `stop`: has stopped there
    arrived: Bool[Array, " a"]  # reached the goal in the last step
    length: Float[Array, " a"]  # [m], of the shortest path from the start
    path_length: Float[Array, " a"]  # [m], length of the path until arrival; 0 if it begins there
    last_pos: Float[Array, "a 3"]  # [m], position in the last step
    collisions: Int[Array, " a"]  # steps with `Snapshot.has_collided`


@dataclass(frozen=True)
class PointNav(Task):
    """Reach the goal within `success_distance`; with several agents, all of them.

    An episode ends when each agent has arrived or has chosen the discrete action `stop`.

    Attributes:
        success_distance: Maximum distance on arrival [m].
        stop: Agents must choose `stop` on arrival: only `stop` within `success_distance` counts. With
            `success_distance=0.2` this is PointNav as in Habitat.
        min_distance: Minimum distance of goals at the start, if there are such goals [m].
        same_storey: Goals are on the storey of the start, if it has one to which a path leads.
        success_reward: Added once, on arrival.
        step_cost: Subtracted every step.
        contact_cost: Subtracted while touching anything but the floor.
    """

    success_distance: float = 0.36
    stop: bool = False
    min_distance: float = 1.0
    same_storey: bool = False
    success_reward: float = 2.5
    step_cost: float = 0.01
    contact_cost: float = 0.01

    def __post_init__(self) -> None:
        for option in fields(self):
            value = getattr(self, option.name)
            if option.name in ("stop", "same_storey"):
                check_flag(option.name, value)
            else:
                check_number(option.name, value, 0)

    @property
    def requires_stop(self) -> bool:
        """True if agents must choose the action `stop`: the option `stop`."""
        return self.stop

    @property
    def observation_spec(self) -> Specs:
        """Spec of `goal`: plan distance [m], cosine and sine of bearing, height above feet [m]."""
        return {"goal": GOAL_SPEC}

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of the columns: index of the goal, and length of the shortest path [m]."""
        return ("goal", "length")

    def init(self, snapshot: Snapshot, key: Array, columns: dict[str, Array] | None) -> PointNavState:
        """Return the initial state, with the goal of `columns` or a random one, if possible beyond `min_distance`."""
        if columns is None:
            goal = point_goals.pick_goal(snapshot, key, self.min_distance, self.same_storey)
        else:
            goal = columns["goal"]
        distance = self._distance(snapshot, goal)
        nobody = jnp.zeros(distance.shape, bool)
        return PointNavState(
            goal=goal,
            distance=distance,
            reached=nobody,
            arrived=nobody,
            length=distance,
            path_length=jnp.zeros(distance.shape, jnp.float32),
            last_pos=snapshot.pose.pos,
            collisions=jnp.zeros(distance.shape, jnp.int32),
        )

    def update(self, snapshot: Snapshot, state: PointNavState) -> PointNavState:
        """Update distances, arrivals, collisions, and path lengths up to the first arrival."""
        distance = self._distance(snapshot, state.goal)
        there = distance <= jnp.float32(self.success_distance)
        there = there & snapshot.stopped if self.stop else there
        # Without `stop`, an agent that begins within the distance has arrived before it moves.
        arrived = state.reached if self.stop else state.reached | (state.distance <= jnp.float32(self.success_distance))
        place = snapshot.pose.pos
        moved = jnp.linalg.norm(place - state.last_pos, axis=-1)
        return state.replace(
            distance=distance,
            reached=state.reached | there,
            arrived=there & ~state.reached,
            path_length=state.path_length + jnp.where(arrived, 0.0, moved),
            last_pos=place,
            collisions=state.collisions + snapshot.has_collided.astype(jnp.int32),
        )

    def observe(self, snapshot: Snapshot, state: PointNavState) -> dict[str, Array]:
        """Return `goal`: plan distance [m], cosine and sine of the bearing, height above the feet [m] of each agent."""
        return {"goal": observe_goal(snapshot, snapshot.bank.navigation.goal[snapshot.house, state.goal])}

    def reward(self, snapshot: Snapshot, before: PointNavState, state: PointNavState) -> Float[Array, " a"]:
        """Return progress [m] minus costs, plus `success_reward` on arrival."""
        terms = self.reward_terms(snapshot, before, state)
        return terms["progress"] + terms["steps"] + terms["contacts"] + terms["success"]

    def reward_terms(
        self, snapshot: Snapshot, before: PointNavState, state: PointNavState
    ) -> dict[str, Float[Array, " a"]]:
        """Return progress [m], costs as negative numbers, and the reward of an arrival."""
        progress = before.distance - state.distance
        return {
            "progress": progress,
            "steps": jnp.full_like(progress, -jnp.float32(self.step_cost)),
            "contacts": -jnp.float32(self.contact_cost) * snapshot.in_contact.astype(jnp.float32),
            "success": jnp.float32(self.success_reward) * state.arrived.astype(jnp.float32),
        }

    def terminated(self, snapshot: Snapshot, state: PointNavState) -> Bool[Array, ""]:
        """Return whether all acting agents have arrived or stopped."""
        return jnp.all((state.reached | snapshot.stopped)[: self.num_acting])

    def metrics(self, snapshot: Snapshot, state: PointNavState) -> dict[str, Float[Array, ""]]:
        """Return Habitat's metrics as means over agents: success, SPL, soft SPL, distance [m], collisions; and contact.

        Contact is the fraction of agents that touch anything but the floor now. Agents that do not act count, too. See
        `path_scores`.
        """
        success = state.reached.astype(jnp.float32)
        figures = {
            "success": success,
            **path_scores(success, state.length, state.path_length, state.distance),
            "distance": state.distance,
            "collisions": state.collisions.astype(jnp.float32),
            "contact": snapshot.in_contact.astype(jnp.float32),
        }
        return {name: jnp.mean(figure) for name, figure in figures.items()}

    def sample(self, bank: HouseBank, house: Int[Array, ""], key: Array, **limits: Any) -> tuple[Array, Array, dict]:
        """Sample an episode by `point_goals.sample_goal`.

        Limits are `min_length` and `max_length` of the path [m], and `same_storey`, by default the task's own.
        """
        limits.setdefault("same_storey", self.same_storey)
        return point_goals.sample_goal(bank, house, key, **limits)

    def to_json(self, bank: HouseBank, house: int, columns: dict[str, Any]) -> dict[str, Any]:
        """Return `goal`, the position [m], so that any bank of the houses can load it, and `length` [m]."""
        return point_goals.to_json(bank, house, columns)

    def from_json(self, bank: HouseBank, house: int, line: dict[str, Any]) -> dict[str, Any]:
        """Return `goal`, the index of the bank's goal at the line's position, and `length`; raises as `point_goals`."""
        return point_goals.from_json(bank, house, line)

    def is_solvable(self, bank: HouseBank, episode: Episodes) -> Bool[Array, ""]:
        """Return whether the start is on a floor, in or beside a cell with a path to the goal."""
        return point_goals.is_solvable(bank, episode)

    def shortest_length(self, bank: HouseBank, episode: Episodes) -> Float[Array, ""]:
        """Return the length of the shortest path from the start to the goal [m]."""
        return geodesic_distance(bank, episode.house, episode.columns["goal"], episode.start)

    def _distance(self, snapshot: Snapshot, goal: Int[Array, ""]) -> Float[Array, " a"]:
        """Return each agent's geodesic distance to a goal [m]."""
        return jax.vmap(lambda p: geodesic_distance(snapshot.bank, snapshot.house, goal, p))(snapshot.feet)
