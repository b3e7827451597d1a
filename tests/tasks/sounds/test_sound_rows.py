"""Sounds of rows: written, read, refused; and where they are in an environment."""

import dataclasses
import functools
import json
from dataclasses import dataclass

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from home_mjx.audio_jax import CLIPS
from home_mjx.errors import ConfigError
from home_mjx.houses import load_bank
from home_mjx.navigation import geodesic_distance
from home_mjx.physics import PhysicsConfig
from home_mjx.tasks import EnvConfig, EnvParams, HouseholdEnv, expert_action, load_tasks, save_tasks
from home_mjx.tasks.rules import SoundEvent
from home_mjx.tasks.rules.declaration import extract
from home_mjx.tasks.rules.enums import Attribute, TargetKind
from home_mjx.tasks.rules.packing import pack_sounds, unpack_sounds
from home_mjx.tasks.sounds.sound_events import NUM_SOUNDS, SoundEvents
from home_mjx.tasks.suite import AudioNav, HouseTasks, RoomNav
from home_mjx.tasks.suite.audio_nav import DISTRACTOR_CLIPS, SPLITS

OPTIONS = {"stop": True}
KINDS = {
    "place": AudioNav(**OPTIONS),
    "object": AudioNav(emitter="object", num_distractors=2, schedule="intermittent", clip_split="unheard", **OPTIONS),
    "moving": AudioNav(moving_source=True, num_distractors=1, schedule="once", **OPTIONS),
    "room": RoomNav(**OPTIONS),
}
MIX = HouseTasks(tasks=tuple(KINDS.values()), num_tasks=3)
CONFIG = EnvConfig(sensors=("state",), actions="discrete", physics=PhysicsConfig(impl="kinematic"))


@pytest.fixture(scope="module")
def bank():
    return load_bank("procedural:2?preset=flat")


@pytest.fixture(scope="module")
def env(bank):
    return HouseholdEnv(CONFIG, MIX).bind(bank)


@pytest.fixture(scope="module")
def columns(env):
    return {name: np.asarray(values) for name, values in env.params.tasks.rows.columns.items()}


@pytest.fixture(scope="module")
def walk(env):
    """States of every row at the reset, and after each of 20 turns."""
    rows = len(env.params.tasks)
    keys, index = jax.random.split(jax.random.key(0), rows), jnp.arange(rows)
    turn, states = jnp.full(rows, 2), []

    def reset(key, row):
        return env.core.reset(env.params, key, None, row, observe=False)

    begun = jax.jit(jax.vmap(reset))(keys, index)
    states.append(begun)
    step = jax.jit(jax.vmap(functools.partial(env.core.step, observe=False), (None, 0, 0)))
    for _ in range(20):
        states.append(step(env.params, states[-1], turn))
    return states


def of(columns, kind: str) -> np.ndarray:
    return np.flatnonzero(columns["task"] == list(KINDS).index(kind))


def test_sounds_are_read_as_they_were_written():
    sounds = [
        SoundEvent(0, "bell"),
        SoundEvent(2, "hum", period=3.0, duration=0.5, gain=0.25),
        SoundEvent(1, "ring", destination=2, speed=0.5),
    ]
    arrays = pack_sounds(sounds, 3)
    assert {values.shape for values in arrays.values()} == {(NUM_SOUNDS,)}
    assert unpack_sounds(arrays) == sounds
    on_device = {name: jnp.asarray(values) for name, values in arrays.items()}
    assert extract(SoundEvents, on_device).clip[:3].tolist() == [CLIPS.index(sound.clip) for sound in sounds]


@pytest.mark.parametrize(
    ("make", "what"),
    [
        (lambda: SoundEvent(0, "bel"), "Did you mean `bell`"),
        (lambda: SoundEvent(-1, "bell"), "emitter"),
        (lambda: SoundEvent(0, "bell", duration=0.0), "duration"),
        (lambda: SoundEvent(0, "bell", period=float("nan")), "period"),
        (lambda: pack_sounds([SoundEvent(2, "bell")], 2), "descriptor 2"),
        (lambda: pack_sounds([SoundEvent(0, "bell", destination=1)], 1), "descriptor 1"),
        (lambda: pack_sounds([SoundEvent(0, "bell")] * 5, 1), "at most 4"),
        (lambda: AudioNav(clip_split="new"), "new"),
        (lambda: AudioNav(schedule="seldom"), "seldom"),
        (lambda: AudioNav(moving_source=True, num_distractors=2), "distractors"),
    ],
)
def test_sounds_that_cannot_be_are_refused(make, what):
    with pytest.raises(ConfigError, match=what):
        make()


