"""The story without its pictures: its script is acted by puppets, and its environment is traced, not compiled.

So what it uses of sounds, doors, hands and names is tried in every fast run; `test_story.py` plays all of it.
"""

from dataclasses import dataclass, fields, replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from examples.story.actor import NAMES
from examples.story.film import Film
from examples.story.house import write_story_house
from examples.story.moment import Moment, moment_of
from examples.story.places import Places
from examples.story.play import Step, make_story_env, opening
from examples.story.script import CARRIER, WATCHER, Script
from home_mjx.tasks import HouseholdEnv

REACH = 1.2  # [m], of a puppet's hand


@pytest.fixture(scope="module")
def env(tmp_path_factory: pytest.TempPathFactory):
    root = tmp_path_factory.mktemp("story")
    write_story_house(root)
    return make_story_env(root, sensors=("rgb", "audio"), width=8, height=6)


@pytest.fixture(scope="module")
def places(env) -> Places:
    return Places.of(env.bank)


@dataclass
class Puppets:
    """Both agents as points that do what actions say, in straight lines through anything but a closed door."""

    script: Script
    now: Moment

    def act(self, actions: np.ndarray) -> None:
        config, dt = self.script.carrier.config, self.script.carrier.config.timing.ctrl_dt
        told = [dict(zip(NAMES, action, strict=True)) for action in actions]
        pos, yaw, pitch = self.now.pos.copy(), self.now.yaw.copy(), self.now.pitch.copy()
        for agent, body in enumerate(config.agents):
            yaw[agent] += told[agent]["turn_left"] * body.turn_rate * dt
            pitch[agent] += told[agent]["look_up"] * config.max_pitch_rate * dt
            step = told[agent]["forward"] * body.forward_speed * dt * np.array([np.cos(yaw[agent]), np.sin(yaw[agent])])
            if agent == WATCHER or not self._is_shut(pos[agent, :2] + step):
                pos[agent, :2] += step
        pos[CARRIER, 2] = self._height(pos[CARRIER])
        self.now = replace(self.now, pos=pos, yaw=yaw, pitch=pitch)
        self._use(told[CARRIER])

    def _use(self, told: dict[str, float]) -> None:
        lamp, door = self.script.places.lamp, self.script.places.door
        here, held = self.now.pos[CARRIER], self.now.held.copy()
        bodies, angle = self.now.body_pos.copy(), self.now.door_angle.copy()
        if told["turn_door"] > 0 and np.linalg.norm(door.middle[:2] - here[:2]) < REACH:
            angle[0] += 0.2 * (door.wide - angle[0])
        if told["pick"] > 0 and held[CARRIER] == lamp.body:
            held[CARRIER], bodies[lamp.body] = -1, self.script.spot(self.now) + np.array([0, 0, lamp.half[2]])
        elif told["pick"] > 0 and np.linalg.norm(bodies[lamp.body] - here) < REACH:
            held[CARRIER] = lamp.body
        if held[CARRIER] == lamp.body:
            yaw = self.now.yaw[CARRIER]
            bodies[lamp.body] = here + 0.4 * np.array([np.cos(yaw), np.sin(yaw), 0.0])
        self.now = replace(self.now, held=held, body_pos=bodies, door_angle=angle)

    def _is_shut(self, to: np.ndarray) -> bool:
        """Whether a step would lead through the door's plane while it is not open."""
        door = self.script.places.door
        sides = [np.sign((at - door.middle[:2]) @ door.through) for at in (self.now.pos[CARRIER, :2], to)]
        return sides[0] != sides[1] and abs(self.now.door_angle[0] - door.wide) > 0.2

    def _height(self, pos: np.ndarray) -> float:
        stairs = self.script.places.stairs
        part = np.clip((pos[:2] - stairs.foot) @ stairs.up / np.linalg.norm(stairs.head - stairs.foot), 0, 1)
        half = self.script.carrier.config.agents[CARRIER].height / 2
        return float(half + part * stairs.upstairs)


def first_moment(env, places: Places) -> Moment:
    """The carrier before the closed door, the watcher near its place."""
    physics = env.bank.physics
    door, half = places.door, env.config.agents[CARRIER].height / 2
    before = door.middle[:2] - 2.0 * door.through
    pos = np.array([[*before, half], [*(places.lookout + 0.5), half + places.stairs.upstairs]])
    count = physics.body_pos.shape[1]
    return Moment(
        pos=pos,
        yaw=np.zeros(2),
        pitch=np.zeros(2),
        held=np.array([-1, -1]),
        door_angle=np.array(physics.door_closed[0], float),
        body_pos=np.array(physics.body_pos[0], float),
        body_frame=np.tile(np.eye(3), (count, 1, 1)),
        body_speed=np.zeros(count),
    )


