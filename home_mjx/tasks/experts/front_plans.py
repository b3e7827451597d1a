"""The front of furniture that experts open next."""

import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from home_mjx.navigation.doors import opening_fractions
from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.rules.containment import body_compartments
from home_mjx.tasks.rules.enums import Feature
from home_mjx.tasks.rules.program import leads_on
from home_mjx.tasks.rules.row_task import RowState
from home_mjx.tasks.sensors.front_reach import is_openable

MIN_OPENING = 0.85  # minimum opening of a front behind which a hand takes something, 1: wide open


def plan_front(
    snapshot: Snapshot,
    state: RowState,
    values: Float[Array, "feature a d d"],
    guide: Int[Array, ""],
    take: Bool[Array, " a"],
) -> tuple[Int[Array, ""], Bool[Array, " a"]]:
    """Return the front to open, as a row of the doors, and which agents should open it now.

    It is the front before the object to take if that is in a compartment, until it is open by `MIN_OPENING`. If a
    transition of the stage needs the guide open, it is the front before what the guide contains, or its first one.

    Args:
        snapshot: The environment.
        state: State of its row task.
        values: See `FeatureValues`.
        guide: Descriptor of the stage's guide.
        take: True if the agent should pick up a target of the guide.
    """
    if snapshot.bank.fronts.is_empty or snapshot.bank.compartments.is_empty:
        return jnp.zeros((), jnp.int32), jnp.zeros_like(take)
    around = _compartment_around(snapshot, state, guide)
    doors = snapshot.bank.compartments.door[snapshot.house]
    before = jnp.maximum(doors[jnp.maximum(around, 0)], 0)
    shut = opening_fractions(snapshot.bank, snapshot.house, snapshot.door_angle)[before] < jnp.float32(MIN_OPENING)
    first = take & (around >= 0) & shut
    within = jnp.max(values[Feature.CONTAINED, 0, :, guide]).astype(jnp.int32)
    own = jnp.where(within >= 0, doors[jnp.maximum(within, 0)], _first_front(snapshot, state, guide))
    looks = ~take & _needs_opening(state, values, guide) & (own >= 0)
    return jnp.where(jnp.any(first), before, jnp.maximum(own, 0)), first | looks


def _compartment_around(snapshot: Snapshot, state: RowState, guide: Int[Array, ""]) -> Int[Array, ""]:
    """Return the compartment that a movable target of a descriptor is in; -1 none."""
    physics, house = snapshot.bank.physics, snapshot.house
    item = state.targets.instance[guide, jnp.maximum(physics.body_instance[house], 0)] & physics.body_valid[house]
    return jnp.max(jnp.where(item, body_compartments(snapshot), -1), initial=-1)


def _first_front(snapshot: Snapshot, state: RowState, guide: Int[Array, ""]) -> Int[Array, ""]:
    """Return the first front of a descriptor's targets that agents open, as a row of the doors; -1 none."""
    bank, house = snapshot.bank, snapshot.house
    leaf = bank.fronts.leaf[house]
    owner = state.targets.instance[guide, jnp.maximum(bank.physics.door_instance[house, jnp.maximum(leaf, 0)], 0)]
    fits = owner & is_openable(bank, house)
    return jnp.where(jnp.any(fits), leaf[jnp.argmax(fits)], -1)


def _needs_opening(state: RowState, values: Float[Array, "feature a d d"], guide: Int[Array, ""]) -> Bool[Array, ""]:
    """Return whether a transition, not to FAILURE, needs the guide open, and none is possible now or with `stop`."""
    opened = values.at[Feature.OPEN, :, guide].set(1.0)
    done = values.at[Feature.STOPPED].set(1.0)
    at_once, if_done, if_open = (leads_on(state.program, state.stage, x)[0] for x in (values, done, opened))
    return ~at_once & ~if_done & if_open
