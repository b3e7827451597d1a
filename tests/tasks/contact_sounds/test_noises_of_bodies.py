"""Noises of bodies against what they do: paths walked, free fall, doors that move."""

import functools

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from handmade import Furniture, shoebox

from home_mjx import HouseBank, HouseholdEnv
from home_mjx.audio_jax import ContactSoundConfig
from home_mjx.audio_jax.contact_sounds.sound_bank import SUSTAINED, TRANSIENTS
from home_mjx.tasks import Status, Variation, make_config

RATE, FRAME = 16000, 1600
QUIET = {"late": "traced", "num_rays": 4, "num_bounces": 1, "num_edges": 0, "sensors": ("audio",)}
AHEAD = jnp.array([1.0, 0.0, 0.0, 0.0])


class Room:
    """An environment in a bare room of 12 m by 10 m, with a box of 5 kg."""

    def __init__(self, contact_sounds=ContactSoundConfig(), **options):  # noqa: B008
        box = Furniture(position=(3.0, 2.0), mass=5.0)
        self.core = HouseholdEnv(make_config(contact_sounds=contact_sounds, **{**QUIET, **options}))
        self.env = self.core.bind(HouseBank.from_compiled([shoebox((12.0, 10.0, 3.0), furniture=[box])]))
        self.advance = jax.jit(functools.partial(self.core.step, observe=False))
        self.begun = jax.jit(functools.partial(self.core.reset, observe=False))(self.env.params, jax.random.key(0))

    def placed(self, *agents, lift=0.0):
        """Agents at (x, y, yaw), the box lifted."""
        qpos = self.begun.physics.qpos
        for a, (x, y, yaw) in enumerate(agents):
            qpos = qpos.at[4 * a + jnp.array([0, 1, 3])].set(jnp.float32([x, y, yaw]))
        return self.begun.replace(physics=self.begun.physics.replace(qpos=qpos.at[4 * len(agents) + 2].add(lift)))

    def run(self, state, action, steps):
        """All states after."""
        states = []
        for _ in range(steps):
            state = self.advance(self.env.params, state, action)
            states.append(state)
        return states


def struck(states) -> list[tuple[int, str, float]]:
    """Start [samples], name and gain of all strikes of some states, each once."""
    found = {}
    for state in states:
        s = state.world.contact_sounds.transients
        for start, row, gain in zip(*(np.asarray(x) for x in (s.start, s.row, s.gain)), strict=True):
            if gain > 0:
                found[int(start), int(row)] = (int(start), TRANSIENTS[row], float(gain))
    return sorted(found.values())


@pytest.fixture(scope="module")
def room():
    return Room()


@pytest.mark.parametrize("impl", ["fused", "kinematic"])
def test_as_many_footsteps_as_lengths_were_walked(room, impl):
    """6 m at 1 m/s: nine steps of 0.65 m, 0.65 s apart, as loud as the speed says; floors of no known kind are soft."""
    place = room if impl == "fused" else Room(impl="kinematic")
    start = place.placed((-4.0, -2.0, 0.0))
    states = place.run(start, AHEAD, 62)
    walked = float(states[-1].physics.qpos[0] - start.physics.qpos[0])
    steps = struck(states)
    assert walked > 5.9
    assert len(steps) == int(walked / 0.65)
    assert {name.rsplit("_", 1)[0] for _, name, _ in steps} == {"step_soft"}
    apart = np.diff([time for time, *_ in steps])
    np.testing.assert_allclose(apart, 0.65 * RATE, atol=40)
    np.testing.assert_allclose([gain for *_, gain in steps], 1.0, atol=0.02)
    place = states[-1].world.contact_sounds.transients.pos
    np.testing.assert_allclose(place[:, 1:], [[-2.0, 0.05]] * 4, atol=5e-3)  # in its own lane, just over the floor
    assert not any(int(s.status) for s in states)


def test_who_stands_or_turns_makes_no_step(room):
    for action in (jnp.zeros(4), jnp.array([0.0, 0.0, 1.0, 0.0])):
        assert struck(room.run(room.placed((-4.0, -2.0, 0.0)), action, 15)) == []


def test_slow_steps_are_softer(room):
    steps = struck(room.run(room.placed((-4.0, -2.0, 0.0)), 0.5 * AHEAD, 45))
    assert len(steps) == 3
    np.testing.assert_allclose([gain for *_, gain in steps], 0.5, atol=0.02)


@pytest.fixture(scope="module")
def drops(room):
    """Strikes of a box that falls by 0.3, 0.5 and 1 m."""
    heights = (0.3, 0.5, 1.0)
    return {h: struck(room.run(room.placed((-4.0, -2.0, 0.0), lift=h), jnp.zeros(4), 10)) for h in heights}


