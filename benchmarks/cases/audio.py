"""Sound alone: from a source and a listener in each environment to binaural frames."""

import time
from collections.abc import Callable
from functools import partial
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from benchmarks.cases.batch import eye_pose, houses_and_starts, make_scene_at, own_body_id, rate_per_environment
from benchmarks.cases.record import BenchSettings, Measurement, make_measurement
from home_mjx.audio_jax.auralization.clips import clip_samples
from home_mjx.audio_jax.auralization.convolution import convolve_frame
from home_mjx.audio_jax.auralization.envelope import clip_power, energy_envelope, mean_band_power
from home_mjx.audio_jax.auralization.response import impulse_response
from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.endpoints import Listener, SoundSource
from home_mjx.audio_jax.base.options import Baked
from home_mjx.audio_jax.base.presets import audio_preset
from home_mjx.audio_jax.late_reverb.bake.bake import bake_house
from home_mjx.audio_jax.late_reverb.bake.options import BakeOptions
from home_mjx.audio_jax.moving_sources.frames import render_early, render_frame, render_frames, render_late
from home_mjx.audio_jax.moving_sources.receiver_state import render_receiver_state
from home_mjx.bank.bank import HouseBank
from home_mjx.core import profiling

CONFIG = AudioConfig()
NUM_SOURCES = 4  # number of simultaneous sources
FRAME_MOVEMENT = 0.1  # [m] movement of source and listener in a frame


def response(settings: BenchSettings) -> Measurement:
    """Measure impulse responses."""
    value, seconds = rate_per_environment(settings, partial(_receive, impulse_response, CONFIG, 0.0))
    note = f"{_describe_late(CONFIG)}, {CONFIG.response_length} samples; {settings.houses}"
    return make_measurement(
        "audio/response", value, "responses/s", note, num_envs=settings.num_envs, compile_seconds=seconds
    )


def frame(settings: BenchSettings) -> Measurement:
    """Measure an impulse response and the crossfaded sound frame, as in one step."""
    return _frames("audio/frame", CONFIG, settings)


def frame_fast(settings: BenchSettings) -> Measurement:
    """Measure frames of moving sources and listeners with the preset `kernels`."""
    return _frames("audio/frame-fast", audio_preset("fast"), settings)


def frame_balanced(settings: BenchSettings) -> Measurement:
    """Measure frames with the preset `balance_rows`, which has a late tail."""
    return _frames("audio/frame-balanced", audio_preset("balanced"), settings)


def frame_fast_traced(settings: BenchSettings) -> Measurement:
    """Measure frames with the preset `kernels` and rays traced in every step."""
    return _frames("audio/frame-fast-traced", audio_preset("fast", late="traced"), settings)


def frame_balanced_traced(settings: BenchSettings) -> Measurement:
    """Measure frames with the preset `balance_rows` and rays traced in every step."""
    return _frames("audio/frame-balanced-traced", audio_preset("balanced", late="traced"), settings)


def frame_synthesis(settings: BenchSettings) -> Measurement:
    """Measure the synthesis of frames alone, with the preset `kernels` and precomputed receptions."""
    return _stage("audio/frame-synthesis", settings, render_frame)


def frame_early(settings: BenchSettings) -> Measurement:
    """Measure the synthesis of the early part alone: moving paths, without late reverberation."""

    def early(source: jax.Array, old: Any, new: Any, config: AudioConfig) -> jax.Array:
        old, new = jax.tree.map(lambda x: x[None], (old, new))
        return render_early(source[None], old, new, config)

    return _stage("audio/frame-early", settings, early)


def frame_late(settings: BenchSettings) -> Measurement:
    """Measure the synthesis of the late part alone."""

    def late(source: jax.Array, old: Any, new: Any, config: AudioConfig) -> jax.Array:
        old, new = jax.tree.map(lambda x: x[None], (old, new))
        return render_late(source[None], old, new, config)

    return _stage("audio/frame-late", settings, late)


def frame_baked(settings: BenchSettings) -> Measurement:
    """Measure a response and its frame with baked late reverberation."""
    return _frames("audio/frame-baked", AudioConfig(late=Baked()), settings)


def reception_fast(settings: BenchSettings) -> Measurement:
    """Measure the reception of `frame-kernels` alone: paths and baked energies, no waveform."""
    config = audio_preset("fast")
    value, seconds = rate_per_environment(
        settings, partial(_receive, render_receiver_state, config, 0.0), settings.late_bank
    )
    note = f"paths and baked energies, {config.num_paths} paths; {settings.houses}"
    return make_measurement(
        "audio/reception-fast", value, "receptions/s", note, num_envs=settings.num_envs, compile_seconds=seconds
    )


def frame_four(settings: BenchSettings) -> Measurement:
    """Measure frames of four simultaneous sources per agent, with the preset `kernels`."""
    return _frames("audio/frame-four", audio_preset("fast"), settings, NUM_SOURCES)


def features(settings: BenchSettings) -> Measurement:
    """Measure levels of both ears per octave and the interaural delay, without a waveform."""
    return _features("audio/features", CONFIG, settings)


def features_baked(settings: BenchSettings) -> Measurement:
    """Measure the same features with baked late reverberation."""
    return _features("audio/features-baked", AudioConfig(late=Baked()), settings)


def bake(settings: BenchSettings) -> Measurement:
    """Measure baking of the late reverberation of one house; the first run, which loads kernels, is not counted."""
    house, seconds = settings.first_house, []
    for _ in range(2):
        start = time.perf_counter()
        field = bake_house(house, bank=settings.bank)
        seconds.append(time.perf_counter() - start)
    rays, _ = BakeOptions().ray_counts(len(field.room), len(house.rooms.type))
    note = f"{rays} rays per cell, {field.nbytes / 1e6:.2f} MB; the first house of {settings.houses}"
    return make_measurement(
        "audio/bake", seconds[1], "s/house", note, compile_seconds=max(seconds[0] - seconds[1], 0.0)
    )


