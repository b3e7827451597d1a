"""An environment with the expert's action as an observation."""

import dataclasses

import jax
import jax.numpy as jnp
from jaxtyping import Array

from home_mjx.errors import ConfigError
from home_mjx.navigation.grid import stored_distance
from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.base.specs import Specs
from home_mjx.tasks.base.state import State
from home_mjx.tasks.base.task import Task
from home_mjx.tasks.env.env import Env
from home_mjx.tasks.env.household import HouseholdEnv
from home_mjx.tasks.experts.field_descent import descend_field
from home_mjx.tasks.experts.path_follower import expert_action, to_actions, turn_towards
from home_mjx.tasks.rules.row_task import RowState, RowTask
from home_mjx.tasks.suite.point_nav import PointNav, PointNavState

EXPERT = "expert"  # name of the observation
STOP_RADIUS_FRACTION = 0.8  # fraction of the success radius within which experts choose `stop`


class ExpertObservationEnv(HouseholdEnv):
    """The same environment with one more observation, `expert`: the expert's action in the current state.

    Every interface that passes observations on can thus follow, record and query experts (DAgger). Networks of
    `home_mjx.training` do not read it.

    A task without an expert raises when the first reset is traced.

    Args:
        core: The environment.
        teaches: Actions are for imitation, see `expert_action`.

    Example:
        >>> core = ExpertObservationEnv(env.core)  # doctest: +SKIP
        >>> state = core.reset(env.params, jax.random.key(0))  # doctest: +SKIP
        >>> state = core.step(env.params, state, state.obs["expert"])  # doctest: +SKIP
    """

    def __init__(self, core: HouseholdEnv, teaches: bool = False) -> None:
        task, self.teaches = core.task, teaches
        super().__init__(
            core.config, dataclasses.replace(task, store_features=True) if isinstance(task, RowTask) else task
        )
        self.progress = core.progress

    def _extra_observations(self, state: State, snapshot: Snapshot) -> dict[str, Array]:
        """Return `expert`: actions of all agents, or of the acting ones if the task's state has its own expert."""
        return {EXPERT: _expert_action(self.task, snapshot, state.task, self.teaches)}

    def _observation_spec(self) -> Specs:
        """Return the specs of the environment and, as that of `expert`, the spec of actions."""
        spec = dataclasses.replace(self.action_spec, text=f"action of the expert: {self.action_spec.text}")
        return {**super()._observation_spec(), EXPERT: spec}


def add_expert(env: Env[HouseholdEnv]) -> Env[HouseholdEnv]:
    """Return an environment with expert actions, see `ExpertObservationEnv`; unchanged if it has them."""
    return (
        env if isinstance(env.core, ExpertObservationEnv) else Env(ExpertObservationEnv(env.core), env.params, env.spec)
    )


def _expert_action(task: Task, snapshot: Snapshot, state: object, teaches: bool) -> Array:
    """Return the expert's action for every agent, by the kind of task; `ConfigError` if it has none."""
    if isinstance(task, PointNav) and isinstance(state, PointNavState):
        return _point_nav_action(task, snapshot, state)
    if not isinstance(state, RowState) and not hasattr(state, "expert"):
        hint = "There are experts for PointNav, and for tasks that are rows of a task bank."
        raise ConfigError(f"no expert is known for {type(task).__name__}", hint=hint)
    return expert_action(snapshot, state, teaches)  # pyright: ignore[reportArgumentType]


def _point_nav_action(task: PointNav, snapshot: Snapshot, state: PointNavState) -> Array:
    """Return actions along the shortest path past door leaves; `stop` well within the success radius.

    Only the task's option `stop` leads to `stop`; without it agents walk on.
    """
    field, pose = snapshot.bank.navigation.field, snapshot.pose

    def ahead(agent: Array) -> tuple[Array, Array]:
        """Return one agent's waypoint (x, y) [m], and whether its path ends."""
        far = lambda _, cell: stored_distance(field, cell, state.goal)  # noqa: E731
        return descend_field(snapshot, agent, far, tolerance=STOP_RADIUS_FRACTION * task.success_distance / 2)

    aim, there = jax.vmap(ahead)(jnp.arange(snapshot.config.num_agents))
    stop = (state.distance <= jnp.float32(STOP_RADIUS_FRACTION * task.success_distance)) | there
    stop = stop & jnp.bool_(task.stop)
    return to_actions(snapshot.config, turn_towards(snapshot, aim), -pose.pitch, jnp.zeros_like(stop), stop)
