"""Columns of rows as their records declare them, and what is derived from that."""

import dataclasses
import inspect

import jax.numpy as jnp
import numpy as np
import pytest
from drawn_programs import drawn_stages
from jaxtyping import Array, Float, Int

from home_mjx.core.pytree import Pytree, array
from home_mjx.errors import ConfigError
from home_mjx.tasks.rules import SUCCESS, Condition, Feature, Selector, SoundEvent, TaskStage, Transition
from home_mjx.tasks.rules.declaration import AXES, columns_of, extract, pack, pack_items, row_columns
from home_mjx.tasks.rules.enums import NUM_STAGES, NUM_TRANSITIONS
from home_mjx.tasks.rules.packing import (
    pack_program,
    pack_sounds,
    pack_speech,
    unpack_program,
    unpack_sounds,
    unpack_speech,
)
from home_mjx.tasks.rules.task_bank import RECORDS
from home_mjx.tasks.suite.task_io import decode, encode
from home_mjx.tasks.validation.column_ranges import column_ranges, column_values, index_range, values_range
from home_mjx.tasks.validation.line_schema import ITEMS, TaskLine, schema_of

PARTS = (TaskLine, *ITEMS)


class Light(Pytree):
    """A column that no row has."""

    PREFIX = "light_"
    power: Float[Array, "*t e"] = array("[W]", dtype=np.float32, values="gain", fill=2.0)
    switch: Int[Array, "*t g 2"] = array("descriptor", dtype=np.int8, values="descriptor", fill=-1)


def test_a_field_declares_a_column():
    power, switch = columns_of(Light).values()
    assert (power.key, power.shape, power.dtype, power.fill) == ("light_power", (AXES["e"].capacity,), np.float32, 2.0)
    assert pack(Light, {"power": [0.5]})["light_power"].tolist() == [0.5, 2.0, 2.0, 2.0]
    assert pack_items(Light, "g", [{"switch": (1, 2)}])["light_switch"].tolist() == [
        [1, 2],
        [-1, -1],
        [-1, -1],
        [-1, -1],
    ]
    assert switch.empty().tolist() == [[-1, -1]] * AXES["g"].capacity
    packed = {column.key: jnp.asarray(column.empty()) for column in (power, switch)}
    assert extract(Light, packed).power is packed["light_power"]
    assert values_range(power.values).maximum == 1000.0
    with pytest.raises(ConfigError, match="at most 4 sounds, got 5"):
        power.pack([1.0] * 5)


def test_all_columns_have_a_range_and_their_fill_is_in_it():
    ranges = column_ranges()
    assert ranges.keys() == column_values().keys()
    for key, column in row_columns(RECORDS).items():
        allowed = ranges.get(key) or ranges["selectors.on"]
        assert np.all(allowed.contains(column.empty())), key
        assert allowed.is_integer == (column.dtype.kind == "i")
    assert len(row_columns(RECORDS)) == sum(len(columns_of(record)) for record in RECORDS)


def test_ranges_are_replaced_by_the_name_of_values():
    changed = column_ranges({"agent": index_range(2)})
    different = {name for name, own in column_ranges().items() if changed[name] != own}
    assert different == {"agent", "selectors.agent"}


@pytest.mark.parametrize("part", PARTS)
def test_a_file_has_the_fields_of_the_dataclasses(part):
    fields = {name.rstrip("?"): not name.endswith("?") for name in schema_of(part)}
    if part is not Selector:
        assert fields == {f.name: f.default is dataclasses.MISSING for f in dataclasses.fields(part)}


def test_too_many_transitions_are_named():
    stage = TaskStage((Transition(SUCCESS),) * (NUM_TRANSITIONS + 1))
    with pytest.raises(ConfigError, match="at most 4 transitions of a stage, got 5"):
        pack_program([], [stage])
    with pytest.raises(ConfigError, match="at most 6 stages, got 7"):
        pack_program([], [TaskStage((Transition(SUCCESS),))] * (NUM_STAGES + 1))


def test_stages_without_transitions_keep_their_number():
    stages = [TaskStage((Transition(2),)), TaskStage(()), TaskStage((Transition(SUCCESS),))]
    assert unpack_program(pack_program([], stages))[1] == stages
    assert unpack_program(pack_program([], [stages[2], TaskStage(())]))[1] == stages[2:]


@pytest.mark.parametrize("agent", [-1, 15, 40, 0.5])
def test_agents_beyond_the_mask_are_refused(agent):
    unchecked = inspect.unwrap(pack_speech)  # users have no type checker, which refuses 0.5 in these tests
    with pytest.raises(ConfigError, match="instructed_agents"):
        unchecked(instructed_agents=(0, agent))


def test_what_is_packed_is_unpacked(rng):
    selectors = [
        Selector.objects(coarse=3, on=1),
        Selector.point((1.0, -2.5, 0.0)),
        Selector.agent(2),
        Selector.rooms(),
    ]
    for _ in range(20):
        stages = [stage for stage in drawn_stages(rng) if stage.transitions] or [TaskStage((Transition(SUCCESS),))]
        stages = [
            dataclasses.replace(stage, transitions=tuple(_within(way, len(stages)) for way in stage.transitions))
            for stage in stages
        ]
        columns = pack_program(selectors, stages)
        found, again = unpack_program(columns)
        assert found == selectors
        repacked = pack_program(found, again)
        assert [len(stage.transitions) for stage in again] == [len(stage.transitions) for stage in stages]
        assert repacked["reward"].tolist() == columns["reward"].tolist()
        assert _meaning(again) == _meaning(stages)
    sounds = [SoundEvent(0, "bell", period=3.0, duration=0.5), SoundEvent(2, "voice")]
    assert unpack_sounds(pack_sounds(sounds, 3)) == sounds
    speech = {"answer": 3, "instructed_agents": (0, 14), "oracle": [(1, 2), (3, 4)], "num_identifying_questions": 1}
    assert unpack_speech(pack_speech(**speech)) == speech
    assert unpack_speech(pack_speech())["instructed_agents"] is None


def _within(way: Transition, count: int) -> Transition:
    return dataclasses.replace(way, next=min(way.next, count - 1))


def _meaning(stages: list[TaskStage]) -> list:
    """Stages with their conditions as sets: a bit mask has no order."""
    return [[(way.next, set(way.require), set(way.forbid), way.reward) for way in s.transitions] for s in stages]


def test_a_stage_is_the_same_from_its_json():
    near = Condition(Feature.DISTANCE, 0, maximum=1.0)
    stage = TaskStage((Transition(SUCCESS, (near,), reward=0.5), Transition(0, forbid=(near,))), guide=0)
    line = encode(stage)
    assert line["transitions"][0] == {
        "next": "success",
        "require": [{"feature": "distance", "maximum": 1.0}],
        "reward": 0.5,
    }
    assert decode(TaskStage, line) == stage