def _stage(case: str, settings: BenchSettings, make: Callable[..., jax.Array]) -> Measurement:
    """Measure part of a frame with the preset `kernels` and precomputed receptions."""
    config = audio_preset("fast")
    ends = [_previous_receptions(settings, config, step) for step in (-FRAME_MOVEMENT, FRAME_MOVEMENT)]
    houses = houses_and_starts(settings)[0]
    step = jax.vmap(lambda house, old, new: make(_clip(config, house), old, new, config))
    program, seconds = profiling.compiled(step, houses, *ends)
    rate = profiling.calls_per_second(program, houses, *ends, seconds=settings.seconds)
    note = f"no rays; {settings.houses}"
    return make_measurement(
        case, rate * settings.num_envs, "frames/s", note, num_envs=settings.num_envs, compile_seconds=seconds
    )


def _features(case: str, config: AudioConfig, settings: BenchSettings) -> Measurement:
    """Measure energies of one frame of the source's clip at both ears."""
    frame = config.frame // config.bin_samples

    def step(bank: HouseBank, house: jax.Array, start: jax.Array) -> tuple[jax.Array, jax.Array]:
        heard = _receive(energy_envelope, config, 0.0, bank, house, start)
        power = jnp.asarray(clip_power("radio", config))[: heard.energy.shape[0] - 1 + frame]
        return mean_band_power(heard.energy, power), heard.left_ear_lead

    houses, starts = houses_and_starts(settings)
    bank = _bank(settings, config)
    program, seconds = profiling.compiled(jax.vmap(step, (None, 0, 0)), bank, houses, starts)
    rate = profiling.calls_per_second(program, bank, houses, starts, seconds=settings.seconds)
    note = f"energies in {config.num_bins} bins, levels of a frame; {_describe_late(config)}; {settings.houses}"
    return make_measurement(
        case, rate * settings.num_envs, "frames/s", note, num_envs=settings.num_envs, compile_seconds=seconds
    )


def _frames(case: str, config: AudioConfig, settings: BenchSettings, sources: int = 1) -> Measurement:
    """Measure responses with their frames, from the previous reception to the one after a movement."""
    hear, old = _receiver(config), _previous_receptions(settings, config, -FRAME_MOVEMENT, sources)

    def step(bank: HouseBank, house: jax.Array, start: jax.Array, old: Any) -> tuple[jax.Array, Any]:
        new = _receive_all(hear, config, FRAME_MOVEMENT, sources, bank, house, start)
        return _frame(config, house, old, new, sources), new

    houses, starts = houses_and_starts(settings)
    bank = _bank(settings, config)
    program, seconds = profiling.compiled(jax.vmap(step, (None, 0, 0, 0)), bank, houses, starts, old)
    rate = profiling.calls_per_second(program, bank, houses, starts, old, seconds=settings.seconds)
    note = (
        f"response, then a stereo frame of {config.frame} samples; {_describe_late(config)}, {config.num_paths} paths"
    )
    note += f", {sources} sources" if sources > 1 else ""
    return make_measurement(
        case,
        rate * settings.num_envs,
        "frames/s",
        f"{note}; {settings.houses}",
        num_envs=settings.num_envs,
        compile_seconds=seconds,
    )


def _describe_late(config: AudioConfig) -> str:
    if isinstance(config.late, Baked):
        return "late sound baked"
    return f"{config.traced.num_rays} rays, {config.traced.num_bounces} bounces"


def _bank(settings: BenchSettings, config: AudioConfig) -> HouseBank:
    return settings.late_bank if isinstance(config.late, Baked) else settings.bank


def _receiver(config: AudioConfig) -> Callable[..., Any]:
    return render_receiver_state if config.motion is not None else impulse_response


def _previous_receptions(settings: BenchSettings, config: AudioConfig, step: float, sources: int = 1) -> Any:
    """Return the receptions of all environments with source and listener moved by half of `step` [m]."""
    hear = jax.jit(jax.vmap(partial(_receive_all, _receiver(config), config, step, sources), (None, 0, 0)))
    return jax.block_until_ready(hear(_bank(settings, config), *houses_and_starts(settings)))


def _receive_all(
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
        return _receive(hear, config, step, bank, house, start)
    goals = jnp.arange(sources, dtype=jnp.int32) % bank.navigation.goal.shape[1]
    return jax.vmap(lambda goal: _receive(hear, config, step, bank, house, start, goal))(goals)


def _frame(config: AudioConfig, house: jax.Array, old: Any, new: Any, sources: int = 1) -> jax.Array:
    """Return a frame of a clip that starts at a different sample in each house."""
    source = _clip(config, house)
    if sources > 1:
        return render_frames(jnp.broadcast_to(source, (sources, *source.shape)), old, new, config)
    return (render_frame if config.motion is not None else convolve_frame)(source, old, new, config)


def _clip(config: AudioConfig, house: jax.Array) -> jax.Array:
    clip = jnp.asarray(clip_samples("radio", config))
    span = np.arange(1 - config.memory_length, config.frame + config.num_lookahead)
    return clip[(977 * house + jnp.asarray(span, jnp.int32)) % clip.size]


def _receive(
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
    eyes, quat = eye_pose(start + jnp.array([step / 2, 0.0, 0.0], jnp.float32))
    scene = make_scene_at(bank, house, start)
    return hear(scene, SoundSource(source), Listener(eyes, quat, body=own_body_id(bank)), jax.random.key(0), config)


CASES: dict[str, Callable[[BenchSettings], Measurement]] = {
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
