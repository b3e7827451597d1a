"""Runner of the story in an environment: to its end, or to an error that names the failed stage."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from examples.story.moment import Moment, moment_of, to_host
from examples.story.places import Places
from examples.story.script import CARRIER, WATCHER, Script, Stage
from home_mjx.env_factory import make
from home_mjx.errors import HomeMjxError
from home_mjx.tasks.base.state import EnvParams, State
from home_mjx.tasks.env.env import Env
from home_mjx.tasks.env.household import HouseholdEnv

TRIED = 1 << 14  # keys, of which the first that gives a suitable start is taken
STRIP = (1.2, 3.0, 0.8)  # [m], before the door, where the carrier starts: nearest, farthest, to either side
AROUND = 1.0  # [m], from its place, where the watcher starts


@dataclass(frozen=True)
class Step:
    """Report on each step."""

    caption: str
    moment: Moment
    state: State


def make_story_env(root: Path, **options: Any) -> Env[HouseholdEnv]:
    """Two agents with hands in the house below a dataset root, its doors closed.

    Args:
        root: Where `write_story_house` wrote it.
        options: Of `home_mjx.make`.
    """
    return make(
        "PointNav-v0", root, num_houses=1, num_agents=2, hands=True, doors="closed", episode_length=10**6, **options
    )


def play(env: Env[HouseholdEnv], told: Callable[[Step], None] = lambda step: None) -> Moment:
    """Plays the story.

    Args:
        env: As `make_story_env` makes it.
        told: Called after every step.

    Returns:
        How it ends.

    Raises:
        HomeMjxError: A stage took longer than its limit.
    """
    core, params = env.core, env.params
    places = Places.of(env.bank)
    script = Script(core.config, places)
    state = jax.jit(lambda params, key: opening(core, params, key, places))(params, suitable_start(env, places))
    look = jax.jit(lambda params, state: moment_of(core, params, state))
    step = jax.jit(core.step)
    moment = to_host(look(params, state))
    for stage in script.stages():
        for _ in range(round(stage.limit / core.dt)):
            if stage.done(moment):
                break
            actions = np.stack([stage.act(moment), script.watch(moment)])
            state = step(params, state, jnp.asarray(actions))
            moment = to_host(look(params, state))
            told(Step(stage.caption, moment, state))
        else:
            raise _too_late(stage, moment)
    return moment


def opening(core: HouseholdEnv, params: EnvParams, key: jax.Array, places: Places) -> State:
    """The first state that a key gives, in which the loudspeaker plays; pure JAX."""
    state = core.reset(params, key, observe=False)
    return state.replace(world=state.world.move_source(jnp.asarray(places.sound, jnp.float32)))


def suitable_start(env: Env[HouseholdEnv], places: Places) -> jax.Array:
    """The first key that starts the carrier before the door and the watcher near its place.

    Raises:
        HomeMjxError: There is none among many keys.
    """
    keys = jax.random.key_data(jax.random.split(jax.random.key(0), TRIED))
    start = jax.jit(
        jax.vmap(lambda p, k: moment_of(env.core, p, env.core.reset(p, k, observe=False))["pos"], (None, 0))
    )
    pos = np.asarray(start(env.params, keys))
    door, upstairs = places.door, places.stairs.upstairs
    away = door.middle[:2] - pos[:, CARRIER, :2]
    ahead, aside = away @ door.through, abs(away @ np.array([-door.through[1], door.through[0]]))
    fits = (ahead > STRIP[0]) & (ahead < STRIP[1]) & (aside < STRIP[2]) & (pos[:, CARRIER, 2] < upstairs)
    fits &= np.linalg.norm(pos[:, WATCHER, :2] - places.lookout, axis=-1) < AROUND
    fits &= pos[:, WATCHER, 2] > upstairs
    if not fits.any():
        raise HomeMjxError(f"none of {TRIED} starts suits the story", hint="Leave more floor free before the door.")
    return keys[int(np.argmax(fits))]


def _too_late(stage: Stage, moment: Moment) -> HomeMjxError:
    pos, held = np.round(moment.pos[CARRIER], 2).tolist(), int(moment.held[CARRIER])
    return HomeMjxError(
        f"the story stops: after {stage.limit:g} s the agent is not done where it `{stage.caption}`: it is at {pos}, "
        f"holds {'nothing' if held < 0 else f'body {held}'}, the door is at {float(moment.door_angle[0]):.2f} rad"
    )
