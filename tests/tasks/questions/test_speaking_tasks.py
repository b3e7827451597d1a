"""Tasks in which agents speak, in one mix of two agents: what words do, who hears them, and what experts say."""

import json

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from spoken_words import number
from whole_episodes import begun, played

from home_mjx.errors import ConfigError, DatasetError
from home_mjx.houses import load_bank
from home_mjx.physics import PhysicsConfig
from home_mjx.schema.semantic import Semantic
from home_mjx.tasks import EnvConfig, HouseholdEnv, expert_action, load_tasks, save_tasks
from home_mjx.tasks.language import detokenize, tokenize
from home_mjx.tasks.questions.dialogue import QUESTION_WORDS, UNKNOWN
from home_mjx.tasks.rules.enums import ANY, NUM_DESCRIPTORS, NUM_REPLIES, Attribute, TargetKind
from home_mjx.tasks.rules.house_view import house_views
from home_mjx.tasks.rules.packing import pack_speech
from home_mjx.tasks.rules.resolve import resolve_targets_on_host
from home_mjx.tasks.rules.speech import words_of_others
from home_mjx.tasks.suite import VQA, Communication, Dialogue, HouseQA, HouseTasks, ObjectNav

STOPS = {"stop": True}
MIX = HouseTasks(
    tasks=(HouseQA(kinds=("existence", "color")), Dialogue(**STOPS), Communication(**STOPS), ObjectNav(**STOPS)),
    num_tasks=4,
    failure_cost=0.25,
)
SENSORS = ("goal_words", "instruction", "reply", "heard_words")
MOST_STEPS = 400


def config_of(num_agents, sensors=("state",)):
    physics = PhysicsConfig(impl="kinematic", num_agents=num_agents)
    return EnvConfig(sensors=sensors, actions="discrete", physics=physics)


@pytest.fixture(scope="module")
def bank():
    return load_bank("procedural:4?preset=flat")


@pytest.fixture(scope="module")
def env(bank):
    return HouseholdEnv(config_of(2, SENSORS), MIX).bind(bank)


@pytest.fixture(scope="module")
def states(env):
    """Of every row."""
    rows = len(env.params.tasks)
    keys, index = jax.random.split(jax.random.key(0), rows), jnp.arange(rows)
    return jax.jit(jax.vmap(env.core.reset, (None, 0, None, 0)))(env.params, keys, None, index)


@pytest.fixture(scope="module")
def step(env):
    return jax.jit(jax.vmap(env.core.step, (None, 0, 0)))


def column(env, name):
    return np.asarray(env.params.tasks.rows.columns[name])


def rows_of(env, name):
    return np.flatnonzero(column(env, "task") == env.params.tasks.names.index(name))


def says(env, tokens):
    """Actions of one agent that say these tokens; `stopped` where one cannot be said."""
    names = env.core.action_names
    word = {int(tokenize(name.partition(":")[2])[0]): number for number, name in enumerate(names) if ":" in name}
    return np.array([word.get(int(token), 0) for token in tokens])


def both(first, second):
    return jnp.asarray(np.stack([first, second], axis=1), jnp.int32)


def test_the_mix_lets_agents_say_all_that_its_tasks_do(env):
    names = env.core.action_names
    assert {"answer:yes", "answer:red", "say:colour", "say:on", "say:kitchen"} < set(names)
    assert "answer:wood" not in names
    assert len(set(names)) == len(names)
    for wrong in (HouseQA(), Communication(**STOPS)):
        with pytest.raises(ConfigError):
            HouseholdEnv(EnvConfig(), wrong)
    with pytest.raises(ConfigError, match="num_agents=2"):
        HouseholdEnv(config_of(1), MIX)


