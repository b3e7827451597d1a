"""Tasks of hands: what is drawn can be done, rewards cannot be farmed, experts do it and chance does not."""

import dataclasses

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import KDTree
from scipy.spatial.transform import Rotation
from whole_episodes import begun, played

import home_mjx
from home_mjx.errors import ConfigError
from home_mjx.houses import load_bank
from home_mjx.physics import PhysicsConfig
from home_mjx.schema.compiled import FIELD_UNIT
from home_mjx.schema.semantic import Semantic
from home_mjx.tasks import EnvConfig, HouseholdEnv, expert_action, load_tasks, save_tasks
from home_mjx.tasks.language import detokenize
from home_mjx.tasks.rules import SUCCESS, Feature
from home_mjx.tasks.rules.cell_graph import MAX_TURN_DISTANCE
from home_mjx.tasks.rules.declaration import extract
from home_mjx.tasks.rules.enums import NUM_CONDITIONS, Attribute, TargetKind
from home_mjx.tasks.rules.house_view import house_views
from home_mjx.tasks.rules.packing import pack_program
from home_mjx.tasks.rules.program import Selector, TaskProgram, take_transition
from home_mjx.tasks.suite import Fetch, HouseTasks, Rearrange
from home_mjx.tasks.suite.portable_objects import find_portable_objects

HANDS = {"hands": True, "max_aim_angle": 10.0, "max_pitch": 1.05}
TASKS = HouseTasks(tasks=(Fetch(stop=True), Rearrange(stop=True, max_objects=2)), num_tasks=5)
MOST_STEPS = 400


@pytest.fixture(scope="module")
def bank():
    return load_bank("procedural:4?preset=flat")


@pytest.fixture(scope="module")
def tasks(bank):
    return TASKS.task_bank(bank)


@pytest.fixture(scope="module")
def views(bank):
    return house_views(bank)


def meant_by(view, words: np.ndarray) -> list:
    """The things that a descriptor means, by a loop over what is in the house."""
    columns = {
        Attribute.COARSE: (Semantic.COARSE,),
        Attribute.COLOR: (Semantic.COLOR, Semantic.COLOR_2, Semantic.COLOR_3),
        Attribute.SIZE: (Semantic.SIZE,),
        Attribute.MATERIAL: (Semantic.MATERIAL,),
        Attribute.ROOM_TYPE: (Semantic.ROOM_TYPE,),
    }
    used = {word: words[word] for word in columns if words[word] >= 0}
    return [
        thing
        for thing in view.objects
        if all(any(thing.semantic(column) == value for column in columns[word]) for word, value in used.items())
    ]


def rows_of(tasks, name: str) -> list[dict]:
    """Rows of one task as dictionaries of arrays."""
    columns = {key: np.asarray(value) for key, value in tasks.rows.columns.items()}
    columns |= {"house": np.asarray(tasks.rows.house), "start": np.asarray(tasks.rows.start)}
    chosen = np.flatnonzero(columns["task"] == tasks.names.index(name)).tolist()
    return [{key: value[i] for key, value in columns.items()} for i in chosen]


def things_to_take(row: dict) -> list[int]:
    """Descriptors that conditions ask to be held."""
    return sorted({int(d) for f, d in zip(row["feature"], row["first"], strict=True) if f == Feature.HELD})


@pytest.mark.parametrize("name", ["Fetch", "Rearrange"])
def test_every_house_has_tasks_of_things_that_hands_can_take(bank, tasks, views, name):
    rows = rows_of(tasks, name)
    assert {int(row["house"]) for row in rows} == set(range(bank.num_houses))
    for row in rows:
        view = views[row["house"]]
        below = {thing.semantic(Semantic.SUPPORTER) for thing in view.objects}
        for d in things_to_take(row):
            (thing,) = meant_by(view, row["descriptor"][d])
            assert thing.body >= 0
            assert bank.physics.body_mass[view.house, thing.body] <= 10
            assert (thing.box[1] - thing.box[0]).max() <= 0.7
            assert thing.object_id not in below