def test_splits_have_no_sound_in_common():
    heard, unheard, distracting = (set(x) for x in (SPLITS["heard"], SPLITS["unheard"], DISTRACTOR_CLIPS))
    assert not heard & unheard
    assert not (heard | unheard) & distracting
    assert heard | unheard | distracting <= set(CLIPS)


def test_rows_play_the_sounds_of_their_split(columns):
    names = np.array(CLIPS)[columns["sound_clip"]]
    for kind in ("place", "object", "moving"):
        rows = of(columns, kind)
        assert len(rows) >= 4
        assert set(names[rows, 0]) <= set(SPLITS[KINDS[kind].clip_split])
        count = 1 + KINDS[kind].num_distractors
        assert set(names[rows, 1:count].ravel()) <= set(DISTRACTOR_CLIPS)
        assert (columns["sound_emitter"][rows, count:] == -1).all()
        assert (columns["sound_emitter"][rows, :count] >= 1).all()  # the first descriptor is hidden
    assert (columns["sound_emitter"][of(columns, "room")] == -1).all()


def test_the_first_descriptor_says_nothing(columns):
    rows = np.concatenate([of(columns, kind) for kind in ("place", "object", "moving")])
    assert (columns["descriptor"][rows, 0] == -1).all()
    assert np.isinf(columns["place"][rows, 0]).all()
    assert KINDS["place"].observation_spec == {}


def test_the_goal_does_not_follow_from_the_clip(bank):
    """Whoever hears nothing but which clip it is knows nothing of the way: places and clips are drawn apart."""
    tasks = AudioNav(num_tasks=48, **OPTIONS).task_bank(bank)
    house = np.asarray(tasks.rows.house)
    clip = np.asarray(tasks.rows.columns["sound_clip"])[:, 0]
    place = np.asarray(tasks.rows.columns["place"])[:, 1]
    for h in range(bank.num_houses):
        places = [{*map(tuple, place[(house == h) & (clip == c)].tolist())} for c in set(clip.tolist())]
        assert min(len(x) for x in places) > 1


def test_sources_are_where_their_rows_say(env, bank, columns, walk):
    sounds = jax.tree.map(np.asarray, walk[0].world.sounds)
    assert sounds.pos.shape[1] == env.config.num_sources == 3
    rise = np.array([0, 0, CONFIG.source_height])
    for kind in ("place", "moving"):
        rows = of(columns, kind)
        np.testing.assert_allclose(sounds.pos[rows, 0], columns["place"][rows, 1] + rise, atol=1e-5)
    rows = of(columns, "object")
    geometry, house = bank.geometry, np.asarray(env.params.tasks.rows.house)
    for row in rows:
        for source in range(3):
            number = columns["descriptor"][row, source + 1, Attribute.OBJECT_ID]
            assert sounds.body[row, source] == number
            instance = int(np.flatnonzero(np.asarray(geometry.instance_object[house[row]]) == number)[0])
            pose = np.asarray(geometry.instance_pose[house[row], instance])
            box = np.asarray(geometry.model_box[geometry.instance_model[house[row], instance]])
            middle = pose[:, :3] @ box.mean(axis=0) + pose[:, 3]  # of its box, turned with it
            np.testing.assert_allclose(sounds.pos[row, source], middle, atol=0.02)
    silent = sounds.clip[of(columns, "place")]
    assert (silent[:, 0] >= 0).all()
    assert (silent[:, 1:] == -1).all()


def test_rows_without_sounds_keep_the_houses_source(columns, walk):
    rows = of(columns, "room")
    for state in (walk[0], walk[-1]):
        assert (np.asarray(state.world.sounds.clip)[rows] == [CLIPS.index("radio"), -1, -1]).all()
    np.testing.assert_array_equal(walk[0].world.source[rows], walk[-1].world.source[rows])


