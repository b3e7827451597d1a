"""Sound alone: from a source and a listener in each environment to binaural frames."""

import time
from collections.abc import Callable
from functools import partial
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from benchmarks.cases.batch import eye_at, houses_and_starts, own_body, rate_per_environment, scene_at
from benchmarks.cases.record import Record, Settings, make_record
from home_mjx.audio_jax.auralization.envelope import band_level, clip_power, energy_response
from home_mjx.audio_jax.auralization.response import impulse_response
from home_mjx.audio_jax.auralization.sources import clip_samples
from home_mjx.audio_jax.auralization.stream import faded_frame
from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.endpoints import Listener, Source
from home_mjx.audio_jax.base.presets import audio_preset
from home_mjx.audio_jax.late_reverb.bake.bake import BakeOptions, bake_house
from home_mjx.audio_jax.moving_sources.frame import moving_early, moving_frame, moving_frames, moving_late
from home_mjx.audio_jax.moving_sources.reception import reception
from home_mjx.bank.bank import HouseBank
from home_mjx.core import profiling

CONFIG = AudioConfig()
SOURCES = 4  # number of simultaneous sources
STEP = 0.1  # [m] movement of source and listener in a frame


def response(settings: Settings) -> Record:
    """Measure impulse responses."""
    value, seconds = rate_per_environment(settings, partial(_heard, impulse_response, CONFIG, 0.0))
    note = f"{CONFIG.num_rays} rays, {CONFIG.num_bounces} bounces, {CONFIG.response_length} samples; {settings.houses}"
    return make_record(
        "audio/response", value, "responses/s", note, num_envs=settings.num_envs, compile_seconds=seconds
    )


def frame(settings: Settings) -> Record:
    """Measure an impulse response and the crossfaded sound frame, as in one step."""
    return _frames("audio/frame", CONFIG, settings)


def frame_fast(settings: Settings) -> Record:
    """Measure frames of moving sources and listeners with the preset `fast`."""
    return _frames("audio/frame-fast", audio_preset("fast"), settings)


def frame_balanced(settings: Settings) -> Record:
    """Measure frames with the preset `balanced`, which has a late tail."""
    return _frames("audio/frame-balanced", audio_preset("balanced"), settings)


def frame_fast_traced(settings: Settings) -> Record:
    """Measure frames with the preset `fast` and rays traced in every step."""
    return _frames("audio/frame-fast-traced", audio_preset("fast", late="traced"), settings)


def frame_balanced_traced(settings: Settings) -> Record:
    """Measure frames with the preset `balanced` and rays traced in every step."""
    return _frames("audio/frame-balanced-traced", audio_preset("balanced", late="traced"), settings)


def frame_synthesis(settings: Settings) -> Record:
    """Measure the synthesis of frames alone, with the preset `fast` and precomputed receptions."""
    return _stage("audio/frame-synthesis", settings, moving_frame)


def frame_early(settings: Settings) -> Record:
    """Measure the synthesis of the early part alone: moving paths, without late reverberation."""

    def early(source: jax.Array, old: Any, new: Any, config: AudioConfig) -> jax.Array:
        old, new = jax.tree.map(lambda x: x[None], (old, new))
        return moving_early(source[None], old, new, config)

    return _stage("audio/frame-early", settings, early)


def frame_late(settings: Settings) -> Record:
    """Measure the synthesis of the late part alone."""

    def late(source: jax.Array, old: Any, new: Any, config: AudioConfig) -> jax.Array:
        old, new = jax.tree.map(lambda x: x[None], (old, new))
        return moving_late(source[None], old, new, config)

    return _stage("audio/frame-late", settings, late)


def frame_baked(settings: Settings) -> Record:
    """Measure a response and its frame with baked late reverberation."""
    return _frames("audio/frame-baked", AudioConfig(late="baked"), settings)


