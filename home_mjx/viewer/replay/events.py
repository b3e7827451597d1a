"""Events of an episode: contacts, sounds, words, large rewards and the end."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from home_mjx.audio_jax.base.endpoints import SoundSources
from home_mjx.scene_compile import decode_row
from home_mjx.tasks.base.snapshot import contact_semantics
from home_mjx.tasks.base.state import State
from home_mjx.tasks.env.env import Env
from home_mjx.tasks.env.household import HouseholdEnv
from home_mjx.tasks.env.observers import EpisodeStep
from home_mjx.tasks.sensors.selection import state_owners
from home_mjx.viewer.episodes.goal_markers import get_utterances
from home_mjx.viewer.replay.track import Event

CONTACT, SOUND, WORDS, REWARD, END = KINDS = ("contact", "sound", "words", "reward", "end")
AUDIO = "audio"  # sensor state of agents that hear
MIN_REWARD = 0.5  # smallest absolute reward of a step that counts as an event


class EventLog:
    """Events of the first agent's episode.

    Args:
        env: The environment.

    Attributes:
        events: Events so far.
        feet: Lowest point of the first agent after each step [m].
    """

    def __init__(self, env: Env[HouseholdEnv]) -> None:
        self._env, self._look = env, jax.jit(self._seen)
        self._hears = AUDIO in {sensor.name for sensor in state_owners(env.core.sensors)}
        self.clear()

    def clear(self) -> None:
        """Begin another episode."""
        self.events: list[Event] = []
        self.feet: list[np.ndarray] = []
        self._touched, self._sounding = False, np.zeros(0, bool)

    def add(self, step: EpisodeStep) -> None:
        """Add the events of a step."""
        feet, touches, other, sounding = (np.asarray(x) for x in self._look(self._env.params, step.state))
        found = {WORDS: get_utterances(step.state)}
        if touches and not self._touched:
            found[CONTACT] = (f"touches {_name(other)}",)
        began = sounding if not self.feet else sounding & ~self._sounding
        if self._hears and began.any():
            found[SOUND] = tuple(f"source {n} begins to sound" for n in np.flatnonzero(began))
        reward = float(np.reshape(step.state.reward, -1)[0])
        if abs(reward) >= MIN_REWARD:
            found[REWARD] = (f"reward {reward:+.2f}",)
        if step.state.done:
            success = float(step.state.metrics.get("success", 0.0)) > 0
            found[END] = ("success" if success else "failure",)
        self._touched, self._sounding = bool(touches), sounding
        self.feet.append(feet)
        self.events += [Event(step.index, kind, text) for kind in KINDS for text in found.get(kind, ())]

    def _seen(self, params: Any, state: State) -> tuple[Any, ...]:
        """Return feet and contact of the first agent, semantics of what it touches, and which sources sound."""
        snapshot = self._env.core.snapshot(params, state)
        other = contact_semantics(snapshot.scene, snapshot.body_contacts).other[0]
        time = snapshot.step.astype(jnp.float32) * self._env.dt
        return snapshot.feet[0], snapshot.in_contact[0], other, is_sounding(snapshot.sounds, time)


def is_sounding(sounds: SoundSources, time: Any) -> Any:
    """Return a mask of the sources that sound at `time` [s]; see `SoundSources` for periods.

    Example:
        >>> one, none = jnp.ones(1), jnp.full(1, -1)
        >>> tick = SoundSources(jnp.zeros((1, 3)), none, clip=0 * none, gain=one, period=2 * one, duration=0.5 * one)
        >>> bool(is_sounding(tick, jnp.float32(2.25))[0]), bool(is_sounding(tick, jnp.float32(3.0))[0])
        (True, False)
    """
    is_periodic = jnp.isfinite(sounds.period)
    within = jnp.where(is_periodic, jnp.mod(time, jnp.where(is_periodic, sounds.period, 1.0)), time)
    return (sounds.clip >= 0) & (sounds.gain > 0) & (within < sounds.duration)


def _name(row: np.ndarray) -> str:
    """Return the category of a row of semantics, in words."""
    return str(decode_row(row).get("fine", "something")).replace("_", " ")