def test_right_answers_succeed_and_others_fail(env, states, step):
    asks, answer = rows_of(env, "HouseQA"), column(env, "answer")
    stays = np.full(len(answer), env.core.action_names.index("look_up"))
    right = step(env.params, states, both(says(env, answer), stays))
    wrong_token = np.where(answer == tokenize("no")[0], tokenize("yes")[0], tokenize("no")[0])
    wrong = step(env.params, states, both(says(env, wrong_token), stays))
    second = step(env.params, states, both(stays, says(env, answer)))  # the first agent is asked
    assert np.asarray(right.metrics["success"])[asks].all()
    assert (np.asarray(right.metrics["answered"])[asks] == 1).all()
    assert (np.asarray(right.reward)[asks, 0] > 2).all()
    assert not np.asarray(wrong.metrics["success"])[asks].any()
    assert np.asarray(wrong.terminated)[asks].all()
    quiet = np.asarray(step(env.params, states, both(stays, stays)).reward)
    np.testing.assert_allclose(quiet[asks] - np.asarray(wrong.reward)[asks], MIX.failure_cost, atol=1e-5)
    assert not np.asarray(second.terminated)[asks].any()
    other = np.setdiff1d(np.arange(len(answer)), asks)
    assert not np.asarray(wrong.terminated)[other].any()  # words end no other task


def test_the_oracle_replies_to_who_has_asked_and_each_question_costs(env, states, step):
    rows, oracle = rows_of(env, "Dialogue"), column(env, "oracle")
    stays = np.full(len(oracle), env.core.action_names.index("look_up"))
    assert len(rows) >= 4
    quiet = step(env.params, states, both(stays, stays))
    assert not np.asarray(quiet.obs["reply"])[rows].any()
    for question in ("colour", "size", "material", "room", "on"):
        asked = np.full(len(oracle), tokenize(question)[0])
        after = step(env.params, states, both(says(env, asked), stays))
        own = oracle[rows][oracle[rows][..., 0] == asked[0]]
        np.testing.assert_array_equal(np.asarray(after.obs["reply"])[rows, 0, 0], own[:, 1])
        assert not np.asarray(after.obs["reply"])[rows, 1].any()  # the other one has not asked
        np.testing.assert_array_equal(after.metrics["questions"][rows], np.ones(len(rows)))
        cost = np.asarray(quiet.reward)[rows, 0] - np.asarray(after.reward)[rows, 0]
        np.testing.assert_allclose(cost, MIX.question_cost, atol=1e-5)
        later = step(env.params, after, both(stays, stays))
        assert not np.asarray(later.obs["reply"]).any()
        assert not np.asarray(later.terminated)[rows].any()
    others = np.setdiff1d(np.arange(len(oracle)), rows)
    assert not np.asarray(after.obs["reply"])[others].any()


def test_the_oracle_tells_the_truth_and_enough(env, bank):
    """By masks: what it says of the thing holds, and what is to be asked means it alone."""
    columns = {name: column(env, name) for name in ("oracle", "num_identifying_questions", "descriptor")}
    houses = np.asarray(env.params.tasks.rows.house)
    things = {(view.house, t.object_id): t for view in house_views(bank) for t in view.objects}
    word_of = {tokenize(question)[0]: word for word, question in QUESTION_WORDS.items()}
    for at in rows_of(env, "Dialogue"):
        category, target = columns["descriptor"][at, :2]
        assert category[Attribute.OBJECT_ID] == ANY  # which one is meant is not told
        told, number_of = category.astype(np.int32).copy(), int(target[Attribute.OBJECT_ID])
        thing = things[int(houses[at]), number_of]
        for place, (question, reply) in enumerate(columns["oracle"][at].tolist()):
            if question in word_of:
                said, word = detokenize([reply]), word_of[question]
                if said == UNKNOWN:
                    assert place >= columns["num_identifying_questions"][at]
                    continue
                alone = category.astype(np.int32).copy()
                alone[word] = number(word, said)
                assert number_of in meant(bank, houses[at], alone)
                if place < columns["num_identifying_questions"][at]:
                    told[word] = number(word, said)
            elif question == tokenize("on")[0] and thing.semantic(Semantic.SUPPORTER) >= 0:
                below = things[int(houses[at]), thing.semantic(Semantic.SUPPORTER)]
                assert number(Attribute.COARSE, detokenize([reply])) == below.semantic(Semantic.COARSE)
        assert len(meant(bank, houses[at], category.astype(np.int32))) > 1
        assert meant(bank, houses[at], told) == {number_of}