def test_a_source_walks_along_the_shortest_way(env, bank, columns, walk):
    rows, dt = of(columns, "moving"), env.dt
    speed = KINDS["moving"].source_speed
    house = np.asarray(env.params.tasks.rows.house)
    away = jax.jit(lambda h, goal, at: geodesic_distance(bank, h, goal, at, env.params.tasks.field))
    for row in rows:
        path = np.stack([np.asarray(state.world.sounds.pos)[row, 0] for state in walk])
        floor = path - [0, 0, CONFIG.source_height - 0.9]
        goal = jnp.int32(columns["field"][row, 2])
        left = np.array([float(away(jnp.int32(house[row]), goal, jnp.asarray(p, jnp.float32))) for p in floor])
        steps = np.linalg.norm(np.diff(path[:, :2], axis=0), axis=1)
        assert steps.max() <= speed * dt + 1e-5
        far = left[:-1] > 0.3
        assert (np.diff(left)[far] < 0.05).all()
        gone = left[0] - left[-1]
        assert gone > 0.6 * min(20 * speed * dt, left[0] - 0.2)
    other = walk[-1].world.sounds.pos[of(columns, "place"), 0]
    np.testing.assert_array_equal(other, walk[0].world.sounds.pos[of(columns, "place"), 0])


def test_a_file_of_tasks_holds_their_sounds(env, bank, columns, tmp_path):
    path = tmp_path / "tasks.jsonl"
    save_tasks(path, bank, env.params.tasks)
    again = load_tasks(path, bank)
    for name in ("sound_emitter", "sound_clip", "sound_period", "sound_duration", "sound_destination", "sound_speed"):
        np.testing.assert_array_equal(again.rows.columns[name], columns[name], err_msg=name)
    np.testing.assert_array_equal(again.rows.columns["descriptor"], columns["descriptor"])
    lines = [json.loads(line) for line in path.read_text().splitlines()]
    assert all("sounds" not in line for line in lines if line["task"] == "RoomNav")
    loud = next(line for line in lines if len(line.get("sounds", ())) == 3)
    assert loud["sounds"][0]["period"] == 3.0
    assert loud["sounds"][0]["clip"] in SPLITS["unheard"]


def test_sounds_that_would_not_be_heard_are_refused(env):
    few = HouseholdEnv(dataclasses.replace(CONFIG, clips=CLIPS), RoomNav(**OPTIONS))
    with pytest.raises(ConfigError, match="num_sources=3"):
        few.bind(EnvParams(env.bank, env.params.tasks))
    mute = HouseholdEnv(dataclasses.replace(CONFIG, num_sources=3), RoomNav(**OPTIONS))
    with pytest.raises(ConfigError, match="clips="):
        mute.bind(EnvParams(env.bank, env.params.tasks))
    HouseholdEnv(dataclasses.replace(CONFIG, num_sources=3, clips=CLIPS), RoomNav(**OPTIONS)).bind(env.params)


@dataclass(frozen=True)
class Nothing:
    """A generator without sounds."""

    name = "Nothing"

    def rows(self, view, random):
        return iter(())


def test_a_mix_plays_what_its_tasks_play():
    assert MIX.num_sources == 3
    assert set(MIX.clips) == {*SPLITS["all"], *DISTRACTOR_CLIPS}
    assert HouseTasks(tasks=(Nothing(),)).num_sources == 1
    assert TargetKind.NOTHING == -1


@pytest.mark.slow
def test_experts_go_to_what_sounds_and_chance_does_not(env, columns, walk):
    """The three kinds of AudioNav; expert actions are computed where the state is."""

    def run(act):
        def step(states, key):
            actions = jax.vmap(act)(states, jax.random.split(key, states.done.shape[0]))
            after = jax.vmap(functools.partial(env.core.step, observe=False), (None, 0, 0))(env.params, states, actions)
            return jax.vmap(lambda o, a: jax.tree.map(lambda x, y: jnp.where(o.done, x, y), o, a))(states, after), None

        keys = jax.random.split(jax.random.key(1), 500)
        return jax.jit(lambda s: jax.lax.scan(step, s, keys)[0])(walk[0])

    rows = np.concatenate([of(columns, kind) for kind in ("place", "object", "moving")])
    expert = run(lambda s, _: expert_action(env.core.snapshot(env.params, s), s.task)[0])
    assert np.asarray(expert.metrics["success"])[rows].mean() >= 0.99
    random = run(lambda _, key: jax.random.randint(key, (), 0, 6))
    assert np.asarray(random.metrics["success"])[rows].mean() < 0.1
