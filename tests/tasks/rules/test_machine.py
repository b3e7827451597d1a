"""The machine of a row against a loop in Python."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from drawn_programs import AGENTS, drawn_stages

from home_mjx.errors import ConfigError
from home_mjx.tasks.rules.declaration import extract
from home_mjx.tasks.rules.enums import (
    FAILURE,
    NUM_DESCRIPTORS,
    NUM_STAGES,
    NUM_TRANSITIONS,
    SUCCESS,
    Feature,
)
from home_mjx.tasks.rules.packing import pack_program
from home_mjx.tasks.rules.program import (
    Condition,
    Selector,
    TaskProgram,
    TaskStage,
    Transition,
    check_success,
    evaluate_conditions,
    needs_only,
    take_transition,
)


def holds(when: Condition, table: np.ndarray) -> bool:
    agents = range(AGENTS) if when.agent < 0 else [when.agent]
    return any(when.minimum <= table[when.feature, a, when.first, when.second] <= when.maximum for a in agents)


def by_hand(stages: list[TaskStage], stage: int, table: np.ndarray) -> tuple[int, float, bool]:
    if stage >= 0:
        for way in stages[stage].transitions:
            if all(holds(when, table) for when in way.require) and not any(holds(when, table) for when in way.forbid):
                return way.next, way.reward, True
    return stage, 0.0, False


def test_any_program_takes_the_transitions_of_a_loop():
    random = np.random.default_rng(0)

    @jax.jit
    def one(columns, stage, table):
        program = extract(TaskProgram, columns)
        return take_transition(program, stage, evaluate_conditions(program, table))

    kinds = set()
    for _ in range(500):
        stages = drawn_stages(random)
        columns = pack_program([Selector.point((0, 0, 0))] * NUM_DESCRIPTORS, stages)
        columns["field"] = np.zeros(NUM_DESCRIPTORS, np.int16)
        table = random.uniform(-1, 1, (len(Feature), AGENTS, NUM_DESCRIPTORS, NUM_DESCRIPTORS)).astype(np.float32)
        for stage in (*range(len(stages)), SUCCESS, FAILURE):
            expected = by_hand(stages, stage, table)
            got = one(columns, jnp.int32(stage), table)
            assert (int(got[0]), float(got[1]), bool(got[2])) == pytest.approx(expected)
            kinds.add(expected[0] if expected[2] else "stays")
    assert kinds == {SUCCESS, FAILURE, "stays", *range(NUM_STAGES)}


@pytest.mark.parametrize(
    ("descriptors", "stages", "text"),
    [
        ([Selector.point((0, 0, 0))] * (NUM_DESCRIPTORS + 1), [TaskStage(())], "descriptors"),
        ([], [], "stages"),
        ([], [TaskStage(())] * (NUM_STAGES + 1), "stages"),
        ([], [TaskStage((Transition(SUCCESS),) * (NUM_TRANSITIONS + 1))], "transitions"),
        ([], [TaskStage((Transition(1),))], "leads to stage 1"),
        ([], [TaskStage((Transition(SUCCESS, (Condition(Feature.HELD, 0),)),))], "descriptor 0"),
        (
            [Selector.point((0, 0, 0))],
            [TaskStage((Transition(SUCCESS, (Condition(Feature.ON, 0, 1),)),))],
            "descriptor 1",
        ),
        ([], [TaskStage((), guide=2)], "descriptor 2"),
    ],
)
def test_what_has_no_room_or_names_nothing_is_refused(descriptors, stages, text):
    with pytest.raises(ConfigError, match=text):
        pack_program(descriptors, stages)


def test_stages_that_cannot_succeed_are_refused():
    """No transition that one gets to leads to success."""
    check_success([TaskStage((Transition(FAILURE), Transition(1))), TaskStage((Transition(0), Transition(SUCCESS)))])
    for stages in (
        [TaskStage((Transition(FAILURE),))],
        [TaskStage((Transition(0),)), TaskStage((Transition(SUCCESS),))],
        [TaskStage(())],
    ):
        with pytest.raises(ConfigError, match="leads to SUCCESS"):
            check_success(stages)


def test_what_alone_is_missing_is_needed_only():
    """A stage that ends by `stop` in a room: `stop` alone is missing inside, nothing after it, more outside."""
    inside, stopped = Condition(Feature.INSIDE, 0, minimum=1), Condition(Feature.STOPPED, minimum=1)
    stages = [TaskStage((Transition(SUCCESS, (inside, stopped)),), guide=0)]
    columns = pack_program([Selector.rooms(room_type=0)], stages)
    program = TaskProgram(**{name: jnp.asarray(x) for name, x in columns.items()})
    outside = jnp.zeros((len(Feature), 2, NUM_DESCRIPTORS, NUM_DESCRIPTORS))
    within = outside.at[Feature.INSIDE].set(1.0)
    stop = [table.at[Feature.STOPPED].set(1.0) for table in (outside, within)]
    cases = (outside, stop[0]), (within, stop[1]), (stop[1], stop[1])
    found = [needs_only(program, jnp.int32(0), *case).tolist() for case in cases]
    assert found == [[False, False], [True, True], [False, False]]
