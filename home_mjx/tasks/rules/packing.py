"""Packing of rows into columns, and unpacking, by the declarations of the records (host side)."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from home_mjx.audio_jax.auralization.clips import CLIPS
from home_mjx.core.checks import check_number
from home_mjx.errors import ConfigError
from home_mjx.tasks.rules.declaration import check_count, columns_of, pack, pack_items
from home_mjx.tasks.rules.enums import ALL_AGENTS, ANY, FAILURE, MAX_AGENTS, NO_WORD, NUM_STAGES, Attribute, Feature
from home_mjx.tasks.rules.program import (
    FIRST_DESCRIPTOR_FEATURES,
    SECOND_DESCRIPTOR_FEATURES,
    Condition,
    Selector,
    TaskProgram,
    TaskStage,
    Transition,
)
from home_mjx.tasks.rules.speech import SpeechColumns
from home_mjx.tasks.sounds.sound_events import (
    NO_DESCRIPTOR,
    VOICE_CLIP,
    VOICE_CLIP_NUMBER,
    SoundEvent,
    SoundEvents,
    clip_name,
)

Columns = Mapping[str, np.ndarray | np.generic]  # of one row; numbers are scalars


def pack_program(selectors: Sequence[Selector], stages: Sequence[TaskStage]) -> dict[str, np.ndarray]:
    """Pack selectors and stages into the columns of a `TaskProgram`; the task bank sets its `field`.

    Raises:
        ConfigError: A row has no space for all of them, there is no stage, or a number refers to a missing descriptor
            or stage. Or a selector has an unknown attribute.

    Example:
        >>> there = Condition(Feature.DISTANCE, 0, maximum=0.2), Condition(Feature.STOPPED, minimum=1)
        >>> stages = [TaskStage((Transition(-1, there, reward=2.5),), guide=0)]
        >>> pack_program([Selector.point((1, 2, 0))], stages)["next"][0].tolist()
        [-1, -1, -1, -1]
    """
    used = (when for stage in stages for way in stage.transitions for when in (*way.require, *way.forbid))
    numbers = {when: number for number, when in enumerate(dict.fromkeys(used))}
    if not stages:
        raise ConfigError(f"a task must have 1 to {NUM_STAGES} stages, got 0", hint="Give at least one.")
    _check_references(selectors, numbers, stages)
    return (
        pack_items(TaskProgram, "d", [{"descriptor": _words(one), "place": one.place} for one in selectors])
        | pack_items(TaskProgram, "c", [vars(when) for when in numbers])
        | pack_items(TaskProgram, "s", [_stage_fields(stage, numbers) for stage in stages])
    )


def _check_references(
    selectors: Sequence[Selector], conditions: Mapping[Condition, int], stages: Sequence[TaskStage]
) -> None:
    """Raise `ConfigError` if a condition or guide names a missing descriptor, or a transition a missing stage.

    -1, no descriptor, passes, as do descriptors of conditions whose feature tests none.
    """
    used = [when.first for when in conditions if when.feature in FIRST_DESCRIPTOR_FEATURES]
    used += [when.second for when in conditions if when.feature in SECOND_DESCRIPTOR_FEATURES]
    for number in (*used, *(stage.guide for stage in stages)):
        if not ANY <= number < len(selectors):
            hint = "Descriptors are numbered from 0, in the order of `selectors`."
            raise ConfigError(f"a task refers to descriptor {number}, but has {len(selectors)}", hint=hint)
    for way in (way for stage in stages for way in stage.transitions):
        if not FAILURE <= way.next < len(stages):
            hint = "Stages are numbered from 0; SUCCESS and FAILURE end a task."
            raise ConfigError(f"a transition leads to stage {way.next}, but there are {len(stages)}", hint=hint)


def _words(selector: Selector) -> list[int]:
    """Return a selector's values in the order of `Attribute`; `ANY` where it has none."""
    words = [ANY] * len(Attribute)
    for name, value in selector.attributes.items():
        words[Attribute[name.upper()]] = value
    return words


def _stage_fields(stage: TaskStage, numbers: Mapping[Condition, int]) -> dict[str, Any]:
    """Return the column values of a stage: lists with one value per transition, and the stage's `guide`.

    The lists are `require`, `forbid`, `next` and `reward`. The first two are masks with condition bits at `numbers`.
    """

    def bits(conditions: Sequence[Condition]) -> int:
        """Return the mask of bits of the conditions."""
        return sum(1 << numbers[when] for when in set(conditions))

    ways = stage.transitions
    masks = {"require": [bits(way.require) for way in ways], "forbid": [bits(way.forbid) for way in ways]}
    return masks | {"next": [way.next for way in ways], "reward": [way.reward for way in ways], "guide": stage.guide}