def test_a_dropped_box_is_heard_when_it_lands(drops):
    """After sqrt(2 h / g), within half a step; the first step's frame is the second one."""
    for height, found in drops.items():
        (start, name, _), *more = found
        assert more == []
        assert name == "hit_wood"
        assert start / RATE - FRAME / RATE == pytest.approx(np.sqrt(2 * height / 9.81), abs=0.055)


def test_it_is_louder_the_harder_it_lands(drops):
    """The gain is the impulse in N s: mass times the speed of landing, and what of its weight lasts for the step."""
    gains = [found[0][2] for found in drops.values()]
    assert gains == sorted(gains)
    for height, gain in zip(drops, gains, strict=True):
        landing = 5.0 * np.sqrt(2 * 9.81 * height)
        assert landing - 5 * 9.81 * 0.1 <= gain <= 1.1 * landing


def test_what_lies_still_is_silent_and_what_is_pushed_scrapes(room):
    """A box that an agent walks into: a soft blow (and another where it hops), then a scrape until it stops.

    The scrape's gain is the root of its friction's power, 0.4 m g v watts.
    """
    states = room.run(room.placed((1.5, 2.0, 0.0)), AHEAD, 22)
    hits = [x for x in struck(states) if x[1].startswith("hit")]
    assert 1 <= len(hits) <= 3
    assert all(0 < gain < 1 for *_, gain in hits)
    touching = next(i for i, x in enumerate(states) if float(x.physics.qpos[4]) > 3.005)
    assert hits[0][0] == (touching + 1) * FRAME + FRAME // 2
    rubs = states[-1].world.contact_sounds.sustained
    speed = float(states[-1].physics.qpos[4] - states[-2].physics.qpos[4]) / 0.1
    assert speed > 0.8
    assert SUSTAINED[int(rubs.row[0])] == "scrape_wood"
    assert float(rubs.gain[0, 0]) == pytest.approx(np.sqrt(0.4 * 5 * 9.81 * speed), rel=1e-3)
    np.testing.assert_allclose(rubs.pos[0], states[-1].physics.qpos[4:7], atol=1e-5)
    after = room.run(states[-1], jnp.array([-1.0, 0, 0, 0]), 6)
    assert float(after[-1].world.contact_sounds.sustained.gain[0, 0]) == 0


def test_doors_creak_and_thud(generated_bank):
    """A leaf that is driven shut: it creaks at its speed, and there is one thud, where and when it stops."""
    core = HouseholdEnv(
        make_config(contact_sounds=ContactSoundConfig(footsteps=False), impl="kinematic", doors="open", **QUIET)
    )
    env, doors = core.bind(generated_bank), generated_bank.physics
    hinged = np.asarray(doors.door_valid[0]) & ~np.any(np.asarray(doors.door_slide[0]), axis=1)
    row = int(np.flatnonzero(hinged)[0])
    state = jax.jit(functools.partial(core.reset, observe=False))(env.params, jax.random.key(0), 0)
    goal = state.physics.door_goal.at[row].set(doors.door_closed[0, row])
    state = state.replace(physics=state.physics.replace(door_goal=goal))
    advance = jax.jit(functools.partial(core.step, observe=False))
    angle = jax.jit(lambda state: core.snapshot(env.params, state).door_angle[row])
    angles, gains, states = [float(angle(state))], [], []
    for _ in range(40):
        state = advance(env.params, state, jnp.zeros(4))
        states.append(state)
        angles.append(float(angle(state)))
        gains.append(float(state.world.contact_sounds.sustained.gain[0, 0]))
    assert abs(angles[-1] - float(doors.door_closed[0, row])) < 0.02
    rate = np.abs(np.diff(angles)) / 0.1
    np.testing.assert_allclose(gains, np.where(rate > 0.05, rate, 0.0), atol=1e-4)
    ((start, name, gain),) = struck(states)
    stopped = 1 + int(np.flatnonzero(np.abs(np.array(angles[1:]) - float(doors.door_closed[0, row])) < 0.02)[0])
    assert name == "thud"
    assert start == (stopped + 1) * FRAME - 1
    assert gain == pytest.approx(rate[stopped - 1], rel=1e-4)


