"""Words as sounds: told apart by ear through a house, by a decoder that knows no more than how they are made."""

import itertools
import json

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.ndimage import distance_transform_edt

from home_mjx import physics
from home_mjx.audio_jax import AudioConfig
from home_mjx.errors import ConfigError
from home_mjx.houses import load_bank
from home_mjx.schema.timing import Timing
from home_mjx.tasks import HouseholdEnv, load_tasks, make_config, save_tasks
from home_mjx.tasks.language import tokenize
from home_mjx.tasks.language.vocabulary import all_words
from home_mjx.tasks.rules import SoundEvent
from home_mjx.tasks.rules.packing import pack_sounds
from home_mjx.tasks.sounds.sound_events import VOICE_CLIP, VOICE_CLIP_NUMBER
from home_mjx.tasks.sounds.word_sounds import (
    NUM_CHOICES,
    NUM_GROUPS,
    num_audible_frames,
    synthesize_voices,
    synthesize_word,
    word_tones,
)
from home_mjx.tasks.suite import Communication, HouseTasks

RATE, LISTENER, SPEAKER, LOOK_UP, LOOK_DOWN = 16000, 0, 1, 4, 5
MIX = HouseTasks(tasks=(Communication(stop=True), Communication(stop=True, channel="audible")), num_tasks=8)
OPTIONS = {
    "num_agents": 2,
    "actions": "discrete",
    "impl": "kinematic",
    "sensors": ("audio", "heard_words"),
    "doors": "open",
}
CORE = HouseholdEnv(make_config(**OPTIONS), MIX)
SAYS = {i: tokenize(name.partition(":")[2])[0] for i, name in enumerate(CORE.action_names) if ":" in name}


def mel(frequency):
    return 2595 * np.log10(1 + frequency / 700)


def decoded(audio):
    """The token that two ears heard, and the power of its weakest tone [dB]; None: no token has these tones."""
    steps = np.linspace(mel(300.0), mel(3600.0), 24)
    time = np.arange(audio.shape[-1]) / RATE
    sines = np.exp(-2j * np.pi * 700 * (10 ** (steps / 2595) - 1)[:, None] * time)
    power = np.sum(np.abs(audio @ sines.T) ** 2, axis=0).reshape(6, 4)
    digits = power.argmax(axis=1)
    token = sum(int(digit) * 4**place for place, digit in enumerate(digits[:5]))
    return (token if digits.sum() % 4 == 0 else None), 10 * np.log10(power.max(axis=1).min() + 1e-30)


@pytest.fixture(scope="module")
def env():
    return CORE.bind(load_bank("procedural:2?preset=flat", bakes=CORE.bakes))


@pytest.fixture(scope="module")
def step(env):
    return jax.jit(jax.vmap(env.core.step, (None, 0, 0)))


def audible(env):
    return np.flatnonzero(np.asarray(env.params.tasks.rows.columns["task"]) == 1)


def begun(env, step, **options):
    """Every row after a step in which nobody said anything."""
    core = HouseholdEnv(make_config(**OPTIONS | options), MIX)
    rows = len(env.params.tasks)
    keys, index = jax.random.split(jax.random.key(0), rows), jnp.arange(rows)
    states = jax.jit(jax.vmap(lambda key, row: core.reset(env.params, key, None, row, observe=False)))(keys, index)
    return step(env.params, states, acts(np.full(rows, LOOK_UP)))


def acts(speaker, listener=LOOK_UP):
    return jnp.asarray(np.stack([np.broadcast_to(listener, np.shape(speaker)), speaker], axis=1), jnp.int32)


@pytest.fixture(scope="module")
def quiet(env, step):
    return begun(env, step)


def drawn_words(env, seed):
    return np.random.default_rng(seed).choice(list(SAYS), len(env.params.tasks))


def recovered(env, states, said):
    """Shares of rows in which the listener and the speaker told the word."""
    audio, rows = np.asarray(states.obs["audio"], float), audible(env)
    right = [[decoded(audio[row, agent])[0] == SAYS[said[row]] for agent in (LISTENER, SPEAKER)] for row in rows]
    return np.mean(right, axis=0).tolist()