def meant(bank, house, words):
    """Objects that these words mean in a house."""
    whole = np.full((1, NUM_DESCRIPTORS, len(Attribute)), ANY, np.int32)
    whole[0, 0] = words
    assert words[Attribute.KIND] == TargetKind.OBJECT
    mask = resolve_targets_on_host(bank, int(house), whole).instance[0, 0]
    return set(np.asarray(bank.geometry.instance_object[int(house)])[mask].tolist())


def test_only_the_speaker_is_told_and_the_listener_hears_it_a_step_later(env, states, step):
    rows, code = rows_of(env, "Communication"), column(env, "answer")
    assert len(rows) >= 4
    words, told = (np.asarray(states.obs[name])[rows] for name in ("goal_words", "instruction"))
    assert (words[:, 0] == ANY).all()
    assert not told[:, 0].any()
    assert (words[:, 1, Attribute.ROOM_TYPE] >= 0).all()
    assert all(detokenize(text).startswith("go to the ") for text in told[:, 1])
    everybody = np.setdiff1d(np.arange(len(code)), rows)
    np.testing.assert_array_equal(*(np.asarray(states.obs["instruction"])[everybody, agent] for agent in (0, 1)))
    assert not np.asarray(states.obs["heard_words"]).any()
    stays = np.full(len(code), env.core.action_names.index("look_up"))
    after = step(env.params, states, both(stays, says(env, code)))
    np.testing.assert_array_equal(np.asarray(after.obs["heard_words"])[rows, 0, 0], code[rows])
    assert not np.asarray(after.obs["heard_words"])[rows, 1].any()
    assert not np.asarray(step(env.params, after, both(stays, stays)).obs["heard_words"]).any()


def test_who_is_heard():
    assert words_of_others(jnp.array([3])).tolist() == [-1]
    assert words_of_others(jnp.array([-1, -1, 4])).tolist() == [4, 4, -1]


def test_a_file_keeps_what_is_said(env, bank, tmp_path):
    path, tasks = tmp_path / "tasks.jsonl", env.params.tasks
    save_tasks(path, bank, tasks)
    again = load_tasks(path, bank)
    for name in (
        "answer",
        "instructed_agents",
        "oracle",
        "num_identifying_questions",
        "tokens",
        "require",
        "minimum",
        "maximum",
    ):
        np.testing.assert_array_equal(again.rows.columns[name], tasks.rows.columns[name])
    text = path.read_text()
    assert '"instructed_agents": [1]' in text
    dialogue = next(json.loads(line) for line in text.splitlines() if '"oracle"' in line)
    path.write_text(json.dumps(dialogue | {"oracle": [["colour", "blorb"]]}) + "\n")
    with pytest.raises(DatasetError, match="blorb"):
        load_tasks(path, bank)


def test_an_oracle_has_room_for_some_questions():
    assert pack_speech(oracle=[(1, 2)] * NUM_REPLIES)["oracle"].shape == (NUM_REPLIES, 2)
    for wrong in ({"oracle": [(1, 2)] * (NUM_REPLIES + 1)}, {"oracle": [(1, 2)], "num_identifying_questions": 2}):
        with pytest.raises(ConfigError, match="replies"):
            pack_speech(**wrong)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("task", "num_agents", "least"),
    [
        (HouseQA(num_tasks=24), 1, 0.95),
        (VQA(num_tasks=24), 1, 1.0),
        (Dialogue(num_tasks=24, **STOPS), 1, 0.94),
        (Communication(num_tasks=24, **STOPS), 2, 0.95),
    ],
    ids=["HouseQA", "VQA", "Dialogue", "Communication"],
)
def test_experts_succeed_and_chance_does_not(bank, task, num_agents, least):
    env = HouseholdEnv(config_of(num_agents), task).bind(bank)
    first = begun(env)
    of_all = (lambda action: action) if num_agents > 1 else (lambda action: action[0])
    expert = played(
        env, first, lambda s, _: of_all(expert_action(env.core.snapshot(env.params, s), s.task)), MOST_STEPS
    )
    assert len(env.params.tasks) >= 40
    assert np.asarray(expert.metrics["success"]).mean() >= least
    count = len(env.core.action_names)
    shape = (num_agents,) if num_agents > 1 else ()
    drawn = played(env, first, lambda _, key: jax.random.randint(key, shape, 0, count), MOST_STEPS)
    assert np.asarray(drawn.metrics["success"]).mean() < 0.08
