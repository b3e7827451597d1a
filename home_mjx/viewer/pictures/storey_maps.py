"""Maps of level and reverberation time over the storey of a source, as images."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.endpoints import SoundSource
from home_mjx.audio_jax.base.options import Traced
from home_mjx.audio_jax.parameters.floor_survey import survey_floor
from home_mjx.bank.bank import HouseBank
from home_mjx.navigation.grid import cell_below
from home_mjx.raycast_render.scene.types import Scene
from home_mjx.schema.agent import AgentBody
from home_mjx.viewer.pictures.floor_map import draw_sound_map

RECEIVER_SPACING = 0.4  # [m] spacing of receivers
MID_OCTAVES = slice(2, 4)  # 500 Hz and 1 kHz, whose mean ISO 3382-1 reports
MAX_RAYS_PER_OCTAVE, MAX_BOUNCES = 256, 60  # per receiver; each ray carries one octave, and rays are per octave


def draw_storey_maps(scene: Scene, source: np.ndarray, config: AudioConfig) -> dict[str, np.ndarray]:
    """Render maps over the storey of a source, averaged over the octaves of 500 Hz and 1 kHz.

    Args:
        scene: Scene with the first house of its bank.
        source: (3,) [m].
        config: Options; traced rays are reduced, see `reduce_rays`.

    Returns:
        Images (H, W, 3) uint8: `level`, the strength G [dB], and `t30`, the reverberation time T30 [s].
    """
    room, free, place = _receiver_grid(scene.bank, source)
    few = reduce_rays(config)
    hear = jax.jit(survey_floor, static_argnames="config")
    points = jnp.asarray(place[free], jnp.float32)
    found = hear(scene, SoundSource(jnp.asarray(source, jnp.float32)), points, jax.random.key(0), few)
    at = (source[1] - place[0, 0, 1]) / RECEIVER_SPACING + 0.5, (source[0] - place[0, 0, 0]) / RECEIVER_SPACING + 0.5
    shown = {}
    for name, caption, values in (("level", "G [dB]", found.strength), ("t30", "T30 [s]", found.t30)):
        picture = np.full(free.shape, np.nan)
        picture[free] = np.asarray(values)[:, MID_OCTAVES].mean(axis=1)
        shown[name] = draw_sound_map(picture, room, np.array(at), caption)
    return shown


def reduce_rays(config: AudioConfig) -> AudioConfig:
    """Return options with fewer rays and bounces, for many receivers; unchanged if late reverberation is not traced.

    Smaller numbers of rays and bounces stay.
    """
    if not isinstance(config.late, Traced):
        return config
    rays = min(MAX_RAYS_PER_OCTAVE * config.late.num_groups, config.late.num_rays)
    few = replace(config.late, num_rays=rays, num_bounces=min(MAX_BOUNCES, config.late.num_bounces))
    return replace(config, late=few)


def _receiver_grid(bank: HouseBank, source: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return masks (y, x) of receivers in rooms, of walkable ones, and ears (y, x, 3) [m], on the storey of `source`.

    Rows and columns are cropped to the rooms and about `RECEIVER_SPACING` apart. The storey is that of `cell_below`.
    """
    navigation, cell = bank.navigation, bank.spec.cell
    floor = np.asarray(navigation.floor[0])
    level = int(cell_below(bank, jnp.int32(0), jnp.asarray(source, jnp.float32))[0])
    stride = max(round(RECEIVER_SPACING / cell), 1)
    every = slice(stride // 2, None, stride)
    room = np.asarray(navigation.room[0, level])[every, every] >= 0
    free = np.asarray(navigation.region[0, level])[every, every] >= 0
    inside = np.argwhere(room)
    part = tuple(slice(a, b + 1) for a, b in zip(inside.min(axis=0), inside.max(axis=0), strict=True))
    rows, columns = (stride // 2 + 0.5 + stride * np.arange(n) for n in room.shape)
    x, y = np.meshgrid(*(np.asarray(navigation.origin[0])[i] + cell * at for i, at in ((0, columns), (1, rows))))
    place = np.stack([x, y, np.full_like(x, floor[level] + AgentBody().eye_height)], axis=-1)
    return room[part], (room & free)[part], place[part]