@pytest.mark.parametrize("doors", ["open", "closed"])
def test_every_word_is_told_by_ear_in_one_room_and_through_doors(env, step, quiet, doors):
    states = quiet if doors == "open" else begun(env, step, doors=doors)
    said = drawn_words(env, 0)
    after = step(env.params, states, acts(said))
    assert len(audible(env)) == 16
    assert recovered(env, after, said) == [1.0, 1.0]
    snapshots = jax.vmap(lambda s: env.core.snapshot(env.params, s).pose.pos)(after)
    away = np.linalg.norm(np.asarray(snapshots[:, 0] - snapshots[:, 1]), axis=-1)[audible(env)]
    assert (away > 4).any()
    assert (away < 2).any()


@pytest.mark.parametrize(("pauses", "least"), [(0, 0.85), (2, 1.0)])
def test_words_that_follow_each_other_are_told_apart(env, step, quiet, pauses, least):
    """Without a pause the reverberation of the word before may be louder, far from the speaker."""
    states, shares = quiet, []
    for seed in range(3):
        said = drawn_words(env, seed)
        states = step(env.params, states, acts(said))
        shares.append(recovered(env, states, said))
        for _ in range(pauses):
            states = step(env.params, states, acts(np.full(len(said), LOOK_UP)))
    assert np.min(np.mean(shares, axis=0)) >= least  # of 48 words each; of 16 alone the share varies by 2 words


def test_who_says_nothing_is_not_heard_and_words_fade(env, step, quiet):
    rows = audible(env)
    np.testing.assert_array_equal(np.asarray(quiet.obs["audio"])[rows], 0)
    states, power = step(env.params, quiet, acts(drawn_words(env, 0))), []
    for _ in range(num_audible_frames(env.config.audio)):
        power.append(np.sum(np.asarray(states.obs["audio"])[rows] ** 2, axis=(-2, -1)))
        states = step(env.params, states, acts(np.full(len(env.params.tasks), LOOK_DOWN)))
    assert (power[0] > 0).all()
    assert (power[1] < power[0]).all()
    np.testing.assert_array_equal(np.asarray(states.obs["audio"])[rows], 0)


def test_the_channel_of_a_row_says_how_words_are_heard(env, step, quiet):
    """Seen and not heard in rows of the discrete channel, where the house's radio plays on; the other way elsewhere."""
    rows, said = audible(env), drawn_words(env, 1)
    others = np.setdiff1d(np.arange(len(said)), rows)
    spoken, idle = (step(env.params, quiet, acts(a)) for a in (said, np.full(len(said), LOOK_UP)))
    heard = np.asarray(spoken.obs["heard_words"])[..., 0]
    assert not heard[rows].any()
    assert heard[others, LISTENER].tolist() == [SAYS[word] for word in said[others]]
    # Heads nod with what they do, about the axis of their ears: the same but for rounding.
    np.testing.assert_allclose(*(np.asarray(s.obs["audio"])[others] for s in (spoken, idle)), atol=1e-6)
    assert np.abs(np.asarray(idle.obs["audio"])[others]).max() > 0


def test_both_voices_are_heard_where_they_are(env, step, quiet):
    """If the listener speaks, both hear its word, and it itself the louder, where reverberation lets it."""
    said = drawn_words(env, 2)
    after = step(env.params, quiet, acts(np.full(len(said), LOOK_UP), said))
    assert recovered(env, after, said) == [1.0, 1.0]
    power = np.sum(np.asarray(after.obs["audio"])[audible(env)] ** 2, axis=(-2, -1))
    assert (power[:, LISTENER] > power[:, SPEAKER]).mean() > 0.9
    assert np.asarray(after.world.sounds.clip)[audible(env)].tolist() == [[VOICE_CLIP_NUMBER, VOICE_CLIP_NUMBER]] * 16