def reception_fast(settings: Settings) -> Record:
    """Measure the reception of `frame-fast` alone: paths and baked energies, no waveform."""
    config = audio_preset("fast")
    value, seconds = rate_per_environment(settings, partial(_heard, reception, config, 0.0), settings.late_bank)
    note = f"paths and baked energies, {config.num_paths} paths; {settings.houses}"
    return make_record(
        "audio/reception-fast", value, "receptions/s", note, num_envs=settings.num_envs, compile_seconds=seconds
    )


def frame_four(settings: Settings) -> Record:
    """Measure frames of four simultaneous sources per agent, with the preset `fast`."""
    return _frames("audio/frame-four", audio_preset("fast"), settings, SOURCES)


def features(settings: Settings) -> Record:
    """Measure levels of both ears per octave and the interaural delay, without a waveform."""
    return _features("audio/features", CONFIG, settings)


def features_baked(settings: Settings) -> Record:
    """Measure the same features with baked late reverberation."""
    return _features("audio/features-baked", AudioConfig(late="baked"), settings)


def bake(settings: Settings) -> Record:
    """Measure baking of the late reverberation of one house; the first run, which compiles, is not counted."""
    house, seconds = settings.first_house, []
    for _ in range(2):
        start = time.perf_counter()
        field = bake_house(house, bank=settings.bank)
        seconds.append(time.perf_counter() - start)
    rays, size = BakeOptions().rays_for(len(field.room)), field.nbytes / 1e6
    note = f"{rays} rays per cell and octave, {size:.2f} MB; the first house of {settings.houses}"
    return make_record("audio/bake", seconds[1], "s/house", note, compile_seconds=max(seconds[0] - seconds[1], 0.0))


def _stage(case: str, settings: Settings, make: Callable[..., jax.Array]) -> Record:
    """Measure part of a frame with the preset `fast` and precomputed receptions."""
    config = audio_preset("fast")
    ends = [_before(settings, config, step) for step in (-STEP, STEP)]
    houses = houses_and_starts(settings)[0]
    step = jax.vmap(lambda house, old, new: make(_clip(config, house), old, new, config))
    program, seconds = profiling.compiled(step, houses, *ends)
    rate = profiling.calls_per_second(program, houses, *ends, seconds=settings.seconds)
    note = f"no rays; {settings.houses}"
    return make_record(
        case, rate * settings.num_envs, "frames/s", note, num_envs=settings.num_envs, compile_seconds=seconds
    )


def _features(case: str, config: AudioConfig, settings: Settings) -> Record:
    """Measure energies of one frame of the source's clip at both ears."""
    frame = config.frame // config.bin_samples

    def step(bank: HouseBank, house: jax.Array, start: jax.Array) -> tuple[jax.Array, jax.Array]:
        heard = _heard(energy_response, config, 0.0, bank, house, start)
        power = jnp.asarray(clip_power("radio", config))[: heard.energy.shape[0] - 1 + frame]
        return band_level(heard.energy, power), heard.lead

    houses, starts = houses_and_starts(settings)
    bank = _bank(settings, config)
    program, seconds = profiling.compiled(jax.vmap(step, (None, 0, 0)), bank, houses, starts)
    rate = profiling.calls_per_second(program, bank, houses, starts, seconds=settings.seconds)
    note = f"energies in {config.num_bins} bins, levels of a frame; {_late(config)}; {settings.houses}"
    return make_record(
        case, rate * settings.num_envs, "frames/s", note, num_envs=settings.num_envs, compile_seconds=seconds
    )


