"""Task programs: user-facing dataclasses, and their packed form as arrays."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Array, Float, Int

from home_mjx.core.pytree import Pytree
from home_mjx.errors import ConfigError
from home_mjx.tasks.rules.words import (
    ANY,
    FAILURE,
    NUM_CONDITIONS,
    NUM_DESCRIPTORS,
    NUM_STAGES,
    NUM_TRANSITIONS,
    SUCCESS,
    Attribute,
    Feature,
    TargetKind,
)

NO_PLACE = (np.inf, np.inf, np.inf)
FAR = np.inf


class TaskProgram(Pytree):
    """Packed program of one episode: d descriptors, c conditions, s stages with g transitions each.

    In each step the first transition of the present stage is taken whose `require` all hold and none of whose `forbid`
    holds.
    """

    descriptor: Int[Array, "*t d words"]  # columns are those of `Attribute`
    place: Float[Array, "*t d 3"]  # [m], of descriptors of kind PLACE; inf elsewhere
    field: Int[Array, "*t d"]  # column of `TaskBank.field`; -1: distances are straight lines
    feature: Int[Array, "*t c"]  # of `Feature`
    first: Int[Array, "*t c"]  # descriptor i
    second: Int[Array, "*t c"]  # descriptor j
    agent: Int[Array, "*t c"]  # agent whose feature is tested; -1: any agent's
    minimum: Float[Array, "*t c"]  # minimum of the feature, inclusive
    maximum: Float[Array, "*t c"]  # maximum of the feature, inclusive
    require: Int[Array, "*t s g"]  # bit mask of conditions that must hold; -1: no transition
    forbid: Int[Array, "*t s g"]  # bit mask of conditions that must not hold
    next: Int[Array, "*t s g"]  # stage, SUCCESS or FAILURE
    reward: Float[Array, "*t s g"]  # of the transition
    guide: Int[Array, "*t s"]  # descriptor towards which progress is rewarded; -1 if none


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
        """Select the objects that have all of these words.

        Example:
            >>> Meant.thing(coarse=3, color=1).words["coarse"]
            3
        """
        return cls({"kind": TargetKind.OBJECT, **words})

    @classmethod
    def objects_with(cls, words: Mapping[Attribute, int]) -> "Selector":
        """Select the objects that have all of these words, by `Attribute`."""
        return cls.objects(**{word.name.lower(): value for word, value in words.items()})

    @classmethod
    def rooms(cls, **words: int) -> "Selector":
        """Select the rooms that have all of these words."""
        return cls({"kind": TargetKind.ROOM, **words})

    @classmethod
    def point(cls, place: Sequence[float]) -> "Selector":
        """Select a point on the floor [m]."""
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
        >>> near = When(Feature.DISTANCE, 0, maximum=0.2)
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


def pack_program(descriptors: Sequence[Selector], stages: Sequence[TaskStage]) -> dict[str, np.ndarray]:
    """Pack descriptors and stages into the arrays of a `TaskProgram`, except `field`, which the task bank adds.

    Raises:
        ConfigError: A row has no space for all of them, there is no stage, or a number refers to a missing descriptor
            or stage.

    Example:
        >>> there = When(Feature.DISTANCE, 0, maximum=0.2), When(Feature.STOPPED, minimum=1)
        >>> stages = [Stage((Go(SUCCESS, there, reward=2.5),), guide=0)]
        >>> written([Meant.at((1, 2, 0))], stages)["next"][0].tolist()
        [-1, -1, -1, -1]
    """
    known: dict[Condition, int] = {}
    for stage in stages:
        for way in stage.transitions:
            for when in (*way.require, *way.forbid):
                known.setdefault(when, len(known))
    counts = {"descriptors": len(descriptors), "conditions": len(known), "stages": len(stages)}
    counts["transitions of a stage"] = max((len(stage.transitions) for stage in stages), default=0)
    room = (NUM_DESCRIPTORS, NUM_CONDITIONS, NUM_STAGES, NUM_TRANSITIONS)
    for (name, count), most in zip(counts.items(), room, strict=True):
        if count > most or (count == 0 and name == "stages"):
            hint = "Leave some out, or split the task in two." if count else "Give at least one."
            raise ConfigError(f"a task must have 1 to {most} {name}, got {count}", hint=hint)
    _check_references(descriptors, known, stages)
    return _pack_descriptors(descriptors) | _pack_conditions(known) | _pack_stages(stages, known)


def _check_references(
    descriptors: Sequence[Selector], known: dict[Condition, int], stages: Sequence[TaskStage]
) -> None:
    used = [when.first for when in known if when.feature in FIRST_DESCRIPTOR_FEATURES] + [
        stage.guide for stage in stages
    ]
    used += [when.second for when in known if when.feature in SECOND_DESCRIPTOR_FEATURES]
    for number in used:
        if not ANY <= number < len(descriptors):
            hint = "Descriptors are numbered from 0, in the order of `selectors`."
            raise ConfigError(f"a task refers to descriptor {number}, but has {len(descriptors)}", hint=hint)
    for way in (way for stage in stages for way in stage.transitions):
        if not FAILURE <= way.next < len(stages):
            hint = "Stages are numbered from 0; SUCCESS and FAILURE end a task."
            raise ConfigError(f"a transition leads to stage {way.next}, but there are {len(stages)}", hint=hint)


def check_success(stages: Sequence[TaskStage]) -> None:
    """Check that `SUCCESS` can be reached from the first stage; the stages must be valid for `pack_program`.

    Raises:
        ConfigError: No sequence of transitions from the first stage leads to `SUCCESS`.

    Example:
        >>> check_success([Stage((Go(1),)), Stage((Go(SUCCESS),))])
    """
    seen, front = {0}, [0]
    while front:
        front = [n for n in {way.next for i in front if i >= 0 for way in stages[i].transitions} if n not in seen]
        seen |= set(front)
    if SUCCESS not in seen:
        raise ConfigError("no transition of a task leads to SUCCESS", hint="Give a stage a Go(SUCCESS, ...).")


SECOND_DESCRIPTOR_FEATURES = (Feature.BESIDE, Feature.ON)
FIRST_DESCRIPTOR_FEATURES = (
    *(Feature.DISTANCE, Feature.STRAIGHT, Feature.SEEN, Feature.HELD, Feature.INSIDE, Feature.OPEN, Feature.CLEAR),
    *SECOND_DESCRIPTOR_FEATURES,
)


def _pack_descriptors(descriptors: Sequence[Selector]) -> dict[str, np.ndarray]:
    words = np.full((NUM_DESCRIPTORS, len(Attribute)), ANY, np.int16)
    place = np.full((NUM_DESCRIPTORS, 3), np.inf, np.float32)
    for row, meant in enumerate(descriptors):
        place[row] = meant.place
        for name, value in meant.attributes.items():
            words[row, Attribute[name.upper()]] = value
    return {"descriptor": words, "place": place}


def _pack_conditions(known: dict[Condition, int]) -> dict[str, np.ndarray]:
    rows = [*known, *[Condition(Feature.TRUE)] * (NUM_CONDITIONS - len(known))]
    whole = {name: np.array([getattr(row, name) for row in rows], np.int8) for name in ("feature", "first", "second")}
    whole["agent"] = np.array([row.agent for row in rows], np.int8)
    return whole | {name: np.array([getattr(row, name) for row in rows], np.float32) for name in ("minimum", "maximum")}


def _pack_stages(stages: Sequence[TaskStage], known: dict[Condition, int]) -> dict[str, np.ndarray]:
    shape = NUM_STAGES, NUM_TRANSITIONS
    arrays = {name: np.full(shape, -1, np.int16) for name in ("require", "forbid")}
    arrays |= {"next": np.full(shape, SUCCESS, np.int8), "reward": np.zeros(shape, np.float32)}
    guide = np.full(NUM_STAGES, ANY, np.int8)
    for s, stage in enumerate(stages):
        guide[s] = stage.guide
        for g, way in enumerate(stage.transitions):
            bits = (sum(1 << known[when] for when in set(whens)) for whens in (way.require, way.forbid))
            arrays["require"][s, g], arrays["forbid"][s, g] = bits
            arrays["next"][s, g], arrays["reward"][s, g] = way.next, way.reward
    return arrays | {"guide": guide}