def open_line(bank, house, lengths):
    """A listener's and speakers' cells [m] on a line of the largest room of a house, far from its walls."""
    first, count = int(bank.navigation.first_cell[house]), int(bank.navigation.num_cells[house])
    cells = np.asarray(bank.navigation.cell_coords[first : first + count])
    rooms = np.asarray(bank.navigation.room[house])[tuple(cells.T)]
    own = cells[rooms == np.bincount(rooms[rooms >= 0]).argmax()]
    free = np.zeros(bank.navigation.room.shape[1:], bool)
    free[tuple(own.T)] = True
    clear = distance_transform_edt(np.pad(free[own[0, 0]], 64))  # both flats have one storey
    steps = np.round(np.array([0.0, *lengths]) / bank.spec.cell).astype(int)
    sides = [step * np.array([side]) for side in [(0, 1), (0, -1), (1, 0), (-1, 0)] for step in steps[:, None]]
    lines = own[:, None, None, 1:] + np.reshape(sides, (1, 4, len(steps), 2))
    best = clear[tuple(np.moveaxis(lines + 64, -1, 0))].min(axis=-1)
    line = lines[np.unravel_index(best.argmax(), best.shape)]
    assert best.max() > 0
    return (line[:, ::-1] + 0.5) * bank.spec.cell + np.asarray(bank.navigation.origin[house])


def test_the_level_falls_with_distance(env, step, quiet):
    """Between cells of one room that are far from its walls; the direct sound alone by the inverse of the way."""
    bank, number = env.bank, int(audible(env)[0])
    house = int(env.params.tasks.rows.house[number])
    listener, *places = open_line(bank, house, (0.7, 1.4, 2.8))
    floor = float(env.params.tasks.rows.start[number][2])
    template = env.core.template(bank)

    def heard(step, quiet):
        one = jax.tree.map(lambda x: x[number], quiet)
        angle = physics.door_angle(template, one.physics)

        def stands(place):
            pos = jnp.asarray([[*listener, floor], [*place, floor]], jnp.float32)
            return one.replace(physics=physics.reset(template, bank, jnp.int32(house), pos, jnp.zeros(2), angle, None))

        many = [stands(place) for place in places] * len(env.params.tasks)
        states = jax.tree.map(lambda *x: jnp.stack(x), *many[: len(env.params.tasks)])
        for word in (LOOK_UP, min(SAYS)):
            states = step(env.params, states, acts(np.full(len(env.params.tasks), word)))
        pos = np.asarray(jax.vmap(lambda s: env.core.snapshot(env.params, s).pose.pos)(states))[:3]
        return pos, np.asarray(states.obs["audio"])[:3, LISTENER]

    dry = {"late": "none", "num_reflections": 0}
    dry_step = jax.jit(jax.vmap(HouseholdEnv(make_config(**OPTIONS, **dry), MIX).step, (None, 0, 0)))
    pos, direct = heard(dry_step, begun(env, dry_step, **dry))
    rise = env.config.body.eye_height - env.config.body.height / 2
    way = np.linalg.norm(pos[:, SPEAKER] - pos[:, LISTENER] - [0, 0, rise], axis=1)
    first = [round(length / 343.2 * RATE) for length in way]
    level = [np.abs(sound[:, begin : begin + 400]).max() for sound, begin in zip(direct, first, strict=True)]
    np.testing.assert_allclose(level * way, level[0] * way[0], rtol=0.05)

    _, audio = heard(step, quiet)
    before = [np.abs(sound[:, : begin - 20]).max() for sound, begin in zip(audio, first, strict=True)]
    loudest = [np.abs(sound[:, begin - 10 : begin + 20]).max() for sound, begin in zip(audio, first, strict=True)]
    assert min(loudest) > 10 * max(before)  # nothing comes before the direct sound
    power = np.sum(audio**2, axis=(-2, -1))
    assert min(power[:2]) > power[2]  # near the speaker tones and their reflections add up as it happens
    assert (power > np.sum(direct**2, axis=(-2, -1))).all()