def test_agents_are_heard_where_nothing_else_moves():
    """A bank without movable bodies and doors has footsteps, and nothing that could scrape or creak."""
    core = HouseholdEnv(make_config(contact_sounds=ContactSoundConfig(), impl="kinematic", **QUIET))
    env = core.bind(HouseBank.from_compiled([shoebox((12.0, 10.0, 3.0))]))
    state = jax.jit(functools.partial(core.reset, observe=False))(env.params, jax.random.key(0))
    advance = jax.jit(functools.partial(core.step, observe=False))
    state = state.replace(physics=state.physics.replace(qpos=state.physics.qpos.at[:2].set(0.0)))
    for _ in range(8):
        state = advance(env.params, state, AHEAD)
    assert int((state.world.contact_sounds.transients.gain > 0).sum()) == 1
    assert not np.any(state.world.contact_sounds.sustained.gain)


def test_more_than_the_slots_hold_is_told():
    """Two agents side by side, one slot."""
    place = Room(ContactSoundConfig(num_transients=1), num_agents=2)
    states = place.run(place.placed((-4.0, -2.0, 0.0), (-4.0, -3.0, 0.0)), jnp.stack([AHEAD, AHEAD]), 9)
    status = [int(s.status) & Status.NOISES for s in states]
    assert any(status)
    assert not all(status)


def test_noises_are_heard_and_off_they_cost_nothing():
    """A radio that is switched off: an agent hears its own steps, and nothing before the first."""
    place = Room(sensors=("audio", "ear_levels"))
    silent = place.placed((-4.0, -2.0, 0.0))
    silent = silent.replace(world=silent.world.replace(sounds=silent.world.sounds.replace(gain=jnp.zeros(1))))
    look = jax.jit(functools.partial(place.core.observe, update=True))
    state = look(place.env.params, silent)
    heard, levels = [], []
    for _ in range(10):
        state = look(place.env.params, place.advance(place.env.params, state, AHEAD))
        heard.append(10 * np.log10(np.mean(np.asarray(state.obs["audio"]) ** 2) + 1e-20))
        levels.append(
            10 * np.log10(np.mean(10 ** (np.asarray(state.obs["ear_levels"]).reshape(2, -1) / 10), axis=0).sum())
        )
    first = next(i for i, x in enumerate(heard) if x > -100)
    assert 6 <= first <= 8  # the first step is at 0.65 m
    assert max(heard) > -60
    loudest = int(np.argmax(heard))
    assert levels[loudest] == pytest.approx(heard[loudest], abs=4)
    off = HouseholdEnv(make_config(contact_sounds=None, **QUIET))
    assert jax.eval_shape(off.reset, place.env.params, jax.random.key(0)).world.contact_sounds is None
    assert off.config.num_traced_sources == 1


def test_episodes_draw_how_long_steps_are_and_how_loud_noises():
    """Steps one drawn length apart, each as loud as without the range: what is heard of them is a factor louder."""
    place = Room()
    variation = Variation.of(footstep_distance=(0.3, 0.9), contact_sound_volume=(0.25, 4.0))
    varied, keys = place.env.params.replace(variation=variation), jax.random.split(jax.random.key(1), 3)

    def walk(state, params):
        def one(state, _):
            state = place.core.step(params, state, AHEAD)
            return state, (state.obs["audio"], state.world.contact_sounds.transients, state.physics.qpos[0])

        return jax.lax.scan(one, state, length=15)[1]

    def begun(params, key):
        state = place.core.reset(params, key, observe=False)
        physics = state.physics.replace(qpos=place.placed((-4.0, -2.0, 0.0)).physics.qpos)
        off = state.world.sounds.replace(gain=jnp.zeros(1))
        return state.replace(physics=physics, world=state.world.replace(sounds=off))

    states = jax.jit(jax.vmap(begun, (None, 0)))(varied, keys)
    drawn, run = states.world.variation, jax.jit(jax.vmap(walk, (0, None)))
    quiet = states.replace(world=states.world.replace(variation=drawn.replace(contact_sound_volume=jnp.ones(3))))
    (heard, strikes, x), (plain, _, _) = run(states, varied), run(quiet, varied)
    for number, length in enumerate(np.asarray(drawn.footstep_distance)):
        here = jax.tree.map(lambda leaf, number=number: np.asarray(leaf[number]), strikes)
        starts = np.unique(here.start[here.gain > 0])
        assert len(starts) == int((float(x[number, -1]) + 4.0) / length)
        np.testing.assert_allclose(np.diff(starts), length * RATE, atol=40)
    assert len(np.unique(drawn.footstep_distance)) == 3
    assert np.abs(plain).max() > 1e-4
    np.testing.assert_allclose(heard, np.asarray(drawn.contact_sound_volume)[:, None, None, None] * plain, atol=1e-6)
