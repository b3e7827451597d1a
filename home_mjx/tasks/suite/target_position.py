"""The observation `target_position`: position of the present stage's target relative to an agent."""

from dataclasses import replace

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from home_mjx.tasks.base.goal_observation import GOAL_SPEC, observe_goal
from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.rules.enums import Attribute, TargetKind
from home_mjx.tasks.rules.features import current_boxes, nearest_targets
from home_mjx.tasks.rules.row_task import RowState
from home_mjx.tasks.rules.speech import is_instructed
from home_mjx.tasks.sensors.cameras import eye_position

TARGET_POSITION = "target_position"  # name of the observation
MAX_TILT = 3.15  # [rad]
TARGET_SPEC = replace(
    GOAL_SPEC,
    shape=(5,),
    low=(*GOAL_SPEC.low, -MAX_TILT),  # pyright: ignore[reportGeneralTypeIssues]
    high=(*GOAL_SPEC.high, MAX_TILT),  # pyright: ignore[reportGeneralTypeIssues]
    text=f"{GOAL_SPEC.text}, angle above the view centre [rad], of the target's middle; 0 for rooms",
)


def observe_target(snapshot: Snapshot, state: RowState) -> Float[Array, "a 5"]:
    """Return the middle of the nearest target of each agent's present stage, relative to the agent, see `TARGET_SPEC`.

    The target may move: it is the present position of an object. All are 0 for rooms, which have no position, without a
    target, and for agents that are not instructed.
    """
    box = nearest_targets(snapshot, state.program, state.targets, current_boxes(snapshot))[1][:, state.goal]
    kind = state.program.descriptor[state.goal, Attribute.KIND]
    middle = jnp.where(jnp.isfinite(box), box, 0.0).mean(axis=1)
    is_point = (kind == TargetKind.PLACE) | (kind == TargetKind.AGENT)
    known = is_point | jnp.any(state.targets.instance[state.goal], axis=-1)  # else the box is arbitrary
    known &= (kind != TargetKind.ROOM) & jnp.all(jnp.isfinite(box), axis=(1, 2))
    known &= is_instructed(state.speech, len(middle))
    seen = jax.vmap(lambda point: observe_goal(snapshot, point))(middle)
    agents = jnp.arange(len(middle))
    offset = middle - eye_position(snapshot.config, snapshot.pose)
    level = jnp.maximum(jnp.linalg.norm(offset[:, :2], axis=-1), 1e-3)
    tilt = jnp.arctan2(offset[:, 2], level) - snapshot.pose.pitch
    return jnp.where(known[:, None], jnp.concatenate([seen[agents, agents], tilt[:, None]], axis=-1), 0.0)