@pytest.mark.parametrize("name", ["Fetch", "Rearrange"])
def test_ways_end_where_hands_reach(tasks, views, name):
    """A thing's bounds are within reach of the axis of who stands where its field is least."""
    for row in rows_of(tasks, name):
        view = views[row["house"]]
        for d in things_to_take(row):
            (thing,) = meant_by(view, row["descriptor"][d])
            cells = len(view.graph.place)
            first = int(np.asarray(view.bank.navigation.first_cell)[view.house])
            field = np.asarray(tasks.field)[first : first + cells, row["field"][d]]
            at = view.graph.place[np.argmin(field)]
            gap = np.maximum(np.maximum(thing.box[0, :2] - at[:2], at[:2] - thing.box[1, :2]), 0)
            assert np.hypot(*gap) <= 0.93
            assert at[2] - 0.1 <= thing.box[0, 2] <= at[2] + 1.6


def test_things_are_put_on_others_on_which_they_are_not(tasks, views):
    seen = 0
    for row in rows_of(tasks, "Rearrange"):
        view, pairs = views[row["house"]], []
        for f, i, j in zip(row["feature"], row["first"], row["second"], strict=True):
            if f == Feature.ON:
                (thing,), (below,) = (meant_by(view, row["descriptor"][d]) for d in (i, j))
                pairs += [thing.object_id, below.object_id]
                assert thing.semantic(Semantic.SUPPORTER) != below.object_id
                top = below.box[1, 2] - view.graph.place[:, 2].min()
                assert 0.2 < top < 1.4
        assert len(set(pairs)) == len(pairs)
        seen += len(pairs) // 2
    assert seen > len(rows_of(tasks, "Rearrange"))  # some rows have two


def test_here_is_where_the_episode_begins_and_lengths_have_all_legs(tasks, views):
    texts = []
    for row in rows_of(tasks, "Fetch"):
        texts.append(detokenize(row["tokens"]))
        if row["descriptor"][1, Attribute.KIND] == TargetKind.PLACE:
            assert texts[-1].endswith("here")
            np.testing.assert_allclose(row["place"][1], row["start"], atol=1e-5)
        first = int(np.asarray(views[0].bank.navigation.first_cell)[row["house"]])
        view = views[row["house"]]
        cell = np.argmin(np.linalg.norm(view.graph.place - row["start"], axis=1))
        way = np.asarray(tasks.field)[first + cell, row["field"][0]] * FIELD_UNIT
        assert row["length"] >= way - 0.02
    assert all(text.startswith("bring the") for text in texts)


def test_a_file_of_them_holds_their_fields(bank, tasks, tmp_path):
    """Where ways end depends on what is done there, which conditions say: a file needs nothing else for it."""
    path = tmp_path / "hands.jsonl"
    few = tasks.pick(jnp.arange(8))
    save_tasks(path, bank, few)
    again = load_tasks(path, bank)
    for i in range(8):
        first = int(bank.navigation.first_cell[few.rows.house[i]])
        for d in range(4):
            old, new = int(few.rows.columns["field"][i, d]), int(again.rows.columns["field"][i, d])
            assert (old < 0) == (new < 0)
            if old >= 0:
                np.testing.assert_array_equal(
                    few.field[first : first + 500, old], again.field[first : first + 500, new]
                )


def radius_of(view, thing) -> float:
    """How far a thing reaches in the plan [m]."""
    size, quat = (
        np.asarray(x[view.house, thing.body]) for x in (view.bank.physics.body_size, view.bank.physics.body_quat)
    )
    return np.linalg.norm((Rotation.from_quat(quat, scalar_first=True).as_matrix() * size)[:2])


def free_at(view, thing, floor: np.ndarray, height: float, radius: float) -> np.ndarray:
    """Places over which a disc as high as a thing touches nothing at a height, by boxes of the bank one by one."""
    physics, place = view.bank.physics, floor[:, :2]
    half = (thing.box[1, 2] - thing.box[0, 2]) / 2
    free = np.ones(len(place), bool)
    middle = floor[:, 2] + height
    for pos, turn, box in zip(
        *(np.asarray(getattr(physics, f"collider_{name}")[view.house]) for name in ("pos", "quat", "size")), strict=True
    ):
        matrix = Rotation.from_quat(turn, scalar_first=True).as_matrix()
        rise = np.abs(matrix[2]) @ box
        local = np.abs((place - pos[:2]) @ matrix[:2, :2])
        near = np.linalg.norm(np.maximum(local - box[:2], 0), axis=1) < radius
        free &= ~(near & (np.abs(middle - pos[2]) < rise + half))
    return free