def test_any_two_words_differ_in_two_tones_at_least():
    num_words = NUM_CHOICES ** (NUM_GROUPS - 1)
    assert len(all_words()) <= num_words
    tones = np.asarray(word_tones(jnp.arange(num_words)))
    assert (np.sort(tones, axis=1) // 4 == np.arange(6)).all()
    sets = np.zeros((num_words, 24), int)
    sets[np.arange(num_words)[:, None], tones] = 1
    common = sets @ sets.T
    np.fill_diagonal(common, 0)
    assert common.max() == 4


@pytest.mark.parametrize("rate", [8000, 16000, 48000])
def test_a_word_is_as_loud_as_a_clip_at_any_rate(rate):
    config = AudioConfig(timing=Timing(sample_rate=rate))
    sound = np.asarray(synthesize_word(jnp.int32(tokenize("kitchen")[0]), config), float)
    assert len(sound) == round(0.2 * rate)
    middle = sound[len(sound) // 10 : -len(sound) // 10]
    np.testing.assert_allclose(np.sqrt(np.mean(middle**2)), 0.1, rtol=0.03)
    assert np.abs(sound[[0, -1]]).max() < 0.01
    assert not np.asarray(synthesize_word(jnp.int32(-1), config)).any()


def test_frames_of_words_are_parts_of_one_long_sound():
    """By hand: words put at the begin of their frames; short frames, so that words overlap."""
    config = AudioConfig()
    said = np.random.default_rng(3).choice([-1, *range(40)], size=(12, 2))
    frame, past, count = config.frame, config.memory_length - 1, num_audible_frames(config)
    sound = np.zeros((2, past + 12 * frame + 4000))
    for number, who in itertools.product(range(12), range(2)):
        word = np.asarray(synthesize_word(jnp.int32(said[number, who]), config))
        begin = past + number * frame
        sound[who, begin : begin + len(word)] += word
    spoken = jax.jit(lambda words: synthesize_voices(words, config))
    for number in range(12):
        rows = [said[number - ago] if ago <= number else [-1, -1] for ago in range(count)]
        expected = sound[:, number * frame : number * frame + past + frame]
        heard = np.asarray(spoken(jnp.asarray(rows)))
        np.testing.assert_allclose(heard[:, : past + frame], expected, atol=1e-6)
        assert heard.shape[1] == past + frame + config.num_lookahead


def test_voices_are_written_in_files(env, tmp_path):
    path = tmp_path / "tasks.jsonl"
    save_tasks(path, env.bank, env.params.tasks)
    lines = [json.loads(line) for line in path.read_text().splitlines()]
    assert [{"emitter": 1, "clip": VOICE_CLIP}, {"emitter": 2, "clip": VOICE_CLIP}] in [
        line.get("sounds") for line in lines
    ]
    again = load_tasks(path, env.bank).rows.columns
    np.testing.assert_array_equal(again["sound_clip"], env.params.tasks.rows.columns["sound_clip"])
    env.with_tasks(load_tasks(path, env.bank))  # voices are no clips that an environment might lack


@pytest.mark.parametrize(
    ("make", "what"),
    [
        (lambda: SoundEvent(1, VOICE_CLIP, period=3.0), "voice"),
        (lambda: SoundEvent(1, VOICE_CLIP, destination=2, speed=0.3), "voice"),
        (lambda: Communication(channel="audable"), "Did you mean `audible`"),
        (lambda: synthesize_word(jnp.int32(1), AudioConfig(timing=Timing(sample_rate=6000))), "6000 Hz"),
    ],
)
def test_voices_that_cannot_be_are_refused(make, what):
    with pytest.raises(ConfigError, match=what):
        make()


def test_only_agents_have_voices():
    assert pack_sounds([SoundEvent(1, VOICE_CLIP)], 2)["sound_clip"].tolist()[0] == VOICE_CLIP_NUMBER
    audible_alone = HouseholdEnv(make_config(**OPTIONS | {"sensors": None}), Communication(channel="audible"))
    assert "heard_words" not in audible_alone.observation_spec
    assert audible_alone.config.num_sources == 2