def _frames(case: str, config: AudioConfig, settings: Settings, sources: int = 1) -> Record:
    """Measure responses with their frames, from the previous reception to the one after a movement."""
    hear, old = _producer(config), _before(settings, config, -STEP, sources)

    def step(bank: HouseBank, house: jax.Array, start: jax.Array, old: Any) -> tuple[jax.Array, Any]:
        new = _all_heard(hear, config, STEP, sources, bank, house, start)
        return _frame(config, house, old, new, sources), new

    houses, starts = houses_and_starts(settings)
    bank = _bank(settings, config)
    program, seconds = profiling.compiled(jax.vmap(step, (None, 0, 0, 0)), bank, houses, starts, old)
    rate = profiling.calls_per_second(program, bank, houses, starts, old, seconds=settings.seconds)
    note = f"response, then a stereo frame of {config.frame} samples; {_late(config)}, {config.num_paths} paths"
    note += f", {sources} sources" if sources > 1 else ""
    return make_record(
        case,
        rate * settings.num_envs,
        "frames/s",
        f"{note}; {settings.houses}",
        num_envs=settings.num_envs,
        compile_seconds=seconds,
    )


def _late(config: AudioConfig) -> str:
    return "late sound baked" if config.late == "baked" else f"{config.num_rays} rays, {config.num_bounces} bounces"


def _bank(settings: Settings, config: AudioConfig) -> HouseBank:
    return settings.late_bank if config.late == "baked" else settings.bank


def _producer(config: AudioConfig) -> Callable[..., Any]:
    return reception if config.motion else impulse_response


def _before(settings: Settings, config: AudioConfig, step: float, sources: int = 1) -> Any:
    """Return the receptions of all environments with source and listener moved by half of `step` [m]."""
    hear = jax.jit(jax.vmap(partial(_all_heard, _producer(config), config, step, sources), (None, 0, 0)))
    return jax.block_until_ready(hear(_bank(settings, config), *houses_and_starts(settings)))


def _all_heard(
    hear: Callable[..., Any],
    config: AudioConfig,
    step: float,
    sources: int,
    bank: HouseBank,
    house: jax.Array,
    start: jax.Array,
) -> Any:
    """Return the reception of one source, or of each of several."""
    if sources == 1:
        return _heard(hear, config, step, bank, house, start)
    goals = jnp.arange(sources, dtype=jnp.int32) % bank.navigation.goal.shape[1]
    return jax.vmap(lambda goal: _heard(hear, config, step, bank, house, start, goal))(goals)


def _frame(config: AudioConfig, house: jax.Array, old: Any, new: Any, sources: int = 1) -> jax.Array:
    """Return a frame of a clip that starts at a different sample in each house."""
    source = _clip(config, house)
    if sources > 1:
        return moving_frames(jnp.broadcast_to(source, (sources, *source.shape)), old, new, config)
    return (moving_frame if config.motion else faded_frame)(source, old, new, config)


def _clip(config: AudioConfig, house: jax.Array) -> jax.Array:
    clip = jnp.asarray(clip_samples("radio", config))
    span = np.arange(1 - config.memory_length, config.frame + config.ahead)
    return clip[(977 * house + jnp.asarray(span, jnp.int32)) % clip.size]


def _heard(
    hear: Callable[..., Any],
    config: AudioConfig,
    step: float,
    bank: HouseBank,
    house: jax.Array,
    start: jax.Array,
    goal: jax.Array | int = 0,
) -> Any:
    """Return the reception of a house's goal near `start`; both are moved by half of `step` [m], in y and x."""
    source = bank.navigation.goal[house, goal] + jnp.array([0.0, step / 2, 1.0], jnp.float32)
    eyes, quat = eye_at(start + jnp.array([step / 2, 0.0, 0.0], jnp.float32))
    scene = scene_at(bank, house, start)
    return hear(scene, Source(source), Listener(eyes, quat, body=own_body(bank)), jax.random.key(0), config)


CASES: dict[str, Callable[[Settings], Record]] = {
    "response": response,
    "frame": frame,
    "frame-fast": frame_fast,
    "frame-balanced": frame_balanced,
    "frame-fast-traced": frame_fast_traced,
    "frame-balanced-traced": frame_balanced_traced,
    "frame-synthesis": frame_synthesis,
    "frame-early": frame_early,
    "frame-late": frame_late,
    "frame-baked": frame_baked,
    "frame-four": frame_four,
    "reception-fast": reception_fast,
    "features": features,
    "features-baked": features_baked,
    "bake": bake,
}
