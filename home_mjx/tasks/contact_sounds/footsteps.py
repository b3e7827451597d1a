"""Footsteps of agents: one per step length, with the sound of the floor under the foot."""

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float

from home_mjx.audio_jax.contact_sounds.sound_bank import (
    FLOOR_KINDS,
    FLOORS,
    IMPACT_MATERIAL_KINDS,
    IMPACT_MATERIALS,
    STEP_VARIANTS,
)
from home_mjx.audio_jax.contact_sounds.sound_slots import ContactSounds, TransientSounds
from home_mjx.raycast_render.casting.cast import cast
from home_mjx.raycast_render.scene.surface import semantics
from home_mjx.schema.compiled import RayKind
from home_mjx.schema.material_kinds import MATERIAL_KINDS
from home_mjx.schema.semantic import Semantic
from home_mjx.tasks.base.config import EnvConfig
from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.sensors.cameras import agent_ids

MAX_FLOOR_DISTANCE = 3.0  # [m] maximum distance from an agent's middle down to the floor
FOOT_HEIGHT = 0.05  # [m] height of a foot above the floor, so that the floor does not occlude it
MAX_FOOTSTEP_SPEED = 4.0  # [m/s] maximum speed that counts for the gain of a footstep


def floor_classes() -> np.ndarray:
    """Return the index into FLOORS of each of MATERIAL_KINDS; the last one is of unknown materials, which are soft."""
    return _classes(FLOORS, FLOOR_KINDS, "soft")


def stuff_classes() -> np.ndarray:
    """Return the index into IMPACT_MATERIALS of each of MATERIAL_KINDS; the last one, of unknown materials, is wood."""
    return _classes(IMPACT_MATERIALS, IMPACT_MATERIAL_KINDS, "wood")


def _classes(classes: dict, kinds: dict[str, tuple[str, ...]], other: str) -> np.ndarray:
    """Return the index into `classes` of each of MATERIAL_KINDS, whose members `kinds` lists, and of unknown materials.

    The last entry and materials in no class have that of `other`.
    """
    names = list(classes)
    of_kind = {kind: names.index(name) for name, members in kinds.items() for kind in members}
    return np.array([of_kind.get(kind, names.index(other)) for kind in (*MATERIAL_KINDS, "")], np.int32)


def step_length(config: EnvConfig, snapshot: Snapshot) -> Float[Array, ""]:
    """Return the distance between footsteps [m], as drawn for this episode if it varies; requires contact sounds."""
    assert config.contact_sounds is not None
    drawn = None if snapshot.variation is None else snapshot.variation.footstep_distance
    return jnp.float32(config.contact_sounds.step_length) if drawn is None else drawn


def footsteps(
    config: EnvConfig, before: Float[Array, "a 3"], snapshot: Snapshot, noises: ContactSounds
) -> tuple[TransientSounds, Float[Array, " a"], Bool[Array, ""]]:
    """Return one footstep of each agent in a control step; its gain is the horizontal speed [m/s], 0 if it took none.

    The speed counts up to `MAX_FOOTSTEP_SPEED`; without a floor within `MAX_FLOOR_DISTANCE` below the agent the gain is
    0. Of several in one step only the last sounds. `before` are positions of agents before the step [m], `noises` the
    contact sounds before it, `snapshot` is of after it.

    Returns:
        The footsteps, each agent's horizontal path length since the start of the episode [m], and whether an agent took
        several.
    """
    length, frame = step_length(config, snapshot), config.audio.frame
    pos = snapshot.pose.pos
    way = jnp.linalg.norm((pos - before)[:, :2], axis=1)
    walked = noises.walked_distance + way
    count, earlier = jnp.floor(walked / length), jnp.floor(noises.walked_distance / length)
    share = jnp.clip((count * length - noises.walked_distance) / jnp.maximum(way, 1e-9), 0.0, 1.0)
    middle = before + share[:, None] * (pos - before)
    down = jnp.broadcast_to(jnp.array([0.0, 0.0, -1.0], jnp.float32), pos.shape)
    own = agent_ids(snapshot.bank, pos.shape[0])
    hit = cast(snapshot.scene, middle, down, t_max=MAX_FLOOR_DISTANCE, exclude=own, mask=int(RayKind.SOUND))
    kind = jnp.asarray(floor_classes())[semantics(snapshot.scene, hit, Semantic.MATERIAL)]
    speed = jnp.minimum(way / jnp.float32(config.timing.ctrl_dt), MAX_FOOTSTEP_SPEED)
    steps = TransientSounds(
        pos=middle.at[:, 2].add(jnp.where(hit.instance < 0, 0.0, FOOT_HEIGHT - hit.t)),
        body=own,
        row=kind * STEP_VARIANTS + count.astype(jnp.int32) % STEP_VARIANTS,
        gain=jnp.where((count > earlier) & (hit.instance >= 0), speed, 0.0),
        start=snapshot.step * frame + (share * frame).astype(jnp.int32),
    )
    return steps, walked, jnp.any(count > earlier + 1)