@pytest.mark.parametrize("name", ["Fetch", "Rearrange"])
def test_what_is_to_be_carried_can_be_carried_away(tasks, views, name):
    """From where its way ends a free place is near that is joined to most of the house, furniture that moves aside."""
    checked = 0
    for row in rows_of(tasks, name):
        view = views[row["house"]]
        for d in things_to_take(row):
            (thing,) = meant_by(view, row["descriptor"][d])
            first = int(np.asarray(view.bank.navigation.first_cell)[view.house])
            field = np.asarray(tasks.field)[first : first + len(view.graph.place), row["field"][d]]
            free = free_at(view, thing, view.graph.place, view.bank.spec.agent_height - 0.55, radius_of(view, thing))
            cells = np.flatnonzero(free)
            pairs = KDTree(view.graph.place[cells]).query_pairs(view.bank.spec.cell * 1.5, output_type="ndarray")
            graph = csr_matrix((np.ones(len(pairs)), tuple(pairs.T)), shape=(len(cells),) * 2)
            part = connected_components(graph, directed=False)[1]
            out = cells[part == np.bincount(part).argmax()]
            end = view.graph.place[np.argmin(field)]
            assert np.linalg.norm(view.graph.place[out] - end, axis=1).min() <= 0.4
            checked += 1
    assert checked >= len(rows_of(tasks, name))


def turns_at(view, thing, cell: int, slack: float) -> bool:
    """Whether who stands in a cell can make a half turn with a thing, one way round or the other."""
    place, radius = view.graph.place[cell], radius_of(view, thing)
    way = (thing.box.mean(axis=0) - place)[:2]
    turn = np.exp(1j * np.radians(np.arange(0, 181, 20))) * complex(*way) / np.linalg.norm(way)
    ahead = view.bank.spec.agent_radius + 0.15 + radius
    arcs = [np.stack([x.real, x.imag, 0 * x.real], axis=1) * ahead for x in (turn, way_back(turn, way))]
    height = view.bank.spec.agent_height - 0.55
    return any(free_at(view, thing, place + arc, height, radius - slack).all() for arc in arcs)


def way_back(turn: np.ndarray, way: np.ndarray) -> np.ndarray:
    """The same directions, mirrored at the one that comes first."""
    along = complex(*way) / np.linalg.norm(way)
    return np.conj(turn / along) * along


@pytest.mark.parametrize("name", ["Fetch", "Rearrange"])
def test_who_takes_a_thing_can_turn_round_with_it(tasks, views, name):
    """Where ways to it end; boxes that stand still are looked at, one by one."""
    for row in rows_of(tasks, name):
        view = views[row["house"]]
        for d in things_to_take(row):
            (thing,) = meant_by(view, row["descriptor"][d])
            first = int(np.asarray(view.bank.navigation.first_cell)[view.house])
            field = np.asarray(tasks.field)[first : first + len(view.graph.place), row["field"][d]]
            assert turns_at(view, thing, int(np.argmin(field)), slack=0.05)


def test_a_thing_is_taken_from_where_one_can_turn_round_with_it():
    """Hands reach it from eighteen cells that were tried; in some the turn sweeps it into a wall."""
    (view,) = house_views(load_bank("procedural:1?seed=202&preset=flat"))
    (thing,) = [x.object for x in find_portable_objects(view, 10.0, 0.5) if x.instance == 35]
    cells, _ = view.take_cells(35)
    assert 0 < len(cells) < 18
    assert all(turns_at(view, thing, cell, slack=0.05) for cell in cells.tolist())


