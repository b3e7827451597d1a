"""Sound alone: from a source and a listener in each environment to what the two ears hear."""

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from home_mjx.audio_jax.auralization.response import impulse_response
from home_mjx.audio_jax.auralization.sources import clip_samples
from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.endpoints import Listener, Source
from home_mjx.audio_jax.motion.frame import moving_frame
from home_mjx.audio_jax.motion.reception import reception
from home_mjx.bank.bank import HouseBank
from home_mjx.bench.batch import eye_at, own_body, rate_per_environment, scene_at
from home_mjx.bench.record import Record, Settings, make_record

CONFIG = AudioConfig()


def response(settings: Settings) -> Record:
    """Impulse responses."""
    value, seconds = rate_per_environment(settings, _response)
    note = f"{CONFIG.num_rays} rays, {CONFIG.num_bounces} bounces, {CONFIG.response_length} samples; {settings.houses}"
    return make_record(
        "audio/response", value, "responses/s", note, num_envs=settings.num_envs, compile_seconds=seconds
    )


def frame(settings: Settings) -> Record:
    """What a head receives and the sound frame made of it, with tail, as one step of an environment makes them."""
    clip = jnp.asarray(clip_samples("radio", CONFIG))
    heard = clip[np.arange(CONFIG.memory_length - 1 + CONFIG.frame + CONFIG.ahead) % clip.size]

    def hear(bank: HouseBank, house: jax.Array, start: jax.Array) -> jax.Array:
        new = _response(bank, house, start, reception)
        return moving_frame(heard, new, new, CONFIG)

    value, seconds = rate_per_environment(settings, hear)
    note = f"response, then a stereo frame of {CONFIG.frame} samples; {settings.houses}"
    return make_record("audio/frame", value, "frames/s", note, num_envs=settings.num_envs, compile_seconds=seconds)


def _response(bank: HouseBank, house: jax.Array, start: jax.Array, hear: Callable[..., Any] = impulse_response) -> Any:
    """What an agent at `start` hears of the house's first goal."""
    source = bank.navigation.goal[house, 0] + jnp.array([0.0, 0.0, 1.0], jnp.float32)
    scene = scene_at(bank, house, start)
    listener = Listener(*eye_at(start), body=own_body(bank))
    return hear(scene, Source(source), listener, jax.random.key(0), CONFIG)


CASES: dict[str, Callable[[Settings], Record]] = {"response": response, "frame": frame}
