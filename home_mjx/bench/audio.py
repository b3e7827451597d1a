"""Sound alone: from a source and a listener in each environment to what the two ears hear."""

from collections.abc import Callable
from functools import partial
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from home_mjx.audio_jax.auralization.response import impulse_response
from home_mjx.audio_jax.auralization.sources import clip_samples
from home_mjx.audio_jax.auralization.stream import faded_frame
from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.endpoints import Listener, Source
from home_mjx.audio_jax.base.presets import audio_preset
from home_mjx.audio_jax.motion.frame import moving_frame
from home_mjx.audio_jax.motion.reception import reception
from home_mjx.bank.bank import HouseBank
from home_mjx.bench import timing
from home_mjx.bench.batch import eye_at, houses_and_starts, own_body, rate_per_environment, scene_at
from home_mjx.bench.record import Record, Settings, make_record

CONFIG = AudioConfig()
STEP = 0.1  # [m] in a frame, by which source and listener each move


def response(settings: Settings) -> Record:
    """Impulse responses."""
    value, seconds = rate_per_environment(settings, partial(_heard, impulse_response, CONFIG, 0.0))
    note = f"{CONFIG.num_rays} rays, {CONFIG.num_bounces} bounces, {CONFIG.response_length} samples; {settings.houses}"
    return make_record(
        "audio/response", value, "responses/s", note, num_envs=settings.num_envs, compile_seconds=seconds
    )


def frame(settings: Settings) -> Record:
    """An impulse response and the sound frame that leads over to it, as one step makes them."""
    return _frames("audio/frame", CONFIG, settings)


def frame_fast(settings: Settings) -> Record:
    """The same of sound that moves within the frame, as the preset `fast` has it."""
    return _frames("audio/frame-fast", audio_preset("fast"), settings)


def frame_balanced(settings: Settings) -> Record:
    """The same of the preset `balanced`."""
    return _frames("audio/frame-balanced", audio_preset("balanced"), settings)


def frame_synthesis(settings: Settings) -> Record:
    """Frames alone, as `fast` makes them of what has been received before."""
    config = audio_preset("fast")
    ends = [_before(settings, config, step) for step in (-STEP, STEP)]
    program, seconds = timing.compiled(jax.vmap(partial(_frame, config)), houses_and_starts(settings)[0], *ends)
    rate = timing.calls_per_second(program, houses_and_starts(settings)[0], *ends, seconds=settings.seconds)
    note = f"no rays; {settings.houses}"
    return make_record(
        "audio/frame-synthesis",
        rate * settings.num_envs,
        "frames/s",
        note,
        num_envs=settings.num_envs,
        compile_seconds=seconds,
    )


def _frames(case: str, config: AudioConfig, settings: Settings) -> Record:
    """Responses with their frames, between where source and listener were, received before, and where they are now."""
    hear, old = _producer(config), _before(settings, config, -STEP)

    def step(bank: HouseBank, house: jax.Array, start: jax.Array, old: Any) -> tuple[jax.Array, Any]:
        new = _heard(hear, config, STEP, bank, house, start)
        return _frame(config, house, old, new), new

    houses, starts = houses_and_starts(settings)
    program, seconds = timing.compiled(jax.vmap(step, (None, 0, 0, 0)), settings.bank, houses, starts, old)
    rate = timing.calls_per_second(program, settings.bank, houses, starts, old, seconds=settings.seconds)
    rays = f"{config.num_rays} rays, {config.num_bounces} bounces, {config.num_paths} paths"
    note = f"response, then a stereo frame of {config.frame} samples; {rays}; {settings.houses}"
    return make_record(
        case, rate * settings.num_envs, "frames/s", note, num_envs=settings.num_envs, compile_seconds=seconds
    )


def _producer(config: AudioConfig) -> Callable[..., Any]:
    return reception if config.motion else impulse_response


def _before(settings: Settings, config: AudioConfig, step: float) -> Any:
    """What every environment has received when source and listener were `step` [m] from the middle of their way."""
    hear = jax.jit(jax.vmap(partial(_heard, _producer(config), config, step), (None, 0, 0)))
    return jax.block_until_ready(hear(settings.bank, *houses_and_starts(settings)))


def _frame(config: AudioConfig, house: jax.Array, old: Any, new: Any) -> jax.Array:
    """A frame of a clip, at a place of its own in each house."""
    clip = jnp.asarray(clip_samples("radio", config))
    span = np.arange(1 - config.memory_length, config.frame + config.ahead)
    source = clip[(977 * house + jnp.asarray(span, jnp.int32)) % clip.size]
    return (moving_frame if config.motion else faded_frame)(source, old, new, config)


def _heard(
    hear: Callable[..., Any], config: AudioConfig, step: float, bank: HouseBank, house: jax.Array, start: jax.Array
) -> Any:
    """What an agent near `start` hears of the house's first goal; both moved by half of `step` [m], each its way."""
    source = bank.navigation.goal[house, 0] + jnp.array([0.0, step / 2, 1.0], jnp.float32)
    eyes, quat = eye_at(start + jnp.array([step / 2, 0.0, 0.0], jnp.float32))
    scene = scene_at(bank, house, start)
    return hear(scene, Source(source), Listener(eyes, quat, body=own_body(bank)), jax.random.key(0), config)


CASES: dict[str, Callable[[Settings], Record]] = {
    "response": response,
    "frame": frame,
    "frame-fast": frame_fast,
    "frame-balanced": frame_balanced,
    "frame-synthesis": frame_synthesis,
}