def test_what_lies_in_a_pocket_is_not_to_be_carried():
    """An agent fits through the ring of cells around it, with the thing in its hands it does not."""
    (view,) = house_views(load_bank("procedural:1?seed=207&preset=flat"))
    place = view.graph.place
    away = np.linalg.norm(place - np.median(place, axis=0), axis=1)
    pocket = np.flatnonzero(away < away.min() + 0.3)
    ring = (away >= away.min() + 0.3) & (away < away.min() + 0.5 + MAX_TURN_DISTANCE)
    outside = np.flatnonzero(away > away.min() + 0.7 + MAX_TURN_DISTANCE)
    assert min(len(pocket), np.sum(ring), len(outside)) > 8
    assert not view.graph.has_turning_room(pocket, ~ring).any()
    assert view.graph.has_turning_room(pocket, np.ones(len(place), bool)).all()
    assert view.graph.has_turning_room(outside, ~ring).mean() > 0.9


def told(program, stage: int, **features: bool) -> tuple[int, float]:
    """Next stage and reward if these features hold; `held0` is `HELD` of descriptor 0."""
    names = [f"{Feature(int(f)).name.lower()}{int(d)}" for f, d in zip(program.feature, program.first, strict=True)]
    holds = [features.get(name, features.get(name[:-1], False)) for name in names]
    bits = jnp.array([*holds, *[False] * (NUM_CONDITIONS - len(holds))][:NUM_CONDITIONS])
    after, reward, _ = take_transition(program, jnp.int32(stage), bits)
    return int(after), float(reward)


def one_program(task, count: int):
    stages = task._stages(count)
    arrays = pack_program([Selector.objects(coarse=k) for k in range(2 * count)], stages)
    return extract(
        TaskProgram, {name: jnp.asarray(value) for name, value in arrays.items()} | {"field": jnp.zeros(4, jnp.int32)}
    )


def test_two_things_one_after_the_other():
    program = one_program(Rearrange(max_objects=2), 2)
    quarter = pytest.approx(2.5 / 4)
    assert told(program, 0) == (0, 0.0)
    assert told(program, 0, held0=True) == (1, quarter)
    assert told(program, 1, held0=True, on0=True) == (1, 0.0)  # it must let go
    assert told(program, 1, on0=True) == (2, quarter)
    assert told(program, 2, on0=True, held2=True) == (3, quarter)
    assert told(program, 3, on0=True, on2=True) == (SUCCESS, quarter)


def test_what_is_undone_is_paid_back():
    program = one_program(Rearrange(max_objects=2), 2)
    _, gained = told(program, 0, held0=True)
    stage, lost = told(program, 1)  # neither in the hand nor where it should be
    assert stage == 0
    assert gained + lost == 0
    assert told(program, 0, on0=True) == (1, pytest.approx(gained))  # also if it got there otherwise


@pytest.mark.parametrize("stop", [False, True])
def test_what_is_put_down_and_falls_is_to_be_put_back(stop):
    """Rewards of the second thing are paid back as well, and paid again for what has stayed done."""
    program = one_program(Rearrange(max_objects=2, stop=stop), 2)
    part = pytest.approx(2.5 / 4)
    assert told(program, 2) == (0, -2 * part.expected)  # nothing in the hand: first things first
    assert told(program, 2, held2=True) == (3, part)
    assert told(program, 3, held2=True) == (3, 0.0)  # that one is put down first
    stage, lost = told(program, 3, on2=True)
    assert (stage, lost) == (0, pytest.approx(-3 * part.expected))
    stage, first = told(program, stage, on2=True, held0=True)
    stage, second = told(program, stage, on0=True, on2=True)
    stage, third = told(program, stage, on0=True, on2=True)
    assert stage == 3
    assert first + second + third == pytest.approx(-lost)


@pytest.mark.parametrize(
    ("task", "options", "words"),
    [
        ("Fetch", {"hands": False}, "needs hands"),
        ("Fetch", {"destinations": ("moon",)}, "moon"),
        ("Fetch", {"destinations": ()}, "destinations"),
        ("Fetch", {"success_distance": -1.0}, "success_distance"),
        ("Rearrange", {"max_objects": 3}, "max_objects"),
        ("Rearrange", {"max_mass": -1.0}, "max_mass"),
        ("Rearrange", {"max_aim_angle": 90.0}, "max_aim_angle"),
    ],
)
def test_options_that_cannot_be_are_refused(bank, task, options, words):
    with pytest.raises(ConfigError, match=words):
        home_mjx.make(f"{task}-v0", bank, **options)