def unpack_program(columns: Columns) -> tuple[list[Selector], list[TaskStage]]:
    """Unpack the selectors and stages of a row, the inverse of `pack_program`.

    Selectors of nothing at the end are dropped, and stages without transitions at the end.

    Example:
        >>> stages = [TaskStage((Transition(-1, (Condition(Feature.STOPPED, minimum=1.0),)),))]
        >>> unpack_program(pack_program([Selector.rooms(room_type=1)], stages))[1] == stages
        True
    """
    values = {name: columns[name].tolist() for name in columns_of(TaskProgram)}
    names = ("feature", "first", "second", "agent", "minimum", "maximum")
    conditions = [Condition(Feature(f), *rest) for f, *rest in zip(*(values[name] for name in names), strict=True)]
    selectors = [_selector(*pair) for pair in zip(values["descriptor"], values["place"], strict=True)]
    while selectors and selectors[-1] == Selector.nothing():
        selectors.pop()
    names = ("next", "require", "forbid", "reward")
    stages = [
        TaskStage(tuple(_transitions(conditions, ways)), guide)
        for guide, *ways in zip(values["guide"], *(values[name] for name in names), strict=True)
    ]
    while stages and not stages[-1].transitions:
        stages.pop()
    return selectors, stages


def _selector(words: Sequence[int], place: Sequence[float]) -> Selector:
    """Return the selector with these values of `Attribute`; a place that is not finite is left out."""
    attributes = {word.name.lower(): words[word] for word in Attribute if words[word] != ANY}
    x, y, z = place
    return Selector(attributes, (x, y, z)) if np.isfinite(place).all() else Selector(attributes)


def _transitions(conditions: Sequence[Condition], ways: Sequence[Sequence[Any]]) -> Iterator[Transition]:
    """Yield the transitions of a stage from its entries of `next`, `require`, `forbid`, `reward`; skip unused ones."""
    for after, require, forbid, reward in zip(*ways, strict=True):
        if require >= 0:
            yield Transition(after, _selected(conditions, require), _selected(conditions, forbid), reward)


def _selected(conditions: Sequence[Condition], bits: int) -> tuple[Condition, ...]:
    """Return the conditions whose bit is set."""
    return tuple(when for c, when in enumerate(conditions) if bits >> c & 1)


def pack_sounds(sounds: Sequence[SoundEvent], num_descriptors: int) -> dict[str, np.ndarray]:
    """Pack sounds into the columns of `SoundEvents`.

    Whether the descriptor of an emitter can emit sound is not checked.

    Raises:
        ConfigError: There are more than `NUM_SOUNDS`, or one refers to a missing descriptor.

    Example:
        >>> pack_sounds([SoundEvent(0, "bell")], 1)["sound_emitter"].tolist()
        [0, -1, -1, -1]
    """
    check_count("e", len(sounds))
    for number in (number for sound in sounds for number in (sound.emitter, sound.destination)):
        if number >= num_descriptors:
            raise ConfigError(f"a sound refers to descriptor {number}, but the task has {num_descriptors}")
    return pack_items(SoundEvents, "e", [vars(sound) | {"clip": _clip_number(sound.clip)} for sound in sounds])


def _clip_number(clip: str) -> int:
    """Return the index of a clip in `CLIPS`, or `VOICE_CLIP_NUMBER` for the words of an agent."""
    return VOICE_CLIP_NUMBER if clip == VOICE_CLIP else CLIPS.index(clip)


def unpack_sounds(columns: Columns) -> list[SoundEvent]:
    """Unpack the sounds of one row, without unused entries; the inverse of `pack_sounds`."""
    values = {name: columns[column.key].tolist() for name, column in columns_of(SoundEvents).items()}
    values["clip"] = [clip_name(number) for number in values["clip"]]
    rows = [dict(zip(values, row, strict=True)) for row in zip(*values.values(), strict=True)]
    return [SoundEvent(**row) for row in rows if row["emitter"] != NO_DESCRIPTOR]


def pack_speech(
    answer: int = NO_WORD,
    instructed_agents: Sequence[int] | None = None,
    oracle: Sequence[tuple[int, int]] = (),
    num_identifying_questions: int = 0,
) -> dict[str, np.ndarray]:
    """Pack the speech of a row into the columns of `SpeechColumns`; see `TaskRow` for the arguments.

    Raises:
        ConfigError: There are more than `NUM_REPLIES` questions, or fewer than `num_identifying_questions`. Or an agent
            is not a whole number from 0 to `MAX_AGENTS` - 1.

    Example:
        >>> pack_speech(instructed_agents=(1,))["instructed_agents"].tolist()
        2
    """
    if num_identifying_questions > len(oracle):
        message = f"an oracle must have at least {num_identifying_questions} replies, got {len(oracle)}"
        raise ConfigError(message, hint="Give more questions, or a smaller `num_identifying_questions`.")
    values: dict[str, Any] = {"answer": answer, "num_identifying_questions": num_identifying_questions}
    everyone = instructed_agents is None
    for agent in instructed_agents or ():
        check_number("instructed_agents", agent, 0, MAX_AGENTS - 1, integer=True)
    values["instructed_agents"] = ALL_AGENTS if everyone else sum(1 << agent for agent in set(instructed_agents))
    return pack(SpeechColumns, values | {"oracle": oracle})


def unpack_speech(columns: Columns) -> dict[str, Any]:
    """Return the arguments of `pack_speech` by name, from the columns of one row; agents ascending, each once."""
    bits, oracle = int(columns["instructed_agents"]), columns["oracle"].tolist()
    everyone = bits == ALL_AGENTS
    return {
        "answer": int(columns["answer"]),
        "instructed_agents": None if everyone else tuple(agent for agent in range(MAX_AGENTS) if bits >> agent & 1),
        "oracle": [(question, reply) for question, reply in oracle if question != NO_WORD],
        "num_identifying_questions": int(columns["num_identifying_questions"]),
    }