def test_puppets_act_the_script_to_its_end(env, places):
    """Every stage ends within its limit, by actions alone: the door must be opened, the lamp taken and put down."""
    script = Script(env.config, places)
    puppets = Puppets(script, first_moment(env, places))
    assert not script.stands(puppets.now)
    told = []
    for stage in script.stages():
        told.append(stage.caption)
        for _ in range(round(stage.limit / env.dt)):
            if stage.done(puppets.now):
                break
            puppets.act(np.stack([stage.act(puppets.now), script.watch(puppets.now)]))
        assert stage.done(puppets.now), f"puppets are not done where the story `{stage.caption}`: {puppets.now}"
    assert len(told) == len(set(told)) == 10
    last = puppets.now
    assert last.door_angle[0] == pytest.approx(places.door.wide, abs=0.2)
    assert script.is_upstairs(last)
    assert last.held.tolist() == [-1, -1]
    assert script.stands(last)
    assert script.watcher.distance(last, places.lookout) < 0.2


def test_actors_and_environment_mean_the_same_by_an_action(env):
    assert tuple(env.core.action_names) == NAMES


def test_the_loudspeaker_is_what_sounds(env, places):
    """It is in the state that the story begins with, and a step later."""
    physics = replace(env.config.physics, impl="kinematic")
    core = HouseholdEnv(env.config.replace(sensors=("state",), physics=physics), env.task)
    params = core.bind(env.bank).params

    def run(key):
        state = opening(core, params, key, places)
        return state.world.sounds, core.step(params, state, jnp.zeros((2, len(NAMES)))).world.sounds

    first, later = jax.jit(run)(jax.random.PRNGKey(0))
    speaker = np.asarray(env.bank.physics.body_pos[0])[:, :2]
    for sounds in (first, later):
        np.testing.assert_allclose(sounds.pos[0], places.sound, atol=1e-6)
        assert np.linalg.norm(speaker - sounds.pos[0, :2], axis=-1).min() < 1e-3
        assert int(sounds.clip[0]) >= 0


def test_every_step_gives_what_the_script_and_the_film_read(env, places):
    """Traced: the same state again, all fields of a moment, both agents' images and sound."""
    core, key = env.core, jax.ShapeDtypeStruct((2,), jnp.uint32)
    state = jax.eval_shape(lambda params, key: opening(core, params, key, places), env.params, key)
    actions = jax.ShapeDtypeStruct((2, len(NAMES)), jnp.float32)
    after = jax.eval_shape(core.step, env.params, state, actions)
    assert jax.tree.structure(after) == jax.tree.structure(state)
    assert jax.tree.map(lambda x: (x.shape, x.dtype), after) == jax.tree.map(lambda x: (x.shape, x.dtype), state)
    read = jax.eval_shape(lambda params, state: moment_of(core, params, state), env.params, after)
    assert set(read) == {field.name for field in fields(Moment)}
    count = env.bank.physics.body_pos.shape[1]
    assert {name: x.shape for name, x in read.items()} == {
        "pos": (2, 3), "yaw": (2,), "pitch": (2,), "held": (2,), "door_angle": env.bank.physics.door_closed.shape[1:],
        "body_pos": (count, 3), "body_frame": (count, 3, 3), "body_speed": (count,),
    }  # fmt: skip
    assert after.obs["pixels/head_rgb"].shape == (2, 6, 8, 3)
    assert after.obs["audio"].shape[:2] == (2, 2)


def test_the_film_takes_a_step(env, places):
    """Its shot of a state: both agents' eyes, a plan of each storey, and the carrier's sound."""
    film = Film(env, places.lamp.body)
    moment = first_moment(env, places)
    state = jax.jit(lambda key: opening(env.core, env.params, key, places))(jax.random.PRNGKey(0))
    film.told(Step("stands", moment, state))
    (shot,) = film.shots
    assert [image.shape for image in shot.eyes] == [(6, 8, 3)] * 2
    assert len(shot.plans) == env.bank.navigation.floor.shape[1]
    assert np.ptp(shot.plans[0]) > 0
    assert shot.sound.shape[0] == 2