def test_nothing_to_carry_is_no_task(bank):
    with pytest.raises(ConfigError, match="Rearrange yields no row"):
        Rearrange(max_mass=0.01).task_bank(bank)


@pytest.fixture(scope="module")
def env(bank, tasks):
    config = EnvConfig(sensors=("state",), actions="discrete", physics=PhysicsConfig(impl="kinematic"), **HANDS)
    return HouseholdEnv(config, TASKS).bind(bank)


@pytest.fixture(scope="module")
def reset(env):
    return begun(env)


def test_the_distance_at_the_start_has_all_legs(reset):
    np.testing.assert_allclose(reset.metrics["distance"], reset.task.length, atol=0.1)
    assert (np.asarray(reset.task.later_legs) > 0.1).mean() > 0.9


@pytest.mark.slow
@pytest.mark.parametrize("teaches", [False, True])
def test_experts_bring_things_and_put_them_down(env, reset, teaches):
    act = lambda s, _: expert_action(env.core.snapshot(env.params, s), s.task, teaches)[0]  # noqa: E731
    done = played(env, reset, act, MOST_STEPS)
    success, left = np.asarray(done.metrics["success"]), np.asarray(done.metrics["distance"])
    length = np.asarray(done.task.length)  # at the end it was that to the first thing, however far from its destination
    assert (left < np.maximum(2.0, 0.3 * length))[success > 0].all()  # large beds are reached from all sides
    progress = 1 - left / length
    ratio = np.asarray(done.metrics["spl"])[success > 0]
    np.testing.assert_allclose(
        np.asarray(done.metrics["soft_spl"])[success > 0], (progress[success > 0] * ratio).clip(0), atol=1e-5
    )
    for number, name in enumerate(env.params.tasks.names):
        own = np.asarray(done.task.task) == number
        assert own.sum() >= 12
        assert success[own].mean() >= 0.95, name


@pytest.mark.slow
def test_experts_fetch_what_has_been_dropped_from_where_it_lies(env, reset):
    """Everyone lets go once, twelve steps after it has taken something; fields lead to where things were before."""
    names, params = env.core.action_names, env.params

    def act(carry: tuple, _) -> tuple:
        state, time = carry
        snapshot = env.core.snapshot(params, state)
        time = jnp.where(snapshot.held[0] >= 0, time + 1, time)
        lets_go = time == 12
        action = jnp.where(lets_go, names.index("drop"), expert_action(snapshot, state.task)[0])
        after = env.core.step(params, state, action)
        after = jax.tree.map(lambda old, new: jnp.where(state.done, old, new), state, after)
        return (after, jnp.where(lets_go, 100, time)), None

    run = jax.jit(jax.vmap(lambda state: jax.lax.scan(act, (state, jnp.int32(0)), None, MOST_STEPS)[0]))
    done, time = run(reset)
    assert np.mean(np.asarray(time) >= 100) > 0.9
    assert np.asarray(done.metrics["success"]).mean() >= 0.9


@pytest.mark.slow
def test_chance_does_not_tidy_up(env, reset):
    num = int(env.core.action_spec.high) + 1
    done = played(env, reset, lambda _, key: jax.random.randint(key, (), 0, num), MOST_STEPS)
    assert np.asarray(done.metrics["success"]).mean() < 0.1


@pytest.mark.parametrize("env_id", ["Fetch-v0", "Rearrange-v0"])
def test_ids_have_hands(env_id, bank):
    env = home_mjx.make(env_id, bank, sensors=("state", "instruction"), num_tasks=1, impl="kinematic")
    assert env.core.action_names[-5:] == ("pick", "drop", "throw", "open", "close")
    assert dataclasses.asdict(env.core.task)["stop"]
    state = jax.eval_shape(env.reset, jax.random.key(0))
    assert set(state.obs) == {"state", "instruction"}


def test_without_any_destination_there_are_no_rows(views):
    """The generator ends instead of drawing for ever."""
    far = {"success_distance": 1000.0}  # [m], within which every object is of every other
    random = np.random.default_rng(0)
    assert next(Fetch(destinations=("object",), **far).rows(views[0], random), None) is None
    assert next(Fetch(destinations=("object", "start"), **far).rows(views[0], random), None) is not None
