"""Effects of switch states on light and sound."""

import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from home_mjx.audio_jax.auralization.clips import CLIPS
from home_mjx.audio_jax.base.endpoints import SoundSources
from home_mjx.bank.bank import HouseBank
from home_mjx.bank.records import SWITCH_KINDS
from home_mjx.raycast_render.scene.appearance import AppearanceOverrides
from home_mjx.raycast_render.scene.types import Scene
from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.base.status import status_flags
from home_mjx.tasks.sounds.sources import SILENT

# Clip that each kind plays while it is on, and the emission of its surfaces, from 0 to 1.
KIND_CLIPS = {"television": "speech", "radio": "radio", "water": "water", "kettle": "whistle", "fan": "hum"}
KIND_GLOW = {"lamp": 0.6, "television": 0.6, "radio": 0.1}
SWITCH_CLIPS = tuple(KIND_CLIPS.values())
LUMINANCE = (0.2126, 0.7152, 0.0722)  # ITU-R BT.709


def switch_lights(
    bank: HouseBank, house: Int[Array, ""], on: Bool[Array, " s"], look: AppearanceOverrides | None
) -> AppearanceOverrides:
    """Return overrides `look` with the light and glow of these states; other fields stay.

    Direct light of each lamp is exact. Indirect light of a room, of one bake for all states, is scaled by the share of
    its lamps' flux that is on. Factors of lamps that the episode has already are kept.
    """
    look = AppearanceOverrides(seed=jnp.zeros((), jnp.uint32)) if look is None else look
    lights, of_light = bank.lights, bank.switches.of_light[house]
    lit = jnp.where(of_light < 0, 1.0, on[jnp.maximum(of_light, 0)].astype(jnp.float32))
    share, room = _room_shares(bank, house, lit), lights.room[house] + 1
    kind = bank.switches.kind[house]
    glow = jnp.array([KIND_GLOW.get(name, 0.0) for name in SWITCH_KINDS], jnp.float32)[jnp.maximum(kind, 0)] * on
    instance = bank.switches.instance[house]
    place = jnp.where(instance < 0, bank.spec.num_instances, instance)
    return look.replace(
        lamps=share if look.lamps is None else share * look.lamps,
        lights=lit if look.lamps is None else lit * look.lamps[room],
        glow=jnp.zeros(bank.spec.num_instances, jnp.float32).at[place].set(glow, mode="drop"),
    )


def _room_shares(bank: HouseBank, house: Int[Array, ""], lit: Float[Array, " l"]) -> Float[Array, " rooms_and_none"]:
    """Return the share of each room's lamp flux that is on, by room + 1; of no room, that of the house. 1 without."""
    lights, count = bank.lights, bank.lights.ambient.shape[1]
    exponent, cutoff = lights.exponent[house], lights.cutoff[house]
    low = jnp.maximum(cutoff, jnp.where(exponent > 0, 0.0, -1.0))
    angle = (1 - low * jnp.abs(low) ** exponent) / (exponent + 1)  # of the angular profile, see `LightSource.intensity`
    flux = jnp.where(lights.daylight[house], 0.0, lights.intensity[house] @ jnp.asarray(LUMINANCE, jnp.float32) * angle)

    def by_room(values: Float[Array, " l"]) -> Float[Array, " rooms_and_none"]:
        """Sum values of lights by room + 1; entry 0 is the sum of all."""
        return jnp.zeros(count, jnp.float32).at[lights.room[house] + 1].add(values).at[0].set(jnp.sum(values))

    total = by_room(flux)
    return jnp.where(total > 0, by_room(flux * lit) / jnp.where(total > 0, total, 1.0), 1.0)


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
