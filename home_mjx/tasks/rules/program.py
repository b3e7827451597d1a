"""Task programs: user-facing dataclasses, their packed form as arrays, and the state machine that runs them.

The machine goes from feature values to the next stage by integer compares, the same for every task.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from home_mjx.core.pytree import Pytree, array
from home_mjx.errors import ConfigError
from home_mjx.tasks.rules.enums import ANY, FAILURE, NUM_CONDITIONS, SUCCESS, Attribute, Feature, TargetKind

NO_PLACE = (np.inf, np.inf, np.inf)
SECOND_DESCRIPTOR_FEATURES = (Feature.BESIDE, Feature.ON, Feature.CONTAINED)
FIRST_DESCRIPTOR_FEATURES = (
    *(Feature.DISTANCE, Feature.STRAIGHT, Feature.SEEN, Feature.HELD, Feature.INSIDE, Feature.OPEN, Feature.CLEAR),
    Feature.SWITCHED_ON,
    *SECOND_DESCRIPTOR_FEATURES,
)


class TaskProgram(Pytree):
    """Packed program of one episode: d descriptors, c conditions, s stages with g transitions each.

    In each step the first transition of the present stage is taken whose `require` all hold and none of whose `forbid`
    holds.
    """

    descriptor: Int[Array, "*t d words"] = array(
        "descriptors; columns are those of `Attribute`", dtype=np.int16, values="attributes", fill=ANY
    )
    place: Float[Array, "*t d 3"] = array(
        "position of descriptors of kind PLACE [m]; inf elsewhere", dtype=np.float32, values="place", fill=np.inf
    )
    field: Int[Array, "*t d"] = array(
        "column of `TaskBank.field`; -1: distances are straight lines", dtype=np.int16, values="field", fill=-1
    )
    feature: Int[Array, "*t c"] = array(
        "feature that is tested, of `Feature`", dtype=np.int8, values="feature", fill=Feature.TRUE
    )
    first: Int[Array, "*t c"] = array("descriptor i", dtype=np.int8, values="descriptor", fill=0)
    second: Int[Array, "*t c"] = array("descriptor j; -1 if none", dtype=np.int8, values="descriptor", fill=ANY)
    agent: Int[Array, "*t c"] = array(
        "agent whose feature is tested; -1: any agent's", dtype=np.int8, values="agent", fill=0
    )
    minimum: Float[Array, "*t c"] = array(
        "minimum of the feature, inclusive", dtype=np.float32, values="limit", fill=-np.inf
    )
    maximum: Float[Array, "*t c"] = array(
        "maximum of the feature, inclusive", dtype=np.float32, values="limit", fill=np.inf
    )
    require: Int[Array, "*t s g"] = array(
        "bit mask of conditions that must hold; -1: no transition", dtype=np.int16, values="conditions", fill=-1
    )
    forbid: Int[Array, "*t s g"] = array(
        "bit mask of conditions that must not hold; -1: no transition", dtype=np.int16, values="conditions", fill=-1
    )
    next: Int[Array, "*t s g"] = array("stage, SUCCESS or FAILURE", dtype=np.int8, values="next", fill=SUCCESS)
    reward: Float[Array, "*t s g"] = array("reward of the transition", dtype=np.float32, values="reward", fill=0.0)
    guide: Int[Array, "*t s"] = array(
        "descriptor towards which progress is rewarded; -1 if none", dtype=np.int8, values="descriptor", fill=ANY
    )


@dataclass(frozen=True)
class Selector:
    """Descriptor: selects the objects, rooms, point or agent that a task refers to.

    Made by `Selector.objects`, `.objects_with`, `.rooms`, `.point`, `.agent` or `.nothing`.

    Attributes:
        attributes: Values of `Attribute` by name, in lower case.
        place: Position of a point [m]; inf for other kinds.
    """

    attributes: dict[str, int] = field(default_factory=dict)
    place: tuple[float, float, float] = NO_PLACE

    @classmethod
    def nothing(cls) -> "Selector":
        """Select nothing. As first descriptor it hides the targets from the observations `goal` and `goal_words`."""
        return cls({})

    @classmethod
    def objects(cls, **words: int) -> "Selector":
        """Select the objects that have all of these values, by `Attribute` name in lower case; all without any.

        Names are checked by `pack_program`, here not yet.

        Example:
            >>> Selector.objects(coarse=3, color=1).attributes["coarse"]
            3
        """
        return cls({"kind": TargetKind.OBJECT, **words})

    @classmethod
    def objects_with(cls, words: Mapping[Attribute, int]) -> "Selector":
        """Select the objects that have all of these values, by `Attribute`."""
        return cls.objects(**{word.name.lower(): value for word, value in words.items()})

    @classmethod
    def rooms(cls, **words: int) -> "Selector":
        """Select the rooms that have all of these values, by `Attribute` name in lower case; all without any."""
        return cls({"kind": TargetKind.ROOM, **words})

    @classmethod
    def point(cls, place: Sequence[float]) -> "Selector":
        """Select a point (x, y, z) on the floor [m]."""
        x, y, z = (float(v) for v in place)
        return cls({"kind": TargetKind.PLACE}, (x, y, z))

    @classmethod
    def agent(cls, agent: int) -> "Selector":
        """Select an agent by its index."""
        return cls({"kind": TargetKind.AGENT, "agent": agent})


@dataclass(frozen=True)
class Condition:
    """Condition: a feature between two limits, both inclusive.

    Example:
        >>> near = Condition(Feature.DISTANCE, 0, maximum=0.2)
    """

    feature: Feature
    first: int = 0
    second: int = ANY
    agent: int = 0
    minimum: float = -np.inf
    maximum: float = np.inf


@dataclass(frozen=True)
class Transition:
    """Transition to the stage `next`, possible if all of `require` hold and none of `forbid` does."""

    next: int
    require: tuple[Condition, ...] = ()
    forbid: tuple[Condition, ...] = ()
    reward: float = 0.0


@dataclass(frozen=True)
class TaskStage:
    """Stage of a task: transitions in order of priority; progress towards the descriptor `guide` is rewarded."""

    transitions: tuple[Transition, ...]
    guide: int = ANY


def check_success(stages: Sequence[TaskStage]) -> None:
    """Check that a chain of transitions leads from the first stage to `SUCCESS`, whatever their conditions.

    The stages must be valid for `pack_program`.

    Raises:
        ConfigError: None does.

    Example:
        >>> check_success([TaskStage((Transition(1),)), TaskStage((Transition(SUCCESS),))])
    """
    seen, front = {0}, [0]
    while front:
        front = [n for n in {way.next for i in front if i >= 0 for way in stages[i].transitions} if n not in seen]
        seen |= set(front)
    if SUCCESS not in seen:
        raise ConfigError("no transition of a task leads to SUCCESS", hint="Give a stage a Transition(SUCCESS, ...).")


def evaluate_conditions(program: TaskProgram, table: Float[Array, "feature a d d"]) -> Bool[Array, " c"]:
    """Return which conditions of a program hold, from the values of `FeatureValues`.

    A condition tests its agent's value, with agent -1 that of any agent; both limits are inclusive. Numbers beyond the
    last agent count as the last one.
    """
    first, second = jnp.maximum(program.first, 0), jnp.maximum(program.second, 0)
    value = table[program.feature, :, first, second]  # (c, a)
    holds = (value >= program.minimum[:, None]) & (value <= program.maximum[:, None])
    own = jnp.take_along_axis(holds, jnp.clip(program.agent, 0, table.shape[1] - 1)[:, None], axis=1)[:, 0]
    return jnp.where(program.agent < 0, jnp.any(holds, axis=1), own)


def take_transition(
    program: TaskProgram, stage: Int[Array, ""], holds: Bool[Array, " c"]
) -> tuple[Int[Array, ""], Float[Array, ""], Bool[Array, ""]]:
    """Return the stage after the first transition whose conditions hold, its reward, and whether there was one.

    Otherwise the stage stays and the reward is 0, as in an episode that has ended (negative stage). `holds` has the
    result of each condition.
    """
    bits = jnp.sum(jnp.where(holds, jnp.left_shift(1, jnp.arange(NUM_CONDITIONS)), 0)).astype(jnp.int32)
    at = jnp.maximum(stage, 0)
    require, forbid = program.require[at], program.forbid[at]
    open_ = (require >= 0) & ((bits & require) == require) & ((bits & forbid) == 0) & (stage >= 0)
    way = jnp.argmax(open_)
    taken = jnp.any(open_)
    reward = jnp.where(taken, program.reward[at, way], 0.0)
    return jnp.where(taken, program.next[at, way], stage), reward, taken


def leads_on(
    program: TaskProgram, stage: Int[Array, ""], table: Float[Array, "feature a d d"]
) -> tuple[Bool[Array, ""], Bool[Array, ""]]:
    """Return whether feature values lead to a transition that is not to FAILURE, and whether to any transition."""
    after, _, taken = take_transition(program, stage, evaluate_conditions(program, table))
    return taken & (after != FAILURE), taken


def needs_only(
    program: TaskProgram,
    stage: Int[Array, ""],
    table: Float[Array, "feature a d d"],
    changed: Float[Array, "feature a d d"],
) -> Bool[Array, " a"]:
    """Return whether `changed` feature values lead to a transition, not to FAILURE, and those of `table` to none.

    It is the same for all agents.
    """
    needs = leads_on(program, stage, changed)[0] & ~leads_on(program, stage, table)[1]
    return jnp.broadcast_to(needs, table.shape[1:2])
