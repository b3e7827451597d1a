"""Relation of things and the furniture they are inside of: on the device, in conditions, and at the start of rows."""

import json
from dataclasses import dataclass

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from chest import CUP, TRAVEL, home

from home_mjx import HouseBank, physics
from home_mjx.errors import DatasetError
from home_mjx.navigation import compartment_at, containers_at
from home_mjx.physics import PhysicsConfig
from home_mjx.scene_compile.objects.fronts import ArticulationOptions
from home_mjx.scene_compile.pipeline.compile import CompileOptions, compile_house
from home_mjx.schema.categories import COARSE
from home_mjx.schema.semantic import Semantic
from home_mjx.tasks import EnvConfig, HouseholdEnv, load_tasks, save_tasks
from home_mjx.tasks.env.reset import physics_template, put_bodies
from home_mjx.tasks.rules.build_bank import TaskRow
from home_mjx.tasks.rules.enums import SUCCESS, Feature
from home_mjx.tasks.rules.program import Condition, Selector, TaskStage, Transition
from home_mjx.tasks.suite import NavigationTask
from home_mjx.tasks.validation.row_violations import host_columns
from home_mjx.tasks.validation.stored_targets import first_without_compartment

CONFIG = EnvConfig(sensors=("state",), hands=True, fronts="closed", physics=PhysicsConfig(impl="kinematic"))
CUPS, CHESTS = Selector.objects(coarse=COARSE.index("kitchenware")), Selector.objects(coarse=COARSE.index("dresser"))


@dataclass(frozen=True)
class Opened(NavigationTask):
    """A row for each compartment of the chest: the cup begins in it, and success is to open the chest."""

    def rows(self, view, random):
        (chest,) = (thing for thing in view.objects if thing.coarse == "dresser")
        for slot in view.compartments_of(chest):
            inside = Condition(Feature.CONTAINED, 0, 1, minimum=slot, maximum=slot)
            done = Transition(SUCCESS, (inside, Condition(Feature.OPEN, 1, minimum=0.9)))
            yield TaskRow([CUPS, CHESTS], [TaskStage((done,), guide=1)])


@pytest.fixture(scope="module")
def house():
    return compile_house(*home(blocked=False), CompileOptions(articulation=ArticulationOptions(8)))


@pytest.fixture(scope="module")
def env(house):
    task = Opened(num_tasks=8, min_length=0.2, store_features=True)
    return HouseholdEnv(CONFIG, task).bind(HouseBank.from_compiled([house]))


@pytest.fixture(scope="module")
def states(env):
    rows = jnp.arange(len(env.params.tasks))
    return jax.jit(jax.vmap(env.core.reset, (None, 0, None, 0)))(
        env.params, jax.random.split(jax.random.key(1), len(rows)), None, rows
    )


def named(env):
    """The compartment that each row names."""
    columns = env.params.tasks.rows.columns
    return np.asarray(columns["minimum"])[np.asarray(columns["feature"]) == Feature.CONTAINED].astype(int)


def test_a_row_begins_with_its_thing_on_the_bottom_of_its_compartment(env, states, house):
    """By the boxes of the compiled house: the cup is within the compartment, and no tray is in it."""
    slots, template = named(env), physics_template(CONFIG, env.bank.spec)
    assert len(slots) >= 1
    places = np.asarray(jax.vmap(lambda data: physics.body_pose(template, data)[0])(states.physics))[:, 0]
    for at, slot in enumerate(slots):
        pos = places[at]
        own = house.compartments
        half = np.array(own.size[slot])[[1, 0, 2]] if abs(own.quat[slot, 3]) > 0.5 else own.size[slot]
        assert (np.abs(pos - own.pos[slot]) + CUP / 2 <= half + 1e-4).all()
        assert pos[2] - CUP / 2 == pytest.approx(own.pos[slot, 2] - half[2], abs=2e-3)


def test_conditions_have_the_compartment_and_the_opening(env, states):
    slots, bank, template = named(env), env.bank, physics_template(CONFIG, env.bank.spec)
    values = np.asarray(states.task.features.values)
    assert values[:, Feature.CONTAINED, 0, 0, 1].tolist() == slots.tolist()
    assert (values[:, Feature.CONTAINED, 0, 1, 0] == -1).all()  # the chest is not in the cup
    assert (values[:, Feature.SEEN, 0, 0] == 0).all()
    assert (values[:, Feature.CLEAR, 0, 0] == 0).all()
    assert values[:, Feature.OPEN, 0, 1] == pytest.approx(0, abs=1e-5)
    state = jax.tree.map(lambda x: x[0], states)
    leaf = bank.compartments.door[0, slots[0]]
    wide = physics.door_angle(template, state.physics).at[leaf].set(bank.physics.door_fully_open[0, leaf])
    data = state.physics.replace(qpos=state.physics.qpos.at[template.layout.door_qpos].set(wide))
    pos = bank.compartments.centers(bank.physics, 0, wide)[slots[0]]  # in the open drawer
    there = jnp.ones((env.bank.spec.num_bodies, 1), bool)[:, 0], pos[None].repeat(bank.spec.num_bodies, 0)
    data = put_bodies(CONFIG, bank, data, (*there, bank.physics.body_quat[0]))
    update = jax.jit(lambda params, state: env.core.task.update(env.core.snapshot(params, state), state.task))
    after = update(env.params, state.replace(physics=data))
    found = np.asarray(after.features.values)
    assert found[Feature.OPEN, 0, 1, 0] == pytest.approx(1, abs=0.02)
    assert found[Feature.CONTAINED, 0, 0, 1] == slots[0]
    assert int(after.stage) == SUCCESS


