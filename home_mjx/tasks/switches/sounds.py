"""Sounds of appliances that are on."""

import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from home_mjx.audio_jax.auralization.clips import CLIPS
from home_mjx.audio_jax.base.endpoints import SoundSources
from home_mjx.bank.records import SWITCH_KINDS
from home_mjx.raycast_render.scene.types import Scene
from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.base.status import status_flags
from home_mjx.tasks.sounds.sources import SILENT

# Clip that each kind plays while it is on.
KIND_CLIPS = {"television": "speech", "radio": "radio", "water": "water", "kettle": "whistle", "fan": "hum"}
SWITCH_CLIPS = tuple(KIND_CLIPS.values())


def play_switched(snapshot: Snapshot, sounds: SoundSources) -> tuple[SoundSources, Int[Array, ""] | None]:
    """Return sounds whose last `num_switch_sources` are the appliances that are on, and flags of `Status`.

    The first ones in the order of the bank's rows have slots; the flag is `NOISES` if one has none. They sound from the
    middle of their bounds; what moves carries its sound. Without `EnvConfig.switches` sounds are unchanged, and flags
    are None.
    """
    on, config = snapshot.switch_on, snapshot.config
    if on is None:
        return sounds, None
    count, switches, house = config.num_switch_sources, snapshot.bank.switches, snapshot.house
    clips = jnp.array([CLIPS.index(KIND_CLIPS[k]) if k in KIND_CLIPS else SILENT for k in SWITCH_KINDS], jnp.int32)
    clip = jnp.where(on, clips[jnp.maximum(switches.kind[house], 0)], SILENT)
    rank = jnp.cumsum(clip >= 0) - 1
    slot = jnp.where((clip >= 0) & (rank < count), config.num_sources + rank, sounds.clip.shape[0])
    instance = jnp.maximum(switches.instance[house], 0)
    middle = instance_middles(snapshot.scene, instance)
    silent = sounds.clip.at[config.num_sources :].set(SILENT)
    return sounds.replace(
        pos=sounds.pos.at[slot].set(middle, mode="drop"),
        body=sounds.body.at[slot].set(snapshot.bank.geometry.instance_object[house, instance], mode="drop"),
        clip=silent.at[slot].set(clip, mode="drop"),
        gain=sounds.gain.at[config.num_sources :].set(1.0),
        period=sounds.period.at[config.num_sources :].set(jnp.inf),
        duration=sounds.duration.at[config.num_sources :].set(jnp.inf),
    ), status_flags(NOISES=jnp.sum(clip >= 0) > count)


def instance_middles(scene: Scene, instance: Int[Array, " s"]) -> Float[Array, "s 3"]:
    """Return the middles of the present bounds of instances in the world [m]."""
    geometry, moving = scene.geometry, scene.moving
    box = geometry.model_box[jnp.maximum(geometry.instance_model[scene.house, instance], 0)]
    pose, middle = geometry.instance_pose[scene.house, instance], box.mean(axis=1)
    still = jnp.einsum("sij,sj->si", pose[:, :, :3], middle, precision="highest") + pose[:, :, 3]
    same = moving.instance[None] == instance[:, None]
    now = moving.box[jnp.argmax(same, axis=1)].mean(axis=1)
    return jnp.where(jnp.any(same, axis=1)[:, None], now, still)