def test_containers_are_the_furniture_around_a_point_and_its_opening(env, states, house):
    bank = env.bank
    slots, closed = np.arange(len(house.compartments.leaf)), bank.physics.door_closed[0]
    middle = jnp.asarray(house.compartments.pos, jnp.float32)
    leaf = np.asarray(bank.compartments.door[0])[slots]
    half = closed.at[leaf[0]].set((closed + bank.physics.door_fully_open[0])[leaf[0]] / 2)
    points = jnp.concatenate([middle, middle.at[:, 2].add(1.5)])
    ids, opening = containers_at(bank, jnp.int32(0), closed, points)
    table = np.asarray(bank.semantics)
    (chest,) = set(table[table[:, Semantic.COARSE] == COARSE.index("dresser"), Semantic.OBJECT_ID].tolist())
    assert ids.tolist() == [chest] * len(slots) + [-1] * len(slots)
    assert np.abs(np.asarray(opening)).max() < 1e-6
    slide = jnp.zeros(3).at[:2].set(bank.physics.door_slide[0, leaf[0]] * TRAVEL / 2)
    ids, opening = containers_at(bank, jnp.int32(0), half, (middle[0] + slide)[None])
    assert (int(ids[0]), float(opening[0])) == (chest, pytest.approx(0.5, abs=1e-3))


def test_a_compartment_is_empty_before_its_thing_begins_there():
    """Two stored cups are in the two drawers that hold any; only the first one may be in that of the row."""
    house = compile_house(*home(blocked=False, cups=2), CompileOptions(articulation=ArticulationOptions(8)))
    task = Opened(num_tasks=8, min_length=0.2)
    env = HouseholdEnv(CONFIG.replace(stored_bodies=2), task).bind(HouseBank.from_compiled([house]))
    slots, template = named(env), physics_template(CONFIG, env.bank.spec)
    keys = jax.random.split(jax.random.key(3), len(slots))
    states = jax.jit(jax.vmap(env.core.reset, (None, 0, None, 0)))(env.params, keys, None, jnp.arange(len(slots)))
    pos, angle = jax.vmap(lambda data: (physics.body_pose(template, data)[0], physics.door_angle(template, data)))(
        states.physics
    )
    within = jax.vmap(lambda a, p: compartment_at(env.bank, jnp.int32(0), a, p))(angle, pos)
    assert np.asarray(within)[:, 0].tolist() == slots.tolist()
    assert (np.asarray(within)[:, 1] != slots).all()
    assert np.isin(-1, np.asarray(within)[:, 1])  # one was in the row's drawer before


@pytest.mark.parametrize(
    ("condition", "said"),
    [
        ({"minimum": 5.0, "maximum": 5.0}, "the house has no compartment 5"),
        ({"minimum": 0.5, "maximum": 0.5}, "the house has no compartment 0.5"),
        ({"first": 1, "second": 0}, "is not in the furniture"),
        ({"first": 1}, "no movable object"),
    ],
)
def test_files_with_impossible_compartments_are_refused(env, tmp_path, condition, said):
    file = tmp_path / "tasks.jsonl"
    save_tasks(file, env.bank, env.params.tasks)
    assert len(load_tasks(file, env.bank)) == len(env.params.tasks)
    line = json.loads(file.read_text().splitlines()[0])
    line["stages"][0]["transitions"][0]["require"][0] |= condition
    file.write_text(json.dumps(line) + "\n")
    with pytest.raises(DatasetError, match=said) as raised:
        load_tasks(file, env.bank)
    assert raised.value.element == "line 1, stages"


def test_rows_with_compartments_need_houses_that_have_them(env, tmp_path):
    """Also rows in memory, whose houses nobody reads from a file."""
    bare, file = HouseBank.from_compiled([compile_house(*home(blocked=False))]), tmp_path / "tasks.jsonl"
    save_tasks(file, env.bank, env.params.tasks)
    with pytest.raises(DatasetError, match="the house has no compartment"):
        load_tasks(file, bare)
    columns = host_columns(env.params.tasks.rows)
    assert first_without_compartment(columns, env.bank) is None
    assert first_without_compartment(columns, bare) == (0, "`contained` needs compartments, and no house has any")
    changed = columns | {"minimum": columns["minimum"] + 7, "maximum": columns["maximum"] + 7}
    row, said = first_without_compartment(changed, env.bank)
    assert (row, said) == (0, f"the house has no compartment {named(env)[0] + 7}")
